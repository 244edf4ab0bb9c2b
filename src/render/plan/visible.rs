//! Cells in which rays meet nothing: those whose values the transfer function makes invisible. Rays pass them as they
//! pass what is not drawn, from one boundary of what is visible to the next.

use rayon::prelude::*;

use super::frame::ghost;
use super::layout::per_unit;
use super::majorants::Majorants;
use crate::model::Grid;
use crate::view::View;

/// Hidden cells among the drawn ones below which it does not pay to list boundaries anew.
const FEWEST_HIDDEN: f64 = 0.05;

/// Bits of the cells, in the order of slots, in which a view shows something: of the drawn ones (`drawn_words`) those
/// whose smallest and largest value, given by slot, include one with an extinction. `None` where rays meet all drawn
/// cells.
pub fn visible_words(
    view: &View,
    drawn: &[[u32; 2]],
    ghosts: Option<&[u32]>,
    range: impl Fn(usize) -> [f32; 2] + Sync,
) -> Option<Vec<u32>> {
    let majorants = Majorants::new(&view.style.transfer);
    if !majorants.hide_some() {
        return None;
    }
    let values = view.style.transfer.range;
    let (low, scale) = (values[0] as f32, per_unit(values));
    let position = |value: f32| ((value - low) * scale).clamp(0.0, 1.0);
    let shows_ghosts = ghost(view)[3] > 0.0;
    let is_visible = |slot: usize| {
        let [low, high] = range(slot).map(position);
        majorants.between(low, high) > 0.0
    };
    let word = |n: usize| {
        let of_ghosts = ghosts.map_or(0, |ghosts| ghosts[n]);
        let mut left = drawn[n][0] & !of_ghosts;
        let mut visible = match shows_ghosts {
            true => drawn[n][0] & of_ghosts,
            false => 0,
        };
        while left != 0 {
            let bit = left.trailing_zeros();
            left &= left - 1;
            visible |= u32::from(is_visible(32 * n + bit as usize)) << bit;
        }
        visible
    };
    let words: Vec<u32> = (0..drawn.len()).into_par_iter().map(word).collect();
    let count = |words: &mut dyn Iterator<Item = u32>| words.map(u32::count_ones).sum::<u32>();
    let of_drawn = count(&mut drawn.iter().map(|word| word[0]));
    let hidden = of_drawn - count(&mut words.iter().copied());
    (f64::from(hidden) > FEWEST_HIDDEN * f64::from(of_drawn)).then_some(words)
}

/// The cells of some bits by active index of the grid that rays pass.
pub fn by_active_index(grid: &Grid, words: &[u32]) -> Vec<bool> {
    let dims = grid.dims();
    grid.map_active(|column, k| {
        let slot = (column.i + dims.ni * column.j) * dims.nk + k;
        words[slot / 32] >> (slot % 32) & 1 == 1
    })
}
