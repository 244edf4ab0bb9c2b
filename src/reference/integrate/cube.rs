//! Samples of a cube beside the model, as [`crate::view::ShownCube`] defines them.

use glam::{DAffine3, DVec3};

use super::{Integrator, Ray, Sum};
use crate::view::ShownCube;

/// The samples of a cube on a ray, from the nearest on.
pub(super) struct CubeOnRay<'a> {
    integrator: &'a Integrator<'a>,
    shown: &'a ShownCube,
    ray: Ray,
    sample_from_world: DAffine3,
    /// Number of the next sample, and distance of the last one at most.
    next: f64,
    leave: f64,
}

impl<'a> CubeOnRay<'a> {
    /// Those of a view's cube, if it shows one and the ray meets it.
    pub(super) fn new(integrator: &'a Integrator<'a>, ray: Ray) -> Option<Self> {
        let shown = integrator.view.shown.cube.as_deref()?;
        let sample_from_world = shown.world_from_sample.inverse();
        let inside = Ray {
            origin: sample_from_world.transform_point3(ray.origin),
            direction: sample_from_world.transform_vector3(ray.direction),
        };
        // Distances stay those of world space.
        let [enter, leave] = inside.within(shown.crop)?;
        let step = shown.step(integrator.view.sampling.step);
        Some(Self {
            integrator,
            shown,
            ray,
            sample_from_world,
            next: (enter / step).ceil().max(1.0),
            leave,
        })
    }

    /// Adds the samples up to a distance.
    pub(super) fn add_until(&mut self, distance: f64, sum: &mut Sum) {
        let view = self.integrator.view;
        let step = self.shown.step(view.sampling.step);
        while self.next * step <= distance.min(self.leave)
            && sum.transmittance >= view.sampling.early_termination
        {
            let position = self.ray.origin + self.next * step * self.ray.direction;
            self.next += 1.0;
            if !self.integrator.is_kept(position) {
                continue;
            }
            let (value, presence) = self.at(position);
            if presence > 0.0 {
                let transfer = &self.shown.transfer;
                let place = transfer.position(value / presence);
                let alpha = presence * (1.0 - (-transfer.extinction(place) * step).exp());
                let color = view.style.blending.of_srgb(transfer.srgb(place));
                sum.add(color.into(), alpha);
            }
        }
    }

    /// Value times presence, and presence, at a point of world space: linear along k, then j, then i.
    fn at(&self, position: DVec3) -> (f64, f64) {
        let place = self.sample_from_world.transform_point3(position);
        let size = self.shown.cube.size;
        // The two samples around a place along an axis, with their weights.
        let around = |axis: usize| {
            let last = size[axis] - 1;
            let at = place[axis].max(0.0).min(last as f64);
            let low = at as usize;
            let part = at - low as f64;
            [(low, 1.0 - part), ((low + 1).min(last), part)]
        };
        let [along_i, along_j, along_k] = [around(0), around(1), around(2)];
        let mut sums = (0.0, 0.0);
        for (k, of_k) in along_k {
            for (j, of_j) in along_j {
                for (i, of_i) in along_i {
                    let value = f64::from(self.shown.cube.values[(k * size[1] + j) * size[0] + i]);
                    if value.is_finite() {
                        let weight = of_i * of_j * of_k;
                        sums = (sums.0 + weight * value, sums.1 + weight);
                    }
                }
            }
        }
        sums
    }
}
