//! How the pyramid of representative extinction is made (campagnolo-2021, 3.2.1 and 3.2.3), without a device.

use glam::DVec3;

use super::compact_grid::GridFacts;
use super::frame::{clip_planes, ghost};
use super::layout::{BlurInfo, MAX_CLIP_PLANES};
use super::sat;
use super::transfer::position;
use crate::view::View;

/// Levels of the pyramid at most: 2^11 voxels along an axis have no more.
pub const MOST_LEVELS: u32 = 12;

/// Along which axis a pass blurs, how many voxels there are along it before and after, and how wide the
/// Gaussian is, in voxels before.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// The axis.
    pub axis: u32,
    /// Voxels before and after.
    pub counts: [u32; 2],
    /// Standard deviation.
    pub deviation: f64,
}

/// What opacities are made from, and how they are blurred.
#[derive(Clone, Copy)]
pub struct Blur {
    /// Voxels of the volume of values.
    pub size: [u32; 3],
    /// Transfer-function position of a value: offset, and factor on the part of the range.
    pub position: [f32; 2],
    /// Standard deviation of the finest level in world space.
    pub sigma: f64,
    /// Extinction of inactive cells.
    pub ghost: f32,
    /// Clip planes in grid space relative to the origin.
    pub clip_planes: [[f32; 4]; MAX_CLIP_PLANES],
    /// How many of them count.
    pub clip_count: u32,
    /// Box of the volume relative to the origin.
    pub bounds: [DVec3; 2],
    /// Its edges in world space.
    pub extent: DVec3,
    /// Numbers that a unit of optical depth is counted in, in sums.
    pub counts: f32,
}

impl Blur {
    /// That of a view of a grid, with a volume of values that has those of `range` as 0 and 1.
    pub fn new(grid: &GridFacts, view: &View, range: [f64; 2]) -> Self {
        let lighting = &view.style.lighting;
        Self {
            size: lighting.size(),
            position: position(view, range),
            sigma: lighting.sigma(),
            ghost: ghost(view)[3],
            clip_planes: clip_planes(grid, view),
            clip_count: view.shown.clip.len() as u32,
            bounds: grid.bounds,
            extent: lighting.extent,
            counts: sat::counts(view),
        }
    }

    /// Width of the Gaussian along an axis that makes a level from means over all of the volume's voxels in
    /// `count` parts, in these parts: variances add up, and a mean has one already.
    pub fn deviation(&self, axis: usize, count: u32, level: u32) -> f64 {
        let voxels = f64::from(self.size[axis]);
        let edge = self.extent[axis] / voxels;
        let in_a_part = voxels / f64::from(count);
        let wanted = (self.sigma * f64::from(level).exp2()).powi(2);
        let had = (in_a_part.powi(2) - 1.0) / 12.0 * edge.powi(2);
        (wanted - had).max(0.0).sqrt() / (in_a_part * edge)
    }

    /// The numbers of a pass that blurs nothing.
    pub fn numbers(&self) -> BlurInfo {
        self.info(Line {
            axis: 0,
            counts: [self.size[0]; 2],
            deviation: 0.0,
        })
    }

    /// The numbers of a pass.
    pub fn info(&self, line: Line) -> BlurInfo {
        let [low, high] = self.bounds;
        let size = DVec3::from_array(self.size.map(f64::from));
        BlurInfo {
            axis: line.axis,
            source_count: line.counts[0],
            made_count: line.counts[1],
            deviation: line.deviation as f32,
            box_low: low.as_vec3().to_array(),
            position_low: self.position[0],
            spacing: ((high - low) / size).as_vec3().to_array(),
            position_scale: self.position[1],
            sigma: self.sigma as f32,
            ghost: self.ghost,
            clip_count: self.clip_count,
            counts: self.counts,
            clip_planes: self.clip_planes,
        }
    }
}
