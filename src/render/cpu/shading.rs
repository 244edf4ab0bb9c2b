//! What light makes of a sample's color (`Lighting` in view/lighting.rs says how).
//! The twin of `shaders/shared/shading.wgsl`.

use glam::{Vec3A, Vec4};

use super::along::{LightAlong, SPACING, Shade};
use super::frame::{Frame, Ray};
use super::lamps::smoothstep;
use super::light::Light;
use crate::render::plan::layout::{LIGHT_OFF, LIGHT_RAYS};
use crate::view::lighting::{GRADIENT_FADE, Lighting, SHININESS, SPECULAR};
use crate::view::surfaces::HEADLIGHT_AMBIENT;

/// How samples are shaded.
pub struct Shading<'a> {
    /// Only inactive cells are shaded.
    exact_colors: bool,
    /// `None` where nothing is shaded.
    light: Option<Light<'a>>,
    /// Distance along a ray between places where its light is found; 0 where each sample has its own.
    spacing: f32,
}

impl<'a> Shading<'a> {
    /// That of a view, whose light is there where something is shaded.
    /// Rays over cones are random at each sample, so that their means need all of them.
    pub fn new(lighting: &Lighting, light: Option<Light<'a>>) -> Self {
        let is_random = |light: &Light<'_>| {
            [light.shading.occlusion, light.shading.shadows].contains(&LIGHT_RAYS)
        };
        let spacing = match &light {
            Some(light) if !is_random(light) => (SPACING * lighting.sigma()) as f32,
            _ => 0.0,
        };
        Self {
            exact_colors: lighting.exact_colors,
            light,
            spacing,
        }
    }

    /// True where the color of a sample depends on where it is.
    #[inline]
    pub fn varies(&self, is_ghost: bool) -> bool {
        let by_place =
            |light: &Light<'_>| light.shading.lights || light.shading.occlusion != LIGHT_OFF;
        self.light.as_ref().is_some_and(by_place) && (is_ghost || !self.exact_colors)
    }

    /// Color of a sample at a point of grid space relative to the origin.
    #[inline]
    pub fn shade(&self, color: Vec3A, point: Vec3A, is_ghost: bool) -> Vec3A {
        self.find(point, is_ghost).of(color)
    }

    /// What light makes of colors at a point of grid space relative to the origin.
    #[inline]
    pub fn find(&self, point: Vec3A, is_ghost: bool) -> Shade {
        match &self.light {
            Some(light) if is_ghost || !self.exact_colors => found(light, point, is_ghost),
            _ => Shade::NONE,
        }
    }

    /// Color at a distance along a ray of a sample that stands for so much of it.
    #[inline]
    pub fn shade_along(
        &self,
        color: Vec3A,
        along: &mut LightAlong,
        ray: &Ray,
        [distance, length]: [f32; 2],
        is_ghost: bool,
    ) -> Vec3A {
        match &self.light {
            None => color,
            // Inactive cells have light of their own, and long pieces need no more of it than one place has.
            Some(_) if is_ghost || length >= self.spacing => {
                self.shade(color, ray.at(distance), is_ghost)
            }
            Some(_) if self.exact_colors => color,
            Some(_) => {
                let find = |distance| self.find(ray.at(distance), false);
                along.at(self.spacing, distance, find).of(color)
            }
        }
    }

    /// Color and extinction of a sample, its color shaded where it is seen.
    #[inline]
    pub fn shade_entry(&self, entry: Vec4, point: Vec3A, is_ghost: bool) -> Vec4 {
        match entry.w > 0.0 {
            true => self
                .shade(Vec3A::from_vec4(entry), point, is_ghost)
                .extend(entry.w),
            false => entry,
        }
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

fn found(light: &Light<'_>, point: Vec3A, is_ghost: bool) -> Shade {
    let (info, modes) = (&light.info, light.shading);
    let p = light.place(point);
    let [viewer, lamps @ ..] = light.lamps else {
        return Shade::NONE;
    };
    let mut sum = Vec3A::splat(info.ambient);
    if modes.occlusion != LIGHT_OFF {
        let occluded = 1.0 - light.toward_viewer(viewer, p);
        sum *= 1.0 - info.strength * occluded;
    }
    let mut highlight = Vec3A::ZERO;
    let (normal, counts) = match is_ghost {
        true => (Vec3A::ZERO, 0.0),
        false => surface_at(light, p),
    };
    for lamp in lamps {
        let (way, _) = lamp.toward(p);
        let mut arriving = lamp.arriving(way);
        if modes.shadows != LIGHT_OFF {
            arriving *= light.toward_light(lamp, p);
        }
        if counts == 0.0 {
            sum += arriving;
            continue;
        }
        let half_way = (way + viewer.toward(p).0 + Vec3A::splat(1e-6)).normalize();
        sum += (1.0 - counts + counts * normal.dot(way).abs()) * arriving;
        let shine = normal.dot(half_way).abs().powf(SHININESS as f32);
        highlight += SPECULAR as f32 * counts * shine * arriving;
    }
    Shade {
        factor: sum,
        highlight,
    }
}

/// Unit gradient of the field, and how much it counts.
fn surface_at(light: &Light<'_>, p: Vec3A) -> (Vec3A, f32) {
    let Some(gradients) = light.gradients else {
        return (Vec3A::ZERO, 0.0);
    };
    let sampled = gradients.sample(p / Vec3A::from(light.info.size));
    let gradient = Vec3A::from_vec4(sampled) / sampled.w.max(1e-3);
    let size = gradient.length();
    let fade = GRADIENT_FADE.map(|v| v as f32);
    let counts = smoothstep(fade, size * light.info.gradient_scale);
    (gradient / size.max(1e-9), counts)
}

/// Cosine between a surface's normal of any length and sense and a ray: both of grid space.
pub fn turned_to_ray(frame: &Frame, normal: Vec3A, direction: Vec3A) -> f32 {
    (normal.dot(direction).abs() / world_length(frame, normal)).min(1.0)
}

/// Length of a normal in world space.
fn world_length(frame: &Frame, normal: Vec3A) -> f32 {
    (frame.to_grid.transpose() * normal).length().max(1e-30)
}
