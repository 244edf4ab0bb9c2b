//! Values where local grids meet the grid that they refine: the same from both sides.
//!
//! A cell that is refined counts at its vertices with the mean of the finer cells in it, and the finer vertices on its
//! faces have what it has there, as at the hanging nodes of a refined mesh. So a value that is linear in space stays so
//! across the border.

use glam::DVec3;

use super::corner_point::{Hexahedron, weights};
use super::grid::Grid;
use super::ids::Ijk;
use super::topology::Face;

/// How far from a face a vertex may lie to be on it, as a part of half the cell.
const ON_FACE: f64 = 1e-3;
/// Iterations that find a place in a cell.
const MOST_ITERATIONS: usize = 12;

/// Means of the finer cells, in the values by active index of the cells that they refine and that have none.
pub(super) fn restrict(grid: &Grid, values: &mut [f32]) {
    let own: Vec<bool> = values.iter().map(|value| !value.is_nan()).collect();
    let active = |cell: Ijk| Some(grid.active_index(grid.dims().cell(cell))?.0 as usize);
    // The finest first.
    for patch in (1..grid.patches().len()).rev() {
        let mut sums: std::collections::HashMap<usize, (f64, f64)> = Default::default();
        for (cell, host) in grid.hosts_of(patch) {
            let (Some(cell), Some(host)) = (active(cell), active(host)) else {
                continue;
            };
            if !own[host] && !values[cell].is_nan() {
                let (sum, count) = sums.entry(host).or_default();
                *sum += f64::from(values[cell]);
                *count += 1.0;
            }
        }
        for (host, (sum, count)) in sums {
            values[host] = (sum / count) as f32;
        }
    }
}

/// Given values by active index with those of [`restrict`], and means at the entries of the depth pool: those of the
/// vertices of local grids on faces behind which a cell of the coarser grid has a value become what it has there.
pub(super) fn prolong(grid: &Grid, values: &[f32], means: &mut [f32]) {
    let has_value = |cell: Ijk| {
        let active = grid.active_index(grid.dims().cell(cell));
        active.is_some_and(|active| !values[active.0 as usize].is_nan())
    };
    // The coarsest first.
    for patch in 1..grid.patches().len() {
        for (cell, host) in grid.hosts_of(patch) {
            if !has_value(cell) || !has_value(host) {
                continue;
            }
            for face in Face::ALL {
                let next = grid.adjacent(cell, face);
                if next.is_some_and(|next| grid.patch_of(next) == Some(patch)) {
                    continue;
                }
                let behind = grid.adjacent(host, face).filter(|&next| {
                    grid.patch_of(next) == grid.patch_of(host)
                        && has_value(next)
                        && grid.coincide(host, next, face)
                });
                if behind.is_some() {
                    prolong_face(grid, cell, host, face, means);
                }
            }
        }
    }
}

/// The values of a face's corners, where they lie on the same face of its host.
fn prolong_face(grid: &Grid, cell: Ijk, host: Ijk, face: Face, means: &mut [f32]) {
    let (fine, coarse) = (grid.hexahedron(cell), grid.hexahedron(host));
    let coarse_values: [f64; 8] =
        std::array::from_fn(|corner| f64::from(means[grid.corner_entry(host, corner)]));
    let [corners, _] = face.corners();
    let (axis, end) = (
        face as usize / 2,
        if face as usize % 2 == 1 { 1.0 } else { -1.0 },
    );
    for corner in corners {
        let Some(mut at) = parameters(&coarse, fine.0[corner]) else {
            continue;
        };
        let is_inside = at.abs().max_element() < 1.0 + ON_FACE;
        if (at[axis] - end).abs() > ON_FACE || !is_inside {
            continue;
        }
        at[axis] = end;
        let at = at.clamp(DVec3::NEG_ONE, DVec3::ONE);
        let weighted = weights(at).into_iter().zip(coarse_values);
        // Corners that do not count may have no value.
        let value: f64 = weighted.filter(|(w, _)| *w > 0.0).map(|(w, v)| w * v).sum();
        if value.is_finite() {
            means[grid.corner_entry(cell, corner)] = value as f32;
        }
    }
}

/// Where a point lies in a cell, by Newton's method; `None` where that does not find it.
fn parameters(cell: &Hexahedron, point: DVec3) -> Option<DVec3> {
    let mut at = DVec3::ZERO;
    for _ in 0..MOST_ITERATIONS {
        let jacobian = cell.jacobian(at);
        if jacobian.determinant() == 0.0 {
            return None;
        }
        let step = jacobian.inverse() * (point - cell.at(at));
        if !step.is_finite() {
            return None;
        }
        at = (at + step).clamp(DVec3::splat(-3.0), DVec3::splat(3.0));
        if step.abs().max_element() < 1e-9 {
            return Some(at);
        }
    }
    None
}
