//! Why something could not be exported.

use std::io;
use std::path::{Path, PathBuf};

use super::Format;
use crate::case::CaseError;
use crate::view::SceneError;

/// Why something could not be exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The ending is none of a format.
    #[error("{}: cells and values are written as {}", .0.display(), endings())]
    Format(PathBuf),
    /// A file cannot be written, or cannot hold what is to be written.
    #[error("cannot write {}: {cause}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// A file would take the place of one that the case is read from.
    #[error("{} is a file of the case itself; name another one", .0.display())]
    Source(PathBuf),
    /// A file from elsewhere would be taken for a part of what is written.
    #[error("{} is left from another case; remove it, or name another base", .0.display())]
    Leftover(PathBuf),
    /// No property was named for a format that has nothing else.
    #[error("a table needs a property at least: name one with --property")]
    NoProperty,
    /// Surfaces were asked for without a view, which has their colors.
    #[error("surfaces are written of what a scene shows, and there is none")]
    NoView,
    /// The main grid cannot be taken apart from its local grids.
    #[error("the main grid cannot be written: {0}")]
    Grid(String),
    /// No cell is written.
    #[error("no cell is drawn, so there is nothing to write")]
    Empty,
    /// The case does not have what is to be written.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The scene is wrong, or asks for what the case does not have.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Whoever asked does not want it anymore.
    #[error("writing was canceled")]
    Canceled,
}

/// From what went wrong with a file to an error that names it.
pub(super) fn failed(path: &Path) -> impl Fn(io::Error) -> ExportError {
    move |cause| ExportError::Write {
        path: path.to_owned(),
        cause,
    }
}

fn endings() -> String {
    let endings = Format::ALL.map(|(_, ending, _)| format!(".{ending}"));
    endings.join(", ")
}
