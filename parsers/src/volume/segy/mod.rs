//! SEG-Y rev 0 to 2: stacked seismic traces on a lattice of inlines and crosslines.
//!
//! i is the inline, j the crossline, k the sample of a trace. The headers of all traces are read, side by side, and none
//! of the samples: from the numbers of the traces follows the lattice, and from their places, by least squares, the affine
//! map of the lattice to the map; a survey whose places fit worse than half a bin is refused. Places without a trace, and
//! traces that are marked as dead, have no values. The third coordinate is time in ms, or depth, and grows downward, as
//! in the file.
//!
//! Files differ in where they have these numbers: [`SegyOptions`] says where they are read.
//!
//! The facts are those of the definitions of the format by the SEG's technical standards committee.

mod grid;
mod header;
mod places;
mod scan;
mod text;
mod traces;
mod write;

use super::lattice::{self, Lattice};
use super::sample::{ByteOrder, Coding};
use super::source::Source;
use super::{Axis, Format, Samples, VolumeFile};
use crate::error::{At, ErrorKind, ParseError, Warnings};

use grid::Grid;
use header::{Header, TRACE_HEADER};
use scan::{Layout, TraceHeader};

pub(super) use header::is_header;
pub(super) use traces::Traces;
pub use write::{SegyLayout, SegyWriter};

/// What the third axis is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vertical {
    /// Time in ms.
    Time,
    /// Depth in the unit of the file's lengths.
    Depth,
}

/// Where things stand in a SEG-Y file, as bytes of the header of a trace, from 1.
#[derive(Debug, Clone, PartialEq)]
pub struct SegyOptions {
    /// 4 bytes of the inline number.
    pub inline: u16,
    /// 4 bytes of the crossline number.
    pub crossline: u16,
    /// 4 bytes of the x coordinate.
    pub x: u16,
    /// 4 bytes of the y coordinate.
    pub y: u16,
    /// 2 bytes of the scalar of coordinates.
    pub scalar: u16,
    /// What samples are apart in; files do not say it.
    pub vertical: Vertical,
    /// False: places are not looked at, and inline and crossline numbers stand for them.
    pub coordinates: bool,
    /// The order of bytes, where the file does not show it.
    pub byte_order: Option<ByteOrder>,
}

impl Default for SegyOptions {
    fn default() -> Self {
        Self {
            inline: 189,
            crossline: 193,
            x: 181,
            y: 185,
            scalar: 71,
            vertical: Vertical::Time,
            coordinates: true,
            byte_order: None,
        }
    }
}

/// What a SEG-Y file says beside the lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Major and minor number of the definition.
    pub revision: [u8; 2],
    /// Code of the type of samples.
    pub code: u16,
    /// Inline and crossline number of the first place.
    pub first: [i32; 2],
    /// Steps of inline and crossline numbers.
    pub step: [u32; 2],
    /// Traces in the file.
    pub traces: u64,
    /// Places of the lattice without a trace.
    pub absent: u64,
    /// Traces at places that have one already; the first one counts.
    pub repeated: u64,
    /// How far the places of traces are from those of the lattice: root of the mean square, and the largest distance.
    /// `None` where places are not those of the file.
    pub residual: Option<[f64; 2]>,
}

fn refuse(source: &Source, kind: ErrorKind, message: impl Into<String>) -> ParseError {
    source.error(kind, At::File, "SEG-Y", message)
}

fn check(source: &Source, options: &SegyOptions) -> Result<(), ParseError> {
    let last = TRACE_HEADER as u16;
    let longs = [options.inline, options.crossline, options.x, options.y].map(|n| (n, 4));
    for (place, size) in longs.into_iter().chain([(options.scalar, 2)]) {
        if place < 1 || place > last + 1 - size {
            let message = format!(
                "{size} bytes from byte {place} on are not within the {last} bytes of a trace's header"
            );
            return Err(refuse(source, ErrorKind::BadValue, message));
        }
    }
    Ok(())
}

