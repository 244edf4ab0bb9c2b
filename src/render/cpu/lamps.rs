//! Emitters with the sections of their cones, as `shaders/shared/light.wgsl` has them.

use glam::Vec3A;

use crate::render::plan::layout::{EMITTER_DIRECTIONAL, EMITTER_SPOT, Emitter};
use crate::render::plan::light::{Emitters, FAR};

/// A section of a cone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// From the tip.
    pub distance: f32,
    /// Of the pyramid.
    pub level: usize,
    /// Factor on its depths.
    pub amplitude: f32,
    /// Half of the length that it and the one before it stand for.
    pub weight: f32,
    /// 1 / (2 s^2) for the standard deviation s of the level.
    pub fade: f32,
    /// Of boxes: the edge, which stands where others have their level.
    pub edge: f32,
}

impl Section {
    /// As it is planned: distance, level, amplitude, weight.
    pub fn of([distance, level, amplitude, weight]: [f32; 4]) -> Self {
        Self {
            distance,
            level: level as usize,
            amplitude,
            weight,
            fade: 0.5 * (-2.0 * level).exp2(),
            edge: level,
        }
    }
}

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

    /// One with the same sections far away in a direction.
    pub fn far_toward(&self, direction: Vec3A) -> Self {
        Self {
            emitter: Emitter {
                kind: EMITTER_DIRECTIONAL,
                ..self.emitter
            },
            at: direction,
            axis: FAR * direction,
            sections: self.sections.clone(),
        }
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
