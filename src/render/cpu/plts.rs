//! PLTS, point location with topological search (campagnolo-2021, 4.1.3): every sample in its cell, or every cell from
//! where a ray comes in to where it leaves. The twin of `shaders/plts.wgsl`.
//!
//! Departures from the shader: rays know all passages of the boundary of what is drawn at once. Of
//! the samples in a cell the first and the last one are located by Newton's method, and parameters in between are a
//! cubic that has the places and tangents of both.

use glam::Vec4;

use super::boundary::Boundary;
use super::frame::Ray;
use super::samples::Samples;
use super::scene::Scene;
use super::segments::Span;
use super::surfaces::Layers;
use super::tally::Tally;
use super::topology::{Stretch, Track};
use super::transfer::Accumulated;
use crate::scene::Integration;

/// Ways without length in a row after which a ray is located anew.
const MOST_STALLS: u32 = 32;
/// How far ahead, in samples.
const NUDGE: f32 = 0.25;

/// What a ray walks through.
pub struct Way<'a> {
    /// What all rays read.
    pub scene: &'a Scene<'a>,
    /// The ray.
    pub ray: &'a Ray,
    /// Where it passes the boundary of what it meets.
    pub boundary: &'a Boundary,
    /// What is integrated.
    pub integration: Integration,
}

impl Way<'_> {
    /// Adds what the ray meets to what is there.
    pub fn cast(&self, layers: &mut Layers, sum: &mut Accumulated, tally: &mut Tally) {
        let Self { scene, ray, .. } = *self;
        let mut track = Track::new(scene.grid, scene.visible, ray, self.boundary, tally);
        // Where layers cross, a point of several cells belongs to the first of them: each sample is located.
        match self.integration {
            Integration::Segments if !scene.grid.compact.facts.layers_cross => {
                self.by_segments(&mut track, layers, sum);
            }
            _ => self.by_samples(&mut track, layers, sum),
        }
    }

    fn by_samples(&self, track: &mut Track<'_>, layers: &mut Layers, sum: &mut Accumulated) {
        let Self { scene, ray, .. } = *self;
        let mut n = 0.0;
        let mut is_next = false;
        while scene.transfer.is_open(sum) {
            let Some(stretch) = track.next(n, is_next) else {
                break;
            };
            let cell = track.cell();
            let is_ghost = scene.grid.is_ghost(cell.column, cell.layer);
            let samples = Samples {
                scene,
                ray,
                first: stretch.first,
                count: stretch.more + 1.0,
            };
            let taken = match scene.entry_of(cell.column, cell.layer) {
                Some(entry) => samples.of_one(entry, is_ghost, layers, sum),
                None => samples.by_value(layers, sum, |n| cell.values(stretch.parameters(n))),
            };
            track.tally.samples += taken as u64;
            n = stretch.first + stretch.more + 1.0;
            is_next = true;
        }
    }

    fn by_segments(&self, track: &mut Track<'_>, layers: &mut Layers, sum: &mut Accumulated) {
        let Self { scene, ray, .. } = *self;
        let step = scene.frame.numbers.step;
        let place = |distance: f32| distance / step - 0.5 - ray.first;
        let end = place(ray.leave);
        let mut n = place(ray.enter);
        let (mut joins, mut stalls) = (false, 0);
        while scene.transfer.is_open(sum) && n < end {
            let Some(way) = track.cross(n, joins) else {
                break;
            };
            let to = way.first + way.more;
            stalls = if to > n { 0 } else { stalls + 1 };
            self.integrate(track, &way, to.min(end), layers, sum);
            n = n.max(to);
            joins = track.leave();
            if stalls > MOST_STALLS {
                track.tally.recovered += 1;
                (joins, stalls) = (false, 0);
                n += NUDGE;
            }
        }
    }

    /// Adds what lies on a way, up to a place. Surfaces lie on faces, so those that are nearer than its end lie at its
    /// beginning, and what is opaque ends the ray.
    fn integrate(
        &self,
        track: &mut Track<'_>,
        way: &Stretch,
        to: f32,
        layers: &mut Layers,
        sum: &mut Accumulated,
    ) {
        let Self { scene, ray, .. } = *self;
        let step = scene.frame.numbers.step;
        let [from, to] = [way.first, to].map(|n| ray.distance(step, n));
        layers.blend_until(scene, sum, 0.5 * (from + to));
        if to <= from {
            return;
        }
        let span = Span {
            scene,
            ray,
            from,
            to,
        };
        let cell = track.cell();
        let is_ghost = scene.grid.is_ghost(cell.column, cell.layer);
        let place = |t: Vec4| t / step - (0.5 + ray.first);
        let values = |t| cell.values(way.parameters(place(t)));
        track.tally.samples += span.add(is_ghost, sum, values);
    }
}
