//! Where rays meet the surfaces of a view: a tree over its faces, kept while it shows the same ones.

use std::sync::Arc;

use super::ray::Ray;
use crate::model::topology::Face;
use crate::model::{FaceHit, FaceTree, FaultFaces, Grid, Ijk};
use crate::scene::Hull;
use crate::view::View;
use crate::view::surfaces::SHEET_LAYERS;

/// The faces of the surfaces that a view of one grid shows.
#[derive(Default)]
pub struct SurfaceTree {
    of: Option<Key>,
    tree: FaceTree,
}

/// What the faces depend on.
#[derive(Clone, PartialEq)]
struct Key {
    drawn: Arc<Vec<bool>>,
    named: Arc<FaultFaces>,
    chosen: Option<Arc<[bool]>>,
    hull: Hull,
    faults: bool,
}

impl SurfaceTree {
    /// The points of the surfaces that a ray sees, as [`crate::view::Surfaces`] defines them: the nearest one
    /// of the hull, or the nearest fault sheets.
    pub(super) fn seen(&mut self, grid: &Grid, view: &View, ray: &Ray) -> Vec<FaceHit> {
        let surfaces = view.style.surfaces;
        // A faint hull is there for orientation, and is never what one clicks on.
        if surfaces.hull != Hull::Opaque && !surfaces.faults {
            return Vec::new();
        }
        self.update(grid, view);
        let in_grid = ray.in_grid(view);
        let mut met = self.tree.meets(grid, in_grid.origin, in_grid.direction);
        met.retain(|hit| view.keeps(ray.at(hit.distance)));
        let gap = view.fault_gap();
        if surfaces.hull == Hull::Opaque {
            let counts_as = |hit: &FaceHit| hit.distance + if hit.is_exit { gap } else { 0.0 };
            let nearest = met
                .into_iter()
                .min_by(|a, b| counts_as(a).total_cmp(&counts_as(b)));
            return nearest.into_iter().collect();
        }
        met.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut sheets: Vec<FaceHit> = Vec::new();
        for one in met {
            let is_same = |before: &FaceHit| {
                one.distance < before.distance + gap || between(&one) == between(before)
            };
            if !sheets.last().is_some_and(is_same) {
                sheets.push(one);
            }
        }
        sheets.truncate(SHEET_LAYERS as usize);
        sheets
    }

    /// Lists the faces anew where others are shown.
    fn update(&mut self, grid: &Grid, view: &View) {
        let now = Key {
            drawn: view.shown.cells.drawn.clone(),
            named: view.shown.named_faults.clone(),
            chosen: view.shown.chosen_faults.clone(),
            hull: view.style.surfaces.hull,
            faults: view.style.surfaces.faults,
        };
        if self.of.as_ref() == Some(&now) {
            return;
        }
        let faces: Vec<(Ijk, Face)> = match now.hull {
            Hull::Opaque => view.hull_faces(grid),
            Hull::Hidden | Hull::Faint => {
                let faults = view.fault_faces(grid).into_iter();
                faults.map(|(cell, face, _)| (cell, face)).collect()
            }
        };
        self.tree = FaceTree::new(grid, &faces);
        self.of = Some(now);
    }
}

/// The two columns that a face lies between.
fn between(hit: &FaceHit) -> (usize, usize, Face) {
    let Ijk { i, j, .. } = hit.cell;
    match hit.face {
        Face::IMinus => (i.wrapping_sub(1), j, Face::IPlus),
        Face::JMinus => (i, j.wrapping_sub(1), Face::JPlus),
        other => (i, j, other),
    }
}
