//! The index of a record file: headers, found by skipping over the data.

use super::store::{Store, Window};
use super::{Entry, Form, Kind, i32_at, text};
use crate::error::{ErrorKind, ParseError};

/// Header record with its markers.
pub(super) const HEADER: u64 = 24;
/// Type of a header whose count is minus the number of 2^31 elements to add to the next header's.
const X231: [u8; 4] = *b"X231";

/// What stopped the indexing.
pub(super) struct Fault {
    kind: ErrorKind,
    at: u64,
    keyword: String,
    message: String,
}

/// A header record.
#[derive(Clone, Copy)]
pub(super) struct Header {
    pub(super) name: [u8; 8],
    pub(super) count: i32,
    pub(super) kind: [u8; 4],
    /// Byte offset behind it.
    pub(super) behind: u64,
}

/// What is looked at: a binary file place by place, text as a whole.
enum Source<'a> {
    Binary(Window<'a>),
    Formatted(&'a [u8]),
}

/// The complete arrays from the start, and what stopped the indexing before the end.
pub(super) fn index(store: &Store, form: Form) -> (Vec<Entry>, Option<ParseError>) {
    let reader = match store.reader() {
        Ok(reader) => reader,
        Err(cause) => {
            let error = ParseError::io(store.path(), "cannot open", cause);
            return (Vec::new(), Some(error));
        }
    };
    let mut source = match form {
        Form::Binary => Source::Binary(Window::new(reader)),
        Form::Formatted => Source::Formatted(store.text()),
    };
    let (entries, fault) = entries(&mut source);
    if let Source::Binary(window) = source
        && let Some(cause) = window.failed()
    {
        let error = ParseError::io(store.path(), "cannot read", cause);
        return (entries, Some(error));
    }
    let error = fault.map(|fault| {
        let at = form.place(store.text(), fault.at);
        ParseError::of(fault.kind, store.path(), at, &fault.keyword, fault.message)
    });
    (entries, error)
}

fn entries(source: &mut Source<'_>) -> (Vec<Entry>, Option<Fault>) {
    let mut entries: Vec<Entry> = Vec::new();
    if source.length() == 0 {
        let empty = fault(ErrorKind::Truncated, 0, "the file is empty");
        return (entries, Some(empty));
    }
    let mut at = source.next(0);
    while at < source.length() {
        match array(source, at) {
            Ok(entry) => {
                at = source.next(entry.end);
                entries.push(entry);
            }
            Err(mut fault) => {
                // The array before it is to blame as often as the header itself.
                if let (true, Some(last)) = (fault.keyword.is_empty(), entries.last()) {
                    fault.keyword = last.name().to_owned();
                    fault.message = format!("after it: {}", fault.message);
                }
                return (entries, Some(fault));
            }
        }
    }
    (entries, None)
}

impl Source<'_> {
    fn length(&self) -> u64 {
        match self {
            Self::Binary(window) => window.length(),
            Self::Formatted(text) => text.len() as u64,
        }
    }

    /// Where the header stands that follows at `at`.
    fn next(&self, at: u64) -> u64 {
        match self {
            Self::Binary(_) => at,
            Self::Formatted(text) => {
                usize::try_from(at).map_or(at, |at| text::visible(text, at) as u64)
            }
        }
    }

    fn header(&mut self, at: u64) -> Result<Header, Fault> {
        match self {
            Self::Binary(window) => header(window, at),
            Self::Formatted(text) => text::header(text, at),
        }
    }

    fn data_end(&mut self, data: u64, count: u64, kind: Kind) -> Result<u64, Fault> {
        match self {
            Self::Binary(window) => data_end(window, data, count, kind),
            Self::Formatted(text) => text::data_end(text, data, count, kind),
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
fn array(source: &mut Source<'_>, at: u64) -> Result<Entry, Fault> {
    let first = source.header(at)?;
    let named = |mut fault: Fault| {
        fault.keyword = String::from_utf8_lossy(&first.name).into_owned();
        fault
    };
    let wrong = |message: String| Err(named(fault(ErrorKind::Malformed, at, message)));
    let (high, second) = match first.kind {
        X231 => match u64::try_from(-i64::from(first.count)) {
            Ok(multiple) => {
                let at = source.next(first.behind);
                let second = source.header(at).map_err(named)?;
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
    let Some(kind) = Kind::parse(&second.kind) else {
        let kind = String::from_utf8_lossy(&second.kind);
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
    let end = source.data_end(data, count, kind).map_err(named)?;
    Ok(Entry {
        name: first.name,
        kind,
        count,
        offset: at,
        data,
        end,
    })
}

fn header(window: &mut Window<'_>, at: u64) -> Result<Header, Fault> {
    let rest = window.at(at, HEADER as usize);
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
            kind: record[16..20].try_into().unwrap_or_default(),
            behind: at + HEADER,
        }),
        _ => Err(damaged()),
    }
}

/// Where the data records of an array end.
fn data_end(window: &mut Window<'_>, data: u64, count: u64, kind: Kind) -> Result<u64, Fault> {
    let length = window.length();
    let Some(total) = count.checked_mul(kind.size()) else {
        let message = format!("a count of {count} is not possible");
        return Err(fault(ErrorKind::TooLarge, data, message));
    };
    if total == 0 {
        // Conventionally nothing follows; some writers put an empty record.
        let empty = window.at(data, 8) == [0; 8];
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
    match conventional_end(window, data, total, kind) {
        Some(end) => Ok(end),
        None => walk(window, data, total, kind.size(), too_short),
    }
}

/// The end by the conventional block sizes, where first and last block and what follows agree
/// with them; so that indexing touches only a page or two of each array.
fn conventional_end(window: &mut Window<'_>, data: u64, total: u64, kind: Kind) -> Option<u64> {
    let block = kind.size() * kind.block();
    let blocks = total.div_ceil(block);
    let last = total - (blocks - 1) * block;
    let end = data + total + 8 * blocks;
    let mut agrees = |at: u64, length: u64| window.i32(at).map(i64::from) == Some(length as i64);
    // In the order of the file, so that the end of the array is looked at in one piece.
    let agrees = agrees(data, total.min(block))
        && agrees(end - 8 - last, last)
        && agrees(end - 4, last)
        && (end == window.length() || header(window, end).is_ok());
    agrees.then_some(end)
}

/// The end by following the markers block by block.
fn walk(
    window: &mut Window<'_>,
    data: u64,
    total: u64,
    size: u64,
    too_short: impl Fn(u64) -> Fault,
) -> Result<u64, Fault> {
    let (mut at, mut left) = (data, total);
    while left > 0 {
        // With at least one more block, and its two markers.
        let needed = at - data + left + 8;
        let Some(marker) = window.i32(at) else {
            return Err(too_short(needed));
        };
        let block = u64::try_from(marker).ok();
        let Some(block) = block.filter(|b| (1..=left).contains(b) && b % size == 0) else {
            let message = format!(
                "a block of {marker} bytes does not fit here, where {left} bytes of values are due; the file is damaged"
            );
            return Err(fault(ErrorKind::Malformed, at, message));
        };
        match window.i32(at + 4 + block) {
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
