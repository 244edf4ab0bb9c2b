//! Where the files of a deck come from: folders, or memory.

use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path, PathBuf};

use crate::bytes::FileBytes;
use crate::error::ParseError;

/// Finds and opens a deck and the files that it includes.
pub trait DeckFiles {
    /// The path under which the file at `path` is opened; `None` where there is none.
    fn find(&self, path: &Path) -> Option<PathBuf>;

    /// As [`Self::find`], for a path that may differ in letter case: decks from systems that ignore it are read on
    /// those that do not.
    fn find_any_case(&self, path: &Path) -> Option<PathBuf>;

    /// Opens the file at a path that was given by the user or found.
    ///
    /// # Errors
    /// When there is none, or it cannot be read.
    fn open(&self, path: &Path) -> Result<FileBytes, ParseError>;
}

/// The files on disk.
#[derive(Debug, Clone, Copy, Default)]
pub struct Folders;

impl DeckFiles for Folders {
    fn find(&self, path: &Path) -> Option<PathBuf> {
        path.is_file().then(|| path.to_owned())
    }

    fn find_any_case(&self, path: &Path) -> Option<PathBuf> {
        as_on_disk(path)
    }

    fn open(&self, path: &Path) -> Result<FileBytes, ParseError> {
        FileBytes::open(path)
    }
}

/// Files in memory, by their paths.
///
/// Made from any number of [`FileBytes`], or of pairs of a name and bytes.
///
/// ```
/// use std::path::Path;
/// use strataray_parsers::deck::{DeckFiles, MemoryFiles};
///
/// let files: MemoryFiles = [("CASE.DATA", "INCLUDE\n 'include/grid.inc' /"), ("include/GRID.INC", "")]
///     .into_iter()
///     .collect();
/// assert!(files.open(Path::new("CASE.DATA")).is_ok());
/// let found = files.find_any_case(Path::new("./include/grid.inc"));
/// assert_eq!(found.as_deref(), Some(Path::new("include/GRID.INC")));
/// ```
#[derive(Debug, Clone, Default)]
pub struct MemoryFiles(BTreeMap<PathBuf, FileBytes>);

impl<F: Into<FileBytes>> FromIterator<F> for MemoryFiles {
    fn from_iter<I: IntoIterator<Item = F>>(files: I) -> Self {
        let files = files.into_iter().map(Into::into);
        Self(files.map(|file| (plain(file.path()), file)).collect())
    }
}

impl DeckFiles for MemoryFiles {
    fn find(&self, path: &Path) -> Option<PathBuf> {
        let path = plain(path);
        self.0.contains_key(&path).then_some(path)
    }

    fn find_any_case(&self, path: &Path) -> Option<PathBuf> {
        let path = plain(path);
        let same = |name: &&PathBuf| name.as_os_str().eq_ignore_ascii_case(&path);
        self.0.keys().find(same).cloned()
    }

    fn open(&self, path: &Path) -> Result<FileBytes, ParseError> {
        let file = self.0.get(&plain(path)).cloned();
        file.ok_or_else(|| {
            let cause = io::ErrorKind::NotFound.into();
            ParseError::io(path, "cannot open", cause)
        })
    }
}

/// The path without `.`, and without each `..` that follows a folder.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if plain.file_name().is_some() => {
                plain.pop();
            }
            _ => plain.push(part),
        }
    }
    plain
}

/// The file that `path` means in the letter case of its folders and its name on disk.
fn as_on_disk(path: &Path) -> Option<PathBuf> {
    let mut found = PathBuf::new();
    for part in path.components() {
        let next = found.join(part);
        if next.exists() || !matches!(part, Component::Normal(_)) {
            found = next;
            continue;
        }
        let folder = match found.as_os_str().is_empty() {
            true => Path::new("."),
            false => found.as_path(),
        };
        let names = std::fs::read_dir(folder).ok()?.flatten();
        let names = names.map(|entry| entry.file_name());
        // Names in another encoding than UTF-8 are compared by what of them can be read, as the deck's are.
        let wanted = part.as_os_str().to_string_lossy();
        let same = names.filter(|name| name.to_string_lossy().eq_ignore_ascii_case(&wanted));
        found.push(same.min()?);
    }
    found.is_file().then_some(found)
}
