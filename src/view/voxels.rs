//! How many voxels a volume over the model has, and what they take.

use crate::model::Dims;

/// Half floats of a voxel, which every adapter can interpolate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Voxel {
    /// One; two voxels along x share a word.
    Single,
    /// None, but 16 bits of coverage and value; two voxels along x share a word.
    Packed,
    /// None, but a whole number of 32 bits.
    Word,
    /// Two. Of a resampled field: the value, as a part of the range that it was filled with, times presence;
    /// and presence, 1 in a drawn cell and 0 elsewhere.
    Pair,
    /// Four. Of a field beside inactive cells: the same two; presence of an inactive cell that is shown; 0.
    Quad,
}

/// How large a volume is, and what it can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Voxels along x, y and depth.
    pub size: [u32; 3],
    /// Levels of the texture: the volume, and those of its average pyramid.
    pub levels: u32,
    /// What each voxel holds.
    pub voxel: Voxel,
}

/// Levels of the average pyramid above the volume, at most: the longest step is of 2^3 samples.
const AVERAGES: u32 = 3;
/// Voxels along an axis, at most; no adapter has more.
const MOST_ALONG: f64 = 16384.0;

impl Shape {
    /// For a field: `factor` voxels for each cell of the grid along i, j and k, with all levels of averages.
    pub fn of(dims: Dims, factor: f64, ghosts: bool) -> Self {
        let along = |n: usize| (factor * n as f64).round().clamp(1.0, MOST_ALONG) as u32;
        let size = [dims.ni, dims.nj, dims.nk].map(along);
        let coarsest = size.iter().max().map_or(0, |n| n.ilog2());
        Self {
            size,
            levels: 1 + AVERAGES.min(coarsest),
            voxel: match ghosts {
                true => Voxel::Quad,
                false => Voxel::Pair,
            },
        }
    }

    /// One number a voxel; `levels` of them, fewer where the last one has a single voxel before.
    pub fn single(size: [u32; 3], levels: u32) -> Self {
        let coarsest = size.iter().max().map_or(0, |n| n.ilog2());
        Self {
            size,
            levels: levels.min(1 + coarsest),
            voxel: Voxel::Single,
        }
    }

    /// Bytes of a voxel.
    pub(crate) fn voxel_bytes(&self) -> u32 {
        match self.voxel {
            Voxel::Single | Voxel::Packed => 2,
            Voxel::Pair | Voxel::Word => 4,
            Voxel::Quad => 8,
        }
    }

    /// Bytes of all levels.
    pub fn bytes(&self) -> u64 {
        let voxels = |level| -> u64 { self.at(level).map(u64::from).iter().product() };
        u64::from(self.voxel_bytes()) * (0..self.levels).map(voxels).sum::<u64>()
    }

    /// Voxels of a level along each axis.
    pub fn at(&self, level: u32) -> [u32; 3] {
        self.size.map(|n| (n >> level).max(1))
    }
}
