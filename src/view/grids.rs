//! Which grids of a model are drawn: local ones in place of the cells that they refine.

use super::error::{SceneError, wrong};
use crate::model::{CellIndex, Grid, Ijk};
use crate::scene::Grids;

/// The cells of the grids that are drawn.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ShownGrids {
    /// By number of the grid: true where none of its cells are drawn.
    hidden: Vec<bool>,
    /// Cells that grids which are drawn refine, sorted.
    refined: Vec<CellIndex>,
}

impl ShownGrids {
    /// Those of a scene.
    ///
    /// # Errors
    /// When it hides a grid that is not there.
    pub(super) fn of(scene: &Grids, grid: &Grid) -> Result<Self, SceneError> {
        let patches = grid.patches();
        let mut hidden = vec![false; patches.len()];
        for name in &scene.hidden {
            match grid.patch_named(name).filter(|number| *number > 0) {
                Some(number) => hidden[number] = true,
                None => return Err(unknown(name, grid)),
            }
        }
        for (number, hidden) in hidden.iter_mut().enumerate() {
            *hidden |= grid.leaves_out(number);
        }
        // Parents come first. What refines a hidden grid is hidden with it.
        for number in 1..patches.len() {
            hidden[number] |= hidden[patches[number].parent];
        }
        let shown = (1..patches.len()).filter(|number| !hidden[*number]);
        let hosts = shown.flat_map(|number| grid.hosts_of(number));
        let mut refined: Vec<CellIndex> = hosts.map(|(_, host)| grid.dims().cell(host)).collect();
        refined.sort_unstable();
        refined.dedup();
        Ok(Self { hidden, refined })
    }

    /// True where all cells are drawn.
    pub(super) fn are_all(&self) -> bool {
        self.refined.is_empty() && !self.hidden.contains(&true)
    }

    /// By active index the cells that count where numbers are told: those of [`Self::shows`], of which several that are
    /// one cell of a file count once. `None` where all do.
    pub(super) fn counted(&self, grid: &Grid) -> Option<Vec<bool>> {
        if grid.patches().len() == 1 {
            return None;
        }
        let cells = grid.active_cells().iter();
        let counts = cells.map(|cell| {
            let at = grid.dims().ijk(*cell);
            grid.is_first(at) && self.shows(grid, at)
        });
        Some(counts.collect())
    }

    /// True where a cell is of a grid that is drawn, and no other such grid refines it.
    pub(super) fn shows(&self, grid: &Grid, cell: Ijk) -> bool {
        let is_hidden = |number: usize| self.hidden.get(number).is_some_and(|hidden| *hidden);
        let number = grid.dims().cell(cell);
        !grid.patch_of(cell).is_some_and(is_hidden) && self.refined.binary_search(&number).is_err()
    }
}

fn unknown(name: &str, grid: &Grid) -> SceneError {
    let known: Vec<&str> = grid.patches()[1..]
        .iter()
        .map(|p| p.name.as_str())
        .collect();
    let known = match known[..] {
        [] => "this case has none".to_owned(),
        _ => format!("this case has {}", known.join(", ")),
    };
    wrong(
        "grids.hidden",
        format!("there is no local grid {name}; {known}"),
    )
}
