//! Lines along the edges of cells, as wide at any distance (`Surfaces` in view/surfaces.rs says how).
//! The twin of `shaders/shared/edges.wgsl`.

use glam::Vec3A;

use crate::view::surfaces::{EDGE_DARKNESS, EDGE_FADE, EDGE_WIDTH};

/// A color with the lines in its pixel. `uvw` are parameters in the cell, `right` and `down` their change from a pixel
/// to the next ones; a parameter that is constant must be 1/2.
pub fn with_edges(color: Vec3A, uvw: Vec3A, [right, down]: [Vec3A; 2]) -> Vec3A {
    let change = (right * right + down * down).map(f32::sqrt);
    let pixels_across = 1.0 / change.max(Vec3A::splat(1e-9));
    let away = uvw.min(Vec3A::ONE - uvw) * pixels_across;
    let covered = Vec3A::splat(0.5 * EDGE_WIDTH as f32 + 0.5) - away;
    let covered = covered.clamp(Vec3A::ZERO, Vec3A::ONE);
    let lines = covered * pixels_across.map(fade);
    color * (1.0 - EDGE_DARKNESS as f32 * lines.max_element())
}

fn fade(pixels_across: f32) -> f32 {
    smoothstep(EDGE_FADE.map(|v| v as f32), pixels_across)
}

/// From 0 to 1 over a range, smooth at both ends.
pub fn smoothstep([low, high]: [f32; 2], value: f32) -> f32 {
    let part = ((value - low) / (high - low)).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}
