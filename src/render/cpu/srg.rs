//! SRG, structured resampled grid (campagnolo-2021, 4.1.1; accelerations: volumetric-ray-tracing survey, 8).
//! The twin of `shaders/srg.wgsl`.
//!
//! Rays take samples of the common lattice, between the first and the last boundary face that they meet, from a volume
//! that is filled by point location. A ray passes a brick of it, or a larger part, at once where it is empty; in one
//! step where it is even; in longer steps, from the average pyramid, where it is thin.

use glam::{Vec3A, Vec4};

use super::bricks::{Bricks, Pass};
use super::each::Each;
use super::frame::{AHEAD, PixelRay, Ray};
use super::illumination::Source;
use super::kept::Kept;
use super::random::{pcg, unit};
use super::raster::Met;
use super::resample::{Field, Resampler};
use super::scene::Scene;
use super::surfaces::Layers;
use super::tally::Tally;
use super::transfer::Accumulated;
use crate::model::Dims;
use crate::render::job::Progress;
use crate::render::plan::bricks::{Classifier, Limits};
use crate::render::plan::layout::{BRICK, VolumeInfo};
use crate::render::plan::srg::{limits, shape, useful};
use crate::render::plan::volume::volume_info;
use crate::scene::SrgSettings;
use crate::transfer::TransferFunction;
use crate::view::voxels::Shape;

/// Voxels along an axis, at most: what every adapter holds.
const MOST_ALONG: u32 = 2048;

/// The volume, kept from image to image.
#[derive(Default)]
pub struct Srg {
    filled: Kept<Filled>,
    numbers: Option<Numbers>,
}

/// The volume with its pyramids, and what they were made from.
struct Filled {
    shape: Shape,
    /// Values that are stored as 0 and 1.
    range: [f64; 2],
    field: Field,
    bricks: Option<Bricks>,
    /// What the bricks are classified for.
    classified: Option<(TransferFunction, Limits, bool)>,
}

/// What of a view rays through the volume need to know.
#[derive(Clone, Copy)]
struct Numbers {
    settings: SrgSettings,
    info: VolumeInfo,
    /// Transfer-function position of a stored value: offset and factor.
    position: [f32; 2],
    by_brick: bool,
}

impl Srg {
    /// Brings the volume of a view up to date; `dims` are those of the grid that rays pass.
    pub async fn update(&mut self, source: &Source<'_>, dims: Dims, progress: &Progress) {
        let view = source.view;
        let settings = useful(view);
        let ghosts = view.shown.cells.ghosts.is_some();
        let shape = shape(dims, &settings, ghosts, settings.budget_bytes(), MOST_ALONG);
        let revision = source.revisions.values;
        if self.filled.get().is_some_and(|f| f.shape != shape) || !self.filled.is_of(revision) {
            self.filled.forget();
            let range = view.shown.cells.value_range().unwrap_or([0.0, 1.0]);
            let resampler = Resampler::new(source.grid, shape.size, range);
            let mut field = resampler.field(progress).await;
            field.average(shape.levels, progress).await;
            let filled = Filled {
                shape,
                range,
                field,
                bricks: None,
                classified: None,
            };
            self.filled.keep(revision, filled);
        }
        let Some(filled) = self.filled.get_mut() else {
            return;
        };
        let limits = limits(&settings, view.sampling.step);
        if !limits.are_never() {
            filled.classify(source, &settings, limits, progress).await;
        }
        let [low, scale] = view.style.transfer.positions(filled.range);
        let facts = &source.grid.compact.facts;
        self.numbers = Some(Numbers {
            settings,
            info: volume_info(facts, shape.size, filled.range, source.grid.interpolation),
            position: [low as f32, scale as f32],
            by_brick: !limits.are_never(),
        });
    }

    /// What rays sample, as the last update has left it.
    pub fn volume(&self) -> Option<SrgVolume<'_>> {
        let filled = self.filled.get()?;
        let numbers = self.numbers?;
        Some(SrgVolume {
            field: &filled.field,
            bricks: filled.bricks.as_ref().filter(|_| numbers.by_brick),
            averages: filled.shape.levels - 1,
            size: Vec3A::from_array(filled.shape.size.map(|n| n as f32)),
            box_low: numbers.info.box_low.into(),
            box_extent: numbers.info.box_extent.into(),
            position: numbers.position,
            settings: numbers.settings,
        })
    }

    /// Bytes of the volume.
    pub fn bytes(&self) -> u64 {
        let bytes = |f: &Filled| f.field.bytes() + f.bricks.as_ref().map_or(0, Bricks::bytes);
        self.filled.get().map_or(0, bytes)
    }
}

