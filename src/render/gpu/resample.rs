//! Fills volumes with a field by point location.

use super::device::Gpu;
use super::grid_upload::{Constants, GpuGrid};
use super::pipeline::{Pipeline, flag};
use super::slabs::Slabs;
use super::volume::Volume;
use crate::render::RenderError;
use crate::render::plan::layout;
use crate::render::plan::volume::volume_info;
use crate::scene::Interpolation;

/// Loop iterations that a voxel costs, about: bins, column, Newton's method.
pub const VOXEL_WORK: u64 = 8;
/// The same for a packed voxel, of four samples.
const PACKED_WORK: u64 = 20;

/// Fills volumes by point location.
pub struct Resampler {
    fill: Pipeline,
    /// Constants that it was compiled with.
    constants: Constants,
    /// Volumes have packed voxels.
    packed: bool,
}

impl Resampler {
    /// Compiles the shader for volumes of a field, or for those of packed voxels.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu, packed: bool) -> Result<Self, RenderError> {
        let constants = Constants::default();
        Ok(Self {
            fill: compile(gpu, constants, packed)?,
            constants,
            packed,
        })
    }

    /// Fills the first level of a volume with the field that the grid shows; where that ends early, the volume is
    /// worth nothing. A packed voxel has coverage and mean value.
    ///
    /// `range` has the values that are stored as 0 and 1.
    ///
    /// # Errors
    /// When the device reports an error.
    pub async fn fill(
        &mut self,
        slabs: &mut Slabs<'_>,
        grid: &GpuGrid,
        volume: &Volume,
        range: [f64; 2],
        interpolation: Interpolation,
    ) -> Result<(), RenderError> {
        let gpu = slabs.gpu;
        let constants = grid.constants();
        if constants != self.constants {
            self.fill = compile(gpu, constants, self.packed)?;
            self.constants = constants;
        }
        let info = volume_info(&grid.facts, volume.shape.size, range, interpolation);
        gpu.queue
            .write_buffer(&volume.info, 0, bytemuck::bytes_of(&info));
        let grid = grid.bind(gpu);
        let work = if self.packed { PACKED_WORK } else { VOXEL_WORK };
        let dispatch =
            |encoder: &mut wgpu::CommandEncoder, slab: &layout::Slab, voxels: &wgpu::Buffer| {
                let slab_info = gpu.uniform("slab", slab);
                let own = [
                    volume.info.as_entire_binding(),
                    slab_info.as_entire_binding(),
                    voxels.as_entire_binding(),
                ];
                let groups = [(1, &grid), (3, &gpu.bind(&self.fill.own, &own))];
                let [width, height, _] = slab.size;
                let wide = if self.packed { 2 } else { 1 };
                let size = [width.div_ceil(wide), height, 1];
                self.fill.dispatch(encoder, &groups, size);
            };
        volume.make_level(slabs, 0, work, &dispatch).await
    }
}

fn compile(gpu: &Gpu, constants: Constants, packed: bool) -> Result<Pipeline, RenderError> {
    let own = [("PACKED", flag(packed))];
    let constants: Vec<_> = own.into_iter().chain(constants.pairs()).collect();
    Pipeline::variant(gpu, "resample", "fill", &constants)
}