/// How traces stand in the file: all of one length.
fn layout(
    source: &Source,
    header: &mut Header,
    options: &SegyOptions,
    notes: &mut Warnings,
) -> Result<Layout, ParseError> {
    let size = header.sample.size() as u64;
    let of = |samples: u64| Layout {
        start: header.start,
        length: TRACE_HEADER.saturating_add(samples.saturating_mul(size)),
        count: 0,
        order: header.order,
    };
    let bytes = header.end - header.start;
    let first = scan::one(source, of(0), 0, options)?;
    let told = [header.samples, u64::from(first.samples)];
    let fits = |samples: &&u64| **samples > 0 && bytes.is_multiple_of(of(**samples).length);
    let Some(samples) = told.iter().find(fits).copied() else {
        let [binary, trace] = told;
        let message = format!(
            "{bytes} bytes are no whole number of traces, of {binary} samples by the file's header or {trace} by that of the first trace, of {size} bytes (format code {}): the file is cut, or traces are of different lengths, which is not read",
            header.code
        );
        return Err(refuse(source, ErrorKind::Truncated, message));
    };
    if samples != header.samples {
        let message = format!(
            "the file's header has {} samples of a trace, and those of traces {samples}, with which the file fits: these are read",
            header.samples
        );
        notes.push(source.path(), At::Byte(3220), message);
        header.samples = samples;
    }
    let layout = of(samples);
    let count = bytes / layout.length;
    if count >= u64::from(grid::NONE) {
        let message = format!("{count} traces are more than can be numbered: split the file");
        return Err(refuse(source, ErrorKind::TooLarge, message));
    }
    Ok(Layout { count, ..layout })
}

/// Start and step of the third axis, in ms or in lengths.
fn vertical(
    source: &Source,
    header: &Header,
    traces: &[TraceHeader],
    notes: &mut Warnings,
) -> Result<[f64; 2], ParseError> {
    let mut note = |message: String| notes.push(source.path(), At::File, message);
    let of_trace = traces.first().map_or(0, |trace| trace.interval);
    let interval = match header.interval {
        0.0 => f64::from(of_trace),
        interval => interval,
    };
    if interval == 0.0 {
        note("the sample interval is not told: samples are 1 apart".into());
    } else if of_trace != 0 && f64::from(of_trace) != interval {
        note(format!(
            "the sample interval is {interval} in the file's header, and {of_trace} in that of the first trace: {interval} is read"
        ));
    }
    let delays = traces.iter().map(|trace| trace.delay);
    let low = delays.clone().fold(f32::INFINITY, f32::min);
    let high = delays.fold(f32::NEG_INFINITY, f32::max);
    if low != high {
        let message = format!(
            "traces begin at different times, from {low} to {high} ms: shift them to one before"
        );
        return Err(refuse(source, ErrorKind::Unsupported, message));
    }
    let step = if interval == 0.0 {
        1.0
    } else {
        interval / 1000.0
    };
    Ok([f64::from(low), step])
}

