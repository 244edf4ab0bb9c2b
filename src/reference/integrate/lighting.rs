//! The color of a sample in a view's light, as [`crate::view::Lighting`] defines it.

use glam::DVec3;

use super::{Integrator, Sample};
use crate::model::Hexahedron;
use crate::reference::locate::Located;
use crate::scene::LightMode;
use crate::view::lighting::{GRADIENT_FADE, Light, LightSource, SHININESS, SPECULAR, SPOT_EDGE};
use crate::view::surfaces::{HEADLIGHT_AMBIENT, HEADLIGHT_ASIDE};

/// What a light is from a point.
struct Incident {
    /// Unit vector to it.
    direction: DVec3,
    /// Distance to it.
    reach: f64,
    /// Part of its light that goes to the point.
    part: f64,
}

/// The field's surface at a point.
struct Surface {
    /// Unit gradient, or null where there is none.
    normal: DVec3,
    /// How much there is a surface at all, 0 to 1.
    weight: f64,
}

impl Integrator<'_> {
    /// Color of a sample of a primary ray; what it is by itself where nothing shades it.
    pub(in crate::reference) fn lit(&self, point: DVec3, sample: &Sample) -> [f64; 3] {
        let valued = sample.value.map(|_| sample);
        self.shaded(point, self.unlit(sample), valued)
    }

    /// A color at a point of a primary ray as light makes it. `valued` is the sample there, of what
    /// carries a number.
    pub(in crate::reference) fn shaded(
        &self,
        point: DVec3,
        color: [f64; 3],
        valued: Option<&Sample>,
    ) -> [f64; 3] {
        let lighting = &self.view.style.lighting;
        if lighting.is_off() || (lighting.exact_colors && valued.is_some()) {
            return color;
        }
        let mut random = random(lighting.seed, point);
        let surface = self.surface(valued);
        let (viewer, _) = self.viewer(point);
        let mut diffuse = DVec3::splat(lighting.ambient * self.occlusion(point, &mut random));
        let mut specular = DVec3::ZERO;
        for light in &lighting.lights {
            let incident = Incident::new(light.source, point);
            let arriving = light.blended(self.view.style.blending)
                * self.arriving(light, &incident, point, &mut random);
            diffuse += arriving * surface.diffuse(incident.direction);
            specular += arriving * surface.specular(incident.direction, viewer);
        }
        (DVec3::from_array(color) * diffuse + specular).to_array()
    }

    /// What the lamp beside the viewer leaves of the color of a surface, by its unit normal of either sense.
    pub(in crate::reference) fn headlight(&self, normal: DVec3, ray: DVec3) -> f64 {
        if self.view.style.lighting.exact_colors {
            return 1.0;
        }
        let camera = &self.view.camera;
        let [right, up] = HEADLIGHT_ASIDE;
        let aside = right * camera.right + up * camera.up;
        let outward = if normal.dot(ray) > 0.0 {
            -normal
        } else {
            normal
        };
        let lit = outward.dot(aside - ray) / (1.0 + aside.length_squared()).sqrt();
        HEADLIGHT_AMBIENT + (1.0 - HEADLIGHT_AMBIENT) * lit.clamp(0.0, 1.0)
    }

    /// Unit vector from a point to the viewer, and the distance to where rays begin.
    fn viewer(&self, point: DVec3) -> (DVec3, f64) {
        let camera = &self.view.camera;
        let from_eye = point - camera.eye;
        match camera.parallel {
            None => (-from_eye).normalize_and_length(),
            Some(_) => (-camera.forward, from_eye.dot(camera.forward)),
        }
    }

    /// Part of the ambient light that occlusion leaves.
    fn occlusion(&self, point: DVec3, random: &mut fastrand::Rng) -> f64 {
        self.view.style.lighting.occlusion.map_or(1.0, |occlusion| {
            let (axis, reach) = self.viewer(point);
            let seen = self.transmittance(point, axis, &occlusion.cone, reach, random);
            1.0 - occlusion.strength * (1.0 - seen)
        })
    }

    /// Part of a light that comes to a point.
    fn arriving(
        &self,
        light: &Light,
        incident: &Incident,
        point: DVec3,
        random: &mut fastrand::Rng,
    ) -> f64 {
        let Incident {
            direction,
            reach,
            part,
        } = *incident;
        if part == 0.0 || self.view.style.lighting.shadows == LightMode::Off {
            return part;
        }
        part * self.transmittance(point, direction, &light.cone, reach, random)
    }

    fn surface(&self, valued: Option<&Sample>) -> Surface {
        let shades = valued.filter(|_| self.view.style.lighting.blinn_phong);
        let gradient = shades.and_then(|s| self.gradient(s)).unwrap_or_default();
        let change = gradient.length() * self.view.style.transfer.reference_length;
        Surface {
            normal: gradient.normalize_or_zero(),
            weight: smooth_step(GRADIENT_FADE, change),
        }
    }

    /// Gradient in world space of the position in the range of values, as they are interpolated in a cell
    /// and not clamped to the range; `None` where they are constant or the cell is flat.
    pub(in crate::reference) fn gradient(&self, sample: &Sample) -> Option<DVec3> {
        sample.value?;
        let Located { ijk, str } = sample.located;
        let corners = self.vertices.as_ref()?.corners(self.grid, ijk);
        // Values vary by the same map as places do: here as a place with three equal coordinates.
        let values = Hexahedron(corners.map(DVec3::splat)).jacobian(str).row(0);
        let [low, high] = self.view.style.transfer.range;
        let world_from_grid = self.view.world.spaces.world_from_grid.matrix3;
        let map = world_from_grid * self.grid.hexahedron(ijk).jacobian(str);
        let gradient = map.transpose().inverse() * values / (high - low);
        gradient.is_finite().then_some(gradient)
    }
}

impl Incident {
    fn new(source: LightSource, point: DVec3) -> Self {
        match source {
            LightSource::Directional { toward } => Self {
                direction: toward,
                reach: f64::INFINITY,
                part: 1.0,
            },
            LightSource::Point { position } => Self::from_place(position, point),
            LightSource::Spot {
                position,
                axis,
                opening,
            } => {
                let incident = Self::from_place(position, point);
                let edge = [opening, (1.0 - SPOT_EDGE) * opening].map(f64::cos);
                let part = smooth_step(edge, -incident.direction.dot(axis));
                Self { part, ..incident }
            }
        }
    }

    fn from_place(position: DVec3, point: DVec3) -> Self {
        let (direction, reach) = (position - point).normalize_and_length();
        Self {
            direction,
            reach,
            part: 1.0,
        }
    }
}

impl Surface {
    fn diffuse(&self, to_light: DVec3) -> f64 {
        1.0 - self.weight + self.weight * self.normal.dot(to_light).abs()
    }

    /// Blinn's highlight.
    fn specular(&self, to_light: DVec3, to_viewer: DVec3) -> f64 {
        let halfway = (to_light + to_viewer).normalize_or_zero();
        SPECULAR * self.weight * self.normal.dot(halfway).abs().powf(SHININESS)
    }
}

/// 0 up to the first edge, 1 from the second on, smooth between them.
fn smooth_step([low, high]: [f64; 2], x: f64) -> f64 {
    let x = ((x - low) / (high - low)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Random numbers of a point on a ray, and of no other: no thread's turn changes them.
fn random(seed: u32, point: DVec3) -> fastrand::Rng {
    let words = point.to_array().map(f64::to_bits);
    let mix = |state: u64, word: u64| fastrand::Rng::with_seed(state ^ word).u64(..);
    fastrand::Rng::with_seed(words.into_iter().fold(u64::from(seed), mix))
}
