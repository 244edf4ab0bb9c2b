//! What a frame's rays read of a view, from world space to grid space.

use glam::DVec3;

use super::compact_grid::GridFacts;
use super::layout::{self, Frame};
use crate::view::clip::MAX_CLIP_PLANES;
use crate::view::surfaces::HEADLIGHT_ASIDE;
use crate::view::{View, ghosts};

/// The numbers of a frame.
pub fn frame_uniform(grid: &GridFacts, view: &View) -> Frame {
    let camera = &view.camera;
    let aspect = view.aspect();
    let f32s = |v: DVec3| v.as_vec3().to_array();
    let linear = view.world.spaces.grid_from_world.matrix3;
    let eye = view
        .world
        .spaces
        .grid_from_world
        .transform_point3(camera.eye)
        - grid.origin;
    // Half the picture at a depth of one.
    let half_height = camera.half_height(1.0);
    let [half_right, half_up] = [aspect * camera.right, camera.up].map(|v| half_height * v);
    let is_parallel = f64::from(u8::from(camera.parallel.is_some()));
    let aside = HEADLIGHT_ASIDE[0] * camera.right + HEADLIGHT_ASIDE[1] * camera.up;
    let to_camera = view.world.spaces.world_from_grid.matrix3.transpose();
    Frame {
        eye: f32s(eye),
        step: view.sampling.step as f32,
        forward: f32s(camera.forward),
        early_termination: view.sampling.early_termination as f32,
        right: f32s((1.0 - is_parallel) * half_right),
        value_low: view.style.transfer.range[0] as f32,
        up: f32s((1.0 - is_parallel) * half_up),
        value_scale: layout::per_unit(view.style.transfer.range),
        grid_from_world_x: f32s(linear.x_axis),
        width: view.size[0],
        grid_from_world_y: f32s(linear.y_axis),
        height: view.size[1],
        grid_from_world_z: f32s(linear.z_axis),
        interpolation: layout::interpolation(view.shown.cells.interpolation),
        box_low: f32s(grid.bounds[0]),
        clip_count: view.shown.clip.len() as u32,
        box_high: f32s(grid.bounds[1]),
        opaque_cuts: (0..)
            .zip(&view.shown.clip)
            .map(|(n, plane)| u32::from(plane.opaque) << n)
            .sum(),
        view_x: f32s(to_camera * (camera.right / (half_height * aspect))),
        farthest: farthest(view) as f32,
        view_y: f32s(to_camera * (camera.up / half_height)),
        world_handedness: grid.handedness * linear.determinant().signum() as f32,
        view_z: f32s(to_camera * camera.forward),
        grid_handedness: grid.handedness,
        origin_right: f32s(linear * (is_parallel * half_right)),
        is_parallel: is_parallel as f32,
        origin_up: f32s(linear * (is_parallel * half_up)),
        rays_across: view.sampling.supersample as f32,
        headlight: f32s(linear * aside),
        headlight_scale: (1.0 + aside.length_squared()).sqrt().recip() as f32,
        ghost: ghost(view),
        clip_planes: clip_planes(grid, view),
    }
}

/// Distance of the farthest corner of the model's box.
fn farthest(view: &View) -> f64 {
    let distances = view.world.corners.iter();
    let distances = distances.map(|c| view.camera.to_viewer(*c).1);
    distances.fold(0.0, f64::max)
}

/// Color, as it is blended, and extinction of inactive cells.
pub fn ghost(view: &View) -> [f32; 4] {
    let [r, g, b] = view.style.blending.of_srgb(ghosts::COLOR).map(|v| v as f32);
    [
        r,
        g,
        b,
        view.style.transfer.extinction_of(ghosts::OPACITY) as f32,
    ]
}

/// Planes from world space to grid space relative to the grid's origin; f64 until nothing cancels.
pub fn clip_planes(grid: &GridFacts, view: &View) -> [[f32; 4]; MAX_CLIP_PLANES] {
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
