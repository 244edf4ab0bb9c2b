//! The pyramid of representative extinction: opacities blurred by Gaussians, each level twice as wide as the one below
//! (campagnolo-2021, 3.2.1 and 3.2.3). The twin of `shaders/extinction.wgsl`.
//!
//! As on the device each level is blurred from means of the opacities, along one axis after the other.

use glam::{Vec3A, Vec4};

use super::mean::overlap;
use super::resample::FieldVoxel;
use super::transfer::Tables;
use super::volume::Voxels;
use crate::render::job::Progress;
use crate::render::plan::extinction::{Blur, Line, MOST_LEVELS};
use crate::render::plan::layout::{BlurInfo, PACKED_GHOST};
use crate::render::plan::occluders::Occluders;
use crate::view::voxels::Shape;

/// Opacities are kept below one, as in the transfer function.
const MOST_OPACITY: f32 = 0.999_999;
/// Standard deviations after which a Gaussian ends; voxels that lie there in part count.
const REACH: f32 = 3.0;

/// Optical depth of a length of one standard deviation of the finest level, level by level.
pub struct Pyramid(pub Vec<Voxels<f32>>);

impl Pyramid {
    /// The pyramid over opacities.
    pub async fn new(opacities: &Voxels<f32>, blur: &Blur, progress: &Progress) -> Self {
        let shape = Shape::single(blur.size, MOST_LEVELS);
        let mut levels = Vec::new();
        let mut means: Option<Voxels<f32>> = None;
        for level in 0..shape.levels {
            if level > 1 {
                let taps = |line: &Line| Taps::means(line.counts);
                let below = means.as_ref().unwrap_or(opacities);
                let wider = shape.at(level - 1);
                means = Some(filtered(below, wider, blur, None, &taps, progress).await);
            }
            let below = means.as_ref().unwrap_or(opacities);
            let taps = |line: &Line| Taps::gaussian(line);
            let (size, of) = (shape.at(level), Some(level));
            levels.push(filtered(below, size, blur, of, &taps, progress).await);
        }
        Self(levels)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(Voxels::bytes).sum()
    }
}

/// Optical depth of an opacity.
pub fn depth_of(opacity: f32) -> f32 {
    -(1.0 - opacity.min(MOST_OPACITY)).ln()
}

/// Opacities of a unit of length: of cells, and of what stands in the way beside them.
pub async fn opacities(
    field: &Voxels<u16>,
    blur: &Blur,
    tables: &Tables,
    occluders: Option<&Occluders>,
    progress: &Progress,
) -> Voxels<f32> {
    let numbers = blur.numbers();
    // A packed value has so few numbers that each is asked once.
    let of_value = |packed: u32| {
        let voxel = FieldVoxel::of(packed as u16);
        let in_cell = tables.at(numbers.position_low + numbers.position_scale * voxel.value);
        let extinction = if voxel.is_ghost {
            numbers.ghost
        } else {
            in_cell.w
        };
        1.0 - (-extinction * numbers.sigma).exp()
    };
    let of_values: Vec<f32> = (0..=PACKED_GHOST).map(of_value).collect();
    let is_kept = unclipped(&numbers);
    Voxels::by_rows(blur.size, progress, |y, z| {
        let opacity = |(x, packed): (usize, &u16)| match *packed != 0 && is_kept([x, y, z]) {
            true => {
                let value = u32::from(*packed) & PACKED_GHOST;
                FieldVoxel::of(*packed).coverage * of_values[value as usize]
            }
            false => 0.0,
        };
        let mut row: Vec<f32> = field.row(y, z).iter().enumerate().map(opacity).collect();
        if let Some(occluders) = occluders {
            let others = row.iter_mut().zip(occluders.row(y, z)).enumerate();
            for (x, (opacity, other)) in others.filter(|(_, (_, other))| *other > 0.0) {
                let other = if is_kept([x, y, z]) { other } else { 0.0 };
                *opacity = 1.0 - (1.0 - *opacity) * (1.0 - other);
            }
        }
        row
    })
    .await
}

