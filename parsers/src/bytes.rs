//! The bytes of a file with the name that errors give it, and how files on disk are read: into memory or by place, never
//! mapped. Memory that is mapped goes away where another process cuts the file off, and touching it ends the process.

use std::fmt;
use std::fs::{File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::ParseError;
use crate::geometry::zeros;
use crate::parallel;

/// Bytes that one task reads.
const PIECE: usize = 4 << 20;

/// The bytes of a file and its path, which need not exist: it names the file in errors.
///
/// Made by [`Self::open`] from disk, or from a pair of a name and anything that holds bytes, such as
/// `Vec<u8>`, `Arc<[u8]>` or `&'static [u8]`. A clone shares the bytes.
///
/// ```
/// use strataray_parsers::FileBytes;
///
/// let file = FileBytes::from(("CASE.INIT", vec![0, 0, 0, 16]));
/// assert_eq!(file.bytes(), [0, 0, 0, 16]);
/// ```
#[derive(Clone)]
pub struct FileBytes {
    path: PathBuf,
    bytes: Arc<dyn AsRef<[u8]> + Send + Sync>,
}

impl FileBytes {
    /// Reads the file at `path` into memory: as many bytes as it has when it is opened, or fewer where it becomes
    /// shorter meanwhile. What happens to the file afterwards does not matter.
    ///
    /// # Errors
    /// When the file cannot be opened or read, does not fit in memory, or is none: a directory, a pipe, a device.
    pub fn open(path: &Path) -> Result<Self, ParseError> {
        let bytes = read_whole(path).map_err(|cause| ParseError::io(path, "cannot open", cause))?;
        Ok(Self::from((path, bytes)))
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        (*self.bytes).as_ref()
    }

    /// The path that was opened, or the name that was given.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl<N: Into<PathBuf>, B: AsRef<[u8]> + Send + Sync + 'static> From<(N, B)> for FileBytes {
    fn from((name, bytes): (N, B)) -> Self {
        Self {
            path: name.into(),
            bytes: Arc::new(bytes),
        }
    }
}

impl fmt::Debug for FileBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let length = self.bytes().len();
        write!(f, "FileBytes({}, {length} bytes)", self.path.display())
    }
}

/// Opens a file to read it; also gives what the system says of it.
pub(crate) fn open(path: &Path) -> io::Result<(File, Metadata)> {
    // Opening a pipe waits for a writer, and a device has no end.
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    Ok((file, metadata))
}

fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    let (file, metadata) = open(path)?;
    let length = usize::try_from(metadata.len()).ok();
    let mut bytes: Vec<u8> = length.and_then(zeros).ok_or(io::ErrorKind::OutOfMemory)?;
    let pieces = bytes.chunks_mut(PIECE).enumerate().collect();
    let read = parallel::map(pieces, |(n, piece)| {
        let at = (n * PIECE) as u64;
        read_at(&file, at, piece).map(|count| (n * PIECE + count, count == piece.len()))
    });
    // Up to the first piece that is not there, or not whole.
    let mut end = 0;
    for piece in read {
        let (behind, is_whole) = piece?;
        end = behind;
        if !is_whole {
            break;
        }
    }
    bytes.truncate(end);
    Ok(bytes)
}

/// Reads into `buffer` what stands at a byte offset; gives the number of bytes, fewer than asked for where the file ends.
pub(crate) fn read_at(file: &File, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
    let mut count = 0;
    while count < buffer.len() {
        match read_some(file, at + count as u64, &mut buffer[count..]) {
            Ok(0) => break,
            Ok(read) => count += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(count)
}

#[cfg(unix)]
fn read_some(file: &File, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, at)
}

#[cfg(windows)]
fn read_some(file: &File, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, at)
}

/// Elsewhere, as in a browser, there are no files on disk.
#[cfg(not(any(unix, windows)))]
fn read_some(_: &File, _: u64, _: &mut [u8]) -> io::Result<usize> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_any_length_are_read_whole() {
        let file = tempfile::NamedTempFile::new().unwrap();
        for length in [0, 1, PIECE - 1, PIECE, PIECE + 1, 3 * PIECE + 5] {
            let bytes: Vec<u8> = (0..length).map(|n| (n % 251) as u8).collect();
            std::fs::write(file.path(), &bytes).unwrap();
            let read = FileBytes::open(file.path()).unwrap();
            assert!(read.bytes() == bytes, "{length}");
        }
    }
}
