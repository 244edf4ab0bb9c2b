//! Fills volumes with a field by point location down their lines of voxels. The twin of `shaders/resample.wgsl`.

use glam::{Vec2, Vec3A, Vec4};

use super::each::Each;
use super::frame::{AHEAD, Ray};
use super::grid::Grid;
use super::tally::Tally;
use super::topology::Track;
use super::volume::{ONE_PART, Voxel, Voxels, averages, in_parts};
use crate::render::job::Progress;
use crate::render::plan::layout::{
    PACKED_COVERAGE, PACKED_GHOST, PACKED_SHIFT, PACKED_VALUES, VolumeInfo,
};
use crate::render::plan::volume::volume_info;
use crate::scene::Interpolation;

/// Samples of a packed voxel: without them the model's top would have steps that light shows.
const PARTS: u32 = 4;

/// A sample in a cell: its number in the line, its value as a part of the range, and whether it is in a ghost.
struct Found {
    n: usize,
    stored: f32,
    is_ghost: bool,
}

/// Volumes of a grid's field.
pub struct Resampler<'a> {
    grid: &'a Grid,
    info: VolumeInfo,
    size: [u32; 3],
}

/// A volume of values and presence, level by level of its average pyramid.
pub enum Field {
    /// The value as a part of the range times presence, and presence: 1 in a drawn cell and 0 elsewhere.
    Drawn(Vec<Voxels<[u16; 2]>>),
    /// The same two, presence of a ghost, and 0.
    WithGhosts(Vec<Voxels<[u16; 4]>>),
}

impl Field {
    /// Values times presence, presences, and presences of ghosts at four places of the box.
    #[inline]
    pub fn samples(&self, places: [Vec3A; 4], level: usize) -> [Vec4; 3] {
        match self {
            Self::Drawn(levels) => {
                let [a, b, c, d] = places.each(|at| levels[level].sample(at));
                [
                    ONE_PART * Vec4::new(a.x, b.x, c.x, d.x),
                    ONE_PART * Vec4::new(a.y, b.y, c.y, d.y),
                    Vec4::ZERO,
                ]
            }
            Self::WithGhosts(levels) => {
                let found = places.each(|at| ONE_PART * levels[level].sample(at));
                [0, 1, 2].each(|n| Vec4::from_array(found.each(|voxel| voxel[n])))
            }
        }
    }

    /// Value times presence, and presence, of a voxel of the finest level.
    pub fn voxel(&self, at: [usize; 3]) -> Vec2 {
        let parts = match self {
            Self::Drawn(levels) => levels[0].at(at).number(),
            Self::WithGhosts(levels) => levels[0].at(at).number().truncate().truncate(),
        };
        ONE_PART * parts
    }

    /// Makes the coarser levels, up to so many in all.
    pub async fn average(&mut self, levels: u32, progress: &Progress) {
        match self {
            Self::Drawn(made) => coarser(made, levels, progress).await,
            Self::WithGhosts(made) => coarser(made, levels, progress).await,
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Drawn(levels) => levels.iter().map(Voxels::bytes).sum(),
            Self::WithGhosts(levels) => levels.iter().map(Voxels::bytes).sum(),
        }
    }
}

async fn coarser<T: Voxel>(made: &mut Vec<Voxels<T>>, levels: u32, progress: &Progress) {
    while let Some(fine) = made.last().filter(|_| made.len() < levels as usize) {
        let coarse = averages(fine, progress).await;
        made.push(coarse);
    }
}

impl<'a> Resampler<'a> {
    /// What fills volumes of so many voxels; `range` has the values that are stored as 0 and 1.
    pub fn new(grid: &'a Grid, size: [u32; 3], range: [f64; 2]) -> Self {
        let info = volume_info(&grid.compact.facts, size, range, grid.interpolation);
        Self { grid, info, size }
    }

    /// Voxels of coverage and value.
    pub async fn packed(&self, progress: &Progress) -> Voxels<u16> {
        Voxels::by_lines(self.size, progress, |x, y, line: &mut [u16]| {
            let mut packing = Packing::default();
            self.for_each(x, y, PARTS, |found| packing.add(&found, line));
            packing.finish(line);
        })
        .await
    }

