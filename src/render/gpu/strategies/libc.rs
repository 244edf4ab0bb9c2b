//! LIBC, linear interpolation with barycentric coordinates: the fast strategy that keeps to the cells.
//!
//! Depth peeling of the boundary faces gives each ray its entries in order; from each the ray walks
//! from cell to cell through faces cut into two triangles, and its parameters are linear between entry
//! and exit of a cell (campagnolo-2021, 4.1.2). Cost: one step a cell, whatever the number of samples;
//! one drawing of the faces a peel.

use crate::render::RenderError;
use crate::render::gpu::faces::{FaceMode, FaceRaster, FaceTarget};
use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::{Gpu, Pipeline, Place, Round, flag, tiles};
use crate::render::job::Work;
use crate::render::plan::layout::LIBC_STATE;
use crate::scene::{Integration, Interpolation, LibcSettings};

/// The strategy with its compiled shaders.
pub struct Libc {
    begin: Pipeline,
    walk: Pipeline,
    set_right: Pipeline,
    variant: Variant,
    faces: FaceRaster,
    target: Option<FaceTarget>,
    /// Rays left before and after a round, in turn.
    rays: [wgpu::Buffer; 2],
    rays_count: wgpu::Buffer,
}

/// Options that are constants of the walk's pipeline.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Variant {
    settings: LibcSettings,
    interpolation: Interpolation,
    common: Common,
}

impl Variant {
    fn compile(self, gpu: &Gpu) -> Result<Pipeline, RenderError> {
        // Many rays a sample are more than a segment can wait for.
        let by_segment =
            self.settings.integration == Integration::Segments && !self.common.casts_rays();
        let own = [
            ("CROSSES", flag(self.settings.cross_faults)),
            ("BY_SEGMENT", flag(by_segment)),
            (
                "BY_VERTEX",
                flag(self.interpolation == Interpolation::Vertex),
            ),
        ];
        let constants: Vec<_> = own.into_iter().chain(self.common.pairs()).collect();
        Pipeline::variant(gpu, "libc", "walk", &constants)
    }
}

impl Libc {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// When the driver refuses one.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        let variant = Variant {
            settings: LibcSettings::default(),
            interpolation: Interpolation::Vertex,
            common: Common::default(),
        };
        Ok(Self {
            begin: Pipeline::variant(gpu, "libc", "begin", &[])?,
            walk: variant.compile(gpu)?,
            set_right: Pipeline::variant(gpu, "libc", "set_right", &[])?,
            variant,
            faces: FaceRaster::new(gpu)?,
            target: None,
            rays: [0, 1].map(|_| gpu.scratch("rays left", 4 * tiles::MAX_AREA)),
            rays_count: gpu.scratch("number of rays left", 16),
        })
    }
}

/// What a dispatch does beside taking rays further.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Nothing: paused rays go on.
    GoesOn,
    /// Takes the entries just drawn.
    Enters,
}

impl RenderStrategy for Libc {
    fn ray_state_bytes(&self) -> u64 {
        16 * u64::from(LIBC_STATE)
    }

    /// Drawing the faces costs the same for small tiles and large ones.
    fn least_work(&self) -> u64 {
        32
    }

    fn draws_faces(&self) -> bool {
        true
    }

    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()> {
        Box::pin(async move {
            let variant = Variant {
                settings: what.view.sampling.libc,
                interpolation: what.view.shown.cells.interpolation,
                common: Common::of(what),
            };
            if variant != self.variant {
                if variant.common != self.variant.common {
                    let common: Vec<_> = variant.common.pairs().collect();
                    self.begin = Pipeline::variant(what.gpu, "libc", "begin", &common)?;
                    self.set_right = Pipeline::variant(what.gpu, "libc", "set_right", &common)?;
                }
                self.walk = variant.compile(what.gpu)?;
                self.variant = variant;
            }
            let margin = match what.grid.facts.layers_cross {
                // Cells may overlap anywhere: every entry counts.
                true => f32::MAX,
                false => what.view.fault_gap() as f32,
            };
            self.faces.update(what.gpu, what.faces, margin);
            Ok(())
        })
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        let target = FaceTarget::fitting(self.target.take(), round.gpu, round.size);
        let [before, after] = &self.rays;
        let record = |encoder: &mut _, pipeline: &Pipeline, stage: Stage, size, place| {
            let stage = round
                .gpu
                .uniform("stage", &[stage as u32, round.rays_left, 0, 0]);
            let own = [
                stage.as_entire_binding(),
                wgpu::BindingResource::TextureView(&target.met),
                before.as_entire_binding(),
                after.as_entire_binding(),
                self.rays_count.as_entire_binding(),
            ];
            let own = round.gpu.bind(&pipeline.own, &own);
            round.compute(encoder, pipeline, Some(&own), size, place);
        };
        let rays = [round.rays_left, 1];
        encoder.clear_buffer(&self.rays_count, 0, None);
        if round.starts {
            record(encoder, &self.begin, Stage::GoesOn, round.size, Place::Only);
        } else if round.paused > 0 {
            let mut place = Place::Only;
            if round.strayed > 0 {
                record(encoder, &self.set_right, Stage::GoesOn, rays, Place::First);
                place = Place::Last;
            }
            record(encoder, &self.walk, Stage::GoesOn, rays, place);
        } else {
            self.faces
                .draw(round, encoder, &target, FaceMode::Peel, Place::First);
            record(encoder, &self.walk, Stage::Enters, rays, Place::Last);
        }
        self.rays.swap(0, 1);
        self.target = Some(target);
    }
}
