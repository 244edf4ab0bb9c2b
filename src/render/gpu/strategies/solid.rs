//! Solid cells among nothing: their surfaces and sections are all of the picture. No strategy of its own that
//! users choose, for there are no rays to cast.

use crate::render::RenderError;
use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::{Gpu, Pipeline, Place, Round, flag};
use crate::render::job::Work;

/// What blends surfaces and sections, with its compiled shader.
pub struct Solid {
    pipeline: Pipeline,
    /// Whether clip planes have opaque sections, and the other constants that it was compiled with.
    constants: (bool, Common),
}

impl Solid {
    /// Compiles the shader.
    ///
    /// # Errors
    /// When the driver refuses it.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        Ok(Self {
            pipeline: Pipeline::new(gpu, "solid")?,
            constants: (false, Common::default()),
        })
    }
}

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
            let constants = (sections, Common::of(what));
            if constants != self.constants {
                let own = [("SECTIONS", flag(sections))];
                let pairs: Vec<_> = own.into_iter().chain(constants.1.pairs()).collect();
                self.pipeline = Pipeline::variant(what.gpu, "solid", "main", &pairs)?;
                self.constants = constants;
            }
            Ok(())
        })
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        round.compute(encoder, &self.pipeline, None, round.size, Place::Only);
    }
}