impl Filled {
    /// Makes the bricks where they are not there, and classifies them anew where transfer function or settings have
    /// changed.
    async fn classify(
        &mut self,
        source: &Source<'_>,
        settings: &SrgSettings,
        limits: Limits,
        progress: &Progress,
    ) {
        let mut bricks = match self.bricks.take() {
            Some(bricks) => bricks,
            None => {
                self.classified = None;
                Bricks::new(&self.field, self.shape.size, progress).await
            }
        };
        let by = (
            source.view.style.transfer.clone(),
            limits,
            settings.weighted,
        );
        if self.classified.as_ref() != Some(&by) {
            let classifier = Classifier {
                transfer: &by.0,
                range: self.range,
                limits,
                weighted: settings.weighted,
            };
            bricks.classify(&classifier, self.shape.levels - 1);
            self.classified = Some(by);
        }
        self.bricks = Some(bricks);
    }
}

/// What rays sample.
pub struct SrgVolume<'a> {
    field: &'a Field,
    /// Rays ask the bricks how to pass them; else every sample is taken.
    bricks: Option<&'a Bricks>,
    /// Levels of the average pyramid.
    averages: u32,
    /// Voxels along each axis.
    size: Vec3A,
    /// Grid space relative to the origin.
    box_low: Vec3A,
    box_extent: Vec3A,
    position: [f32; 2],
    settings: SrgSettings,
}

/// Samples that are taken alike.
struct Stretch {
    end: f32,
    /// Samples that one stands for, and the level of the average pyramid that it is taken from.
    stride: f32,
    level: u32,
}

/// Numbers of the first sample between the boundary faces that a ray meets, and of the one after the last.
pub fn span(met: &[Met], through: &PixelRay, ray: &Ray, step: f32) -> Option<[f32; 2]> {
    let turned = |sense: i32| {
        let points = met.iter().filter_map(move |m| m.point);
        let of = points.filter(move |(_, turn)| *turn == sense);
        of.map(|(depth, _)| (depth * f64::from(through.slant)) as f32)
    };
    let exit = turned(-1).reduce(f32::max)?;
    let entry = match ray.starts_inside {
        true => ray.enter,
        false => turned(1).reduce(f32::min)?,
    };
    let first = ((entry / step - 0.5).ceil() - ray.first).max(0.0);
    let last = ((exit / step - 0.5).floor() - ray.first).min(ray.count - 1.0);
    Some([first, last + 1.0])
}

/// What a ray takes its samples from.
pub struct Way<'a> {
    /// What all rays read.
    pub scene: &'a Scene<'a>,
    /// Values.
    pub volume: &'a SrgVolume<'a>,
    /// The pixel of the ray.
    pub pixel: [u32; 2],
    /// The ray.
    pub ray: &'a Ray,
    /// Its first sample, and the one after its last.
    pub span: [f32; 2],
}

/// Adds what a ray meets to what is there.
pub fn cast(way: &Way<'_>, layers: &mut Layers, sum: &mut Accumulated, tally: &mut Tally) {
    let Way {
        scene,
        volume,
        pixel,
        ray,
        span: [first, end],
    } = *way;
    let base = (ray.base - volume.box_low) / volume.box_extent;
    let advance = ray.advance / volume.box_extent;
    let long_steps = volume.settings.even > 0.0 || volume.settings.thin > 0.0;
    let roulette = volume.settings.roulette as f32;
    let mut stretch = Stretch {
        end: if volume.bricks.is_some() { 0.0 } else { end },
        stride: 1.0,
        level: 0,
    };
    let mut sees_nothing = true;
    let mut n = first;
    while n < end && scene.transfer.is_open(sum) {
        // Where all steps are alike, bricks are asked only where a sample shows nothing.
        if n >= stretch.end && (long_steps || sees_nothing) {
            stretch = volume.stretch_at(base + n * advance, advance, n, end);
        }
        if stretch.stride == 0.0 {
            n = stretch.end;
            tally.skips += 1;
            continue;
        }
        let left = match long_steps {
            true => stretch.end - n,
            false => end - n,
        };
        let taken = stretch.stride.min(left);
        let count = (left / taken).clamp(1.0, 4.0) as usize;
        let middles = n + 0.5 * (taken - 1.0) + taken * AHEAD;
        let places = middles.to_array().each(|n| base + n * advance);
        let four = volume.four(scene, places, &stretch, taken);
        for (lane, middle) in middles.to_array().into_iter().enumerate().take(count) {
            let distance = ray.distance(scene.frame.numbers.step, middle);
            layers.blend_until(scene, sum, distance);
            let sample = four.sample(lane);
            let met = u64::from(sample.is_met);
            tally.samples += met;
            tally.skips += 1 - met;
            sees_nothing = sample.opacity == 0.0 && sample.ghost == 0.0;
            if !sees_nothing {
                let length = taken * scene.frame.numbers.step;
                sample.add(scene, ray, [distance, length], sum);
            }
            n += taken;
            if sum.transmittance < roulette {
                let survives = random(pixel, n as u32) * roulette < sum.transmittance;
                sum.transmittance = if survives { roulette } else { 0.0 };
            }
            if !scene.transfer.is_open(sum) {
                break;
            }
        }
    }
}

