//! The bytes of all samples in their order, wherever they stand: plain, compressed, as text, in base64, in several files.

use std::fmt;
use std::io::{BufReader, Read};
use std::sync::{Mutex, PoisonError};

use flate2::read::{MultiGzDecoder, ZlibDecoder};

use super::sample::{ByteOrder, Coding, SampleType};
use super::source::Source;
use crate::error::{At, ErrorKind, ParseError};

/// No byte of deflate stands for more bytes than this.
const MOST_INFLATED: u64 = 1040;
const BUFFER: usize = 1 << 18;

/// Bytes of a file from some place on, as they are or in base64.
#[derive(Debug, Clone)]
pub(super) struct Span {
    pub(super) source: Source,
    pub(super) start: u64,
    pub(super) is_base64: bool,
}

impl Span {
    /// Bytes that there are at most.
    pub(super) fn length(&self) -> u64 {
        let length = self.source.length().saturating_sub(self.start);
        if self.is_base64 {
            length / 4 * 3
        } else {
            length
        }
    }

    /// The span that begins `bytes` later; in base64 at the group behind them.
    pub(super) fn behind(&self, bytes: u64) -> Self {
        let skipped = if self.is_base64 {
            bytes.div_ceil(3).saturating_mul(4)
        } else {
            bytes
        };
        Self {
            start: self.start.saturating_add(skipped),
            ..self.clone()
        }
    }

    pub(super) fn read(&self, offset: u64, out: &mut [u8]) -> Result<(), ParseError> {
        if !self.is_base64 {
            return self.source.read(self.start.saturating_add(offset), out);
        }
        let mut done = 0;
        let mut letters = Vec::new();
        while done < out.len() {
            let at = offset + done as u64;
            let (group, skipped) = (at / 3, (at % 3) as usize);
            let count = (out.len() - done).min(BUFFER);
            letters.resize((count + skipped).div_ceil(3) * 4, 0);
            let place = self.start.saturating_add(group * 4);
            self.source.read(place, &mut letters)?;
            let bytes = letters.chunks_exact(4).enumerate().map(|(n, four)| {
                let place = place + 4 * n as u64;
                from_base64(four).ok_or_else(|| {
                    let message = "these are no four letters of base64; the file is damaged";
                    let at = At::Byte(place);
                    self.source.error(ErrorKind::Malformed, at, "", message)
                })
            });
            let mut bytes = bytes.collect::<Result<Vec<_>, _>>()?.into_iter().flatten();
            let wanted = bytes.by_ref().skip(skipped);
            for (byte, read) in out[done..done + count].iter_mut().zip(wanted) {
                *byte = read;
            }
            done += count;
        }
        Ok(())
    }

    fn error(&self, kind: ErrorKind, message: impl Into<String>) -> ParseError {
        self.source.error(kind, At::Byte(self.start), "", message)
    }
}

/// Three bytes of four letters; padding stands for zeros.
fn from_base64(four: &[u8]) -> Option<[u8; 3]> {
    let mut bits = 0_u32;
    for letter in four {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => 0,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
    }
    let [_, a, b, c] = bits.to_be_bytes();
    Some([a, b, c])
}

/// The bytes of samples.
#[derive(Debug)]
pub(super) enum Store {
    /// As they are.
    Plain(Span),
    /// One compressed stream.
    Stream(Stream),
    /// Compressed in blocks.
    Blocks(Blocks),
    /// Once written as text: little-endian.
    Memory(Vec<u8>),
    /// Parts of equal length, one behind the other.
    Parts(Vec<Store>, u64),
}

impl Store {
    /// Samples as they are; `length` bytes.
    ///
    /// # Errors
    /// When the file ends before.
    pub(super) fn plain(span: Span, length: u64) -> Result<Self, ParseError> {
        let left = span.length();
        if left < length {
            let message = format!(
                "the samples take {length} bytes, and {left} are there: the file is cut, or its size or type is another one"
            );
            return Err(span.error(ErrorKind::Truncated, message));
        }
        Ok(Self::Plain(span))
    }

    /// Samples of `length` bytes, behind `skip` others in a compressed stream.
    ///
    /// # Errors
    /// When no stream of the bytes in the file can hold as much.
    pub(super) fn stream(
        packing: Packing,
        source: &Source,
        start: u64,
        skip: u64,
        length: u64,
    ) -> Result<Self, ParseError> {
        let span = Span {
            source: source.clone(),
            start,
            is_base64: false,
        };
        check_inflated(&span, span.length(), skip.saturating_add(length))?;
        Ok(Self::Stream(Stream {
            packing,
            span,
            skip,
            state: Mutex::new(None),
        }))
    }

