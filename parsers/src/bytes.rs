//! The bytes of a file with the name that errors give it: from disk or from memory.

use std::fmt;
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

impl FileBytes {
    /// Maps the file at `path`; without the feature `mmap`, reads all of it into memory.
    ///
    /// # Errors
    /// When the file cannot be opened, mapped or read, or is a directory.
    pub fn open(path: &Path) -> Result<Self, ParseError> {
        #[cfg(feature = "mmap")]
        let content = Map::open(path).map(|map| Content::Mapped(Arc::new(map)));
        #[cfg(not(feature = "mmap"))]
        let content = std::fs::read(path).map(|bytes| Content::Memory(Arc::new(bytes)));
        Ok(Self {
            path: path.to_owned(),
            content: content.map_err(|cause| ParseError::io(path, "cannot open", cause))?,
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

    /// False where the file on disk has become shorter since it was mapped.
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
