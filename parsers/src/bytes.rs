//! The bytes of a file with the name that errors give it: from disk or from memory.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::ParseError;
#[cfg(feature = "mmap")]
use crate::mapped::Map;

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
    content: Content,
}

#[derive(Clone)]
enum Content {
    #[cfg(feature = "mmap")]
    Mapped(Arc<Map>),
    Memory(Arc<dyn AsRef<[u8]> + Send + Sync>),
}

/// Files up to this many bytes are read into memory: that takes some hundredths of a second, and what another process
/// does to them afterwards does not matter (see `mapped`).
const SMALL: u64 = 64 << 20;

fn content(path: &Path, small: u64) -> io::Result<Content> {
    // Opening a pipe waits for a writer, and a device has no end.
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    #[cfg(feature = "mmap")]
    if metadata.len() > small {
        return Map::open(path).map(|map| Content::Mapped(Arc::new(map)));
    }
    #[cfg(not(feature = "mmap"))]
    let _ = small;
    std::fs::read(path).map(|bytes| Content::Memory(Arc::new(bytes)))
}

impl FileBytes {
    /// Reads the file at `path` into memory, or maps it where it is large; without the feature `mmap` it is always read.
    ///
    /// # Errors
    /// When the file cannot be opened, mapped or read, or is none: a directory, a pipe, a device.
    pub fn open(path: &Path) -> Result<Self, ParseError> {
        Self::open_mapping(path, SMALL)
    }

    /// As [`Self::open`]; files of more bytes than `small` are mapped.
    pub(crate) fn open_mapping(path: &Path, small: u64) -> Result<Self, ParseError> {
        Ok(Self {
            path: path.to_owned(),
            content: content(path, small)
                .map_err(|cause| ParseError::io(path, "cannot open", cause))?,
        })
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        match &self.content {
            #[cfg(feature = "mmap")]
            Content::Mapped(map) => map.bytes(),
            Content::Memory(bytes) => (**bytes).as_ref(),
        }
    }

    /// The path that was opened, or the name that was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// False where the file on disk has become shorter since it was mapped; what was read into memory stays whole.
    pub fn is_whole(&self) -> bool {
        match &self.content {
            #[cfg(feature = "mmap")]
            Content::Mapped(map) => map.is_whole(),
            Content::Memory(_) => true,
        }
    }
}

impl<N: Into<PathBuf>, B: AsRef<[u8]> + Send + Sync + 'static> From<(N, B)> for FileBytes {
    fn from((name, bytes): (N, B)) -> Self {
        Self {
            path: name.into(),
            content: Content::Memory(Arc::new(bytes)),
        }
    }
}

impl fmt::Debug for FileBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let length = self.bytes().len();
        write!(f, "FileBytes({}, {length} bytes)", self.path.display())
    }
}
