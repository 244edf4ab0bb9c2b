//! How near a camera comes to what it frames.

use glam::DVec3;

use super::Camera;

/// Parts of the picture's width and height that stay free around what is framed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// At the left.
    pub left: f64,
    /// At the right.
    pub right: f64,
    /// Above.
    pub top: f64,
    /// Below.
    pub bottom: f64,
}

/// The same on all sides.
pub const MARGINS: Margins = Margins {
    left: 0.04,
    right: 0.04,
    top: 0.04,
    bottom: 0.04,
};

impl Camera {
    /// The camera in this one's direction that has all points in its picture, as large as they can be.
    #[must_use]
    pub fn framed(self, points: &[DVec3], aspect: f64) -> Self {
        self.framed_within(points, aspect, MARGINS, 1.0)
    }

    /// The same within some margins; a `zoom` above 1 comes closer to the middle between them. The plane of a
    /// parallel camera does not cut what is framed, however it is turned about its middle.
    #[must_use]
    pub fn framed_within(self, points: &[DVec3], aspect: f64, margins: Margins, zoom: f64) -> Self {
        let Some(first) = points.first() else {
            return self;
        };
        let start = [*first, *first];
        let [low, high] = points
            .iter()
            .fold(start, |[a, b], p| [a.min(*p), b.max(*p)]);
        let center = 0.5 * (low + high);
        let seen = points.iter().map(|p| {
            let p = *p - center;
            DVec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.forward))
        });
        let opening = Opening::of(self.tan_half_fovy, aspect, margins);
        let fit = match self.parallel {
            None => opening.perspective(seen),
            Some(_) => opening.parallel(seen, self.tan_half_fovy),
        };
        let to_world = |v: DVec3| v.x * self.right + v.y * self.up + v.z * self.forward;
        let camera = Self {
            eye: center + to_world(fit.eye),
            parallel: fit.half_height,
            ..self
        };
        let reach = camera.half_height(fit.depth) / self.tan_half_fovy;
        let middle = camera.eye + to_world((reach * opening.middle()).with_z(fit.depth));
        camera.closer(middle, zoom)
    }
}

/// How far the margins let the picture reach to each side, per unit of depth of a perspective camera.
struct Opening {
    left: f64,
    right: f64,
    below: f64,
    above: f64,
}

/// A camera in its own axes: right, up and forward.
struct Fit {
    eye: DVec3,
    /// Of a parallel camera half the picture's height.
    half_height: Option<f64>,
    /// Of the middle of what is framed.
    depth: f64,
}

impl Opening {
    fn of(tan: f64, aspect: f64, margins: Margins) -> Self {
        let part = |margin: f64| 1.0 - 2.0 * margin;
        Self {
            left: tan * aspect * part(margins.left),
            right: tan * aspect * part(margins.right),
            below: tan * part(margins.bottom),
            above: tan * part(margins.top),
        }
    }

    /// Where the middle between the margins is, per unit of depth.
    fn middle(&self) -> DVec3 {
        0.5 * DVec3::new(self.right - self.left, self.above - self.below, 0.0)
    }

    /// The eye that is nearest to points: each of the four sides is a plane through it that no point may be
    /// beyond, and two opposite planes bound how far forward it may be.
    fn perspective(&self, points: impl Iterator<Item = DVec3>) -> Fit {
        let mut across = Span::default();
        let mut upward = Span::default();
        let mut depths = Span::default();
        for p in points {
            across.add([p.x + self.left * p.z, p.x - self.right * p.z]);
            upward.add([p.y + self.below * p.z, p.y - self.above * p.z]);
            depths.add([p.z; 2]);
        }
        let by_width = -across.length() / (self.left + self.right);
        let by_height = -upward.length() / (self.below + self.above);
        // A single point could not be before the eye.
        let z = by_width.min(by_height).min(depths.low - 1e-9);
        let between = |span: &Span, slopes: [f64; 2]| {
            0.5 * (span.low - slopes[0] * z + span.high + slopes[1] * z)
        };
        let x = between(&across, [self.left, self.right]);
        let y = between(&upward, [self.below, self.above]);
        Fit {
            eye: DVec3::new(x, y, z),
            half_height: None,
            depth: depths.middle() - z,
        }
    }

    fn parallel(&self, points: impl Iterator<Item = DVec3>, tan: f64) -> Fit {
        let mut across = Span::default();
        let mut upward = Span::default();
        let mut radius: f64 = 0.0;
        for p in points {
            across.add([p.x; 2]);
            upward.add([p.y; 2]);
            radius = radius.max(p.length());
        }
        let by_width = across.length() / (self.left + self.right);
        let by_height = upward.length() / (self.below + self.above);
        // The depth at which a perspective picture is as high.
        let reach = by_width.max(by_height).max(1e-9);
        let depth = reach.max(1.01 * radius);
        let eye = DVec3::new(across.middle(), upward.middle(), 0.0) - reach * self.middle();
        Fit {
            eye: eye.with_z(-depth),
            half_height: Some(reach * tan),
            depth,
        }
    }
}

/// The smallest of the first and the largest of the second of pairs of numbers.
struct Span {
    low: f64,
    high: f64,
}

impl Default for Span {
    fn default() -> Self {
        Self {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        }
    }
}

impl Span {
    fn add(&mut self, [low, high]: [f64; 2]) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    fn length(&self) -> f64 {
        self.high - self.low
    }

    fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::scene::Projection;

    /// A thin slab that lies diagonally in its box.
    fn diagonal() -> Vec<DVec3> {
        let along = DVec3::new(30.0, 40.0, 0.0);
        let across = DVec3::new(-8.0, 6.0, 0.0);
        let ends = [0.0, 1.0];
        let at = |a: f64, b: f64, z: f64| a * along + b * across + z * DVec3::Z;
        let points = ends.map(|a| ends.map(|b| [0.0, 3.0].map(|z| at(a, b, z))));
        points.as_flattened().as_flattened().to_vec()
    }

    /// Free parts of the picture at the left, right, top and bottom.
    fn free(camera: &Camera, points: &[DVec3], aspect: f64) -> [f64; 4] {
        let seen: Vec<_> = points
            .iter()
            .map(|p| camera.project(*p, aspect).unwrap())
            .collect();
        let least = |of: &dyn Fn(usize) -> f64| (0..seen.len()).map(of).fold(1.0, f64::min);
        [
            least(&|n| seen[n].x),
            least(&|n| 1.0 - seen[n].x),
            least(&|n| seen[n].y),
            least(&|n| 1.0 - seen[n].y),
        ]
    }

    const UNEVEN: Margins = Margins {
        left: 0.1,
        right: 0.02,
        top: 0.05,
        bottom: 0.2,
    };

    #[test]
    fn what_is_framed_reaches_two_margins_and_is_centered_between_the_others() {
        let points = diagonal();
        for projection in [Projection::Perspective, Projection::Parallel] {
            for margins in [MARGINS, UNEVEN] {
                for (azimuth, elevation, aspect) in [
                    (0.3, 0.6, 1.0),
                    (2.0, 0.2, 3.0),
                    (4.0, -0.5, 0.3),
                    (1.0, std::f64::consts::FRAC_PI_2, 1.6),
                ] {
                    let camera = Camera::facing(azimuth, elevation, projection).unwrap();
                    let camera = camera.framed_within(&points, aspect, margins, 1.0);
                    let [left, right, top, bottom] = free(&camera, &points, aspect);
                    let over = [
                        [left - margins.left, right - margins.right],
                        [top - margins.top, bottom - margins.bottom],
                    ];
                    assert!(
                        over.as_flattened().iter().all(|o| *o > -1e-9),
                        "{azimuth} {over:?}"
                    );
                    let tight = |pair: &[f64; 2]| pair.iter().all(|o| *o < 1e-9);
                    assert!(over.iter().any(tight), "{azimuth} {over:?}");
                    if projection == Projection::Parallel {
                        assert!(over.iter().all(|[a, b]| (a - b).abs() < 1e-9), "{over:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_corners_of_the_box_would_waste_the_picture() {
        let points = diagonal();
        let corners: Vec<DVec3> = (0..8usize)
            .map(|c| {
                let pick = |axis: usize, [low, high]: [f64; 2]| [low, high][c >> axis & 1];
                DVec3::new(
                    pick(0, [-8.0, 30.0]),
                    pick(1, [0.0, 46.0]),
                    pick(2, [0.0, 3.0]),
                )
            })
            .collect();
        // Looking along the diagonal from above: the slab is narrow.
        let camera = Camera::facing(2.5, 0.6, Projection::Perspective).unwrap();
        let extent = |camera: &Camera| {
            let [left, right, ..] = free(camera, &points, 2.0);
            1.0 - left - right
        };
        let tight = extent(&camera.framed(&points, 2.0));
        let loose = extent(&camera.framed(&corners, 2.0));
        assert!(tight > 0.9 && loose < 0.85 * tight, "{tight} {loose}");
    }

    #[test]
    fn zooming_keeps_the_middle_between_the_margins() {
        let points = diagonal();
        for projection in [Projection::Perspective, Projection::Parallel] {
            let facing = Camera::facing(0.3, 0.6, projection).unwrap();
            let [near, far] = [4.0, 1.0].map(|z| facing.framed_within(&points, 1.5, UNEVEN, z));
            let at = glam::DVec2::new(0.5 * (0.1 + 0.98), 0.5 * (0.05 + 0.8));
            let (origin, direction) = far.ray(at, 1.5);
            let depth = far.depth(points.iter().sum::<DVec3>() / 8.0);
            let point = origin + depth / direction.dot(far.forward) * direction;
            let seen = near.project(point, 1.5).unwrap();
            assert!(seen.distance(at) < 0.05, "{seen}");
            let [a, b] = [points[0], points[7]];
            let size = |camera: &Camera| {
                let [a, b] = [a, b].map(|p| camera.project(p, 1.5).unwrap());
                a.distance(b)
            };
            assert!(size(&near) > 3.0 * size(&far));
        }
    }

    #[test]
    fn points_without_extent_are_framed_without_losing_the_eye() {
        for projection in [Projection::Perspective, Projection::Parallel] {
            let camera = Camera::facing(1.0, 0.5, projection).unwrap();
            for points in [vec![DVec3::ONE], vec![DVec3::ONE; 3], Vec::new()] {
                let framed = camera.framed(&points, 1.3);
                assert!(framed.eye.is_finite());
                assert!(points.iter().all(|p| framed.depth(*p) > 0.0));
            }
        }
    }
}
