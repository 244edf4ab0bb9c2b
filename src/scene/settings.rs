//! Settings of single strategies, and clip planes, as users write them.

use serde::{Deserialize, Serialize};

/// A plane that cuts a part of the model away.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClipSpec {
    /// A point of the plane in world coordinates.
    pub point: [f64; 3],
    /// Points to the part that is kept; any length but zero.
    pub normal: [f64; 3],
    /// How the section through the cells looks; in the mode `cells` it is opaque.
    #[serde(default)]
    pub face: CutFace,
}

/// How the section looks at which a clip plane cuts the cells.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CutFace {
    /// One looks on into the volume.
    #[default]
    Open,
    /// Opaque and colored by the field.
    Opaque,
}

/// Settings of the strategy LIBC.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LibcSettings {
    /// What is integrated.
    pub integration: Integration,
    /// Rays go on across fault faces; else each fault face ends a peel.
    pub cross_faults: bool,
}

impl Default for LibcSettings {
    fn default() -> Self {
        Self {
            integration: Integration::Samples,
            cross_faults: true,
        }
    }
}

/// Settings of the strategy PLTS.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PltsSettings {
    /// What is integrated.
    pub integration: Integration,
}

impl Default for PltsSettings {
    fn default() -> Self {
        Self {
            integration: Integration::Samples,
        }
    }
}

/// What rays integrate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Integration {
    /// The samples of the lattice that all strategies share.
    Samples,
    /// The part of a ray in each cell as a whole, with integrals of the transfer function.
    Segments,
}

/// How depths and values are held where they are many.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Storage {
    /// As f32.
    #[default]
    Exact,
    /// In 16 bits, rounded; on a GPU that halves the memory they take.
    Compact,
}

/// Settings of the strategy SRG. A switch that is a number is off at 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SrgSettings {
    /// Megabytes (2^20 bytes) on the device, of volume and pyramids; [`Self::BUDGET_MB`] where absent.
    pub budget_mb: Option<u32>,
    /// Voxels a cell along i, j and k; as large as the budget allows where absent.
    pub factor: Option<f64>,
    /// Values are divided by interpolated presence, so that they do not fade at the model's boundary.
    pub weighted: bool,
    /// What the transfer function makes empty is passed at once.
    pub skip_empty: bool,
    /// What varies by no more than this part of the color map's range is passed in one step.
    pub even: f64,
    /// Where no sample is more opaque than this, fewer samples are taken, of averages.
    pub thin: f64,
    /// Transmittance below which rays end by chance (Russian roulette).
    pub roulette: f64,
}

impl Default for SrgSettings {
    fn default() -> Self {
        Self {
            budget_mb: None,
            factor: None,
            weighted: true,
            skip_empty: true,
            even: 0.0,
            thin: 0.0,
            roulette: 0.0,
        }
    }
}

impl SrgSettings {
    /// Megabytes where the scene says nothing, on every adapter alike, so that a scene means one image. Filling so
    /// much takes an adapter in software 0.5 to 0.8 s of CPU time at each time step that is played.
    pub const BUDGET_MB: u32 = 32;

    /// Bytes that volume and pyramids may take.
    pub fn budget_bytes(&self) -> u64 {
        u64::from(self.budget_mb.unwrap_or(Self::BUDGET_MB)) << 20
    }
}
