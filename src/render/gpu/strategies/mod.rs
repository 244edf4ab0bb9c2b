//! The ray-casting strategies: one host file and one shader each, chosen at run time by name.

pub mod libc;
pub mod plts;
pub mod solid;
pub mod srg;

use super::Gpu;
use super::strategy::RenderStrategy;
use crate::scene::StrategyKind;

/// A strategy on a device; what it needs is compiled when it is first asked for.
pub fn create(kind: StrategyKind, gpu: &Gpu) -> Box<dyn RenderStrategy> {
    match kind {
        StrategyKind::Libc => Box::new(libc::Libc::new(gpu)),
        StrategyKind::Plts => Box::new(plts::Plts::default()),
        StrategyKind::Srg => Box::new(srg::Srg::new(gpu)),
    }
}
