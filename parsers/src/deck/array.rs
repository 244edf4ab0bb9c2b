//! Long arrays of numbers, converted in parallel.
//!
//! The text is cut at line ends, so that no piece starts inside a comment. Each piece becomes
//! values with repeat counts beside them; only when the sum of all counts is known to be right
//! is the array itself allocated, so no repeat count can ask for memory on its own.

use super::lexer::{Mistake, is_undefined, line_end, repeat, shown, token_end};
use super::numbers::{leading_number, number, sixteen_bytes, visible};
use crate::error::ErrorKind;
use crate::geometry::zeros;
use crate::parallel;

/// Bytes of text a thread converts at a time: small against the caches, large against the cost of a task.
const PIECE: usize = 1 << 18;
/// Short tokens with their blanks, for sizing a piece's values; unused memory of it is never touched.
const BYTES_PER_VALUE: usize = 4;

/// What stands for a defaulted value (`*`, `3*`) and for one that is no finite number; `None` refuses it.
#[derive(Clone, Copy)]
pub(super) struct Rule {
    pub(super) default: Option<f64>,
    pub(super) undefined: Option<f64>,
}

/// An array as written, repeat counts not yet expanded.
pub(super) struct Runs {
    pieces: Vec<Piece>,
    /// Number of values after expansion, saturating.
    pub(super) count: usize,
}

#[derive(Default)]
struct Piece {
    values: Vec<f64>,
    /// Index into `values` and how many times that value stands there, for those that are repeated.
    repeats: Vec<(usize, usize)>,
    /// Number of values after expansion; while reading, what repeats add to the values.
    count: usize,
}

/// Reads all numbers of `data`; a mistake's place counts from the start of `data`.
pub(super) fn runs(data: &[u8], rule: Rule) -> Result<Runs, Mistake> {
    let pieces = parallel::map(cut(data), |(start, text)| {
        piece(text, rule).map_err(|mistake| mistake.moved(start))
    });
    let pieces = pieces.into_iter().collect::<Result<Vec<Piece>, _>>()?;
    let count = pieces
        .iter()
        .fold(0, |sum: usize, piece| sum.saturating_add(piece.count));
    Ok(Runs { pieces, count })
}

impl Runs {
    /// An array that is numbers already.
    ///
    /// # Errors
    /// When a value is undefined and must not be.
    pub(super) fn of(mut values: Vec<f64>, rule: Rule) -> Result<Self, String> {
        for (index, value) in values.iter_mut().enumerate() {
            if !value.is_finite() {
                let number = index + 1;
                let undefined = rule.undefined;
                *value = undefined.ok_or_else(|| format!("value {number} is not finite"))?;
            }
        }
        let count = values.len();
        let piece = Piece {
            values,
            repeats: Vec::new(),
            count,
        };
        let pieces = vec![piece];
        Ok(Self { pieces, count })
    }

    /// The array with repeat counts expanded; `None` where there is not enough memory.
    pub(super) fn expand(self) -> Option<Vec<f64>> {
        let mut array = zeros(self.count)?;
        let mut rest = array.as_mut_slice();
        let mut parts = Vec::with_capacity(self.pieces.len());
        for piece in self.pieces {
            let (part, behind) = rest.split_at_mut(piece.count);
            parts.push((piece, part));
            rest = behind;
        }
        parallel::map(parts, |(piece, part)| piece.expand_into(part));
        Some(array)
    }
}

impl Piece {
    fn expand_into(&self, part: &mut [f64]) {
        let (mut from, mut to) = (0, 0);
        for &(index, count) in &self.repeats {
            let plain = index - from;
            part[to..to + plain].copy_from_slice(&self.values[from..index]);
            part[to + plain..to + plain + count].fill(self.values[index]);
            (from, to) = (index + 1, to + plain + count);
        }
        part[to..].copy_from_slice(&self.values[from..]);
    }

    fn push(&mut self, value: f64, count: usize) {
        if count > 1 {
            self.repeats.push((self.values.len(), count));
            self.count = self.count.saturating_add(count - 1);
        }
        self.values.push(value);
    }
}

/// Pieces of about [`PIECE`] bytes, each ending at a line end, with their offsets.
fn cut(data: &[u8]) -> Vec<(usize, &[u8])> {
    let mut pieces = Vec::with_capacity(data.len() / PIECE + 1);
    let mut start = 0;
    while start < data.len() {
        let end = line_end(data, (start + PIECE).min(data.len()));
        pieces.push((start, &data[start..end]));
        start = end;
    }
    pieces
}

fn piece(text: &[u8], rule: Rule) -> Result<Piece, Mistake> {
    let mut piece = Piece::default();
    piece.values.reserve(text.len() / BYTES_PER_VALUE);
    let mut at = 0;
    while let Some(start) = next_token(text, at) {
        if let Some((value, length)) = leading_number(&text[start..]) {
            piece.values.push(value);
            at = start + length;
        } else if let Some((count, value, length)) = repeated_number(&text[start..]) {
            piece.push(value, count);
            at = start + length;
        } else {
            at = unusual_token(text, start, rule, &mut piece)?;
        }
    }
    piece.count = piece.count.saturating_add(piece.values.len());
    Ok(piece)
}

/// The first byte at or behind `at` that is no blank.
#[inline]
fn next_token(text: &[u8], mut at: usize) -> Option<usize> {
    // One blank between values is so common that guessing it beats computing it.
    if text.get(at).is_some_and(|&byte| byte <= b' ')
        && text.get(at + 1).is_some_and(|&byte| byte > b' ')
    {
        return Some(at + 1);
    }
    while at < text.len() {
        let visible = visible(sixteen_bytes(text, at));
        at += (visible.trailing_zeros() / 8) as usize;
        if visible != 0 {
            return Some(at);
        }
    }
    None
}

/// A number behind a repeat count of at most 8 digits, and the length of both, where
/// [`leading_number`] can read it: corner depths of neighbors are often equal in pairs.
#[inline]
fn repeated_number(text: &[u8]) -> Option<(usize, f64, usize)> {
    let digits = text.iter().take(9).position(|b| !b.is_ascii_digit())?;
    let (count, behind) = text.split_at(digits);
    let number = behind.strip_prefix(b"*")?;
    let count = count.iter().fold(0, |n, d| 10 * n + usize::from(d - b'0'));
    let (value, length) = leading_number(number)?;
    (count > 0).then_some((count, value, digits + 1 + length))
}

/// Reads a comment, a repeat count, a number in another notation; returns the offset behind it.
#[cold]
fn unusual_token(
    text: &[u8],
    start: usize,
    rule: Rule,
    piece: &mut Piece,
) -> Result<usize, Mistake> {
    if text[start..].starts_with(b"--") {
        return Ok(line_end(text, start));
    }
    let end = token_end(text, start);
    let token = &text[start..end];
    let (count, written) = repeat(token).map_err(|mistake| mistake.moved(start))?;
    let value = if written.is_empty() {
        rule.default.ok_or_else(|| {
            Mistake::new(
                ErrorKind::BadValue,
                start,
                "a defaulted value (*) is not allowed here",
            )
        })?
    } else {
        value(written, rule).map_err(|message| Mistake::new(ErrorKind::BadValue, start, message))?
    };
    piece.push(value, count);
    Ok(end)
}

fn value(token: &[u8], rule: Rule) -> Result<f64, String> {
    let shown = shown(token);
    match number(token) {
        Some(value) if value.is_finite() => Ok(value),
        None if !is_undefined(token) => Err(format!("'{shown}' is not a number")),
        _ => rule
            .undefined
            .ok_or_else(|| format!("'{shown}' is not a finite number")),
    }
}
