//! What light makes of a sample's color (`Lighting` in view/lighting.rs says how).
//! The twin of `shaders/shared/shading.wgsl`, as far as light comes from everywhere.

use glam::{Vec3A, Vec4};

use super::frame::Frame;
use crate::view::lighting::Lighting;
use crate::view::surfaces::HEADLIGHT_AMBIENT;

/// How samples are shaded.
pub struct Shading {
    ambient: f32,
    /// Only inactive cells are shaded.
    exact_colors: bool,
}

impl Shading {
    /// That of a view.
    pub fn of(lighting: &Lighting) -> Self {
        let is_on = lighting.exact_colors || lighting.blinn_phong;
        Self {
            ambient: if is_on { lighting.ambient as f32 } else { 1.0 },
            exact_colors: lighting.exact_colors,
        }
    }

    /// Color of a sample.
    pub fn shade(&self, color: Vec3A, is_ghost: bool) -> Vec3A {
        match self.exact_colors && !is_ghost {
            true => color,
            false => self.ambient * color,
        }
    }

    /// Color and extinction of a sample, its color shaded.
    pub fn shade_entry(&self, entry: Vec4, is_ghost: bool) -> Vec4 {
        self.shade(Vec3A::from_vec4(entry), is_ghost)
            .extend(entry.w)
    }

    /// What the lamp beside the viewer leaves of the color of a surface (`Surfaces` in view/surfaces.rs says how), by
    /// its normal of any length and sense, and the ray's direction: grid space.
    pub fn headlight(&self, frame: &Frame, normal: Vec3A, direction: Vec3A) -> f32 {
        if self.exact_colors {
            return 1.0;
        }
        let numbers = &frame.numbers;
        // Products of normals and displacements are those of world space.
        let toward_viewer = -normal.dot(direction);
        let sense = if toward_viewer >= 0.0 { 1.0 } else { -1.0 };
        let aside = normal.dot(numbers.headlight.into());
        let lit = sense * (toward_viewer + aside) * numbers.headlight_scale;
        let ambient = HEADLIGHT_AMBIENT as f32;
        ambient + (1.0 - ambient) * (lit / world_length(frame, normal)).clamp(0.0, 1.0)
    }
}

/// Cosine between a surface's normal of any length and sense and a ray: both of grid space.
pub fn turned_to_ray(frame: &Frame, normal: Vec3A, direction: Vec3A) -> f32 {
    (normal.dot(direction).abs() / world_length(frame, normal)).min(1.0)
}

/// Length of a normal in world space.
fn world_length(frame: &Frame, normal: Vec3A) -> f32 {
    (frame.to_grid.transpose() * normal).length().max(1e-30)
}
