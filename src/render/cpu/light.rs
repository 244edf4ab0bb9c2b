//! Light of a view: its emitters, and the volumes. The twin of `shaders/shared/light.wgsl`.

use glam::{Vec3A, Vec4};

use super::cone_rays::ConeRays;
use super::cones::Cones;
use super::lamps::Lamp;
use super::sat::Sat;
use super::vct::Vct;
use super::volume::Voxels;
use crate::render::plan::layout::{LIGHT_IMAGE, LIGHT_RAYS, LIGHT_VOLUME, LightingInfo};
use crate::render::plan::light::Shading;
use crate::scene::lighting::LightMethod;

/// Light of a view, brought up to date.
pub struct Light<'a> {
    /// What is shaded.
    pub shading: Shading,
    /// Its numbers.
    pub info: LightingInfo,
    /// The viewer, then the lights.
    pub lamps: &'a [Lamp],
    /// Where cones are traced.
    pub cones: Option<Cones<'a>>,
    /// Where they are traced through values.
    pub vct: Option<Vct<'a>>,
    /// Where they are boxes of sums.
    pub sat: Option<Sat<'a>>,
    /// Where rays over cones are cast.
    pub rays: Option<ConeRays<'a>>,
    /// Transmittances of cones found before, of each emitter that has a number there.
    pub volumes: Vec<&'a Voxels<f32>>,
    /// Change of the transfer function's position a unit, times presence; and presence.
    pub gradients: Option<&'a Voxels<Vec4>>,
}

impl Light<'_> {
    /// A point of grid space relative to the origin, in lighting space.
    pub fn place(&self, point: Vec3A) -> Vec3A {
        (point - Vec3A::from(self.info.box_low)) * Vec3A::from(self.info.scale)
    }

    /// Transmittance of the cone from a point toward the viewer.
    pub fn toward_viewer(&self, viewer: &Lamp, p: Vec3A) -> f32 {
        let Shading {
            occlusion, method, ..
        } = self.shading;
        self.transmittance(occlusion, method, viewer, p)
    }

    /// Transmittance of the cone from a point toward a light.
    pub fn toward_light(&self, lamp: &Lamp, p: Vec3A) -> f32 {
        let Shading {
            shadows,
            shadow_method,
            ..
        } = self.shading;
        self.transmittance(shadows, shadow_method, lamp, p)
    }

    fn transmittance(&self, mode: u32, method: LightMethod, lamp: &Lamp, p: Vec3A) -> f32 {
        let found = match mode {
            LIGHT_IMAGE => match method {
                LightMethod::Vct => self.vct.map(|vct| vct.transmittance(lamp, p)),
                LightMethod::Sat => self.sat.map(|sat| sat.transmittance(lamp, p)),
                _ => self.cones.map(|cones| cones.transmittance(lamp, p)),
            },
            LIGHT_RAYS => self.rays.map(|rays| rays.transmittance(lamp, p)),
            LIGHT_VOLUME => {
                let volume = self.volumes.get(lamp.emitter.volume as usize);
                volume.map(|volume| volume.sample(p / Vec3A::from(self.info.size)))
            }
            _ => None,
        };
        found.unwrap_or(1.0)
    }
}
