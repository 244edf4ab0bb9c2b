//! Parts of a ray in one cell, each integrated as a whole. The twin of `shaders/shared/segments.wgsl`.

use glam::{Vec3A, Vec4};

use super::each::Each;
use super::frame::Ray;
use super::scene::Scene;
use super::transfer::{Accumulated, passed};

/// Optical depth and part of the value range that one piece of a segment may have.
const PIECE_DEPTH: f32 = 0.5;
const PIECE_RANGE: f32 = 0.05;
const MOST_PIECES: f32 = 16.0;

/// A part of a ray, between two distances from its origin.
pub struct Span<'a> {
    /// What all rays read.
    pub scene: &'a Scene<'a>,
    /// The ray.
    pub ray: &'a Ray,
    /// Where it begins.
    pub from: f32,
    /// Where it ends, behind that.
    pub to: f32,
}

impl Span<'_> {
    /// Adds the inside of a cell, whose values are given for four distances at a time where it is no ghost. Returns
    /// the number of pieces that were integrated.
    #[inline]
    pub fn add(&self, is_ghost: bool, sum: &mut Accumulated, values: impl Fn(Vec4) -> Vec4) -> u64 {
        match is_ghost {
            true => {
                self.of_ghost(sum);
                0
            }
            false => self.by_value(sum, values),
        }
    }

    fn of_ghost(&self, sum: &mut Accumulated) {
        let scene = self.scene;
        let middle = self.ray.at(0.5 * (self.from + self.to));
        let entry = scene.shading.shade_entry(scene.ghost, middle, true);
        sum.absorb(entry, entry.w * (self.to - self.from));
    }

    /// Adds values in pieces so small that the order of colors within one does not matter; in each the means of
    /// extinction and color over its values are differences of integrals. Returns their number.
    #[inline]
    fn by_value(&self, sum: &mut Accumulated, values: impl Fn(Vec4) -> Vec4) -> u64 {
        let Self {
            scene, ray, from, ..
        } = *self;
        let transfer = &scene.transfer;
        let length = self.to - from;
        let ends = values(from + length * Vec4::new(0.0, 0.5, 1.0, 1.0));
        let [first, middle, last, _] = ends.to_array();
        let extinctions = [first, middle, last].each(|value| transfer.of(value).w);
        let depth = length * Vec3A::from_array(extinctions).max_element();
        let range = (ends.max_element() - ends.min_element()) * transfer.value_scale();
        let pieces = (depth / PIECE_DEPTH).max(range / PIECE_RANGE).ceil();
        let pieces = pieces.clamp(1.0, MOST_PIECES);
        let mut before = first;
        let mut done = 0.0;
        while done < pieces && transfer.is_open(sum) {
            done += 1.0;
            let value = match done < pieces {
                true => values(Vec4::splat(from + length * done / pieces)).x,
                false => last,
            };
            let mean = transfer.mean(before, value);
            if mean.w > 0.0 {
                let color = Vec3A::from_vec4(mean) / mean.w;
                let piece = length / pieces;
                let at = [from + (done - 0.5) * piece, piece];
                let light = &mut sum.light;
                let color = scene.shading.shade_along(color, light, ray, at, false);
                sum.pass(color, passed(mean.w * piece));
            }
            before = value;
        }
        done as u64
    }
}
