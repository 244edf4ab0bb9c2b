//! Surfaces of cells as parts of the picture: the hull, faults, edges of cells on them.

use std::sync::Arc;

use super::View;
use super::error::{SceneError, wrong};
use crate::case::Case;
use crate::model::topology::Face;
use crate::model::{Grid, Ijk};
use crate::scene::{Hull, Mode, Scene, ShownFaults};

/// Which of the named faults of a case are chosen, by number; `None` where all or none are.
///
/// # Errors
/// When a name is not one of the case's.
pub(super) fn chosen(shown: &ShownFaults, case: &Case) -> Result<Option<Arc<[bool]>>, SceneError> {
    let ShownFaults::Named(names) = shown else {
        return Ok(None);
    };
    let named = &case.about.named_faults;
    if let Some(unknown) = names.iter().find(|n| named.iter().all(|f| f.name != **n)) {
        let known = match named.is_empty() {
            true => "this case names no faults; use true or false".to_owned(),
            false => {
                let names: Vec<_> = named.iter().map(|f| f.name.as_str()).collect();
                format!("this case has {}", names.join(", "))
            }
        };
        let problem = format!("there is no fault {unknown}; {known}");
        return Err(wrong("show.faults", problem));
    }
    let flags = named.iter().map(|f| shown.shows(Some(&f.name)));
    Ok(Some(flags.collect()))
}

/// The surfaces that a view shows.
///
/// A point of a surface is blended between the samples before and behind it, and shaded as these are. Each
/// face is two triangles, 0 1 3 and 0 3 2 of its corners in the order of [`Face::corners`]. Clip planes cut
/// surfaces too.
///
/// The hull is all boundary faces of the drawn cells: beside nothing, beside cells that are not drawn, and
/// on faults. It is opaque, has the color of the value there, and is seen from both sides; of two faces
/// nearer to one another than [`View::fault_gap`] the one that faces the viewer is in front.
///
/// A lamp beside the viewer lights the hull and opaque sections. Let `v` be the unit vector from a point to
/// the viewer, `b` the way from the viewer to the lamp at a distance of one ([`HEADLIGHT_ASIDE`]), and `n` the
/// face's unit normal on the viewer's side, at right angles to both of its diagonals. Colors are multiplied by
/// `a + (1 - a) max(0, n (v + b)) / sqrt(1 + b b)`, `a` being [`HEADLIGHT_AMBIENT`]: what is turned to the
/// viewer has the legend's color all but exactly. Exact colors of [`super::Lighting`] turn the lamp off.
///
/// A faint hull is two layers of a gray ([`faint_color`]) that no light changes: in front the nearest point of
/// the hull, and as a ground behind the volume the last one, of two faces within a gap the one that is turned
/// away. Their opacities rise from where a face is turned to the viewer to where it is seen edge-on, `c` being
/// the cosine between its normal and the ray: from the first number of [`FAINT_FRONT`] or [`FAINT_BEHIND`] to
/// the second by `(1 - c)^2`. It has no edges of cells and hides no fault.
///
/// Solid cells have no inside: nothing but ghosts is seen between their faces.
///
/// Faults are sheets of [`SHEET_OPACITY`], or where the hull is opaque that part of its color. Of a fault
/// the faces of both sides are drawn, but what lies between the same two columns as the surface before it
/// on a ray, or behind that by less than [`View::fault_gap`], is the same sheet and is left out.
///
/// Edges darken what they are on, hull, sheets and opaque sections, by [`EDGE_DARKNESS`] times the part of
/// a pixel that a line of [`EDGE_WIDTH`] pixels covers: `clamp(width / 2 + 1/2 - d)`, `d` being the pixels to
/// the nearest edge across which a parameter of the cell ends, times a smooth step over [`EDGE_FADE`] of
/// the pixels from edge to edge, for where lines are dense there is nothing to tell apart.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Surfaces {
    /// The hull.
    pub hull: Hull,
    /// Faults are shown.
    pub faults: bool,
    /// Wells are shown, and there are some.
    pub wells: bool,
    /// Edges of cells are drawn on surfaces and opaque sections.
    pub cell_edges: bool,
    /// Cells with a value are solid: their faces and sections are all that is seen of them.
    pub solid: bool,
}

impl Surfaces {
    /// What a scene shows.
    pub fn of(scene: &Scene) -> Self {
        let solid = scene.mode == Mode::Cells;
        Self {
            hull: if solid { Hull::Opaque } else { scene.show.hull },
            faults: scene.show.faults.are_shown(),
            wells: scene.show.wells.are_shown(),
            cell_edges: scene.show.cell_edges.unwrap_or(solid),
            solid,
        }
    }

