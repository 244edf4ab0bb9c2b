//! What light needs: the emitters with the sections of their cones, and the volumes.
//! The twin of `shaders/shared/light.wgsl`.

use glam::{Vec3A, Vec4};

use super::cone_rays::ConeRays;
use super::cones::{Cones, Section};
use super::volume::Voxels;
use crate::render::plan::layout::{
    EMITTER_DIRECTIONAL, EMITTER_SPOT, Emitter, LIGHT_IMAGE, LIGHT_RAYS, LIGHT_VOLUME, LightingInfo,
};
use crate::render::plan::light::{Emitters, Shading};

/// The viewer, or a light.
#[derive(Debug, Clone)]
pub struct Lamp {
    /// Its numbers.
    pub emitter: Emitter,
    at: Vec3A,
    axis: Vec3A,
    sections: Vec<Section>,
}

impl Lamp {
    /// All of a view, the viewer first.
    pub fn all(emitters: &Emitters) -> Vec<Self> {
        let lamp = |(n, emitter): (usize, &Emitter)| Self {
            emitter: *emitter,
            at: emitter.at.into(),
            axis: emitter.axis.into(),
            sections: emitters.of(n).iter().map(|s| Section::of(*s)).collect(),
        };
        emitters.emitters.iter().enumerate().map(lamp).collect()
    }

    /// Unit vector from a point toward it, and the distance to it.
    pub fn toward(&self, p: Vec3A) -> (Vec3A, f32) {
        if self.emitter.kind == EMITTER_DIRECTIONAL {
            return (self.at, self.at.dot(self.axis - p));
        }
        let away = self.at - p;
        let distance = away.length().max(1e-6);
        (away / distance, distance)
    }

    /// The sections of its cone of one part, of three and of seven.
    pub fn sections(&self) -> [&[Section]; 3] {
        let [ones, threes] = [self.emitter.ones, self.emitter.threes].map(|n| n as usize);
        let (of_one, more) = self.sections.split_at(ones);
        let (of_three, of_seven) = more.split_at(threes);
        [of_one, of_three, of_seven]
    }

    /// Color of its light that arrives from a direction, if nothing is in the way.
    pub fn arriving(&self, way: Vec3A) -> Vec3A {
        let color = Vec3A::from(self.emitter.color);
        match self.emitter.kind == EMITTER_SPOT {
            true => {
                let edges = [self.emitter.cos_outer, self.emitter.cos_inner];
                smoothstep(edges, (-way).dot(self.axis)) * color
            }
            false => color,
        }
    }
}

/// Two unit vectors across a unit vector (Duff and others 2017).
pub fn across(axis: Vec3A) -> [Vec3A; 2] {
    let s = if axis.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (s + axis.z);
    let b = axis.x * axis.y * a;
    [
        Vec3A::new(1.0 + s * axis.x * axis.x * a, s * b, -s * axis.x),
        Vec3A::new(b, s + axis.y * axis.y * a, -axis.y),
    ]
}

/// 0 below the first edge, 1 above the second, smooth between.
pub fn smoothstep([low, high]: [f32; 2], at: f32) -> f32 {
    let t = ((at - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

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

    /// Transmittance of the cone from a point toward an emitter.
    pub fn transmittance(&self, mode: u32, lamp: &Lamp, p: Vec3A) -> f32 {
        let found = match mode {
            LIGHT_IMAGE => self.cones.map(|cones| cones.transmittance(lamp, p)),
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
