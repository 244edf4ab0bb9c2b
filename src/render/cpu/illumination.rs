//! Light for the rays, kept from image to image: what is made follows the scene, as on the GPU. A volume of values
//! follows cells and values; the pyramid follows that, transfer function and clip planes; a light volume follows the
//! pyramid and its emitter, which for occlusion is the camera (campagnolo-2021, 3.3.3).

use std::time::Instant;

use glam::{Vec3A, Vec4};

use super::around::{Means, Surround};
use super::cone_rays::ConeRays;
use super::cones::Cones;
use super::extinction::{Pyramid, opacities};
use super::grid::Grid;
use super::illuminate::{gradients, light_volume, near_cells, near_occluders};
use super::kept::Kept;
use super::lamps::Lamp;
use super::light::Light;
use super::resample::Resampler;
use super::sat::{Sat, Sums};
use super::transfer::Tables;
use super::vct::{ValuePyramid, Vct};
use super::volume::Voxels;
use crate::model::Grid as Model;
use crate::render::LightTimes;
use crate::render::job::Progress;
use crate::render::plan::around::shells;
use crate::render::plan::extinction::Blur;
use crate::render::plan::layout::{Emitter, LightingInfo};
use crate::render::plan::light::{Emitters, Shading};
use crate::render::plan::occluders::Occluders;
use crate::render::plan::sat;
use crate::render::plan::vct::OpacityTable;
use crate::render::revisions::Revisions;
use crate::scene::Interpolation;
use crate::scene::lighting::LightMethod;
use crate::view::View;

/// Makes light and keeps it up to date.
#[derive(Default)]
pub struct Illumination {
    field: Kept<Field>,
    /// Opacities of a unit of length without any blur, for rays over cones, and their means where they are asked for.
    opacities: Kept<Means>,
    pyramid: Kept<Pyramid>,
    /// Voxels of light volumes that count, where not for cells alone.
    near: Option<Voxels<bool>>,
    values: Kept<ValuePyramid>,
    sums: Kept<Sums>,
    /// Opacities by what that pyramid holds.
    of_values: Kept<Vec<[f32; 4]>>,
    /// One for each emitter whose light is found before the rays.
    volumes: Vec<LightVolume>,
    gradients: Kept<Voxels<Vec4>>,
    lamps: Vec<Lamp>,
    /// What is shaded, and by which numbers.
    numbers: Option<(Shading, LightingInfo)>,
    /// What the last update took.
    pub times: LightTimes,
}

/// The volume of values that extinction is made from.
struct Field {
    /// Values at both ends of the range that is stored.
    range: [f64; 2],
    voxels: Voxels<u16>,
    /// Voxels of light volumes that count.
    near: Voxels<bool>,
}

/// Transmittances of the cones to an emitter.
struct LightVolume {
    lit: Lit,
    voxels: Voxels<f32>,
}

/// What a light volume is made from.
#[derive(Clone, PartialEq)]
struct Lit {
    /// Revision of what it is found in.
    extinction: u64,
    size: [u32; 3],
    emitter: Emitter,
    sections: Vec<[f32; 4]>,
    method: LightMethod,
    per_shell: bool,
}

/// What light at a point is found from.
struct Finder<'a> {
    cones: Option<&'a Cones<'a>>,
    vct: Option<&'a Vct<'a>>,
    sat: Option<&'a Sat<'a>>,
    means: Option<&'a Means>,
    info: &'a LightingInfo,
}

impl<'a> Finder<'a> {
    /// The part of the light toward a lamp, or from all sides, that comes to a point of lighting space.
    fn of(self, lit: &Lit, lamp: &'a Lamp) -> Box<dyn Fn(Vec3A) -> f32 + Sync + 'a> {
        let Self {
            cones,
            vct,
            sat,
            means,
            info,
        } = self;
        let per_shell = lit.per_shell;
        let found: Option<Box<dyn Fn(Vec3A) -> f32 + Sync + 'a>> = match lit.method {
            LightMethod::Cones => {
                cones.map(|cones| Box::new(move |p| cones.transmittance(lamp, p)) as _)
            }
            LightMethod::Surround => cones.map(|cones| {
                let surround = Surround::new(cones, lamp);
                Box::new(move |p| surround.openness(p)) as _
            }),
            LightMethod::SpaoMipmap => {
                means.map(|means| Box::new(move |p| means.openness(info, per_shell, p)) as _)
            }
            LightMethod::Vct => vct.map(|vct| Box::new(move |p| vct.transmittance(lamp, p)) as _),
            LightMethod::Sat => sat.map(|sat| Box::new(move |p| sat.transmittance(lamp, p)) as _),
        };
        found.unwrap_or_else(|| Box::new(|_| 1.0))
    }
}

/// What light is made of.
pub struct Source<'a> {
    /// The grid of the case.
    pub model: &'a Model,
    /// The same with its values, as it is held.
    pub grid: &'a Grid,
    /// Those of the view.
    pub revisions: Revisions,
    /// What is looked at.
    pub view: &'a View,
    /// Of the transfer function.
    pub tables: &'a Tables,
}

