//! What several shaders read of a view, from world space to grid space.

use super::grid_upload::GpuGrid;
use crate::view::clip::MAX_CLIP_PLANES;
use crate::view::{View, ghosts};

/// Color, as it is blended, and extinction of inactive cells.
pub(super) fn ghost(view: &View) -> [f32; 4] {
    let [r, g, b] = view.style.blending.of_srgb(ghosts::COLOR).map(|v| v as f32);
    [
        r,
        g,
        b,
        view.style.transfer.extinction_of(ghosts::OPACITY) as f32,
    ]
}

/// Planes from world space to grid space relative to the grid's origin; f64 until nothing cancels.
pub(super) fn clip_planes(grid: &GpuGrid, view: &View) -> [[f32; 4]; MAX_CLIP_PLANES] {
    let mut planes = [[0.0; 4]; MAX_CLIP_PLANES];
    for (plane, clip) in planes.iter_mut().zip(&view.shown.clip) {
        let to_world = &view.world.spaces.world_from_grid;
        let normal = to_world.matrix3.transpose() * clip.normal;
        let height = clip
            .normal
            .dot(to_world.transform_point3(grid.origin) - clip.point);
        *plane = normal.extend(height).as_vec4().to_array();
    }
    planes
}
