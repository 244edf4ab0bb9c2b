//! SRG, structured resampled grid: the fast strategy for what moves, whatever the cells look like.
//!
//! The field is resampled into a volume of value and presence over the box of the active cells, filled on
//! the device by point location; rays between the first and the last boundary face sample it
//! (campagnolo-2021, 4.1.1). Cost: one texture sample a sample; the volume's bytes; a refill where values
//! or drawn cells change. Faults and thin layers are blurred by about a voxel. Pyramids over the volume
//! shorten the way (volumetric-ray-tracing survey, 8).

use super::{Preparation, RenderStrategy};
use crate::gpu::faces::{BoundaryFaces, FaceMode, FaceTarget};
use crate::gpu::pyramids::{Bricks, Classifier, Limits, PyramidMaker};
use crate::gpu::resample::{Resampler, Slabs, VOXEL_BYTES, Volume};
use crate::gpu::tiles::Pace;
use crate::gpu::{Gpu, GpuBytes, GpuError, Pipeline, Place, Round, Versions};
use crate::model::Dims;
use crate::scene::SrgSettings;
use crate::transfer::TransferFunction;

/// Levels of the average pyramid above the volume, at most: the longest step is of 2^3 samples.
const AVERAGES: u32 = 3;

/// The strategy with its compiled shaders, the volume, and the list of faces.
pub struct Srg {
    begin: Pipeline,
    march: Pipeline,
    variant: Variant,
    resampler: Resampler,
    pyramids: PyramidMaker,
    sampler: wgpu::Sampler,
    faces: BoundaryFaces,
    /// For the first entries and the last exits.
    targets: [Option<FaceTarget>; 2],
    pace: Pace,
    filled: Option<Filled>,
}

/// The volume with its pyramids, and what it was made from.
struct Filled {
    plan: Plan,
    versions: Versions,
    range: [f64; 2],
    volume: Volume,
    bricks: Bricks,
    /// What the bricks are classified for.
    classified: Option<(TransferFunction, Limits, bool)>,
}

/// How large a volume is, and which pyramids it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Plan {
    size: [u32; 3],
    levels: u32,
    has_bricks: bool,
}

impl Plan {
    /// The volume of the wanted factor, or the largest one within a budget.
    fn new(dims: Dims, settings: &SrgSettings, budget: u64, limit: u32) -> Self {
        let size = |factor: f64| {
            let along = |n: usize| (factor * n as f64).round().clamp(1.0, f64::from(limit)) as u32;
            [dims.ni, dims.nj, dims.nk].map(along)
        };
        let mut factor = settings.factor.unwrap_or_else(|| {
            let voxels = budget as f64 / VOXEL_BYTES as f64;
            (voxels / dims.cells() as f64).cbrt()
        });
        // Room for all pyramids is left, used or not, so that switches do not change the resolution.
        while settings.factor.is_none()
            && Self::full(size(factor)).bytes() > budget
            && size(factor) != [1; 3]
        {
            factor *= 0.99;
        }
        let full = Self::full(size(factor));
        Self {
            levels: if settings.thin > 0.0 { full.levels } else { 1 },
            has_bricks: !limits(settings, 1.0).are_never(),
            ..full
        }
    }

    /// With all pyramids.
    fn full(size: [u32; 3]) -> Self {
        let coarsest = size.iter().max().map_or(0, |n| n.ilog2());
        Self {
            size,
            levels: 1 + AVERAGES.min(coarsest),
            has_bricks: true,
        }
    }

    fn bytes(&self) -> u64 {
        let bricks = if self.has_bricks {
            Bricks::bytes(self.size)
        } else {
            0
        };
        Volume::bytes(self.size, self.levels) + bricks
    }
}

/// Limits of the bricks' classes at a sampling step.
fn limits(settings: &SrgSettings, step: f64) -> Limits {
    let limit = |is_on, value| if is_on { value } else { -1.0 };
    Limits {
        empty: limit(settings.skip_empty, 0.0),
        even: limit(settings.even > 0.0, settings.even),
        // From a sample's opacity to extinction.
        thin: limit(settings.thin > 0.0, -(-settings.thin).ln_1p() / step),
    }
}

/// Options that are constants of the pipelines.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Variant {
    sections: bool,
    weighted: bool,
    by_brick: bool,
    long_steps: bool,
    roulette: f64,
}

impl Variant {
    fn compile(self, gpu: &Gpu, entry: &str) -> Result<Pipeline, GpuError> {
        let flag = |value| f64::from(u8::from(value));
        let constants = [
            ("SECTIONS", flag(self.sections)),
            ("WEIGHTED", flag(self.weighted)),
            ("BY_BRICK", flag(self.by_brick)),
            ("LONG_STEPS", flag(self.long_steps)),
            ("ROULETTE", self.roulette),
        ];
        Pipeline::variant(gpu, "srg", entry, &constants)
    }

