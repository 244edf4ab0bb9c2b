//! Formatted files: the same arrays as text, a header in quotes and then values between blanks.
//!
//! ```text
//!  'PORO    '           3 'REAL'
//!    0.10000000E+00   0.20000000E+00   0.30000000E+00
//! ```
//!
//! Numbers hold no quotes, so that the next header is found without looking at them. Values are read whatever the
//! width of their columns, as simulators and tools differ in it.

use std::str::FromStr;

use super::index::{Fault, Header, fault};
use super::{Entry, Kind, RecordFile};
use crate::error::{At, ErrorKind, ParseError};
use crate::parallel;

/// Bytes of text that a task converts.
const PIECE: usize = 1 << 18;
/// Bytes looked at together for a quote.
const STRIDE: usize = 256;
const QUOTE: u8 = b'\'';

/// True where the first visible byte is the quote of a header.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    bytes.get(visible(bytes, 0)) == Some(&QUOTE)
}

/// Line and column of a byte.
pub(super) fn place(bytes: &[u8], at: u64) -> At {
    let before = usize::try_from(at).ok().and_then(|at| bytes.get(..at));
    let before = before.unwrap_or(bytes);
    let line_start = before
        .iter()
        .rposition(|b| *b == b'\n')
        .map_or(0, |n| n + 1);
    let breaks = before.iter().filter(|b| **b == b'\n').count();
    At::Line {
        line: breaks + 1,
        column: before.len() - line_start + 1,
    }
}

/// The first byte at or behind `at` that is no blank; the length of `bytes` where there is none.
pub(super) fn visible(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or_default();
    let found = rest.iter().position(|b| !is_blank(*b));
    found.map_or(bytes.len(), |n| at + n)
}

fn is_blank(byte: u8) -> bool {
    byte <= b' '
}

/// The header that starts at `at`, the place of its first quote.
pub(super) fn header(bytes: &[u8], at: u64) -> Result<Header, Fault> {
    let damaged = |at: usize| {
        let message = "not an array header like 'PORO    '  3 'REAL': this is not a formatted Eclipse file, or it is damaged";
        fault(ErrorKind::Malformed, at as u64, message)
    };
    let cut = || {
        let message = "the file ends within an array header";
        fault(ErrorKind::Truncated, at, message)
    };
    let start = usize::try_from(at).unwrap_or(usize::MAX);
    let (name, behind) = quoted(bytes, start, 8).ok_or_else(|| match line_ends(bytes, start) {
        true => damaged(start),
        false => cut(),
    })?;
    let number = visible(bytes, behind);
    let end = token_end(bytes, number);
    let kind_start = visible(bytes, end);
    if kind_start == bytes.len() {
        return Err(cut());
    }
    let count = std::str::from_utf8(&bytes[number..end]).ok();
    let count = count.and_then(|text| text.parse().ok());
    let (Some(count), true) = (count, name.is_ascii()) else {
        return Err(damaged(start));
    };
    let kind = quoted(bytes, kind_start, 4);
    let kind = kind.and_then(|(kind, behind)| Some((kind.try_into().ok()?, behind)));
    let Some((kind, behind)) = kind else {
        return Err(match line_ends(bytes, kind_start) {
            true => damaged(start),
            false => cut(),
        });
    };
    let mut padded = [b' '; 8];
    padded[..name.len()].copy_from_slice(name);
    Ok(Header {
        name: padded,
        count,
        kind,
        behind: behind as u64,
    })
}

fn line_ends(bytes: &[u8], at: usize) -> bool {
    let rest = bytes.get(at..).unwrap_or_default();
    rest.contains(&b'\n')
}

/// The string of at most `width` bytes that opens with a quote at `at`, and the offset behind its second quote.
///
/// A string of the full width may hold quotes; a shorter one, as editors leave it, ends at the first.
fn quoted(bytes: &[u8], at: usize, width: usize) -> Option<(&[u8], usize)> {
    let rest = bytes.get(at..)?.strip_prefix(b"'")?;
    let full = rest.get(width) == Some(&QUOTE) && !rest[..width].contains(&b'\n');
    let length = match full {
        true => width,
        false => rest
            .iter()
            .take(width)
            .position(|b| matches!(*b, QUOTE | b'\n'))
            .filter(|n| rest[*n] == QUOTE)?,
    };
    Some((&rest[..length], at + length + 2))
}

fn token_end(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or_default();
    let length = rest.iter().position(|b| is_blank(*b) || *b == QUOTE);
    at + length.unwrap_or(rest.len())
}

/// Where the values of an array end that start at `data`.
pub(super) fn data_end(bytes: &[u8], data: u64, count: u64, kind: Kind) -> Result<u64, Fault> {
    if count == 0 || kind == Kind::Mess {
        return Ok(data);
    }
    let start = usize::try_from(data).unwrap_or(usize::MAX);
    let rest = bytes.get(start..).unwrap_or_default();
    let too_short = || {
        let message = format!("the file ends before its {count} values");
        fault(ErrorKind::Truncated, data, message)
    };
    // A value takes a blank and a digit, or two quotes: before anything is done by the count.
    if count > rest.len() as u64 / 2 {
        return Err(too_short());
    }
    if let Kind::Text(width) = kind {
        let mut at = start;
        for _ in 0..count {
            at = visible(bytes, at);
            at = match quoted(bytes, at, usize::from(width)) {
                Some((_, behind)) => behind,
                None if !line_ends(bytes, at) => return Err(too_short()),
                None => {
                    let message = format!("no string of at most {width} bytes between quotes");
                    return Err(fault(ErrorKind::Malformed, at as u64, message));
                }
            };
        }
        return Ok(at as u64);
    }
    let Some(length) = next_quote(rest) else {
        // The last array: is it whole? Every line ends with a line break.
        let is_cut = !rest.last().is_some_and(|b| is_blank(*b));
        let found = tokens(rest).count() as u64;
        return match is_cut || found < count {
            true => Err(too_short()),
            false => Ok(bytes.len() as u64),
        };
    };
    Ok((start + length) as u64)
}

