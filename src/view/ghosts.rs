//! Inactive cells shown as a faint ghost.

use std::sync::Arc;

use crate::model::{CellField, Grid};

/// Color (sRGB, 0..1) of inactive cells.
pub const COLOR: [f64; 3] = [0.45, 0.45, 0.5];
/// Their opacity per reference length: enough to see where they are, not to hide what is behind.
pub const OPACITY: f64 = 0.012;

/// The grid in which inactive cells are active, and which of its cells these are.
///
/// **Invariants**: `is_ghost` goes by the active index of this grid, as field and selection of the view
/// do. Ghosts have no value.
#[derive(Debug)]
pub struct Ghosts {
    /// Every cell is active here.
    pub grid: Grid,
    /// True for the cells that the case has as inactive.
    pub is_ghost: Vec<bool>,
}

impl Eq for Ghosts {}

impl PartialEq for Ghosts {
    /// Of one case's grid: which of its cells are ghosts says all.
    fn eq(&self, other: &Self) -> bool {
        self.is_ghost == other.is_ghost
    }
}

impl Ghosts {
    /// Makes ghosts of the inactive cells of `grid`, with field and selection extended to them.
    pub fn new(grid: &Grid, field: &CellField, drawn: &[bool]) -> (Self, CellField, Vec<bool>) {
        let all = grid.with_inactive();
        let active: Vec<Option<usize>> = active_in(grid, &all).collect();
        let values = active
            .iter()
            .map(|a| a.map_or(f32::NAN, |a| field.values()[a]));
        let field = CellField::new(values.collect());
        let is_ghost = active.iter().map(Option::is_none).collect();
        let made = Self {
            grid: all,
            is_ghost,
        };
        let drawn = made.with(grid, drawn);
        (made, field, drawn)
    }

    /// A selection of the active cells of `grid`, the case's, extended to the ghosts that have a thickness.
    pub fn with(&self, grid: &Grid, selected: &[bool]) -> Vec<bool> {
        let all = &self.grid;
        let cells = all.active_cells().iter().zip(active_in(grid, all));
        let shown = cells.map(|(&cell, active)| match active {
            Some(active) => selected[active],
            None => all.has_thickness(all.dims().ijk(cell)),
        });
        shown.collect()
    }
}

/// For each cell of `all` its active index in `grid`.
fn active_in<'a>(grid: &'a Grid, all: &'a Grid) -> impl Iterator<Item = Option<usize>> + 'a {
    let cells = all.active_cells().iter();
    cells.map(|&cell| grid.active_index(cell).map(|a| a.0 as usize))
}

/// What a view's field and selection go by: the case's grid, or the one with the ghosts.
pub fn shown_grid<'a>(grid: &'a Grid, ghosts: Option<&'a Arc<Ghosts>>) -> &'a Grid {
    ghosts.map_or(grid, |g| &g.grid)
}
