//! The pyramid of a volume's bricks, and how rays pass them (volumetric-ray-tracing survey, 8.3 to 8.7).
//! The twin of `shaders/pyramids.wgsl`, which says where it departs from the survey.

use super::pieces::in_groups;
use super::resample::Field;
use crate::render::job::Progress;
use crate::render::plan::bricks::{Classifier, bricks_of_volume, levels};
use crate::render::plan::layout::{BRICK, BricksInfo};
use crate::render::plan::majorants::Majorants;

/// How rays pass a part of a volume.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Pass {
    /// Sample by sample.
    #[default]
    Plain,
    /// At once.
    Empty,
    /// In one step.
    Even,
    /// In longer steps, from the average pyramid.
    Thin,
}

/// A part of the pyramid.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// Stored values of its voxels that are present; high < low where there are none.
    low: f32,
    high: f32,
    /// The least one.
    presence: f32,
    /// The largest one.
    extinction: f32,
}

/// The pyramid of a volume's bricks.
pub struct Bricks {
    info: BricksInfo,
    /// Bricks first, x fastest, level by level.
    parts: Vec<Vec<Part>>,
    /// How each brick is passed, and the level of the part that is passed so.
    passes: Vec<(Pass, u8)>,
}

impl Bricks {
    /// Range and presence of each brick of a volume of so many voxels.
    pub async fn new(field: &Field, size: [u32; 3], progress: &Progress) -> Self {
        let info = bricks_of_volume(size);
        let [across, down, deep] = info.count.map(|n| n as usize);
        let mut parts = Vec::with_capacity(across * down * deep);
        let row = |n: usize| {
            let part = |x| summary(field, size, [x, n % down, n / down]);
            (0..across).map(part).collect::<Vec<_>>()
        };
        in_groups(down * deep, progress, row, |_, row| parts.extend(row)).await;
        Self {
            info,
            passes: vec![(Pass::Plain, 0); parts.len()],
            parts: vec![parts],
        }
    }

    /// Weighs the bricks by a transfer function and says how each is passed; the volume has so many levels of
    /// averages.
    pub fn classify(&mut self, by: &Classifier<'_>, averages: u32) {
        let info = by.info(self.info, averages);
        let majorants = Majorants::new(by.transfer);
        let position =
            |stored: f32| (info.position_low + info.position_scale * stored).clamp(0.0, 1.0);
        self.parts.truncate(1);
        for part in &mut self.parts[0] {
            part.extinction = match part.low <= part.high {
                true => {
                    let fades = !by.weighted && part.presence < 1.0;
                    let low = if fades { 0.0 } else { part.low };
                    majorants.between(position(low), position(part.high))
                }
                false => 0.0,
            };
        }
        let sizes: Vec<_> = levels(info.count).collect();
        for pair in sizes.windows(2) {
            let reduced = self
                .parts
                .last()
                .map(|below| reduce(below, pair[0], pair[1]));
            self.parts.extend(reduced);
        }
        let pass = |n: usize| {
            let mut at = place_of(n, info.count);
            let [mut empty, mut even, mut thin] = [None; 3];
            for (level, (parts, size)) in (0..).zip(self.parts.iter().zip(&sizes)) {
                let part = parts[index_in(at, *size)];
                let range = position(part.high) - position(part.low);
                let steps = f32::from(2u8).powi((i32::from(level) + 1).min(averages as i32));
                let found = Some(level);
                empty = if part.extinction <= info.empty {
                    found
                } else {
                    empty
                };
                even = if part.presence == 1.0 && range <= info.even {
                    found
                } else {
                    even
                };
                thin = if part.extinction * steps <= info.thin {
                    found
                } else {
                    thin
                };
                at = at.map(|n| n / 2);
            }
            let of = |pass| move |level| (pass, level);
            let best = empty.map(of(Pass::Empty)).or(even.map(of(Pass::Even)));
            best.or(thin.map(of(Pass::Thin))).unwrap_or_default()
        };
        self.passes = (0..self.passes.len()).map(pass).collect();
    }

    /// Bricks along each axis.
    pub fn count(&self) -> [u32; 3] {
        self.info.count
    }

    /// How a brick is passed, and the level of the part that is passed so.
    pub fn pass(&self, brick: [u32; 3]) -> (Pass, u8) {
        self.passes[index_in(brick, self.info.count)]
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let parts = self.parts.iter().map(|level| size_of_val(level.as_slice()));
        (parts.sum::<usize>() + size_of_val(self.passes.as_slice())) as u64
    }
}

/// Range and presence of a brick with the voxels around it, from which values near its sides are interpolated.
fn summary(field: &Field, size: [u32; 3], brick: [usize; 3]) -> Part {
    let side = BRICK as usize;
    let range = |axis: usize| {
        let first = (brick[axis] * side).saturating_sub(1);
        first..=((brick[axis] + 1) * side).min(size[axis] as usize - 1)
    };
    let mut part = Part {
        low: 1.0,
        high: 0.0,
        presence: 1.0,
        extinction: 0.0,
    };
    for z in range(2) {
        for y in range(1) {
            for x in range(0) {
                let [value, presence] = field.voxel([x, y, z]).to_array();
                part.presence = part.presence.min(presence);
                if presence > 0.0 {
                    part.low = part.low.min(value);
                }
                part.high = part.high.max(value);
            }
        }
    }
    part
}

/// The next level of a pyramid.
fn reduce(below: &[Part], size: [u32; 3], reduced: [u32; 3]) -> Vec<Part> {
    let part = |n: usize| {
        let first = place_of(n, reduced).map(|n| 2 * n);
        let child = |n: u32| [0, 1, 2].map(|axis| first[axis] + (n >> axis & 1));
        let is_there = |at: &[u32; 3]| at.iter().zip(size).all(|(n, size)| *n < size);
        let children = (0..8).map(child).filter(is_there);
        let parts = children.map(|at| below[index_in(at, size)]);
        let both = |a: Part, b: Part| Part {
            low: a.low.min(b.low),
            high: a.high.max(b.high),
            presence: a.presence.min(b.presence),
            extinction: a.extinction.max(b.extinction),
        };
        parts.fold(below[index_in(first, size)], both)
    };
    let count: u32 = reduced.iter().product();
    (0..count as usize).map(part).collect()
}

fn index_in([x, y, z]: [u32; 3], size: [u32; 3]) -> usize {
    (x + size[0] * (y + size[1] * z)) as usize
}

fn place_of(n: usize, [width, height, _]: [u32; 3]) -> [u32; 3] {
    let n = n as u32;
    [n % width, n / width % height, n / width / height]
}
