//! How a field changes from cell to cell: first and second derivatives where two cells touch.

use glam::DVec3;
use rayon::prelude::*;

use super::fields::CellField;
use super::grid::Grid;
use super::ids::Ijk;
use super::topology::{Behind, Face};

/// A field halfway between the centers of two cells that share a face.
///
/// **Units**: the field's, and those per length. Lengths are in mean distances of neighbors along the
/// same axis, so that a flat cell's short axis does not outdo the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Mean of both cells.
    pub value: f64,
    /// Length of the gradient.
    pub first: f64,
    /// Second derivative along the gradient.
    pub second: f64,
}

/// Centers nearer than this part of the mean distance are one place.
const LEAST_DISTANCE: f64 = 1e-3;

/// Samples at all faces that two active cells with a value share as a whole, so never across a fault; both are
/// among the cells that `kept` (by active index) names, where it is given.
///
/// Along the line between both cells the derivative is their difference over the distance; along the two
/// other axes it is the mean of both cells' own. The grid's axes are taken to be at right angles, and
/// mixed second derivatives to be zero.
pub fn samples(grid: &Grid, field: &CellField, kept: Option<&[bool]>) -> Vec<Sample> {
    let is_kept = |active: u32| kept.is_none_or(|kept| kept[active as usize]);
    let has_value = |active: u32| !field.values()[active as usize].is_nan() && is_kept(active);
    let cells = grid.active_cells().par_iter();
    let centers: Vec<DVec3> = cells
        .map(|&cell| grid.hexahedron(grid.dims().ijk(cell)).center())
        .collect();
    let faces = [Face::IPlus, Face::JPlus, Face::KPlus];
    let axes: Vec<Axis> = faces
        .into_par_iter()
        .map(|face| Axis::new(grid, field, &centers, face, has_value))
        .collect();
    let along: Vec<Vec<Sample>> = (0..axes.len())
        .into_par_iter()
        .map(|axis| between(field, &axes, axis))
        .collect();
    along.concat()
}

/// What there is along an axis, by active index.
struct Axis {
    /// The cell behind and the derivative toward it.
    next: Vec<Option<(u32, f32)>>,
    /// First and second derivative at the cell's center; zero along an axis without neighbors.
    at_cells: Vec<[f32; 2]>,
}

impl Axis {
    fn new(
        grid: &Grid,
        field: &CellField,
        centers: &[DVec3],
        face: Face,
        has_value: impl Fn(u32) -> bool + Sync,
    ) -> Self {
        let neighbor = |active: usize, ijk: Ijk| {
            let Behind::Neighbor(next) = grid.behind(ijk, face) else {
                return None;
            };
            let next = grid.active_index(grid.dims().cell(next))?.0;
            let distance = centers[active].distance(centers[next as usize]);
            (has_value(active as u32) && has_value(next)).then_some((next, distance as f32))
        };
        let cells = grid.active_cells().par_iter().enumerate();
        let links: Vec<Option<(u32, f32)>> = cells
            .map(|(active, &cell)| neighbor(active, grid.dims().ijk(cell)))
            .collect();
        let lengths = links.iter().flatten().map(|link| f64::from(link.1));
        let (sum, count) = lengths.fold((0.0, 0.0), |(s, n), d| (s + d, n + 1.0));
        let mean: f64 = sum / f64::max(count, 1.0);
        let mut next = vec![None; links.len()];
        // Sums of derivatives to both sides, and of what makes the second one of them.
        let mut sides = vec![[None; 2]; links.len()];
        for (active, link) in links.into_iter().enumerate() {
            let Some((cell, distance)) = link else {
                continue;
            };
            let distance = f64::from(distance) / mean;
            // False for NaN, where all centers are one place.
            if distance > LEAST_DISTANCE {
                let [here, there] = [active, cell as usize].map(|c| field.values()[c]);
                let derivative = (f64::from(there - here) / distance) as f32;
                let side = Some((derivative, distance as f32));
                next[active] = Some((cell, derivative));
                sides[active][1] = side;
                sides[cell as usize][0] = side;
            }
        }
        Self {
            next,
            at_cells: sides.par_iter().map(at_center).collect(),
        }
    }
}

/// First and second derivative at a cell's center, from the derivatives to the neighbors before and
/// after it and their distances.
fn at_center(sides: &[Option<(f32, f32)>; 2]) -> [f32; 2] {
    match *sides {
        [Some((a, da)), Some((b, db))] => [0.5 * (a + b), (b - a) / (0.5 * (da + db))],
        [Some((one, _)), None] | [None, Some((one, _))] => [one, 0.0],
        [None, None] => [0.0; 2],
    }
}

