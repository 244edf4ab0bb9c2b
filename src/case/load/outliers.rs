//! Numbers of a grid file that can be no coordinates, and the cells at them.

use rayon::prelude::*;

use super::slots::CellSlots;
use crate::model::{FAR, Grid, GridInput, ModelError};

/// What stands for a coordinate that is no finite number: cells at it are outliers.
const NOWHERE: f32 = 1e30;
/// Cells that a note names.
const NAMED: usize = 3;
/// Part of an array that may be damaged.
const MOST: usize = 4;
/// Numbers of a pillar.
const PILLAR: usize = 6;

/// Values that a file may have instead of a coordinate.
pub trait Coordinate: Copy + Into<f64> + From<f32> + Send + Sync {}

impl Coordinate for f32 {}
impl Coordinate for f64 {}

/// The grid of arrays that may have numbers that are not finite: cells at them are far away. A note says how many.
///
/// # Errors
/// As [`Grid::new`], which refuses arrays with many such numbers.
pub fn built<C: Coordinate, Z: Coordinate>(
    input: &GridInput<'_, C, Z>,
    notes: &mut Vec<String>,
) -> Result<Grid, ModelError> {
    let coord = replaced(input.coord, PILLAR);
    let zcorn = replaced(input.zcorn, 1);
    let counts = [coord.as_ref().map(|c| c.1), zcorn.as_ref().map(|z| z.1)];
    for (keyword, count) in ["COORD", "ZCORN"].into_iter().zip(counts) {
        notes.extend(count.map(|count| {
            format!("{keyword} has {count} values that are no finite numbers: active cells at them are left out")
        }));
    }
    Grid::new(&GridInput {
        coord: coord.as_ref().map_or(input.coord, |(values, _)| values),
        zcorn: zcorn.as_ref().map_or(input.zcorn, |(values, _)| values),
        ..*input
    })
}

/// Values in groups, those of each group with a number that is not finite replaced, and how many are not; `None`
/// where all are finite, or too few.
fn replaced<T: Coordinate>(values: &[T], group: usize) -> Option<(Vec<T>, usize)> {
    let is_finite = |value: &T| -> bool {
        let value: f64 = (*value).into();
        value.is_finite()
    };
    let count = values.par_iter().filter(|value| !is_finite(value)).count();
    if count == 0 || count > values.len() / MOST {
        return None;
    }
    let mut values = values.to_vec();
    for group in values.chunks_mut(group) {
        if !group.iter().all(is_finite) {
            group.fill(T::from(NOWHERE));
        }
    }
    Some((values, count))
}

/// Leaves out the cells far outside of the model; the note about them.
pub fn leave_out(grid: &mut Grid, slots: &mut CellSlots) -> Option<String> {
    let left = grid.leave_outliers();
    slots.leave_out(&left);
    let names = left.iter().take(NAMED).map(|cell| {
        let [i, j, k] = grid.dims().ijk(*cell).one_based();
        format!("({i},{j},{k})")
    });
    let names = names.collect::<Vec<_>>().join(", ");
    let more = if left.len() > NAMED { ", ..." } else { "" };
    (!left.is_empty()).then(|| {
        format!(
            "cells with corners more than {FAR} times the extent of the model away from it are left out: {} of them, {names}{more}",
            left.len()
        )
    })
}
