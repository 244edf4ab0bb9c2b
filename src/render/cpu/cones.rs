//! Transmittance of a cone from sections of the extinction pyramid (campagnolo-2021, 3.2 and appendix A).
//! The twin of `shaders/shared/cones.wgsl`.

use glam::Vec3A;

use super::extinction::Pyramid;
use super::lamps::{Lamp, Section, across};
use super::transfer::passed;
use crate::render::plan::layout::LightingInfo;

/// Centers of three circles packed in a circle, as a part of its radius; and of the outer six of seven.
const THREE_AT: f32 = 0.535_898_4;
const SEVEN_AT: f32 = 0.666_666_7;
/// Optical depth behind which nothing more is seen to change.
const DARK: f32 = 8.0;
/// Exponent of a Gaussian behind which nothing is left of it.
const MOST_OUTSIDE: f32 = 12.0;
/// Half the square root of three.
const COS_30: f32 = 0.866_025_4;

/// A pyramid that cones are traced through, over a box of `size` in lighting space.
#[derive(Clone, Copy)]
pub struct Cones<'a> {
    /// The pyramid.
    pub pyramid: &'a Pyramid,
    /// Of the box.
    pub size: Vec3A,
    /// One over it.
    scale: Vec3A,
}

/// Sums along parts of a cone: optical depths, and what the last section counted.
#[derive(Clone, Copy)]
struct Parts<const N: usize> {
    directions: [Vec3A; N],
    depths: [f32; N],
    before: [f32; N],
}

impl<const N: usize> Parts<N> {
    /// Goes on from a point through sections that are no farther than `reach`, until all is dark.
    fn trace(&mut self, cones: &Cones<'_>, p: Vec3A, sections: &[Section], reach: f32) {
        for section in sections {
            let least = self.depths.iter().copied().fold(f32::MAX, f32::min);
            if section.distance > reach || least > DARK {
                break;
            }
            for n in 0..N {
                let at = p + section.distance * self.directions[n];
                let now = section.amplitude * cones.depth(at, section);
                self.depths[n] += section.weight * (self.before[n] + now);
                self.before[n] = now;
            }
        }
    }

    fn transmittances(&self) -> [f32; N] {
        self.depths.map(passed)
    }
}

impl<'a> Cones<'a> {
    /// Cones through a pyramid.
    pub fn new(pyramid: &'a Pyramid, info: &LightingInfo) -> Self {
        let size = Vec3A::from(info.size);
        Self {
            pyramid,
            size,
            scale: size.recip(),
        }
    }

    /// Optical depth of a unit of length at a point, from the level of a section. Outside the box the value at the
    /// border fades as a Gaussian does.
    fn depth(&self, p: Vec3A, section: &Section) -> f32 {
        let levels = &self.pyramid.0;
        let outside = (-p).max(p - self.size).max(Vec3A::ZERO);
        let off = section.fade * outside.length_squared();
        if off > MOST_OUTSIDE {
            return 0.0;
        }
        let depth = levels[section.level.min(levels.len() - 1)].sample(p * self.scale);
        match off > 0.0 {
            true => passed(off) * depth,
            false => depth,
        }
    }

    /// Transmittance from a point toward an emitter.
    ///
    /// One cone goes on as three and these as seven, where the table says so. Three inherit the one's optical depth; of
    /// seven the middle one takes the mean of three, the outer ones that of the nearest.
    pub fn transmittance(&self, lamp: &Lamp, p: Vec3A) -> f32 {
        let (axis, reach) = lamp.toward(p);
        let [ones, threes, sevens] = lamp.sections();
        let mut one = Parts {
            directions: [axis],
            depths: [0.0],
            before: [0.0],
        };
        one.trace(self, p, ones, reach);
        if threes.is_empty() && sevens.is_empty() {
            return one.transmittances()[0];
        }
        let side = across(axis);
        let part = THREE_AT * lamp.emitter.tangent;
        let (down, right) = (-0.5 * part * side[1], COS_30 * part * side[0]);
        let directions = [part * side[1], down - right, down + right];
        let mut three = Parts {
            directions: directions.map(|aside| (axis + aside).normalize()),
            depths: [one.depths[0]; 3],
            before: [one.before[0]; 3],
        };
        three.trace(self, p, threes, reach);
        if sevens.is_empty() {
            return three.transmittances().iter().sum::<f32>() / 3.0;
        }
        // The outer six lie 30 degrees to either side of the three.
        let wide = SEVEN_AT * lamp.emitter.tangent;
        let (far, near) = (COS_30 * wide * side[1], 0.5 * wide * side[0]);
        let outer = [
            far + near,
            far - near,
            -wide * side[0],
            -far - near,
            near - far,
            wide * side[0],
        ];
        let of = |three: [f32; 3]| {
            let [a, b, c] = three;
            [(a + b + c) / 3.0, a, a, b, b, c, c]
        };
        let [a, b, c, d, e, f] = outer.map(|aside| (axis + aside).normalize());
        let mut seven = Parts {
            directions: [axis, a, b, c, d, e, f],
            depths: of(three.depths),
            before: of(three.before),
        };
        seven.trace(self, p, sevens, reach);
        let [middle, outer @ ..] = seven.transmittances();
        let cosine = 1.0 / (1.0 + wide * wide).sqrt();
        (middle + cosine * outer.iter().sum::<f32>()) / (1.0 + 6.0 * cosine)
    }
}
