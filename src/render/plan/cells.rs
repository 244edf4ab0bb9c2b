//! What is shown of a grid: bits of the drawn cells, and values by cell or by vertex.

use crate::model::{CellField, Grid, Ijk, VertexField};
use crate::scene::Interpolation;

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

/// The values of a field: one for each drawn cell in the order of slots, or one for each entry of the depth lists.
/// None is NaN.
pub fn values(
    grid: &Grid,
    field: &CellField,
    drawn: &[bool],
    interpolation: Interpolation,
) -> Vec<f32> {
    match interpolation {
        Interpolation::Cell => column_major(grid, field, drawn),
        // Entries that no drawn cell touches are never read.
        Interpolation::Vertex => {
            let vertices = VertexField::new(grid, field);
            vertices.values().iter().map(|v| or_zero(*v)).collect()
        }
    }
}

/// Values of the drawn cells in slot order.
fn column_major(grid: &Grid, field: &CellField, drawn: &[bool]) -> Vec<f32> {
    let dims = grid.dims();
    let mut values = Vec::new();
    for column in 0..dims.columns() {
        for k in 0..dims.nk {
            let ijk = Ijk {
                i: column % dims.ni,
                j: column / dims.ni,
                k,
            };
            if let Some(active) = grid.active_index(dims.cell(ijk)) {
                let active = active.0 as usize;
                if drawn.get(active) == Some(&true) {
                    // Ghosts have none.
                    values.push(or_zero(field.values()[active]));
                }
            }
        }
    }
    values
}

fn or_zero(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value }
}
