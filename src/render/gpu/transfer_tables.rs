//! The transfer function on the device.

use super::cube::GpuCube;
use super::device::Gpu;
use crate::render::RenderError;
use crate::render::plan::transfer::{transfer_integrals, transfer_table};
use crate::view::View;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Its table and the integrals over it, for one transfer function and blending.
pub struct TransferTables {
    /// See [`crate::render::revisions::Revisions::transfer`].
    pub revision: u64,
    /// Color, as it is blended, and extinction at equal distances over the range.
    pub table: wgpu::TextureView,
    /// Integrals over the position of extinction times color, and of extinction.
    pub integrals: wgpu::TextureView,
    /// Voxels and table of a cube beside the model, or what is bound without one.
    pub cube: [wgpu::TextureView; 2],
}

impl TransferTables {
    /// Uploads the tables.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(gpu: &Gpu, view: &View, cube: &GpuCube, revision: u64) -> Result<Self, RenderError> {
        let table = transfer_table(view);
        Ok(Self {
            integrals: gpu.table("transfer integrals", FORMAT, &transfer_integrals(&table))?,
            table: gpu.table("transfer table", FORMAT, &table)?,
            cube: cube.views(),
            revision,
        })
    }
}
