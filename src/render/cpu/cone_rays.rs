//! Transmittance of a cone by many rays through the volume of opacities: slow, for comparison (campagnolo-2021, 3.1.1).
//! The twin of `shaders/shared/cone_rays.wgsl`.

use std::f32::consts::TAU;

use glam::Vec3A;

use super::around::openness;
use super::extinction::depth_of;
use super::lamps::{Lamp, across};
use super::random::{pcg, unit};
use super::transfer::passed;
use super::volume::Voxels;

/// Angle between the directions of rings that follow each other.
const GOLDEN_ANGLE: f32 = 2.399_963_2;
/// Optical depth behind which nothing more is seen to change.
const DARK: f32 = 8.0;

/// A volume of opacities that rays are cast through, over a box of `size` in lighting space.
#[derive(Clone, Copy)]
pub struct ConeRays<'a> {
    /// Opacities of a unit of length that nothing has blurred.
    pub opacities: &'a Voxels<f32>,
    /// Of the box.
    pub size: Vec3A,
    /// Rays over a cone.
    pub rays: u32,
    /// Picks their random numbers.
    pub seed: u32,
    /// Distance of their samples.
    pub step: f32,
    /// Distance at which they start.
    pub gap: f32,
}

impl ConeRays<'_> {
    /// Mean of the transmittances of rays over a cone, weighted by the cosine of their angle to the axis, or alike where
    /// the cone is all of the sphere. Their
    /// directions are uniform in solid angle, one in each of as many rings; samples of a ray begin at a random part of
    /// a step.
    pub fn transmittance(&self, lamp: &Lamp, p: Vec3A) -> f32 {
        let (axis, reach) = lamp.toward(p);
        let side = across(axis);
        let is_around = lamp.emitter.is_around();
        let reach = if is_around { f32::MAX } else { reach };
        let range = [self.gap, lamp.emitter.length.min(reach)];
        let [x, y, z] = p.to_array().map(f32::to_bits);
        let seed = pcg(x ^ pcg(y ^ pcg(z ^ pcg(self.seed))));
        let first_turn = TAU * unit3(seed)[1];
        let (mut sum, mut weights) = (0.0, 0.0);
        for n in 0..self.rays {
            let chance = unit3(seed.wrapping_add(n));
            let ring = (n as f32 + chance[0]) / self.rays as f32;
            let cosine = 1.0 + ring * (lamp.emitter.cosine - 1.0);
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            // Golden angles spread the rings' directions; one random turn for all of them.
            let (up, aside) = (GOLDEN_ANGLE * n as f32 + first_turn).sin_cos();
            let direction = cosine * axis + sine * (aside * side[0] + up * side[1]);
            let weight = if is_around { 1.0 } else { cosine };
            sum += weight * passed(self.depth(p, direction, range, chance[2]));
            weights += weight;
        }
        match is_around {
            true => openness(sum / weights),
            false => sum / weights,
        }
    }

    /// Optical depth of a ray within a range of distances, up to where it leaves the box.
    fn depth(&self, p: Vec3A, direction: Vec3A, range: [f32; 2], offset: f32) -> f32 {
        let tiny = Vec3A::splat(1e-9);
        let safe = Vec3A::select(direction.abs().cmplt(tiny), tiny, direction);
        let (a, b) = (-p / safe, (self.size - p) / safe);
        let end = range[1].min(a.max(b).min_element());
        let begin = range[0].max(a.min(b).max_element());
        let mut depth = 0.0;
        let mut t = begin + offset * self.step;
        while t < end && depth < DARK {
            let opacity = self.opacities.sample((p + t * direction) / self.size);
            depth += self.step * depth_of(opacity);
            t += self.step;
        }
        depth
    }
}

fn unit3(seed: u32) -> [f32; 3] {
    let a = pcg(seed);
    let b = pcg(a);
    [a, b, pcg(b)].map(unit)
}