impl Illumination {
    /// Brings the light of a view up to date.
    pub async fn update(&mut self, source: &Source<'_>, progress: &Progress) {
        self.times = LightTimes::default();
        let lighting = &source.view.style.lighting;
        let shading = Shading::of(lighting);
        if !shading.is_on() {
            *self = Self::default();
            return;
        }
        let start = Instant::now();
        // Values that are constant in a cell have no gradient.
        let slopes = shading.blinn_phong && source.grid.interpolation == Interpolation::Vertex;
        self.fill(source, shading, slopes, progress).await;
        self.times.field = start.elapsed();
        let start = Instant::now();
        self.blur(source, shading, progress).await;
        self.times.extinction = start.elapsed();
        let start = Instant::now();
        let emitters = Emitters::new(&source.grid.compact.facts, source.view);
        self.lamps = Lamp::all(&emitters);
        let range = self.field.get().map_or([0.0, 1.0], |f| f.range);
        let levels = self.pyramid.get().map_or(1, |p| p.0.len() as u32);
        let facts = &source.grid.compact.facts;
        let info = emitters.info(facts, source.view, levels, range);
        self.illuminate(source, &emitters, &info, progress).await;
        self.slope(source, &info, slopes, progress).await;
        self.times.volumes = start.elapsed();
        self.numbers = Some((shading, info));
    }

    /// Fills the volume of values where it is asked for, and cells, values or sizes have changed.
    async fn fill(
        &mut self,
        source: &Source<'_>,
        shading: Shading,
        slopes: bool,
        progress: &Progress,
    ) {
        let lighting = &source.view.style.lighting;
        let (size, light_size) = (lighting.size(), lighting.light_size());
        let is_used = slopes || shading.reads_field();
        let fits = |f: &Field| {
            let sizes = [f.voxels.size, f.near.size];
            sizes == [size, light_size].map(|size| size.map(|n| n as usize))
        };
        if !is_used || !self.field.get().is_some_and(fits) {
            self.field.forget();
        }
        let revision = source.revisions.values;
        if !is_used || self.field.is_of(revision) {
            return;
        }
        self.field.forget();
        let cells = &source.view.shown.cells;
        let range = cells.value_range().unwrap_or([0.0, 1.0]);
        let resampler = Resampler::new(source.grid, size, range);
        let voxels = resampler.packed(progress).await;
        let near = near_cells(&voxels, light_size, progress).await;
        let field = Field {
            range,
            voxels,
            near,
        };
        self.field.keep(revision, field);
    }

    /// Makes the pyramid where the values, the transfer function or the clip planes have changed.
    async fn blur(&mut self, source: &Source<'_>, shading: Shading, progress: &Progress) {
        let revision = source.revisions.extinction;
        let shells = match shading.averages() {
            true => shells(&source.view.style.lighting),
            false => 0,
        };
        let has_shells = |means: &Means| means.shells() == shells;
        let uses_opacities = shading.casts_rays() || shading.averages();
        if !uses_opacities || !self.opacities.get().is_some_and(has_shells) {
            self.opacities.forget();
        }
        if !shading.traces_cones() {
            self.pyramid.forget();
        }
        if !shading.traces_values() {
            self.values.forget();
            self.of_values.forget();
        }
        self.hold_values(source, shading, progress).await;
        let counts = sat::counts(source.view);
        if !shading.sums() || self.sums.get().is_some_and(|s| s.counts != counts) {
            self.sums.forget();
        }
        let wants_sums = shading.sums() && !self.sums.is_of(revision);
        let wants_rays = uses_opacities && !self.opacities.is_of(revision);
        let wants_cones = shading.traces_cones() && !self.pyramid.is_of(revision);
        let Some(field) = self
            .field
            .get()
            .filter(|_| wants_rays || wants_cones || wants_sums)
        else {
            return;
        };
        let blur = Blur::new(&source.grid.compact.facts, source.view, field.range);
        let facts = &source.grid.compact.facts;
        let occluders = Occluders::of(facts, source.view, source.model);
        let occluders = occluders.as_ref();
        self.near = match occluders {
            Some(occluders) => Some(near_occluders(&field.near, occluders, progress).await),
            None => None,
        };
        let made = opacities(&field.voxels, &blur, source.tables, occluders, progress).await;
        if wants_sums {
            self.sums.keep(revision, Sums::new(&made, counts));
        }
        if wants_cones {
            self.pyramid.forget();
            let pyramid = Pyramid::new(&made, &blur, progress).await;
            self.pyramid.keep(revision, pyramid);
        }
        if wants_rays {
            let means = Means::new(made, shells, progress).await;
            self.opacities.keep(revision, means);
        }
    }