    fn of(settings: &SrgSettings, sections: bool) -> Self {
        Self {
            sections,
            weighted: settings.weighted,
            by_brick: !limits(settings, 1.0).are_never(),
            long_steps: settings.even > 0.0 || settings.thin > 0.0,
            roulette: settings.roulette,
        }
    }
}

impl Srg {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// When the driver refuses one.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let variant = Variant::of(&SrgSettings::default(), false);
        Ok(Self {
            begin: variant.compile(gpu, "begin")?,
            march: variant.compile(gpu, "march")?,
            variant,
            resampler: Resampler::new(gpu)?,
            pyramids: PyramidMaker::new(gpu)?,
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Nearest,
                ..Default::default()
            }),
            faces: BoundaryFaces::new(gpu)?,
            targets: [None, None],
            pace: Pace::default(),
            filled: None,
        })
    }

    /// Fills the volume anew; false where it was cancelled.
    fn fill(&mut self, what: &Preparation<'_>, plan: Plan) -> Result<bool, GpuError> {
        let mut filled = match self.filled.take() {
            Some(filled) if filled.plan == plan => filled,
            _ => Filled {
                plan,
                versions: what.grid.versions,
                range: [0.0; 2],
                volume: Volume::new(what.gpu, plan.size, plan.levels),
                bricks: Bricks::new(what.gpu, plan.size, plan.has_bricks),
                classified: None,
            },
        };
        let mut slabs = Slabs {
            gpu: what.gpu,
            pace: &mut self.pace,
            progress: what.progress,
        };
        let statistics = what.view.field.statistics();
        filled.range = statistics.map_or([0.0, 1.0], |s| [s.min, s.max]);
        filled.versions = what.grid.versions;
        filled.classified = None;
        let (volume, bricks) = (&filled.volume, &filled.bricks);
        let interpolation = what.view.interpolation;
        let done =
            self.resampler
                .fill(&mut slabs, what.grid, volume, filled.range, interpolation)?
                && self.pyramids.average(&mut slabs, volume, bricks)?
                && (!plan.has_bricks || self.pyramids.summarize(&mut slabs, volume, bricks)?);
        self.filled = done.then_some(filled);
        Ok(done)
    }

    /// Classifies the bricks anew where transfer function or settings have changed.
    fn classify(&mut self, what: &Preparation<'_>) -> Result<(), GpuError> {
        let Some(filled) = &mut self.filled else {
            return Ok(());
        };
        let view = what.view;
        let by = (
            view.transfer.clone(),
            limits(&view.srg, view.sampling_step),
            view.srg.weighted,
        );
        if filled.classified.as_ref() != Some(&by) {
            let classifier = Classifier {
                transfer: &by.0,
                range: filled.range,
                weighted: by.2,
                limits: by.1,
            };
            let (volume, bricks) = (&filled.volume, &filled.bricks);
            self.pyramids
                .classify(what.gpu, volume, bricks, &classifier)?;
            filled.classified = Some(by);
        }
        Ok(())
    }
}

impl RenderStrategy for Srg {
    fn ray_state_bytes(&self) -> u64 {
        32
    }

    /// Samples are cheap beside the drawing of the faces.
    fn least_work(&self) -> u64 {
        32
    }

    fn prepare(&mut self, what: &Preparation<'_>) -> Result<bool, GpuError> {
        let view = what.view;
        let variant = Variant::of(&view.srg, view.clip.iter().any(|plane| plane.opaque));
        if variant != self.variant {
            self.begin = variant.compile(what.gpu, "begin")?;
            self.march = variant.compile(what.gpu, "march")?;
            self.variant = variant;
        }
        self.faces
            .update(what.gpu, what.model, what.grid, &view.drawn, 0.0)?;
        let plan = Plan::new(
            what.model.dims(),
            &view.srg,
            view.srg.budget_bytes(what.gpu.is_software()),
            what.gpu.device.limits().max_texture_dimension_3d,
        );
        let is_fresh = |f: &Filled| f.plan == plan && f.versions == what.grid.versions;
        if !self.filled.as_ref().is_some_and(is_fresh) && !self.fill(what, plan)? {
            return Ok(false);
        }
        self.classify(what)?;
        Ok(true)
    }

    fn bytes(&self) -> GpuBytes {
        GpuBytes {
            geometry: self.faces.bytes(),
            resampled: self.filled.as_ref().map_or(0, |f| f.plan.bytes()),
            ..GpuBytes::default()
        }
    }

    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder) {
        let Some(filled) = &self.filled else {
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
        let mut place = Place::Only;
        if round.starts {
            for (target, mode, place) in [
                (&first, FaceMode::First, Place::First),
                (&last, FaceMode::Last, Place::Between),
            ] {
                self.faces.draw(round, encoder, target, mode, place);
            }
            let own = own(&self.begin);
            round.compute(encoder, &self.begin, Some(&own), round.size, Place::Between);
            place = Place::Last;
        }
        let own = own(&self.march);
        round.compute(encoder, &self.march, Some(&own), round.size, place);
        self.targets = [Some(first), Some(last)];
    }
}
