//! Occlusion, lights and shadows, checked against a model.
//!
//! Both effects look along a cone: occlusion toward the viewer, shadows toward a light
//! (campagnolo-2021, chapter 3 and 4.2). Defaults and ranges are the paper's.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::error::{SceneError, within, wrong};
use crate::image::Blending;
use crate::scene::lighting::{
    LightMethod, LightMode, LightSpec, LightingSpec, OcclusionSpec, SHADOW_HALF_ANGLE, VolumeSpec,
};
use crate::transfer::presets::parse_color;

/// A cone along which light comes, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Half of its opening in radians.
    pub half_angle: f64,
    /// Parts that it is split into at most: 1, 3 or 7.
    pub splits: u32,
    /// Factor on the extinction along it.
    pub attenuation: f64,
    /// Distance at which it starts, in standard deviations of the finest level.
    pub gap: f64,
    /// Its length in world space.
    pub length: f64,
    /// Sections count as if the medium in them were even.
    pub even_media: bool,
}

impl Cone {
    /// True where it is all of the sphere: what stands at an emitter, or behind it, counts too.
    pub fn is_around(&self) -> bool {
        self.half_angle > FRAC_PI_2
    }
}

/// Where a light is and what it reaches, in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightSource {
    /// Light from far away; the unit vector points to it.
    Directional {
        /// Where it comes from.
        toward: DVec3,
    },
    /// Light from a point.
    Point {
        /// Where it is.
        position: DVec3,
    },
    /// Light from a point within a cone.
    Spot {
        /// Where it is.
        position: DVec3,
        /// Its axis, unit length.
        axis: DVec3,
        /// Half of its opening in radians.
        opening: f64,
    },
}

/// Changes of the transfer function's position over its reference length between which the gradient comes
/// to count: below the first there is no surface to shade.
pub const GRADIENT_FADE: [f64; 2] = [0.01, 0.1];
/// Highlights: their brightness as a part of the light, and the exponent of Blinn's cosine.
pub const SPECULAR: f64 = 0.25;
/// See [`SPECULAR`].
pub const SHININESS: f64 = 40.0;

/// Angles over which the light of a spot fades out at its edge, as a part of its opening.
pub const SPOT_EDGE: f64 = 0.1;

/// A light, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where it is.
    pub source: LightSource,
    /// Color (sRGB, 0..1).
    pub color: [f64; 3],
    /// Factor on its color.
    pub intensity: f64,
    /// Its cone.
    pub cone: Cone,
}

impl Light {
    /// Its color times intensity, in the numbers that are blended.
    pub fn blended(&self, blending: Blending) -> DVec3 {
        self.intensity * DVec3::from_array(blending.of_srgb(self.color))
    }
}

/// Occlusion toward the viewer, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Occlusion {
    /// Where it is found; never `Off`, nor `Image` of a method that looks to all sides.
    pub mode: LightMode,
    /// Which way it looks, and how.
    pub method: LightMethod,
    /// Of shells: each counts as one voxel, whatever its thickness.
    pub per_shell: bool,
    /// Its cone; all of the sphere for a method that looks to all sides.
    pub cone: Cone,
    /// Part of the darkening that is applied.
    pub strength: f64,
}