fn next_quote(bytes: &[u8]) -> Option<usize> {
    // All of a stride at once, which the compiler makes wide instructions of.
    let has = |piece: &[u8]| piece.iter().fold(false, |found, b| found | (*b == QUOTE));
    let stride = bytes.chunks(STRIDE).position(has)?;
    let from = stride * STRIDE;
    let within = bytes[from..].iter().position(|b| *b == QUOTE)?;
    Some(from + within)
}

fn tokens(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split(|b| is_blank(*b)).filter(|t| !t.is_empty())
}

impl RecordFile {
    /// The values of an array of a formatted file, each by `parse` from what stands between blanks.
    pub(super) fn parse_text<T: Send>(
        &self,
        entry: &Entry,
        parse: impl Fn(&[u8]) -> Option<T> + Sync,
    ) -> Result<Vec<T>, ParseError> {
        let pieces = parallel::map(cut(self.text(entry)?), |(start, text)| {
            let value = |token| parse(token).ok_or_else(|| (start + offset(text, token), token));
            tokens(text).map(value).collect::<Result<Vec<T>, _>>()
        });
        let mut values = Vec::new();
        for piece in pieces {
            let piece = piece.map_err(|(at, token)| self.not_a_value(entry, at, token))?;
            match values.is_empty() {
                true => values = piece,
                false => values.extend(piece),
            }
        }
        if values.len() as u64 == entry.count {
            return Ok(values);
        }
        let message = format!(
            "its header says {} values, and {} follow; the file is damaged",
            entry.count,
            values.len()
        );
        Err(self.error(ErrorKind::Malformed, entry, message))
    }

    /// One value of an array of reals of a formatted file.
    pub(super) fn parse_text_at(&self, entry: &Entry, index: usize) -> Result<f32, ParseError> {
        let text = self.text(entry)?;
        let Some(token) = tokens(text).nth(index) else {
            let message = format!("has no value {}; the file is damaged", index + 1);
            return Err(self.error(ErrorKind::Malformed, entry, message));
        };
        let value = match entry.kind {
            Kind::Doub => real::<f64>(token).map(|v| v as f32),
            _ => real(token),
        };
        value.ok_or_else(|| self.not_a_value(entry, offset(text, token), token))
    }

    /// The error about what stands `at` bytes behind the start of the data.
    fn not_a_value(&self, entry: &Entry, at: usize, token: &[u8]) -> ParseError {
        let shown: String = String::from_utf8_lossy(token).chars().take(40).collect();
        let at = self.place(entry.data + at as u64);
        let message = format!("{shown:?} is not a value of its type");
        ParseError::of(ErrorKind::BadValue, self.path(), at, entry.name(), message)
    }

    /// The strings of an array of a formatted file, each of at most `width` bytes.
    pub(super) fn text_strings(&self, entry: &Entry, width: u16) -> Result<Vec<&[u8]>, ParseError> {
        let bytes = self.text(entry)?;
        let mut at = 0;
        let mut strings = Vec::new();
        while let Some((string, behind)) = quoted(bytes, visible(bytes, at), usize::from(width)) {
            strings.push(string);
            at = behind;
        }
        Ok(strings)
    }

    fn text(&self, entry: &Entry) -> Result<&[u8], ParseError> {
        let place = usize::try_from(entry.data)
            .ok()
            .zip(usize::try_from(entry.end).ok());
        let text = place.and_then(|(start, end)| self.store.text().get(start..end));
        text.ok_or_else(|| self.cut_off(entry, self.store.text().len() as u64))
    }
}

/// Where `part` starts in `whole`, of which it is a part.
fn offset(whole: &[u8], part: &[u8]) -> usize {
    part.as_ptr().addr() - whole.as_ptr().addr()
}

/// Pieces of about [`PIECE`] bytes, each ending at a blank, with their offsets.
fn cut(text: &[u8]) -> Vec<(usize, &[u8])> {
    let mut pieces = Vec::with_capacity(text.len() / PIECE + 1);
    let mut start = 0;
    while start < text.len() {
        let end = token_end(text, (start + PIECE).min(text.len()));
        pieces.push((start, &text[start..end]));
        start = end;
    }
    pieces
}

/// A real number in the notation of C or Fortran: `1.5`, `0.15E+01`, `0.15D+01`, `0.15+101`, `inf`, `nan`.
pub(super) fn real<T: FromStr>(token: &[u8]) -> Option<T> {
    let text = std::str::from_utf8(token).ok()?;
    text.parse().ok().or_else(|| {
        let mut plain = text.replace(['d', 'D'], "e");
        // Fortran leaves the letter out where the exponent takes three digits.
        let sign = plain.rfind(['+', '-']).filter(|n| *n > 0);
        if let Some(sign) = sign.filter(|_| !plain.contains(['e', 'E'])) {
            plain.insert(sign, 'e');
        }
        plain.parse().ok()
    })
}

/// An integer.
pub(super) fn whole(token: &[u8]) -> Option<i32> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// A logical: `T` or `F`, as Fortran writes it.
pub(super) fn logical(token: &[u8]) -> Option<bool> {
    match token {
        b"T" | b"t" => Some(true),
        b"F" | b"f" => Some(false),
        _ => None,
    }
}
