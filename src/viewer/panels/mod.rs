//! The panels: each a small file that knows the case, the state and the last picture, and answers with
//! actions. Panels do not know each other.

mod cells;
mod clip;
mod compare;
mod controls;
mod curve;
mod curves;
mod filters;
mod light;
mod player;
mod property;
mod selection;
mod statistics;
mod strategy;
mod surfaces;
mod transfer;

use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::Ui;

use super::action::Action;
use super::pictures::ShownDifference;
use super::reader::{Curves, Table};
use super::state::State;
use super::worker::Picture;
use crate::case::Case;
use crate::picking::Hit;
use crate::scene::Scene;

pub use curves::csv;
pub use player::{Asked, player};
pub use selection::part as hover_text;

/// What a panel knows.
pub struct About<'a> {
    /// The case.
    pub case: &'a Arc<Case>,
    /// What the user has set.
    pub state: &'a State,
    /// How the case looks: of the state.
    pub scene: &'a Scene,
    /// The last picture.
    pub picture: Option<&'a Picture>,
    /// How far it is from the second one.
    pub difference: Option<&'a ShownDifference>,
    /// Where the pointer met what was selected last.
    pub hit: Option<&'a Hit>,
    /// All properties of the selected cells.
    pub table: Option<&'a Table>,
    /// The property shown over time, in the selected cells.
    pub curves: Option<&'a Curves>,
    /// The other cases that are open, with their names.
    pub others: &'a [(PathBuf, String)],
}

/// A panel: its title, whether it is open at first, and what draws it.
pub type Panel = (
    &'static str,
    bool,
    fn(&mut Ui, &About<'_>, &mut Vec<Action>),
);

/// Panels at the left, from top to bottom.
pub const LEFT: [Panel; 5] = [
    ("Property", true, property::show),
    ("Cells", true, cells::show),
    ("Shown", true, surfaces::show),
    ("Property filters", false, filters::show),
    ("Clip planes", false, clip::show),
];

/// Panels at the right, from top to bottom.
pub const RIGHT: [Panel; 6] = [
    ("Transfer function", true, transfer::show),
    ("Strategy", true, strategy::show),
    ("Light", true, light::show),
    ("Selected cells", true, selection::show),
    ("Compare", false, compare::show),
    ("Statistics", false, statistics::show),
];
