//! Light for the rays: emitters with their cones, the extinction pyramid, light volumes, gradients.
//!
//! What is made follows the scene: a volume of values follows cells and values; the pyramid follows that,
//! transfer function and clip planes; a light volume follows the pyramid and its emitter, which for occlusion
//! is the camera (campagnolo-2021, 3.3.3).

use std::time::Instant;

use glam::{DVec3, Vec3};

use super::cones::ConeTable;
use super::device::Gpu;
use super::extinction::{Blurs, Pyramid};
use super::grid_upload::GpuGrid;
use super::pipeline::{Pipeline, flag};
use super::resample::Resampler;
use super::slabs::Slabs;
use super::tiles::Pace;
use super::transfer_tables::TransferTables;
use super::volume::Volume;
use crate::render::RenderError;
use crate::render::job::Progress;
use crate::render::plan::frame::{clip_planes, ghost};
use crate::render::plan::layout::{self, Emitter, LightingInfo, Slab};
use crate::render::stats::LightTimes;
use crate::scene::lighting::LightMode;
use crate::view::View;
use crate::view::lighting::{Cone, LightSource, Lighting, SPOT_EDGE};
use crate::view::voxels::{Shape, Voxel};

/// Options of the light that are constants of the strategies' pipelines.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Shading {
    occlusion: u32,
    shadows: u32,
    lights: bool,
    blinn_phong: bool,
    exact_colors: bool,
}

impl Shading {
    /// What a view's lighting needs.
    pub fn of(lighting: &Lighting) -> Self {
        let lights = !lighting.lights.is_empty();
        Self {
            occlusion: lighting
                .occlusion
                .map_or(layout::LIGHT_OFF, |o| mode(o.mode)),
            shadows: if lights {
                mode(lighting.shadows)
            } else {
                layout::LIGHT_OFF
            },
            lights,
            blinn_phong: lighting.blinn_phong,
            exact_colors: lighting.exact_colors,
        }
    }

    /// True where a sample's color depends on where it is.
    pub fn is_on(self) -> bool {
        self != Self::default()
    }

    /// True where samples cast rays over cones.
    pub fn casts_rays(self) -> bool {
        [self.occlusion, self.shadows].contains(&layout::LIGHT_RAYS)
    }

    /// True where cones are traced through the pyramid, at samples or before.
    pub fn traces_cones(self) -> bool {
        let modes = [self.occlusion, self.shadows];
        modes.contains(&layout::LIGHT_IMAGE) || modes.contains(&layout::LIGHT_VOLUME)
    }

    /// Names and values of the shaders' `override` constants.
    pub fn pairs(self) -> [(&'static str, f64); 6] {
        [
            ("LIT", flag(self.is_on())),
            ("OCCLUSION", f64::from(self.occlusion)),
            ("SHADOWS", f64::from(self.shadows)),
            ("LIGHTS", flag(self.lights)),
            ("BLINN_PHONG", flag(self.blinn_phong)),
            ("EXACT_COLORS", flag(self.exact_colors)),
        ]
    }
}

fn mode(mode: LightMode) -> u32 {
    match mode {
        LightMode::Off => layout::LIGHT_OFF,
        LightMode::Image => layout::LIGHT_IMAGE,
        LightMode::Preilluminated => layout::LIGHT_VOLUME,
        LightMode::MonteCarlo => layout::LIGHT_RAYS,
    }
}

/// How often each part has been made. The numbers never fall, so that what was made from a part that a
/// canceled update has dropped is stale for good.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Made {
    /// Fillings of the volume of values.
    pub fields: u64,
    /// Extinction pyramids.
    pub pyramids: u64,
    /// Light volumes, each emitter's counted by itself.
    pub light_volumes: u64,
}

