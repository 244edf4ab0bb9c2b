//! The data of a binary array: blocks between their lengths, read in pieces that are decoded by themselves.

use std::borrow::Cow;
use std::io;

use super::index::HEADER;
use super::store::{Reader, Window};
use super::{Entry, RecordFile, i32_at};
use crate::error::{ErrorKind, ParseError};

/// Bytes of blocks that one task reads and decodes.
const PIECE: u64 = 1 << 18;

/// A part of an array's data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Piece {
    /// Byte offset.
    at: u64,
    /// Bytes.
    length: u64,
    /// Bytes of values in it.
    pub(super) values: u64,
    /// True for whole blocks with their lengths, false for a part of one large block.
    is_framed: bool,
}

/// Why an array could not be read.
pub(super) enum Trouble {
    /// The system said so.
    Io(io::Error),
    /// The file ends at this byte by now.
    CutOff(u64),
    /// It has other bytes by now.
    Rewritten,
    /// There is not enough memory for the values.
    Memory,
    /// The lengths of the block at this byte are not right.
    Blocks(u64),
    /// The blocks together have not as many values as the header says.
    Sum,
}

impl Piece {
    /// Calls `each` with the values of each block of the piece.
    pub(super) fn read(
        &self,
        reader: &Reader<'_>,
        mut each: impl FnMut(&[u8]),
    ) -> Result<(), Trouble> {
        let bytes = read(reader, self.at, self.length)?;
        if !self.is_framed {
            each(&bytes);
            return Ok(());
        }
        let (mut rest, mut values) = (&bytes[..], 0);
        while !rest.is_empty() {
            let Some((block, behind)) = first_block(rest) else {
                return Err(Trouble::Blocks(self.at + (bytes.len() - rest.len()) as u64));
            };
            each(block);
            values += block.len() as u64;
            rest = behind;
        }
        match values == self.values {
            true => Ok(()),
            false => Err(Trouble::Sum),
        }
    }
}

/// All of some bytes.
fn read<'a>(reader: &Reader<'a>, at: u64, length: u64) -> Result<Cow<'a, [u8]>, Trouble> {
    let bytes = usize::try_from(length).map_err(|_| io::ErrorKind::OutOfMemory.into());
    let bytes = bytes.and_then(|length| reader.read(at, length));
    let bytes = bytes.map_err(Trouble::Io)?;
    match bytes.len() as u64 == length {
        true => Ok(bytes),
        false => Err(Trouble::CutOff(reader.end().map_err(Trouble::Io)?)),
    }
}

/// The values of the first block of some bytes, and what is behind it.
fn first_block(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    let size = usize::try_from(i32::from_be_bytes(*length)).ok()?;
    let (block, rest) = rest.split_at_checked(size)?;
    let (again, rest) = rest.split_first_chunk::<4>()?;
    (again == length && size > 0).then_some((block, rest))
}

impl Entry {
    /// Bytes of all values.
    fn total(&self) -> u64 {
        self.count * self.kind.size()
    }

    /// Bytes of values of a block by convention.
    fn block(&self) -> u64 {
        self.kind.size() * self.kind.block()
    }

    /// The pieces of an array whose blocks are those of the convention; `None` where it has not as many bytes.
    fn conventional(&self) -> Option<Vec<Piece>> {
        let (total, block) = (self.total(), self.block());
        if total == 0 {
            return Some(Vec::new());
        }
        let blocks = total.div_ceil(block);
        if self.data + total + 8 * blocks != self.end {
            return None;
        }
        let each = (PIECE / (block + 8)).max(1);
        let pieces = (0..blocks.div_ceil(each)).map(|n| {
            let values = (total - n * each * block).min(each * block);
            Piece {
                at: self.data + n * each * (block + 8),
                length: values + 8 * values.div_ceil(block),
                values,
                is_framed: true,
            }
        });
        Some(pieces.collect())
    }

    /// The pieces of an array with blocks of any size, found by going from one to the next.
    fn walked(&self, reader: Reader<'_>) -> Result<Vec<Piece>, Trouble> {
        let size = self.kind.size().max(1);
        let mut window = Window::new(reader);
        let mut pieces: Vec<Piece> = Vec::new();
        let (mut at, mut total) = (self.data, 0);
        while at < self.end {
            let length = window.i32(at).and_then(|l| u64::try_from(l).ok());
            let block = length.filter(|l| *l > 0 && l % size == 0);
            let block = block.filter(|l| window.i32(at + 4 + l) == Some(*l as i32));
            let Some(block) = block else {
                return Err(Trouble::Blocks(at));
            };
            match pieces.last_mut() {
                _ if block > PIECE => pieces.extend(parts(at + 4, block, size)),
                Some(last) if last.is_framed && last.length < PIECE && last.behind() == at => {
                    last.length += block + 8;
                    last.values += block;
                }
                _ => pieces.push(Piece {
                    at,
                    length: block + 8,
                    values: block,
                    is_framed: true,
                }),
            }
            total += block;
            at += block + 8;
        }
        match total == self.total() && at == self.end {
            true => Ok(pieces),
            false => Err(Trouble::Sum),
        }
    }
}

impl Piece {
    fn behind(&self) -> u64 {
        self.at + self.length
    }

