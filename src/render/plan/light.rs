//! Light without a device: where it is found, its space, the viewer and the lights with the sections of their cones.

use glam::{DVec3, Vec3};

use super::around;
use super::compact_grid::GridFacts;
use super::cones::ConeTable;
use super::layout::{self, Emitter, LightingInfo};
use super::transfer::position;
use super::{sat, vct};
use crate::scene::lighting::{LightMethod, LightMode};
use crate::view::View;
use crate::view::lighting::{Cone, LightSource, Lighting, SPOT_EDGE};

/// How samples are shaded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Shading {
    /// Where occlusion is found: one of the `LIGHT` constants.
    pub occlusion: u32,
    /// The same of the lights' shadows.
    pub shadows: u32,
    /// There are lights.
    pub lights: bool,
    /// They make highlights and shade by the gradient.
    pub blinn_phong: bool,
    /// Only inactive cells are shaded.
    pub exact_colors: bool,
    /// How occlusion is found.
    pub method: LightMethod,
    /// Of shells: each counts as one voxel.
    pub per_shell: bool,
    /// How shadows are found.
    pub shadow_method: LightMethod,
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
            method: lighting
                .occlusion
                .map_or_else(Default::default, |o| o.method),
            per_shell: lighting.occlusion.is_some_and(|o| o.per_shell),
            shadow_method: if lights {
                lighting.shadow_method
            } else {
                LightMethod::default()
            },
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

    /// True where cones are traced through the pyramid of extinction, at samples or before.
    pub fn traces_cones(self) -> bool {
        self.uses(LightMethod::Cones) || self.uses(LightMethod::Surround)
    }

    /// True where occlusion is found from mean opacities.
    pub fn averages(self) -> bool {
        self.uses(LightMethod::SpaoMipmap)
    }

    /// True where cones are traced through the pyramid of values.
    pub fn traces_values(self) -> bool {
        self.uses(LightMethod::Vct)
    }

    /// True where boxes of a summed-area table are asked for.
    pub fn sums(self) -> bool {
        self.uses(LightMethod::Sat)
    }

    /// True where the volume of values is asked for.
    pub fn reads_field(self) -> bool {
        self.casts_rays()
            || self.traces_cones()
            || self.averages()
            || self.traces_values()
            || self.sums()
    }

    /// How the light toward an emitter is found, the viewer being the first.
    pub fn method_of(self, emitter: usize) -> LightMethod {
        match emitter {
            0 => self.method,
            _ => self.shadow_method,
        }
    }

    fn uses(self, method: LightMethod) -> bool {
        let finds = |mode| [layout::LIGHT_IMAGE, layout::LIGHT_VOLUME].contains(&mode);
        (self.method == method && finds(self.occlusion))
            || (self.shadow_method == method && finds(self.shadows))
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

/// Lighting space: the grid's axes from the low corner of the box, in units of the finest level's standard
/// deviation in world space.
pub(super) struct LightSpace<'a> {
    grid: &'a GridFacts,
    view: &'a View,
    scale: DVec3,
    sigma: f64,
}

impl<'a> LightSpace<'a> {
    pub(super) fn new(grid: &'a GridFacts, view: &'a View) -> Self {
        let [low, high] = grid.bounds;
        let sigma = view.style.lighting.sigma();
        let edges = (high - low).max(DVec3::splat(1e-6));
        Self {
            grid,
            view,
            scale: view.style.lighting.extent / edges / sigma,
            sigma,
        }
    }

    pub(super) fn point(&self, world: DVec3) -> Vec3 {
        let to_grid = &self.view.world.spaces.grid_from_world;
        let point = to_grid.transform_point3(world) - self.grid.origin;
        ((point - self.grid.bounds[0]) * self.scale).as_vec3()
    }

    fn direction(&self, world: DVec3) -> Vec3 {
        let direction = self.view.world.spaces.grid_from_world.matrix3 * world * self.scale;
        direction.normalize_or(DVec3::Z).as_vec3()
    }
}

/// The emitters of a view: the viewer, then the lights.
pub struct Emitters {
    /// All of them.
    pub emitters: Vec<Emitter>,
    /// Sections of their cones: distance from the tip, level of the pyramid, amplitude times attenuation, weight. By the
    /// method `vct` one, as [`vct::section`] says. By the method `sat` a box each: distance of its middle, edge, attenuation
    /// a count, length that it stands for.
    pub sections: Vec<[f32; 4]>,
    /// Emitter of each light volume.
    pub volumes: Vec<usize>,
    /// Loop iterations that the light toward each emitter costs at a point, about.
    pub works: Vec<u32>,
    /// Numbers that a unit of optical depth is counted in, in sums.
    counts: f32,
    /// Loop iterations that the light of a sample costs, about.
    pub work: u32,
    /// Samples of a ray over the longest of the cones over which rays are cast.
    pub ray_steps: f64,
}

