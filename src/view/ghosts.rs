//! Inactive cells shown as a faint ghost.

use super::grids::ShownGrids;
use crate::model::{Grid, Ijk};

/// Color (sRGB, 0..1) of inactive cells.
pub const COLOR: [f64; 3] = [0.45, 0.45, 0.5];
/// Their opacity per reference length: enough to see where they are, not to hide what is behind.
pub const OPACITY: f64 = 0.012;

/// The grid in which inactive cells are active, and which of its cells are drawn.
///
/// The geometry is the case's own. Ghosts have no value.
#[derive(Debug)]
pub struct Ghosts {
    /// Every cell is active here.
    pub grid: Grid,
    /// By active index of this grid: the drawn cells of the case, and the ghosts that have a thickness.
    pub drawn: Vec<bool>,
    /// Where there can be ghosts.
    grids: ShownGrids,
}

impl Ghosts {
    /// Makes ghosts of the inactive cells of `grid`, the case's, beside the cells of it that are drawn.
    pub fn new(grid: &Grid, grids: &ShownGrids, drawn: &[bool]) -> Self {
        let mut ghosts = Self {
            grid: grid.with_inactive(),
            drawn: Vec::new(),
            grids: grids.clone(),
        };
        ghosts.drawn = ghosts.with(grid, drawn);
        ghosts
    }

    /// A selection of the active cells of `grid`, the case's, extended to the ghosts that have a thickness.
    pub fn with(&self, grid: &Grid, selected: &[bool]) -> Vec<bool> {
        let all = &self.grid;
        let shown = all.active_cells().iter().map(|&cell| {
            let active = grid.active_index(cell).map(|a| a.0 as usize);
            active.map_or_else(|| self.can_be(all.dims().ijk(cell)), |a| selected[a])
        });
        shown.collect()
    }

    /// True where an inactive cell can be seen.
    fn can_be(&self, cell: Ijk) -> bool {
        self.grid.has_thickness(cell) && self.grids.shows(&self.grid, cell)
    }
}
