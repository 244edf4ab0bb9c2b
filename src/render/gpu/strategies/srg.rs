//! SRG, structured resampled grid: the fast strategy for what moves, whatever the cells look like.
//!
//! The field is resampled into a volume of value and presence over the box of the active cells, filled on
//! the device by point location; rays between the first and the last boundary face sample it
//! (campagnolo-2021, 4.1.1). Cost: one texture sample a sample; the volume's bytes; a refill where values
//! or drawn cells change. Faults and thin layers are blurred by about a voxel. Pyramids over the volume
//! shorten the way (volumetric-ray-tracing survey, 8).

use std::sync::Arc;

use crate::render::gpu::faces::{FaceMode, FaceRaster, FaceTarget};
use crate::render::gpu::pyramids::{self, Bricks};
use crate::render::gpu::resample;
use crate::render::gpu::slabs::Slabs;
use crate::render::gpu::strategy::{Common, Preparation, RenderStrategy};
use crate::render::gpu::tiles::Pace;
use crate::render::gpu::volume::Volume;
use crate::render::gpu::{Gpu, Pipeline, Place, Round, flag};
use crate::render::job::Work;
use crate::render::plan::bricks::{Classifier, Limits};
use crate::render::plan::layout::RAY_STATE;
use crate::render::plan::srg::{limits, shape, useful};
use crate::render::{DeviceBytes, RenderError};
use crate::scene::SrgSettings;
use crate::transfer::TransferFunction;
use crate::view::voxels::Shape;

/// The strategy with its compiled shaders, and the volume.
pub struct Srg {
    /// What begins rays and what takes them further, compiled when they are first asked for.
    pipelines: Option<[Arc<Pipeline>; 2]>,
    sampler: wgpu::Sampler,
    faces: FaceRaster,
    /// For the first entries and the last exits.
    targets: [Option<FaceTarget>; 2],
    pace: Pace,
    fills: u64,
    filled: Option<Filled>,
}

/// The volume with its pyramids, and what they were made from.
struct Filled {
    /// Of the values.
    revision: u64,
    /// Values that are stored as 0 and 1.
    range: [f64; 2],
    volume: Volume,
    bricks: Bricks,
    /// What the bricks are classified for.
    classified: Option<(TransferFunction, Limits, bool)>,
}

/// Options that are constants of the pipelines.
#[derive(Debug, Clone, Copy)]
struct Variant {
    sections: bool,
    weighted: bool,
    by_brick: bool,
    long_steps: bool,
    roulette: f64,
    common: Common,
}

impl Variant {
    fn compile(self, gpu: &Gpu) -> Result<[Arc<Pipeline>; 2], RenderError> {
        let own = [
            ("SECTIONS", flag(self.sections)),
            ("WEIGHTED", flag(self.weighted)),
            ("BY_BRICK", flag(self.by_brick)),
            ("LONG_STEPS", flag(self.long_steps)),
            ("ROULETTE", self.roulette),
        ];
        let constants: Vec<_> = own.into_iter().chain(self.common.pairs()).collect();
        let wanted: [(_, &[_]); 2] = [("begin", &constants), ("march", &constants)];
        let [begin, march] = Pipeline::variants(gpu, "srg", wanted);
        Ok([begin?, march?])
    }

    fn of(settings: &SrgSettings, sections: bool, common: Common) -> Self {
        Self {
            sections,
            weighted: settings.weighted,
            by_brick: !limits(settings, 1.0).are_never(),
            long_steps: settings.even > 0.0 || settings.thin > 0.0,
            roulette: settings.roulette,
            common,
        }
    }
}

