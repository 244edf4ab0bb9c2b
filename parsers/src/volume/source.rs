//! A file, or bytes in memory, read at places: volumes are larger than what is shown of them.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::bytes::{self, FileBytes};
use crate::error::{At, ErrorKind, ParseError};

/// Headers longer than this are none.
const LONGEST_HEADER: u64 = 1 << 20;

/// A file that is read at places.
#[derive(Clone)]
pub(super) struct Source {
    path: PathBuf,
    content: Content,
    length: u64,
}

#[derive(Clone)]
enum Content {
    Open(Arc<File>),
    /// Opened for each reading: a volume may stand in more files than a process may have open.
    Closed,
    Memory(FileBytes),
}

/// Fills `out` from a byte offset.
fn read_at(file: &File, offset: u64, out: &mut [u8]) -> io::Result<()> {
    match bytes::read_at(file, offset, out)? == out.len() {
        true => Ok(()),
        false => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}

impl Source {
    pub(super) fn open(path: &Path) -> Result<Self, ParseError> {
        let (file, metadata) =
            bytes::open(path).map_err(|cause| ParseError::io(path, "cannot open", cause))?;
        Ok(Self {
            path: path.to_owned(),
            content: Content::Open(Arc::new(file)),
            length: metadata.len(),
        })
    }

    /// As [`Self::open`], of a file that is one of many.
    pub(super) fn open_one_of_many(path: &Path) -> Result<Self, ParseError> {
        let mut source = Self::open(path)?;
        source.content = Content::Closed;
        Ok(source)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// The folder where files that this one names are found; `None` of bytes in memory.
    pub(super) fn folder(&self) -> Option<&Path> {
        match self.content {
            Content::Memory(_) => None,
            _ => Some(self.path.parent().unwrap_or(Path::new(""))),
        }
    }

    /// Fills `out` from `offset`.
    pub(super) fn read(&self, offset: u64, out: &mut [u8]) -> Result<(), ParseError> {
        let read = match &self.content {
            Content::Open(file) => read_at(file, offset, out),
            Content::Closed => {
                bytes::open(&self.path).and_then(|(file, _)| read_at(&file, offset, out))
            }
            Content::Memory(file) => {
                let start = usize::try_from(offset).unwrap_or(usize::MAX);
                let end = start.saturating_add(out.len());
                match file.bytes().get(start..end) {
                    Some(bytes) => {
                        out.copy_from_slice(bytes);
                        Ok(())
                    }
                    None => Err(io::ErrorKind::UnexpectedEof.into()),
                }
            }
        };
        read.map_err(|cause| match cause.kind() {
            io::ErrorKind::UnexpectedEof => {
                let message = format!("the file ends before {} bytes that are read", out.len());
                self.error(ErrorKind::Truncated, At::Byte(offset), "", message)
            }
            _ => ParseError::io(&self.path, "cannot read", cause),
        })
    }

    /// The first bytes: all that a header may be.
    pub(super) fn head(&self) -> Result<Vec<u8>, ParseError> {
        let mut head = vec![0; self.length.min(LONGEST_HEADER) as usize];
        self.read(0, &mut head)?;
        Ok(head)
    }

    /// Reads on from `at`.
    pub(super) fn reader(&self, at: u64) -> Reader {
        Reader {
            source: self.clone(),
            at,
        }
    }

    pub(super) fn error(
        &self,
        kind: ErrorKind,
        at: At,
        keyword: &str,
        message: impl Into<String>,
    ) -> ParseError {
        ParseError::of(kind, &self.path, at, keyword, message)
    }
}

impl From<FileBytes> for Source {
    fn from(file: FileBytes) -> Self {
        Self {
            path: file.path().to_owned(),
            length: file.bytes().len() as u64,
            content: Content::Memory(file),
        }
    }
}

impl fmt::Debug for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Source({}, {} bytes)", self.path.display(), self.length)
    }
}

/// A source from some place to its end.
#[derive(Debug)]
pub(super) struct Reader {
    source: Source,
    at: u64,
}

impl Read for Reader {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let left = self.source.length.saturating_sub(self.at);
        let count = (out.len() as u64).min(left) as usize;
        let read = self.source.read(self.at, &mut out[..count]);
        // The file has become shorter, or cannot be read.
        read.map_err(|error| error.cause.unwrap_or(io::ErrorKind::UnexpectedEof.into()))?;
        self.at += count as u64;
        Ok(count)
    }
}
