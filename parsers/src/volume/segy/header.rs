//! The binary header of a SEG-Y file: how its traces stand in it.

use super::super::sample::{ByteOrder, SampleType};
use super::super::source::Source;
use super::text;
use crate::error::{At, ErrorKind, ParseError};

/// Where traces begin, without further text headers.
pub(super) const HEADERS: u64 = 3600;
/// Bytes of the header of a trace.
pub(super) const TRACE_HEADER: u64 = 240;
/// Text headers of which the number is not told are looked for in so many places.
const MOST_HEADERS: u64 = 1000;

/// What the binary header says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Header {
    pub(super) order: ByteOrder,
    pub(super) sample: SampleType,
    /// Code of the type of samples.
    pub(super) code: u16,
    /// Major and minor number.
    pub(super) revision: [u8; 2],
    /// Microseconds, or thousandths of a meter or foot; zero where it is not told.
    pub(super) interval: f64,
    /// Samples of a trace; zero where it is not told.
    pub(super) samples: u64,
    /// 1: meters, 2: feet.
    pub(super) measurement: u16,
    /// Where traces begin.
    pub(super) start: u64,
    /// Where they end.
    pub(super) end: u64,
}

fn sample_type(code: u16) -> Option<SampleType> {
    Some(match code {
        1 => SampleType::Ibm32,
        2 => SampleType::I32,
        3 => SampleType::I16,
        5 => SampleType::F32,
        6 => SampleType::F64,
        7 => SampleType::I24,
        8 => SampleType::I8,
        9 => SampleType::I64,
        10 => SampleType::U32,
        11 => SampleType::U16,
        12 => SampleType::U64,
        15 => SampleType::U24,
        16 => SampleType::U8,
        _ => return None,
    })
}

/// The code of a type of samples.
pub(super) fn code(sample: SampleType) -> u16 {
    let mut codes = 1..=16;
    codes
        .find(|code| sample_type(*code) == Some(sample))
        .unwrap_or(1)
}

/// Bytes of a header, told by their numbers from 1 as the definition of the format does.
pub(super) struct Bytes<'a> {
    pub(super) bytes: &'a [u8],
    /// Number of the first byte.
    pub(super) first: usize,
    pub(super) order: ByteOrder,
}

impl Bytes<'_> {
    fn get<const N: usize>(&self, number: usize) -> [u8; N] {
        let start = number - self.first;
        let found = self
            .bytes
            .get(start..)
            .and_then(|bytes| bytes.first_chunk());
        let mut bytes: [u8; N] = *found.unwrap_or(&[0; N]);
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    pub(super) fn u16(&self, number: usize) -> u16 {
        u16::from_le_bytes(self.get(number))
    }

    pub(super) fn i16(&self, number: usize) -> i16 {
        i16::from_le_bytes(self.get(number))
    }

    pub(super) fn i32(&self, number: usize) -> i32 {
        i32::from_le_bytes(self.get(number))
    }

    fn u64(&self, number: usize) -> u64 {
        u64::from_le_bytes(self.get(number))
    }

    fn f64(&self, number: usize) -> f64 {
        f64::from_le_bytes(self.get(number))
    }
}

/// Order of bytes: as rev 2 tells it, else that in which the code of the samples is one.
fn byte_order(source: &Source, binary: &[u8]) -> Result<ByteOrder, ParseError> {
    match binary[96..100] {
        [1, 2, 3, 4] => return Ok(ByteOrder::Big),
        [4, 3, 2, 1] => return Ok(ByteOrder::Little),
        [2, 1, 4, 3] => {
            let message = "numbers with their bytes swapped in pairs are not read: swap them";
            return Err(source.error(ErrorKind::Unsupported, At::Byte(3296), "SEG-Y", message));
        }
        _ => {}
    }
    let is_known = |order| {
        sample_type(
            Bytes {
                bytes: binary,
                first: 3201,
                order,
            }
            .u16(3225),
        )
        .is_some()
    };
    if !is_known(ByteOrder::Big) && is_known(ByteOrder::Little) {
        return Ok(ByteOrder::Little);
    }
    Ok(ByteOrder::Big)
}

/// True where the headers are those of a SEG-Y file: text, and a code of samples.
pub(in super::super) fn is_header(source: &Source, head: &[u8]) -> bool {
    let (Some(letters), Some(binary)) = (head.get(..text::LENGTH), head.get(text::LENGTH..3600))
    else {
        return false;
    };
    if !text::is_text(letters) {
        return false;
    }
    byte_order(source, binary).is_ok_and(|order| {
        let bytes = Bytes {
            bytes: binary,
            first: 3201,
            order,
        };
        sample_type(bytes.u16(3225)).is_some()
    })
}

