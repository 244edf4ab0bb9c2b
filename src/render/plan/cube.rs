//! What executors read of a cube that is shown beside the model ([`ShownCube`] says what is seen of it).

use glam::{DAffine3, DVec3};

use super::compact_grid::GridFacts;
use super::transfer::table_of;
use crate::case::Cube;
use crate::view::{ShownCube, View};

/// The numbers of a cube in a frame. Its box is 0 to 1 each way: voxel n of N along an axis has its middle at
/// (n + 1/2) / N of that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeNumbers {
    /// From grid space relative to the origin to the box, row by row; last what is added.
    pub box_from_grid: [[f32; 4]; 3],
    /// The crop in the box.
    pub low: [f32; 3],
    /// See `low`.
    pub high: [f32; 3],
    /// World-space distance of samples.
    pub step: f32,
    /// Position in the transfer function of a stored value: offset, and factor.
    pub position: [f32; 2],
}

impl CubeNumbers {
    /// Those of a view of a grid, of a cube whose values are stored as 0 and 1 at the ends of a range.
    pub fn new(grid: &GridFacts, view: &View, shown: &ShownCube, stored: [f64; 2]) -> Self {
        let size = DVec3::from_array(shown.cube.size.map(|n| n as f64));
        let in_box = |sample: DVec3| ((sample + 0.5) / size).as_vec3().to_array();
        let box_from_sample =
            DAffine3::from_scale(size.recip()) * DAffine3::from_translation(DVec3::splat(0.5));
        let from_grid = box_from_sample
            * shown.world_from_sample.inverse()
            * view.world.spaces.world_from_grid
            * DAffine3::from_translation(grid.origin);
        let rows = from_grid.matrix3.transpose();
        let added = from_grid.translation;
        let row = |axis: usize| rows.col(axis).extend(added[axis]).as_vec4().to_array();
        Self {
            box_from_grid: [0, 1, 2].map(row),
            low: in_box(shown.crop[0]),
            high: in_box(shown.crop[1]),
            step: shown.step(view.sampling.step) as f32,
            position: shown.transfer.positions(stored).map(|v| v as f32),
        }
    }
}

/// Red, green, blue, as they are blended, and extinction at equal distances over the range of a cube.
pub fn cube_table(view: &View, shown: &ShownCube) -> Vec<[f32; 4]> {
    table_of(&shown.transfer, view.style.blending)
}

/// Smallest and largest value of a cube, which differ.
pub fn cube_range(cube: &Cube) -> [f64; 2] {
    match cube.quantiles {
        Some(found) if found.max > found.min => [found.min, found.max],
        Some(found) => [found.min, found.min + 1.0],
        None => [0.0, 1.0],
    }
}
