//! How much light comes along a cone, by many rays over it (campagnolo-2021, 3.1.1).

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Integrator, Ray};
use crate::view::Lighting;
use crate::view::lighting::Cone;

/// Transmittance at which a ray over a cone ends.
const OPAQUE: f64 = 1e-3;

/// Turn from one ray to the next around the axis: the golden section of a circle spreads any number of
/// them evenly.
const TURN: f64 = 0.618_033_988_749_895;

impl Integrator<'_> {
    /// Transmittance of a cone from `apex` around the unit vector `axis`: the mean over its directions,
    /// weighted by their cosines to the axis (equation 3-6), or alike where the cone is all of the sphere.
    ///
    /// The rays are [`Lighting::rays`], uniform in solid angle, one at a random place in each of as many
    /// rings of equal solid angle. They start at [`Lighting::rays_gap`] and end at the cone's length or at `reach`,
    /// the distance to the light or the viewer, whichever is nearer; both in world space. Gap, attenuation, splits
    /// and the correction for even media belong to the approximation and count for nothing here.
    pub fn transmittance(
        &self,
        apex: DVec3,
        axis: DVec3,
        cone: &Cone,
        reach: f64,
        random: &mut fastrand::Rng,
    ) -> f64 {
        let lighting = &self.view.style.lighting;
        let sigma = lighting.sigma();
        let step = Lighting::REFERENCE_STEP * sigma;
        let is_around = cone.is_around();
        let reach = if is_around { f64::INFINITY } else { reach };
        let range = [lighting.rays_gap * sigma, cone.length.min(reach)];
        let (right, up) = axis.any_orthonormal_pair();
        let open = 1.0 - cone.half_angle.cos();
        let start = random.f64();
        let (mut sum, mut weights) = (0.0, 0.0);
        for n in (0..lighting.rays).map(f64::from) {
            let cosine = 1.0 - open * (n + random.f64()) / f64::from(lighting.rays);
            let (y, x) = (TAU * (start + TURN * n)).sin_cos();
            let across = (1.0 - cosine * cosine).sqrt() * (x * right + y * up);
            let ray = Ray {
                origin: apex,
                direction: cosine * axis + across,
            };
            let weight = if is_around { 1.0 } else { cosine };
            let passed = match self.view.style.lighting.geometry {
                true => self.past_surfaces(ray, range),
                false => 1.0,
            };
            if passed > 0.0 {
                let depth = self.optical_depth(ray, range, step, random.f64());
                sum += weight * passed * (-depth).exp();
            }
            weights += weight;
        }
        match is_around {
            // Light comes to a point of an even surface from half of all directions.
            true => (2.0 * sum / weights).min(1.0),
            false => sum / weights,
        }
    }

    /// Part of the light that wells and sheets of faults leave within a range of a ray, in the model's box.
    fn past_surfaces(&self, ray: Ray, [start, end]: [f64; 2]) -> f64 {
        let Some([enter, leave]) = ray.within(self.view.world.bounds) else {
            return 1.0;
        };
        let range = [start.max(enter), end.min(leave)];
        match self.meets_tube(ray, range) {
            true => 0.0,
            false => self.past_sheets(ray, range),
        }
    }

    /// Extinction along a range of a ray, as far as it matters, by samples in steps of at most `most`.
    ///
    /// It is the trapezoid rule (equation 3-7) moved by `shift`, a part of a step. What that leaves at
    /// both ends is one step in all and is given to the outermost samples, so that the mean over all
    /// shifts is exact: thin layers are missed as often as they should be.
    fn optical_depth(&self, ray: Ray, [start, end]: [f64; 2], most: f64, shift: f64) -> f64 {
        let Some([enter, leave]) = ray.within(self.view.world.bounds) else {
            return 0.0;
        };
        let (start, end) = (start.max(enter), end.min(leave));
        if start >= end {
            return 0.0;
        }
        let steps = ((end - start) / most).ceil();
        let step = (end - start) / steps;
        let (mut depth, mut number) = (0.0, 0.0);
        while number < steps && depth <= -OPAQUE.ln() {
            let at = start + (number + shift) * step;
            let sample = self.absorbing(ray.origin + at * ray.direction);
            depth += step * sample.map_or(0.0, |(_, extinction)| extinction);
            number += 1.0;
        }
        depth
    }
}
