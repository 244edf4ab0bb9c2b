//! Light for the rays: emitters with their cones, the extinction pyramid, light volumes, gradients.
//!
//! What is made follows the scene: a volume of values follows cells and values; the pyramid follows that,
//! transfer function and clip planes; a light volume follows the pyramid and its emitter, which for occlusion
//! is the camera (campagnolo-2021, 3.3.3).

use std::time::Instant;

use super::device::Gpu;
use super::extinction::{Pyramid, PyramidSource};
use super::grid_upload::GpuGrid;
use super::pipeline::{Pipeline, flag};
use super::resample;
use super::sat::Sums;
use super::slabs::Slabs;
use super::tiles::Pace;
use super::transfer_tables::TransferTables;
use super::vct::{ValueOpacities, ValuePyramid};
use super::volume::{Volume, of_bytes};
use crate::model::Grid;
use crate::render::RenderError;
use crate::render::job::Progress;
use crate::render::plan::around::shells;
use crate::render::plan::extinction::Blur;
use crate::render::plan::layout::{
    Emitter, LIGHT_IMAGE, LightingInfo, METHOD_CONES, METHOD_SAT, METHOD_SPAO_MIPMAP,
    METHOD_SURROUND, METHOD_VCT, Slab,
};
use crate::render::plan::light::{Emitters, Shading};
use crate::render::plan::occluders::Occluders;
use crate::render::revisions::Revisions;
use crate::render::stats::LightTimes;
use crate::scene::lighting::LightMethod;
use crate::view::View;
use crate::view::voxels::{Shape, Voxel};

/// How often each part has been made. The numbers never fall, so that what was made from a part that a
/// canceled update has dropped is stale for good.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Made {
    /// Fillings of the volume of values.
    pub fields: u64,
    /// Extinction pyramids.
    pub pyramids: u64,
    /// Opacities, and their means.
    pub means: u64,
    /// Pyramids of values.
    pub value_pyramids: u64,
    /// Opacities of what these hold.
    pub value_opacities: u64,
    /// Summed-area tables.
    pub sums: u64,
    /// Light volumes, each emitter's counted by itself.
    pub light_volumes: u64,
}

/// Makes light and keeps it up to date.
pub struct Illumination {
    sampler: wgpu::Sampler,
    pace: Pace,
    /// What is bound where there is no volume.
    nothing: [Volume; 4],
    info: wgpu::Buffer,
    /// Emitters, and the sections of their cones.
    emitters: wgpu::TextureView,
    work: u32,
    field: Option<Field>,
    pyramid: Option<Pyramid>,
    values: Option<ValuePyramid>,
    of_values: Option<ValueOpacities>,
    sums: Option<Sums>,
    /// What is bound where there are no opacities of values.
    no_table: wgpu::TextureView,
    /// Opacities without any blur, for rays over cones, and their means where they are asked for.
    opacities: Option<Pyramid>,
    lights: Option<LightVolumes>,
    gradients: Option<Gradients>,
    /// What the last update took.
    pub times: LightTimes,
    /// What all updates have made.
    pub made: Made,
}

/// The volume of values that extinction is made from.
struct Field {
    revision: u64,
    /// Values at both ends of the range that is stored.
    range: [f64; 2],
    volume: Volume,
}

/// One volume for each emitter whose light is found before the rays, one above the other.
struct LightVolumes {
    volume: Volume,
    size: [u32; 3],
    /// What each was made from.
    made: Vec<Option<Lit>>,
}

#[derive(Clone, PartialEq)]
struct Lit {
    method: LightMethod,
    per_shell: bool,
    /// Which pyramid, or which mean opacities.
    pyramid: u64,
    emitter: Emitter,
    sections: Vec<[f32; 4]>,
}

struct Gradients {
    volume: Volume,
    revision: u64,
}

