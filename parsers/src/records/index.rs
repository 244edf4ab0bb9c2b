//! The index of a record file: headers, found by skipping over the data.

use super::{Entry, Form, Kind, i32_at, text};
use crate::bytes::FileBytes;
use crate::error::{ErrorKind, ParseError};

/// Header record with its markers.
const HEADER: u64 = 24;
/// Type of a header whose count is minus the number of 2^31 elements to add to the next header's.
const X231: &[u8] = b"X231";

/// What stopped the indexing.
pub(super) struct Fault {
    kind: ErrorKind,
    at: u64,
    keyword: String,
    message: String,
}

/// A header record.
#[derive(Clone, Copy)]
pub(super) struct Header<'a> {
    pub(super) name: [u8; 8],
    pub(super) count: i32,
    pub(super) kind: &'a [u8],
    /// Byte offset behind it.
    pub(super) behind: u64,
}

/// The complete arrays from the start, and what stopped the indexing before the end.
pub(super) fn index(file: &FileBytes, form: Form) -> (Vec<Entry>, Option<ParseError>) {
    let bytes = file.bytes();
    let mut entries = Vec::new();
    let stop = |f: Fault| {
        let at = form.place(bytes, f.at);
        ParseError::of(f.kind, file.path(), at, &f.keyword, f.message)
    };
    if bytes.is_empty() {
        return (
            entries,
            Some(stop(fault(ErrorKind::Truncated, 0, "the file is empty"))),
        );
    }
    let mut at = form.next(bytes, 0);
    while at < bytes.len() as u64 {
        match array(bytes, at, form) {
            Ok(entry) => {
                at = form.next(bytes, entry.end);
                entries.push(entry);
            }
            Err(mut fault) => {
                // The array before it is to blame as often as the header itself.
                if let (true, Some(last)) = (fault.keyword.is_empty(), entries.last()) {
                    fault.keyword = last.name().to_owned();
                    fault.message = format!("after it: {}", fault.message);
                }
                return (entries, Some(stop(fault)));
            }
        }
    }
    (entries, None)
}

impl Form {
    /// Where the header stands that follows at `at`.
    fn next(self, bytes: &[u8], at: u64) -> u64 {
        match self {
            Self::Binary => at,
            Self::Formatted => usize::try_from(at).map_or(at, |at| text::visible(bytes, at) as u64),
        }
    }

    fn header(self, bytes: &[u8], at: u64) -> Result<Header<'_>, Fault> {
        match self {
            Self::Binary => header(bytes, at),
            Self::Formatted => text::header(bytes, at),
        }
    }

    fn data_end(self, bytes: &[u8], data: u64, count: u64, kind: Kind) -> Result<u64, Fault> {
        match self {
            Self::Binary => data_end(bytes, data, count, kind),
            Self::Formatted => text::data_end(bytes, data, count, kind),
        }
    }
}

pub(super) fn fault(kind: ErrorKind, at: u64, message: impl Into<String>) -> Fault {
    Fault {
        kind,
        at,
        keyword: String::new(),
        message: message.into(),
    }
}

/// The array whose header is at `at`.
fn array(bytes: &[u8], at: u64, form: Form) -> Result<Entry, Fault> {
    let first = form.header(bytes, at)?;
    let named = |mut fault: Fault| {
        fault.keyword = String::from_utf8_lossy(&first.name).into_owned();
        fault
    };
    let wrong = |message: String| Err(named(fault(ErrorKind::Malformed, at, message)));
    let (high, second) = match first.kind {
        X231 => match u64::try_from(-i64::from(first.count)) {
            Ok(multiple) => {
                let at = form.next(bytes, first.behind);
                let second = form.header(bytes, at).map_err(named)?;
                (multiple << 31, second)
            }
            Err(_) => {
                let count = first.count;
                return wrong(format!(
                    "has an X231 count of {count}, which must not be positive; the file is damaged"
                ));
            }
        },
        _ => (0, first),
    };
    if second.name != first.name {
        return wrong("its X231 header is not followed by a second header of that name".into());
    }
    let Some(kind) = Kind::parse(second.kind) else {
        let kind = String::from_utf8_lossy(second.kind);
        return wrong(format!(
            "has the unknown type {kind:?}; the file is damaged"
        ));
    };
    let Ok(low) = u64::try_from(second.count) else {
        return wrong(format!(
            "has a count of {}; the file is damaged",
            second.count
        ));
    };
    let count = high + low;
    let data = second.behind;
    let end = form.data_end(bytes, data, count, kind).map_err(named)?;
    Ok(Entry {
        name: first.name,
        kind,
        count,
        offset: at,
        data,
        end,
    })
}

