//! The acceleration grid: a regular grid over x and y that lists the columns above each bin.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::columns::ColumnShape;
use super::layout::BIN_IS_ODD;
use crate::model::Grid;
use crate::scene::Storage;

/// Bins a column and direction, at most, and bytes of acceleration that an active cell may cost: the paper's refinement,
/// or half as fine in half as much memory.
fn fineness(storage: Storage) -> (f64, f64) {
    match storage {
        Storage::Exact => (1.75, 3.0),
        Storage::Compact => (1.0, 1.5),
    }
}

/// Columns are widened by this part of their extent against rounding to f32.
const WIDENING: f64 = 1e-5;

/// Bins in device form, positions relative to the origin.
pub struct AccelGrid {
    /// Bins along x and y.
    pub size: [u32; 2],
    /// Low corner.
    pub origin: DVec2,
    /// Size of a bin.
    pub bin: DVec2,
    /// First entry in `columns`, with [`BIN_IS_ODD`] where one of them is odd, and 2 x 16 bits of depth range;
    /// one more than there are bins.
    pub bins: Vec<[u32; 2]>,
    /// Columns of each bin in rising order.
    pub columns: Vec<u32>,
    /// Depth of 16-bit number 0, and depth per unit.
    pub depth: [f64; 2],
}

/// The corners that bound the active cells of a column.
struct Footprint {
    column: u32,
    is_odd: bool,
    /// Two ends of the used part of each of the four pillars.
    corners: [DVec3; 8],
}

impl Footprint {
    fn bounds(&self) -> [DVec3; 2] {
        let start = [self.corners[0]; 2];
        let [low, high] = self
            .corners
            .iter()
            .fold(start, |[a, b], &c| [a.min(c), b.max(c)]);
        let widening = WIDENING * (high - low) + DVec3::splat(1e-9);
        [low - widening, high + widening]
    }

    /// False where a line along one of the column's sides separates it from a rectangle.
    fn may_touch(&self, low: DVec2, high: DVec2) -> bool {
        let xy = self.corners.map(|c| c.truncate());
        let widening = WIDENING * (high - low).length();
        // Pillar pairs of the four sides; corners c and c + 4 are the two ends of pillar c.
        [[0, 1], [2, 3], [0, 2], [1, 3]].iter().all(|&[a, b]| {
            let normal = ((xy[b] + xy[b + 4]) - (xy[a] + xy[a + 4])).perp();
            let Some(normal) = normal.try_normalize() else {
                return true;
            };
            let span = |points: &[DVec2]| {
                points
                    .iter()
                    .map(|p| p.dot(normal))
                    .fold((f64::MAX, f64::MIN), |(lo, hi), v| (lo.min(v), hi.max(v)))
            };
            let mine = span(&xy);
            let theirs = span(&[
                low,
                high,
                DVec2::new(low.x, high.y),
                DVec2::new(high.x, low.y),
            ]);
            mine.0 <= theirs.1 + widening && theirs.0 <= mine.1 + widening
        })
    }
}

impl AccelGrid {
    /// Builds the bins over the active columns of a grid, relative to `origin`.
    pub fn new(grid: &Grid, shapes: &[ColumnShape], origin: DVec3, storage: Storage) -> Self {
        let footprints = footprints(grid, shapes, origin);
        let bounds = footprints.iter().map(Footprint::bounds);
        let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = bounds.fold(start, |[a, b], [c, d]| [a.min(c), b.max(d)]);
        let (low, high) = if footprints.is_empty() {
            (DVec3::ZERO, DVec3::ONE)
        } else {
            (low, high)
        };
        let extent = (high - low).max(DVec3::splat(1e-6));
        // Bins about as wide as columns, fewer where the budget does not allow that; an entry takes
        // 4 bytes and a bin 8, and a bin about as wide as a column touches about four of them.
        let (refinement, bytes_a_cell) = fineness(storage);
        let budget = bytes_a_cell * grid.active_cells().len() as f64;
        let mut wanted = refinement.powi(2) * grid.dims().columns() as f64;
        loop {
            let built = Self::build(&footprints, low, extent, wanted);
            let bytes = 8 * built.bins.len() + 4 * built.columns.len();
            if bytes as f64 <= budget || wanted < 64.0 {
                return built;
            }
            wanted *= (budget / bytes as f64).clamp(0.3, 0.9);
        }
    }

