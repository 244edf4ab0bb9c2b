//! Where the bytes of a file of arrays are: in memory, or on disk, from where arrays are read by their place.
//!
//! A file on disk may be cut off or written anew at any moment, as by a simulator that is run again. Reading it then
//! gives fewer bytes, or others, which is an error like any other.

use std::borrow::Cow;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use crate::bytes::{self, FileBytes};
use crate::error::ParseError;

use super::Form;

/// Files up to this many bytes are read into memory: that takes some hundredths of a second. Files that are held
/// together, one for each step, share them.
pub(super) const SMALL: u64 = 64 << 20;
/// Most files on disk that stay open; those of a case with more are opened for each array, as systems allow a process no
/// more than a thousand or so.
const OPEN: usize = 64;
/// Bytes of a window: a block by convention and the header behind it fit twice.
const WINDOW: usize = 8 << 10;

/// The bytes of a file.
#[derive(Debug)]
pub(super) enum Store {
    Memory(FileBytes),
    Disk(Disk),
}

/// A binary file on disk.
#[derive(Debug)]
pub(super) struct Disk {
    path: PathBuf,
    /// `None` where it is opened for each array.
    file: Option<File>,
    /// Bytes at the time of its opening.
    length: u64,
}

impl Store {
    /// Opens one of `count` files that are held together; files of more than `small` bytes together stay on disk.
    pub(super) fn open(path: &Path, count: usize, small: u64) -> Result<Self, ParseError> {
        let failed = |cause| ParseError::io(path, "cannot open", cause);
        let (file, metadata) = bytes::open(path).map_err(failed)?;
        let length = metadata.len();
        if length > small / (count as u64).max(1) {
            let mut start = [0; 4];
            bytes::read_at(&file, 0, &mut start).map_err(failed)?;
            // Text is cut into values from its begin to its end, so it is needed whole.
            if Form::of(&start) == Some(Form::Binary) {
                return Ok(Self::Disk(Disk {
                    path: path.to_owned(),
                    file: (count <= OPEN).then_some(file),
                    length,
                }));
            }
        }
        FileBytes::open(path).map(Self::Memory)
    }

    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Memory(file) => file.path(),
            Self::Disk(disk) => &disk.path,
        }
    }

    /// The bytes of a file in memory, as one of text is; none of one on disk.
    pub(super) fn text(&self) -> &[u8] {
        match self {
            Self::Memory(file) => file.bytes(),
            Self::Disk(_) => &[],
        }
    }

    /// What reads the bytes.
    pub(super) fn reader(&self) -> io::Result<Reader<'_>> {
        Ok(match self {
            Self::Memory(file) => Reader::Memory(file.bytes()),
            Self::Disk(Disk {
                file: Some(file),
                length,
                ..
            }) => Reader::Open(file, *length),
            Self::Disk(disk) => Reader::Opened(bytes::open(&disk.path)?.0, disk.length),
        })
    }
}

/// Reads the bytes of a file, those on disk up to the length that it had when it was opened.
pub(super) enum Reader<'a> {
    Memory(&'a [u8]),
    Open(&'a File, u64),
    Opened(File, u64),
}

impl<'a> Reader<'a> {
    /// Bytes of the file when it was opened.
    pub(super) fn length(&self) -> u64 {
        match self {
            Self::Memory(bytes) => bytes.len() as u64,
            Self::Open(_, length) | Self::Opened(_, length) => *length,
        }
    }

    /// Bytes of the file now.
    pub(super) fn end(&self) -> io::Result<u64> {
        match self {
            Self::Memory(bytes) => Ok(bytes.len() as u64),
            Self::Open(file, _) => file.metadata().map(|m| m.len()),
            Self::Opened(file, _) => file.metadata().map(|m| m.len()),
        }
    }

    /// Up to `length` bytes from an offset; fewer where the file ends.
    pub(super) fn read(&self, at: u64, length: usize) -> io::Result<Cow<'a, [u8]>> {
        let end = at.saturating_add(length as u64).min(self.length());
        let start = at.min(end);
        let file = match self {
            Self::Memory(bytes) => {
                let place = start as usize..end as usize;
                return Ok(Cow::Borrowed(bytes.get(place).unwrap_or_default()));
            }
            Self::Open(file, _) => file,
            Self::Opened(file, _) => file,
        };
        let mut read = vec![0; (end - start) as usize];
        let count = bytes::read_at(file, start, &mut read)?;
        // While a file is cut off its last page may be read as zeros, after its length has changed.
        let left = self.end()?.saturating_sub(start);
        read.truncate(usize::try_from(left).unwrap_or(count).min(count));
        Ok(Cow::Owned(read))
    }
}

/// Looks at a file place by place; of a file on disk it holds the bytes around the last place.
pub(super) struct Window<'a> {
    reader: Reader<'a>,
    held: Cow<'a, [u8]>,
    /// Offset of what is held.
    start: u64,
    /// The first error of the system: the file seems to end there.
    failed: Option<io::Error>,
}

impl<'a> Window<'a> {
    pub(super) fn new(reader: Reader<'a>) -> Self {
        let held = match reader {
            Reader::Memory(bytes) => Cow::Borrowed(bytes),
            Reader::Open(..) | Reader::Opened(..) => Cow::Owned(Vec::new()),
        };
        Self {
            reader,
            held,
            start: 0,
            failed: None,
        }
    }

    pub(super) fn length(&self) -> u64 {
        self.reader.length()
    }

    /// The error of the system that ended the file early.
    pub(super) fn failed(self) -> Option<io::Error> {
        self.failed
    }

    /// Up to `length` bytes from an offset; fewer where the file ends. `length` is at most that of a window.
    pub(super) fn at(&mut self, at: u64, length: usize) -> &[u8] {
        let end = at.saturating_add(length as u64).min(self.length());
        if at < self.start || end > self.start + self.held.len() as u64 {
            match self.reader.read(at, WINDOW.max(length)) {
                Ok(read) => (self.held, self.start) = (read, at),
                Err(error) => {
                    self.failed.get_or_insert(error);
                    return &[];
                }
            }
        }
        let from = usize::try_from(at - self.start).unwrap_or(usize::MAX);
        let held = self.held.get(from..).unwrap_or_default();
        &held[..held.len().min(length)]
    }

    /// Big-endian i32 at an offset, if the bytes are there.
    pub(super) fn i32(&mut self, at: u64) -> Option<i32> {
        let four = self.at(at, 4).try_into().ok()?;
        Some(i32::from_be_bytes(four))
    }
}
