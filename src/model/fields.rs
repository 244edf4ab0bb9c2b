//! Values of the active cells, and their averages at the vertices.

use rayon::prelude::*;

use super::grid::Grid;
use super::ids::{CellIndex, Ijk};
use super::{borders, vertices};

/// Absolute values from here on mean "undefined" in simulators' files.
const UNDEFINED: f32 = 1e19;

/// One value for each active cell.
///
/// **Invariants**: as long as the grid's active cells; undefined values are NaN.
#[derive(Debug, Clone)]
pub struct CellField(Vec<f32>);

impl Eq for CellField {}

impl PartialEq for CellField {
    /// Undefined values are equal to each other.
    fn eq(&self, other: &Self) -> bool {
        let bits = |v: &f32| v.to_bits();
        self.0.iter().map(bits).eq(other.0.iter().map(bits))
    }
}

/// Minimum, maximum and mean of the defined values of a field.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Statistics {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Number of these cells without a value.
    pub undefined: usize,
}

impl CellField {
    /// A field from one value for each active cell; 1e20-like and non-finite values are undefined.
    pub fn new(mut values: Vec<f32>) -> Self {
        values.par_iter_mut().for_each(|v| {
            if v.is_nan() || v.abs() >= UNDEFINED {
                *v = f32::NAN;
            }
        });
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
        self.statistics_of(None)
    }

    /// [`Self::statistics`] over the cells that `kept` (by active index) names, where it is given.
    pub fn statistics_of(&self, kept: Option<&[bool]>) -> Option<Statistics> {
        let (mut min, mut max, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0);
        let mut undefined = 0;
        let is_kept = |at: usize| kept.is_none_or(|kept| kept[at]);
        for (_, &v) in (self.0.iter().enumerate()).filter(|(at, _)| is_kept(*at)) {
            if v.is_nan() {
                undefined += 1;
                continue;
            }
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
            undefined,
        })
    }
}

/// One value for each entry of the grid's depth pool: the mean of the active cells that share
/// the vertex (same pillar, same depth), so that nothing is averaged across a fault. Where local grids meet the grid that
/// they refine, values are the same from both sides.
///
/// **Invariants**: as long as the depth pool; NaN where no defined active cell touches.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexField(Vec<f32>);

impl VertexField {
    /// Averages a cell field at the vertices.
    pub fn new(grid: &Grid, field: &CellField) -> Self {
        Self::of(grid, field, None)
    }

    /// [`Self::new`] of the cells that `kept` (by active index) names, where it is given.
    pub fn of(grid: &Grid, field: &CellField, kept: Option<&[bool]>) -> Self {
        let value = |active: usize| {
            let counts = kept.is_none_or(|kept| kept[active]);
            if counts { field.0[active] } else { f32::NAN }
        };
        if grid.patches().len() == 1 {
            return Self(vertices::means(grid, value));
        }
        let mut values: Vec<f32> = (0..field.0.len()).map(value).collect();
        borders::restrict(grid, &mut values);
        let mut means = vertices::means(grid, |active| values[active]);
        borders::prolong(grid, &values, &mut means);
        Self(means)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Dims, GridInput};

    /// Two columns of two layers; the second displaced downward by `throw`.
    fn stack(throw: f64) -> Grid {
        let mut coord = Vec::new();
        for j in 0..2 {
            for i in 0..3 {
                let (x, y) = (f64::from(i), f64::from(j));
                coord.extend([x, y, 0.0, x, y, 10.0]);
            }
        }
        let depths = [0.0, 1.0, 1.0, 2.0];
        let zcorn: Vec<f64> = (0..32)
            .map(|at| depths[at / 8] + if at % 4 >= 2 { throw } else { 0.0 })
            .collect();
        let dims = Dims {
            ni: 2,
            nj: 1,
            nk: 2,
        };
        Grid::new(&GridInput {
            dims,
            coord: &coord,
            zcorn: &zcorn,
            actnum: None,
            map_axes: None,
        })
        .unwrap()
    }

    #[test]
    fn vertices_average_the_cells_that_share_them() {
        let field = CellField::new(vec![1.0, 2.0, 4.0, 8.0]);
        let grid = stack(0.0);
        let corners = VertexField::new(&grid, &field).corners(&grid, Ijk { i: 0, j: 0, k: 0 });
        // Outer pillar: cell 1 alone above, 1 and 4 below; inner pillar: 1 and 2, then all four.
        assert_eq!(corners, [1.0, 1.5, 1.0, 1.5, 2.5, 3.75, 2.5, 3.75]);
    }

    #[test]
    fn nothing_is_averaged_across_a_fault() {
        let field = CellField::new(vec![0.0, 1.0, 0.0, 1.0]);
        let grid = stack(0.4);
        assert_eq!(grid.fault_faces(), [2, 0]);
        let vertices = VertexField::new(&grid, &field);
        for cell in grid.active_cells() {
            let ijk = grid.dims().ijk(*cell);
            assert_eq!(vertices.corners(&grid, ijk), [ijk.i as f64; 8]);
        }
    }

    #[test]
    fn undefined_values_are_left_out() {
        let field = CellField::new(vec![1e20, 2.0, f32::NAN, 8.0]);
        let statistics = field.statistics().unwrap();
        assert_eq!(
            (statistics.min, statistics.max, statistics.undefined),
            (2.0, 8.0, 2)
        );
        let grid = stack(0.0);
        let corners = VertexField::new(&grid, &field).corners(&grid, Ijk { i: 1, j: 0, k: 0 });
        assert_eq!(corners, [2.0, 2.0, 2.0, 2.0, 5.0, 5.0, 5.0, 5.0]);
    }
}
