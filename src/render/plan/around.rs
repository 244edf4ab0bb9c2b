//! Occlusion from all sides, without a device: it does not depend on where the viewer is, so that it is made once for a
//! model and an opacity curve.
//!
//! By cones in even directions, or by filtered opacities (SPAO, kroes-2014): the mean opacities of larger and larger
//! cubes around a point give those of the shells between them, and light passes one shell after the other.

use glam::Vec3;

use crate::scene::lighting::LightMethod;
use crate::view::Lighting;
use crate::view::lighting::Occlusion;

/// Shells at most: no axis has more voxels than the largest one is wide.
const MOST_SHELLS: u32 = 11;

/// Cones that together look to all sides.
pub const DIRECTIONS: u32 = 12;

/// Turn from one direction to the next around the vertical: the golden angle.
const TURN: f64 = 2.399_963_229_728_653;

/// Half of the opening of each of the cones, in radians: they have the solid angle of the sphere between them.
pub fn half_angle() -> f64 {
    (1.0 - 2.0 / f64::from(DIRECTIONS)).acos()
}

/// The directions of the cones, unit vectors on a spiral from pole to pole.
pub fn directions() -> [Vec3; DIRECTIONS as usize] {
    std::array::from_fn(|n| {
        let z = 1.0 - (2.0 * n as f64 + 1.0) / f64::from(DIRECTIONS);
        let across = (1.0 - z * z).sqrt();
        let (sine, cosine) = (TURN * n as f64).sin_cos();
        glam::DVec3::new(across * cosine, across * sine, z).as_vec3()
    })
}

/// How many shells there are around a point, the largest one no wider than cones are long.
///
/// Shell l, from 1, lies between cubes of 2^(l-1) and 2^l voxels.
pub fn shells(lighting: &Lighting) -> u32 {
    let spao = |o: &&Occlusion| o.method == LightMethod::SpaoMipmap;
    lighting.occlusion.as_ref().filter(spao).map_or(0, |o| {
        let voxels = 2.0 * o.cone.length / lighting.sigma();
        (voxels.max(2.0).log2().round() as u32).clamp(1, MOST_SHELLS)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_even() {
        let all = directions();
        let sum: Vec3 = all.iter().sum();
        assert!(sum.length() < 0.5, "{sum}");
        let nearest = |n: usize| {
            let others = (0..all.len()).filter(|m| *m != n);
            others.map(|m| all[n].dot(all[m])).fold(-1.0, f32::max)
        };
        for (n, direction) in all.iter().enumerate() {
            assert!((direction.length() - 1.0).abs() < 1e-6);
            // Those of an icosahedron's vertices have a cosine of 0.447.
            assert!((0.4..0.65).contains(&nearest(n)), "{n} {}", nearest(n));
        }
        let open = 1.0 - half_angle().cos();
        assert!((f64::from(DIRECTIONS) * open - 2.0).abs() < 1e-12);
    }
}