    fn build(footprints: &[Footprint], low: DVec3, extent: DVec3, wanted: f64) -> Self {
        let edge = (extent.x * extent.y / wanted).sqrt();
        let along = |length: f64| (length / edge).ceil().clamp(1.0, 16384.0) as u32;
        let size = [along(extent.x), along(extent.y)];
        let bin = DVec2::new(extent.x / f64::from(size[0]), extent.y / f64::from(size[1]));
        let origin = low.truncate();
        let depth = [low.z, extent.z / 65535.0];
        let lists: Vec<Vec<(u32, u32)>> = footprints
            .par_iter()
            .map(|f| bins_under(f, origin, bin, size))
            .collect();
        let bounds: Vec<[f64; 2]> = footprints.iter().map(|f| f.bounds().map(|b| b.z)).collect();
        let bins = size[0] as usize * size[1] as usize;
        let mut counts = vec![0u32; bins + 1];
        let mut flags = vec![0; bins + 1];
        let mut ranges = vec![[f64::MAX, f64::MIN]; bins];
        for ((list, bounds), footprint) in lists.iter().zip(&bounds).zip(footprints) {
            for &(at, _) in list {
                counts[at as usize + 1] += 1;
                if footprint.is_odd {
                    flags[at as usize] = BIN_IS_ODD;
                }
                let range = &mut ranges[at as usize];
                *range = [range[0].min(bounds[0]), range[1].max(bounds[1])];
            }
        }
        for at in 0..bins {
            counts[at + 1] += counts[at];
        }
        let mut columns = vec![0; counts[bins] as usize];
        let mut next = counts.clone();
        // Footprints come in rising column order, so each bin's list does too.
        for &(at, column) in lists.iter().flatten() {
            columns[next[at as usize] as usize] = column;
            next[at as usize] += 1;
        }
        let pack = |range: Option<&[f64; 2]>| match range {
            Some(&[low, high]) if low <= high => {
                let low = ((low - depth[0]) / depth[1] - 0.5)
                    .floor()
                    .clamp(0.0, 65535.0);
                let high = ((high - depth[0]) / depth[1] + 0.5)
                    .ceil()
                    .clamp(0.0, 65535.0);
                low as u32 | (high as u32) << 16
            }
            _ => 0,
        };
        let bins = counts
            .iter()
            .enumerate()
            .map(|(n, &first)| [first | flags[n], pack(ranges.get(n))])
            .collect();
        Self {
            size,
            origin,
            bin,
            bins,
            columns,
            depth,
        }
    }
}

fn footprints(grid: &Grid, shapes: &[ColumnShape], origin: DVec3) -> Vec<Footprint> {
    let columns = grid.columns().enumerate();
    columns
        .filter_map(|(number, column)| {
            let ends = column.ends(column.active())?;
            Some(Footprint {
                column: number as u32,
                is_odd: shapes[number].is_odd,
                corners: std::array::from_fn(|c| ends[c & 3][c >> 2] - origin),
            })
        })
        .collect()
}

/// (bin, column) for each bin that a footprint may touch.
fn bins_under(footprint: &Footprint, origin: DVec2, bin: DVec2, size: [u32; 2]) -> Vec<(u32, u32)> {
    let [low, high] = footprint.bounds().map(|b| (b.truncate() - origin) / bin);
    let last = |axis: usize| f64::from(size[axis] - 1);
    let range = |a: f64, b: f64, axis: usize| {
        a.floor().clamp(0.0, last(axis)) as u32..=b.floor().clamp(0.0, last(axis)) as u32
    };
    let mut bins = Vec::new();
    for y in range(low.y, high.y, 1) {
        for x in range(low.x, high.x, 0) {
            let corner = origin + bin * DVec2::new(f64::from(x), f64::from(y));
            let widening = 1e-4 * bin;
            if footprint.may_touch(corner - widening, corner + bin + widening) {
                bins.push((x + size[0] * y, footprint.column));
            }
        }
    }
    bins
}
