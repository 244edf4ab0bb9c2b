//! Surfaces of cells as parts of the picture: the hull, faults, edges of cells on them.

use serde::{Deserialize, Serialize};

use super::{Show, View};
use crate::model::topology::Face;
use crate::model::{Grid, Ijk};

/// How the boundary faces of the drawn cells look.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hull {
    /// Not at all: one looks into the volume.
    #[default]
    Hidden,
    /// Opaque and colored by the field.
    Opaque,
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
/// Faults are sheets of [`SHEET_OPACITY`], or where the hull is shown that part of its color. Of a fault
/// the faces of both sides are drawn, but what lies between the same two columns as the surface before it
/// on a ray, or behind that by less than [`View::fault_gap`], is the same sheet and is left out.
///
/// Edges darken what they are on, hull, sheets and opaque sections, by [`EDGE_DARKNESS`] times the part of
/// a pixel that a line of [`EDGE_WIDTH`] pixels covers: `clamp(width / 2 + 1/2 - d)`, `d` being the pixels to
/// the nearest edge across which a parameter of the cell ends, times a smooth step over [`EDGE_FADE`] of
/// the pixels from edge to edge, for where lines are dense there is nothing to tell apart.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Surfaces {
    /// The hull is opaque.
    pub hull: bool,
    /// Faults are shown.
    pub faults: bool,
    /// Edges of cells are drawn on surfaces and opaque sections.
    pub cell_edges: bool,
}

impl From<&Show> for Surfaces {
    fn from(show: &Show) -> Self {
        Self {
            hull: show.hull == Hull::Opaque,
            faults: show.faults,
            cell_edges: show.cell_edges,
        }
    }
}

impl Surfaces {
    /// True where there are any: edges alone have nothing to be on but sections.
    pub fn are_shown(self) -> bool {
        self.hull || self.faults
    }
}

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
pub const EDGE_WIDTH: f64 = 1.5;
/// How much darker they are than what they are on.
pub const EDGE_DARKNESS: f64 = 0.85;
/// Pixels from edge to edge between which lines come to be seen.
pub const EDGE_FADE: [f64; 2] = [2.0, 6.0];

/// Color (sRGB, 0..1) of a fault by its number.
pub fn fault_color(fault: Option<usize>) -> [f64; 3] {
    fault.map_or(UNNAMED, |n| PALETTE[n % PALETTE.len()])
}

impl View {
    /// Distance along a ray within which the faces on both sides of a fault lie: they are on one surface,
    /// but their triangles are not.
    pub fn fault_gap(&self) -> f64 {
        2.0 * self.sampling_step
    }

    /// Which active cells of `grid` (the case's) are drawn, by active index.
    pub fn drawn_active(&self, grid: &Grid) -> Vec<bool> {
        match &self.ghosts {
            None => self.drawn.to_vec(),
            Some(ghosts) => {
                let cells = grid.active_cells().iter();
                let of_all = cells.filter_map(|&cell| ghosts.grid.active_index(cell));
                of_all.map(|a| self.drawn[a.0 as usize]).collect()
            }
        }
    }

    /// The faces of the hull: boundary faces of the drawn cells of `grid` (the case's); inactive cells shown
    /// as ghosts have none.
    pub fn hull_faces(&self, grid: &Grid) -> Vec<(Ijk, Face)> {
        grid.boundary_faces(&self.drawn_active(grid))
    }

    /// The fault faces of the drawn cells of `grid` (the case's), with the fault's number where it has a
    /// name; those of named faults are there whatever their throw.
    pub fn fault_faces(&self, grid: &Grid) -> Vec<(Ijk, Face, Option<usize>)> {
        let faces = grid.fault_faces_of(&self.drawn_active(grid), &self.named_faults);
        faces
            .into_iter()
            .map(|(cell, face)| (cell, face, self.named_faults.fault_of(cell, face)))
            .collect()
    }
}