/// Numbers of the traces; none of those that are dead.
fn numbers(
    source: &Source,
    traces: &[TraceHeader],
    notes: &mut Warnings,
) -> (Vec<Option<[i32; 2]>>, [&'static str; 2]) {
    let mut note = |message: String| notes.push(source.path(), At::File, message);
    let is_dead = |trace: &TraceHeader| trace.kind == 2;
    let dead = traces.iter().filter(|trace| is_dead(trace)).count();
    let is_any = dead < traces.len();
    if dead > 0 && is_any {
        note(format!(
            "traces marked as dead: {dead}; they have no values"
        ));
    }
    let alive = traces
        .iter()
        .map(|trace| Some(trace).filter(|t| !is_any || !is_dead(t)));
    let vary = |number: fn(&TraceHeader) -> i32| {
        let mut numbers = alive.clone().flatten().map(number);
        let first = numbers.next();
        numbers.any(|n| Some(n) != first)
    };
    if traces.len() == 1 || vary(|t| t.inline) || vary(|t| t.crossline) {
        let numbers = alive.map(|trace| trace.map(|t| [t.inline, t.crossline]));
        return (numbers.collect(), ["inline", "crossline"]);
    }
    if vary(|t| t.cdp) {
        note("inline and crossline numbers are all the same: this is a line, along the numbers of common depth points (bytes 21 to 24)".into());
        let numbers = alive.map(|trace| trace.map(|t| [1, t.cdp]));
        return (numbers.collect(), ["line", "cdp"]);
    }
    note("traces have no numbers: this is a line, in the order of the file".into());
    let numbers = alive
        .enumerate()
        .map(|(n, trace)| trace.map(|_| [1, n as i32 + 1]));
    (numbers.collect(), ["line", "trace"])
}

fn too_sparse(source: &Source, options: &SegyOptions, traces: usize, places: u64) -> ParseError {
    let message = format!(
        "{traces} traces on a lattice of {places} places: the inline and crossline number may stand at other bytes than {} and {}",
        options.inline, options.crossline
    );
    refuse(source, ErrorKind::Mismatch, message)
}

/// Says what is odd about the traces on their lattice.
fn note_grid(
    source: &Source,
    header: &Header,
    grid: &Grid,
    traces: &[TraceHeader],
    notes: &mut Warnings,
) {
    let mut note = |message: String| notes.push(source.path(), At::File, message);
    if grid.repeated > 0 {
        note(format!(
            "traces with the numbers of another one: {}; the first one is read, so stack gathers before",
            grid.repeated
        ));
    }
    if grid.absent > 0 {
        let places = grid.traces.len();
        note(format!(
            "places without a trace: {} of {places}; they have no values",
            grid.absent
        ));
    }
    let samples = header.samples;
    let others = traces
        .iter()
        .filter(|t| t.samples != 0 && u64::from(t.samples) != samples.min(0xffff));
    let others = others.count();
    if others > 0 {
        note(format!(
            "traces whose headers have another number of samples than {samples}, with which the file fits: {others}"
        ));
    }
}

pub(super) fn read(source: &Source, options: &SegyOptions) -> Result<VolumeFile, ParseError> {
    check(source, options)?;
    let mut notes = Warnings::default();
    let mut header = header::read(source, options.byte_order)?;
    let layout = layout(source, &mut header, options, &mut notes)?;
    let traces = scan::all(source, layout, options)?;
    let [start, step] = vertical(source, &header, &traces, &mut notes)?;
    let (numbers, names) = numbers(source, &traces, &mut notes);
    let grid =
        Grid::new(&numbers).map_err(|places| too_sparse(source, options, traces.len(), places))?;
    note_grid(source, &header, &grid, &traces, &mut notes);
    let map = places::read(source, options, &grid, &traces, &numbers, &mut notes)?;
    let dims = [grid.axes[0].count, grid.axes[1].count, header.samples];
    let (dims, _) = lattice::samples(dims).ok_or_else(|| {
        let [ni, nj, nk] = dims;
        let message =
            format!("no volume of {ni} x {nj} x {nk} samples can be addressed on this machine");
        refuse(source, ErrorKind::TooLarge, message)
    })?;
    let [inline, crossline] = map.edges;
    let lattice = Lattice {
        dims,
        origin: [map.origin[0], map.origin[1], start],
        edges: [
            [inline[0], inline[1], 0.0],
            [crossline[0], crossline[1], 0.0],
            [0.0, 0.0, step],
        ],
    };
    let survey = Survey {
        revision: header.revision,
        code: header.code,
        first: grid.axes.map(|axis| axis.first),
        step: grid.axes.map(|axis| axis.step),
        traces: layout.count,
        absent: grid.absent,
        repeated: grid.repeated,
        residual: map.residual,
    };
    let coding = Coding {
        kind: header.sample,
        order: header.order,
    };
    let samples = Samples::Traces(Traces::new(layout, [dims[0], dims[1]], grid.traces));
    let mut volume = VolumeFile::new(Format::Segy, source, lattice, coding, samples);
    volume.axes = axes(options, &header, names, map.residual.is_some());
    volume.survey = Some(survey);
    let mut letters = vec![0; text::LENGTH];
    source.read(0, &mut letters)?;
    volume.header = text::lines(&letters);
    volume.notes = notes;
    Ok(volume)
}

fn axes(options: &SegyOptions, header: &Header, names: [&str; 2], is_placed: bool) -> [Axis; 3] {
    let length = match header.measurement {
        1 => "m",
        2 => "ft",
        _ => "",
    };
    let axis = |name: &str, unit: &str| Axis {
        name: name.to_owned(),
        unit: unit.to_owned(),
    };
    let unit = if is_placed { length } else { "" };
    let [i, j] = names.map(|name| axis(name, unit));
    let k = match options.vertical {
        Vertical::Time => axis("time", "ms"),
        Vertical::Depth => axis("depth", length),
    };
    [i, j, k]
}
