//! PLTS, point location with topological search: the accurate strategy.
//!
//! Each sample is located exactly, by Newton's method on the trilinear map from the previous sample's
//! cell through shared faces (in closed form where all pillars are vertical), and through the
//! acceleration grid where the topology ends (campagnolo-2021, 4.1.3). Cost: about one Newton iteration
//! a sample inside a cell, a point location at each entry into the model.

use crate::render::RenderError;
use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::{Gpu, Pipeline, Place, Round};
use crate::render::job::Work;
use crate::render::plan::layout::RAY_STATE;

/// The strategy with its compiled shader.
pub struct Plts {
    pipeline: Pipeline,
    /// Constants that it was compiled with.
    constants: Common,
}

impl Plts {
    /// Compiles the shader.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            pipeline: Pipeline::new(gpu, "plts")?,
            constants: Common::default(),
        })
    }
}

impl RenderStrategy for Plts {
    fn ray_state_bytes(&self) -> u64 {
        16 * u64::from(RAY_STATE)
    }

    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()> {
        Box::pin(async move {
            let constants = Common::of(what);
            if constants != self.constants {
                let pairs: Vec<_> = constants.pairs().collect();
                self.pipeline = Pipeline::variant(what.gpu, "plts", "main", &pairs)?;
                self.constants = constants;
            }
            Ok(())
        })
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        round.compute(encoder, &self.pipeline, None, round.size, Place::Only);
    }
}
