//! The GPU as an executor.

use std::sync::Arc;

use super::device::Gpu;
use super::renderer::GpuRenderer;
use crate::model::Grid;
use crate::render::{Executor, ExecutorInfo, RenderError, Renderer};

/// A GPU, or a program on the CPU that acts as one.
pub struct GpuExecutor(Arc<Gpu>);

impl GpuExecutor {
    /// Opens the best adapter, or the best one whose name contains `adapter`; see [`Gpu::new`].
    ///
    /// # Errors
    /// When there is no (such) adapter, or it lacks a limit.
    pub fn new(adapter: Option<&str>) -> Result<Self, RenderError> {
        Ok(Self(Arc::new(Gpu::new(adapter)?)))
    }

    /// The device.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.0
    }
}

impl From<Arc<Gpu>> for GpuExecutor {
    fn from(gpu: Arc<Gpu>) -> Self {
        Self(gpu)
    }
}

impl Executor for GpuExecutor {
    fn info(&self) -> ExecutorInfo {
        ExecutorInfo {
            executor: "gpu",
            adapter: self.0.describe(),
            is_software: self.0.is_software(),
        }
    }

    fn renderer(&self, grid: &Arc<Grid>) -> Result<Box<dyn Renderer>, RenderError> {
        Ok(Box::new(GpuRenderer::new(self.0.clone(), grid)?))
    }

    fn tidy(&self) -> Result<(), RenderError> {
        self.0.wait()
    }
}
