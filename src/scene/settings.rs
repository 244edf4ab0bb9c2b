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
    /// How the section through the cells looks.
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

/// What a cell-to-cell walk integrates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Integration {
    /// The samples of the lattice that all strategies share.
    Samples,
    /// Each segment in a cell as a whole, with integrals of the transfer function.
    Segments,
}
