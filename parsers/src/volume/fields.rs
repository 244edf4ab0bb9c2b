//! Headers of text: a line for each field, `key: value` or `key = value`.

use std::str::FromStr;

use super::lattice;
use super::source::Source;
use crate::error::{At, ErrorKind, ParseError};

/// A field of a header.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub(super) key: String,
    pub(super) value: String,
    /// From 1.
    pub(super) line: usize,
}

/// The lines of a header, and where each ends.
pub(super) fn lines(head: &[u8]) -> impl Iterator<Item = (String, u64)> {
    let mut end = 0;
    head.split_inclusive(|byte| *byte == b'\n')
        .map(move |line| {
            end += line.len() as u64;
            let text = String::from_utf8_lossy(line);
            (text.trim_end_matches(['\r', '\n']).to_owned(), end)
        })
}

/// The fields of a header.
#[derive(Debug)]
pub(super) struct Fields<'a> {
    pub(super) source: &'a Source,
    pub(super) all: Vec<Field>,
}

impl Fields<'_> {
    /// The first field of a key, whatever its letter case.
    pub(super) fn find(&self, key: &str) -> Option<&Field> {
        self.all
            .iter()
            .find(|field| field.key.eq_ignore_ascii_case(key))
    }

    /// The value of a field, empty where there is none.
    pub(super) fn text(&self, key: &str) -> &str {
        self.find(key).map_or("", |field| &field.value)
    }

    pub(super) fn need(&self, key: &str) -> Result<&Field, ParseError> {
        self.find(key).ok_or_else(|| {
            let kind = ErrorKind::MissingKeyword;
            self.source
                .error(kind, At::File, key, "is missing in the header")
        })
    }

    pub(super) fn error(
        &self,
        kind: ErrorKind,
        field: &Field,
        message: impl Into<String>,
    ) -> ParseError {
        let at = At::Line {
            line: field.line,
            column: 1,
        };
        self.source.error(kind, at, &field.key, message)
    }

    /// Numbers between blanks or commas.
    pub(super) fn numbers<T: FromStr>(&self, field: &Field) -> Result<Vec<T>, ParseError> {
        let words = field
            .value
            .split(|c: char| c.is_whitespace() || c == ',')
            .filter(|word| !word.is_empty());
        let numbers = words.map(|word| {
            word.parse().map_err(|_| {
                let message = format!("'{word}' is no number that can stand there");
                self.error(ErrorKind::BadValue, field, message)
            })
        });
        numbers.collect()
    }

    /// The numbers of a key, `count` of them; `None` where it is missing.
    pub(super) fn some<T: FromStr>(
        &self,
        key: &str,
        count: usize,
    ) -> Result<Option<Vec<T>>, ParseError> {
        let Some(field) = self.find(key) else {
            return Ok(None);
        };
        let numbers = self.numbers(field)?;
        if numbers.len() != count {
            let message = format!("expected {count} numbers, found {}", numbers.len());
            return Err(self.error(ErrorKind::WrongCount, field, message));
        }
        Ok(Some(numbers))
    }

    /// A whole number, or `default` where the key is missing.
    pub(super) fn whole<T: FromStr>(&self, key: &str, default: T) -> Result<T, ParseError> {
        let number = self
            .some(key, 1)?
            .and_then(|numbers| numbers.into_iter().next());
        Ok(number.unwrap_or(default))
    }

    /// Sizes of a lattice, padded with ones to three.
    pub(super) fn dims(
        &self,
        field: &Field,
        sizes: &[u64],
    ) -> Result<([usize; 3], u64), ParseError> {
        let mut dims = [1; 3];
        for (dim, size) in dims.iter_mut().zip(sizes) {
            *dim = *size;
        }
        lattice::samples(dims).ok_or_else(|| {
            let [ni, nj, nk] = dims;
            let message =
                format!("no volume of {ni} x {nj} x {nk} samples can be addressed on this machine");
            self.error(ErrorKind::TooLarge, field, message)
        })
    }

    /// Checks that there is such a component.
    pub(super) fn check_component(
        &self,
        field: &Field,
        component: usize,
        count: usize,
    ) -> Result<(), ParseError> {
        if component < count {
            return Ok(());
        }
        let message =
            format!("samples have {count} components: there is no component {component} (from 0)");
        Err(self.error(ErrorKind::BadValue, field, message))
    }
}
