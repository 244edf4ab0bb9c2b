//! Occlusion from all sides. The twin of `shaders/shared/around.wgsl`.

use glam::Vec3A;

use super::cones::Cones;
use super::extinction::depth_of;
use super::lamps::Lamp;
use super::transfer::passed;
use super::volume::{Voxels, averages};
use crate::render::job::Progress;
use crate::render::plan::around::directions;
use crate::render::plan::layout::LightingInfo;

/// What a mean transmittance over all directions counts for: a point of an even surface, to which light comes from half
/// of them, is as open as can be.
pub fn openness(mean: f32) -> f32 {
    (2.0 * mean).min(1.0)
}

/// Cones to all sides of a point.
pub struct Surround<'a> {
    cones: &'a Cones<'a>,
    lamps: Vec<Lamp>,
}

impl<'a> Surround<'a> {
    /// Cones with the sections of a lamp.
    pub fn new(cones: &'a Cones<'a>, lamp: &Lamp) -> Self {
        let toward = |direction: glam::Vec3| lamp.far_toward(direction.into());
        Self {
            cones,
            lamps: directions().map(toward).into(),
        }
    }

    /// Openness of a point of lighting space.
    pub fn openness(&self, p: Vec3A) -> f32 {
        let of = |lamp: &Lamp| self.cones.transmittance(lamp, p);
        openness(self.lamps.iter().map(of).sum::<f32>() / self.lamps.len() as f32)
    }
}

/// Opacities, and their means in voxels twice as large each time.
pub struct Means(Vec<Voxels<f32>>);

impl Means {
    /// Of so many shells.
    pub async fn new(opacities: Voxels<f32>, shells: u32, progress: &Progress) -> Self {
        let mut levels = vec![opacities];
        for _ in 0..shells {
            let Some(below) = levels.last() else { break };
            let made = averages(below, progress).await;
            levels.push(made);
        }
        Self(levels)
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(Voxels::bytes).sum()
    }

    /// Voxels without any mean.
    pub fn finest(&self) -> Option<&Voxels<f32>> {
        self.0.first()
    }

    /// So many shells can be asked for.
    pub fn shells(&self) -> u32 {
        self.0.len().saturating_sub(1) as u32
    }

    /// Openness of a point of lighting space; see [`Self::transmittance`].
    pub fn openness(&self, info: &LightingInfo, per_shell: bool, p: Vec3A) -> f32 {
        openness(self.transmittance(info, per_shell, p))
    }

    /// Part of the light that passes the shells around a point of lighting space, one after the other, as much of each
    /// as of a voxel where `per_shell` is true.
    fn transmittance(&self, info: &LightingInfo, per_shell: bool, p: Vec3A) -> f32 {
        let size = Vec3A::from(info.size);
        let mean = |level: usize, voxels: &Voxels<f32>| {
            voxels.sample(p / size) * part_inside(p, size, 0.5 * (level as f32).exp2())
        };
        let mut levels = self.0.iter().enumerate();
        let mut before = levels.next().map_or(0.0, |(n, voxels)| mean(n, voxels));
        let mut depth = 0.0;
        for (level, voxels) in levels {
            let now = mean(level, voxels);
            let shell = ((8.0 * now - before) / 7.0).clamp(0.0, 1.0);
            let thickness = match per_shell {
                true => 1.0,
                false => (level as f32 - 2.0).exp2(),
            };
            depth += thickness * depth_of(shell);
            before = now;
        }
        passed(info.around_attenuation * depth)
    }
}

/// Part of a cube around a point, of half an edge each way, that lies in the box: there is nothing outside.
pub fn part_inside(p: Vec3A, size: Vec3A, half: f32) -> f32 {
    let inside = (p + half).min(size) - (p - half).max(Vec3A::ZERO);
    let part = (inside / (2.0 * half)).clamp(Vec3A::ZERO, Vec3A::ONE);
    part.x * part.y * part.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::job::Job;

    const EDGE: u32 = 64;

    /// Means over a cube of voxels whose opacities follow their places, of so many shells.
    fn means(opacity: impl Fn([usize; 3]) -> f32 + Sync, shells: u32) -> Means {
        let job = Job::new(|progress| {
            Box::pin(async move {
                let row = |y, z| (0..EDGE as usize).map(|x| opacity([x, y, z])).collect();
                let voxels = Voxels::by_rows([EDGE; 3], &progress, row).await;
                Ok(Means::new(voxels, shells, &progress).await)
            })
        });
        job.run(&|_| true).unwrap_or_else(|error| panic!("{error}"))
    }

    fn transmittance(means: &Means, per_shell: bool, p: [f32; 3]) -> f32 {
        let mut info: LightingInfo = bytemuck::Zeroable::zeroed();
        info.size = [EDGE as f32; 3];
        info.around_attenuation = 1.0;
        means.transmittance(&info, per_shell, p.into())
    }

    #[test]
    fn an_even_medium_takes_what_its_length_does_or_as_much_per_shell() {
        let opacity = 0.4_f32;
        let means = means(|_| opacity, 4);
        let middle = [32.0; 3];
        // Four shells end at 8 voxels, the first begins at half a voxel.
        let by_length = (1.0 - opacity).powf(7.5);
        let of_shells = (1.0 - opacity).powi(4);
        assert!((transmittance(&means, false, middle) - by_length).abs() < 1e-5);
        assert!((transmittance(&means, true, middle) - of_shells).abs() < 1e-5);
        assert!((by_length - of_shells).abs() > 0.1);
    }

    #[test]
    fn at_an_opaque_half_space_each_shell_takes_half() {
        for shells in [2, 4] {
            let means = means(|[.., z]| if z < 32 { 1.0 } else { 0.0 }, shells);
            let found = transmittance(&means, true, [32.0; 3]);
            let expected = 0.5_f32.powi(shells as i32);
            assert!((found - expected).abs() < 1e-3, "{found} {expected}");
        }
    }

    #[test]
    fn a_voxel_counts_in_shells_that_are_wide_enough() {
        // Opaque, 12 voxels beside the middle.
        let means = |shells| means(|at| f32::from(u8::from(at == [44, 32, 32])), shells);
        let at = |shells| transmittance(&means(shells), true, [32.5; 3]);
        assert!((at(3) - 1.0).abs() < 1e-6, "{}", at(3));
        assert!(at(5) < 0.99999, "{}", at(5));
    }

    #[test]
    fn there_is_nothing_outside_of_the_box() {
        let size = Vec3A::splat(64.0);
        let part = |p: [f32; 3], half| part_inside(p.into(), size, half);
        assert!((part([32.0; 3], 32.0) - 1.0).abs() < 1e-6);
        assert!((part([0.0, 32.0, 32.0], 8.0) - 0.5).abs() < 1e-6);
        assert!((part([0.0; 3], 128.0) - 0.015_625).abs() < 1e-6);
        assert!(part([-20.0, 32.0, 32.0], 8.0) == 0.0);
    }
}
