//! A read-only memory map of a whole file: the only unsafe code of the project.
//!
//! Hazard: when another process truncates the file while it is mapped, touching the lost
//! pages raises SIGBUS. A simulator only appends to its result files while it runs, which is
//! harmless, but it begins them anew when it is run again: who reads a file that has been open
//! for a while asks [`MappedFile::is_whole`] before, which leaves a moment, not hours.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::error::ParseError;

/// The bytes of a file, mapped, together with its path for error messages.
#[derive(Debug)]
pub struct MappedFile {
    path: PathBuf,
    file: File,
    // None for an empty file, which cannot be mapped.
    map: Option<memmap2::Mmap>,
}

impl MappedFile {
    /// Maps the file at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened or mapped, or is a directory.
    pub fn open(path: &Path) -> Result<Self, ParseError> {
        let io = |source| ParseError::io(path, "cannot open", source);
        let file = File::open(path).map_err(io)?;
        let metadata = file.metadata().map_err(io)?;
        if metadata.is_dir() {
            let source = std::io::Error::from(std::io::ErrorKind::IsADirectory);
            return Err(io(source));
        }
        let map = if metadata.len() == 0 {
            None
        } else {
            Some(map_read_only(&file).map_err(io)?)
        };
        Ok(Self {
            path: path.to_owned(),
            file,
            map,
        })
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        self.map.as_deref().unwrap_or_default()
    }

    /// False where the file has become shorter since it was mapped.
    pub fn is_whole(&self) -> bool {
        let length = self.file.metadata().map_or(0, |m| m.len());
        length >= self.bytes().len() as u64
    }

    /// The path that was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

#[allow(
    unsafe_code,
    reason = "memory mapping has no safe interface; the hazard is described at the top of this file"
)]
fn map_read_only(file: &File) -> std::io::Result<memmap2::Mmap> {
    // SAFETY: the map is read-only and private to this process; the remaining hazard, another
    // process truncating the file, ends in SIGBUS, never in silently wrong memory of ours.
    unsafe { memmap2::Mmap::map(file) }
}