    /// Voxels of value and presence.
    pub async fn field(&self, progress: &Progress) -> Field {
        let one = u16::MAX;
        if !self.grid.has_ghosts() {
            let fill = |x, y, line: &mut [[u16; 2]]| {
                self.for_each(x, y, 1, |f| line[f.n] = [in_parts(f.stored), one]);
            };
            return Field::Drawn(vec![Voxels::by_lines(self.size, progress, fill).await]);
        }
        let fill = |x, y, line: &mut [[u16; 4]]| {
            self.for_each(x, y, 1, |f| {
                line[f.n] = match f.is_ghost {
                    true => [0, 0, one, 0],
                    false => [in_parts(f.stored), one, 0, 0],
                };
            });
        };
        Field::WithGhosts(vec![Voxels::by_lines(self.size, progress, fill).await])
    }

    /// Finds the samples of a line that lie in cells, `parts` of them in a voxel.
    fn for_each(&self, x: usize, y: usize, parts: u32, mut found: impl FnMut(Found)) {
        let info = &self.info;
        let size = Vec3A::from_array(self.size.map(|n| n as f32));
        let spacing = Vec3A::from(info.box_extent) / size;
        let middle = Vec3A::new(x as f32 + 0.5, y as f32 + 0.5, 0.5 / parts as f32);
        let ray = Ray::down(
            Vec3A::from(info.box_low) + middle * spacing,
            spacing.z / parts as f32,
            (parts * self.size[2]) as f32,
        );
        let mut tally = Tally::default();
        let mut track = Track::through(self.grid, &ray, &mut tally);
        let (mut n, mut is_next) = (0.0, false);
        while let Some(stretch) = track.next(n, is_next) {
            let cell = track.cell();
            let is_ghost = self.grid.is_ghost(cell.column, cell.layer);
            let last = stretch.first + stretch.more;
            let mut at = stretch.first;
            while at <= last {
                let four = at + AHEAD;
                let values = match self.grid.interpolation {
                    Interpolation::Cell => Vec4::splat(cell.k0.w),
                    Interpolation::Vertex => cell.values(stretch.parameters(four)),
                };
                let stored = (values - info.value_low) * info.value_scale;
                let stored = stored.clamp(Vec4::ZERO, Vec4::ONE).to_array();
                let numbers = four.to_array().into_iter().zip(stored);
                for (at, stored) in numbers.take_while(|(at, _)| *at <= last) {
                    found(Found {
                        n: at as usize,
                        stored,
                        is_ghost,
                    });
                }
                at += 4.0;
            }
            n = stretch.first + stretch.more + 1.0;
            is_next = true;
        }
    }
}

/// A voxel of which some parts have been met.
#[derive(Default)]
struct Packing {
    voxel: usize,
    parts: u32,
    ghosts: u32,
    sum: f32,
}

impl Packing {
    /// Adds a part of a voxel; the one before is written once another begins.
    fn add(&mut self, found: &Found, line: &mut [u16]) {
        let voxel = found.n / PARTS as usize;
        if voxel != self.voxel {
            self.finish(line);
            *self = Self {
                voxel,
                ..Self::default()
            };
        }
        self.parts += 1;
        self.ghosts += u32::from(found.is_ghost);
        self.sum += if found.is_ghost { 0.0 } else { found.stored };
    }

    fn finish(&self, line: &mut [u16]) {
        if self.parts == 0 {
            return;
        }
        let mean = self.sum / (self.parts - self.ghosts).max(1) as f32;
        let value = match 2 * self.ghosts > self.parts {
            true => PACKED_GHOST,
            false => (mean * PACKED_VALUES as f32).round_ties_even() as u32,
        };
        let coverage = self.parts as f32 / PARTS as f32 * PACKED_COVERAGE as f32;
        line[self.voxel] = ((coverage.round_ties_even() as u32) << PACKED_SHIFT | value) as u16;
    }
}

/// Coverage of a packed voxel, 0 to 1; its value, as a part of the range; and whether it is an inactive cell.
pub struct FieldVoxel {
    /// Coverage.
    pub coverage: f32,
    /// Value.
    pub value: f32,
    /// It is an inactive cell.
    pub is_ghost: bool,
}

impl FieldVoxel {
    /// A packed voxel.
    pub fn of(packed: u16) -> Self {
        let value = u32::from(packed) & PACKED_GHOST;
        Self {
            coverage: (u32::from(packed) >> PACKED_SHIFT) as f32 / PACKED_COVERAGE as f32,
            value: value as f32 / PACKED_VALUES as f32,
            is_ghost: value == PACKED_GHOST,
        }
    }
}
