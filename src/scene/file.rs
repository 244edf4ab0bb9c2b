//! The text of scene files.

use std::io;
use std::path::Path;

/// Reads a text file, which must be one: opening a pipe waits for a writer, and a device has no end.
///
/// # Errors
/// When it cannot be read, is a pipe or a device, or is not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    let kind = std::fs::metadata(path)?;
    match kind.is_file() || kind.is_dir() {
        true => std::fs::read_to_string(path),
        false => Err(io::Error::other("not a regular file")),
    }
}
