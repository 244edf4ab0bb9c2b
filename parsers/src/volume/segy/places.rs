//! Where a survey is on the map: places of traces, and the affine map through them.

use super::super::source::Source;
use super::grid::{self, Grid, Map};
use super::scan::{TraceHeader, scaled};
use super::{SegyOptions, refuse};
use crate::error::{At, ErrorKind, ParseError, Warnings};

/// The lattice on the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OnMap {
    pub(super) origin: [f64; 2],
    pub(super) edges: [[f64; 2]; 2],
    /// How far traces are from it: root of the mean square, and the largest distance.
    pub(super) residual: Option<[f64; 2]>,
}

/// What the places of traces say.
struct Found {
    map: Map,
    /// Traces without a place.
    without: u64,
    /// True of places of sources, where common depth points have none.
    is_source: bool,
}

/// Places of traces on the lattice of numbers, as the file has them; the reason where it has none.
fn find(
    grid: &Grid,
    traces: &[TraceHeader],
    numbers: &[Option<[i32; 2]>],
) -> Result<Found, &'static str> {
    if traces.iter().any(|trace| matches!(trace.units, 2..=4)) {
        return Err("coordinates are degrees, which are not turned into lengths");
    }
    let is_zero = |place: [i32; 2]| place == [0, 0];
    let is_source = traces.iter().all(|trace| is_zero(trace.place));
    let place = |trace: &TraceHeader| {
        if is_source {
            trace.source_place
        } else {
            trace.place
        }
    };
    let points = traces.iter().zip(numbers).filter_map(|(trace, number)| {
        let [inline, crossline] = (*number)?;
        // Stands for none: dead traces, and what fills a rectangle.
        let place = Some(place(trace)).filter(|place| !is_zero(*place))?;
        let number = [
            grid.axes[0].place(inline) as f64,
            grid.axes[1].place(crossline) as f64,
        ];
        Some((number, place.map(|v| scaled(f64::from(v), trace.scalar))))
    });
    let count = points.clone().count() as u64;
    let numbered = numbers.iter().flatten().count() as u64;
    match grid::fit(points) {
        Some(map) => Ok(Found {
            map,
            without: numbered - count,
            is_source,
        }),
        None => Err("traces have no coordinates of a lattice"),
    }
}

/// The lattice on the map, from places of traces, or else from their numbers.
///
/// # Errors
/// When places are those of no lattice.
pub(super) fn read(
    source: &Source,
    options: &SegyOptions,
    grid: &Grid,
    traces: &[TraceHeader],
    numbers: &[Option<[i32; 2]>],
    notes: &mut Warnings,
) -> Result<OnMap, ParseError> {
    let found = match options.coordinates {
        true => find(grid, traces, numbers),
        false => Err("coordinates are not looked at"),
    };
    match found {
        Ok(found) => fitted(source, options, grid, &found, notes),
        Err(reason) => {
            let message = format!("{reason}: inline and crossline numbers stand for x and y");
            notes.push(source.path(), At::File, message);
            let [i, j] = grid.axes;
            Ok(OnMap {
                origin: [f64::from(i.first), f64::from(j.first)],
                edges: [[f64::from(i.step), 0.0], [0.0, f64::from(j.step)]],
                residual: None,
            })
        }
    }
}

fn fitted(
    source: &Source,
    options: &SegyOptions,
    grid: &Grid,
    found: &Found,
    notes: &mut Warnings,
) -> Result<OnMap, ParseError> {
    let mut note = |message: String| notes.push(source.path(), At::File, message);
    let Found {
        map,
        without,
        is_source,
    } = found;
    if *is_source {
        note("coordinates of common depth points are zero: those of the source (bytes 73 to 80) are read".into());
    }
    if *without > 0 {
        note(format!(
            "traces without coordinates: {without}; their places follow from their numbers"
        ));
    }
    let length = |edge: [f64; 2]| edge[0].hypot(edge[1]);
    let known = (0..2).filter(|axis| map.is_known[*axis] && grid.axes[*axis].count > 1);
    let bin = known
        .map(|axis| length(map.edges[axis]))
        .fold(f64::INFINITY, f64::min);
    let [mean, largest] = map.residual;
    if mean > bin / 2.0 {
        let message = format!(
            "places of traces are {mean:.1} from those of a lattice (root of the mean square), more than half a bin of {bin:.1}: the inline or crossline number, or the coordinates, may stand at other bytes than {}, {}, {} and {}; without coordinates the file is read by its numbers",
            options.inline, options.crossline, options.x, options.y
        );
        return Err(refuse(source, ErrorKind::Mismatch, message));
    }
    if largest > bin / 2.0 {
        note(format!(
            "a trace is {largest:.1} from its place on the lattice, more than half a bin of {bin:.1}"
        ));
    }
    let mut edges = map.edges;
    for axis in 0..2 {
        let other = edges[1 - axis];
        if !map.is_known[axis] {
            // To the left of the other axis, or to its right, as x and y are.
            let sign = if axis == 0 { 1.0 } else { -1.0 };
            edges[axis] = [sign * other[1], -sign * other[0]];
            if grid.axes[axis].count > 1 {
                note(format!(
                    "places do not change along axis {axis}: it is taken at a right angle to the other one"
                ));
            }
        }
    }
    Ok(OnMap {
        origin: map.origin,
        edges,
        residual: Some(map.residual),
    })
}
