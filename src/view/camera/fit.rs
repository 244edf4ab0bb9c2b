//! How near a camera comes to what it frames.

use glam::DVec3;

use crate::view::Camera;

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

/// Points, and what stays free around them.
#[derive(Debug, Clone, Copy)]
pub struct Framed<'a> {
    /// In world space.
    pub points: &'a [DVec3],
    /// Around them.
    pub margins: Margins,
}

impl Camera {
    /// The camera in this one's direction that has all points in its picture, as large as they can be.
    #[must_use]
    pub fn framed(self, points: &[DVec3], aspect: f64) -> Self {
        let margins = MARGINS;
        self.framed_within(&[Framed { points, margins }], aspect, 1.0)
    }

    /// The same with some points within some margins and others within others; a `zoom` above 1 comes closer to the
    /// middle of the picture. The plane of a parallel camera does not cut what is framed, however it is turned
    /// about its middle.
    #[must_use]
    pub fn framed_within(self, framed: &[Framed<'_>], aspect: f64, zoom: f64) -> Self {
        let points = || framed.iter().flat_map(|f| f.points);
        let Some(first) = points().next() else {
            return self;
        };
        let start = [*first, *first];
        let [low, high] = points().fold(start, |[a, b], p| [a.min(*p), b.max(*p)]);
        let center = 0.5 * (low + high);
        let tan = self.tan_half_fovy;
        let seen: Vec<Seen> = framed
            .iter()
            .filter(|f| !f.points.is_empty())
            .map(|f| {
                let points = f.points.iter().map(|p| {
                    let p = *p - center;
                    DVec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.forward))
                });
                let flat = self.parallel.is_some();
                Seen::of(points, Opening::of(tan, aspect, f.margins), flat)
            })
            .collect();
        let fit = match self.parallel {
            None => perspective(&seen),
            Some(_) => parallel(&seen, tan),
        };
        let to_world = |v: DVec3| v.x * self.right + v.y * self.up + v.z * self.forward;
        let camera = Self {
            eye: center + to_world(fit.eye),
            parallel: fit.half_height,
            ..self
        };
        camera.closer(camera.eye + fit.depth * self.forward, zoom)
    }
}

/// How far margins let the picture reach, per unit of depth of a perspective camera: left and right, below and
/// above.
#[derive(Clone, Copy)]
struct Opening {
    across: [f64; 2],
    upward: [f64; 2],
}

impl Opening {
    fn of(tan: f64, aspect: f64, margins: Margins) -> Self {
        let part = |margin: f64| tan * (1.0 - 2.0 * margin);
        Self {
            across: [margins.left, margins.right].map(|m| aspect * part(m)),
            upward: [margins.bottom, margins.top].map(part),
        }
    }
}

/// What a set of points asks of the eye, in the camera's axes: right, up and forward.
///
/// Each of the four sides of the picture is a plane through the eye that no point may be beyond: with the slope of a
/// side, the point that asks the most of it says all.
struct Seen {
    opening: Opening,
    across: Span,
    upward: Span,
    depths: Span,
    radius: f64,
}

impl Seen {
    /// Of points, seen in parallel where they are `flat`.
    fn of(points: impl Iterator<Item = DVec3>, opening: Opening, flat: bool) -> Self {
        let mut seen = Self {
            opening,
            across: Span::default(),
            upward: Span::default(),
            depths: Span::default(),
            radius: 0.0,
        };
        for p in points {
            let ends = |at: f64, [low, high]: [f64; 2]| match flat {
                true => [at; 2],
                false => [at + low * p.z, at - high * p.z],
            };
            seen.across.add(ends(p.x, opening.across));
            seen.upward.add(ends(p.y, opening.upward));
            seen.depths.add([p.z; 2]);
            seen.radius = seen.radius.max(p.length());
        }
        seen
    }
}

/// A camera in its own axes.
struct Fit {
    eye: DVec3,
    /// Of a parallel camera half the picture's height.
    half_height: Option<f64>,
    /// Of the middle of what is framed.
    depth: f64,
}

/// A direction in the picture: the ends that sets of points ask for, and the slopes of the two sides.
type Demands = Vec<(Span, [f64; 2])>;

fn asked(seen: &[Seen]) -> [Demands; 2] {
    [
        seen.iter().map(|s| (s.across, s.opening.across)).collect(),
        seen.iter().map(|s| (s.upward, s.opening.upward)).collect(),
    ]
}

/// The depth of all points.
fn depths(seen: &[Seen]) -> Span {
    let mut all = Span::default();
    for s in seen {
        all.add([s.depths.low, s.depths.high]);
    }
    all
}

