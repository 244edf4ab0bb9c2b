//! What a tab shows, as one plain value.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::slices::Slicing;
use crate::case::{Case, difference_name};
use crate::scene::{Scene, StepSpec, StrategyKind};
use crate::view::look::Look;

/// All that the user has set in a tab.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// What can be undone.
    pub setup: Setup,
    /// Cells that were picked, by I, J, K from 1.
    pub selected: Vec<[usize; 3]>,
    /// The well that was selected, whose cells are among those.
    pub well: Option<String>,
    /// Curves over time below the picture.
    pub curves: CurvePlots,
    /// How time plays.
    pub pace: Playback,
    /// How slices are stepped through.
    pub slicing: Slicing,
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

    /// The name of the property that is the difference of values shown, where one is.
    pub fn difference(&self) -> Option<String> {
        let comparison = self.comparison.as_ref()?;
        let is_shown =
            comparison.layout == CompareLayout::Difference && comparison.differs_in_values();
        let now = self.scene.property.as_ref().filter(|_| is_shown)?;
        let base = comparison.property.as_ref().unwrap_or(now);
        let at = match (&comparison.case, &comparison.step) {
            (Some(path), _) => path.file_stem().map(|s| s.to_string_lossy().into_owned()),
            (None, Some(StepSpec::Index(n))) => Some(n.to_string()),
            (None, Some(StepSpec::Name(name))) => Some(name.clone()),
            (None, None) => None,
        };
        Some(difference_name(now, base, at.as_deref()))
    }

    /// Changes range, colors or opacities of what is shown: of the difference where that is.
    pub fn change_look(&mut self, change: impl FnOnce(&mut Look)) {
        if let Some(name) = self.difference() {
            change(self.looks.entry(name).or_default());
            return;
        }
        let mut look = Look::of(&self.scene);
        change(&mut look);
        look.apply(&mut self.scene);
    }

    /// The scene of the second picture, if there is one.
    pub fn compared(&self, scene: &Scene) -> Option<Scene> {
        let comparison = self.comparison.as_ref()?;
        let mut other = scene.clone();
        if let Some(strategy) = &comparison.strategy {
            other.strategy = *strategy;
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

/// Curves over time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct CurvePlots {
    /// They are shown.
    pub is_open: bool,
    /// Which properties of the selected cells; where there are none, that of the picture.
    pub properties: Vec<String>,
    /// Which summary vectors, by name, beside those of the selected well.
    pub vectors: Vec<String>,
}

/// How time plays.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Playback {
    /// Steps a second, at most: a step stays until its picture has been seen.
    #[serde(alias = "steps_a_second")]
    pub steps_per_second: f64,
    /// After the last step comes the first.
    pub repeats: bool,
}

impl Default for Playback {
    fn default() -> Self {
        Self {
            steps_per_second: 2.5,
            repeats: true,
        }
    }
}

/// A second picture from the same camera.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Comparison {
    /// How both are shown.
    pub layout: CompareLayout,
    /// Another strategy.
    pub strategy: Option<StrategyKind>,
    /// Another property, over its own range.
    pub property: Option<String>,
    /// Another step.
    pub step: Option<StepSpec>,
    /// Another case that is open.
    pub case: Option<PathBuf>,
}

/// The strategy that comes after another in the list.
pub fn next_strategy(strategy: StrategyKind) -> StrategyKind {
    let all = StrategyKind::ALL;
    let at = all.iter().position(|k| *k == strategy);
    all[at.map_or(0, |n| (n + 1) % all.len())]
}

/// How two pictures are shown.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum CompareLayout {
    /// Next to each other.
    #[default]
    Beside,
    /// The second one right of a part of the width.
    Wipe(f64),
    /// The values of the first minus those of the second, as a picture of its own.
    Difference,
    /// How far the colors of two strategies are apart, by CIEDE2000.
    ColorDifference,
}

impl Comparison {
    /// What comparing begins with: the step shown beside the first one (the first beside the last), or the next
    /// strategy where the property does not change with time.
    pub fn opening(case: &Case, scene: &Scene) -> Self {
        let is_dynamic = scene.property.as_ref().is_some_and(|p| case.is_dynamic(p));
        let last = case.steps.len().saturating_sub(1);
        if !is_dynamic || last == 0 {
            return Self::of_strategies(scene);
        }
        let shown = match &scene.step {
            StepSpec::Index(n) => *n,
            StepSpec::Name(name) => case.step(name).unwrap_or(last),
        };
        Self {
            step: Some(StepSpec::Index(if shown == 0 { last } else { 0 })),
            ..Self::default()
        }
    }

    /// With the strategy that comes after the scene's.
    pub fn of_strategies(scene: &Scene) -> Self {
        Self {
            strategy: Some(next_strategy(scene.strategy)),
            ..Self::default()
        }
    }

    /// True where both pictures are of other values: another step, property or case.
    pub fn differs_in_values(&self) -> bool {
        self.step.is_some() || self.property.is_some() || self.case.is_some()
    }

    /// In another layout. Only values can be subtracted, and colors are compared of strategies alone, so what
    /// does not fit gives way.
    pub fn laid_out(self, layout: CompareLayout, case: &Case, scene: &Scene) -> Self {
        let fitting = match layout {
            CompareLayout::Difference if !self.differs_in_values() => Self::opening(case, scene),
            CompareLayout::ColorDifference
                if self.differs_in_values() || self.strategy.is_none() =>
            {
                Self::of_strategies(scene)
            }
            _ => self,
        };
        Self { layout, ..fitting }
    }
}
