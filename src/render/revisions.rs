//! What a change of a view makes stale: the one place that says so.
//!
//! What is kept from one image to the next holds the revision that it was made of, and is made anew where that has
//! counted up. Camera, size, sampling and colors of lights are in no revision: they are told anew with each image.
//! A light volume is made anew with the extinction, and where its own emitter has changed; what is compiled, where
//! its constants have.

use std::sync::Arc;

use crate::scene::{Hull, Storage};
use crate::view::{ShownCube, View};

/// Numbers that count up with each change of what a view shows of one grid, and never fall: what a canceled update
/// has dropped is stale for good.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Revisions {
    /// The cells that rays can meet: inactive ones, or none of them; and how they are held. The grid and its
    /// acceleration.
    pub grid: u64,
    /// The drawn cells. Their bits, and lists of boundary faces.
    pub drawn: u64,
    /// Values. Those at cells or vertices, and volumes that are resampled from them.
    pub values: u64,
    /// Colors and opacities. The tables of the transfer function.
    pub transfer: u64,
    /// The drawn cells in which something shows. Their bits, and lists of their boundary faces.
    pub visible: u64,
    /// The faces that are hull or faults. Their lists.
    pub surfaces: u64,
    /// Opacity at points of space. The extinction pyramid, and all light volumes.
    pub extinction: u64,
    /// Values at points of space, whatever the curve. The pyramid of values.
    pub placed: u64,
    /// Slopes of values at points of space. The volume of gradients.
    pub gradients: u64,
    /// Values of a cube beside the model. Its voxels.
    pub cube: u64,
    /// How that looks and where it is. The table of its transfer function.
    pub cube_look: u64,
}

/// Follows the views of one grid.
#[derive(Debug, Default)]
pub struct RevisionCounter {
    last: Option<View>,
    now: Revisions,
}

impl RevisionCounter {
    /// The revisions of a view, the next one in a row.
    pub fn of(&mut self, view: &View) -> Revisions {
        let changes = |differs: fn(&View, &View) -> bool| {
            self.last.as_ref().is_none_or(|last| differs(last, view))
        };
        // The exact grid without ghosts is there before the first view.
        let held = self.last.as_ref().map(held).unwrap_or_default();
        let grid = held != self::held(view);
        let drawn = grid || changes(|a, b| a.shown.cells.drawn != b.shown.cells.drawn);
        let values = drawn || changes(|a, b| !a.shown.cells.is_same(&b.shown.cells));
        let transfer = changes(|a, b| colors(a) != colors(b));
        let surfaces = drawn || changes(|a, b| surfaces(a) != surfaces(b));
        let opacities = changes(|a, b| opacities(a) != opacities(b));
        let visible = values || opacities;
        let space = changes(|a, b| space(a) != space(b));
        let occluders = changes(|a, b| occluders(a) != occluders(b));
        let placed = values || space;
        let extinction = placed || opacities || occluders;
        let gradients = values || space || changes(|a, b| range(a) != range(b));
        let cube = changes(|a, b| {
            let of = |view: &View| view.shown.cube.as_ref().map(|s| s.cube.clone());
            match (of(a), of(b)) {
                (Some(a), Some(b)) => !Arc::ptr_eq(&a, &b),
                (a, b) => a.is_some() != b.is_some(),
            }
        });
        let cube_look = grid || cube || changes(|a, b| cube_look(a) != cube_look(b));
        for (revision, changes) in [
            (&mut self.now.cube, cube),
            (&mut self.now.cube_look, cube_look),
            (&mut self.now.grid, grid),
            (&mut self.now.drawn, drawn),
            (&mut self.now.values, values),
            (&mut self.now.visible, visible),
            (&mut self.now.transfer, transfer),
            (&mut self.now.surfaces, surfaces),
            (&mut self.now.extinction, extinction),
            (&mut self.now.placed, placed),
            (&mut self.now.gradients, gradients),
        ] {
            *revision += u64::from(changes);
        }
        self.last = Some(view.clone());
        self.now
    }
}

/// Whether a grid has ghosts, and how it is held.
fn held(view: &View) -> (bool, Storage) {
    (view.shown.cells.ghosts.is_some(), view.sampling.storage)
}

fn colors(view: &View) -> impl PartialEq {
    (&view.style.transfer, view.style.blending)
}

fn surfaces(view: &View) -> impl PartialEq {
    let shown = view.style.surfaces;
    (
        shown.hull,
        shown.faults,
        &view.shown.named_faults,
        &view.shown.chosen_faults,
    )
}

/// Light's own space, and what of it is kept.
fn space(view: &View) -> impl PartialEq {
    let lighting = &view.style.lighting;
    let size = (lighting.size(), lighting.light_size(), lighting.extent);
    (size, view.world.vertical_exaggeration, &view.shown.clip)
}

/// What else than cells stands in the way of light.
fn occluders(view: &View) -> impl PartialEq {
    let lit = view.style.lighting.geometry && !view.style.lighting.is_off();
    let shown = view.style.surfaces;
    let wells = (lit && shown.wells).then(|| {
        let capsules = view.shown.wells.capsules.iter();
        capsules.map(|c| (c.ends, c.radius)).collect::<Vec<_>>()
    });
    let sheets = lit && shown.faults && shown.hull != Hull::Opaque;
    (
        wells,
        sheets.then(|| {
            (
                view.shown.named_faults.clone(),
                view.shown.chosen_faults.clone(),
            )
        }),
    )
}

fn opacities(view: &View) -> impl PartialEq {
    let transfer = &view.style.transfer;
    (&transfer.opacity, transfer.reference_length, range(view))
}

/// What executors read of a cube beside its values, and of the view for it.
fn cube_look(view: &View) -> impl PartialEq {
    let look = |shown: &Arc<ShownCube>| {
        (
            shown.transfer.clone(),
            shown.world_from_sample,
            shown.crop,
            shown.step(view.sampling.step),
        )
    };
    let shown = view.shown.cube.as_ref().map(look);
    (
        shown,
        view.style.blending,
        view.world.spaces.world_from_grid,
    )
}

fn range(view: &View) -> impl PartialEq {
    view.style.transfer.range
}