    /// Fills `out` with the bytes from `offset`.
    pub(super) fn read(&self, offset: u64, out: &mut [u8]) -> Result<(), ParseError> {
        match self {
            Self::Plain(span) => span.read(offset, out),
            Self::Stream(stream) => stream.read(offset, out),
            Self::Blocks(blocks) => blocks.read(offset, out),
            Self::Memory(bytes) => {
                // What is asked for was counted before.
                let start = offset as usize;
                let found = bytes.get(start..start + out.len()).unwrap_or_default();
                out[..found.len()].copy_from_slice(found);
                Ok(())
            }
            Self::Parts(parts, length) => {
                let mut done = 0;
                while done < out.len() {
                    let at = offset + done as u64;
                    let inside = at % length;
                    let count = ((length - inside) as usize).min(out.len() - done);
                    if let Some(part) = parts.get((at / length) as usize) {
                        part.read(inside, &mut out[done..done + count])?;
                    }
                    done += count;
                }
                Ok(())
            }
        }
    }
}

fn check_inflated(span: &Span, packed: u64, length: u64) -> Result<(), ParseError> {
    if packed.saturating_add(1).saturating_mul(MOST_INFLATED) >= length {
        return Ok(());
    }
    let message = format!("{packed} compressed bytes cannot hold samples of {length} bytes");
    Err(span.error(ErrorKind::Truncated, message))
}

/// How a stream is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Gzip,
    Zlib,
}

/// A compressed stream: read forward; where one goes back it is begun anew, so that none of it is kept.
pub(super) struct Stream {
    packing: Packing,
    span: Span,
    skip: u64,
    state: Mutex<Option<(u64, Box<dyn Read + Send>)>>,
}

impl Stream {
    fn read(&self, offset: u64, out: &mut [u8]) -> Result<(), ParseError> {
        let offset = self.skip + offset;
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut at, mut reader) = match state.take() {
            Some((at, reader)) if at <= offset => (at, reader),
            _ => (0, self.begin()),
        };
        let skipped = std::io::copy(&mut reader.by_ref().take(offset - at), &mut std::io::sink());
        at += skipped.as_ref().map_or(0, |count| *count);
        skipped.map_err(|cause| self.error(at, &cause))?;
        reader
            .read_exact(out)
            .map_err(|cause| self.error(at, &cause))?;
        *state = Some((at + out.len() as u64, reader));
        Ok(())
    }

    fn begin(&self) -> Box<dyn Read + Send> {
        let reader = self.span.source.reader(self.span.start);
        let reader = BufReader::with_capacity(BUFFER, reader);
        match self.packing {
            Packing::Gzip => Box::new(MultiGzDecoder::new(reader)),
            Packing::Zlib => Box::new(ZlibDecoder::new(reader)),
        }
    }

    fn error(&self, at: u64, cause: &std::io::Error) -> ParseError {
        let (kind, what) = match cause.kind() {
            std::io::ErrorKind::UnexpectedEof => (ErrorKind::Truncated, "end too early"),
            _ => (ErrorKind::Malformed, "are damaged"),
        };
        let message = format!("the compressed samples {what}, at or behind byte {at} of them");
        self.span.error(kind, message)
    }
}

impl fmt::Debug for Stream {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Stream({:?}, {:?})", self.packing, self.span)
    }
}

/// Blocks that are compressed one by one.
#[derive(Debug)]
pub(super) struct Blocks {
    span: Span,
    /// Where each block begins, and the end of the last one.
    starts: Vec<u64>,
    /// Bytes of a block that is not the last.
    size: u64,
    length: u64,
    /// The block that was read last.
    last: Mutex<Option<(usize, Vec<u8>)>>,
}

impl Blocks {
    /// Blocks of the bytes `starts` in `span`, each of `size` bytes once inflated; `length` in all.
    ///
    /// # Errors
    /// When the file ends before, or a block cannot hold its bytes.
    pub(super) fn new(
        span: Span,
        starts: Vec<u64>,
        size: u64,
        length: u64,
    ) -> Result<Self, ParseError> {
        let packed = starts.last().copied().unwrap_or_default();
        if packed > span.length() {
            return Err(span.error(
                ErrorKind::Truncated,
                format!(
                    "the compressed blocks take {packed} bytes, and {} are there",
                    span.length()
                ),
            ));
        }
        for (n, pair) in starts.windows(2).enumerate() {
            let left = length.saturating_sub(size.saturating_mul(n as u64));
            check_inflated(&span, pair[1] - pair[0], size.min(left))?;
        }
        Ok(Self {
            span,
            starts,
            size,
            length,
            last: Mutex::new(None),
        })
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> Result<(), ParseError> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let mut done = 0;
        while done < out.len() {
            let at = offset + done as u64;
            let number = (at / self.size) as usize;
            if last.as_ref().is_none_or(|(n, _)| *n != number) {
                *last = Some((number, self.inflate(number)?));
            }
            let inside = (at % self.size) as usize;
            let block = last.as_ref().map(|(_, block)| block.as_slice());
            let block = block.and_then(|b| b.get(inside..)).unwrap_or_default();
            let count = block.len().min(out.len() - done);
            if count == 0 {
                return Err(self.error(number, "is shorter than it should be"));
            }
            out[done..done + count].copy_from_slice(&block[..count]);
            done += count;
        }
        Ok(())
    }