/// All of a view's lighting, checked.
///
/// A sample's color `c`, in the numbers that are blended, becomes `c * (ambient * (1 - strength * (1 - occlusion)) + sum of l * shadow *
/// diffuse) + sum of l * shadow * specular` over the lights, `l` a light's color. Occlusion and shadow are
/// transmittances of a cone from the sample toward the viewer, or toward the light. Light does not fade
/// with distance; a spot's fades to nothing over the edge of its cone, by a smooth step of the cosine.
///
/// With Blinn-Phong, `diffuse` is `1 - w + w |n d|` and `specular` is [`SPECULAR`]` w |n h|^`[`SHININESS`]:
/// `n` is the field's unit gradient (its sign means nothing), `d` the direction to the light, `h` the unit
/// vector halfway between it and the direction to the viewer, and `w` a smooth step over [`GRADIENT_FADE`]
/// of how much the transfer function's position changes along the gradient over a reference length. Values
/// that are constant in a cell have no gradient, nor do inactive cells: `w` is 0. Elsewhere `diffuse` is 1
/// and `specular` 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// Occlusion, where there is some.
    pub occlusion: Option<Occlusion>,
    /// The lights.
    pub lights: Vec<Light>,
    /// Where their shadows are found.
    pub shadows: LightMode,
    /// How they are found; never by a method that looks to all sides.
    pub shadow_method: LightMethod,
    /// Part of the light that comes from everywhere.
    pub ambient: f64,
    /// Lights make highlights and shade by the field's gradient.
    pub blinn_phong: bool,
    /// Only inactive cells are shaded.
    pub exact_colors: bool,
    /// Wells and sheets of faults stand in the way of light too.
    pub geometry: bool,
    /// Rays over a cone in the mode `MonteCarlo`.
    pub rays: u32,
    /// Distance at which they start, in standard deviations of the finest level. Cones have a gap of their own:
    /// their sections are wide, and would count the surface that they start from.
    pub rays_gap: f64,
    /// Picks their random numbers.
    pub seed: u32,
    /// World-space edges of the model's box along the grid's x, y and depth.
    pub extent: DVec3,
    volume: VolumeSpec,
    /// What [`Self::size`] gives: decided once, for the device and the reference alike.
    size: [u32; 3],
}

/// Voxels along an axis, at most.
const MOST_ALONG: u32 = 2048;
/// Voxels of the extinction volume for each cell of the grid, at most: about what the paper took for
/// its models of ten to fifty thousand cells.
const VOXELS_PER_CELL: f64 = 256.0;
/// Bytes that a voxel of the extinction volume takes while it is made: value, extinction, pyramid, in
/// half floats (campagnolo-2021, 4.3.4).
const VOXEL_BYTES: f64 = 2.0 * (2.0 + 1.0 / 7.0);
/// Megabytes of the extinction volume where the scene says nothing, on every adapter alike, so that a scene means
/// one image: what an adapter in software fills in about a second.
pub const BUDGET_MB: u32 = 10;

impl VolumeSpec {
    /// Voxels of the extinction volume over a box of a grid of so many cells: cubes in world space, unless the
    /// scene says otherwise.
    fn voxels(&self, extent: DVec3, cells: usize) -> [u32; 3] {
        self.size.unwrap_or_else(|| {
            let budget = self.budget_mb.unwrap_or(BUDGET_MB);
            let bytes = f64::from(budget) * f64::from(1 << 20);
            let voxels = (bytes / VOXEL_BYTES).min(VOXELS_PER_CELL * cells as f64);
            let edge = (extent.element_product() / voxels.max(1.0)).cbrt();
            (extent / edge)
                .to_array()
                .map(|n| (n.round() as u32).clamp(4, MOST_ALONG))
        })
    }
}

/// Voxels of a light volume along the depth, where the extinction volume has as many.
const LIGHT_DEPTH: u32 = 48;

impl Lighting {
    /// True where nothing is shaded.
    pub fn is_off(&self) -> bool {
        self.occlusion.is_none() && self.lights.is_empty()
    }

    /// The light on solid cells. Near a face that is seen at an angle a cone passes the body that the face bounds,
    /// so that faces would come out darker than what lies before them accounts for: half of it is applied.
    #[must_use]
    pub(crate) fn on_solid_cells(mut self) -> Self {
        if let Some(occlusion) = &mut self.occlusion {
            occlusion.strength *= 0.5;
        }
        self
    }

    /// Voxels of the extinction volume along the grid's x, y and depth.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// Megabytes (2^20 bytes) that the extinction volume may take where the scene names no size.
    pub fn budget_mb(&self) -> u32 {
        self.volume.budget_mb.unwrap_or(BUDGET_MB)
    }

