//! The ray-casting strategies: one host file and one shader each, chosen at run time by name.

pub mod plts;

use crate::gpu::shader::Pipeline;
use crate::gpu::{Gpu, GpuError};

/// What a strategy gives to a frame: a pipeline over the common bind groups (0 frame, 1 grid,
/// 2 transfer function) and its dispatches for one tile.
///
/// Implementations are immutable and live as long as the device; all that changes from frame to
/// frame comes through the bind groups.
pub trait RenderStrategy {
    /// The pipeline that the frame's bind groups are made for.
    fn pipeline(&self) -> &Pipeline;

    /// Records the dispatches for a tile of `size` pixels; groups 0 to 2 are set.
    fn encode(&self, pass: &mut wgpu::ComputePass<'_>, size: [u32; 2]);
}

/// Every strategy; the one list that command line, viewer and tests read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrategyKind {
    /// Point location with topological search.
    Plts,
}

impl StrategyKind {
    /// All strategies.
    pub const ALL: [Self; 1] = [Self::Plts];

    /// The name that users type.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plts => "plts",
        }
    }

    /// Compiles the strategy for a device.
    ///
    /// # Errors
    /// When the driver refuses its shader.
    pub fn create(self, gpu: &Gpu) -> Result<Box<dyn RenderStrategy>, GpuError> {
        Ok(match self {
            Self::Plts => Box::new(plts::Plts::new(gpu)?),
        })
    }

    /// The strategy called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// One sentence for a name that is no strategy of this version.
    pub fn refusal(name: &str) -> String {
        let known: Vec<_> = Self::ALL.iter().map(|s| s.name()).collect();
        match name {
            "srg" | "libc" => format!("{name} is not supported yet; use {}", known.join(", ")),
            _ => format!("{name} is not known; use {}", known.join(", ")),
        }
    }
}
