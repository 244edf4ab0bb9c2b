//! A case in a tab: its files, its scene, its past, what was picked.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::action::Action;
use super::history::History;
use super::loading::Loading;
use super::worker::Picked;
use crate::case::Case;
use crate::scene::{Scene, StepSpec};

/// Where opening a case has come to.
pub enum Status {
    /// It is being opened.
    Loading(Loading),
    /// It is there.
    Ready(Arc<Case>),
    /// Why it is not there.
    Failed(String),
}

/// A tab.
pub struct Document {
    /// As the user gave it.
    pub path: PathBuf,
    /// Where opening it has come to.
    pub status: Status,
    /// How it looks.
    pub scene: Scene,
    /// What can be undone.
    pub history: History,
    /// Time steps play since; `None` where they stand.
    pub playing: Option<Instant>,
    /// The cell picked last.
    pub picked: Option<Picked>,
}

impl Document {
    /// A tab for a case that is being opened.
    pub fn new(path: PathBuf, loading: Loading, scene: Scene) -> Self {
        Self {
            path,
            status: Status::Loading(loading),
            scene,
            history: History::default(),
            playing: None,
            picked: None,
        }
    }

    /// The case, once it is there.
    pub fn case(&self) -> Option<&Arc<Case>> {
        match &self.status {
            Status::Ready(case) => Some(case),
            _ => None,
        }
    }

    /// Name of the tab.
    pub fn title(&self) -> String {
        match self.case() {
            Some(case) => case.about.name.clone(),
            None => self
                .path
                .file_name()
                .map_or_else(|| "case".into(), |n| n.to_string_lossy().into_owned()),
        }
    }

    /// Makes a change that can be undone.
    pub fn apply(&mut self, action: Action) {
        self.history.apply(&mut self.scene, action);
    }

    /// The step shown, by number, and how many there are; `None` where there are none.
    pub fn step(&self) -> Option<(usize, usize)> {
        let case = self.case()?;
        let count = case.steps.len();
        let step = match &self.scene.step {
            StepSpec::Index(n) => *n,
            StepSpec::Name(name) => case.step(name).ok()?,
        };
        (count > 0).then_some((step.min(count - 1), count))
    }

    /// Goes to another step, around the end where `wraps`.
    pub fn move_step(&mut self, by: isize, wraps: bool) {
        if let Some((step, count)) = self.step() {
            let wanted = step as isize + by;
            let last = count as isize - 1;
            let next = match wraps {
                true => wanted.rem_euclid(count as isize),
                false => wanted.clamp(0, last),
            };
            self.apply(Action::Step(next as usize));
        }
    }
}
