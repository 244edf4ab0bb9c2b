//! Where rays meet the tubes of wells (`Wells` in view/wells.rs says what they are). They are few and thin: found once
//! for all executors, pixel by pixel, in f64; these shade the points and blend them among their layers.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::view::View;
use crate::view::surfaces::{HEADLIGHT_AMBIENT, HEADLIGHT_ASIDE};
use crate::view::wells::Capsule;

/// The nearest point of a tube on a pixel's ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TubePoint {
    /// Distance along the ray.
    pub distance: f32,
    /// Its color as it is blended, in the light of the lamp beside the viewer.
    pub color: [f32; 3],
    /// Number of its well.
    pub well: u32,
}

/// The points of all pixels.
#[derive(Debug, Clone)]
pub struct TubePoints {
    /// Width and height in pixels.
    pub size: [u32; 2],
    points: Vec<Option<TubePoint>>,
}

impl TubePoints {
    /// Those of a view; `None` where it shows no wells.
    pub fn of(view: &View) -> Option<Self> {
        if !view.style.surfaces.wells {
            return None;
        }
        let [width, height] = view.size;
        let mut points: Vec<Option<TubePoint>> = vec![None; width as usize * height as usize];
        let tubes: Vec<Tube<'_>> = view
            .shown
            .wells
            .capsules
            .iter()
            .map(|c| Tube::new(c, view))
            .collect();
        let size = DVec2::from(view.size.map(f64::from));
        let rows = points.par_chunks_mut(width.max(1) as usize).zip(0..height);
        rows.for_each(|(row, y)| {
            for tube in tubes.iter().filter(|t| t.low[1] <= y && y <= t.high[1]) {
                let pixels = row.iter_mut().zip(0..width);
                let pixels = pixels.skip(tube.low[0] as usize);
                for (point, x) in pixels.take_while(|(_, x)| *x <= tube.high[0]) {
                    let pixel = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
                    let found = tube.point(view, pixel / size);
                    *point = match (*point, found) {
                        (Some(known), Some(found)) if known.distance <= found.distance => {
                            Some(known)
                        }
                        (known, found) => found.or(known),
                    };
                }
            }
        });
        Some(Self {
            size: view.size,
            points,
        })
    }

    /// The point of a pixel.
    pub fn at(&self, [x, y]: [u32; 2]) -> Option<TubePoint> {
        let at = y as usize * self.size[0] as usize + x as usize;
        self.points.get(at).copied().flatten()
    }
}

/// The nearest point of a tube on the ray through a place in the image, 0 to 1, right and down; `None` where there is
/// none.
pub fn tube_at(view: &View, at: DVec2) -> Option<TubePoint> {
    let shown = view.style.surfaces.wells.then_some(&view.shown.wells)?;
    let capsules = shown.capsules.iter();
    let points = capsules.filter_map(|capsule| Tube::new(capsule, view).point(view, at));
    points.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// A capsule, its color as it is blended, and the pixels that it may be seen in.
struct Tube<'a> {
    capsule: &'a Capsule,
    color: DVec3,
    low: [u32; 2],
    high: [u32; 2],
}

impl<'a> Tube<'a> {
    fn new(capsule: &'a Capsule, view: &View) -> Self {
        let [low, high] = pixels(capsule, view);
        Self {
            capsule,
            color: view.style.blending.of_srgb(capsule.color).into(),
            low,
            high,
        }
    }

    /// The point on the ray through a place in the image, 0 to 1, right and down.
    fn point(&self, view: &View, at: DVec2) -> Option<TubePoint> {
        let (origin, direction) = view.camera.ray(at, view.aspect());
        let is_kept = |distance: f64| {
            let p = origin + distance * direction;
            let mut planes = view.shown.clip.iter();
            distance > 0.0 && planes.all(|plane| (p - plane.point).dot(plane.normal) >= 0.0)
        };
        let ends = passage(self.capsule, origin, direction)?;
        let distance = ends.into_iter().find(|d| is_kept(*d))?;
        let place = origin + distance * direction;
        let lamp = lamp(view, self.normal(place), direction);
        Some(TubePoint {
            distance: distance as f32,
            color: (lamp * self.color).as_vec3().to_array(),
            well: self.capsule.well as u32,
        })
    }

    /// Normal at a point of the tube.
    fn normal(&self, place: DVec3) -> DVec3 {
        let [a, b] = self.capsule.ends;
        let axis = b - a;
        let along = ((place - a).dot(axis) / axis.length_squared().max(1e-300)).clamp(0.0, 1.0);
        (place - a - along * axis) / self.capsule.radius
    }
}

/// What the lamp beside the viewer leaves of the color of a tube: as of the hull.
fn lamp(view: &View, normal: DVec3, direction: DVec3) -> f64 {
    if view.style.lighting.exact_colors {
        return 1.0;
    }
    let camera = &view.camera;
    let aside = HEADLIGHT_ASIDE[0] * camera.right + HEADLIGHT_ASIDE[1] * camera.up;
    let outward = if normal.dot(direction) > 0.0 {
        -normal
    } else {
        normal
    };
    let lit = outward.dot(aside - direction) / (1.0 + aside.length_squared()).sqrt();
    HEADLIGHT_AMBIENT + (1.0 - HEADLIGHT_AMBIENT) * lit.clamp(0.0, 1.0)
}

