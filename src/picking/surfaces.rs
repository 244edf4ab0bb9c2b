//! Where rays meet the surfaces of a view: its faces, listed once and kept by column.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::ray::{Ray, is_kept};
use crate::case::Case;
use crate::model::topology::Face;
use crate::model::{CellIndex, FaultFaces, Grid, Ijk};
use crate::scene::Hull;
use crate::view::View;
use crate::view::surfaces::SHEET_LAYERS;

/// Part of a box's size by which it is wider than what is in it: a ray along a side must not miss it.
const SLACK: f64 = 1e-9;

/// The faces of the surfaces that a view shows, kept while it shows the same ones.
#[derive(Default)]
pub(super) struct SurfaceFaces {
    of: Option<FacesKey>,
    /// By column.
    faces: Vec<(CellIndex, Face)>,
    columns: Vec<Column>,
}

/// What the faces depend on.
#[derive(Clone)]
struct FacesKey {
    /// One of each case.
    case: Arc<FaultFaces>,
    drawn: Arc<Vec<bool>>,
    hull: Hull,
    faults: bool,
}

/// The faces of a column of cells.
struct Column {
    /// Smallest and largest corner in grid space.
    bounds: [DVec3; 2],
    faces: Range<usize>,
}

/// A point of a surface on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Met {
    pub distance: f64,
    pub cell: Ijk,
    pub face: Face,
    /// The face is turned away from the viewer.
    pub is_back: bool,
}

impl FacesKey {
    fn is_same(&self, other: &Self) -> bool {
        let is_drawn = Arc::ptr_eq(&self.drawn, &other.drawn) || self.drawn == other.drawn;
        let kinds = |s: &Self| (s.hull, s.faults);
        kinds(self) == kinds(other) && Arc::ptr_eq(&self.case, &other.case) && is_drawn
    }
}

impl SurfaceFaces {
    /// The points of the surfaces that a ray sees, as [`crate::view::Surfaces`] defines them: the nearest one
    /// of the hull, or the nearest fault sheets.
    pub fn seen(&mut self, case: &Case, view: &View, ray: &Ray) -> Vec<Met> {
        // A faint hull is there for orientation, and is never what one clicks on.
        if view.style.surfaces.hull != Hull::Opaque && !view.style.surfaces.faults {
            return Vec::new();
        }
        self.update(case, view);
        let mut met = self.met(&case.grid, view, ray);
        met.retain(|m| is_kept(view, ray.at(m.distance)));
        let gap = view.fault_gap();
        if view.style.surfaces.hull == Hull::Opaque {
            let counts_as = |m: &Met| m.distance + if m.is_back { gap } else { 0.0 };
            let nearest = met
                .into_iter()
                .min_by(|a, b| counts_as(a).total_cmp(&counts_as(b)));
            return nearest.into_iter().collect();
        }
        met.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut sheets: Vec<Met> = Vec::new();
        for one in met {
            let is_same = |before: &Met| {
                one.distance < before.distance + gap || one.between() == before.between()
            };
            if !sheets.last().is_some_and(is_same) {
                sheets.push(one);
            }
        }
        sheets.truncate(SHEET_LAYERS as usize);
        sheets
    }

    /// Lists the faces anew where others are shown.
    fn update(&mut self, case: &Case, view: &View) {
        let now = FacesKey {
            case: view.shown.named_faults.clone(),
            drawn: view.shown.cells.drawn.clone(),
            hull: view.style.surfaces.hull,
            faults: view.style.surfaces.faults,
        };
        if self.of.as_ref().is_some_and(|known| known.is_same(&now)) {
            return;
        }
        let grid = &case.grid;
        let dims = grid.dims();
        let mut faces: Vec<(Ijk, Face)> = match view.style.surfaces.hull {
            Hull::Opaque => view.hull_faces(grid),
            Hull::Hidden | Hull::Faint => {
                let faults = view.fault_faces(grid).into_iter();
                faults.map(|(cell, face, _)| (cell, face)).collect()
            }
        };
        faces.par_sort_by_key(|(cell, _)| (cell.j, cell.i));
        let columns: Vec<&[(Ijk, Face)]> = faces
            .chunk_by(|(a, _), (b, _)| (a.i, a.j) == (b.i, b.j))
            .collect();
        let bounds: Vec<[DVec3; 2]> = columns.par_iter().map(|c| bounds(grid, c)).collect();
        let mut end = 0;
        let column = |(bounds, faces): ([DVec3; 2], &&[(Ijk, Face)])| {
            let start = end;
            end += faces.len();
            Column {
                bounds,
                faces: start..end,
            }
        };
        self.columns = bounds.into_iter().zip(&columns).map(column).collect();
        let numbered = faces.iter().map(|(cell, face)| (dims.cell(*cell), *face));
        self.faces = numbered.collect();
        self.of = Some(now);
    }

    /// Every face that a ray meets, in no order.
    fn met(&self, grid: &Grid, view: &View, ray: &Ray) -> Vec<Met> {
        let ray = ray.in_grid(view);
        let is_met = |column: &&Column| {
            let [enter, leave] = ray.within(column.bounds);
            enter <= leave && leave > 0.0
        };
        let columns = self.columns.iter().filter(is_met);
        let faces = columns.flat_map(|c| &self.faces[c.faces.clone()]);
        faces
            .flat_map(|&(cell, face)| Met::of(grid, grid.dims().ijk(cell), face, ray))
            .collect()
    }
}

impl Met {
    /// Where a ray in grid space meets the two triangles of a face.
    fn of(grid: &Grid, cell: Ijk, face: Face, ray: Ray) -> impl Iterator<Item = Self> {
        let hexahedron = grid.hexahedron(cell);
        let center = hexahedron.center();
        let [a, b, c, d] = face.corners()[0].map(|n| hexahedron.0[n]);
        [[a, b, d], [a, d, c]]
            .into_iter()
            .filter_map(move |[a, b, c]| {
                let normal = (b - a).cross(c - a);
                let outward = normal * normal.dot(a - center).signum();
                Some(Self {
                    distance: ray.meets([a, b, c])?,
                    cell,
                    face,
                    is_back: outward.dot(ray.direction) > 0.0,
                })
            })
    }

    /// The two columns that the face lies between.
    fn between(&self) -> (usize, usize, Face) {
        let Ijk { i, j, .. } = self.cell;
        match self.face {
            Face::IMinus => (i.wrapping_sub(1), j, Face::IPlus),
            Face::JMinus => (i, j.wrapping_sub(1), Face::JPlus),
            other => (i, j, other),
        }
    }
}

/// Box of some faces in grid space.
fn bounds(grid: &Grid, faces: &[(Ijk, Face)]) -> [DVec3; 2] {
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for (cell, face) in faces {
        let corners = grid.hexahedron(*cell).0;
        for corner in face.corners()[0].map(|n| corners[n]) {
            bounds = [bounds[0].min(corner), bounds[1].max(corner)];
        }
    }
    let slack = DVec3::splat(SLACK * bounds[0].distance(bounds[1]));
    [bounds[0] - slack, bounds[1] + slack]
}
