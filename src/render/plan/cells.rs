//! What is shown of a grid: bits of the drawn cells, and values by cell or by vertex.

use super::compact_grid::pairs;
use crate::model::{Grid, Ijk, VertexField};
use crate::scene::Interpolation;
use crate::view::ShownCells;

/// Slots column by column, layers fastest: bits of the drawn cells (by active index) and the count before each
/// word.
pub fn drawn_words(grid: &Grid, drawn: &[bool]) -> Vec<[u32; 2]> {
    let dims = grid.dims();
    let mut words = vec![[0u32; 2]; dims.cells().div_ceil(32)];
    for (&cell, _) in grid.active_cells().iter().zip(drawn).filter(|(_, d)| **d) {
        let ijk = dims.ijk(cell);
        let slot = (ijk.i + dims.ni * ijk.j) * dims.nk + ijk.k;
        words[slot / 32][0] |= 1 << (slot % 32);
    }
    let mut before = 0;
    for word in &mut words {
        word[1] = before;
        before += word[0].count_ones();
    }
    words
}

/// One bit for each slot: the ghosts among the cells that rays meet; `None` where no ghosts are shown.
pub fn ghost_words(model: &Grid, cells: &ShownCells) -> Option<Vec<u32>> {
    cells.ghosts.as_ref()?;
    let (grid, _) = cells.in_grid(model);
    let all = grid.active_cells().iter();
    let is_ghost: Vec<bool> = all.map(|c| model.active_index(*c).is_none()).collect();
    Some(drawn_words(grid, &is_ghost).iter().map(|w| w[0]).collect())
}

/// The bits of the drawn cells, and behind them those of the ghosts, two words a pair.
pub fn cell_bits(drawn: &[[u32; 2]], ghosts: Option<&[u32]>) -> Vec<[u32; 2]> {
    let ghosts = pairs(ghosts.unwrap_or_default());
    drawn.iter().copied().chain(ghosts).collect()
}

/// The values of what is shown of the case's grid `model`: one for each cell that rays meet, in the order of slots,
/// or one for each entry of the depth lists. None is NaN.
pub fn values(model: &Grid, cells: &ShownCells) -> Vec<f32> {
    match cells.interpolation {
        Interpolation::Cell => column_major(model, cells),
        // Entries that no drawn cell touches are never read.
        Interpolation::Vertex => {
            VertexField::of(model, &cells.field, cells.valued()).into_defined()
        }
    }
}

/// Values in the order of slots; ghosts have none.
fn column_major(model: &Grid, cells: &ShownCells) -> Vec<f32> {
    let (grid, drawn) = cells.in_grid(model);
    let dims = grid.dims();
    let mut values = Vec::new();
    for column in 0..dims.columns() {
        for k in 0..dims.nk {
            let ijk = Ijk {
                i: column % dims.ni,
                j: column / dims.ni,
                k,
            };
            let cell = dims.cell(ijk);
            let active = grid.active_index(cell).map(|a| a.0 as usize);
            if active.is_some_and(|a| drawn.get(a) == Some(&true)) {
                values.push(cells.field.value(model, cell).unwrap_or(0.0));
            }
        }
    }
    values
}