    /// Voxels of a light volume.
    pub fn light_size(&self) -> [u32; 3] {
        let size = self.volume.light_size;
        size.unwrap_or_else(|| Self::light_size_of(self.size))
    }

    /// Voxels of a light volume of which the scene says nothing: an eighth of those of the extinction volume of
    /// `size`, half of them each way, but in flat models more along the depth. Light changes most across gently
    /// dipping layers: voxels as high as they are wide let the dark below a surface through in rings.
    pub fn light_size_of([x, y, depth]: [u32; 3]) -> [u32; 3] {
        let along = depth.div_ceil(2).max(LIGHT_DEPTH.min(depth));
        let lateral = (f64::from(depth) / f64::from(8 * along.max(1))).sqrt();
        let lateral = |n: u32| (lateral * f64::from(n)).ceil() as u32;
        [lateral(x), lateral(y), along]
    }

    /// Standard deviation of the finest level of the extinction pyramid, in world space: the mean edge of
    /// a voxel. Gaps and steps are in units of it.
    pub fn sigma(&self) -> f64 {
        let voxels = self.size.map(f64::from);
        (self.extent / DVec3::from_array(voxels)).element_sum() / 3.0
    }

    /// Distance of the samples of the rays of the mode `MonteCarlo`, in standard deviations of the finest
    /// level (campagnolo-2021, 3.5: half a voxel).
    pub const REFERENCE_STEP: f64 = 0.5;
}

/// Checks a scene's lighting for a model whose box has these edges in world space.
pub(crate) fn resolve(
    spec: &LightingSpec,
    extent: DVec3,
    cells: usize,
) -> Result<Lighting, SceneError> {
    let extent = extent.max(DVec3::splat(1e-6));
    let diagonal = extent.length();
    let occlusion = spec
        .occlusion
        .map(|o| occlusion(&o, diagonal))
        .transpose()?;
    let s = spec.shadows;
    let cone = |half_angle_degrees| -> Result<Cone, SceneError> {
        Ok(Cone {
            half_angle: within(
                "lighting.lights.half_angle_degrees",
                half_angle_degrees,
                [0.05, 10.0],
            )?
            .to_radians(),
            splits: splits("lighting.shadows.splits", s.splits)?,
            attenuation: within("lighting.shadows.attenuation", s.attenuation, [0.0, 4.0])?,
            gap: within("lighting.shadows.gap", s.gap, [0.0, 20.0])?,
            length: diagonal * within("lighting.shadows.length", s.length, [0.01, 1.0])?,
            even_media: s.even_media,
        })
    };
    if s.method.is_around() {
        let problem = format!(
            "{} looks to all sides; shadows are found along cones: cones, vct or sat",
            s.method.name()
        );
        return Err(wrong("lighting.shadows.method", problem));
    }
    // Checked even where no light has one.
    cone(SHADOW_HALF_ANGLE)?;
    let ambient = within("lighting.ambient", spec.ambient(), [0.0, 1.0])?;
    let share = spec.share_of_lights();
    let checked = |light| -> Result<Light, SceneError> {
        let (source, half_angle, intensity, color) = source(light)?;
        let intensity = intensity.unwrap_or(share);
        let color = parse_color(color)
            .ok_or_else(|| wrong("lighting.lights.color", "must be a color like #ffffff"))?;
        Ok(Light {
            source,
            color,
            intensity: within("lighting.lights.intensity", intensity, [0.0, 10.0])?,
            cone: cone(half_angle)?,
        })
    };
    if !(1..=1024).contains(&spec.rays) {
        return Err(wrong("lighting.rays", "must be 1 to 1024"));
    }
    volume(&spec.volume)?;
    Ok(Lighting {
        occlusion: occlusion.filter(|o| o.mode != LightMode::Off),
        lights: spec.lights.iter().map(checked).collect::<Result<_, _>>()?,
        shadows: s.mode,
        shadow_method: s.method,
        ambient,
        blinn_phong: spec.blinn_phong && !spec.lights.is_empty(),
        exact_colors: spec.exact_colors,
        geometry: spec.geometry,
        rays: spec.rays,
        rays_gap: within("lighting.rays_gap", spec.rays_gap, [0.0, 20.0])?,
        seed: spec.seed,
        extent,
        volume: spec.volume,
        size: spec.volume.voxels(extent, cells),
    })
}

