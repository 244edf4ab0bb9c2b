//! A read-only memory map of a whole file: the only unsafe code of the project.
//!
//! Hazard: when another process truncates the file while it is mapped, touching the lost
//! pages raises SIGBUS, which ends this one. What lowers it:
//!
//! - Only files above 64 MiB are mapped; others are read into memory.
//! - A simulator only appends to its result files while it runs, which is harmless, but it begins them anew
//!   when it is run again: whoever reads an array asks [`Map::is_whole`] before, which leaves the moment of decoding
//!   an array, not the hours that a file is open.
//!
//! What is left is that moment, for large files. Nothing closes it while memory is mapped: no file lock on
//! Linux keeps others from truncating, a private mapping follows the file all the same, and a handler of the signal is
//! unsafe code that a library must not install. The full cure is to read each array by its place in the file, into memory
//! of its own, instead of lending slices of the whole file ([`crate::FileBytes::bytes`]).

use std::fs::File;
use std::io;
use std::path::Path;

/// The bytes of a file, mapped.
#[derive(Debug)]
pub(crate) struct Map {
    file: File,
    // None for an empty file, which cannot be mapped.
    map: Option<memmap2::Mmap>,
}

impl Map {
    /// Maps the file at `path`.
    ///
    /// # Errors
    /// When the file cannot be opened or mapped.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        let map = match file.metadata()?.len() {
            0 => None,
            _ => Some(map_read_only(&file)?),
        };
        Ok(Self { file, map })
    }

    /// The bytes of the file.
    pub(crate) fn bytes(&self) -> &[u8] {
        self.map.as_deref().unwrap_or_default()
    }

    /// False where the file has become shorter since it was mapped.
    pub(crate) fn is_whole(&self) -> bool {
        let length = self.file.metadata().map_or(0, |m| m.len());
        length >= self.bytes().len() as u64
    }
}

#[allow(
    unsafe_code,
    reason = "memory mapping has no safe interface; the hazard is described at the top of this file"
)]
fn map_read_only(file: &File) -> io::Result<memmap2::Mmap> {
    // SAFETY: the map is read-only and private to this process; the remaining hazard, another
    // process truncating the file, ends in SIGBUS, never in silently wrong memory of ours.
    unsafe { memmap2::Mmap::map(file) }
}