/// Makes light and keeps it up to date.
pub struct Illumination {
    resampler: Resampler,
    blurs: Blurs,
    illuminate: Pipeline,
    gradient: Pipeline,
    sampler: wgpu::Sampler,
    pace: Pace,
    /// What is bound where there is no volume.
    nothing: [Volume; 3],
    info: wgpu::Buffer,
    emitters: wgpu::Buffer,
    sections: wgpu::Buffer,
    work: u32,
    field: Option<Field>,
    pyramid: Option<Pyramid>,
    /// Opacities without any blur, for rays over cones.
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
    pyramid: u64,
    emitter: Emitter,
    sections: Vec<[f32; 4]>,
}

struct Gradients {
    volume: Volume,
    revision: u64,
}

/// The emitters of a view: the viewer, then the lights.
struct Emitters {
    emitters: Vec<Emitter>,
    sections: Vec<[f32; 4]>,
    /// Emitter of each light volume.
    volumes: Vec<usize>,
    work: u32,
}

/// Reach of the rays of a cone, and of a section of seven parts, in loop iterations.
const SECTION_WORK: [u32; 3] = [1, 2, 4];
/// Loop iterations of the rays over a cone, at most, on an adapter in software: llvmpipe ends a shader with
/// 65,535 without a word, and eight rays side by side may all do theirs one after the other.
const MOST_RAY_WORK: f64 = 7_500.0;
/// Loop iterations that a voxel of the gradient costs, about.
const GRADIENT_WORK: u64 = 60;

