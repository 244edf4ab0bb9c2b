//! Samples of a ray in one cell: colored, shaded and blended, four at a time.

use glam::{Vec3A, Vec4};

use super::frame::{AHEAD, Ray};
use super::scene::Scene;
use super::surfaces::Layers;
use super::transfer::Accumulated;

/// Samples of a ray that follow each other.
pub struct Samples<'a> {
    /// What all rays read.
    pub scene: &'a Scene<'a>,
    /// The ray.
    pub ray: &'a Ray,
    /// Number of the first sample.
    pub first: f32,
    /// How many there are, at least one.
    pub count: f32,
}

impl Samples<'_> {
    /// Adds samples of one color and extinction, with the surfaces between them; returns how many were needed.
    pub fn of_one(
        &self,
        entry: Vec4,
        is_ghost: bool,
        layers: &mut Layers,
        sum: &mut Accumulated,
    ) -> f32 {
        match self.scene.shading.varies(is_ghost) {
            false => self.alike(entry, is_ghost, layers, sum),
            true => {
                let passed = Vec4::splat(self.scene.transfer.passed(entry.w));
                self.in_fours(is_ghost, layers, sum, |_| ([entry; 4], passed))
            }
        }
    }

    /// Adds samples whose values are given for four numbers of samples at a time, with the surfaces between them;
    /// returns how many were needed.
    pub fn by_value(
        &self,
        layers: &mut Layers,
        sum: &mut Accumulated,
        values: impl Fn(Vec4) -> Vec4,
    ) -> f32 {
        let transfer = &self.scene.transfer;
        self.in_fours(false, layers, sum, |n| transfer.of_four(values(n)))
    }

    /// Samples of one color wherever they are.
    fn alike(
        &self,
        entry: Vec4,
        is_ghost: bool,
        layers: &mut Layers,
        sum: &mut Accumulated,
    ) -> f32 {
        let Self { scene, ray, .. } = *self;
        let entry = scene.shading.shade_entry(entry, ray.base, is_ghost);
        let mut done = 0.0;
        while done < self.count && scene.transfer.is_open(sum) {
            layers.blend_until(scene, sum, self.distance(done));
            // Up to the next surface.
            let before = |distance: f32| {
                (distance / scene.frame.numbers.step - 0.5 - ray.first).floor() + 1.0
            };
            let end = (before(layers.next()) - self.first).min(f32::MAX);
            let part = (self.count - done).min((end - done).max(1.0));
            done += scene.transfer.accumulate_many(sum, entry, part);
        }
        done
    }

    /// Samples four by four: `of` gives their colors and extinctions by their numbers, and what each lets pass.
    #[inline]
    fn in_fours(
        &self,
        is_ghost: bool,
        layers: &mut Layers,
        sum: &mut Accumulated,
        of: impl Fn(Vec4) -> ([Vec4; 4], Vec4),
    ) -> f32 {
        let Self { scene, ray, .. } = *self;
        let mut done = 0.0;
        while done < self.count {
            let (entries, passed) = of(self.first + done + AHEAD);
            for (entry, passed) in entries.into_iter().zip(passed.to_array()) {
                if done >= self.count || !scene.transfer.is_open(sum) {
                    return done;
                }
                let distance = self.distance(done);
                layers.blend_until(scene, sum, distance);
                if entry.w > 0.0 {
                    let color = Vec3A::from_vec4(entry);
                    let at = [distance, scene.frame.numbers.step];
                    let light = &mut sum.light;
                    let color = scene.shading.shade_along(color, light, ray, at, is_ghost);
                    sum.pass(color, passed);
                }
                done += 1.0;
            }
        }
        done
    }

    fn distance(&self, done: f32) -> f32 {
        let step = self.scene.frame.numbers.step;
        self.ray.distance(step, self.first + done)
    }
}
