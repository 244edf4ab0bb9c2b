//! Light along a cone through the pyramid of values (shih-2016; `src/render/plan/vct.rs` says how).
//! The twin of `shaders/shared/vct.wgsl` and `shaders/moments.wgsl`.

use glam::{Vec3A, Vec4};

use super::around::part_inside;
use super::extinction::{depth_of, unclipped};
use super::lamps::{Lamp, Section};
use super::resample::FieldVoxel;
use super::transfer::passed;
use super::volume::{Voxels, covered};
use crate::render::job::Progress;
use crate::render::plan::extinction::Blur;
use crate::render::plan::layout::{LightingInfo, VCT_DEVIATIONS, VCT_MEANS};
use crate::render::plan::vct::shape;

/// Optical depth behind which the paper looks no further: a hundredth of the light is left.
const ENOUGH: f32 = 4.605_170_2;
/// Less than that of a voxel is covered by none.
const LEAST_COVERED: f32 = 1e-4;

/// Level by level mean of the values times the part that cells cover; their standard deviation times that; the part;
/// and the part that inactive cells cover.
pub struct ValuePyramid(Vec<Voxels<Vec4>>);

impl ValuePyramid {
    /// That of a volume of values.
    pub async fn new(field: &Voxels<u16>, blur: &Blur, progress: &Progress) -> Self {
        let is_kept = unclipped(&blur.numbers());
        let finest = Voxels::by_rows(blur.size, progress, |y, z| {
            let held = |(x, packed): (usize, &u16)| match is_kept([x, y, z]) {
                true => finest_of(*packed),
                false => Vec4::ZERO,
            };
            field.row(y, z).iter().enumerate().map(held).collect()
        })
        .await;
        let mut levels = vec![finest];
        for level in 1..shape(blur.size).levels {
            let size = shape(blur.size).at(level);
            let below = &levels[levels.len() - 1];
            let made = Voxels::by_rows(size, progress, |y, z| {
                let mean = |x| mean_of(below, size, [x, y, z]);
                (0..size[0] as usize).map(mean).collect()
            });
            let made = made.await;
            levels.push(made);
        }
        Self(levels)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(Voxels::bytes).sum()
    }

    /// Between levels, at a place of the box.
    fn sample(&self, at: Vec3A, level: f32) -> Vec4 {
        let level = level.min((self.0.len() - 1) as f32);
        let (below, part) = (level as usize, level.fract());
        let fine = self.0[below].sample(at);
        match part > 0.0 {
            true => fine.lerp(self.0[below + 1].sample(at), part),
            false => fine,
        }
    }
}

fn finest_of(packed: u16) -> Vec4 {
    let voxel = FieldVoxel::of(packed);
    match voxel.is_ghost {
        true => Vec4::new(0.0, 0.0, 0.0, voxel.coverage),
        false => Vec4::new(voxel.coverage * voxel.value, 0.0, voxel.coverage, 0.0),
    }
}

/// What a larger voxel holds of those below that it covers. The variance of all is the mean of theirs and of their
/// means' distances.
fn mean_of(below: &Voxels<Vec4>, size: [u32; 3], voxel: [usize; 3]) -> Vec4 {
    let along = |axis: usize| covered([below.size[axis], size[axis] as usize], voxel[axis]);
    let each = |found: &mut dyn FnMut(f32, Vec4)| {
        for (z, in_z) in along(2) {
            for (y, in_y) in along(1) {
                let row = below.row(y, z);
                for (x, in_x) in along(0) {
                    found(in_x * in_y * in_z, row[x]);
                }
            }
        }
    };
    let mut sum = Vec4::ZERO;
    each(&mut |part, held| sum += part * held);
    let present = sum.z;
    if present < LEAST_COVERED {
        return Vec4::new(0.0, 0.0, 0.0, sum.w);
    }
    let mean = sum.x / present;
    let mut variance = 0.0;
    each(&mut |part, held| {
        let covered = held.z.max(LEAST_COVERED);
        let off = held.x / covered - mean;
        variance += part * held.z * ((held.y / covered).powi(2) + off * off);
    });
    let deviation = (variance / present).sqrt();
    Vec4::new(sum.x, present * deviation, present, sum.w)
}

/// Cones through a pyramid of values.
#[derive(Clone, Copy)]
pub struct Vct<'a> {
    pyramid: &'a ValuePyramid,
    /// Texels of [`crate::render::plan::vct::OpacityTable`].
    opacities: &'a [[f32; 4]],
    /// Of the box in lighting space.
    size: Vec3A,
}

impl<'a> Vct<'a> {
    /// Through a pyramid, with the opacities of a curve.
    pub fn new(pyramid: &'a ValuePyramid, opacities: &'a [[f32; 4]], info: &LightingInfo) -> Self {
        Self {
            pyramid,
            opacities,
            size: Vec3A::from(info.size),
        }
    }

    /// Transmittance from a point of lighting space toward an emitter.
    pub fn transmittance(&self, lamp: &Lamp, p: Vec3A) -> f32 {
        let (axis, reach) = lamp.toward(p);
        let [
            [
                Section {
                    distance,
                    amplitude,
                    ..
                },
                ..,
            ],
            ..,
        ] = lamp.sections()
        else {
            return 1.0;
        };
        let (tangent, length) = (lamp.emitter.tangent, lamp.emitter.length);
        let end = length
            .min(reach)
            .min(self.leaves(p, axis, length * tangent + 0.5));
        let (mut t, mut depth) = (*distance, 0.0);
        while t < end && amplitude * depth < ENOUGH {
            let step = (t * tangent).max(1.0).min(end - t);
            let middle = t + 0.5 * step;
            let level = (2.0 * middle * tangent).max(1.0).log2();
            depth += step * depth_of(self.opacity(p + middle * axis, level));
            t += step;
        }
        passed(amplitude * depth)
    }

    /// Distance at which a ray leaves the box made wider by a margin.
    fn leaves(&self, p: Vec3A, direction: Vec3A, margin: f32) -> f32 {
        let tiny = Vec3A::splat(1e-9);
        let safe = Vec3A::select(direction.abs().cmplt(tiny), tiny, direction);
        let ends = [(-margin - p) / safe, (self.size + margin - p) / safe];
        ends[0].max(ends[1]).min_element()
    }

    /// Opacity of a unit of length of a voxel around a point.
    fn opacity(&self, p: Vec3A, level: f32) -> f32 {
        let held = self.pyramid.sample(p / self.size, level);
        let covered = held.z.max(LEAST_COVERED);
        let cells = held.z * self.of_values(held.x / covered, held.y / covered);
        let ghosts = held.w * self.opacities.last().map_or(0.0, |texel| texel[0]);
        (cells + ghosts) * part_inside(p, self.size, 0.5 * level.exp2())
    }

    /// Opacity of values with a mean and a deviation.
    fn of_values(&self, mean: f32, deviation: f32) -> f32 {
        let last = (VCT_DEVIATIONS - 1) as f32;
        let row = (last + 3.0 * (2.0 * deviation).max(1e-6).log2()).clamp(0.0, last);
        let column = mean.clamp(0.0, 1.0) * (VCT_MEANS - 1) as f32;
        let at = (row as u32 * VCT_MEANS + column as u32) as usize;
        let [a, b, c, d] = self.opacities[at];
        let [right, down] = [column.fract(), row.fract()];
        let (above, below) = (a + (b - a) * right, c + (d - c) * right);
        above + (below - above) * down
    }
}
