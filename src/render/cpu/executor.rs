//! The CPU as an executor.

use std::sync::Arc;

use super::renderer::CpuRenderer;
use crate::model::Grid;
use crate::render::{Executor, ExecutorInfo, RenderError, Renderer};

/// The threads of this process.
#[derive(Debug, Clone, Default)]
pub struct CpuExecutor {
    /// Why it stands in for a GPU.
    problem: Option<String>,
}

impl CpuExecutor {
    /// In place of a GPU that could not be opened.
    pub fn instead_of(error: &RenderError) -> Self {
        Self {
            problem: Some(error.to_string()),
        }
    }
}

impl Executor for CpuExecutor {
    fn info(&self) -> ExecutorInfo {
        let threads = rayon::current_num_threads();
        let plural = if threads == 1 { "" } else { "s" };
        ExecutorInfo {
            executor: "cpu",
            adapter: format!("cpu ({threads} thread{plural})"),
            is_software: true,
            problem: self.problem.clone(),
        }
    }

    fn renderer(&self, grid: &Arc<Grid>) -> Result<Box<dyn Renderer>, RenderError> {
        Ok(Box::new(CpuRenderer::new(grid)?))
    }

    fn tidy(&self) -> Result<(), RenderError> {
        Ok(())
    }
}
