//! Occlusion, lights and shadows, as users write them.
//!
//! Both effects look along a cone: occlusion toward the viewer, shadows toward a light
//! (campagnolo-2021, chapter 3 and 4.2). Defaults and ranges are the paper's.

use serde::{Deserialize, Serialize};

/// Occlusion and lights as a scene has them; nothing is shaded by default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightingSpec {
    /// Shading by what stands between a sample and the viewer; absent for none.
    pub occlusion: Option<OcclusionSpec>,
    /// Lights.
    pub lights: Vec<LightSpec>,
    /// How the lights' shadows are found.
    pub shadows: ShadowSpec,
    /// Part of the light that comes from everywhere and that occlusion shades; 1 without lights and 0.4
    /// with them where absent.
    pub ambient: Option<f64>,
    /// Lights make highlights and shade by the field's gradient.
    pub blinn_phong: bool,
    /// Only what carries no number is shaded: inactive cells. Colors of values stay exact.
    pub exact_colors: bool,
    /// Wells and fault sheets darken what lies behind them, as cells do.
    pub geometry: bool,
    /// Volumes that extinction and light are sampled into.
    pub volume: VolumeSpec,
    /// Rays over a cone in the mode `monte_carlo`.
    pub rays: u32,
    /// Distance at which rays over a cone start, in the mode `monte_carlo` and in the reference, in standard
    /// deviations of the finest level.
    pub rays_gap: f64,
    /// Picks the random numbers of the mode `monte_carlo`.
    pub seed: u32,
}

impl Default for LightingSpec {
    fn default() -> Self {
        Self {
            occlusion: None,
            lights: Vec::new(),
            shadows: ShadowSpec::default(),
            ambient: None,
            blinn_phong: false,
            exact_colors: false,
            geometry: true,
            volume: VolumeSpec::default(),
            rays: 16,
            rays_gap: 1.0,
            seed: 0,
        }
    }
}

/// Where the light along a cone is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LightMode {
    /// No shading.
    Off,
    /// By a cone at every sample of a ray: slower, more exact.
    Image,
    /// Precomputed in a light volume that the rays sample: fast.
    Preilluminated,
    /// By many rays over the cone at every sample: slow, for comparison.
    MonteCarlo,
}

/// How the light that comes to a point is found, and which way it is looked for. Shadows are looked for toward their
/// lights.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LightMethod {
    /// Along a cone toward the viewer: what lies before something else is seen. It changes with the camera.
    #[default]
    Cones,
    /// Along cones to all sides: hollows, faults and the inside are dark. It is there for good once it is made, so that
    /// the camera turns at no cost.
    Surround,
    /// To all sides by mean opacities of shells around a point (SPAO): quicker to make, less exact.
    SpaoMipmap,
    /// Along a cone through a pyramid of values (shih-2016): an edited curve needs no new pyramid.
    Vct,
    /// Along a cone by boxes of a summed-area table of extinction (schlegel-2011).
    Sat,
}

impl LightMethod {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Cones,
        Self::Surround,
        Self::SpaoMipmap,
        Self::Vct,
        Self::Sat,
    ];

    /// As scenes write it.
    pub const fn name(self) -> &'static str {
        ["cones", "surround", "spao_mipmap", "vct", "sat"][self as usize]
    }

    /// What it does and when to use it.
    pub const fn describe(self) -> &'static str {
        [
            "Cones toward the viewer: what lies before something else is seen; made anew when the camera moves",
            "Cones to all sides: hollows and the inside are dark; the camera turns at no cost",
            "To all sides by mean opacities of shells (SPAO): quicker to make, less exact",
            "Voxel cone tracing toward the viewer: edits of the curve are quickest; too dark beside what is opaque",
            "Boxes of a summed-area table toward the viewer: quickly made; shadows change as light or viewer turns",
        ][self as usize]
    }

    /// True where it looks to all sides, and not along a cone.
    pub const fn is_around(self) -> bool {
        matches!(self, Self::Surround | Self::SpaoMipmap)
    }
}

/// Occlusion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OcclusionSpec {
    /// Which way it looks, and how.
    #[serde(skip_serializing_if = "is_default")]
    pub method: LightMethod,
    /// Where it is found.
    pub mode: LightMode,
    /// Half of the cone's opening.
    pub half_angle_degrees: f64,
    /// Parts that the cone is split into at most: 1, 3 or 7.
    pub splits: u32,
    /// Factor on the extinction that occludes.
    pub attenuation: f64,
    /// Part of the darkening that is applied.
    pub strength: f64,
    /// Distance at which a cone starts, in standard deviations of the finest level.
    pub gap: f64,
    /// Length of a cone, as a part of the diagonal of the model's box.
    pub length: f64,
    /// Sections count as if the medium in them were even, so that even media are not too light.
    pub even_media: bool,
    /// Of the method `spao_mipmap`: each shell darkens as one voxel does, as in the paper; else by its thickness, which
    /// is right in even media and far too dark on opaque surfaces.
    #[serde(skip_serializing_if = "is_true")]
    pub per_shell: bool,
}

