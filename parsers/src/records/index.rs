//! The index of a record file: headers, found by skipping over the data.

use super::{Entry, Kind, i32_at};
use crate::error::{At, ParseError};
use crate::mapped::MappedFile;

/// Elements in a block by convention: numbers, strings.
const NUMBERS_A_BLOCK: u64 = 1000;
const STRINGS_A_BLOCK: u64 = 105;
/// Header record with its markers.
const HEADER: u64 = 24;
/// Count of a header that announces a multiple of 2^31 elements for the next header.
const X231: &[u8] = b"X231";

/// The complete arrays from the start, and what stopped the indexing before the end.
pub(super) fn index(file: &MappedFile) -> (Vec<Entry>, Option<ParseError>) {
    let bytes = file.bytes();
    let mut entries = Vec::new();
    let mut at = 0;
    let wrong = |at: u64, keyword: &str, message: String| {
        Some(ParseError::new(file.path(), At::Byte(at), keyword, message))
    };
    if bytes.is_empty() {
        return (entries, wrong(0, "", "the file is empty".into()));
    }
    let mut high_count = 0u64;
    while at < bytes.len() as u64 {
        let header = match header(bytes, at) {
            Ok(header) => header,
            // The array before it is to blame as often as the header itself.
            Err(message) => {
                let before = entries
                    .last()
                    .map_or(String::new(), |e: &Entry| e.name().to_owned());
                let place = if before.is_empty() {
                    message
                } else {
                    format!("behind it: {message}")
                };
                return (entries, wrong(at, &before, place));
            }
        };
        let (name, count, kind) = header;
        let text = String::from_utf8_lossy(name).trim_end().to_owned();
        if kind == X231 {
            high_count = u64::from(count.unsigned_abs()) << 31;
            at += HEADER;
            continue;
        }
        let Some(kind) = Kind::parse(kind) else {
            let message = format!("unknown type {}", String::from_utf8_lossy(kind));
            return (entries, wrong(at, &text, message));
        };
        let Ok(low) = u64::try_from(count) else {
            return (entries, wrong(at, &text, format!("has a count of {count}")));
        };
        let count = high_count + low;
        high_count = 0;
        let data = at + HEADER;
        match data_end(bytes, data, count, kind) {
            Ok(end) => {
                let mut padded = [b' '; 8];
                padded.copy_from_slice(name);
                entries.push(Entry {
                    name: padded,
                    kind,
                    count,
                    offset: at,
                    data,
                    end,
                });
                at = end;
            }
            Err((place, message)) => return (entries, wrong(place, &text, message)),
        }
    }
    (entries, None)
}

type Header<'a> = (&'a [u8], i32, &'a [u8]);

fn header(bytes: &[u8], at: u64) -> Result<Header<'_>, String> {
    let start = usize::try_from(at).map_err(|e| e.to_string())?;
    let record = bytes
        .get(start..)
        .and_then(|rest| rest.get(..HEADER as usize))
        .ok_or_else(|| {
            format!(
                "the file ends within a header; {} bytes are left of {HEADER}",
                bytes.len() - start
            )
        })?;
    let not_a_header = || {
        "this is not an array header; the file is no Eclipse binary file or is damaged".to_owned()
    };
    if i32_at(record, 0) != Some(16) || i32_at(record, 20) != Some(16) || !record[4..12].is_ascii()
    {
        return Err(not_a_header());
    }
    let count = i32_at(record, 12).ok_or_else(not_a_header)?;
    Ok((&record[4..12], count, &record[16..20]))
}

/// Where the data records of an array end.
fn data_end(bytes: &[u8], data: u64, count: u64, kind: Kind) -> Result<u64, (u64, String)> {
    let total = count
        .checked_mul(kind.size())
        .filter(|t| *t <= bytes.len() as u64);
    let Some(total) = total else {
        let left = (bytes.len() as u64).saturating_sub(data);
        return Err((
            data,
            format!("{count} values do not fit in the {left} bytes that follow"),
        ));
    };
    if total == 0 {
        return Ok(data);
    }
    if let Some(end) = conventional_end(bytes, data, total, kind) {
        return Ok(end);
    }
    let (mut at, mut left) = (data, total);
    while left > 0 {
        let missing = |what: &str| {
            (
                at,
                format!(
                    "the file ends or is damaged within the data: {what}; {left} bytes of values are missing"
                ),
            )
        };
        let length = i32_at(bytes, at).ok_or_else(|| missing("no block length"))?;
        let length = u64::try_from(length)
            .ok()
            .filter(|l| (1..=left).contains(l) && l % kind.size() == 0)
            .ok_or_else(|| missing(&format!("a block of {length} bytes")))?;
        if i32_at(bytes, at + 4 + length) != Some(length as i32) {
            return Err(missing("the two lengths of a block differ"));
        }
        at += 8 + length;
        left -= length;
    }
    Ok(at)
}

/// The end by the conventional block sizes, where first and last block and what follows agree
/// with them; so that indexing touches only a page or two of each array.
fn conventional_end(bytes: &[u8], data: u64, total: u64, kind: Kind) -> Option<u64> {
    let block = kind.size()
        * if matches!(kind, Kind::Text(_)) {
            STRINGS_A_BLOCK
        } else {
            NUMBERS_A_BLOCK
        };
    let blocks = total.div_ceil(block);
    let last = total - (blocks - 1) * block;
    let end = data + total + 8 * blocks;
    let marker = |at: u64, length: u64| i32_at(bytes, at) == Some(length as i32);
    let agrees = marker(data, total.min(block))
        && marker(end - 4, last)
        && marker(end - 8 - last, last)
        && (end == bytes.len() as u64 || marker(end, 16));
    agrees.then_some(end)
}
