//! The grid in the form in which executors read it: pillars, shared depth lists, bins, all relative to an origin.

use std::time::{Duration, Instant};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::accel::AccelGrid;
use super::columns::{self, ColumnShape};
#[cfg(test)]
use super::layout::BIN_IS_ODD;
use super::layout::{COLUMN_FLAG, GridInfo, LIST_GAPPED, LIST_OFFSET};
use super::lists::HeldLists;
use super::packing::round_depths;
use crate::model::{DepthList, Grid};
use crate::render::RenderError;
use crate::scene::Storage;

/// What is true of a grid as a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridFacts {
    /// Origin of the coordinates in grid space.
    pub origin: DVec3,
    /// Box of the active cells relative to the origin.
    pub bounds: [DVec3; 2],
    /// True where all pillars are vertical, so that points are located in closed form.
    pub vertical: bool,
    /// True where the layers of some column cross, so that cells may overlap.
    pub layers_cross: bool,
    /// +1 where the cells are right-handed in grid space, else -1.
    pub handedness: f32,
}

/// A grid in compact form, without what is shown of it. `shaders/shared/grid.wgsl` says what the arrays hold.
pub struct CompactGrid {
    /// What is true of it as a whole.
    pub facts: GridFacts,
    /// Time that building the acceleration grid took.
    pub acceleration_time: Duration,
    /// Sizes of the grid and of its acceleration grid.
    pub info: GridInfo,
    /// Of each pillar x, y at the origin's depth, what rounding to f32 cut off there, and their change per unit of
    /// depth.
    pub pillars: Vec<[[f32; 2]; 3]>,
    /// The four depth lists of each column, with flags.
    pub column_lists: Vec<[u32; 4]>,
    /// The pool of depth lists.
    pub depths: Vec<f32>,
    /// How depths and values are held; compact ones are rounded to what can be packed.
    pub storage: Storage,
    /// The largest change that rounding has made of a depth.
    pub depth_error: f64,
    /// First entry in `bin_columns` and depth range of each bin; one more than there are bins.
    pub bins: Vec<[u32; 2]>,
    /// Columns of the bins.
    pub bin_columns: Vec<u32>,
}

impl CompactGrid {
    /// Brings a grid into compact form.
    ///
    /// # Errors
    /// When its depth lists have more entries than can be numbered.
    pub fn new(grid: &Grid, storage: Storage) -> Result<Self, RenderError> {
        let used = grid.used_depths();
        if used.count() > LIST_OFFSET as usize {
            return Err(RenderError::TooLarge {
                what: "depth lists",
                needed: 4 * used.count() as u64,
                limit: 4 * u64::from(LIST_OFFSET),
            });
        }
        let bounds = grid.bounds().unwrap_or([DVec3::ZERO, DVec3::ONE]);
        let origin = round_origin(bounds);
        let start = Instant::now();
        let shapes = columns::shapes(grid);
        let accel = AccelGrid::new(grid, &shapes, origin, storage);
        let acceleration_time = start.elapsed();
        let dims = grid.dims();
        let lists = 3 * grid.pillars().len();
        let bins = lists + 2 * dims.columns();
        let held = HeldLists::new(grid, storage);
        let mut depths = held.of(grid.depths(), |depth| (depth - origin.z) as f32);
        let depth_error = match storage {
            Storage::Exact => 0.0,
            Storage::Compact => round_depths(&mut depths, &held.pillars()),
        };
        // At least those of one list, which columns without active cells have.
        depths.resize(depths.len().max(dims.nk + 1), 0.0);
        Ok(Self {
            facts: GridFacts {
                origin,
                bounds: bounds.map(|b| b - origin),
                vertical: grid.pillars().iter().all(|p| p.slope() == DVec2::ZERO),
                layers_cross: shapes.iter().any(|s| s.layers_cross),
                handedness: if grid.signed_bulk_volume() < 0.0 {
                    -1.0
                } else {
                    1.0
                },
            },
            acceleration_time,
            info: GridInfo {
                ni: dims.ni as u32,
                nj: dims.nj as u32,
                nk: dims.nk as u32,
                bins_x: accel.size[0],
                bins_y: accel.size[1],
                ghosts: dims.cells().div_ceil(32) as u32,
                bin_origin: accel.origin.as_vec2().to_array(),
                bin_size: accel.bin.as_vec2().to_array(),
                depth_low: accel.depth[0] as f32,
                depth_scale: accel.depth[1] as f32,
                column_lists: lists as u32,
                bins: bins as u32,
                bin_columns: (bins + accel.bins.len()) as u32,
                visible: 0,
            },
            pillars: pillars(grid, origin),
            column_lists: column_lists(grid, &held, &shapes),
            depths,
            storage,
            depth_error,
            bins: accel.bins,
            bin_columns: accel.columns,
        })
    }