fn header(bytes: &[u8], at: u64) -> Result<Header<'_>, Fault> {
    let rest = usize::try_from(at).ok().and_then(|at| bytes.get(at..));
    let rest = rest.unwrap_or_default();
    let damaged = || {
        let message = "not an array header: this is neither a binary nor a formatted Eclipse file, or it is damaged";
        match at {
            0 => fault(ErrorKind::NotThisFormat, at, message),
            _ => fault(ErrorKind::Malformed, at, message),
        }
    };
    // A file that is cut short is told from one that is something else by the marker.
    let begins_well = i32_at(rest, 0).is_none_or(|marker| marker == 16);
    let Some(record) = rest.get(..HEADER as usize).filter(|_| begins_well) else {
        if !begins_well {
            return Err(damaged());
        }
        let missing = HEADER as usize - rest.len();
        let message = format!("the file ends within an array header, {missing} bytes too early");
        return Err(fault(ErrorKind::Truncated, at, message));
    };
    let name = record[4..12].try_into().unwrap_or_default();
    match (i32_at(record, 12), i32_at(record, 20)) {
        (Some(count), Some(16)) if record[4..12].is_ascii() => Ok(Header {
            name,
            count,
            kind: &record[16..20],
            behind: at + HEADER,
        }),
        _ => Err(damaged()),
    }
}

/// Where the data records of an array end.
fn data_end(bytes: &[u8], data: u64, count: u64, kind: Kind) -> Result<u64, Fault> {
    let length = bytes.len() as u64;
    let Some(total) = count.checked_mul(kind.size()) else {
        let message = format!("a count of {count} is not possible");
        return Err(fault(ErrorKind::TooLarge, data, message));
    };
    if total == 0 {
        // Conventionally nothing follows; some writers put an empty record.
        let empty = i32_at(bytes, data) == Some(0) && i32_at(bytes, data + 4) == Some(0);
        return Ok(if empty { data + 8 } else { data });
    }
    let too_short = |needed: u64| {
        let missing = needed.saturating_sub(length - data);
        let message = format!(
            "its {count} values take {needed} bytes and the file ends {missing} bytes too early"
        );
        fault(ErrorKind::Truncated, data, message)
    };
    // Before any arithmetic with the count: what follows in the file bounds it.
    if total > length - data {
        return Err(too_short(total.saturating_add(8)));
    }
    match conventional_end(bytes, data, total, kind) {
        Some(end) => Ok(end),
        None => walk(bytes, data, total, kind.size(), too_short),
    }
}

/// The end by the conventional block sizes, where first and last block and what follows agree
/// with them; so that indexing touches only a page or two of each array.
fn conventional_end(bytes: &[u8], data: u64, total: u64, kind: Kind) -> Option<u64> {
    let block = kind.size() * kind.block();
    let blocks = total.div_ceil(block);
    let last = total - (blocks - 1) * block;
    let end = data + total + 8 * blocks;
    let marker = |at: u64, length: u64| i32_at(bytes, at).map(i64::from) == Some(length as i64);
    let agrees = marker(data, total.min(block))
        && marker(end - 4, last)
        && marker(end - 8 - last, last)
        && (end == bytes.len() as u64 || header(bytes, end).is_ok());
    agrees.then_some(end)
}

/// The end by following the markers block by block.
fn walk(
    bytes: &[u8],
    data: u64,
    total: u64,
    size: u64,
    too_short: impl Fn(u64) -> Fault,
) -> Result<u64, Fault> {
    let (mut at, mut left) = (data, total);
    while left > 0 {
        // With at least one more block, and its two markers.
        let needed = at - data + left + 8;
        let Some(marker) = i32_at(bytes, at) else {
            return Err(too_short(needed));
        };
        let block = u64::try_from(marker).ok();
        let Some(block) = block.filter(|b| (1..=left).contains(b) && b % size == 0) else {
            let message = format!(
                "a block of {marker} bytes does not fit here, where {left} bytes of values are due; the file is damaged"
            );
            return Err(fault(ErrorKind::Malformed, at, message));
        };
        match i32_at(bytes, at + 4 + block) {
            None => return Err(too_short(needed)),
            Some(again) if again != marker => {
                let message = format!(
                    "the two lengths of a block differ ({marker} and {again}); the file is damaged"
                );
                return Err(fault(ErrorKind::Malformed, at, message));
            }
            Some(_) => {}
        }
        at += 8 + block;
        left -= block;
    }
    Ok(at)
}
