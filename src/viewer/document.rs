//! A tab: a case, what the user has set, its past, what was read for it.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::action::Action;
use super::history::History;
use super::loading::{Loading, Opened};
use super::reader::{Curves, Table, WellList};
use super::spread::Spread;
use super::state::State;
use super::vectors::VectorCurves;
use super::watch::Watch;
use crate::case::load::CasePaths;
use crate::case::{Case, Units};
use crate::picking::Pick;
use crate::scene::{CameraSpec, StepSpec};

/// A tab.
pub struct Document {
    /// As the user gave it.
    pub path: PathBuf,
    /// Files that were added to the case.
    pub with: Vec<PathBuf>,
    /// Other cases of which it has statistics.
    pub others: Vec<CasePaths>,
    /// The case, once it is there. It stays while it is read again.
    pub case: Option<Arc<Case>>,
    /// It is being read.
    pub loading: Option<Loading>,
    /// Why the last reading failed.
    pub error: Option<String>,
    /// What the user has set.
    pub state: State,
    /// What can be undone.
    pub history: History,
    /// Time steps play; when the last one came.
    pub playing: Option<Instant>,
    /// Tells when the case's files change.
    pub watch: Option<Watch>,
    /// Tells when those of its summary do.
    pub summary_watch: Option<Watch>,
    /// What was seen at the place clicked last.
    pub pick: Option<Pick>,
    /// All properties of the selected cells.
    pub table: Option<Table>,
    /// The property shown over time, in the selected cells.
    pub curves: Option<Curves>,
    /// Summary vectors, where their curves are shown.
    pub vectors: Option<VectorCurves>,
    /// The wells of a step, once they are read.
    pub wells: Option<WellList>,
    /// How the values are spread by which cells are filtered.
    pub spreads: Vec<Arc<Spread>>,
}

impl Document {
    /// A tab for a case that is being opened.
    pub fn new(paths: CasePaths, loading: Loading, state: State) -> Self {
        Self {
            path: paths.path,
            with: paths.with,
            others: paths.others,
            case: None,
            loading: Some(loading),
            error: None,
            state,
            history: History::default(),
            playing: None,
            watch: None,
            summary_watch: None,
            pick: None,
            table: None,
            curves: None,
            vectors: None,
            wells: None,
            spreads: Vec::new(),
        }
    }

    /// The units in which numbers are shown.
    pub fn units(&self) -> Units {
        self.state.setup.scene.units.into()
    }

    /// The files that the case is read from.
    pub fn paths(&self) -> CasePaths {
        CasePaths {
            path: self.path.clone(),
            with: self.with.clone(),
            others: self.others.clone(),
        }
    }

    /// True where it is the case, or the cases together, that some paths name, whatever files were added.
    pub fn is_of(&self, paths: &CasePaths) -> bool {
        self.path == paths.path && self.others == paths.others
    }

    /// What tells it from other tabs: its path, and how many cases it has statistics of with it.
    pub fn key(&self) -> PathBuf {
        match self.others.len() {
            0 => self.path.clone(),
            more => PathBuf::from(format!("{} and {more} more", self.path.display())),
        }
    }

    /// Name of the tab.
    pub fn title(&self) -> String {
        match &self.case {
            Some(case) => case.about.name.clone(),
            None => self
                .path
                .file_name()
                .map_or_else(|| "case".into(), |n| n.to_string_lossy().into_owned()),
        }
    }

    /// Takes in a case that was being opened; true where one came.
    pub fn listen(&mut self) -> bool {
        let Some(answer) = self.loading.as_ref().and_then(Loading::poll) else {
            return false;
        };
        self.loading = None;
        match answer {
            Ok(Opened { case, first }) => {
                self.error = None;
                self.case = Some(case);
                // What was set before a case is read again stays.
                if self.state.setup.scene.property.is_none() {
                    self.state.setup.scene = *first;
                }
                true
            }
            Err(error) => {
                self.error = Some(error);
                false
            }
        }
    }

    /// Takes in the wells of a step. The cells of the well that is selected are those of this step, beside what else is
    /// selected.
    pub fn take_wells(&mut self, list: WellList) {
        let cells = |list: &WellList| -> Vec<[usize; 3]> {
            let named = list.wells.iter();
            let mut named = named.filter(|well| Some(&well.name) == self.state.well.as_ref());
            let cells = named.next().map(|well| well.finest_cells(&list.case.grid));
            cells.into_iter().flatten().map(|c| c.one_based()).collect()
        };
        let before = self.wells.as_ref().map_or_else(Vec::new, cells);
        let now = cells(&list);
        if self.state.well.is_some() && before != now {
            self.state.selected = followed(&self.state.selected, &before, now);
        }
        self.wells = Some(list);
    }

    /// Makes a change that can be undone.
    pub fn apply(&mut self, action: Action) {
        self.history.apply(&mut self.state, action);
    }

    /// Makes a change of the filter that can be undone. The camera stays where it is, which is given where it would
    /// follow what is drawn.
    pub fn apply_filter(&mut self, action: Action, camera: Option<CameraSpec>) {
        self.history.apply_from(&mut self.state, action, camera);
    }

    /// A property whose look is not known yet and has to be found before it is shown.
    pub fn lacks_look(&self, property: &str) -> bool {
        !self.state.setup.looks.contains_key(property)
            && self.state.setup.scene.property.as_deref() != Some(property)
    }

    /// The cell, by I, J, K from 1, that lies `by` cells behind the one selected last on the ray of the last
    /// click, before it where `by` is below 0; `None` where there is none.
    pub fn along_ray(&self, by: isize) -> Option<[usize; 3]> {
        let case = self.case.as_ref()?;
        let last = case.grid.dims().one_based(*self.state.selected.last()?)?;
        let next = self.pick.as_ref()?.beside(last, by)?;
        Some(next.one_based())
    }

    /// The step shown, by number, and how many there are; `None` where there are none.
    pub fn step(&self) -> Option<(usize, usize)> {
        let case = self.case.as_ref()?;
        let count = case.steps.len();
        let step = match &self.state.setup.scene.step {
            StepSpec::Index(n) => *n,
            StepSpec::Name(name) => case.step(name).ok()?,
        };
        (count > 0).then_some((step.min(count - 1), count))
    }

    /// Goes to another step, around the end where `wraps`.
    pub fn move_step(&mut self, by: isize, wraps: bool) {
        if let Some((step, count)) = self.step() {
            let wanted = step.saturating_add_signed(by);
            let next = match wraps {
                true => (step as isize + by).rem_euclid(count as isize) as usize,
                false => wanted.min(count - 1),
            };
            self.apply(Action::Step(next));
        }
    }
}

/// The selected cells once a well has others: these, and what was selected beside those it had before.
fn followed(
    selected: &[[usize; 3]],
    before: &[[usize; 3]],
    mut now: Vec<[usize; 3]>,
) -> Vec<[usize; 3]> {
    let others = selected.iter();
    let others = others.filter(|cell| !before.contains(cell) && !now.contains(cell));
    let others: Vec<_> = others.copied().collect();
    now.extend(others);
    now
}

#[cfg(test)]
mod tests {
    use super::followed;

    #[test]
    fn a_wells_cells_follow_the_step_and_others_stay() {
        let [a, b, c, other] = [1, 2, 3, 9].map(|k| [5, 5, k]);
        let now = followed(&[a, b, other], &[a, b], vec![b, c]);
        assert_eq!(now, [b, c, other]);
        assert_eq!(followed(&[a], &[a], Vec::new()), [[0; 3]; 0]);
    }
}
