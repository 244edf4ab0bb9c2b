//! What a tab shows, as one plain value.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::scene::look::Look;
use crate::scene::{Scene, StepSpec};
use crate::strategies::StrategyKind;

/// All that the user has set in a tab.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// What can be undone.
    pub setup: Setup,
    /// Cells that were picked, by I, J, K from 1.
    pub selected: Vec<[usize; 3]>,
    /// How time plays.
    pub pace: Pace,
}

/// What makes the picture.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Setup {
    /// How the case looks.
    pub scene: Scene,
    /// What it is compared with.
    pub comparison: Option<Comparison>,
    /// Range, colors and opacities of each property that has been shown, as they were left.
    pub looks: BTreeMap<String, Look>,
}

impl Setup {
    /// Shows another property as it was left.
    pub fn show(&mut self, property: String) {
        if let Some(before) = &self.scene.property {
            self.looks.insert(before.clone(), Look::of(&self.scene));
        }
        let look = self.looks.get(&property).cloned().unwrap_or_default();
        look.apply(&mut self.scene);
        self.scene.property = Some(property);
    }

    /// The scene of the second picture, if there is one.
    pub fn compared(&self, scene: &Scene) -> Option<Scene> {
        let comparison = self.comparison.as_ref()?;
        let mut other = scene.clone();
        if let Some(strategy) = &comparison.strategy {
            other.strategy.clone_from(strategy);
        }
        if let Some(step) = &comparison.step {
            other.step = step.clone();
        }
        let property = comparison.property.clone();
        if let Some(property) = property.filter(|p| scene.property.as_ref() != Some(p)) {
            let look = self.looks.get(&property).cloned().unwrap_or_default();
            look.apply(&mut other);
            other.property = Some(property);
        }
        Some(other)
    }
}

/// How time plays.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Pace {
    /// Steps a second, at most: a step stays until its picture has been seen.
    pub steps_a_second: f64,
    /// After the last step comes the first.
    pub repeats: bool,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            steps_a_second: 2.5,
            repeats: true,
        }
    }
}

/// A second picture from the same camera.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Comparison {
    /// How both are shown.
    pub layout: Layout,
    /// Another strategy.
    pub strategy: Option<String>,
    /// Another property, over its own range.
    pub property: Option<String>,
    /// Another step.
    pub step: Option<StepSpec>,
    /// Another case that is open.
    pub case: Option<PathBuf>,
}

/// The strategy that comes after another in the list.
pub fn next_strategy(name: &str) -> StrategyKind {
    let all = StrategyKind::ALL;
    let at = all.iter().position(|k| k.name() == name);
    all[at.map_or(0, |n| (n + 1) % all.len())]
}

/// How two pictures are shown.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Layout {
    /// Next to each other.
    #[default]
    Beside,
    /// The second one right of a part of the width.
    Wipe(f64),
    /// How far they are apart, by CIEDE2000.
    Difference,
}

impl Comparison {
    /// With the strategy that comes after the scene's.
    pub fn with_next_strategy(scene: &Scene) -> Self {
        Self {
            strategy: Some(next_strategy(&scene.strategy).name().into()),
            ..Self::default()
        }
    }
}
