//! Pyramids over a resampled volume (volumetric-ray-tracing survey, 8.3 to 8.7), without a device: bricks, their sizes,
//! and what they are classified by.

use super::layout::{BRICK, BricksInfo};
use super::majorants::Majorants;
use crate::transfer::TransferFunction;

/// Bytes of a part of the pyramid: range, presence, extinction.
const PART_BYTES: u64 = 16;
/// What bricks are classified by; each negative for never.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest extinction of what is passed at once.
    pub empty: f64,
    /// Largest range, as a part of the transfer function's, of what is passed in one step.
    pub even: f64,
    /// Largest extinction of what is sampled from the average pyramid.
    pub thin: f64,
}

impl Limits {
    /// True where nothing is ever classified.
    pub fn are_never(&self) -> bool {
        self.empty < 0.0 && self.even < 0.0 && self.thin < 0.0
    }
}

/// Bricks of a volume of so many voxels; nothing is said of what makes one special.
pub fn bricks_of_volume(size: [u32; 3]) -> BricksInfo {
    let count = bricks_of(size);
    BricksInfo {
        count,
        levels: levels(count).count() as u32,
        ..bytemuck::Zeroable::zeroed()
    }
}

fn bricks_of(size: [u32; 3]) -> [u32; 3] {
    size.map(|n| n.div_ceil(BRICK))
}

/// Parts along each axis, level by level, up to the one that is the whole.
pub fn levels(bricks: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    std::iter::successors(Some(bricks), |size| {
        (*size != [1; 3]).then(|| size.map(|n| n.div_ceil(2)))
    })
}

/// Bytes of the pyramid of a volume of so many voxels, of what is kept of each brick, and of the table of maxima.
pub fn room(size: [u32; 3]) -> [u64; 3] {
    let number = |count: [u32; 3]| count.map(u64::from).iter().product::<u64>();
    let count = bricks_of(size);
    [
        PART_BYTES * levels(count).map(number).sum::<u64>(),
        4 * number(count),
        4 * Majorants::ENTRIES as u64,
    ]
}

/// Bytes that a pyramid of so many voxels takes.
pub fn most_bytes(size: [u32; 3]) -> u64 {
    room(size).iter().sum()
}

/// What bricks are classified by.
#[derive(Debug, Clone, Copy)]
pub struct Classifier<'a> {
    /// Value to color and extinction.
    pub transfer: &'a TransferFunction,
    /// The values that are stored as 0 and 1.
    pub range: [f64; 2],
    /// Values are divided by presence when they are sampled.
    pub weighted: bool,
    /// What is special.
    pub limits: Limits,
}

impl Classifier<'_> {
    /// The numbers of bricks of a volume that has so many levels of averages.
    pub fn info(&self, bricks: BricksInfo, averages: u32) -> BricksInfo {
        let [low, scale] = self.transfer.positions(self.range);
        let limits = self.limits;
        BricksInfo {
            position_low: low as f32,
            position_scale: scale as f32,
            empty: limits.empty as f32,
            even: limits.even as f32,
            thin: limits.thin as f32,
            averages,
            ..bricks
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_end_with_the_whole() {
        let found: Vec<_> = levels([5, 1, 3]).collect();
        assert_eq!(found, [[5, 1, 3], [3, 1, 2], [2, 1, 1], [1, 1, 1]]);
        assert_eq!(levels([1; 3]).count(), 1);
    }
}