impl Illumination {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// When the driver refuses one.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        let none: [LightingInfo; 1] = bytemuck::Zeroable::zeroed();
        let one = |voxel| Shape {
            voxel,
            ..Shape::single([1; 3], 1)
        };
        Ok(Self {
            resampler: Resampler::new(gpu, true)?,
            blurs: Blurs::default(),
            illuminate: Pipeline::new(gpu, "illuminate")?,
            gradient: Pipeline::variant(gpu, "illuminate", "gradient", &[])?,
            sampler: gpu.linear_sampler(),
            pace: Pace::default(),
            nothing: [Voxel::Single, Voxel::Packed, Voxel::Quad].map(|v| Volume::new(gpu, one(v))),
            info: gpu.uniform("lighting", &none),
            emitters: gpu.storage::<Emitter>("emitters", &[bytemuck::Zeroable::zeroed()])?,
            sections: gpu.storage::<[f32; 4]>("cone sections", &[])?,
            work: 0,
            field: None,
            pyramid: None,
            opacities: None,
            lights: None,
            gradients: None,
            times: LightTimes::default(),
            made: Made::default(),
        })
    }

    /// Brings the light of a view up to date.
    ///
    /// # Errors
    /// When a volume exceeds what the adapter holds, or the device reports an error.
    pub async fn update(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
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
        self.blur(gpu, grid, view, tables, progress).await?;
        self.times.extinction = start.elapsed();
        let start = Instant::now();
        let emitters = emitters(grid, view, gpu.is_software())?;
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
        self.resampler
            .fill(
                &mut slabs,
                grid,
                &volume,
                range,
                view.shown.cells.interpolation,
            )
            .await?;
        self.made.fields += 1;
        self.field = Some(Field {
            revision: grid.revisions.values,
            range,
            volume,
        });
        Ok(())
    }

    /// Makes the pyramid where the values, the transfer function or the clip planes have changed.
    async fn blur(
        &mut self,
        gpu: &Gpu,
        grid: &GpuGrid,
        view: &View,
        tables: &TransferTables,
        progress: &Progress,
    ) -> Result<(), RenderError> {
        let Some(field) = &self.field else {
            return Ok(());
        };
        let source = super::extinction::PyramidSource {
            values: &field.volume,
            revision: grid.revisions.extinction,
            position: position(view, field.range),
            sigma: view.style.lighting.sigma(),
            ghost: ghost(view)[3],
            clip_planes: clip_planes(&grid.facts, view),
            clip_count: view.shown.clip.len() as u32,
            bounds: grid.facts.bounds,
            extent: view.style.lighting.extent,
        };
        let shading = Shading::of(&view.style.lighting);
        let is_stale =
            |made: &Option<Pyramid>| made.as_ref().is_none_or(|p| p.revision != source.revision);
        let group = self.bind(gpu, tables);
        let mut slabs = Slabs::new(gpu, &mut self.pace, progress);
        if !shading.casts_rays() {
            self.opacities = None;
        } else if is_stale(&self.opacities) {
            let before = self.opacities.take();
            let made = self.blurs.make_sharp(&mut slabs, &source, &group, before);
            self.opacities = Some(made.await?);
        }
        if !shading.traces_cones() {
            self.pyramid = None;
        } else if is_stale(&self.pyramid) {
            let before = self.pyramid.take();
            let made = self.blurs.make(&mut slabs, &source, &group, before);
            self.pyramid = Some(made.await?);
            self.made.pyramids += 1;
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
        let lighting = &view.style.lighting;
        let space = LightSpace::new(grid, view);
        let range = self.field.as_ref().map_or([0.0, 1.0], |f| f.range);
        let [position_low, position_scale] = position(view, range);
        let info = LightingInfo {
            box_low: space.low.as_vec3().to_array(),
            sigma: space.sigma as f32,
            scale: space.scale.as_vec3().to_array(),
            strength: lighting.occlusion.map_or(0.0, |o| o.strength as f32),
            size: (lighting.extent / space.sigma).as_vec3().to_array(),
            ambient: lighting.ambient as f32,
            light_size: lighting.light_size(),
            volumes: emitters.volumes.len().max(1) as u32,
            emitters: emitters.emitters.len() as u32,
            levels: self.pyramid.as_ref().map_or(1, Pyramid::levels),
            position_low,
            position_scale,
            rays: lighting.rays,
            seed: lighting.seed,
            step: Lighting::REFERENCE_STEP as f32,
            gradient_scale: (view.style.transfer.reference_length / space.sigma) as f32,
            work: emitters.work,
            rays_gap: lighting.rays_gap as f32,
            reserved0: 0,
            reserved1: 0,
        };
        self.info = gpu.uniform("lighting", &info);
        self.emitters = gpu.storage("emitters", &emitters.emitters)?;
        self.sections = gpu.storage("cone sections", &emitters.sections)?;
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
        for (n, &at) in emitters.volumes.iter().enumerate() {
            let emitter = emitters.emitters[at];
            let lit = Lit {
                pyramid: self.made.pyramids,
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
            let work = u64::from(cone_work(&emitter));
            let range = [from, from + size[2]];
            let illuminate = &self.illuminate;
            let dispatch = |encoder: &mut _, slab: &Slab, voxels: &wgpu::Buffer| {
                run(gpu, illuminate, encoder, slab, &which, voxels, &group, 2);
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
        let gradient = &self.gradient;
        let dispatch = |encoder: &mut _, slab: &Slab, voxels: &wgpu::Buffer| {
            run(gpu, gradient, encoder, slab, &which, voxels, &group, 1);
        };
        volume
            .make_level(&mut slabs, 0, GRADIENT_WORK, &dispatch)
            .await?;
        self.gradients = Some(Gradients { volume, revision });
        Ok(())
    }

    /// Bind group 2: transfer function and light.
    pub fn bind(&self, gpu: &Gpu, tables: &TransferTables) -> wgpu::BindGroup {
        let [single, packed, quad] = &self.nothing;
        let view = |volume: &Volume| volume.texture.create_view(&Default::default());
        let pyramid = view(self.pyramid.as_ref().map_or(single, |p| &p.volume));
        let lights = view(self.lights.as_ref().map_or(single, |l| &l.volume));
        let field = view(self.field.as_ref().map_or(packed, |f| &f.volume));
        let opacities = view(self.opacities.as_ref().map_or(single, |o| &o.volume));
        let gradients = view(self.gradients.as_ref().map_or(quad, |g| &g.volume));
        let resources = [
            tables.table.as_entire_binding(),
            tables.integrals.as_entire_binding(),
            self.info.as_entire_binding(),
            self.emitters.as_entire_binding(),
            self.sections.as_entire_binding(),
            wgpu::BindingResource::TextureView(&pyramid),
            wgpu::BindingResource::TextureView(&lights),
            wgpu::BindingResource::TextureView(&field),
            wgpu::BindingResource::TextureView(&gradients),
            wgpu::BindingResource::Sampler(&self.sampler),
            wgpu::BindingResource::TextureView(&opacities),
        ];
        gpu.bind(gpu.layouts.group(2), &resources)
    }

    /// Frees the volumes.
    fn forget(&mut self) {
        self.field = None;
        self.pyramid = None;
        self.opacities = None;
        self.lights = None;
        self.gradients = None;
    }

    /// Bytes of all volumes.
    pub fn bytes(&self) -> u64 {
        let volumes = [
            self.field.as_ref().map(|f| &f.volume),
            self.pyramid.as_ref().map(|p| &p.volume),
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

/// Transfer-function position of a value that is stored as a part of `range`: offset and factor.
fn position(view: &View, range: [f64; 2]) -> [f32; 2] {
    view.style.transfer.positions(range).map(|v| v as f32)
}

/// Lighting space: the grid's axes from the low corner of the box, in units of the finest level's standard
/// deviation in world space.
struct LightSpace {
    low: DVec3,
    scale: DVec3,
    sigma: f64,
}

impl LightSpace {
    fn new(grid: &GpuGrid, view: &View) -> Self {
        let [low, high] = grid.facts.bounds;
        let sigma = view.style.lighting.sigma();
        let edges = (high - low).max(DVec3::splat(1e-6));
        Self {
            low,
            scale: view.style.lighting.extent / edges / sigma,
            sigma,
        }
    }

    fn point(&self, grid: &GpuGrid, view: &View, world: DVec3) -> Vec3 {
        let point = view.world.spaces.grid_from_world.transform_point3(world) - grid.facts.origin;
        ((point - self.low) * self.scale).as_vec3()
    }

    fn direction(&self, view: &View, world: DVec3) -> Vec3 {
        let direction = view.world.spaces.grid_from_world.matrix3 * world * self.scale;
        direction.normalize_or(DVec3::Z).as_vec3()
    }
}

fn emitters(grid: &GpuGrid, view: &View, software: bool) -> Result<Emitters, RenderError> {
    let lighting = &view.style.lighting;
    let space = LightSpace::new(grid, view);
    let mut all = Emitters {
        emitters: Vec::new(),
        sections: Vec::new(),
        volumes: Vec::new(),
        work: 0,
    };
    let occlusion = lighting.occlusion;
    let off = LightMode::Off;
    all.add(
        Emitter::viewer(grid, view, &space),
        occlusion.map_or(off, |o| o.mode),
        occlusion.map(|o| o.cone),
        lighting,
        &space,
        software,
    )?;
    for light in &lighting.lights {
        let emitter = Emitter::at(
            &light.source,
            light.blended(view.style.blending),
            grid,
            view,
            &space,
        );
        all.add(
            emitter,
            lighting.shadows,
            Some(light.cone),
            lighting,
            &space,
            software,
        )?;
    }
    Ok(all)
}

impl Emitters {
    fn add(
        &mut self,
        emitter: Emitter,
        mode: LightMode,
        cone: Option<Cone>,
        lighting: &Lighting,
        space: &LightSpace,
        software: bool,
    ) -> Result<(), RenderError> {
        let mut emitter = emitter;
        if let Some(cone) = cone.filter(|_| mode != LightMode::Off) {
            let table = ConeTable::of(&cone, space.sigma);
            emitter.first = self.sections.len() as u32;
            [emitter.ones, emitter.threes, emitter.sevens] = table.by_parts();
            emitter.tangent = cone.half_angle.tan() as f32;
            emitter.cosine = cone.half_angle.cos() as f32;
            emitter.length = (cone.length / space.sigma) as f32;
            self.sections.extend(table.sections.iter().map(|s| {
                [s.distance, f64::from(s.level), s.amplitude, s.weight].map(|v| v as f32)
            }));
            match mode {
                LightMode::Off => {}
                LightMode::Image => self.work += cone_work(&emitter),
                LightMode::Preilluminated => {
                    emitter.volume = self.volumes.len() as u32;
                    self.volumes.push(self.emitters.len());
                }
                LightMode::MonteCarlo => {
                    let steps = cone.length / space.sigma / Lighting::REFERENCE_STEP;
                    let work = steps * f64::from(lighting.rays);
                    if software && work > MOST_RAY_WORK {
                        return Err(RenderError::Device(format!(
                            "lighting.rays: {} over cones of {steps:.0} steps are too many for a software adapter; use at most {:.0}, or a smaller volume or length",
                            lighting.rays,
                            (MOST_RAY_WORK / steps).floor().max(1.0)
                        )));
                    }
                    self.work += work as u32;
                }
            }
        }
        self.emitters.push(emitter);
        Ok(())
    }

    /// The sections of an emitter.
    fn of(&self, emitter: usize) -> &[[f32; 4]] {
        let e = &self.emitters[emitter];
        let first = e.first as usize;
        &self.sections[first..first + (e.ones + e.threes + e.sevens) as usize]
    }
}

/// Loop iterations of a cone, about.
fn cone_work(emitter: &Emitter) -> u32 {
    let counts = [emitter.ones, emitter.threes, emitter.sevens];
    counts.iter().zip(SECTION_WORK).map(|(n, w)| n * w).sum()
}

/// Distance from which directional light comes, in the units of its space.
const FAR: f32 = 1e30;

impl Emitter {
    /// The viewer: the eye, or what sees along the axis of a parallel camera. Nothing behind the plane of
    /// that one is in the way; where all of the model is before it, moving it changes nothing.
    fn viewer(grid: &GpuGrid, view: &View, space: &LightSpace) -> Self {
        let camera = &view.camera;
        if camera.parallel.is_none() {
            let position = camera.eye;
            return Self::at(
                &LightSource::Point { position },
                DVec3::ONE,
                grid,
                view,
                space,
            );
        }
        let toward = -camera.forward;
        let viewer = Self::at(
            &LightSource::Directional { toward },
            DVec3::ONE,
            grid,
            view,
            space,
        );
        let cuts = view.world.corners.iter().any(|c| camera.depth(*c) < 0.0);
        let plane = cuts.then(|| space.point(grid, view, camera.eye).to_array());
        Self {
            axis: plane.unwrap_or(viewer.axis),
            ..viewer
        }
    }

    /// What cones to it depend on: color and a spot's own cone are applied to samples.
    fn for_cones(self) -> Self {
        let is_directional = self.kind == layout::EMITTER_DIRECTIONAL;
        Self {
            first: 0,
            color: [0.0; 3],
            axis: if is_directional { self.axis } else { [0.0; 3] },
            cos_outer: 0.0,
            cos_inner: 0.0,
            ..self
        }
    }

    fn at(
        source: &LightSource,
        color: DVec3,
        grid: &GpuGrid,
        view: &View,
        space: &LightSpace,
    ) -> Self {
        let none: Self = bytemuck::Zeroable::zeroed();
        let color = color.as_vec3().to_array();
        match *source {
            LightSource::Directional { toward } => {
                let toward = space.direction(view, toward);
                Self {
                    kind: layout::EMITTER_DIRECTIONAL,
                    at: toward.to_array(),
                    axis: (FAR * toward).to_array(),
                    color,
                    ..none
                }
            }
            LightSource::Point { position } => Self {
                kind: layout::EMITTER_POINT,
                at: space.point(grid, view, position).to_array(),
                color,
                ..none
            },
            LightSource::Spot {
                position,
                axis,
                opening,
            } => Self {
                kind: layout::EMITTER_SPOT,
                at: space.point(grid, view, position).to_array(),
                axis: space.direction(view, axis).to_array(),
                cos_outer: opening.cos() as f32,
                cos_inner: (opening * (1.0 - SPOT_EDGE)).cos() as f32,
                color,
                ..none
            },
        }
    }
}
