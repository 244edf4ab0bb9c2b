//! LIBC, linear interpolation with barycentric coordinates: the fast strategy that keeps to the cells.
//!
//! Depth peeling of the boundary faces gives each ray its entries in order; from each the ray walks
//! from cell to cell through faces cut into two triangles, and its parameters are linear between entry
//! and exit of a cell (campagnolo-2021, 4.1.2). Cost: one step a cell, whatever the number of samples;
//! one drawing of the faces a peel.

use std::sync::Arc;

use crate::render::RenderError;
use crate::render::gpu::faces::{FaceMode, FaceRaster, FaceTarget};
use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::{Gpu, Pipeline, Place, Round, flag, tiles};
use crate::render::job::Work;
use crate::render::plan::layout::LIBC_STATE;
use crate::scene::{Integration, Interpolation, LibcSettings};

/// The strategy with its compiled shaders.
pub struct Libc {
    /// Compiled when they are first asked for.
    pipelines: Option<Pipelines>,
    faces: FaceRaster,
    target: Option<FaceTarget>,
    /// Number of rays that are left after a round, and the lists of those before and after it.
    rays: wgpu::Buffer,
    /// The list of those before a round; the other one is of those after it, in turn.
    list: u32,
}

struct Pipelines {
    begin: Arc<Pipeline>,
    walk: Arc<Pipeline>,
    set_right: Arc<Pipeline>,
}

/// Bytes of the number of rays left.
const COUNT_BYTES: u64 = 4;

/// Options that are constants of the walk's pipeline.
#[derive(Debug, Clone, Copy)]
struct Variant {
    settings: LibcSettings,
    interpolation: Interpolation,
    common: Common,
}

impl Variant {
    fn compile(self, gpu: &Gpu) -> Result<Pipelines, RenderError> {
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
        let common: Vec<_> = self.common.pairs().collect();
        let all = [&own[..], &common].concat();
        let wanted: [(_, &[_]); 3] = [("begin", &common), ("walk", &all), ("set_right", &common)];
        let [begin, walk, set_right] = Pipeline::variants(gpu, "libc", wanted);
        Ok(Pipelines {
            begin: begin?,
            walk: walk?,
            set_right: set_right?,
        })
    }
}

impl Libc {
    /// Without rays yet.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            pipelines: None,
            faces: FaceRaster::default(),
            target: None,
            rays: gpu.scratch("rays left", COUNT_BYTES + 2 * 4 * tiles::MAX_AREA),
            list: 0,
        }
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

    fn needs_faces(&self) -> bool {
        true
    }

    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()> {
        Box::pin(async move {
            let variant = Variant {
                settings: what.view.sampling.libc,
                interpolation: what.view.shown.cells.interpolation,
                common: Common::of(what),
            };
            self.pipelines = Some(variant.compile(what.gpu)?);
            let margin = match what.grid.facts.layers_cross {
                // Cells may overlap anywhere: every entry counts.
                true => f32::MAX,
                false => what.view.fault_gap() as f32,
            };
            let constants = what.grid.constants();
            self.faces.update(what.gpu, constants, what.faces, margin)
        })
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        let Some(pipelines) = &self.pipelines else {
            return;
        };
        let target = FaceTarget::fitting(self.target.take(), round.gpu, round.size);
        let [before, after] = [self.list, 1 - self.list].map(|n| n * tiles::MAX_AREA as u32);
        let record = |encoder: &mut _, pipeline: &Pipeline, stage: Stage, size, place| {
            let stage = round
                .gpu
                .uniform("stage", &[stage as u32, round.rays_left, before, after]);
            let own = [
                stage.as_entire_binding(),
                wgpu::BindingResource::TextureView(&target.met),
                self.rays.as_entire_binding(),
            ];
            let own = round.gpu.bind(&pipeline.own, &own);
            round.compute(encoder, pipeline, Some(&own), size, place);
        };
        let rays = [round.rays_left, 1];
        encoder.clear_buffer(&self.rays, 0, Some(COUNT_BYTES));
        if round.starts {
            record(
                encoder,
                &pipelines.begin,
                Stage::GoesOn,
                round.size,
                Place::Only,
            );
        } else if round.paused > 0 {
            let mut place = Place::Only;
            if round.strayed > 0 {
                record(
                    encoder,
                    &pipelines.set_right,
                    Stage::GoesOn,
                    rays,
                    Place::First,
                );
                place = Place::Last;
            }
            record(encoder, &pipelines.walk, Stage::GoesOn, rays, place);
        } else {
            self.faces
                .draw(round, encoder, &target, FaceMode::Peel, Place::First);
            record(encoder, &pipelines.walk, Stage::Enters, rays, Place::Last);
        }
        self.list = 1 - self.list;
        self.target = Some(target);
    }
}