/// Where a ray comes into a capsule and leaves it: the first and the last point of it in the two spheres and between
/// their middles in the cylinder, for a capsule is convex.
fn passage(capsule: &Capsule, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let [a, b] = capsule.ends;
    let radius = capsule.radius;
    let axis = b - a;
    let mut span = [f64::INFINITY, f64::NEG_INFINITY];
    let mut add = |distance: f64| span = [span[0].min(distance), span[1].max(distance)];
    for center in [a, b] {
        let to = center - origin;
        let along = to.dot(direction);
        let half = radius * radius - (to - along * direction).length_squared();
        if half >= 0.0 {
            add(along - half.sqrt());
            add(along + half.sqrt());
        }
    }
    let length = axis.length();
    if length > 0.0 {
        let unit = axis / length;
        // Across the axis the ray goes through a circle.
        let across = |v: DVec3| v - v.dot(unit) * unit;
        let (from, step) = (across(origin - a), across(direction));
        let rate = step.length_squared();
        let nearest = -from.dot(step) / rate.max(1e-300);
        let half = (radius * radius - (from + nearest * step).length_squared()) / rate.max(1e-300);
        if half >= 0.0 {
            for distance in [nearest - half.sqrt(), nearest + half.sqrt()] {
                let height = (origin + distance * direction - a).dot(unit);
                if (0.0..=length).contains(&height) {
                    add(distance);
                }
            }
        }
    }
    (span[0] <= span[1]).then_some(span)
}

/// First and last pixel of the rectangle in which a capsule may be seen; all of them where it reaches behind the viewer.
fn pixels(capsule: &Capsule, view: &View) -> [[u32; 2]; 2] {
    let last = view.size.map(|n| n.saturating_sub(1));
    let size = DVec2::from(view.size.map(f64::from));
    let camera = &view.camera;
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for end in capsule.ends {
        let near = camera.depth(end) - capsule.radius;
        for sides in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
            let [right, up] = sides.map(|side| side * capsule.radius);
            // As wide as it would be at its nearest depth.
            let corner =
                end + right * camera.right + up * camera.up - capsule.radius * camera.forward;
            let far = end + right * camera.right + up * camera.up + capsule.radius * camera.forward;
            for corner in [corner, far] {
                match camera.project(corner, view.aspect()).filter(|_| near > 0.0) {
                    Some(at) => (low, high) = (low.min(at * size), high.max(at * size)),
                    None => return [[0; 2], last],
                }
            }
        }
    }
    let within = |at: glam::DVec2| [0, 1].map(|n| (at[n].max(0.0) as u32).min(last[n]));
    [within(low - 1.0), within(high + 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capsule() -> Capsule {
        Capsule {
            ends: [DVec3::ZERO, DVec3::new(3.0, 4.0, 12.0)],
            radius: 0.7,
            color: [1.0; 3],
            well: 0,
        }
    }

    /// Distance of a point from the line between the ends.
    fn away(p: DVec3, [a, b]: [DVec3; 2]) -> f64 {
        // Halves of the line that have the nearest point.
        let (mut low, mut high) = (0.0, 1.0);
        let off = |part: f64| a.lerp(b, part).distance(p);
        for _ in 0..100 {
            let [left, right] = [1.0 / 3.0, 2.0 / 3.0].map(|part| low + part * (high - low));
            if off(left) < off(right) {
                high = right;
            } else {
                low = left;
            }
        }
        off(low)
    }

    #[test]
    fn rays_come_in_and_leave_where_the_line_is_as_far_as_the_radius() {
        let capsule = capsule();
        let mut random = fastrand::Rng::with_seed(5);
        let mut met = 0;
        for _ in 0..300 {
            let mut vector = |scale: f64| {
                let mut next = || scale * (2.0 * random.f64() - 1.0);
                DVec3::new(next(), next(), next())
            };
            let origin = vector(30.0);
            let direction = (DVec3::new(1.5, 2.0, 6.0) + vector(7.0) - origin).normalize();
            match passage(&capsule, origin, direction) {
                Some(span) => {
                    met += 1;
                    for distance in span {
                        let off =
                            away(origin + distance * direction, capsule.ends) - capsule.radius;
                        assert!(off.abs() < 1e-5, "{off}");
                    }
                    let middle = origin + 0.5 * (span[0] + span[1]) * direction;
                    assert!(away(middle, capsule.ends) < capsule.radius + 1e-5);
                }
                None => {
                    let nearest = (0..1_000).map(|n| origin + 0.06 * f64::from(n) * direction);
                    let least = nearest
                        .map(|p| away(p, capsule.ends))
                        .fold(f64::MAX, f64::min);
                    assert!(least > capsule.radius - 1e-3, "{least}");
                }
            }
        }
        assert!(met > 30, "{met}");
    }

    #[test]
    fn a_ray_along_the_axis_goes_from_end_to_end() {
        let capsule = capsule();
        let direction = capsule.ends[1].normalize();
        let span = passage(&capsule, -5.0 * direction, direction).unwrap();
        assert!(
            (span[0] - 4.3).abs() < 1e-9 && (span[1] - 18.7).abs() < 1e-9,
            "{span:?}"
        );
        // The twin: beside it there is nothing.
        let aside = direction.any_orthonormal_vector();
        assert_eq!(passage(&capsule, aside - 5.0 * direction, direction), None);
    }
}