/// Parts of the cones to all sides, at most: with seven pictures are lighter than the truth, and take twice as long.
const SURROUND_SPLITS: u32 = 3;

/// A cone as it is traced: one that is all of the sphere by narrower ones, alike.
fn traced(cone: Cone) -> Cone {
    match cone.is_around() {
        true => Cone {
            half_angle: around::half_angle(),
            splits: cone.splits.min(SURROUND_SPLITS),
            ..cone
        },
        false => cone,
    }
}

/// Reach of the rays of a cone, and of a section of seven parts, in loop iterations.
const SECTION_WORK: [u32; 3] = [1, 2, 4];

/// Loop iterations that the sum over a box costs, about.
const BOX_WORK: u32 = 16;

impl Emitters {
    /// Those of a view of a grid.
    pub fn new(grid: &GridFacts, view: &View) -> Self {
        let lighting = &view.style.lighting;
        let space = LightSpace::new(grid, view);
        let mut all = Self {
            emitters: Vec::new(),
            sections: Vec::new(),
            volumes: Vec::new(),
            works: Vec::new(),
            counts: sat::counts(view),
            work: 0,
            ray_steps: 0.0,
        };
        let viewer = Emitter::viewer(&space);
        let occlusion = lighting.occlusion;
        let looks = occlusion.map(|o| (o.mode, o.method, o.cone));
        all.add(viewer, looks, &space);
        for light in &lighting.lights {
            let color = light.blended(view.style.blending);
            let emitter = Emitter::at(&light.source, color, &space);
            let looks = (lighting.shadows, lighting.shadow_method, light.cone);
            all.add(emitter, Some(looks), &space);
        }
        all
    }

    /// Adds an emitter; where its light is found, how, and its cone.
    fn add(
        &mut self,
        mut emitter: Emitter,
        looks: Option<(LightMode, LightMethod, Cone)>,
        space: &LightSpace<'_>,
    ) {
        let mut work = 0;
        if let Some((mode, method, cone)) = looks.filter(|(mode, ..)| *mode != LightMode::Off) {
            emitter.first = self.sections.len() as u32;
            emitter.tangent = cone.half_angle.tan() as f32;
            emitter.cosine = cone.half_angle.cos() as f32;
            emitter.length = (cone.length / space.sigma) as f32;
            work = self.add_sections(&mut emitter, method, &cone, space.sigma);
            match mode {
                LightMode::Off => {}
                LightMode::Image => self.work += work,
                LightMode::Preilluminated => {
                    emitter.volume = self.volumes.len() as u32;
                    self.volumes.push(self.emitters.len());
                }
                LightMode::MonteCarlo => {
                    let steps = cone.length / space.sigma / Lighting::REFERENCE_STEP;
                    self.ray_steps = self.ray_steps.max(steps);
                    self.work += (steps * f64::from(space.view.style.lighting.rays)) as u32;
                }
            }
        }
        self.emitters.push(emitter);
        self.works.push(work);
    }

    /// Adds what a method knows of the cone toward an emitter; gives the loop iterations that a point costs, about.
    fn add_sections(
        &mut self,
        emitter: &mut Emitter,
        method: LightMethod,
        cone: &Cone,
        sigma: f64,
    ) -> u32 {
        match method {
            LightMethod::Cones | LightMethod::Surround | LightMethod::SpaoMipmap => {
                let table = ConeTable::of(&traced(*cone), sigma);
                [emitter.ones, emitter.threes, emitter.sevens] = table.by_parts();
                self.sections.extend(table.sections.iter().map(|s| {
                    [s.distance, f64::from(s.level), s.amplitude, s.weight].map(|v| v as f32)
                }));
                emitter.cone_work()
            }
            LightMethod::Vct => {
                emitter.ones = 1;
                self.sections.push(vct::section(cone));
                vct::steps(cone, sigma)
            }
            LightMethod::Sat => {
                let boxes = sat::sections(cone, sigma);
                let factor = cone.attenuation / f64::from(self.counts);
                emitter.ones = boxes.len() as u32;
                self.sections.extend(
                    boxes
                        .iter()
                        .map(|s| [s.distance, s.edge, factor, s.length].map(|v| v as f32)),
                );
                BOX_WORK * emitter.ones
            }
        }
    }

    /// All emitters and behind them all sections, in texels of four words.
    pub fn texels(&self) -> Vec<[u32; 4]> {
        let emitters: &[[u32; 4]] = bytemuck::cast_slice(&self.emitters);
        let sections: &[[u32; 4]] = bytemuck::cast_slice(&self.sections);
        [emitters, sections].concat()
    }