/// The samples between neighbors along an axis.
fn between(field: &CellField, axes: &[Axis], axis: usize) -> Vec<Sample> {
    let sample = |cell: usize| {
        let (next, derivative) = axes[axis].next[cell]?;
        let next = next as usize;
        let mut first = [f64::from(derivative); 3];
        let mut second = [0.0; 3];
        for (other, along) in axes.iter().enumerate() {
            let [a, b] = [cell, next].map(|c| along.at_cells[c].map(f64::from));
            if other != axis {
                first[other] = 0.5 * (a[0] + b[0]);
            }
            second[other] = 0.5 * (a[1] + b[1]);
        }
        let squares = first.map(|d| d * d);
        let square: f64 = squares.iter().sum();
        let weighted: f64 = squares.iter().zip(second).map(|(w, s)| w * s).sum();
        let [here, there] = [cell, next].map(|c| f64::from(field.values()[c]));
        Some(Sample {
            value: 0.5 * (here + there),
            first: square.sqrt(),
            second: if square > 0.0 { weighted / square } else { 0.0 },
        })
    };
    let cells = (0..axes[axis].next.len()).into_par_iter();
    cells.filter_map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Dims, GridInput};

    /// A row of cells of the given lengths; those from `fault` on lie deeper.
    fn row(lengths: &[f64], fault: usize) -> Grid {
        let ends: Vec<f64> = std::iter::once(0.0)
            .chain(lengths.iter().scan(0.0, |x, l| {
                *x += l;
                Some(*x)
            }))
            .collect();
        let pillar = |x: f64, y: f64| [x, y, 0.0, x, y, 10.0];
        let coord: Vec<f64> = [0.0, 1.0]
            .iter()
            .flat_map(|y| ends.iter().flat_map(|x| pillar(*x, *y)))
            .collect();
        let per_layer = 4 * lengths.len();
        let throw = |at: usize| f64::from(u8::from(at % (2 * lengths.len()) / 2 >= fault)) * 5.0;
        let zcorn: Vec<f64> = (0..2 * per_layer)
            .map(|at| (at / per_layer) as f64 + throw(at))
            .collect();
        Grid::new(&GridInput {
            dims: Dims {
                ni: lengths.len(),
                nj: 1,
                nk: 1,
            },
            coord: &coord,
            zcorn: &zcorn,
            actnum: None,
            map_axes: None,
        })
        .unwrap()
    }

    #[test]
    fn derivatives_are_those_of_a_parabola() {
        // Centers at 0.5, 1.5, ... and f = x^2: f' = 2x, f'' = 2.
        let grid = row(&[1.0; 6], 6);
        let values = (0..6).map(|n| (n as f32 + 0.5).powi(2)).collect();
        let found = samples(&grid, &CellField::new(values), None);
        assert_eq!(found.len(), 5);
        for (n, sample) in found.iter().enumerate().skip(1).take(3) {
            assert!((sample.first - 2.0 * (n as f64 + 1.0)).abs() < 1e-6);
            assert!((sample.second - 2.0).abs() < 1e-6, "{sample:?}");
        }
    }

    #[test]
    fn longer_cells_have_smaller_derivatives() {
        let grid = row(&[1.0, 1.0, 3.0], 3);
        let found = samples(&grid, &CellField::new(vec![0.0, 1.0, 2.0]), None);
        // Distances 1 and 2; their mean is the unit of length.
        let firsts = [found[0].first, found[1].first];
        assert!((firsts[0] - 1.5).abs() < 1e-9 && (firsts[1] - 0.75).abs() < 1e-9);
    }

    #[test]
    fn nothing_is_taken_across_a_fault_or_beside_no_value() {
        let field = CellField::new(vec![0.0, 1.0, 5.0, 6.0]);
        let cut = samples(&row(&[1.0; 4], 2), &field, None);
        assert_eq!(cut.len(), 2);
        assert!(cut.iter().all(|s| s.first == 1.0 && s.second == 0.0));
        assert_eq!(samples(&row(&[1.0; 4], 4), &field, None).len(), 3);
        let kept = [true, true, true, false];
        assert_eq!(samples(&row(&[1.0; 4], 4), &field, Some(&kept)).len(), 2);
        let gap = CellField::new(vec![0.0, f32::NAN, 5.0, 6.0]);
        assert_eq!(samples(&row(&[1.0; 4], 4), &gap, None).len(), 1);
        assert!(samples(&row(&[1.0], 1), &CellField::new(vec![1.0]), None).is_empty());
    }
}
