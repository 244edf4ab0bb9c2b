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

    /// Opens the best adapter that is no program on the CPU; `None` where there is none that can be used.
    ///
    /// # Errors
    /// When the driver refuses.
    pub fn hardware() -> Result<Option<Self>, RenderError> {
        Ok(Gpu::hardware()?.map(|gpu| Self(Arc::new(gpu))))
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
            problem: None,
        }
    }

    fn renderer(&self, grid: &Arc<Grid>) -> Result<Box<dyn Renderer>, RenderError> {
        Ok(Box::new(GpuRenderer::new(self.0.clone(), grid)?))
    }

    fn tidy(&self) -> Result<(), RenderError> {
        self.0.wait()
    }
}
