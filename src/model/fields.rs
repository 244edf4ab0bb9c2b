//! Values of the active cells, and their averages at the vertices.

use rayon::prelude::*;

use super::grid::Grid;
use super::ids::{CellIndex, Ijk};
use super::topology::COINCIDENT;

/// Absolute values from here on mean "undefined" in simulators' files.
const UNDEFINED: f32 = 1e19;

/// One value for each active cell.
///
/// **Invariants**: as long as the grid's active cells; undefined values are NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct CellField(Vec<f32>);

/// Minimum, maximum and mean of the defined values of a field.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Statistics {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Number of active cells without a value.
    pub undefined: usize,
}

impl CellField {
    /// A field from one value for each active cell; 1e20-like and non-finite values are undefined.
    pub fn new(mut values: Vec<f32>) -> Self {
        for v in &mut values {
            if v.is_nan() || v.abs() >= UNDEFINED {
                *v = f32::NAN;
            }
        }
        Self(values)
    }

    /// The values by active index; NaN where undefined.
    pub fn values(&self) -> &[f32] {
        &self.0
    }

    /// The value of a cell; `None` where it is inactive or undefined.
    pub fn value(&self, grid: &Grid, cell: CellIndex) -> Option<f32> {
        let value = self.0[grid.active_index(cell)?.0 as usize];
        (!value.is_nan()).then_some(value)
    }

    /// Statistics over the active cells; `None` where no value is defined.
    pub fn statistics(&self) -> Option<Statistics> {
        let (mut min, mut max, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0);
        for &v in self.0.iter().filter(|v| !v.is_nan()) {
            let v = f64::from(v);
            min = min.min(v);
            max = max.max(v);
            sum += v;
            count += 1;
        }
        (count > 0).then(|| Statistics {
            min,
            max,
            mean: sum / f64::from(count),
            undefined: self.0.len() - count as usize,
        })
    }
}

/// One value for each entry of the grid's depth pool: the mean of the active cells that share
/// the vertex (same pillar, same depth), so that nothing is averaged across a fault.
///
/// **Invariants**: as long as the depth pool; NaN where no defined active cell touches.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexField(Vec<f32>);

impl VertexField {
    /// Averages a cell field at the vertices.
    pub fn new(grid: &Grid, field: &CellField) -> Self {
        let dims = grid.dims();
        let pillars: Vec<Vec<(usize, f32)>> = (0..dims.pillars())
            .into_par_iter()
            .map(|pillar| average_on_pillar(grid, field, pillar))
            .collect();
        let mut values = vec![f32::NAN; grid.depths().len()];
        for (entry, value) in pillars.into_iter().flatten() {
            values[entry] = value;
        }
        Self(values)
    }

    /// The values by depth-pool position.
    pub fn values(&self) -> &[f32] {
        &self.0
    }

    /// The eight corner values of a cell.
    pub fn corners(&self, grid: &Grid, ijk: Ijk) -> [f64; 8] {
        std::array::from_fn(|c| f64::from(self.0[grid.corner_entry(ijk, c)]))
    }
}

/// Means at the distinct depths of one pillar, by depth-pool position.
fn average_on_pillar(grid: &Grid, field: &CellField, pillar: usize) -> Vec<(usize, f32)> {
    let dims = grid.dims();
    let (pi, pj) = (pillar % (dims.ni + 1), pillar / (dims.ni + 1));
    // (depth, pool position, value of the active cell that touches there)
    let mut touching: Vec<(f64, usize, f64)> = Vec::new();
    for corner in 0..4 {
        let (i, j) = (pi.wrapping_sub(corner & 1), pj.wrapping_sub(corner >> 1));
        if i >= dims.ni || j >= dims.nj {
            continue;
        }
        for k in 0..dims.nk {
            let ijk = Ijk { i, j, k };
            let Some(value) = field.value(grid, dims.cell(ijk)) else {
                continue;
            };
            let ends = [corner, corner + 4].map(|c| grid.corner_entry(ijk, c));
            let coincide = (grid.depths()[ends[0]] - grid.depths()[ends[1]]).abs() <= COINCIDENT;
            // A cell collapsed on this pillar touches the vertex once, not twice.
            for (n, &entry) in ends.iter().enumerate() {
                let value = if n == 1 && coincide {
                    f64::NAN
                } else {
                    f64::from(value)
                };
                touching.push((grid.depths()[entry], entry, value));
            }
        }
    }
    touching.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut means = Vec::with_capacity(touching.len());
    let mut rest = touching.as_slice();
    while let Some(&(first, ..)) = rest.first() {
        let count = rest.partition_point(|t| t.0 - first <= COINCIDENT);
        let (vertex, next) = rest.split_at(count);
        let defined = vertex.iter().map(|t| t.2).filter(|v| !v.is_nan());
        let (sum, n) = defined.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
        means.extend(vertex.iter().map(|t| (t.1, (sum / n) as f32)));
        rest = next;
    }
    means
}