/// Loop iterations of the rays over a cone, at most, on an adapter in software: llvmpipe ends a shader with
/// 65,535 without a word, and eight rays side by side may all do theirs one after the other.
const MOST_RAY_WORK: f64 = 7_500.0;
/// Loop iterations that a voxel of light from shells costs, about.
const SHELLS_WORK: u64 = 12;
/// Loop iterations that a voxel of the gradient costs, about.
const GRADIENT_WORK: u64 = 60;

impl Illumination {
    /// No light yet.
    ///
    /// # Errors
    /// When the device refuses a table.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        let none: [LightingInfo; 1] = bytemuck::Zeroable::zeroed();
        let one = |voxel| Shape {
            voxel,
            ..Shape::single([1; 3], 1)
        };
        Ok(Self {
            sampler: gpu.linear_sampler(),
            pace: Pace::default(),
            nothing: [Voxel::Single, Voxel::Packed, Voxel::Quad, Voxel::Word]
                .map(|v| Volume::new(gpu, one(v))),
            info: gpu.uniform("lighting", &none),
            emitters: gpu.table::<u32>("emitters", wgpu::TextureFormat::Rgba32Uint, &[])?,
            work: 0,
            field: None,
            pyramid: None,
            values: None,
            of_values: None,
            sums: None,
            no_table: gpu.table::<f32>("nothing", wgpu::TextureFormat::Rgba32Float, &[])?,
            opacities: None,
            lights: None,
            gradients: None,
            times: LightTimes::default(),
            made: Made::default(),
        })
    }

    /// Brings the light of a view of a case's grid up to date.
    ///
    /// # Errors
    /// When a volume exceeds what the adapter holds, or the device reports an error.
    pub async fn update(
        &mut self,
        gpu: &Gpu,
        (model, grid): (&Grid, &GpuGrid),
        view: &View,
        tables: &TransferTables,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        self.times = LightTimes::default();
        if !Shading::of(&view.style.lighting).is_on() {
            self.work = 0;
            self.forget();
            return Ok(());
        }
        let start = Instant::now();
        self.fill(gpu, grid, view, progress).await?;
        self.times.field = start.elapsed();
        let start = Instant::now();
        self.blur(gpu, (model, grid), view, tables, progress)
            .await?;
        self.hold_values(gpu, grid, view, tables, progress).await?;
        self.times.extinction = start.elapsed();
        let start = Instant::now();
        let emitters = Emitters::new(&grid.facts, view);
        check_rays(gpu, view, &emitters)?;
        self.upload(gpu, grid, view, &emitters)?;
        self.illuminate(gpu, view, tables, &emitters, progress)
            .await?;
        self.slope(gpu, grid, view, tables, progress).await?;
        self.times.volumes = start.elapsed();
        Ok(())
    }

    /// Fills the volume of values where cells, values or sizes have changed.
    async fn fill(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
        view: &View,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let shape = Shape {
            voxel: Voxel::Packed,
            ..Shape::single(view.style.lighting.size(), 1)
        };
        let before = self.field.take();
        let before = before.filter(|f| f.volume.shape == shape);
        if before
            .as_ref()
            .is_some_and(|f| f.revision == grid.revisions.values)
        {
            self.field = before;
            return Ok(());
        }
        check_size(gpu, shape.size)?;
        let volume = before.map_or_else(|| Volume::new(gpu, shape), |f| f.volume);
        let range = view.shown.cells.value_range().unwrap_or([0.0, 1.0]);
        let mut slabs = Slabs::new(gpu, &mut self.pace, progress);
        let interpolation = view.shown.cells.interpolation;
        resample::fill(&mut slabs, grid, &volume, range, interpolation).await?;
        self.made.fields += 1;
        self.field = Some(Field {
            revision: grid.revisions.values,
            range,
            volume,
        });
        Ok(())
    }

    /// Makes the pyramid where the values, the transfer function, the clip planes or what stands in the way beside
    /// cells have changed.
    async fn blur(
        &mut self,
        gpu: &Gpu,
        (model, grid): (&Grid, &GpuGrid),
        view: &View,
        tables: &TransferTables,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let Some(field) = &self.field else {
            return Ok(());
        };
        let revision = grid.revisions.extinction;
        let shading = Shading::of(&view.style.lighting);
        let is_stale =
            |made: &Option<Pyramid>| made.as_ref().is_none_or(|p| p.revision != revision);
        let group = self.bind(gpu, tables);
        let mut slabs = Slabs::new(gpu, &mut self.pace, progress);
        let means = match shading.averages() {
            true => shells(&view.style.lighting),
            false => 0,
        };
        let levels = Shape::single(view.style.lighting.size(), 1 + means).levels;
        let has_other_levels =
            |o: &Option<Pyramid>| o.as_ref().is_none_or(|o| o.levels() != levels);
        let uses_opacities = shading.casts_rays() || shading.averages();
        if !uses_opacities {
            self.opacities = None;
        }
        if !shading.traces_cones() {
            self.pyramid = None;
        }
        let wants_opacities =
            uses_opacities && (is_stale(&self.opacities) || has_other_levels(&self.opacities));
        let wants_cones = shading.traces_cones() && is_stale(&self.pyramid);
        let blur = Blur::new(&grid.facts, view, field.range);
        let has_sums = |s: &Sums| s.revision == revision && s.counts == blur.counts;
        let wants_sums = shading.sums() && !self.sums.as_ref().is_some_and(has_sums);
        if !shading.sums() {
            self.sums = None;
        }
        if !wants_opacities && !wants_cones && !wants_sums {
            return Ok(());
        }
        let occluders = Occluders::of(&grid.facts, view, model);
        let upload = |some: &Occluders, format| of_bytes(gpu, format, some.size, &some.opacities);
        let source = PyramidSource {
            revision,
            blur,
            occluders: match &occluders {
                Some(some) => upload(some, wgpu::TextureFormat::R8Unorm),
                None => self.nothing[0].level(0),
            },
        };
        if wants_opacities {
            let before = self.opacities.take();
            let made = Pyramid::make_sharp(&mut slabs, &source, &group, means, before);
            self.opacities = Some(made.await?);
            self.made.means += 1;
        }
        if wants_sums {
            self.sums = None;
            let occluders = match &occluders {
                Some(some) => upload(some, wgpu::TextureFormat::R8Uint),
                None => self.nothing[3].level(0),
            };
            let made = Sums::make(&mut slabs, (&blur, &occluders), revision, &group);
            self.sums = Some(made.await?);
            self.made.sums += 1;
        }
        if wants_cones {
            let before = self.pyramid.take();
            let made = Pyramid::make(&mut slabs, &source, &group, before);
            self.pyramid = Some(made.await?);
            self.made.pyramids += 1;
        }
        Ok(())
    }

    /// Makes the pyramid of values where values or clip planes have changed, and the table of their opacities where the
    /// transfer function has.
    async fn hold_values(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
        view: &View,
        tables: &TransferTables,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let is_used = Shading::of(&view.style.lighting).traces_values();
        let Some(field) = self.field.as_ref().filter(|_| is_used) else {
            self.values = None;
            self.of_values = None;
            return Ok(());
        };
        let range = field.range;
        let Revisions {
            placed, extinction, ..
        } = grid.revisions;
        if self.values.as_ref().is_none_or(|v| v.revision != placed) {
            let blur = Blur::new(&grid.facts, view, range);
            let before = self.values.take();
            let group = self.bind(gpu, tables);
            let mut slabs = Slabs::new(gpu, &mut self.pace, progress);
            let made = ValuePyramid::make(&mut slabs, &blur, placed, &group, before);
            self.values = Some(made.await?);
            self.made.value_pyramids += 1;
        }
        let known = self.of_values.as_ref();
        if known.is_none_or(|o| o.revision != extinction) {
            self.of_values = Some(ValueOpacities::new(gpu, view, range, extinction)?);
            self.made.value_opacities += 1;
        }
        Ok(())
    }

    /// Uploads what shaders need to know.
    fn upload(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
        view: &View,
        emitters: &Emitters,
    ) -> Result<(), RenderError> {
        let range = self.field.as_ref().map_or([0.0, 1.0], |f| f.range);
        let levels = self.pyramid.as_ref().map_or(1, Pyramid::levels);
        let info = emitters.info(&grid.facts, view, levels, range);
        self.info = gpu.uniform("lighting", &info);
        let texels = emitters.texels();
        self.emitters = gpu.table("emitters", wgpu::TextureFormat::Rgba32Uint, &texels)?;
        self.work = emitters.work;
        Ok(())
    }

    /// Makes the light volumes whose emitter or pyramid has changed.
    async fn illuminate(
        &mut self,
        gpu: &Gpu,
        view: &View,
        tables: &TransferTables,
        emitters: &Emitters,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let size = view.style.lighting.light_size();
        let count = emitters.volumes.len() as u32;
        if count == 0 {
            self.lights = None;
            return Ok(());
        }
        let shape = Shape::single([size[0], size[1], size[2] * count], 1);
        check_size(gpu, shape.size)?;
        let mut lights = match self.lights.take().filter(|l| l.volume.shape == shape) {
            Some(lights) => lights,
            None => LightVolumes {
                volume: Volume::new(gpu, shape),
                size,
                made: vec![None; count as usize],
            },
        };
        let group = self.bind(gpu, tables);
        let shading = Shading::of(&view.style.lighting);
        for (n, &at) in emitters.volumes.iter().enumerate() {
            let emitter = emitters.emitters[at];
            let method = shading.method_of(at);
            let lit = Lit {
                method,
                per_shell: shading.per_shell,
                pyramid: match method {
                    LightMethod::SpaoMipmap => self.made.means,
                    LightMethod::Cones | LightMethod::Surround => self.made.pyramids,
                    LightMethod::Vct => self.made.value_pyramids + self.made.value_opacities,
                    LightMethod::Sat => self.made.sums,
                },
                emitter: emitter.for_cones(),
                sections: emitters.of(at).to_vec(),
            };
            if lights.size == size && lights.made[n].as_ref() == Some(&lit) {
                continue;
            }
            lights.made[n] = None;
            let from = n as u32 * size[2];
            let which = gpu.uniform("emitter", &[at as u32, from, 0, 0]);
            let mut slabs = Slabs::new(gpu, &mut self.pace, progress);
            let work = u64::from(emitters.works[at]).max(SHELLS_WORK);
            let range = [from, from + size[2]];
            let constants = [
                ("METHOD", f64::from(number(method))),
                ("PER_SHELL", flag(shading.per_shell)),
            ];
            let illuminate = Pipeline::variant(gpu, "illuminate", "main", &constants)?;
            let dispatch = |encoder: &mut _, slab: &Slab, voxels: &wgpu::Buffer| {
                run(gpu, &illuminate, encoder, slab, &which, voxels, &group, 2);
            };
            lights
                .volume
                .make_slices(&mut slabs, 0, range, work, &dispatch)
                .await?;
            lights.made[n] = Some(lit);
            self.made.light_volumes += 1;
        }
        lights.size = size;
        self.lights = Some(lights);
        Ok(())
    }

    /// Makes the gradients where highlights need them.
    async fn slope(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
        view: &View,
        tables: &TransferTables,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let (Some(_), true) = (&self.field, view.style.lighting.blinn_phong) else {
            self.gradients = None;
            return Ok(());
        };
        // Values that are constant in a cell have no gradient.
        if view.shown.cells.interpolation == crate::scene::Interpolation::Cell {
            self.gradients = None;
            return Ok(());
        }
        let shape = Shape {
            voxel: Voxel::Quad,
            ..Shape::single(view.style.lighting.light_size(), 1)
        };
        let revision = grid.revisions.gradients;
        let known = self.gradients.as_ref();
        if known.is_some_and(|g| g.revision == revision) {
            return Ok(());
        }
        self.gradients = None;
        let volume = Volume::new(gpu, shape);
        let group = self.bind(gpu, tables);
        let which = gpu.uniform("emitter", &[0u32; 4]);
        let mut slabs = Slabs::new(gpu, &mut self.pace, progress);
        let gradient = Pipeline::variant(gpu, "illuminate", "gradient", &[])?;
        let dispatch = |encoder: &mut _, slab: &Slab, voxels: &wgpu::Buffer| {
            run(gpu, &gradient, encoder, slab, &which, voxels, &group, 1);
        };
        volume
            .make_level(&mut slabs, 0, GRADIENT_WORK, &dispatch)
            .await?;
        self.gradients = Some(Gradients { volume, revision });
        Ok(())
    }

    /// Bind group 2: transfer function and light.
    pub fn bind(&self, gpu: &Gpu, tables: &TransferTables) -> wgpu::BindGroup {
        let [single, packed, quad, word] = &self.nothing;
        let view = |volume: &Volume| volume.texture.create_view(&Default::default());
        let pyramid = view(self.pyramid.as_ref().map_or(single, |p| &p.volume));
        let lights = view(self.lights.as_ref().map_or(single, |l| &l.volume));
        let field = view(self.field.as_ref().map_or(packed, |f| &f.volume));
        let opacities = view(self.opacities.as_ref().map_or(single, |o| &o.volume));
        let values = view(self.values.as_ref().map_or(quad, |v| &v.volume));
        let sums = view(self.sums.as_ref().map_or(word, |s| &s.volume));
        let of_values = self.of_values.as_ref();
        let of_values = of_values.map_or(&self.no_table, |o| &o.table);
        let gradients = view(self.gradients.as_ref().map_or(quad, |g| &g.volume));
        let resources = [
            wgpu::BindingResource::TextureView(&tables.table),
            wgpu::BindingResource::TextureView(&tables.integrals),
            self.info.as_entire_binding(),
            wgpu::BindingResource::TextureView(&self.emitters),
            wgpu::BindingResource::TextureView(&pyramid),
            wgpu::BindingResource::TextureView(&lights),
            wgpu::BindingResource::TextureView(&field),
            wgpu::BindingResource::TextureView(&gradients),
            wgpu::BindingResource::Sampler(&self.sampler),
            wgpu::BindingResource::TextureView(&opacities),
            wgpu::BindingResource::TextureView(&values),
            wgpu::BindingResource::TextureView(of_values),
            wgpu::BindingResource::TextureView(&sums),
            wgpu::BindingResource::TextureView(&tables.cube[0]),
            wgpu::BindingResource::TextureView(&tables.cube[1]),
        ];
        gpu.bind(gpu.layouts.group(2), &resources)
    }

    /// Frees the volumes.
    fn forget(&mut self) {
        self.field = None;
        self.pyramid = None;
        self.values = None;
        self.of_values = None;
        self.sums = None;
        self.opacities = None;
        self.lights = None;
        self.gradients = None;
    }

    /// Bytes of all volumes.
    pub fn bytes(&self) -> u64 {
        let volumes = [
            self.field.as_ref().map(|f| &f.volume),
            self.pyramid.as_ref().map(|p| &p.volume),
            self.values.as_ref().map(|v| &v.volume),
            self.sums.as_ref().map(|s| &s.volume),
            self.opacities.as_ref().map(|o| &o.volume),
            self.lights.as_ref().map(|l| &l.volume),
            self.gradients.as_ref().map(|g| &g.volume),
        ];
        volumes.iter().flatten().map(|v| v.shape.bytes()).sum()
    }

    /// Loop iterations that the light of a sample costs, about.
    pub fn work(&self) -> u32 {
        self.work
    }

    /// The extinction pyramid, where there is one.
    pub fn pyramid(&self) -> Option<&Volume> {
        self.pyramid.as_ref().map(|p| &p.volume)
    }

    /// The volume of values, where there is one.
    pub fn field(&self) -> Option<&Volume> {
        self.field.as_ref().map(|f| &f.volume)
    }

    /// The light volumes, one above the other, where there are some.
    pub fn light_volumes(&self) -> Option<&Volume> {
        self.lights.as_ref().map(|l| &l.volume)
    }
}

