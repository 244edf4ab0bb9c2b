//! Fills volumes with a field by point location.

use super::grid_upload::GpuGrid;
use super::pipeline::{Pipeline, flag};
use super::slabs::Slabs;
use super::volume::Volume;
use crate::render::RenderError;
use crate::render::plan::layout;
use crate::render::plan::volume::volume_info;
use crate::scene::Interpolation;
use crate::view::voxels::Voxel;

/// Loop iterations that a voxel costs, about: bins, column, Newton's method.
pub const VOXEL_WORK: u64 = 8;
/// The same for a packed voxel, of four samples.
const PACKED_WORK: u64 = 20;

/// Fills the first level of a volume with the field that the grid shows; where that ends early, the volume is worth
/// nothing. A packed voxel has coverage and mean value.
///
/// `range` has the values that are stored as 0 and 1.
///
/// # Errors
/// When the device reports an error.
pub async fn fill(
    slabs: &mut Slabs<'_>,
    grid: &GpuGrid,
    volume: &Volume,
    range: [f64; 2],
    interpolation: Interpolation,
) -> Result<(), RenderError> {
    let gpu = slabs.gpu;
    let is_packed = volume.shape.voxel == Voxel::Packed;
    let own = [("PACKED", flag(is_packed))];
    let constants = [&own[..], &grid.constants().pairs()].concat();
    let fill = Pipeline::variant(gpu, "resample", "fill", &constants)?;
    let info = volume_info(&grid.facts, volume.shape.size, range, interpolation);
    gpu.queue
        .write_buffer(&volume.info, 0, bytemuck::bytes_of(&info));
    let grid = grid.bind(gpu);
    let (work, wide) = match is_packed {
        true => (PACKED_WORK, 2),
        false => (VOXEL_WORK, 1),
    };
    let dispatch =
        |encoder: &mut wgpu::CommandEncoder, slab: &layout::Slab, voxels: &wgpu::Buffer| {
            let slab_info = gpu.uniform("slab", slab);
            let own = [
                volume.info.as_entire_binding(),
                slab_info.as_entire_binding(),
                voxels.as_entire_binding(),
            ];
            let groups = [(1, &grid), (3, &gpu.bind(&fill.own, &own))];
            let [width, height, _] = slab.size;
            fill.dispatch(encoder, &groups, [width.div_ceil(wide), height, 1]);
        };
    volume.make_level(slabs, 0, work, &dispatch).await
}
