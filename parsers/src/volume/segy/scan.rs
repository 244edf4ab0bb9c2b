//! The headers of all traces, read side by side; samples are passed over.

use super::super::sample::ByteOrder;
use super::super::source::Source;
use super::SegyOptions;
use super::header::{Bytes, TRACE_HEADER};
use crate::error::ParseError;
use crate::parallel;

/// Traces that are shorter are read as a whole, many at a time: that is quicker than many short readings.
const SHORT: u64 = 4096;
const BUFFER: u64 = 1 << 20;

/// What is needed of the header of a trace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TraceHeader {
    pub(super) inline: i32,
    pub(super) crossline: i32,
    /// Number of the common depth point.
    pub(super) cdp: i32,
    /// Of the common depth point, or as the options say; before the scalar.
    pub(super) place: [i32; 2],
    pub(super) source_place: [i32; 2],
    pub(super) scalar: i16,
    /// 2 to 4: degrees, else lengths.
    pub(super) units: i16,
    /// 2: dead.
    pub(super) kind: i16,
    /// Samples and interval, zero where they are not told.
    pub(super) samples: u16,
    pub(super) interval: u16,
    /// Time of the first sample in ms.
    pub(super) delay: f32,
}

/// Scalars that the definition of the format allows; in rev 0 other things may stand there.
const SCALARS: [u16; 5] = [1, 10, 100, 1000, 10_000];

/// `value` by a scalar: a negative one divides, zero is none.
pub(super) fn scaled(value: f64, scalar: i16) -> f64 {
    match scalar {
        0 => value,
        1.. => value * f64::from(scalar),
        _ => value / -f64::from(scalar),
    }
}

fn trace_header(bytes: &[u8], order: ByteOrder, options: &SegyOptions) -> TraceHeader {
    let bytes = Bytes {
        bytes,
        first: 1,
        order,
    };
    let number = |place: u16| bytes.i32(usize::from(place));
    let of_times = bytes.i16(215);
    let of_times = match SCALARS.contains(&of_times.unsigned_abs()) {
        true => of_times,
        false => 0,
    };
    TraceHeader {
        inline: number(options.inline),
        crossline: number(options.crossline),
        cdp: bytes.i32(21),
        place: [number(options.x), number(options.y)],
        source_place: [bytes.i32(73), bytes.i32(77)],
        scalar: bytes.i16(usize::from(options.scalar)),
        units: bytes.i16(89),
        kind: bytes.i16(29),
        samples: bytes.u16(115),
        interval: bytes.u16(117),
        delay: scaled(f64::from(bytes.i16(109)), of_times) as f32,
    }
}

/// Traces of equal length, one behind the other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) start: u64,
    /// Bytes of a trace with its header.
    pub(super) length: u64,
    pub(super) count: u64,
    pub(super) order: ByteOrder,
}

/// The header of one trace.
pub(super) fn one(
    source: &Source,
    layout: Layout,
    number: u64,
    options: &SegyOptions,
) -> Result<TraceHeader, ParseError> {
    let mut bytes = [0; TRACE_HEADER as usize];
    source.read(layout.start + number * layout.length, &mut bytes)?;
    Ok(trace_header(&bytes, layout.order, options))
}

/// The headers of all traces in the order of the file.
pub(super) fn all(
    source: &Source,
    layout: Layout,
    options: &SegyOptions,
) -> Result<Vec<TraceHeader>, ParseError> {
    let pieces = 8 * parallel::threads() as u64;
    let each = layout.count.div_ceil(pieces).max(256);
    let starts = (0..layout.count).step_by(each as usize);
    let pieces = starts.map(|first| [first, (first + each).min(layout.count)]);
    let read = parallel::map(pieces.collect(), |piece| {
        some(source, layout, piece, options)
    });
    let mut headers = Vec::with_capacity(layout.count as usize);
    for piece in read {
        headers.append(&mut piece?);
    }
    Ok(headers)
}

fn some(
    source: &Source,
    layout: Layout,
    [first, end]: [u64; 2],
    options: &SegyOptions,
) -> Result<Vec<TraceHeader>, ParseError> {
    let mut headers = Vec::with_capacity((end - first) as usize);
    if layout.length > SHORT {
        for number in first..end {
            headers.push(one(source, layout, number, options)?);
        }
        return Ok(headers);
    }
    let at_once = BUFFER / layout.length;
    let mut bytes = Vec::new();
    for number in (first..end).step_by(at_once as usize) {
        let count = at_once.min(end - number);
        bytes.resize((count * layout.length) as usize, 0);
        source.read(layout.start + number * layout.length, &mut bytes)?;
        let traces = bytes.chunks_exact(layout.length as usize);
        headers.extend(traces.map(|trace| trace_header(trace, layout.order, options)));
    }
    Ok(headers)
}