/// Four samples of the volume.
struct Four {
    entries: [Vec4; 4],
    /// Of the field and of ghosts, for all samples that each of them stands for.
    opacities: Vec4,
    ghosts: Vec4,
    /// Presence of either.
    presences: Vec4,
}

/// One of them.
struct Sample {
    color: Vec3A,
    opacity: f32,
    ghost: f32,
    is_met: bool,
}

impl Four {
    fn sample(&self, lane: usize) -> Sample {
        Sample {
            color: Vec3A::from_vec4(self.entries[lane]),
            opacity: self.opacities[lane],
            ghost: self.ghosts[lane],
            is_met: self.presences[lane] > 0.0,
        }
    }
}

impl Sample {
    /// Adds it to what is there; it lies at a distance along the ray and stands for so much of it.
    fn add(&self, scene: &Scene<'_>, ray: &Ray, at: [f32; 2], sum: &mut Accumulated) {
        let light = &mut sum.light;
        let mut shade = |color, is_ghost| {
            let shading = &scene.shading;
            shading.shade_along(color, light, ray, at, is_ghost)
        };
        let (opacity, ghost) = (self.opacity, self.ghost);
        if ghost == 0.0 {
            let color = shade(self.color, false);
            return sum.blend(color, opacity);
        }
        let gray = shade(Vec3A::from_vec4(scene.ghost), true);
        let color = match opacity > 0.0 {
            true => shade(self.color, false),
            false => gray,
        };
        sum.blend(
            (opacity * color + ghost * gray) / (opacity + ghost),
            opacity + ghost,
        );
    }
}

impl SrgVolume<'_> {
    /// Samples at four places, each of which stands for `taken` of the lattice; opacities are multiplied by presence.
    #[inline]
    fn four(&self, scene: &Scene<'_>, places: [Vec3A; 4], stretch: &Stretch, taken: f32) -> Four {
        let found = self.field.samples(places, stretch.level as usize);
        let [values, presences, ghosts] = found;
        let stored = match self.settings.weighted {
            true => values / presences.max(Vec4::splat(1e-6)),
            false => values,
        };
        let [low, scale] = self.position;
        let (entries, passed) = scene.transfer.at_four(low + scale * stored);
        let mut four = Four {
            entries,
            opacities: presences * (1.0 - passed),
            ghosts: ghosts * (1.0 - scene.transfer.passed(scene.ghost.w)),
            presences: presences + ghosts,
        };
        if taken != 1.0 {
            let one = four.opacities + four.ghosts;
            let all = 1.0 - Vec4::from_array((1.0 - one).to_array().each(|p| p.powf(taken)));
            let factor = all / one.max(Vec4::splat(1e-30));
            (four.opacities, four.ghosts) = (factor * four.opacities, factor * four.ghosts);
        }
        four
    }

    /// How a ray goes on from sample n at `at` (0 to 1 in the box), up to sample `end`.
    fn stretch_at(&self, at: Vec3A, advance: Vec3A, n: f32, end: f32) -> Stretch {
        let mut stretch = Stretch {
            end,
            stride: 1.0,
            level: 0,
        };
        let Some(bricks) = self.bricks else {
            return stretch;
        };
        let (voxel, motion) = (at * self.size, advance * self.size);
        let count = bricks.count();
        let brick = [0, 1, 2].map(|a| (voxel[a].max(0.0) as u32 / BRICK).min(count[a] - 1));
        let (pass, level) = bricks.pass(brick);
        let side = BRICK << level;
        let low = Vec3A::from_array(brick.map(|n| ((n >> level) * side) as f32));
        let is_up = motion.cmpgt(Vec3A::ZERO);
        let ahead = Vec3A::select(is_up, low + side as f32, low) - voxel;
        let stands = motion.abs().cmplt(Vec3A::splat(1e-12));
        let steps = Vec3A::select(stands, Vec3A::splat(1e6), ahead / motion);
        let leaves = steps.min_element().ceil().max(1.0);
        stretch.end = (n + leaves).min(end);
        match pass {
            Pass::Plain => {}
            Pass::Empty => stretch.stride = 0.0,
            Pass::Even => stretch.stride = leaves,
            Pass::Thin => {
                stretch.level = (u32::from(level) + 1).min(self.averages);
                stretch.stride = (stretch.level as f32).exp2();
            }
        }
        stretch
    }
}

/// A number in [0, 1) that depends on pixel and sample alone.
fn random([x, y]: [u32; 2], sample: u32) -> f32 {
    let row = pcg(y.wrapping_add(pcg(sample)));
    unit(pcg(x.wrapping_add(row)))
}
