//! What is shown of a grid: bits of the drawn cells, and values by cell or by vertex.

use rayon::prelude::*;

use super::compact_grid::pairs;
use super::lists::HeldLists;
use super::packing::round_values;
use crate::model::{ColumnBits, Dims, Grid, Ijk, VertexField};
use crate::scene::{Interpolation, Storage};
use crate::view::ShownCells;

/// Slots column by column, layers fastest: bits of the drawn cells (by active index) and the count before each
/// word.
pub fn drawn_words(grid: &Grid, drawn: &[bool]) -> Vec<[u32; 2]> {
    let bits = packed(grid.dims(), &grid.bits_of(drawn));
    let mut before = 0;
    let counted = bits.into_iter().map(|word| {
        let counted = [word, before];
        before += word.count_ones();
        counted
    });
    counted.collect()
}

/// Bits of columns without gaps between them, in words of 32.
fn packed(dims: Dims, bits: &ColumnBits) -> Vec<u32> {
    let mut words = vec![0u64; dims.cells().div_ceil(64) + 1];
    for column in 0..dims.columns() {
        for (n, bits) in bits.column(column).iter().enumerate() {
            let slot = column * dims.nk + 64 * n;
            let (word, shift) = (slot / 64, slot % 64);
            words[word] |= bits << shift;
            // What does not fit; shifted twice, for by all 64 bits cannot be.
            words[word + 1] |= bits >> 1 >> (63 - shift);
        }
    }
    let halves = words
        .iter()
        .flat_map(|word| [*word as u32, (word >> 32) as u32]);
    halves.take(dims.cells().div_ceil(32)).collect()
}

/// One bit for each slot: the ghosts among the cells that rays meet; `None` where no ghosts are shown.
pub fn ghost_words(model: &Grid, cells: &ShownCells) -> Option<Vec<u32>> {
    cells.ghosts.as_ref()?;
    let (grid, _) = cells.in_grid(model);
    let all = grid.active_cells().iter();
    let is_ghost: Vec<bool> = all.map(|c| model.active_index(*c).is_none()).collect();
    Some(drawn_words(grid, &is_ghost).iter().map(|w| w[0]).collect())
}

/// The bits of the drawn cells, and behind them, two words a pair, those of the ghosts and of the visible cells.
pub fn cell_bits(
    drawn: &[[u32; 2]],
    ghosts: Option<&[u32]>,
    visible: Option<&[u32]>,
) -> Vec<[u32; 2]> {
    let [ghosts, visible] = [ghosts, visible].map(|bits| pairs(bits.unwrap_or_default()));
    drawn.iter().copied().chain(ghosts).chain(visible).collect()
}

/// The values of what is shown of a grid.
#[derive(Default)]
pub struct Values {
    /// One for each cell that rays meet, in the order of slots, or one for each entry of the depth lists that are used.
    /// None is NaN.
    pub held: Vec<f32>,
    /// The largest change that rounding has made.
    pub error: f64,
}

impl Values {
    /// Of the case's grid `model`.
    pub fn new(model: &Grid, cells: &ShownCells, storage: Storage) -> Self {
        let mut held = match cells.interpolation {
            Interpolation::Cell => column_major(model, cells),
            Interpolation::Vertex => at_vertices(model, cells, storage),
        };
        let error = match storage {
            Storage::Exact => 0.0,
            Storage::Compact => round_values(&mut held),
        };
        Self { held, error }
    }
}

/// Values at the entries of the depth lists that are used. Those that no drawn cell touches are never read: 0, or NaN
/// where they are to be rounded with others.
fn at_vertices(model: &Grid, cells: &ShownCells, storage: Storage) -> Vec<f32> {
    let unknown = match storage {
        Storage::Exact => 0.0,
        Storage::Compact => f32::NAN,
    };
    let values = VertexField::of(model, &cells.field, cells.valued());
    let (grid, _) = cells.in_grid(model);
    let known = |value: f32| if value.is_nan() { unknown } else { value };
    HeldLists::new(grid, storage).of(values.values(), known)
}

/// Values in the order of slots; ghosts have none.
fn column_major(model: &Grid, cells: &ShownCells) -> Vec<f32> {
    let (grid, drawn) = cells.in_grid(model);
    let dims = grid.dims();
    let drawn = grid.bits_of(drawn);
    let value = |column: usize, k: usize| {
        let (i, j) = (column % dims.ni, column / dims.ni);
        let value = cells.field.value(model, dims.cell(Ijk { i, j, k }));
        value.unwrap_or(0.0)
    };
    let columns = (0..dims.columns()).into_par_iter();
    let values = columns.flat_map_iter(|column| {
        let layers = drawn.layers(column);
        layers.map(move |k| value(column, k))
    });
    values.collect()
}
