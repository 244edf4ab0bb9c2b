//! The CPU as an executor.

use std::sync::Arc;

use super::renderer::CpuRenderer;
use crate::model::Grid;
use crate::render::{Executor, ExecutorInfo, RenderError, Renderer};

/// The threads of this process.
#[derive(Debug, Clone, Copy, Default)]
pub struct CpuExecutor;

impl Executor for CpuExecutor {
    fn info(&self) -> ExecutorInfo {
        let threads = rayon::current_num_threads();
        let plural = if threads == 1 { "" } else { "s" };
        ExecutorInfo {
            executor: "cpu",
            adapter: format!("cpu ({threads} thread{plural})"),
            is_software: true,
        }
    }

    fn renderer(&self, grid: &Arc<Grid>) -> Result<Box<dyn Renderer>, RenderError> {
        Ok(Box::new(CpuRenderer::new(grid)?))
    }

    fn tidy(&self) -> Result<(), RenderError> {
        Ok(())
    }
}
