//! Capsules of wells as triangles.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use super::Space;
use super::buffer::{self, Mesh};
use crate::view::wells::Capsule;

/// Corners of a ring around a tube.
const SIDES: u32 = 12;
/// Rings of the half sphere at an end, of which the first is the pole.
const RINGS: u32 = 4;

/// Adds a capsule: rings from pole to pole, and two triangles between each two neighbors of a ring and the next.
pub(super) fn add(mesh: &mut Mesh, capsule: &Capsule, space: &Space) {
    let [from, to] = capsule.ends;
    let axis = (to - from).normalize_or(DVec3::Z);
    let (u, v) = axis.any_orthonormal_pair();
    let first = mesh.positions.len() as u32;
    let color = buffer::color(capsule.color);
    for ring in 0..2 * RINGS {
        // Both ends have the ring at their equator.
        let (end, latitude) = match ring < RINGS {
            true => (
                from,
                FRAC_PI_2 * (f64::from(ring) / f64::from(RINGS - 1) - 1.0),
            ),
            false => (
                to,
                FRAC_PI_2 * f64::from(ring - RINGS) / f64::from(RINGS - 1),
            ),
        };
        for side in 0..SIDES {
            let (sin, cos) = (TAU * f64::from(side) / f64::from(SIDES)).sin_cos();
            let normal = latitude.cos() * (cos * u + sin * v) + latitude.sin() * axis;
            mesh.positions
                .push(space.position(end + capsule.radius * normal));
            mesh.normals.push(space.normal(normal));
            mesh.colors.push(color);
        }
    }
    for ring in 0..2 * RINGS - 1 {
        for side in 0..SIDES {
            let [a, b] = [side, (side + 1) % SIDES].map(|s| first + SIDES * ring + s);
            let [c, d] = [a + SIDES, b + SIDES];
            mesh.indices.extend([a, b, d, a, d, c]);
        }
    }
}
