//! PLTS, point location with topological search: the accurate strategy.
//!
//! Each sample is located exactly by Newton's method on the trilinear map, from the previous sample's
//! cell through shared faces, through the acceleration grid where the topology ends
//! (campagnolo-2021, 4.1.3). Cost: about one Newton iteration a sample inside a cell, a point location
//! at each entry into the model.

use super::RenderStrategy;
use crate::gpu::shader::Pipeline;
use crate::gpu::{Gpu, GpuError};

/// The strategy with its compiled shader.
pub struct Plts {
    pipeline: Pipeline,
}

impl Plts {
    /// Compiles the shader.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            pipeline: Pipeline::new(gpu, "plts")?,
        })
    }
}

impl RenderStrategy for Plts {
    fn pipeline(&self) -> &Pipeline {
        &self.pipeline
    }

    fn encode(&self, pass: &mut wgpu::ComputePass<'_>, size: [u32; 2]) {
        let [x, y, _] = self.pipeline.workgroup;
        pass.set_pipeline(&self.pipeline.pipeline);
        pass.dispatch_workgroups(size[0].div_ceil(x), size[1].div_ceil(y), 1);
    }
}
