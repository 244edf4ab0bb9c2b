//! PLTS, point location with topological search: the accurate strategy.
//!
//! Each sample is located exactly, by Newton's method on the trilinear map from the previous sample's
//! cell through shared faces (in closed form where all pillars are vertical), and through the
//! acceleration grid where the topology ends (campagnolo-2021, 4.1.3). Cost: about one Newton iteration
//! a sample inside a cell, a point location at each entry into the model.

use std::sync::Arc;

use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::{Pipeline, Place, Round};
use crate::render::job::Work;
use crate::render::plan::layout::RAY_STATE;

/// The strategy with its shader, compiled when it is first asked for.
#[derive(Default)]
pub struct Plts(Option<Arc<Pipeline>>);

impl RenderStrategy for Plts {
    fn ray_state_bytes(&self) -> u64 {
        16 * u64::from(RAY_STATE)
    }

    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()> {
        Box::pin(async move {
            let constants: Vec<_> = Common::of(what).pairs().collect();
            self.0 = Some(Pipeline::variant(what.gpu, "plts", "main", &constants)?);
            Ok(())
        })
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        if let Some(pipeline) = &self.0 {
            round.compute(encoder, pipeline, None, round.size, Place::Only);
        }
    }
}
