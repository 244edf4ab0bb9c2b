//! What a tab shows, as one plain value.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::looks;
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

    /// The second picture's scene.
    pub fn scene(&self, scene: &Scene) -> Scene {
        let mut other = scene.clone();
        if let Some(strategy) = &self.strategy {
            other.strategy.clone_from(strategy);
        }
        if let Some(step) = &self.step {
            other.step = step.clone();
        }
        if let Some(property) = self
            .property
            .as_ref()
            .filter(|p| scene.property.as_ref() != Some(p))
        {
            other.property = Some(property.clone());
            looks::forget(&mut other);
        }
        other
    }
}
