//! Volumes that are filled with a field, without a device.

use glam::DVec3;

use super::compact_grid::GridFacts;
use super::layout::{self, VolumeInfo};
use crate::scene::Interpolation;

/// The numbers of a volume of so many voxels over the box of a grid; `range` has the values that are stored as 0 and 1.
pub fn volume_info(
    grid: &GridFacts,
    size: [u32; 3],
    range: [f64; 2],
    interpolation: Interpolation,
) -> VolumeInfo {
    let [from, to] = grid.bounds;
    VolumeInfo {
        box_low: from.as_vec3().to_array(),
        value_low: range[0] as f32,
        box_extent: (to - from).max(DVec3::splat(1e-6)).as_vec3().to_array(),
        value_scale: layout::per_unit(range),
        size,
        interpolation: layout::interpolation(interpolation),
    }
}