    /// True where there are any: edges alone have nothing to be on but sections.
    pub fn are_shown(self) -> bool {
        self.has_hull() || self.faults || self.wells
    }

    /// True where the hull is shown.
    pub fn has_hull(self) -> bool {
        self.hull != Hull::Hidden
    }
}

/// Opacity of the front of a faint hull, where it is turned to the viewer and where it is seen edge-on.
pub const FAINT_FRONT: [f64; 2] = [0.05, 0.6];
/// Opacity of its ground.
pub const FAINT_BEHIND: [f64; 2] = [0.38, 0.75];
/// How much darker than a light background the gray of a faint hull is, or lighter than a dark one.
const FAINT_CONTRAST: f64 = 0.65;

/// Gray (sRGB, 0..1) of a faint hull before a background (sRGB, 0..1).
pub fn faint_color(background: [f64; 3]) -> [f64; 3] {
    let [r, g, b] = background;
    let brightness = 0.299 * r + 0.587 * g + 0.114 * b;
    let away = if brightness > 0.5 {
        -FAINT_CONTRAST
    } else {
        FAINT_CONTRAST
    };
    [(brightness + away).clamp(0.0, 1.0); 3]
}

/// Part of the headlight that comes from everywhere.
pub const HEADLIGHT_AMBIENT: f64 = 0.35;
/// How far to the right of the viewer the headlight is, and how far above, as a part of the distance.
pub const HEADLIGHT_ASIDE: [f64; 2] = [-0.2, 0.3];

/// Points of sheets that a ray meets, at most.
pub const SHEET_LAYERS: u32 = 4;
/// Opacity of a fault's sheet.
pub const SHEET_OPACITY: f64 = 0.5;
/// Color (sRGB, 0..1) of faults without a name.
pub const UNNAMED: [f64; 3] = [0.55, 0.55, 0.55];
/// Colors (sRGB, 0..1) of named faults in turn, which color-blind people tell apart (Okabe and Ito 2008).
pub const PALETTE: [[f64; 3]; 7] = [
    [0.902, 0.624, 0.0],
    [0.337, 0.706, 0.914],
    [0.0, 0.620, 0.451],
    [0.941, 0.894, 0.259],
    [0.0, 0.447, 0.698],
    [0.835, 0.369, 0.0],
    [0.800, 0.475, 0.655],
];

/// Width of the lines along edges, in pixels.
pub const EDGE_WIDTH: f64 = 1.0;
/// How much darker they are than what they are on.
pub const EDGE_DARKNESS: f64 = 0.4;
/// Pixels from edge to edge between which lines come to be seen.
pub const EDGE_FADE: [f64; 2] = [3.0, 12.0];

/// Color (sRGB, 0..1) of a fault by its number.
pub fn fault_color(fault: Option<usize>) -> [f64; 3] {
    fault.map_or(UNNAMED, |n| PALETTE[n % PALETTE.len()])
}

impl View {
    /// Distance along a ray within which the faces on both sides of a fault lie: they are on one surface,
    /// but their triangles are not.
    pub fn fault_gap(&self) -> f64 {
        2.0 * self.sampling.step
    }

    /// The faces of the hull: boundary faces of the drawn cells of `grid` (the case's); inactive cells shown
    /// as ghosts have none.
    pub fn hull_faces(&self, grid: &Grid) -> Vec<(Ijk, Face)> {
        grid.boundary_faces(&self.shown.cells.drawn)
    }

    /// The fault faces of the drawn cells of `grid` (the case's) that the view shows, with the fault's number
    /// where it has a name; those of named faults are there whatever their throw.
    pub fn fault_faces(&self, grid: &Grid) -> Vec<(Ijk, Face, Option<usize>)> {
        let faces = grid.fault_faces_of(&self.shown.cells.drawn, &self.shown.named_faults);
        faces
            .into_iter()
            .map(|(cell, face)| (cell, face, self.shown.named_faults.fault_of(cell, face)))
            .filter(|(.., fault)| self.shows_fault(*fault))
            .collect()
    }

    /// True where a fault is among those that the view shows, by its number where it has a name.
    fn shows_fault(&self, fault: Option<usize>) -> bool {
        let Some(chosen) = &self.shown.chosen_faults else {
            return true;
        };
        fault.is_some_and(|n| chosen.get(n) == Some(&true))
    }
}
