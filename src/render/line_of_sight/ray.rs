//! The ray through a place in the image, and the samples that lie on it.

use std::ops::Range;

use glam::{DVec2, DVec3};

use crate::view::View;

/// Samples of a ray, at most; where an image has more, these lie farther apart.
const MOST_SAMPLES: f64 = 20_000.0;

/// A ray in world space.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// The eye, or in parallel a point of the plane through it.
    pub origin: DVec3,
    /// Of unit length.
    pub direction: DVec3,
}

/// The part of a ray on which samples lie: within the model's box and on the kept side of all clip planes.
#[derive(Debug, Clone)]
pub struct Span {
    /// Sample `n` lies at `(n + 1/2) * step`.
    pub samples: Range<u64>,
    /// Distance from one to the next.
    pub step: f64,
    /// It starts inside the box: its origin is there, or a clip plane opens it.
    pub starts_inside: bool,
    /// Distance of the opaque clip plane through which it starts, if it does.
    pub section: Option<f64>,
}

impl Span {
    /// Distance of a sample.
    pub fn distance(&self, number: u64) -> f64 {
        (number as f64 + 0.5) * self.step
    }
}

impl Ray {
    /// The ray through a place (0 to 1, right and down).
    pub fn through(view: &View, at: DVec2) -> Self {
        let (origin, direction) = view.camera.ray(at, view.aspect());
        Self { origin, direction }
    }

    /// The point at a distance.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + distance * self.direction
    }

    /// The same ray in grid space; a point keeps its distance, so that the direction has no unit length there.
    pub fn in_grid(&self, view: &View) -> Self {
        let grid_from_world = view.world.spaces.grid_from_world;
        Self {
            origin: grid_from_world.transform_point3(self.origin),
            direction: grid_from_world.transform_vector3(self.direction),
        }
    }

    /// Distances at which the ray enters and leaves a box; it misses the box where it leaves before it enters.
    pub fn within(&self, [low, high]: [DVec3; 2]) -> [f64; 2] {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let to = |plane: DVec3| (plane[axis] - self.origin[axis]) / self.direction[axis];
            let (a, b) = (to(low), to(high));
            // A ray along a side gives 0 / 0, which `max` and `min` pass over.
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        [enter, leave]
    }

    /// Where samples of a view lie on the ray; `None` where it misses all that is kept.
    pub fn span(&self, view: &View) -> Option<Span> {
        let ends = [view.world.corners[0], view.world.corners[7]];
        let ends = ends.map(|c| view.world.spaces.grid_from_world.transform_point3(c));
        let [box_enter, box_leave] = self.in_grid(view).within(ends);
        let (mut enter, mut leave, mut section) = (0.0, f64::INFINITY, None);
        for plane in &view.shown.clip {
            let rate = self.direction.dot(plane.normal);
            let height = (self.origin - plane.point).dot(plane.normal);
            if rate == 0.0 && height < 0.0 {
                return None;
            } else if rate < 0.0 {
                leave = f64::min(leave, -height / rate);
            } else if -height / rate > enter {
                enter = -height / rate;
                section = plane.opaque.then_some(enter);
            }
        }
        let starts_inside = enter >= box_enter;
        if box_leave.min(leave) <= box_enter.max(enter) || !box_leave.is_finite() {
            return None;
        }
        let length = box_leave - box_enter.max(0.0);
        let step = view.sampling.step.max(length / MOST_SAMPLES);
        // The box has slack of a sample, clip planes have none: they cut through cells.
        let first = (box_enter / step - 0.5).floor();
        let first = first.max((enter / step - 0.5).ceil()).max(0.0);
        let last = (box_leave / step - 0.5).ceil();
        let last = last.min((leave / step - 0.5).floor());
        Some(Span {
            samples: first as u64..(last + 1.0).max(first) as u64,
            step,
            starts_inside,
            section: section.filter(|_| starts_inside),
        })
    }
}