impl Srg {
    /// Without a volume yet.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            pipelines: None,
            sampler: gpu.linear_sampler(),
            faces: FaceRaster::default(),
            targets: [None, None],
            pace: Pace::default(),
            fills: 0,
            filled: None,
        }
    }

    /// Number of times that the volume was filled.
    pub fn fills(&self) -> u64 {
        self.fills
    }

    /// Fills the volume anew where values, cells or shape have changed.
    async fn fill(&mut self, what: &Preparation<'_>, shape: Shape) -> Result<(), RenderError> {
        let filled = self.filled.take().filter(|f| f.volume.shape == shape);
        let revision = what.grid.revisions.values;
        if filled.as_ref().is_some_and(|f| f.revision == revision) {
            self.filled = filled;
            return Ok(());
        }
        let volume = filled.map_or_else(|| Volume::new(what.gpu, shape), |f| f.volume);
        let range = what.view.shown.cells.value_range().unwrap_or([0.0, 1.0]);
        let bricks = Bricks::unused(what.gpu, shape.size);
        let mut slabs = slabs(what, &mut self.pace);
        let interpolation = what.view.shown.cells.interpolation;
        resample::fill(&mut slabs, what.grid, &volume, range, interpolation).await?;
        pyramids::average(&mut slabs, &volume, &bricks).await?;
        self.fills += 1;
        self.filled = Some(Filled {
            revision,
            range,
            volume,
            bricks,
            classified: None,
        });
        Ok(())
    }

    /// Makes the bricks where they are asked for and not there, and classifies them anew where transfer
    /// function or settings have changed.
    async fn classify(
        &mut self,
        what: &Preparation<'_>,
        settings: &SrgSettings,
    ) -> Result<(), RenderError> {
        let Some(filled) = &mut self.filled else {
            return Ok(());
        };
        let limits = limits(settings, what.view.sampling.step);
        if !limits.are_never() && !filled.bricks.are_used() {
            let bricks = Bricks::new(what.gpu, filled.volume.shape.size);
            let mut slabs = slabs(what, &mut self.pace);
            pyramids::summarize(&mut slabs, &filled.volume, &bricks).await?;
            filled.bricks = bricks;
            filled.classified = None;
        }
        let by = (what.view.style.transfer.clone(), limits, settings.weighted);
        if filled.classified.as_ref() != Some(&by) {
            let classifier = Classifier {
                transfer: &by.0,
                range: filled.range,
                limits,
                weighted: settings.weighted,
            };
            let (volume, bricks) = (&filled.volume, &filled.bricks);
            pyramids::classify(what.gpu, volume, bricks, &classifier)?;
            filled.classified = Some(by);
        }
        Ok(())
    }
}

fn slabs<'a>(what: &Preparation<'a>, pace: &'a mut Pace) -> Slabs<'a> {
    Slabs {
        gpu: what.gpu,
        pace,
        progress: what.progress,
    }
}

impl RenderStrategy for Srg {
    fn ray_state_bytes(&self) -> u64 {
        16 * u64::from(RAY_STATE)
    }

    /// Samples are cheap beside the drawing of the faces.
    fn least_work(&self) -> u64 {
        12
    }

    fn needs_faces(&self) -> bool {
        true
    }

    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()> {
        Box::pin(async move {
            let view = what.view;
            let settings = useful(view);
            let sections = view.shown.clip.iter().any(|plane| plane.opaque);
            let variant = Variant::of(&settings, sections, Common::of(what));
            self.pipelines = Some(variant.compile(what.gpu)?);
            let constants = what.grid.constants();
            self.faces.update(what.gpu, constants, what.faces, 0.0)?;
            let budget = settings.budget_bytes();
            let limit = what.gpu.device.limits().max_texture_dimension_3d;
            let ghosts = view.shown.cells.ghosts.is_some();
            let shape = shape(what.model.main_dims(), &settings, ghosts, budget, limit);
            self.fill(what, shape).await?;
            self.classify(what, &settings).await
        })
    }

    fn bytes(&self) -> DeviceBytes {
        let volume = |f: &Filled| f.volume.shape.bytes() + f.bricks.bytes();
        DeviceBytes {
            resampled: self.filled.as_ref().map_or(0, volume),
            ..DeviceBytes::default()
        }
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        let (Some(filled), Some([begin, march])) = (&self.filled, &self.pipelines) else {
            return;
        };
        let [first, last] = std::array::from_fn(|n| {
            FaceTarget::fitting(self.targets[n].take(), round.gpu, round.size)
        });
        let voxels = filled.volume.texture.create_view(&Default::default());
        let own = |pipeline: &Pipeline| {
            let resources = [
                filled.volume.info.as_entire_binding(),
                filled.bricks.info.as_entire_binding(),
                wgpu::BindingResource::TextureView(&voxels),
                wgpu::BindingResource::Sampler(&self.sampler),
                filled.bricks.passes.as_entire_binding(),
                wgpu::BindingResource::TextureView(&first.met),
                wgpu::BindingResource::TextureView(&last.met),
            ];
            round.gpu.bind(&pipeline.own, &resources)
        };
        // Faces are drawn in a round of their own: how long that takes says nothing of the rays' pace.
        if round.starts {
            for (target, mode, place) in [
                (&first, FaceMode::First, Place::First),
                (&last, FaceMode::Last, Place::Between),
            ] {
                self.faces.draw(round, encoder, target, mode, place);
            }
            let own = own(begin);
            round.compute(encoder, begin, Some(&own), round.size, Place::Last);
        } else {
            let own = own(march);
            round.compute(encoder, march, Some(&own), round.size, Place::Only);
        }
        self.targets = [Some(first), Some(last)];
    }
}