/// A method's number in the shader.
fn number(method: LightMethod) -> u32 {
    match method {
        LightMethod::Cones => METHOD_CONES,
        LightMethod::Surround => METHOD_SURROUND,
        LightMethod::SpaoMipmap => METHOD_SPAO_MIPMAP,
        LightMethod::Vct => METHOD_VCT,
        LightMethod::Sat => METHOD_SAT,
    }
}

#[allow(clippy::too_many_arguments, reason = "the parts of one dispatch")]
fn run(
    gpu: &Gpu,
    pipeline: &Pipeline,
    encoder: &mut wgpu::CommandEncoder,
    slab: &Slab,
    which: &wgpu::Buffer,
    voxels: &wgpu::Buffer,
    group: &wgpu::BindGroup,
    wide: u32,
) {
    let slab_info = gpu.uniform("slab", slab);
    let own = [
        slab_info.as_entire_binding(),
        which.as_entire_binding(),
        voxels.as_entire_binding(),
    ];
    let groups = [(2, group), (3, &gpu.bind(&pipeline.own, &own))];
    let [width, height, depth] = slab.size;
    pipeline.dispatch(encoder, &groups, [width.div_ceil(wide), height, depth]);
}

fn check_size(gpu: &Gpu, size: [u32; 3]) -> Result<(), RenderError> {
    let limit = gpu.device.limits().max_texture_dimension_3d;
    match size.iter().all(|&n| n <= limit) {
        true => Ok(()),
        false => Err(RenderError::Unsuitable {
            adapter: gpu.info.name.clone(),
            reason: format!(
                "light volumes of {} x {} x {} voxels are asked for and {limit} each way are possible; use smaller ones or fewer lights",
                size[0], size[1], size[2]
            ),
        }),
    }
}