/// The eye that is nearest: two opposite sides bound how far forward it may be, whichever set each belongs to.
fn perspective(seen: &[Seen]) -> Fit {
    let asked = asked(seen);
    let depths = depths(seen);
    // A single point could not be before the eye.
    let mut z = depths.low - 1e-9;
    for direction in &asked {
        for (low, slopes) in direction {
            for (high, others) in direction {
                z = z.min((low.low - high.high) / (slopes[0] + others[1]));
            }
        }
    }
    // In the middle of where it may be.
    let [x, y] = asked.map(|direction| {
        let mut between = Span {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        };
        for (span, slopes) in direction {
            between.low = between.low.max(span.high + slopes[1] * z);
            between.high = between.high.min(span.low - slopes[0] * z);
        }
        between.middle()
    });
    Fit {
        eye: DVec3::new(x, y, z),
        half_height: None,
        depth: depths.middle() - z,
    }
}

/// The lowest picture, by the depth at which a perspective one is as high.
fn parallel(seen: &[Seen], tan: f64) -> Fit {
    let asked = asked(seen);
    let mut reach: f64 = 1e-9;
    for direction in &asked {
        for (low, slopes) in direction {
            for (high, others) in direction {
                reach = reach.max((high.high - low.low) / (slopes[0] + others[1]));
            }
        }
    }
    let [x, y] = asked.map(|direction| {
        let mut between = Span {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        };
        for (span, slopes) in direction {
            between.low = between.low.max(span.high - slopes[1] * reach);
            between.high = between.high.min(span.low + slopes[0] * reach);
        }
        between.middle()
    });
    let radius = seen.iter().fold(0.0, |r: f64, s| r.max(s.radius));
    let depth = reach.max(1.01 * radius);
    Fit {
        eye: DVec3::new(x, y, -depth),
        half_height: Some(reach * tan),
        depth,
    }
}

/// The smallest of the first and the largest of the second of pairs of numbers.
#[derive(Clone, Copy)]
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

    fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use crate::scene::Projection;
    use crate::view::camera::*;

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
                    let points = &points[..];
                    let framed = Framed { points, margins };
                    let camera = camera.framed_within(&[framed], aspect, 1.0);
                    let [left, right, top, bottom] = free(&camera, points, aspect);
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
    fn each_of_two_sets_keeps_its_own_margins() {
        let points = diagonal();
        let around: Vec<DVec3> = points.iter().map(|p| 1.02 * *p).collect();
        let none = Margins {
            left: 0.0,
            right: 0.0,
            top: 0.0,
            bottom: 0.0,
        };
        for projection in [Projection::Perspective, Projection::Parallel] {
            for azimuth in [0.1, 1.3, 2.7, 4.4] {
                let camera = Camera::facing(azimuth, 0.4, projection).unwrap();
                let both = [(&points, UNEVEN), (&around, none)];
                let both = both.map(|(points, margins)| Framed { points, margins });
                let camera = camera.framed_within(&both, 1.4, 1.0);
                let over = both.map(|f| {
                    let [left, right, top, bottom] = free(&camera, f.points, 1.4);
                    let m = f.margins;
                    [
                        left - m.left,
                        right - m.right,
                        top - m.top,
                        bottom - m.bottom,
                    ]
                });
                let all = over.as_flattened();
                assert!(all.iter().all(|o| *o > -1e-9), "{azimuth} {over:?}");
                // Nothing could be larger: opposite sides are reached.
                let reached = |a: usize, b: usize| {
                    let touches = |n: usize| over.iter().any(|o| o[n] < 1e-9);
                    touches(a) && touches(b)
                };
                assert!(reached(0, 1) || reached(2, 3), "{azimuth} {over:?}");
            }
        }
    }

    #[test]
    fn zooming_keeps_the_middle_of_the_picture() {
        let points = diagonal();
        for projection in [Projection::Perspective, Projection::Parallel] {
            let facing = Camera::facing(0.3, 0.6, projection).unwrap();
            let framed = Framed {
                points: &points,
                margins: UNEVEN,
            };
            let [near, far] = [1.5, 1.0].map(|z| facing.framed_within(&[framed], 1.5, z));
            let (origin, direction) = far.ray(glam::DVec2::splat(0.5), 1.5);
            let (other, other_direction) = near.ray(glam::DVec2::splat(0.5), 1.5);
            assert!(direction.distance(other_direction) < 1e-9);
            assert!((other - origin).cross(direction).length() < 1e-9);
            let [a, b] = [points[0], points[7]];
            let size = |camera: &Camera| {
                let [a, b] = [a, b].map(|p| camera.project(p, 1.5).unwrap());
                a.distance(b)
            };
            assert!(size(&near) > 1.4 * size(&far));
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
