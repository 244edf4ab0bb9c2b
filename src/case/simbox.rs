//! A case in index space (simbox): the same cells with the same values, flat and square.

use std::sync::{Arc, OnceLock};

use super::{About, Case};
use crate::model::{Grid, Space};

/// A case in index space, made at the first question.
///
/// Cases that share a grid share the flat one too.
#[derive(Default)]
pub struct Simbox {
    pub(super) grid: Arc<OnceLock<Arc<Grid>>>,
    case: OnceLock<Arc<Case>>,
}

impl Simbox {
    /// That of a case whose grid has a flat copy already, or a place for it.
    pub(super) fn of_grid(grid: Arc<OnceLock<Arc<Grid>>>) -> Self {
        Self {
            grid,
            case: OnceLock::new(),
        }
    }

    /// That of another case with the same grid.
    pub(super) fn of_same_grid(&self) -> Self {
        Self {
            grid: self.grid.clone(),
            case: OnceLock::new(),
        }
    }
}

impl Case {
    /// The case in a space, given in map space. Values, also those that follow from the geometry such as DEPTH, are the
    /// same in both. Made at the first call.
    pub fn in_space(self: &Arc<Self>, space: impl Into<Space>) -> Arc<Self> {
        match space.into() {
            Space::Ijk if self.grid.space().is_map() => {
                let made = || Arc::new(self.flattened());
                self.simbox.case.get_or_init(made).clone()
            }
            _ => self.clone(),
        }
    }

    fn flattened(&self) -> Self {
        let flat = || Arc::new(self.grid.flattened());
        let grid = self.simbox.grid.get_or_init(flat).clone();
        let patches = grid.patches().iter().enumerate();
        let left_out = patches.filter(|(number, _)| grid.leaves_out(*number));
        let notes = left_out.map(|(_, patch)| {
            format!(
                "local grid {} is not shown by I, J and K; its place shows the host cells: its rows do not follow theirs",
                patch.name
            )
        });
        Self {
            about: About {
                notes: notes.collect(),
                ..self.about.clone()
            },
            grid,
            cache: self.cache.clone(),
            wells: self.wells.clone(),
            over_steps: self.over_steps.clone(),
            minus: self.minus.clone(),
            simbox: Simbox::default(),
            cubes: self.cubes.clone(),
            ..self.derived_case()
        }
    }
}
