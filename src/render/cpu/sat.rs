//! Light along a cone by boxes of a summed-area table (schlegel-2011; `src/render/plan/sat.rs` says how).
//! The twin of `shaders/shared/sat.wgsl` and `shaders/sums.wgsl`.

use glam::Vec3A;

use super::extinction::depth_of;
use super::lamps::{Lamp, Section};
use super::transfer::passed;
use super::volume::Voxels;
use crate::render::plan::layout::LightingInfo;
use crate::render::plan::sat::DEEPEST;

/// Optical depth behind which nothing more is seen to change.
const DARK: f32 = 8.0;

/// Sums of optical depths over all voxels with smaller or equal indices, which wrap around.
pub struct Sums {
    voxels: Voxels<u32>,
    /// Numbers that a unit of optical depth is counted in.
    pub counts: f32,
}

impl Sums {
    /// Those of opacities of a unit of length.
    pub fn new(opacities: &Voxels<f32>, counts: f32) -> Self {
        let mut voxels = Voxels::new(opacities.size.map(|n| n as u32));
        for (voxel, opacity) in voxels.data.iter_mut().zip(&opacities.data) {
            *voxel = (depth_of(*opacity).min(DEEPEST) * counts + 0.5) as u32;
        }
        let [width, height, _] = opacities.size;
        for (axis, step) in [1, width, width * height].into_iter().enumerate() {
            let along = opacities.size[axis];
            for n in 0..voxels.data.len() {
                if n / step % along > 0 {
                    voxels.data[n] = voxels.data[n].wrapping_add(voxels.data[n - step]);
                }
            }
        }
        Self { voxels, counts }
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        self.voxels.bytes()
    }

    /// The sum of all voxels before a corner.
    fn before(&self, [x, y, z]: [usize; 3]) -> u32 {
        match x == 0 || y == 0 || z == 0 {
            true => 0,
            false => self.voxels.at([x - 1, y - 1, z - 1]),
        }
    }

    /// The sum over a box whose corners are in voxels; of voxels that it cuts a part counts. Differences that wrap
    /// around are exact while whole numbers.
    pub fn over(&self, low: Vec3A, high: Vec3A) -> f32 {
        let axis = |n: usize| Along::new(low[n], high[n], self.voxels.size[n]);
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let mut sum = 0.0;
        let mut behind = [[0u32; 3]; 3];
        for (layer, &z_at) in z.planes.iter().enumerate() {
            let rows = y.planes.map(|y_at| {
                let at = x.planes.map(|x_at| self.before([x_at, y_at, z_at]));
                differences(at)
            });
            let here: [[u32; 3]; 3] = std::array::from_fn(|n| {
                std::array::from_fn(|m| rows[n + 1][m].wrapping_sub(rows[n][m]))
            });
            if layer > 0 {
                for n in 0..3 {
                    for m in 0..3 {
                        let within = here[n][m].wrapping_sub(behind[n][m]) as f32;
                        sum += z.parts[layer - 1] * y.parts[n] * x.parts[m] * within;
                    }
                }
            }
            behind = here;
        }
        sum
    }
}

fn differences([a, b, c, d]: [u32; 4]) -> [u32; 3] {
    [b.wrapping_sub(a), c.wrapping_sub(b), d.wrapping_sub(c)]
}

/// A box along an axis: the planes between a voxel that it cuts, whole ones, and another that it cuts; and what part of
/// each of the three counts.
struct Along {
    planes: [usize; 4],
    parts: [f32; 3],
}

impl Along {
    fn new(low: f32, high: f32, count: usize) -> Self {
        let last = count as f32;
        let (low, high) = (low.clamp(0.0, last), high.clamp(0.0, last));
        let (first, end) = (low as usize, high as usize);
        let second = (first + 1).min(count);
        let third = end.max(second);
        let behind = if end > first { high - end as f32 } else { 0.0 };
        Self {
            planes: [first, second, third, (third + 1).min(count)],
            parts: [high.min(second as f32) - low, 1.0, behind],
        }
    }
}