impl Default for OcclusionSpec {
    fn default() -> Self {
        Self {
            method: LightMethod::default(),
            mode: LightMode::Preilluminated,
            half_angle_degrees: 20.0,
            splits: 7,
            attenuation: 1.0,
            strength: 1.0,
            gap: 3.0,
            length: 0.5,
            even_media: false,
            per_shell: true,
        }
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_true(value: &bool) -> bool {
    *value
}

/// Shadows of all lights.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ShadowSpec {
    /// How they are found; none that looks to all sides.
    #[serde(skip_serializing_if = "is_default")]
    pub method: LightMethod,
    /// Where they are found.
    pub mode: LightMode,
    /// Parts that a cone is split into at most: 1, 3 or 7.
    pub splits: u32,
    /// Factor on the extinction that casts a shadow.
    pub attenuation: f64,
    /// Distance at which a cone starts, in standard deviations of the finest level.
    pub gap: f64,
    /// Length of a cone, as a part of the diagonal of the model's box.
    pub length: f64,
    /// As for occlusion.
    pub even_media: bool,
}

impl Default for ShadowSpec {
    fn default() -> Self {
        Self {
            method: LightMethod::default(),
            mode: LightMode::Preilluminated,
            splits: 1,
            attenuation: 1.0,
            gap: 3.0,
            length: 0.75,
            even_media: false,
        }
    }
}

/// A light. Positions and directions are in world coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum LightSpec {
    /// From far away, everywhere from the same side.
    Directional {
        /// Where its light goes.
        direction: [f64; 3],
        /// Half of the cone's opening: how soft its shadows are.
        #[serde(default = "shadow_half_angle")]
        half_angle_degrees: f64,
        /// Its part of the light; what ambient light leaves, divided by the lights, where absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        intensity: Option<f64>,
        /// `#rrggbb`.
        #[serde(default = "white")]
        color: String,
    },
    /// From a point to all sides.
    Point {
        /// Where it is.
        position: [f64; 3],
        /// As for a directional one.
        #[serde(default = "shadow_half_angle")]
        half_angle_degrees: f64,
        /// As for a directional one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        intensity: Option<f64>,
        /// `#rrggbb`.
        #[serde(default = "white")]
        color: String,
    },
    /// From a point within a cone.
    Spot {
        /// Where it is.
        position: [f64; 3],
        /// The axis of its light.
        direction: [f64; 3],
        /// Half of the opening of its light.
        #[serde(default = "spot_opening")]
        opening_degrees: f64,
        /// As for a directional one.
        #[serde(default = "shadow_half_angle")]
        half_angle_degrees: f64,
        /// As for a directional one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        intensity: Option<f64>,
        /// `#rrggbb`.
        #[serde(default = "white")]
        color: String,
    },
}

/// Half the opening of a light's cone in degrees, where a scene does not say.
pub const SHADOW_HALF_ANGLE: f64 = 1.0;

fn shadow_half_angle() -> f64 {
    SHADOW_HALF_ANGLE
}

fn spot_opening() -> f64 {
    30.0
}

fn white() -> String {
    "#ffffff".into()
}

/// Sizes of the volumes; chosen from the model's shape where absent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VolumeSpec {
    /// Megabytes (2^20 bytes) of the extinction volume on the device, while it is made.
    pub budget_mb: Option<u32>,
    /// Voxels of the extinction volume along the grid's x, y and depth.
    pub size: Option<[u32; 3]>,
    /// Voxels of a light volume; where absent an eighth of the extinction volume's, in flat models more along the depth.
    pub light_size: Option<[u32; 3]>,
}

/// Names of the presets, and what each does in a few words.
pub const PRESETS: [(&str, &str); 5] = [
    ("off", "no shading"),
    ("soft", "gentle occlusion"),
    ("strong", "strong occlusion"),
    (
        "key",
        "occlusion and a light with shadows from the upper left",
    ),
    ("technical", "exact colors; only inactive cells are shaded"),
];

impl LightingSpec {
    /// The preset called `name`.
    pub fn preset(name: &str) -> Option<Self> {
        let occlusion = |half_angle_degrees, attenuation, strength| {
            Some(OcclusionSpec {
                half_angle_degrees,
                attenuation,
                strength,
                ..OcclusionSpec::default()
            })
        };
        let none = Self::default();
        Some(match name {
            "off" => none,
            "soft" => Self {
                occlusion: occlusion(15.0, 0.8, 0.5),
                ..none
            },
            "strong" => Self {
                occlusion: occlusion(20.0, 1.2, 0.9),
                ..none
            },
            "key" => Self {
                occlusion: Some(OcclusionSpec::default()),
                lights: vec![LightSpec::key()],
                blinn_phong: true,
                ..none
            },
            "technical" => Self {
                occlusion: Some(OcclusionSpec::default()),
                exact_colors: true,
                ..none
            },
            _ => return None,
        })
    }

    /// Part of the light that comes from everywhere.
    pub fn ambient(&self) -> f64 {
        let least = if self.lights.is_empty() { 1.0 } else { 0.4 };
        self.ambient.unwrap_or(least)
    }

    /// Intensity of a light that names none: together with ambient light no brighter than without lights, so
    /// that colors stay within the legend.
    pub fn share_of_lights(&self) -> f64 {
        (1.0 - self.ambient()) / self.lights.len().max(1) as f64
    }
}

impl LightSpec {
    /// The key light of the preset of that name: from the upper left of a view to the north.
    pub fn key() -> Self {
        Self::Directional {
            direction: [1.0, -0.6, -1.6],
            half_angle_degrees: 2.0,
            intensity: None,
            color: white(),
        }
    }
}