fn occlusion(o: &OcclusionSpec, diagonal: f64) -> Result<Occlusion, SceneError> {
    let is_around = o.method.is_around();
    if is_around && o.mode == LightMode::Image {
        let problem = format!(
            "is preilluminated or monte_carlo with the method {}",
            o.method.name()
        );
        return Err(wrong("lighting.occlusion.mode", problem));
    }
    let half_angle = within(
        "lighting.occlusion.half_angle_degrees",
        o.half_angle_degrees,
        [1.0, 45.0],
    )?;
    Ok(Occlusion {
        mode: o.mode,
        method: o.method,
        per_shell: o.per_shell,
        cone: Cone {
            half_angle: match is_around {
                true => std::f64::consts::PI,
                false => half_angle.to_radians(),
            },
            splits: splits("lighting.occlusion.splits", o.splits)?,
            attenuation: within("lighting.occlusion.attenuation", o.attenuation, [0.0, 4.0])?,
            gap: within("lighting.occlusion.gap", o.gap, [0.0, 20.0])?,
            length: diagonal * within("lighting.occlusion.length", o.length, [0.01, 1.0])?,
            even_media: o.even_media,
        },
        strength: within("lighting.occlusion.strength", o.strength, [0.0, 1.0])?,
    })
}

fn source(light: &LightSpec) -> Result<(LightSource, f64, Option<f64>, &str), SceneError> {
    let unit = |v: &[f64; 3]| {
        DVec3::from_array(*v)
            .try_normalize()
            .ok_or_else(|| wrong("lighting.lights.direction", "must have a length above 0"))
    };
    let place = |v: &[f64; 3]| {
        let position = DVec3::from_array(*v);
        match position.is_finite() {
            true => Ok(position),
            false => Err(wrong(
                "lighting.lights.position",
                "must be three finite numbers",
            )),
        }
    };
    Ok(match light {
        LightSpec::Directional {
            direction,
            half_angle_degrees,
            intensity,
            color,
        } => {
            let toward = -unit(direction)?;
            let source = LightSource::Directional { toward };
            (source, *half_angle_degrees, *intensity, color)
        }
        LightSpec::Point {
            position,
            half_angle_degrees,
            intensity,
            color,
        } => {
            let position = place(position)?;
            let source = LightSource::Point { position };
            (source, *half_angle_degrees, *intensity, color)
        }
        LightSpec::Spot {
            position,
            direction,
            opening_degrees,
            half_angle_degrees,
            intensity,
            color,
        } => {
            let opening = within(
                "lighting.lights.opening_degrees",
                *opening_degrees,
                [0.5, 89.0],
            )?;
            let source = LightSource::Spot {
                position: place(position)?,
                axis: unit(direction)?,
                opening: opening.to_radians(),
            };
            (source, *half_angle_degrees, *intensity, color)
        }
    })
}

fn volume(spec: &VolumeSpec) -> Result<(), SceneError> {
    if spec.budget_mb == Some(0) {
        return Err(wrong("lighting.volume.budget_mb", "must be at least 1"));
    }
    for (field, size) in [
        ("lighting.volume.size", spec.size),
        ("lighting.volume.light_size", spec.light_size),
    ] {
        if size.is_some_and(|s| s.iter().any(|n| !(2..=MOST_ALONG).contains(n))) {
            let problem = format!("must be 2 to {MOST_ALONG} voxels along each axis");
            return Err(wrong(field, problem));
        }
    }
    Ok(())
}

fn splits(field: &'static str, splits: u32) -> Result<u32, SceneError> {
    match splits {
        1 | 3 | 7 => Ok(splits),
        _ => Err(wrong(field, format!("{splits} must be 1, 3 or 7"))),
    }
}
