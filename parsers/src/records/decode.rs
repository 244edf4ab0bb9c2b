//! Decoding of arrays, in parallel when they are large.

use super::text::{logical, real, whole};
use super::{Entry, Form, Kind, RecordFile, bytes_at, i32_at};
use crate::error::{ErrorKind, ParseError};
use crate::geometry::zeros;
use crate::parallel;

/// Blocks that one task decodes.
const BLOCKS_PER_TASK: usize = 64;

impl RecordFile {
    /// Values of a REAL, DOUB or INTE array as f32.
    ///
    /// # Errors
    /// When the array holds no numbers or is damaged.
    pub fn f32s(&self, entry: &Entry) -> Result<Vec<f32>, ParseError> {
        match entry.kind {
            Kind::Real => self.decode(entry, f32::from_be_bytes, real),
            Kind::Inte => self.decode(
                entry,
                |b| i32::from_be_bytes(b) as f32,
                |t| Some(whole(t)? as f32),
            ),
            Kind::Doub => self.decode(
                entry,
                |b| f64::from_be_bytes(b) as f32,
                |t| Some(real::<f64>(t)? as f32),
            ),
            _ => Err(self.error(ErrorKind::WrongType, entry, "holds no numbers")),
        }
    }

    /// One value of a REAL or DOUB array, from 0, without decoding the others.
    ///
    /// # Errors
    /// When the array holds no reals, has no such value, or is damaged.
    pub fn f32_at(&self, entry: &Entry, index: usize) -> Result<f32, ParseError> {
        self.check_whole(entry)?;
        let lacks = || {
            let message = format!("has no value {}", index + 1);
            self.error(ErrorKind::WrongCount, entry, message)
        };
        if index as u64 >= entry.count {
            return Err(lacks());
        }
        match (self.form, entry.kind) {
            (Form::Formatted, Kind::Real | Kind::Doub) => self.parse_text_at(entry, index),
            (Form::Binary, Kind::Real) => {
                let bytes = self.element(entry, index)?.and_then(|b| b.try_into().ok());
                bytes.map(f32::from_be_bytes).ok_or_else(lacks)
            }
            (Form::Binary, Kind::Doub) => {
                let bytes = self.element(entry, index)?.and_then(|b| b.try_into().ok());
                bytes
                    .map(|b| f64::from_be_bytes(b) as f32)
                    .ok_or_else(lacks)
            }
            _ => Err(self.error(ErrorKind::WrongType, entry, "holds no real numbers")),
        }
    }

    /// The bytes of one element of a binary array.
    fn element(&self, entry: &Entry, index: usize) -> Result<Option<&[u8]>, ParseError> {
        let size = usize::try_from(entry.kind.size()).unwrap_or(1);
        let mut at = index * size;
        for block in self.blocks(entry)? {
            match block.get(at..at + size) {
                Some(element) => return Ok(Some(element)),
                None => at -= block.len().min(at),
            }
        }
        Ok(None)
    }

    /// Values of a REAL, DOUB, INTE or LOGI array as f64; true is 1, false 0.
    ///
    /// # Errors
    /// When the array holds no numbers or is damaged.
    pub fn f64s(&self, entry: &Entry) -> Result<Vec<f64>, ParseError> {
        match entry.kind {
            Kind::Real => self.decode(
                entry,
                |b| f64::from(f32::from_be_bytes(b)),
                |t| real::<f32>(t).map(f64::from),
            ),
            Kind::Inte => self.decode(
                entry,
                |b| f64::from(i32::from_be_bytes(b)),
                |t| whole(t).map(f64::from),
            ),
            Kind::Doub => self.decode(entry, f64::from_be_bytes, real),
            Kind::Logi => self.decode(
                entry,
                |b: [u8; 4]| f64::from(u8::from(b != [0; 4])),
                |t| logical(t).map(|v| f64::from(u8::from(v))),
            ),
            _ => Err(self.error(ErrorKind::WrongType, entry, "holds no numbers")),
        }
    }

    /// Values of an INTE array.
    ///
    /// # Errors
    /// When the array holds no integers or is damaged.
    pub fn i32s(&self, entry: &Entry) -> Result<Vec<i32>, ParseError> {
        match entry.kind {
            Kind::Inte => self.decode(entry, i32::from_be_bytes, whole),
            _ => Err(self.error(ErrorKind::WrongType, entry, "holds no integers")),
        }
    }

