//! Two cases under one camera.

use glam::DVec3;

use crate::scene::{CameraSpec, ExplicitCamera};
use crate::view::camera::middle;

/// From the world of one case to that of another: the same world where the models overlap on the map, else the
/// middle of one model on that of the other, as large as that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    from: DVec3,
    to: DVec3,
    scale: f64,
}

impl Link {
    /// Between two models, given the corners of their boxes in world space.
    pub fn between(a: &[DVec3; 8], b: &[DVec3; 8]) -> Self {
        let bounds = |corners: &[DVec3; 8]| {
            let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            let grow = |[low, high]: [DVec3; 2], p: &DVec3| [low.min(*p), high.max(*p)];
            corners.iter().fold(start, grow)
        };
        let [[low, high], [other_low, other_high]] = [a, b].map(bounds);
        let overlap = low.cmple(other_high).all() && other_low.cmple(high).all();
        if overlap {
            return Self {
                from: DVec3::ZERO,
                to: DVec3::ZERO,
                scale: 1.0,
            };
        }
        let scale = other_low.distance(other_high) / low.distance(high).max(1e-9);
        Self {
            from: middle(a),
            to: middle(b),
            scale: scale.max(1e-9),
        }
    }

    /// True where both models are in one world.
    pub fn is_one_world(&self) -> bool {
        self.from == self.to && self.scale == 1.0
    }

    /// The camera that sees the second model as this one sees the first.
    pub fn there(&self, camera: &CameraSpec) -> CameraSpec {
        moved(camera, |p| self.to + self.scale * (p - self.from))
    }

    /// The other way around.
    pub fn back(&self, camera: &CameraSpec) -> CameraSpec {
        moved(camera, |p| self.from + (p - self.to) / self.scale)
    }
}

fn moved(camera: &CameraSpec, to: impl Fn(DVec3) -> DVec3) -> CameraSpec {
    match camera {
        // One that frames what is drawn does so with each.
        CameraSpec::Framing(_) | CameraSpec::Automatic(_) => camera.clone(),
        CameraSpec::Explicit(c) => CameraSpec::Explicit(ExplicitCamera {
            eye: to(DVec3::from_array(c.eye)).to_array(),
            target: to(DVec3::from_array(c.target)).to_array(),
            ..c.clone()
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Projection;

    fn corners(at: f64, size: f64) -> [DVec3; 8] {
        std::array::from_fn(|n| {
            let bit = |axis: usize| if n >> axis & 1 == 1 { size } else { 0.0 };
            DVec3::new(at + bit(0), bit(1), bit(2))
        })
    }

    #[test]
    fn models_far_apart_are_seen_alike_and_overlapping_ones_in_place() {
        let camera = CameraSpec::Explicit(ExplicitCamera {
            eye: [0.5, -3.0, 0.5],
            target: [0.5, 0.5, 0.5],
            up: [0.0, 0.0, 1.0],
            fovy_degrees: 30.0,
            projection: Projection::Perspective,
        });
        let link = Link::between(&corners(0.0, 1.0), &corners(100.0, 2.0));
        let CameraSpec::Explicit(there) = link.there(&camera) else {
            panic!("it stays explicit");
        };
        assert_eq!(there.eye, [101.0, -6.0, 1.0]);
        assert_eq!(there.target, [101.0, 1.0, 1.0]);
        assert_eq!(link.back(&CameraSpec::Explicit(there)), camera);
        let near = Link::between(&corners(0.0, 1.0), &corners(0.5, 2.0));
        assert!(near.is_one_world() && !link.is_one_world());
        assert_eq!(near.there(&camera), camera);
    }
}
