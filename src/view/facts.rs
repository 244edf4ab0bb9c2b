//! What is drawn, in numbers.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use super::ClipPlane;
use super::grids::ShownGrids;
use crate::case::{Case, Weighting};
use crate::model::{CellField, Grid, Spaces};
use crate::scene::{Coloring, Scene};
use crate::transfer::kinds::Quantity;

/// What is drawn, in numbers: those of what is seen, for the line below the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Active cells of the grids shown.
    pub active: usize,
    /// Those that are drawn and not cut away.
    pub drawn: usize,
    /// What the values of these are like; `None` where none is drawn.
    pub values: Option<Values>,
    /// What the filter keeps and which local grids are hidden, in words; empty where all is drawn.
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
        (seen, grids): (&[bool], &ShownGrids),
        scene: &Scene,
    ) -> Self {
        let has_mean = scene.transfer.coloring != Coloring::Categories
            && Quantity::of(property) != Quantity::Region;
        let counts = grids.counted(&case.grid);
        let active = counts.as_ref().map_or(values.values().len(), |counts| {
            counts.iter().filter(|counts| **counts).count()
        });
        let (all, seen) = match &counts {
            None => (Cow::from(values.values()), Cow::from(seen)),
            Some(counts) => {
                let value =
                    |(value, counts): (&f32, &bool)| if *counts { *value } else { f32::NAN };
                let all: Vec<f32> = values.values().iter().zip(counts).map(value).collect();
                let seen: Vec<bool> = seen.iter().zip(counts).map(|(a, b)| *a && *b).collect();
                (all.into(), seen.into())
            }
        };
        let Counted {
            valued,
            drawn,
            range,
        } = Counted::of(&all, &seen);
        let values = range.map(|[min, max]| Values {
            min,
            max,
            mean: has_mean
                .then(|| mean(case, property, &all, &seen))
                .flatten(),
            are_all: drawn == valued,
        });
        Self {
            active,
            drawn,
            values,
            filter: words(case, scene),
            planes: scene.clip.len(),
        }
    }
}

/// What is not drawn for the filter and the grids that are hidden.
fn words(case: &Case, scene: &Scene) -> String {
    let hidden = &scene.grids.hidden;
    let hidden = (!hidden.is_empty()).then(|| format!("without {}", hidden.join(", ")));
    let mut filter = scene.filter.clone();
    for row in &mut filter.properties {
        let measure = case.measure(&row.name, scene.units.into());
        for bound in row.min.iter_mut().chain(&mut row.max) {
            *bound = measure.show(*bound);
        }
    }
    let all = [Some(filter.words()), hidden];
    let all = all.into_iter().flatten().filter(|text| !text.is_empty());
    all.collect::<Vec<_>>().join(", ")
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

/// Cells that one thread looks at at a time; sums over them do not depend on the number of threads.
const PIECE: usize = 1 << 16;

/// Numbers of cells.
struct Counted {
    /// With a value.
    valued: usize,
    /// Seen.
    drawn: usize,
    /// Smallest and largest value of those that are seen.
    range: Option<[f64; 2]>,
}

impl Counted {
    fn of(values: &[f32], seen: &[bool]) -> Self {
        type Sums = (usize, usize, [f32; 2]);
        let none: Sums = (0, 0, [f32::INFINITY, f32::NEG_INFINITY]);
        let add = |(valued, drawn, [low, high]): Sums, (value, seen): (&f32, &bool)| {
            let ends = match seen {
                true => [value.min(low), value.max(high)],
                false => [low, high],
            };
            (
                valued + usize::from(!value.is_nan()),
                drawn + usize::from(*seen),
                ends,
            )
        };
        let pieces = values.par_chunks(PIECE).zip(seen.par_chunks(PIECE));
        let pieces = pieces.map(|(values, seen)| values.iter().zip(seen).fold(none, add));
        let (valued, drawn, [low, high]) = pieces.reduce(
            || none,
            |a, b| {
                let [low, high] = b.2;
                (a.0 + b.0, a.1 + b.1, [a.2[0].min(low), a.2[1].max(high)])
            },
        );
        Self {
            valued,
            drawn,
            range: (low <= high).then_some([low, high].map(f64::from)),
        }
    }
}

/// The mean by pore volume, or by what stands in for it.
fn mean(case: &Case, property: &str, values: &[f32], seen: &[bool]) -> Option<(f64, Weighting)> {
    let weights = case.weights_of(property);
    let mean = weighted(values, seen, &weights.values)?;
    Some((mean, weights.weighting))
}

/// The mean by weights; `None` where none is above 0.
fn weighted(values: &[f32], seen: &[bool], weights: &[f32]) -> Option<f64> {
    let add = |[sum, total]: [f64; 2], ((value, seen), weight): ((&f32, &bool), &f32)| {
        let weight = f64::from(*weight);
        match *seen && !value.is_nan() && weight > 0.0 {
            true => [sum + weight * f64::from(*value), total + weight],
            false => [sum, total],
        }
    };
    let pieces = values.par_chunks(PIECE).zip(seen.par_chunks(PIECE));
    let pieces = pieces.zip(weights.par_chunks(PIECE));
    let sums = pieces.map(|((values, seen), weights)| {
        let cells = values.iter().zip(seen).zip(weights);
        cells.fold([0.0; 2], add)
    });
    let sums: Vec<[f64; 2]> = sums.collect();
    let [sum, total] = [0, 1].map(|n| sums.iter().map(|sum| sum[n]).sum::<f64>());
    (total > 0.0).then(|| sum / total)
}