    /// Makes the pyramid of values where values or clip planes have changed, and the table of their opacities where the
    /// transfer function has.
    async fn hold_values(&mut self, source: &Source<'_>, shading: Shading, progress: &Progress) {
        let Some(field) = self.field.get().filter(|_| shading.traces_values()) else {
            return;
        };
        if !self.values.is_of(source.revisions.placed) {
            self.values.forget();
            let blur = Blur::new(&source.grid.compact.facts, source.view, field.range);
            let made = ValuePyramid::new(&field.voxels, &blur, progress).await;
            self.values.keep(source.revisions.placed, made);
        }
        if !self.of_values.is_of(source.revisions.extinction) {
            let table = OpacityTable::new(source.view, field.range);
            let revision = source.revisions.extinction;
            self.of_values.keep(revision, table.texels());
        }
    }

    /// Makes the light volumes whose emitter or pyramid has changed.
    async fn illuminate(
        &mut self,
        source: &Source<'_>,
        emitters: &Emitters,
        info: &LightingInfo,
        progress: &Progress,
    ) {
        self.volumes.truncate(emitters.volumes.len());
        let Some(field) = self.field.get() else {
            self.volumes.clear();
            return;
        };
        let size = info.light_size;
        let shading = Shading::of(&source.view.style.lighting);
        let cones = self.pyramid.get().map(|p| Cones::new(p, info));
        let vct = vct(&self.values, &self.of_values, info);
        let sat = self.sums.get().map(|s| Sat::new(s, info));
        for (n, &at) in emitters.volumes.iter().enumerate() {
            let lit = Lit {
                extinction: source.revisions.extinction,
                size,
                emitter: emitters.emitters[at].for_cones(),
                sections: emitters.of(at).to_vec(),
                method: shading.method_of(at),
                per_shell: shading.per_shell,
            };
            if self.volumes.get(n).is_some_and(|v| v.lit == lit) {
                continue;
            }
            let finder = Finder {
                cones: cones.as_ref(),
                vct: vct.as_ref(),
                sat: sat.as_ref(),
                means: self.opacities.get(),
                info,
            };
            let found = finder.of(&lit, &self.lamps[at]);
            let box_size = Vec3A::from(info.size);
            let near = self.near.as_ref().unwrap_or(&field.near);
            let voxels = light_volume(box_size, &*found, near, progress).await;
            let made = LightVolume { lit, voxels };
            match self.volumes.get_mut(n) {
                Some(volume) => *volume = made,
                None => self.volumes.push(made),
            }
        }
    }

    /// Makes the gradients where highlights need them.
    async fn slope(
        &mut self,
        source: &Source<'_>,
        info: &LightingInfo,
        slopes: bool,
        progress: &Progress,
    ) {
        let revision = source.revisions.gradients;
        let Some(field) = self.field.get().filter(|_| slopes) else {
            self.gradients.forget();
            return;
        };
        if !self.gradients.is_of(revision) {
            self.gradients.forget();
            let made = gradients(&field.voxels, info, progress).await;
            self.gradients.keep(revision, made);
        }
    }

    /// The light as the last update has left it; `None` where nothing is shaded.
    pub fn light(&self) -> Option<Light<'_>> {
        let (shading, info) = self.numbers?;
        let rays = |opacities| ConeRays {
            opacities,
            size: Vec3A::from(info.size),
            rays: info.rays,
            seed: info.seed,
            step: info.step,
            gap: info.rays_gap,
        };
        Some(Light {
            shading,
            cones: self.pyramid.get().map(|p| Cones::new(p, &info)),
            vct: vct(&self.values, &self.of_values, &info),
            sat: self.sums.get().map(|s| Sat::new(s, &info)),
            rays: self.opacities.get().and_then(Means::finest).map(rays),
            info,
            lamps: &self.lamps,
            volumes: self.volumes.iter().map(|v| &v.voxels).collect(),
            gradients: self.gradients.get(),
        })
    }

    /// Bytes of all volumes.
    pub fn bytes(&self) -> u64 {
        self.field
            .get()
            .map_or(0, |f| f.voxels.bytes() + f.near.bytes())
            + self.opacities.get().map_or(0, Means::bytes)
            + self.pyramid.get().map_or(0, Pyramid::bytes)
            + self.values.get().map_or(0, ValuePyramid::bytes)
            + self.sums.get().map_or(0, Sums::bytes)
            + self
                .of_values
                .get()
                .map_or(0, |t| size_of_val(t.as_slice()) as u64)
            + self.volumes.iter().map(|v| v.voxels.bytes()).sum::<u64>()
            + self.gradients.get().map_or(0, Voxels::bytes)
    }
}

/// Where light is found along cones through values.
fn vct<'a>(
    values: &'a Kept<ValuePyramid>,
    opacities: &'a Kept<Vec<[f32; 4]>>,
    info: &LightingInfo,
) -> Option<Vct<'a>> {
    Some(Vct::new(values.get()?, opacities.get()?, info))
}
