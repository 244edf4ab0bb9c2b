//! Which cell a point is in, and where in it.

use glam::DVec3;
use rayon::prelude::*;

use super::cell::CellMap;
use super::tree::Tree;
use crate::model::{Grid, Ijk};

/// A point's place in the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located {
    /// The cell.
    pub ijk: Ijk,
    /// Parameters (s, t, r) in [-1, 1]^3, up to rounding.
    pub str: DVec3,
}

/// Finds the drawn cell with thickness that a point is in.
///
/// **Invariants**: a point of several drawn cells (a shared face, an overlap) belongs to the one in the
/// column that comes first (i fastest, then j), and there to the uppermost. Cells that are not drawn take
/// no point from those that are.
#[derive(Debug)]
pub struct Locator {
    /// In the order in which a point prefers them.
    cells: Vec<(Ijk, CellMap)>,
    tree: Tree,
}

impl Locator {
    /// A locator for all active cells of a grid.
    pub fn new(grid: &Grid) -> Self {
        Self::of_drawn(grid, &vec![true; grid.active_cells().len()])
    }

    /// A locator for the cells of a grid that are drawn, by active index.
    pub fn of_drawn(grid: &Grid, drawn: &[bool]) -> Self {
        let dims = grid.dims();
        let mut numbers: Vec<Ijk> = grid
            .active_cells()
            .iter()
            .zip(drawn)
            .filter(|(_, is_drawn)| **is_drawn)
            .map(|(&cell, _)| dims.ijk(cell))
            .filter(|&ijk| grid.has_thickness(ijk))
            .collect();
        numbers.sort_by_key(|ijk| (ijk.j, ijk.i, ijk.k));
        let boxes: Vec<_> = numbers
            .par_iter()
            .map(|&ijk| CellMap::bounds(&grid.hexahedron(ijk)))
            .collect();
        let map = |&ijk| (ijk, CellMap::new(&grid.hexahedron(ijk)));
        Self {
            cells: numbers.par_iter().map(map).collect(),
            tree: Tree::new(&boxes),
        }
    }

    /// The cell that contains a point of grid space; `None` where there is none.
    pub fn locate(&self, point_in_grid: DVec3) -> Option<Located> {
        let mut best: Option<(usize, DVec3)> = None;
        self.tree.near(point_in_grid, &mut |number| {
            if best.is_none_or(|(found, _)| number < found) {
                let parameters = self.cells[number].1.parameters(point_in_grid);
                best = parameters.map(|str| (number, str)).or(best);
            }
        });
        best.map(|(number, str)| Located {
            ijk: self.cells[number].0,
            str,
        })
    }
}
