//! Cells in which rays meet nothing: those whose values the transfer function makes invisible. Rays pass them as they
//! pass what is not drawn, from one boundary of what is visible to the next.

use rayon::prelude::*;

use super::faces::face_numbers;
use super::frame::ghost;
use super::layout::per_unit;
use super::majorants::Majorants;
use super::{GridFacts, list_entry};
use crate::model::Grid;
use crate::render::RenderError;
use crate::scene::{Interpolation, StrategyKind};
use crate::view::View;

/// Hidden cells among the drawn ones below which it does not pay to list boundaries anew.
const FEWEST_HIDDEN: f64 = 0.05;

/// True where rays can pass the cells in which nothing shows, without a change of the image: a resampled value is also
/// of cells around, an opaque section shows all cells, and where layers cross, the first of two hides the other.
pub fn can_be_passed(view: &View, facts: &GridFacts) -> bool {
    let has_opaque_cut = view.shown.clip.iter().any(|plane| plane.opaque);
    view.casts_rays()
        && view.sampling.strategy != StrategyKind::Srg
        && !has_opaque_cut
        && !facts.layers_cross
}

/// The cells of a grid with their values, as executors hold them.
pub struct HeldCells<'a> {
    /// Layers.
    pub nk: u32,
    /// How values vary inside a cell.
    pub interpolation: Interpolation,
    /// Depth lists of the columns.
    pub lists: &'a [[u32; 4]],
    /// See [`super::Values`].
    pub values: &'a [f32],
    /// See [`super::drawn_words`].
    pub drawn: &'a [[u32; 2]],
    /// See [`super::ghost_words`].
    pub ghosts: Option<&'a [u32]>,
}

impl HeldCells<'_> {
    /// Bits of the drawn cells, in the order of slots, in which a view shows something: those whose smallest and
    /// largest value have one with an extinction between them. `None` where these are all but a few.
    pub fn visible(&self, view: &View) -> Option<Vec<u32>> {
        let majorants = Majorants::new(&view.style.transfer);
        if !majorants.hide_some() {
            return None;
        }
        let range = view.style.transfer.range;
        let (low, scale) = (range[0] as f32, per_unit(range));
        let position = |value: f32| ((value - low) * scale).clamp(0.0, 1.0);
        let shows_ghosts = ghost(view)[3] > 0.0;
        let word = |n: usize| {
            let of_ghosts = self.ghosts.map_or(0, |ghosts| ghosts[n]);
            let [drawn, before] = self.drawn[n];
            let mut left = drawn & !of_ghosts;
            let mut visible = if shows_ghosts { drawn & of_ghosts } else { 0 };
            while left != 0 {
                let bit = left.trailing_zeros();
                left &= left - 1;
                let rank = before + (drawn & ((1 << bit) - 1)).count_ones();
                let [low, high] = self.range(32 * n as u32 + bit, rank).map(position);
                visible |= u32::from(majorants.between(low, high) > 0.0) << bit;
            }
            visible
        };
        let words: Vec<u32> = (0..self.drawn.len()).into_par_iter().map(word).collect();
        let [drawn, visible] = [
            self.drawn.iter().map(|w| w[0].count_ones()).sum::<u32>(),
            words.iter().map(|w| w.count_ones()).sum(),
        ];
        let hidden = f64::from(drawn - visible);
        (hidden > FEWEST_HIDDEN * f64::from(drawn)).then_some(words)
    }

    /// Smallest and largest value of a drawn cell, by its slot and its rank among the drawn ones.
    fn range(&self, slot: u32, rank: u32) -> [f32; 2] {
        if self.interpolation == Interpolation::Cell {
            return [self.values[rank as usize]; 2];
        }
        let (column, layer) = (slot / self.nk, slot % self.nk);
        let mut range = [f32::MAX, f32::MIN];
        for list in self.lists[column as usize] {
            let top = list_entry(list, layer, 0) as usize;
            for value in &self.values[top..top + 2] {
                range = [range[0].min(*value), range[1].max(*value)];
            }
        }
        range
    }
}

/// Boundary faces, by number, of the cells that have a bit, of the grid that rays pass.
///
/// # Errors
/// When the faces of the grid cannot be numbered.
pub fn visible_faces(grid: &Grid, words: &[u32]) -> Result<Vec<u32>, RenderError> {
    let cells = by_active_index(grid, words);
    face_numbers(grid, &grid.boundary_faces(&cells))
}

/// The cells of some bits by active index of the grid that rays pass.
fn by_active_index(grid: &Grid, words: &[u32]) -> Vec<bool> {
    let dims = grid.dims();
    grid.map_active(|column, k| {
        let slot = (column.i + dims.ni * column.j) * dims.nk + k;
        words[slot / 32] >> (slot % 32) & 1 == 1
    })
}
