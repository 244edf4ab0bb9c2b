//! PLTS, point location with topological search: every sample in its cell (campagnolo-2021, 4.1.3).
//! The twin of `shaders/plts.wgsl`.
//!
//! Departures from the shader: rays know all passages of the boundary of what is drawn at once. Of
//! the samples in a cell the first and the last one are located by Newton's method, and parameters in between are a
//! cubic that has the places and tangents of both.

use glam::Vec4;

use super::boundary::Boundary;
use super::frame::Ray;
use super::scene::Scene;
use super::surfaces::Layers;
use super::tally::Tally;
use super::topology::{Stretch, Track};
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
    let mut track = Track::new(scene.grid, ray, boundary, tally);
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
        let varies = scene.shading.varies(is_ghost);
        let samples = match entry {
            Some(entry) if !varies => {
                let shaded = scene.shading.shade_entry(entry, ray.base, is_ghost);
                even(scene, ray, &stretch, shaded, layers, sum)
            }
            Some(entry) => each(scene, ray, &stretch, layers, sum, |n| {
                let place = ray.sample(n);
                scene.shading.shade_entry(entry, place, is_ghost)
            }),
            None => each(scene, ray, &stretch, layers, sum, |n| {
                let entry = scene.transfer.of(track.cell().value(stretch.parameters(n)));
                scene.shading.shade_entry(entry, ray.sample(n), false)
            }),
        };
        track.tally.samples += samples as u64;
        n = stretch.first + stretch.more + 1.0;
        is_next = true;
    }
}

/// Adds samples of one color and extinction; returns how many were needed.
fn even(
    scene: &Scene<'_>,
    ray: &Ray,
    stretch: &Stretch,
    entry: Vec4,
    layers: &mut Layers,
    sum: &mut Accumulated,
) -> f32 {
    let (first, count) = (stretch.first, stretch.more + 1.0);
    let mut done = 0.0;
    while done < count && scene.transfer.is_open(sum) {
        let at = |n: f32| ray.distance(scene.frame.numbers.step, n);
        layers.blend_until(sum, at(first + done));
        // Up to the next surface.
        let before =
            |distance: f32| (distance / scene.frame.numbers.step - 0.5 - ray.first).floor();
        let end = layers.next().map_or(f32::MAX, |d| before(d) + 1.0 - first);
        let part = (count - done).min((end - done).max(1.0));
        done += scene.transfer.accumulate_many(sum, entry, part);
    }
    done
}

/// Adds samples one by one, by their colors and extinctions; returns how many were needed.
fn each(
    scene: &Scene<'_>,
    ray: &Ray,
    stretch: &Stretch,
    layers: &mut Layers,
    sum: &mut Accumulated,
    entry: impl Fn(f32) -> Vec4,
) -> f32 {
    let mut done = 0.0;
    while done <= stretch.more && scene.transfer.is_open(sum) {
        let n = stretch.first + done;
        layers.blend_until(sum, ray.distance(scene.frame.numbers.step, n));
        scene.transfer.accumulate(sum, entry(n));
        done += 1.0;
    }
    done
}