/// Whether clip planes leave the middle of a voxel.
pub fn unclipped(numbers: &BlurInfo) -> impl Fn([usize; 3]) -> bool + Sync + use<> {
    let planes = numbers.clip_planes.map(Vec4::from_array);
    let count = numbers.clip_count as usize;
    let [low, spacing] = [numbers.box_low, numbers.spacing].map(Vec3A::from);
    move |voxel| {
        let at = Vec3A::from_array(voxel.map(|n| n as f32)) + 0.5;
        let is_kept =
            |plane: &Vec4| Vec3A::from_vec4(*plane).dot(low + at * spacing) + plane.w >= 0.0;
        planes[..count].iter().all(is_kept)
    }
}

/// What a voxel along an axis takes of those before: from the first one on.
struct Tap {
    first: usize,
    weights: Vec<f32>,
}

/// What all voxels along an axis take.
struct Taps(Vec<Tap>);

impl Taps {
    /// Weights of each voxel that is made by its `center` and the number of one that is read. What lies outside of the
    /// box counts, and is nothing.
    fn new([from, to]: [u32; 2], reach: f32, weight: impl Fn(u32, f32, i32) -> f32) -> Self {
        let ratio = from as f32 / to as f32;
        let tap = |made: u32| {
            let center = (made as f32 + 0.5) * ratio - 0.5;
            let (low, high) = (
                (center - reach).ceil() as i32,
                (center + reach).floor() as i32,
            );
            let sum: f32 = (low..=high).map(|n| weight(made, center, n)).sum();
            let within = low.max(0)..(high + 1).min(from as i32);
            let first = within.start as usize;
            let weights = within.map(|n| weight(made, center, n) / sum.max(1e-30));
            Tap {
                first,
                weights: weights.collect(),
            }
        };
        Self((0..to).map(tap).collect())
    }

    /// A Gaussian.
    fn gaussian(line: &Line) -> Self {
        let deviation = line.deviation as f32;
        Self::new(line.counts, REACH * deviation + 0.5, |_, center, n| {
            let relative = (n as f32 - center) / deviation.max(1e-3);
            (-0.5 * relative * relative).exp()
        })
    }

    /// The part of a voxel that lies within a larger one.
    fn means([from, to]: [u32; 2]) -> Self {
        let ratio = from as f32 / to as f32;
        Self::new([from, to], 0.5 * ratio + 0.5, |made, _, n| {
            overlap(n, made as i32, from as i32, to as i32) as f32
        })
    }
}

/// Filters opacities along x, y and depth in turn: into optical depths by the Gaussian of a level, or into their means.
async fn filtered(
    below: &Voxels<f32>,
    size: [u32; 3],
    blur: &Blur,
    level: Option<u32>,
    taps: &dyn Fn(&Line) -> Taps,
    progress: &Progress,
) -> Voxels<f32> {
    let before = below.size.map(|n| n as u32);
    let [along_x, along_y, along_z] = [0, 1, 2].map(|axis| {
        taps(&Line {
            axis: axis as u32,
            counts: [before[axis], size[axis]],
            deviation: level.map_or(0.0, |level| blur.deviation(axis, before[axis], level)),
        })
    });
    let first = Voxels::by_rows([size[0], before[1], before[2]], progress, |y, z| {
        let row = below.row(y, z);
        let sum = |tap: &Tap| {
            let read = row[tap.first..].iter().zip(&tap.weights);
            read.map(|(opacity, weight)| opacity * weight).sum()
        };
        along_x.0.iter().map(sum).collect()
    });
    let first = first.await;
    let second = Voxels::by_rows([size[0], size[1], before[2]], progress, |y, z| {
        rows(&along_y.0[y], size[0], |n| first.row(n, z))
    });
    let second = second.await;
    let third = |y: usize, z: usize| {
        let mut row = rows(&along_z.0[z], size[0], |n| second.row(y, n));
        if level.is_some() {
            row.iter_mut()
                .for_each(|opacity| *opacity = depth_of(*opacity));
        }
        row
    };
    Voxels::by_rows(size, progress, third).await
}

/// A sum of rows.
fn rows<'a>(tap: &Tap, width: u32, row: impl Fn(usize) -> &'a [f32]) -> Vec<f32> {
    let mut sum = vec![0.0; width as usize];
    for (n, weight) in (tap.first..).zip(&tap.weights) {
        for (sum, opacity) in sum.iter_mut().zip(row(n)) {
            *sum += weight * opacity;
        }
    }
    sum
}
