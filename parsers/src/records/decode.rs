//! Decoding of arrays, in parallel when they are large.

use super::blocks::Trouble;
use super::text::{logical, real, whole};
use super::{Entry, Form, Kind, RecordFile};
use crate::error::{ErrorKind, ParseError};
use crate::geometry::zeros;
use crate::parallel;

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
        if index as u64 >= entry.count {
            let message = format!("has no value {}", index + 1);
            return Err(self.error(ErrorKind::WrongCount, entry, message));
        }
        match (self.form, entry.kind) {
            (Form::Formatted, Kind::Real | Kind::Doub) => self.parse_text_at(entry, index),
            (Form::Binary, Kind::Real) => self.element(entry, index).map(f32::from_be_bytes),
            (Form::Binary, Kind::Doub) => {
                let value = self.element(entry, index).map(f64::from_be_bytes);
                value.map(|v| v as f32)
            }
            _ => Err(self.error(ErrorKind::WrongType, entry, "holds no real numbers")),
        }
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
        let string = |s: &[u8]| String::from_utf8_lossy(s).trim_end().to_owned();
        match self.form {
            Form::Formatted => {
                let strings = self.text_strings(entry, length)?.into_iter();
                Ok(strings.map(string).collect())
            }
            Form::Binary => self.by_pieces(entry, |reader, pieces| {
                let mut strings = Vec::new();
                for piece in pieces {
                    piece.read(reader, |block| {
                        strings.extend(block.chunks_exact(usize::from(length)).map(string));
                    })?;
                }
                Ok(strings)
            }),
        }
    }

    fn decode<const N: usize, T: Send + Sync + Copy + Default>(
        &self,
        entry: &Entry,
        convert: impl Fn([u8; N]) -> T + Sync,
        parse: impl Fn(&[u8]) -> Option<T> + Sync,
    ) -> Result<Vec<T>, ParseError> {
        if self.form == Form::Formatted {
            return self.parse_text(entry, parse);
        }
        // The index has checked that the file is larger than the values, but they may be wider here.
        let count = usize::try_from(entry.count).ok();
        self.by_pieces(entry, |reader, pieces| {
            let mut values = count.and_then(zeros::<T>).ok_or(Trouble::Memory)?;
            let mut rest = values.as_mut_slice();
            let mut tasks = Vec::with_capacity(pieces.len());
            for piece in pieces {
                let mine = (piece.values as usize / N).min(rest.len());
                let (mine, others) = rest.split_at_mut(mine);
                rest = others;
                tasks.push((piece, mine));
            }
            let done = parallel::map(tasks, |(piece, mut out)| {
                piece.read(reader, |block| {
                    let elements = block.as_chunks::<N>().0;
                    let all = std::mem::take(&mut out);
                    let (places, behind) = all.split_at_mut(elements.len().min(all.len()));
                    out = behind;
                    for (value, bytes) in places.iter_mut().zip(elements) {
                        *value = convert(*bytes);
                    }
                })
            });
            done.into_iter().collect::<Result<(), _>>()?;
            Ok(values)
        })
    }
}
