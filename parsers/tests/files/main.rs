//! Whole files, written here and real ones of the folder that `STRATARAY_DATA` names.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

mod formatted;
mod legacy;
mod local;
mod summary;
mod wells;

use std::path::PathBuf;

/// A file of the folder that `STRATARAY_DATA` names; `None` where the variable is not set, unless `REQUIRE_DATA` is.
fn data(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("STRATARAY_DATA");
    assert!(
        folder.is_some() || std::env::var_os("REQUIRE_DATA").is_none(),
        "STRATARAY_DATA is not set"
    );
    Some(PathBuf::from(folder?).join(name))
}