    /// The part of the piece with the value of `size` bytes that begins at byte `at` of its values, and where it begins
    /// in there; blocks have `block` bytes of values.
    fn around(&self, at: u64, block: u64, size: u64) -> (Self, u64) {
        if !self.is_framed {
            let part = Self {
                at: self.at + at,
                length: size,
                values: size,
                is_framed: false,
            };
            return (part, 0);
        }
        let before = at / block * block;
        let values = (self.values - before).min(block);
        let part = Self {
            at: self.at + before + at / block * 8,
            length: values + 8,
            values,
            is_framed: true,
        };
        (part, at - before)
    }

    /// The value that begins at byte `at` of the piece's values.
    fn value<const N: usize>(&self, reader: &Reader<'_>, at: u64) -> Result<[u8; N], Trouble> {
        let mut at = usize::try_from(at).map_err(|_| Trouble::Sum)?;
        let mut found = None;
        self.read(reader, |block| {
            if found.is_none() {
                found = block.get(at..).and_then(|rest| rest.first_chunk()).copied();
                at = at.saturating_sub(block.len());
            }
        })?;
        found.ok_or(Trouble::Sum)
    }
}

/// The values of a large block in pieces that each have whole ones.
fn parts(at: u64, block: u64, size: u64) -> impl Iterator<Item = Piece> {
    let most = (PIECE / size).max(1) * size;
    (0..block.div_ceil(most)).map(move |n| {
        let length = (block - n * most).min(most);
        Piece {
            at: at + n * most,
            length,
            values: length,
            is_framed: false,
        }
    })
}

impl RecordFile {
    /// What reads the data of a binary array, after a look whether its header is still there.
    pub(super) fn reader(&self, entry: &Entry) -> Result<Reader<'_>, Trouble> {
        let reader = self.store.reader().map_err(Trouble::Io)?;
        if matches!(reader, Reader::Memory(_)) {
            return Ok(reader);
        }
        let header = read(&reader, entry.data - HEADER, HEADER)?;
        let is_same = header[4..12] == entry.name
            && i32_at(&header, 12) == Some((entry.count & 0x7fff_ffff) as i32);
        match is_same {
            true => Ok(reader),
            false => Err(Trouble::Rewritten),
        }
    }

    /// Does with the pieces of a binary array what `work` does: with those of the convention, else with those that are
    /// found by going from block to block.
    pub(super) fn by_pieces<T>(
        &self,
        entry: &Entry,
        work: impl Fn(&Reader<'_>, &[Piece]) -> Result<T, Trouble>,
    ) -> Result<T, ParseError> {
        let read = || {
            let reader = self.reader(entry)?;
            if let Some(pieces) = entry.conventional() {
                match work(&reader, &pieces) {
                    Err(Trouble::Blocks(_) | Trouble::Sum) => {}
                    done => return done,
                }
            }
            let pieces = entry.walked(self.store.reader().map_err(Trouble::Io)?);
            if pieces.is_err() {
                // Of a file that has been cut off meanwhile the last length is missing.
                read(&reader, entry.end - 4, 4)?;
            }
            work(&reader, &pieces?)
        };
        read().map_err(|trouble| self.unread(entry, trouble))
    }

    /// The bytes of one value of a binary array.
    pub(super) fn element<const N: usize>(
        &self,
        entry: &Entry,
        index: usize,
    ) -> Result<[u8; N], ParseError> {
        let before = (index * N) as u64;
        self.by_pieces(entry, |reader, pieces| {
            let mut start = 0;
            let piece = pieces.iter().find(|piece| {
                start += piece.values;
                before < start
            });
            let piece = piece.ok_or(Trouble::Sum)?;
            let at = before - (start - piece.values);
            // One block is enough, where blocks are those of the convention.
            let (part, at_in_part) = piece.around(at, entry.block(), N as u64);
            match part.value(reader, at_in_part) {
                Err(Trouble::Blocks(_) | Trouble::Sum) => piece.value(reader, at),
                done => done,
            }
        })
    }

    fn unread(&self, entry: &Entry, trouble: Trouble) -> ParseError {
        match trouble {
            Trouble::Io(cause) => {
                let mut error =
                    self.error(ErrorKind::Io, entry, format!("cannot be read: {cause}"));
                error.cause = Some(cause);
                error
            }
            Trouble::CutOff(end) => self.cut_off(entry, end),
            Trouble::Rewritten => self.error(
                ErrorKind::Malformed,
                entry,
                "cannot be read: the file was written anew while it was open; load the case again",
            ),
            Trouble::Memory => {
                let message = format!("not enough memory for {} values", entry.count);
                self.error(ErrorKind::TooLarge, entry, message)
            }
            Trouble::Blocks(at) => ParseError::of(
                ErrorKind::Malformed,
                self.path(),
                self.place(at),
                entry.name(),
                "the two lengths of a block differ; the file is damaged",
            ),
            Trouble::Sum => self.error(
                ErrorKind::Malformed,
                entry,
                "its blocks do not add up to its count; the file is damaged",
            ),
        }
    }

    /// The error about a file that has become shorter since it was opened.
    pub(super) fn cut_off(&self, entry: &Entry, end: u64) -> ParseError {
        let message = format!(
            "cannot be read: the file was cut off at byte {end:#x} while it was open; load the case again"
        );
        self.error(ErrorKind::Truncated, entry, message)
    }
}
