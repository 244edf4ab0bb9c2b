//! Wells as tubes in world space: along their paths, or through the cells that they are connected to and up to a head
//! above the model.

mod course;

use std::sync::Arc;

use glam::DVec3;

use self::course::Flow;
use super::error::SceneError;
use super::step::well_step;
use super::surfaces::Surfaces;
use crate::case::{Case, Well, WellKind};
use crate::model::{Grid, Spaces};
use crate::scene::names::matches;
use crate::scene::{Scene, ShownWells};

/// The wells that a view shows.
///
/// A well is a chain of capsules, each of them all points within a radius of a straight line. They are opaque, cut by
/// clip planes, and lit by the lamp of the hull (see [`super::Surfaces`]) and by all light there is; exact colors turn
/// the lamp off. Where they lie nearer to the viewer than samples they cover these, whatever cells are drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Wells {
    /// The capsules of all of them.
    pub capsules: Vec<Capsule>,
    /// Where each begins.
    pub heads: Vec<Head>,
}

/// All points within a radius of a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// Ends of the line in world space.
    pub ends: [DVec3; 2],
    /// The radius.
    pub radius: f64,
    /// Color in sRGB, 0..1.
    pub color: [f64; 3],
    /// Number of its well, as in [`Wells::heads`].
    pub well: usize,
}

/// Where a well begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    /// Name of the well.
    pub name: String,
    /// What it does.
    pub kind: WellKind,
    /// It flows.
    pub is_open: bool,
    /// Its place in world space.
    pub at: DVec3,
    /// Radius of the tube there.
    pub radius: f64,
    /// Color of the well in sRGB, 0..1.
    pub color: [f64; 3],
}

impl Head {
    /// The well in words, such as `Well P1: producer, open`.
    pub fn in_words(&self) -> String {
        format!("Well {}: {}", self.name, self.kind.in_words(self.is_open))
    }
}

/// Radius of a tube as a part of the diagonal of the model's box, at most and at least.
const RADIUS: [f64; 2] = [0.0035, 0.0015];
/// Radius of a tube as a part of the mean edge of cells, at most: else wells hide the cells beside them.
const PART_OF_CELL: f64 = 0.25;
/// How much thinner shut wells are: of several at one place the one that flows is seen.
const SHUT: f64 = 0.6;
/// How much thicker tubes are in cells that they are open to, and at the head.
const OPEN: f64 = 1.7;
const HEAD: f64 = 2.4;
/// How far wells reach beyond the model's box, as a part of its diagonal.
pub(super) const BEYOND: f64 = 0.035;

/// Color of a well (sRGB, 0..1): of those that color-blind people tell apart (Okabe and Ito 2008), gray where it is
/// shut.
pub fn well_color(kind: WellKind, is_open: bool) -> [f64; 3] {
    match kind {
        _ if !is_open => [0.45, 0.45, 0.45],
        WellKind::Producer => [0.0, 0.620, 0.451],
        WellKind::OilInjector => [0.902, 0.624, 0.0],
        WellKind::WaterInjector => [0.0, 0.447, 0.698],
        WellKind::GasInjector => [0.835, 0.369, 0.0],
        WellKind::Unknown => [0.6, 0.6, 0.6],
        WellKind::Path => [0.8, 0.475, 0.655],
    }
}

/// What tubes are drawn by.
pub(super) struct Measures<'a> {
    /// Grid to world.
    pub spaces: &'a Spaces,
    /// Corners of the model's box in world space.
    pub corners: &'a [DVec3; 8],
    /// Mean edge of the cells across the depth.
    pub lateral: f64,
}

impl<'a> Measures<'a> {
    /// Those of a model of cells with such mean edges.
    pub fn of(spaces: &'a Spaces, corners: &'a [DVec3; 8], edges: DVec3) -> Self {
        Self {
            spaces,
            corners,
            lateral: 0.5 * (edges.x + edges.y),
        }
    }

