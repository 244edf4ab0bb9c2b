//! Which cells are active: an irregular outline with holes, without cells that have no thickness.

use glam::DVec2;
use rayon::prelude::*;

use super::noise::Noise;
use super::structure::Structure;
use crate::model::corner_point::NO_THICKNESS;

/// Holes in the outline, and their radius in parts of the longer side.
const HOLES: usize = 3;
const HOLE_RADIUS: f64 = 0.045;

/// ACTNUM with about this share of all cells active, fewer where more have no thickness.
pub(super) fn actnum(
    structure: &Structure,
    zcorn: &[f32],
    share: f64,
    random: &mut fastrand::Rng,
) -> Vec<i32> {
    let dims = structure.dims;
    let mut actnum = thick_cells(structure, zcorn);
    let counts = (0..dims.columns()).into_par_iter().map(|column| {
        let layers = actnum[column..].iter().step_by(dims.columns());
        layers.filter(|a| **a != 0).count()
    });
    let counts: Vec<usize> = counts.collect();
    let mut left = ((share * dims.cells() as f64).round() as usize).max(1);
    let mut keep = vec![false; dims.columns()];
    for column in by_score(structure, random) {
        if left == 0 {
            break;
        }
        keep[column] = true;
        left = left.saturating_sub(counts[column]);
    }
    let layers = actnum.par_chunks_exact_mut(dims.columns());
    layers.for_each(|layer| {
        for (active, keep) in layer.iter_mut().zip(&keep) {
            *active *= i32::from(*keep);
        }
    });
    actnum
}

/// 1 for each cell with a corner height above nothing.
fn thick_cells(structure: &Structure, zcorn: &[f32]) -> Vec<i32> {
    let dims = structure.dims;
    let mut actnum = vec![0; dims.cells()];
    let layers = actnum.par_chunks_exact_mut(dims.columns());
    let planes = zcorn.par_chunks_exact(8 * dims.columns());
    layers.zip(planes).for_each(|(layer, planes)| {
        let (top, bottom) = planes.split_at(4 * dims.columns());
        for (corner, (top, bottom)) in top.iter().zip(bottom).enumerate() {
            let (x, y) = (corner % (2 * dims.ni), corner / (2 * dims.ni));
            if f64::from(bottom - top) > NO_THICKNESS {
                layer[x / 2 + dims.ni * (y / 2)] = 1;
            }
        }
    });
    actnum
}

/// All columns from the heart of the field outward, those in a hole last.
fn by_score(structure: &Structure, random: &mut fastrand::Rng) -> Vec<usize> {
    let extent = structure.extent();
    let noise = Noise::new(random);
    let mut place = || DVec2::new(random.f64(), random.f64()) * extent;
    let holes: [DVec2; HOLES] = std::array::from_fn(|_| place());
    let score = |column: usize| {
        let p = structure.center(column);
        let from_middle = (p / extent - 0.5).length();
        let in_hole = holes.iter().any(|h| {
            let radius = HOLE_RADIUS * (1.0 + 0.5 * noise.at(20.0 * p));
            h.distance(p) < radius
        });
        0.22 * noise.at(5.0 * p) - from_middle - if in_hole { 10.0 } else { 0.0 }
    };
    let columns = (0..structure.dims.columns()).into_par_iter();
    let mut scored: Vec<(f64, usize)> = columns.map(|c| (score(c), c)).collect();
    scored.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    scored.into_iter().map(|s| s.1).collect()
}