    /// The sections of an emitter.
    pub fn of(&self, emitter: usize) -> &[[f32; 4]] {
        let e = &self.emitters[emitter];
        let first = e.first as usize;
        &self.sections[first..first + (e.ones + e.threes + e.sevens) as usize]
    }

    /// The numbers of the lighting of a view, whose extinction pyramid has so many levels, and whose volume of values
    /// has those of `range` as 0 and 1.
    pub fn info(
        &self,
        grid: &GridFacts,
        view: &View,
        levels: u32,
        range: [f64; 2],
    ) -> LightingInfo {
        let lighting = &view.style.lighting;
        let space = LightSpace::new(grid, view);
        let [position_low, position_scale] = position(view, range);
        LightingInfo {
            box_low: grid.bounds[0].as_vec3().to_array(),
            sigma: space.sigma as f32,
            scale: space.scale.as_vec3().to_array(),
            strength: lighting.occlusion.map_or(0.0, |o| o.strength as f32),
            size: (lighting.extent / space.sigma).as_vec3().to_array(),
            ambient: lighting.ambient as f32,
            light_size: lighting.light_size(),
            volumes: self.volumes.len().max(1) as u32,
            emitters: self.emitters.len() as u32,
            levels,
            position_low,
            position_scale,
            rays: lighting.rays,
            seed: lighting.seed,
            step: Lighting::REFERENCE_STEP as f32,
            gradient_scale: (view.style.transfer.reference_length / space.sigma) as f32,
            work: self.work,
            rays_gap: lighting.rays_gap as f32,
            around: match around::shells(lighting) {
                0 => around::DIRECTIONS,
                shells => shells,
            },
            around_attenuation: lighting
                .occlusion
                .map_or(0.0, |o| o.cone.attenuation as f32),
        }
    }
}

/// Distance from which directional light comes, in the units of its space.
pub const FAR: f32 = 1e30;

impl Emitter {
    /// The viewer: the eye, or what sees along the axis of a parallel camera. Nothing behind the plane of
    /// that one is in the way; where all of the model is before it, moving it changes nothing.
    fn viewer(space: &LightSpace<'_>) -> Self {
        let camera = &space.view.camera;
        if camera.parallel.is_none() {
            let position = camera.eye;
            return Self::at(&LightSource::Point { position }, DVec3::ONE, space);
        }
        let toward = -camera.forward;
        let viewer = Self::at(&LightSource::Directional { toward }, DVec3::ONE, space);
        let mut corners = space.view.world.corners.iter();
        let cuts = corners.any(|c| camera.depth(*c) < 0.0);
        let plane = cuts.then(|| space.point(camera.eye).to_array());
        Self {
            axis: plane.unwrap_or(viewer.axis),
            ..viewer
        }
    }

    /// Loop iterations of its cone, about.
    fn cone_work(&self) -> u32 {
        let counts = [self.ones, self.threes, self.sevens];
        let one: u32 = counts.iter().zip(SECTION_WORK).map(|(n, w)| n * w).sum();
        match self.is_around() {
            true => around::DIRECTIONS * one,
            false => one,
        }
    }

    /// True of a cone that is all of the sphere, wherever the emitter is.
    pub fn is_around(&self) -> bool {
        self.cosine < 0.0
    }

    /// What cones to it depend on: color and a spot's own cone are applied to samples.
    pub fn for_cones(self) -> Self {
        let is_directional = self.kind == layout::EMITTER_DIRECTIONAL;
        if self.is_around() {
            return Self {
                at: [0.0; 3],
                axis: [0.0; 3],
                kind: 0,
                first: 0,
                ..self
            };
        }
        Self {
            first: 0,
            color: [0.0; 3],
            axis: if is_directional { self.axis } else { [0.0; 3] },
            cos_outer: 0.0,
            cos_inner: 0.0,
            ..self
        }
    }

    fn at(source: &LightSource, color: DVec3, space: &LightSpace<'_>) -> Self {
        let none: Self = bytemuck::Zeroable::zeroed();
        let color = color.as_vec3().to_array();
        match *source {
            LightSource::Directional { toward } => {
                let toward = space.direction(toward);
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
                at: space.point(position).to_array(),
                color,
                ..none
            },
            LightSource::Spot {
                position,
                axis,
                opening,
            } => Self {
                kind: layout::EMITTER_SPOT,
                at: space.point(position).to_array(),
                axis: space.direction(axis).to_array(),
                cos_outer: opening.cos() as f32,
                cos_inner: (opening * (1.0 - SPOT_EDGE)).cos() as f32,
                color,
                ..none
            },
        }
    }
}
