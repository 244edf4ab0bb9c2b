//! The panels: each a small file that knows the case, the state and the last picture, and answers with
//! actions. Panels do not know each other.

mod cells;
mod clip;
mod compare;
mod controls;
mod curve;
mod curves;
mod dates;
mod display;
mod faults;
mod filters;
mod light;
mod over_time;
mod player;
mod property;
mod range_slider;
mod selection;
mod statistics;
mod strategy;
mod table;
mod transfer;
mod values;
mod vector_list;
mod vector_plots;
mod wells;

use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::Ui;

use super::action::Action;
use super::job::Picture;
use super::pictures::ShownDifference;
use super::reader::{Curves, Table};
use super::spread::Spread;
use super::state::State;
use super::vectors::VectorCurves;
use crate::case::{Case, Measure, Property, Units, Well};
use crate::picking::Pick;
use crate::picture::Lengths;
use crate::scene::{Scene, Space};

pub use controls::{Choice, list, one_of};
pub use curves::show as curves;
pub use player::{PlayerRequest, player};
pub use selection::hover_text;
pub use table::csv;

/// What a panel knows.
pub struct PanelContext<'a> {
    /// The case.
    pub case: &'a Arc<Case>,
    /// What the user has set.
    pub state: &'a State,
    /// How the case looks: of the state.
    pub scene: &'a Scene,
    /// The last picture.
    pub picture: Option<&'a Picture>,
    /// How far its colors are from those of the second one.
    pub difference: Option<&'a ShownDifference>,
    /// Why the difference of values that is asked for is not shown.
    pub refusal: Option<String>,
    /// What was seen at the place clicked last.
    pub pick: Option<&'a Pick>,
    /// All properties of the selected cells.
    pub table: Option<&'a Table>,
    /// Properties over time, in the selected cells.
    pub curves: Option<&'a Curves>,
    /// Summary vectors, where their curves are shown.
    pub vectors: Option<&'a VectorCurves>,
    /// The wells of the step, once they are read.
    pub wells: Option<&'a [Well]>,
    /// How the values are spread by which cells are filtered.
    pub spreads: &'a [Arc<Spread>],
    /// The other cases that are open, with their names.
    pub others: &'a [(PathBuf, String)],
}

impl PanelContext<'_> {
    /// The properties of the case in front; differences to another case and statistics over several are none of these.
    pub fn properties(&self) -> impl Iterator<Item = &Property> {
        let is_minus = |name: &str| self.case.minus.iter().any(|m| m.name == name);
        let all = self.case.properties.iter();
        all.filter(move |p| !is_minus(&p.name) && self.case.statistic(&p.name).is_none())
    }

    /// The units in which numbers are shown and typed.
    pub fn units(&self) -> Units {
        self.scene.units.into()
    }

    /// How the values of a property are shown and typed.
    pub fn measure(&self, property: &str) -> Measure {
        self.case.measure(property, self.units())
    }

    /// How lengths are shown, with short units.
    pub fn lengths(&self) -> Lengths {
        Lengths::of(self.case, self.units())
    }

    /// How distances in the picture are shown: those between numbers of cells as they are.
    pub fn world_length(&self) -> Measure {
        match self.scene.space {
            Space::Map => self.lengths().grid,
            Space::Ijk => Measure::of_file("cells"),
        }
    }

    /// The property shown.
    pub fn property(&self) -> Option<&str> {
        let shown = self.picture.map(|p| p.view.shown.property.as_str());
        self.scene.property.as_deref().or(shown)
    }
}

/// What draws a panel.
type Show = fn(&mut Ui, &PanelContext<'_>, &mut Vec<Action>);

/// A panel.
pub struct Panel {
    /// Its title.
    pub title: &'static str,
    /// It is open at first.
    pub is_open: bool,
    /// How many of its things are in use, which its title tells.
    pub count: fn(&PanelContext<'_>) -> usize,
    /// Draws it.
    pub show: Show,
}

const fn panel(title: &'static str, is_open: bool, show: Show) -> Panel {
    Panel {
        title,
        is_open,
        count: |_| 0,
        show,
    }
}

/// Panels at the left, from top to bottom.
pub const LEFT: [Panel; 7] = [
    panel("Property", true, property::show),
    panel("Cell filter", true, cells::show),
    panel("Display", true, display::show),
    Panel {
        count: |about| about.wells.map_or(0, <[Well]>::len),
        ..panel("Wells", false, wells::show)
    },
    Panel {
        count: |about| about.case.about.named_faults.len(),
        ..panel("Faults", false, faults::show)
    },
    Panel {
        count: |about| about.scene.filter.properties.len(),
        ..panel("Property filters", false, filters::show)
    },
    Panel {
        count: |about| about.scene.clip.len(),
        ..panel("Clip planes", false, clip::show)
    },
];

/// Panels at the right, from top to bottom.
pub const RIGHT: [Panel; 6] = [
    panel("Transfer function", true, transfer::show),
    panel("Strategy", true, strategy::show),
    panel("Light", true, light::show),
    Panel {
        count: |about| about.state.selected.len(),
        ..panel("Selected cells", true, selection::show)
    },
    panel("Compare", false, compare::show),
    panel("Statistics", false, statistics::show),
];