/// Tells where rays over cones would do too much for an adapter in software.
fn check_rays(gpu: &Gpu, view: &View, emitters: &Emitters) -> Result<(), RenderError> {
    let (steps, rays) = (emitters.ray_steps, view.style.lighting.rays);
    match gpu.is_software() && steps * f64::from(rays) > MOST_RAY_WORK {
        false => Ok(()),
        true => Err(RenderError::Device(format!(
            "lighting.rays: {rays} over cones of {steps:.0} steps are too many for a software adapter; use at most {:.0}, or a smaller volume or length",
            (MOST_RAY_WORK / steps).floor().max(1.0)
        ))),
    }
}

impl Shading {
    /// Names and values of the shaders' `override` constants.
    pub fn pairs(self) -> [(&'static str, f64); 8] {
        let at_samples = |mode, method| match mode {
            LIGHT_IMAGE => f64::from(number(method)),
            _ => 0.0,
        };
        [
            ("LIT", flag(self.is_on())),
            ("OCCLUSION", f64::from(self.occlusion)),
            ("SHADOWS", f64::from(self.shadows)),
            ("OCCLUSION_METHOD", at_samples(self.occlusion, self.method)),
            (
                "SHADOWS_METHOD",
                at_samples(self.shadows, self.shadow_method),
            ),
            ("LIGHTS", flag(self.lights)),
            ("BLINN_PHONG", flag(self.blinn_phong)),
            ("EXACT_COLORS", flag(self.exact_colors)),
        ]
    }
}