/// Where the extended text headers end: after `count` of them, or after the one that says so where it is negative.
fn behind_text(source: &Source, count: i16) -> Result<u64, ParseError> {
    if let Ok(count) = u64::try_from(count) {
        return Ok(HEADERS + count * text::LENGTH as u64);
    }
    let mut letters = vec![0; text::LENGTH];
    for n in 0..MOST_HEADERS {
        let start = HEADERS + n * text::LENGTH as u64;
        if start + text::LENGTH as u64 > source.length() {
            break;
        }
        source.read(start, &mut letters)?;
        let lines = text::lines(&letters).concat().to_ascii_lowercase();
        if lines.replace(' ', "").contains("((seg:endtext))") {
            return Ok(start + text::LENGTH as u64);
        }
    }
    let message = "no extended text header is the last one, ((SEG: EndText))";
    Err(source.error(ErrorKind::Malformed, At::Byte(3504), "SEG-Y", message))
}

/// Major and minor number: two bytes, or a number of 16 bits with 8 of them behind the point.
fn revision(binary: &[u8; 400], order: ByteOrder) -> [u8; 2] {
    match (order, [binary[300], binary[301]]) {
        (_, [major @ 1..=2, minor]) => [major, minor],
        // Written as whole numbers, or with the bytes of a number turned.
        (ByteOrder::Little, [minor, major @ 1..=2]) => [major, minor],
        (ByteOrder::Big, [0, major @ 1..=2]) => [major, 0],
        _ => [0, 0],
    }
}

pub(super) fn read(source: &Source, forced: Option<ByteOrder>) -> Result<Header, ParseError> {
    let cut = |message: &str| source.error(ErrorKind::Truncated, At::File, "SEG-Y", message);
    if source.length() < HEADERS + TRACE_HEADER {
        return Err(cut("the file ends before its first trace"));
    }
    let mut binary = [0; 400];
    source.read(text::LENGTH as u64, &mut binary)?;
    let order = match forced {
        Some(order) => order,
        None => byte_order(source, &binary)?,
    };
    let bytes = Bytes {
        bytes: &binary,
        first: 3201,
        order,
    };
    let code = bytes.u16(3225);
    let sample = sample_type(code).ok_or_else(|| {
        let message = format!(
            "samples of the format code {code} are not read: codes are 1 (IBM), 2, 3, 5 (IEEE), 6, 7, 8, 9, 10, 11, 12, 15, 16; is the order of bytes another one?"
        );
        source.error(ErrorKind::Unsupported, At::Byte(3224), "SEG-Y", message)
    })?;
    let revision = revision(&binary, order);
    // What rev 0 has there means nothing.
    let texts = if revision[0] > 0 { bytes.i16(3505) } else { 0 };
    let mut header = Header {
        order,
        sample,
        code,
        revision,
        interval: f64::from(bytes.u16(3217)),
        samples: u64::from(bytes.u16(3221)),
        measurement: bytes.u16(3255),
        start: behind_text(source, texts)?,
        end: source.length(),
    };
    if revision[0] >= 2 {
        extended(source, &bytes, &mut header)?;
    }
    if header.start.saturating_add(TRACE_HEADER) > header.end {
        return Err(cut("the file ends before its first trace"));
    }
    Ok(header)
}

/// What rev 2 says in more bytes.
fn extended(source: &Source, bytes: &Bytes, header: &mut Header) -> Result<(), ParseError> {
    if bytes.i32(3507) > 0 {
        let message = "traces with more than one header are not read: write the file as rev 1";
        return Err(source.error(ErrorKind::Unsupported, At::Byte(3506), "SEG-Y", message));
    }
    if let Some(samples) = u64::try_from(bytes.i32(3269)).ok().filter(|n| *n > 0) {
        header.samples = samples;
    }
    let interval = bytes.f64(3273);
    if interval.is_finite() && interval > 0.0 {
        header.interval = interval;
    }
    if bytes.u64(3521) > 0 {
        header.start = bytes.u64(3521);
    }
    if let Ok(trailers) = u64::try_from(bytes.i32(3529)) {
        header.end = header.end.saturating_sub(trailers * text::LENGTH as u64);
    }
    let length =
        TRACE_HEADER.saturating_add(header.samples.saturating_mul(header.sample.size() as u64));
    let traces = bytes.u64(3513);
    if traces > 0 {
        let end = traces.saturating_mul(length).saturating_add(header.start);
        if end > header.end {
            let message = format!("the file ends before its {traces} traces of {length} bytes");
            return Err(source.error(ErrorKind::Truncated, At::File, "SEG-Y", message));
        }
        header.end = end;
    }
    Ok(())
}