    fn inflate(&self, number: usize) -> Result<Vec<u8>, ParseError> {
        let (Some(start), Some(end)) = (self.starts.get(number), self.starts.get(number + 1))
        else {
            return Err(self.error(number, "is missing"));
        };
        // Both were checked against the length of the file.
        let mut packed = vec![0; (end - start) as usize];
        self.span.read(*start, &mut packed)?;
        let left = self.length - (self.size * number as u64).min(self.length);
        let mut block = vec![0; self.size.min(left) as usize];
        ZlibDecoder::new(&packed[..])
            .read_exact(&mut block)
            .map_err(|_| self.error(number, "is damaged"))?;
        Ok(block)
    }

    fn error(&self, number: usize, what: &str) -> ParseError {
        let message = format!("compressed block {} {what}", number + 1);
        self.span.error(ErrorKind::Malformed, message)
    }
}

/// Reads `count` numbers of text between two places of a file, and keeps them as samples of `kind`, little-endian.
///
/// # Errors
/// When there are more or fewer numbers, a word is none, or the type has no such value.
pub(super) fn numbers(
    source: &Source,
    [start, end]: [u64; 2],
    count: u64,
    kind: SampleType,
) -> Result<Store, ParseError> {
    let wrong = |found: u64| {
        let message = format!("expected {count} numbers, found {found}");
        source.error(ErrorKind::WrongCount, At::Byte(start), "", message)
    };
    // A number takes a digit, and a blank before the next one.
    let most = end.min(source.length()).saturating_sub(start).div_ceil(2);
    if count > most {
        let message = format!("expected {count} numbers, and there is room for {most} at most");
        return Err(source.error(ErrorKind::WrongCount, At::Byte(start), "", message));
    }
    let coding = Coding {
        kind,
        order: ByteOrder::Little,
    };
    let mut bytes = Vec::with_capacity(count as usize * kind.size());
    let (mut word, mut found) = (Vec::new(), 0);
    let reader = BufReader::with_capacity(BUFFER, source.reader(start));
    let letters = reader.take(end.saturating_sub(start)).bytes();
    let blank = std::iter::once(Ok(b' '));
    for (n, letter) in letters.chain(blank).enumerate() {
        let letter = letter.map_err(|cause| ParseError::io(source.path(), "cannot read", cause))?;
        if !letter.is_ascii_whitespace() && letter != b',' {
            word.push(letter);
        }
        let is_end = word.len() > 64 || letter.is_ascii_whitespace() || letter == b',';
        if word.is_empty() || !is_end {
            continue;
        }
        found += 1;
        if found > count {
            return Err(wrong(found));
        }
        let text = std::str::from_utf8(&word).ok();
        let value = text.and_then(|text| text.parse::<f64>().ok());
        let stored = value.and_then(|value| coding.encode(value, &mut bytes));
        stored.ok_or_else(|| {
            let shown = String::from_utf8_lossy(&word);
            let message = format!("'{shown}' is no number of the type {}", kind.name());
            let at = At::Byte(start + (n - word.len().min(n)) as u64);
            source.error(ErrorKind::BadValue, at, "", message)
        })?;
        word.clear();
    }
    match found == count {
        true => Ok(Store::Memory(bytes)),
        false => Err(wrong(found)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::FileBytes;

    fn source(bytes: &'static [u8]) -> Source {
        Source::from(FileBytes::from(("A", bytes)))
    }

    #[test]
    fn base64_is_read_at_any_place() {
        // "strataray volumes!!" with a byte of padding.
        let span = Span {
            source: source(b"  c3RyYXRhcmF5IHZvbHVtZXMhIQ=="),
            start: 2,
            is_base64: true,
        };
        let whole = b"strataray volumes!!";
        for start in 0..whole.len() {
            for end in start..=whole.len() {
                let mut read = vec![0; end - start];
                span.read(start as u64, &mut read).unwrap();
                assert_eq!(read, &whole[start..end], "{start} {end}");
            }
        }
        let shifted = Span { start: 3, ..span };
        let mut read = [0; 3];
        shifted.read(0, &mut read).unwrap();
        assert_ne!(&read, b"str");
        let blank = Span {
            start: 0,
            ..shifted
        };
        let error = blank.read(0, &mut read).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Malformed);
    }

    #[test]
    fn numbers_of_text_are_counted() {
        let text = source(b"1 2,3\n4");
        let read = |count| numbers(&text, [0, 7], count, SampleType::U8);
        assert!(matches!(read(4).unwrap(), Store::Memory(bytes) if bytes == [1, 2, 3, 4]));
        assert_eq!(read(3).unwrap_err().kind, ErrorKind::WrongCount);
        assert_eq!(read(5).unwrap_err().kind, ErrorKind::WrongCount);
        let error = numbers(&source(b"1 x"), [0, 3], 2, SampleType::U8).unwrap_err();
        assert_eq!(error.to_string(), "A@0x2: 'x' is no number of the type u8");
        assert!(numbers(&source(b"1 300"), [0, 5], 2, SampleType::U8).is_err());
        assert!(numbers(&source(b"1 300"), [0, 5], 2, SampleType::U16).is_ok());
    }
}
