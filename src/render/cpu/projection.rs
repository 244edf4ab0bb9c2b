//! Corners as a ray sees them: it is the origin, so that edges are cross products.
//! The twin of `shaders/shared/projection.wgsl`.

use glam::{Mat3A, Vec3A};

use super::grid::Pillar;

/// A point on the ray, two directions across, and distances along.
#[derive(Clone, Copy)]
pub struct RayFrame {
    origin: Vec3A,
    /// Across the ray.
    pub across: [Vec3A; 2],
    /// From grid space to coordinates across the ray and distance along it.
    to_ray: Mat3A,
    t_origin: f32,
}

impl RayFrame {
    /// The frame at a point of a ray, which lies at distance `t`.
    pub fn at(origin: Vec3A, direction: Vec3A, t: f32) -> Self {
        let is_steep = direction.z.abs() > 0.7 * direction.length();
        let helper = if is_steep { Vec3A::X } else { Vec3A::Z };
        let across_x = helper.cross(direction).normalize();
        let across_y = direction.cross(across_x).normalize();
        let along = direction / direction.length_squared();
        Self {
            origin,
            across: [across_x, across_y],
            to_ray: Mat3A::from_cols(across_x, across_y, along).transpose(),
            t_origin: t,
        }
    }

    /// A corner relative to the frame's origin, in grid space.
    #[inline]
    pub fn relative(&self, pillar: &Pillar, depth: f32) -> Vec3A {
        let xy = (pillar.at - self.origin.truncate()) + (pillar.low_bits + pillar.slope * depth);
        xy.extend(depth - self.origin.z).into()
    }

    /// A corner: two coordinates across the ray and the distance along it.
    #[inline]
    pub fn project(&self, pillar: &Pillar, depth: f32) -> Vec3A {
        self.projected(self.relative(pillar, depth))
    }

    /// A point relative to the frame's origin: two coordinates across the ray and the distance along it.
    #[inline]
    pub fn projected(&self, relative: Vec3A) -> Vec3A {
        self.turned(relative) + self.t_origin * Vec3A::Z
    }

    /// A displacement: two coordinates across the ray and the distance along it.
    #[inline]
    pub fn turned(&self, displacement: Vec3A) -> Vec3A {
        self.to_ray * displacement
    }
}

/// Twice the area that two vectors across the ray span.
#[inline]
pub fn cross2d(a: Vec3A, b: Vec3A) -> f32 {
    a.x * b.y - a.y * b.x
}