/// Cones by boxes of sums.
#[derive(Clone, Copy)]
pub struct Sat<'a> {
    sums: &'a Sums,
    /// Voxels of a unit of lighting space.
    per_unit: Vec3A,
}

impl<'a> Sat<'a> {
    /// By boxes of sums.
    pub fn new(sums: &'a Sums, info: &LightingInfo) -> Self {
        let count = Vec3A::from_array(sums.voxels.size.map(|n| n as f32));
        Self {
            sums,
            per_unit: count / Vec3A::from(info.size),
        }
    }

    /// Transmittance from a point of lighting space toward an emitter.
    pub fn transmittance(&self, lamp: &Lamp, p: Vec3A) -> f32 {
        let (axis, reach) = lamp.toward(p);
        let [boxes, ..] = lamp.sections();
        let mut depth = 0.0;
        for Section {
            distance,
            edge,
            amplitude,
            weight,
            ..
        } in boxes
        {
            let start = distance - 0.5 * weight;
            if start > reach || depth > DARK {
                break;
            }
            let middle = (p + *distance * axis) * self.per_unit;
            let half = 0.5 * *edge * self.per_unit;
            let mean =
                self.sums.over(middle - half, middle + half) / (8.0 * half.x * half.y * half.z);
            depth += weight.min(reach - start) * amplitude * mean;
        }
        passed(depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 3] = [23, 17, 11];
    /// So many that sums over all voxels wrap around.
    const COUNTS: f32 = 4e6;

    fn random(seed: &mut fastrand::Rng) -> f32 {
        seed.f32()
    }

    fn sums(seed: &mut fastrand::Rng) -> (Sums, Vec<u32>) {
        let mut opacities = Voxels::<f32>::new(SIZE.map(|n| n as u32));
        for opacity in &mut opacities.data {
            *opacity = random(seed);
        }
        let whole = opacities.data.iter();
        let whole = whole.map(|o| (depth_of(*o).min(DEEPEST) * COUNTS + 0.5) as u32);
        let whole = whole.collect();
        (Sums::new(&opacities, COUNTS), whole)
    }

    /// The sum over a box in f64.
    fn brute(voxels: &[u32], low: Vec3A, high: Vec3A) -> f64 {
        let part = |n: usize, axis: usize| {
            let (a, b) = (f64::from(low[axis]), f64::from(high[axis]));
            (b.min((n + 1) as f64) - a.max(n as f64)).max(0.0)
        };
        let mut sum = 0.0;
        for (n, value) in voxels.iter().enumerate() {
            let at = [n % SIZE[0], n / SIZE[0] % SIZE[1], n / SIZE[0] / SIZE[1]];
            let parts: f64 = (0..3).map(|axis| part(at[axis], axis)).product();
            sum += parts * f64::from(*value);
        }
        sum
    }

    #[test]
    fn sums_over_boxes_are_those_of_their_voxels() {
        let mut seed = fastrand::Rng::with_seed(11);
        let (sums, voxels) = sums(&mut seed);
        let total: u64 = voxels.iter().map(|v| u64::from(*v)).sum();
        assert!(total > u64::from(u32::MAX), "nothing wraps around");
        for n in 0..10_000 {
            let mut corner =
                || Vec3A::from_array(SIZE.map(|n| random(&mut seed) * (n + 4) as f32 - 2.0));
            let (a, b) = (corner(), corner());
            let (low, high) = (a.min(b), a.max(b));
            // Half of the boxes are of whole voxels.
            let (low, high) = match n % 2 {
                0 => (low.floor(), high.floor()),
                _ => (low, high),
            };
            let exact = brute(&voxels, low, high);
            if exact > 4e9 {
                continue;
            }
            let found = f64::from(sums.over(low, high));
            assert!(
                (found - exact).abs() <= 2e-6 * exact + 2.0,
                "{low} {high}: {found} {exact}"
            );
        }
        // The twin: a box moved by a voxel.
        let (low, high) = (Vec3A::splat(2.0), Vec3A::splat(5.0));
        let moved = brute(&voxels, low + Vec3A::X, high + Vec3A::X);
        assert!((f64::from(sums.over(low, high)) - moved).abs() > 1e-3 * moved);
    }
}
