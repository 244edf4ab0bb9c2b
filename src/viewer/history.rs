//! Undo and redo: the setups before each change.

use super::action::Action;
use super::state::{Setup, State};
use crate::scene::CameraSpec;

/// Setups that can be gone back to, at most.
const MOST: usize = 200;

/// A setup's past and, after undoing, its future.
#[derive(Debug, Clone, Default)]
pub struct History {
    past: Vec<(&'static str, Setup)>,
    future: Vec<(&'static str, Setup)>,
    /// Changes of the same name join the last one, as of a slider that is dragged.
    joins: bool,
}

impl History {
    /// Makes a change. While a gesture lasts, changes of one name count as one. What is no part of the
    /// setup is changed without being remembered.
    pub fn apply(&mut self, state: &mut State, action: Action) {
        self.apply_from(state, action, None);
    }

    /// The same, seen from another camera afterward where one is given.
    pub fn apply_from(&mut self, state: &mut State, action: Action, camera: Option<CameraSpec>) {
        let name = action.name();
        let before = state.setup.clone();
        action.apply(state);
        if state.setup == before {
            return;
        }
        if let Some(camera) = camera {
            state.setup.scene.camera = camera;
        }
        let joins = self.joins && self.past.last().is_some_and(|(last, _)| *last == name);
        if !joins {
            self.past.push((name, before));
            let excess = self.past.len().saturating_sub(MOST);
            self.past.drain(..excess);
        }
        self.joins = true;
        self.future.clear();
    }

    /// Ends a gesture: the next change is one of its own.
    pub fn end_gesture(&mut self) {
        self.joins = false;
    }

    /// Takes the last change back; its name.
    pub fn undo(&mut self, state: &mut State) -> Option<&'static str> {
        Self::step(&mut self.past, &mut self.future, &mut state.setup)
    }

    /// Makes the change again that was taken back last; its name.
    pub fn redo(&mut self, state: &mut State) -> Option<&'static str> {
        Self::step(&mut self.future, &mut self.past, &mut state.setup)
    }

    fn step(
        from: &mut Vec<(&'static str, Setup)>,
        to: &mut Vec<(&'static str, Setup)>,
        setup: &mut Setup,
    ) -> Option<&'static str> {
        let (name, other) = from.pop()?;
        to.push((name, std::mem::replace(setup, other)));
        Some(name)
    }

    /// Name of what undo would take back.
    pub fn undoes(&self) -> Option<&'static str> {
        self.past.last().map(|(name, _)| *name)
    }

    /// Name of what redo would make again.
    pub fn redoes(&self) -> Option<&'static str> {
        self.future.last().map(|(name, _)| *name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::StrategyKind;
    use crate::viewer::action::Beside;

    #[test]
    fn undo_and_redo_go_through_changes() {
        let (mut history, mut state) = (History::default(), State::default());
        let start = state.clone();
        history.apply(&mut state, Action::Strategy(StrategyKind::Srg));
        history.end_gesture();
        for v in [2.0, 3.0, 4.0] {
            history.apply(&mut state, Action::Exaggeration(Some(v)));
        }
        history.end_gesture();
        let end = state.clone();
        assert_eq!(history.undo(&mut state), Some("vertical exaggeration"));
        assert_eq!(state.setup.scene.vertical_exaggeration, None);
        assert_eq!(history.undo(&mut state), Some("strategy"));
        assert_eq!(state, start);
        assert_eq!(history.undo(&mut state), None);
        history.redo(&mut state);
        history.redo(&mut state);
        assert_eq!(state, end);
        // A change after undoing forgets what was undone.
        history.undo(&mut state);
        history.apply(&mut state, Action::Step(3));
        assert_eq!(history.redoes(), None);
        // What changes nothing is no change.
        history.end_gesture();
        history.apply(&mut state, Action::Step(3));
        assert_eq!(history.undo(&mut state), Some("time step"));
        assert_eq!(history.undoes(), Some("strategy"));
    }

    #[test]
    fn a_selection_outlives_undo() {
        let (mut history, mut state) = (History::default(), State::default());
        history.apply(&mut state, Action::Strategy(StrategyKind::Srg));
        let cell = [3, 4, 5];
        history.apply(&mut state, Action::Select(cell, Beside::Nothing));
        history.undo(&mut state);
        assert_eq!(state.selected, [cell]);
        assert_eq!(state.setup, Setup::default());
        // One that is picked again beside others is let go.
        history.apply(&mut state, Action::Select([1, 1, 1], Beside::Others));
        history.apply(&mut state, Action::Select(cell, Beside::Others));
        assert_eq!(state.selected, [[1, 1, 1]]);
    }
}
