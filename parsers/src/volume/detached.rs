//! Samples in other files than their header: one, a list of them, or files that are numbered.

use std::path::PathBuf;

use super::source::Source;
use super::store::{Packing, Span, Store};
use crate::error::{At, ErrorKind, ParseError};

/// More files are no volume.
const MOST_FILES: usize = 1 << 16;

/// How the samples stand in each file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placing {
    /// Lines before the samples.
    pub(super) lines: u64,
    /// Bytes before the samples, once inflated; `None`: the samples end where the file ends.
    pub(super) bytes: Option<u64>,
    pub(super) packing: Option<Packing>,
}

/// Where the samples of `source` begin, from `start` on, behind the lines that are skipped.
pub(super) fn skip_lines(source: &Source, mut start: u64, lines: u64) -> Result<u64, ParseError> {
    let mut buffer = vec![0; 1 << 16];
    let mut left = lines;
    while left > 0 {
        let count = source
            .length()
            .saturating_sub(start)
            .min(buffer.len() as u64) as usize;
        if count == 0 {
            let message = format!("ends before the {lines} lines that are to be skipped");
            return Err(source.error(ErrorKind::Truncated, At::File, "", message));
        }
        source.read(start, &mut buffer[..count])?;
        let mut ends = buffer[..count]
            .iter()
            .enumerate()
            .filter(|(_, b)| **b == b'\n');
        let ends = ends.by_ref().take(left as usize).map(|(n, _)| n);
        let (found, last) = ends.fold((0, None), |(found, _), n| (found + 1, Some(n)));
        left -= found;
        start += match last {
            Some(n) if left == 0 => n as u64 + 1,
            _ => count as u64,
        };
    }
    Ok(start)
}

/// The bytes of samples in one file, from `start` on.
pub(super) fn store(
    source: &Source,
    start: u64,
    length: u64,
    placing: Placing,
) -> Result<Store, ParseError> {
    let start = skip_lines(source, start, placing.lines)?;
    if let Some(packing) = placing.packing {
        let skip = placing.bytes.unwrap_or(0);
        return Store::stream(packing, source, start, skip, length);
    }
    let start = match placing.bytes {
        Some(bytes) => start.saturating_add(bytes),
        None => source.length().saturating_sub(length).max(start),
    };
    let span = Span {
        source: source.clone(),
        start,
        is_base64: false,
    };
    Store::plain(span, length)
}

/// The files that a header names, from its folder on.
pub(super) fn files(
    header: &Source,
    names: &[String],
    at: At,
    keyword: &str,
) -> Result<Vec<PathBuf>, ParseError> {
    let refuse = |kind, message: String| Err(header.error(kind, at, keyword, message));
    if names.is_empty() || names.iter().any(|name| name.trim().is_empty()) {
        return refuse(ErrorKind::BadValue, "names no file".into());
    }
    let Some(folder) = header.folder() else {
        let message = format!(
            "the samples stand in another file, {}: open the header from its folder",
            names[0]
        );
        return refuse(ErrorKind::Unsupported, message);
    };
    Ok(names.iter().map(|name| folder.join(name.trim())).collect())
}

/// The bytes of samples that stand in `files`, each of which has as many.
pub(super) fn parts(
    header: &Source,
    files: &[PathBuf],
    length: u64,
    placing: Placing,
) -> Result<Store, ParseError> {
    if let [file] = files {
        return store(&Source::open(file)?, 0, length, placing);
    }
    let count = files.len() as u64;
    if count == 0 || files.len() > MOST_FILES || !length.is_multiple_of(count) {
        let message = format!("{length} bytes of samples do not stand in {count} files alike");
        return Err(header.error(ErrorKind::WrongCount, At::File, "", message));
    }
    let part = length / count;
    let stores = files
        .iter()
        .map(|file| store(&Source::open_one_of_many(file)?, 0, part, placing));
    Ok(Store::Parts(stores.collect::<Result<_, _>>()?, part))
}

/// Names of a pattern such as `slice%03d.raw` for the numbers of a range; `None` where there is no pattern, or no end.
pub(super) fn numbered(pattern: &str, [first, last, step]: [i64; 3]) -> Option<Vec<String>> {
    let (before, rest) = pattern.split_once('%')?;
    let (format, after) = rest.split_once('d')?;
    let width: usize = match format {
        "" => 0,
        digits => digits.parse().ok().filter(|width| *width <= 20)?,
    };
    let count = last.checked_sub(first)?.checked_div(step)?.checked_add(1)?;
    if count < 1 || count > MOST_FILES as i64 {
        return None;
    }
    let is_zero = format.starts_with('0');
    let name = |n: i64| {
        let number = first + n * step;
        match is_zero {
            true => format!("{before}{number:0width$}{after}"),
            false => format!("{before}{number:width$}{after}"),
        }
    };
    Some((0..count).map(name).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::FileBytes;

    #[test]
    fn names_by_numbers() {
        let names = numbered("a%03d.raw", [9, 11, 1]).unwrap();
        assert_eq!(names, ["a009.raw", "a010.raw", "a011.raw"]);
        assert_eq!(numbered("a%d", [4, 0, -2]).unwrap(), ["a4", "a2", "a0"]);
        for (pattern, range) in [
            ("a", [1, 2, 1]),
            ("a%d", [1, 2, 0]),
            ("a%d", [2, 1, 1]),
            ("a%d", [0, i64::MAX, 1]),
            ("a%999999999d", [1, 2, 1]),
        ] {
            assert_eq!(numbered(pattern, range), None, "{pattern} {range:?}");
        }
    }

    #[test]
    fn lines_before_samples() {
        let text = format!("a\n{}\nend", "b".repeat(100_000));
        let length = text.len() as u64;
        let source = Source::from(FileBytes::from(("A", text)));
        assert_eq!(skip_lines(&source, 0, 0).unwrap(), 0);
        assert_eq!(skip_lines(&source, 0, 1).unwrap(), 2);
        assert_eq!(skip_lines(&source, 0, 2).unwrap(), length - 3);
        let error = skip_lines(&source, 0, 3).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Truncated);
    }
}