    /// Of the model's box.
    fn diagonal(&self) -> f64 {
        self.corners[0].distance(self.corners[7])
    }
}

/// The wells that a scene shows, of the step that it names whether or not its property changes with time; none of
/// those that have neither a path near the model nor a connection in a grid shown.
pub(super) fn shown(
    scene: &Scene,
    case: &Case,
    measures: &Measures<'_>,
) -> Result<Arc<Wells>, SceneError> {
    let mut wells = Wells::default();
    let asked = &scene.show.wells;
    if asked.are_shown() {
        let of_step = case.wells(well_step(case, &scene.step))?;
        for well in of_step.iter().filter(|well| asked.shows(&well.name)) {
            wells.add(&case.grid, well, measures);
        }
    }
    Ok(Arc::new(wells))
}

/// Names that a warning lists, at most.
const MOST_NAMES: usize = 12;

/// What a scene asks of wells in vain, one sentence each.
///
/// # Errors
/// When the wells of its step cannot be read.
pub fn warnings(scene: &Scene, case: &Case) -> Result<Vec<String>, SceneError> {
    let mut warnings = Vec::new();
    if scene.show.wells.are_shown() && case.about.wells.is_empty() {
        warnings.push("the scene asks for wells, and this case has none".to_owned());
    }
    let shown = match &scene.show.wells {
        ShownWells::Named(names) => names.as_slice(),
        ShownWells::All(_) => &[],
    };
    let asked = [("show.wells", shown), ("filter.wells", &scene.filter.wells)];
    if asked.iter().all(|(_, names)| names.is_empty()) {
        return Ok(warnings);
    }
    let step = well_step(case, &scene.step);
    let wells = case.wells(step)?;
    let names: Vec<&str> = wells.iter().map(|well| well.name.as_str()).collect();
    let known = match names.as_slice() {
        [] => "which has none".to_owned(),
        few if few.len() <= MOST_NAMES => format!("which has {}", few.join(", ")),
        many => format!(
            "which has {} and {} more",
            many[..MOST_NAMES].join(", "),
            many.len() - MOST_NAMES
        ),
    };
    for (field, patterns) in asked {
        for pattern in patterns {
            if !names.iter().any(|name| matches(pattern, name)) {
                warnings.push(format!(
                    "{field}: no well matches {pattern} at step {step}, {known}"
                ));
            }
        }
    }
    Ok(warnings)
}

impl Wells {
    /// Surfaces with these wells among them, where there are some.
    pub(super) fn among(&self, surfaces: Surfaces) -> Surfaces {
        Surfaces {
            wells: !self.capsules.is_empty(),
            ..surfaces
        }
    }

    fn add(&mut self, grid: &Grid, well: &Well, measures: &Measures<'_>) {
        let course = course::along_path(grid, well, measures);
        let Some(course) = course.or_else(|| course::through_cells(grid, well, measures)) else {
            return;
        };
        let diagonal = measures.diagonal();
        let [most, least] = RADIUS.map(|part| part * diagonal);
        let radius = (PART_OF_CELL * measures.lateral).min(most).max(least);
        let radius = if well.is_open { radius } else { SHUT * radius };
        let color = well_color(well.kind, well.is_open);
        let closed = well_color(well.kind, false);
        let number = self.heads.len();
        let mut add = |ends, radius, color| {
            self.capsules.push(Capsule {
                ends,
                radius,
                color,
                well: number,
            });
        };
        add([course.head; 2], HEAD * radius, color);
        for piece in course.pieces {
            match piece.flow {
                Flow::None => add(piece.ends, radius, color),
                Flow::Open if well.is_open => add(piece.ends, OPEN * radius, color),
                Flow::Open | Flow::Closed => add(piece.ends, radius, closed),
            }
        }
        self.heads.push(Head {
            name: well.name.clone(),
            kind: well.kind,
            is_open: well.is_open,
            at: course.head,
            radius: HEAD * radius,
            color,
        });
    }
}
