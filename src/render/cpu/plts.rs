//! PLTS, point location with topological search: every sample in its cell (campagnolo-2021, 4.1.3).
//! The twin of `shaders/plts.wgsl`.
//!
//! Departures from the shader: rays know where they pass the boundary of what is drawn, and search nowhere else. Of
//! the samples in a cell the first and the last one are located by Newton's method, and parameters in between are a
//! cubic that has the places and tangents of both.

use super::boundary::Boundary;
use super::frame::Ray;
use super::samples::Samples;
use super::scene::Scene;
use super::surfaces::Layers;
use super::tally::Tally;
use super::topology::Track;
use super::transfer::Accumulated;
use crate::scene::Interpolation;

/// Adds what a ray meets to what is there.
pub fn cast(
    scene: &Scene<'_>,
    ray: &Ray,
    boundary: &Boundary,
    layers: &mut Layers,
    sum: &mut Accumulated,
    tally: &mut Tally,
) {
    let mut track = Track::new(scene, ray, boundary, tally);
    let mut n = 0.0;
    let mut is_next = false;
    while scene.transfer.is_open(sum) {
        let Some(stretch) = track.next(n, is_next) else {
            break;
        };
        let cell = track.cell();
        let is_ghost = scene.grid.is_ghost(cell.column, cell.layer);
        let entry = match (is_ghost, scene.grid.interpolation) {
            (true, _) => Some(scene.ghost),
            (false, Interpolation::Cell) => Some(scene.transfer.of(cell.k0.w)),
            (false, Interpolation::Vertex) => None,
        };
        let samples = Samples {
            scene,
            ray,
            first: stretch.first,
            count: stretch.more + 1.0,
        };
        let taken = match entry {
            Some(entry) => samples.of_one(entry, is_ghost, layers, sum),
            None => samples.by_value(layers, sum, |n| cell.values(stretch.parameters(n))),
        };
        track.tally.samples += taken as u64;
        n = stretch.first + stretch.more + 1.0;
        is_next = true;
    }
}