    /// Pillars, depth lists of columns, bins and their columns one after the other, from where [`Self::info`] says.
    pub fn words(&self) -> Vec<[u32; 2]> {
        let pillars: &[[u32; 2]] = bytemuck::cast_slice(&self.pillars);
        let lists: &[[u32; 2]] = bytemuck::cast_slice(&self.column_lists);
        let mut words = [pillars, lists, &self.bins].concat();
        words.extend(pairs(&self.bin_columns));
        words
    }

    /// Empties the bins of the lower half of x, so that tests have a grid in which points are lost.
    #[cfg(test)]
    pub(crate) fn lose_half(&mut self) {
        for row in self.bins.chunks_exact_mut(self.info.bins_x as usize) {
            let half = row.len() / 2;
            // Odd ones are searched, whatever faces are there.
            let next = row[half][0] | BIN_IS_ODD;
            row[..half].iter_mut().for_each(|bin| bin[0] = next);
        }
    }
}

/// Position in the depth lists of a layer's top (0) or bottom (1), by a column's list with its flags.
#[inline]
pub fn list_entry(list: u32, layer: u32, bottom: u32) -> u32 {
    let step = if list & LIST_GAPPED != 0 { 2 } else { 1 };
    (list & LIST_OFFSET) + step * layer + bottom
}

/// Words two by two; the last one of an odd number has a zero beside it.
pub fn pairs(words: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    words.chunks(2).map(|pair| match *pair {
        [a, b] => [a, b],
        _ => [pair[0], 0],
    })
}

/// The middle of the model, rounded so coarsely that coordinates that were f32 in the file stay
/// exact when it is subtracted.
fn round_origin([low, high]: [DVec3; 2]) -> DVec3 {
    let extent = (high - low).max_element().max(1e-6);
    let grain = (extent.log2().floor() - 10.0).min(0.0).exp2();
    (0.5 * (low + high) / grain).round() * grain
}

fn pillars(grid: &Grid, origin: DVec3) -> Vec<[[f32; 2]; 3]> {
    let compact = grid.pillars().iter().map(|p| {
        let at = (p.at(origin.z) - origin).truncate();
        let low_bits = at - at.as_vec2().as_dvec2();
        [at, low_bits, p.slope()].map(|v| v.as_vec2().to_array())
    });
    compact.collect()
}

/// The lists of columns; those of a column without active cells are another one's, of which no cell is asked.
fn column_lists(grid: &Grid, held: &HeldLists<'_>, shapes: &[ColumnShape]) -> Vec<[u32; 4]> {
    let reference = |list: DepthList| match held.offset(list) {
        Some(offset) => offset as u32 | if list.gapped() { LIST_GAPPED } else { 0 },
        None => 0,
    };
    shapes
        .par_iter()
        .enumerate()
        .map(|(column, shape)| {
            let mut lists = grid.column_lists(column).map(reference);
            if shape.layers_cross {
                lists[0] |= COLUMN_FLAG;
            }
            for bit in 0..3 {
                if shape.margin_level >> bit & 1 == 1 {
                    lists[bit + 1] |= COLUMN_FLAG;
                }
            }
            lists
        })
        .collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::model::GridInput;
    use crate::model::synthetic::Recipe;

    #[test]
    fn depths_are_those_of_columns_with_active_cells() {
        let recipe = Recipe::named("r3").unwrap();
        let geometry = recipe.build(recipe.dims, 1, 1).unwrap().geometry;
        let grid = Grid::new(&GridInput {
            dims: geometry.dims,
            coord: &geometry.coord,
            zcorn: &geometry.zcorn,
            actnum: Some(&geometry.actnum),
            map_axes: None,
        });
        let grid = grid.unwrap();
        let compact = CompactGrid::new(&grid, Storage::Exact).unwrap();
        assert!(compact.depths.len() < grid.depths().len() * 3 / 4);
        for cell in grid.active_cells() {
            let ijk = grid.dims().ijk(*cell);
            let lists = compact.column_lists[ijk.i + grid.dims().ni * ijk.j];
            for corner in 0..8 {
                let list = lists[corner & 3];
                let step = if list & LIST_GAPPED != 0 { 2 } else { 1 };
                let entry = (list & LIST_OFFSET) as usize + step * ijk.k + (corner >> 2);
                let depth = grid.corner_depth(ijk, corner) - compact.facts.origin.z;
                assert_eq!(compact.depths[entry], depth as f32);
            }
        }
        // With ghosts all are there.
        let all = CompactGrid::new(&grid.with_inactive(), Storage::Exact).unwrap();
        assert_eq!(all.depths.len(), grid.depths().len());
    }
}
