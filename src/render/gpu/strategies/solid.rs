//! Solid cells among nothing: their surfaces and sections are all of the picture. No strategy of its own that
//! users choose, for there are no rays to cast.

use std::sync::Arc;

use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::{Pipeline, Place, Round, flag};
use crate::render::job::Work;

/// What blends surfaces and sections, with its shader, compiled when it is first asked for.
#[derive(Default)]
pub struct Solid(Option<Arc<Pipeline>>);

impl RenderStrategy for Solid {
    fn ray_state_bytes(&self) -> u64 {
        0
    }

    fn least_work(&self) -> u64 {
        1
    }

    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()> {
        Box::pin(async move {
            let sections = what.view.shown.clip.iter().any(|plane| plane.opaque);
            let own = [("SECTIONS", flag(sections))];
            let constants: Vec<_> = own.into_iter().chain(Common::of(what).pairs()).collect();
            self.0 = Some(Pipeline::variant(what.gpu, "solid", "main", &constants)?);
            Ok(())
        })
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        if let Some(pipeline) = &self.0 {
            round.compute(encoder, pipeline, None, round.size, Place::Only);
        }
    }
}