    /// Values of a LOGI array: all but zero is true, since writers differ (-1, 1).
    ///
    /// # Errors
    /// When the array holds no logicals or is damaged.
    pub fn bools(&self, entry: &Entry) -> Result<Vec<bool>, ParseError> {
        match entry.kind {
            Kind::Logi => self.decode(entry, |b: [u8; 4]| b != [0; 4], logical),
            _ => Err(self.error(ErrorKind::WrongType, entry, "holds no logicals")),
        }
    }

    /// Strings of a CHAR or C0nn array, without trailing blanks.
    ///
    /// # Errors
    /// When the array holds no strings or is damaged.
    pub fn strings(&self, entry: &Entry) -> Result<Vec<String>, ParseError> {
        let Kind::Text(length) = entry.kind else {
            return Err(self.error(ErrorKind::WrongType, entry, "holds no strings"));
        };
        self.check_whole(entry)?;
        let strings = match self.form {
            Form::Formatted => self.text_strings(entry, length)?,
            Form::Binary => {
                let blocks = self.blocks(entry)?.into_iter();
                let strings = blocks.flat_map(|b| b.chunks_exact(usize::from(length)));
                strings.collect()
            }
        };
        let string = |s: &[u8]| String::from_utf8_lossy(s).trim_end().to_owned();
        Ok(strings.into_iter().map(string).collect())
    }

    fn decode<const N: usize, T: Send + Sync + Copy + Default>(
        &self,
        entry: &Entry,
        convert: impl Fn([u8; N]) -> T + Sync,
        parse: impl Fn(&[u8]) -> Option<T> + Sync,
    ) -> Result<Vec<T>, ParseError> {
        self.check_whole(entry)?;
        if self.form == Form::Formatted {
            return self.parse_text(entry, parse);
        }
        let blocks = self.blocks(entry)?;
        // The index has checked that the file is larger than the values, but they may be wider here.
        let count = usize::try_from(entry.count).ok();
        let Some(mut values) = count.and_then(zeros::<T>) else {
            let message = format!("not enough memory for {} values", entry.count);
            return Err(self.error(ErrorKind::TooLarge, entry, message));
        };
        let mut rest = values.as_mut_slice();
        let mut tasks = Vec::with_capacity(blocks.len() / BLOCKS_PER_TASK + 1);
        for group in blocks.chunks(BLOCKS_PER_TASK) {
            let count = group.iter().map(|b| b.len() / N).sum();
            let (mine, others) = rest.split_at_mut(count);
            rest = others;
            tasks.push((group, mine));
        }
        parallel::map(tasks, |(group, out)| {
            let elements = group.iter().flat_map(|b| b.as_chunks::<N>().0);
            for (value, bytes) in out.iter_mut().zip(elements) {
                *value = convert(*bytes);
            }
        });
        Ok(values)
    }

    fn check_whole(&self, entry: &Entry) -> Result<(), ParseError> {
        match self.file.is_whole() {
            true => Ok(()),
            false => Err(self.shortened(entry)),
        }
    }

    /// The error about a file that has become shorter since it was opened.
    pub(super) fn shortened(&self, entry: &Entry) -> ParseError {
        let message = "cannot be read: the file was cut off while it was open; load the case again";
        self.error(ErrorKind::Truncated, entry, message)
    }

    /// The data of each block, with both markers checked.
    fn blocks(&self, entry: &Entry) -> Result<Vec<&[u8]>, ParseError> {
        let bytes = self.file.bytes();
        let mut blocks = Vec::new();
        let mut at = entry.data;
        let mut total = 0;
        while at < entry.end {
            let length = i32_at(bytes, at).and_then(|l| u64::try_from(l).ok());
            let block = length
                .filter(|l| l % entry.kind.size().max(1) == 0)
                .filter(|l| i32_at(bytes, at + 4 + l) == Some(*l as i32))
                .and_then(|l| bytes_at(bytes, at + 4, l));
            let Some(block) = block.filter(|b| !b.is_empty()) else {
                let message = "the two lengths of a block differ; the file is damaged";
                return Err(ParseError::of(
                    ErrorKind::Malformed,
                    self.path(),
                    self.place(at),
                    entry.name(),
                    message,
                ));
            };
            total += block.len() as u64;
            blocks.push(block);
            at += 8 + block.len() as u64;
        }
        if total != entry.count * entry.kind.size() || at != entry.end {
            return Err(self.error(
                ErrorKind::Malformed,
                entry,
                "its blocks do not add up to its count; the file is damaged",
            ));
        }
        Ok(blocks)
    }
}
