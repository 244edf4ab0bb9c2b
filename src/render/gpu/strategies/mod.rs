//! The ray-casting strategies: one host file and one shader each, chosen at run time by name.

pub mod libc;
pub mod plts;
pub mod solid;
pub mod srg;

use super::Gpu;
use super::strategy::RenderStrategy;
use crate::render::RenderError;
use crate::scene::StrategyKind;

/// Compiles a strategy for a device.
///
/// # Errors
/// When the driver refuses its shader.
pub fn create(kind: StrategyKind, gpu: &Gpu) -> Result<Box<dyn RenderStrategy>, RenderError> {
    Ok(match kind {
        StrategyKind::Libc => Box::new(libc::Libc::new(gpu)?),
        StrategyKind::Plts => Box::new(plts::Plts::default()),
        StrategyKind::Srg => Box::new(srg::Srg::new(gpu)?),
    })
}
