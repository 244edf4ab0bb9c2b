//! The panels: each a small file that knows the case, the scene and the last picture, and answers with
//! actions. Panels do not know each other.

mod cells;
mod light;
mod pick;
mod player;
mod property;
mod statistics;
mod strategy;
mod transfer;

use eframe::egui::Ui;

use super::action::Action;
use super::worker::{Picked, Picture};
use crate::case::Case;
use crate::scene::Scene;

pub use player::{Player, player};

/// What a panel knows.
pub struct About<'a> {
    /// The case.
    pub case: &'a Case,
    /// How it looks.
    pub scene: &'a Scene,
    /// The last picture.
    pub picture: Option<&'a Picture>,
    /// The cell picked last.
    pub picked: Option<&'a Picked>,
}

/// A panel: its title and what draws it.
pub type Panel = (&'static str, fn(&mut Ui, &About<'_>, &mut Vec<Action>));

/// Panels at the left, from top to bottom.
pub const LEFT: [Panel; 3] = [
    ("Property", property::show),
    ("Cells", cells::show),
    ("Picked cell", pick::show),
];

/// Panels at the right, from top to bottom.
pub const RIGHT: [Panel; 4] = [
    ("Transfer function", transfer::show),
    ("Strategy", strategy::show),
    ("Light", light::show),
    ("Statistics", statistics::show),
];
