//! Undo and redo: the scenes before each change.

use super::action::Action;
use crate::scene::Scene;

/// Scenes that can be gone back to, at most.
const MOST: usize = 200;

/// A scene with its past and, after undoing, its future.
#[derive(Debug, Clone, Default)]
pub struct History {
    past: Vec<(&'static str, Scene)>,
    future: Vec<(&'static str, Scene)>,
    /// Changes of the same name join the last one, as of a slider that is dragged.
    joins: bool,
}

impl History {
    /// Makes a change. While a gesture lasts, changes of one name count as one.
    pub fn apply(&mut self, scene: &mut Scene, action: Action) {
        let name = action.name();
        let before = scene.clone();
        action.apply(scene);
        if *scene == before {
            return;
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
    pub fn undo(&mut self, scene: &mut Scene) -> Option<&'static str> {
        Self::step(&mut self.past, &mut self.future, scene)
    }

    /// Makes the change again that was taken back last; its name.
    pub fn redo(&mut self, scene: &mut Scene) -> Option<&'static str> {
        Self::step(&mut self.future, &mut self.past, scene)
    }

    fn step(
        from: &mut Vec<(&'static str, Scene)>,
        to: &mut Vec<(&'static str, Scene)>,
        scene: &mut Scene,
    ) -> Option<&'static str> {
        let (name, other) = from.pop()?;
        to.push((name, std::mem::replace(scene, other)));
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

    #[test]
    fn undo_and_redo_go_through_changes() {
        let (mut history, mut scene) = (History::default(), Scene::default());
        let start = scene.clone();
        history.apply(&mut scene, Action::Strategy("srg".into()));
        history.end_gesture();
        for v in [2.0, 3.0, 4.0] {
            history.apply(&mut scene, Action::Exaggeration(Some(v)));
        }
        history.end_gesture();
        let end = scene.clone();
        assert_eq!(history.undo(&mut scene), Some("vertical exaggeration"));
        assert_eq!(scene.vertical_exaggeration, None);
        assert_eq!(history.undo(&mut scene), Some("strategy"));
        assert_eq!(scene, start);
        assert_eq!(history.undo(&mut scene), None);
        history.redo(&mut scene);
        history.redo(&mut scene);
        assert_eq!(scene, end);
        // A change after undoing forgets what was undone.
        history.undo(&mut scene);
        history.apply(&mut scene, Action::Step(3));
        assert_eq!(history.redoes(), None);
        // What changes nothing is no change.
        history.end_gesture();
        history.apply(&mut scene, Action::Step(3));
        assert_eq!(history.undo(&mut scene), Some("time step"));
        assert_eq!(history.undoes(), Some("strategy"));
    }
}
