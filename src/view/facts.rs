//! What is drawn, in numbers.

use glam::DVec3;
use rayon::prelude::*;

use super::ClipPlane;
use crate::case::{Case, Weighting};
use crate::model::{CellField, Grid, Spaces};
use crate::scene::{Coloring, Scene};
use crate::transfer::kinds::Quantity;

/// What is drawn, in numbers: those of what is seen, for the line below the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Active cells of the case.
    pub active: usize,
    /// Those that are drawn and not cut away.
    pub drawn: usize,
    /// What the values of these are like; `None` where none is drawn.
    pub values: Option<Values>,
    /// What the filter keeps, in words; empty where it keeps all.
    pub filter: String,
    /// Clip planes.
    pub planes: usize,
}

/// Values of the drawn cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Mean and what it is weighted by; `None` of numbers of regions, of which there is none.
    pub mean: Option<(f64, Weighting)>,
    /// Every active cell that has a value is drawn.
    pub are_all: bool,
}

impl Facts {
    /// Of a property's true values at the step shown, in the cells that are `seen`.
    ///
    /// **Shape**: `values` and `seen` by active cell.
    pub(super) fn of(
        case: &Case,
        property: &str,
        values: &CellField,
        seen: &[bool],
        scene: &Scene,
    ) -> Self {
        let has_mean = scene.transfer.coloring != Coloring::Categories
            && Quantity::of(property) != Quantity::Region;
        let all = values.values();
        let valued = all.par_iter().filter(|v| !v.is_nan()).count();
        let drawn = seen.par_iter().filter(|s| **s).count();
        let range = range(all, seen);
        let values = range.map(|[min, max]| Values {
            min,
            max,
            mean: has_mean.then(|| mean(case, all, seen)).flatten(),
            are_all: drawn == valued,
        });
        Self {
            active: case.grid.active_cells().len(),
            drawn,
            values,
            filter: scene.filter.words(),
            planes: scene.clip.len(),
        }
    }
}

/// Of the drawn cells those that clip planes do not cut away whole.
pub(super) fn uncut(
    grid: &Grid,
    drawn: &[bool],
    planes: &[ClipPlane],
    spaces: &Spaces,
) -> Vec<bool> {
    if planes.is_empty() {
        return drawn.to_vec();
    }
    let cells = grid.active_cells().par_iter().zip(drawn);
    let seen = cells.map(|(cell, drawn)| {
        *drawn && {
            let corners = grid.hexahedron(grid.dims().ijk(*cell)).0;
            let corners = corners.map(|c| spaces.world_from_grid.transform_point3(c));
            planes.iter().all(|plane| reaches(plane, &corners))
        }
    });
    seen.collect()
}

fn reaches(plane: &ClipPlane, corners: &[DVec3]) -> bool {
    let mut corners = corners.iter();
    corners.any(|c| (*c - plane.point).dot(plane.normal) > 0.0)
}

fn range(values: &[f32], seen: &[bool]) -> Option<[f64; 2]> {
    let start = [f32::INFINITY, f32::NEG_INFINITY];
    let join = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let seen = values.par_iter().zip(seen).filter(|(_, seen)| **seen);
    let [low, high] = seen.map(|(v, _)| [*v; 2]).reduce(|| start, join);
    (low <= high).then_some([low, high].map(f64::from))
}

/// The mean by pore volume, or by what stands in for it.
fn mean(case: &Case, values: &[f32], seen: &[bool]) -> Option<(f64, Weighting)> {
    let weights = case.weights();
    let mean = weighted(values, seen, |n| weights.values[n])?;
    Some((mean, weights.weighting))
}

/// Cells that one thread adds up at a time; sums do not depend on the number of threads.
const PIECE: usize = 1 << 16;

/// The mean by weights; `None` where none is above 0.
fn weighted(values: &[f32], seen: &[bool], weight: impl Fn(usize) -> f32 + Sync) -> Option<f64> {
    let cells = values.par_iter().zip(seen).enumerate();
    let add = |[sum, total]: [f64; 2], (n, (value, seen)): (usize, (&f32, &bool))| {
        let weight = f64::from(weight(n));
        match *seen && !value.is_nan() && weight > 0.0 {
            true => [sum + weight * f64::from(*value), total + weight],
            false => [sum, total],
        }
    };
    let pieces: Vec<[f64; 2]> = cells.fold_chunks(PIECE, || [0.0; 2], add).collect();
    let [sum, total] = [0, 1].map(|n| pieces.iter().map(|piece| piece[n]).sum::<f64>());
    (total > 0.0).then(|| sum / total)
}
