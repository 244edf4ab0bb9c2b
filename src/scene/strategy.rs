//! The ray-casting strategies by name.

use serde::{Deserialize, Serialize};

/// Every strategy; the one list that command line, viewer and tests read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StrategyKind {
    /// Linear interpolation with barycentric coordinates.
    Libc,
    /// Point location with topological search.
    #[default]
    Plts,
    /// Structured resampled grid.
    Srg,
}

impl StrategyKind {
    /// All strategies.
    pub const ALL: [Self; 3] = [Self::Libc, Self::Plts, Self::Srg];

    /// The accurate one: what the others are measured against where the f64 reference takes too long.
    pub const fn accurate() -> Self {
        Self::Plts
    }

    /// The name that users type.
    pub fn name(self) -> &'static str {
        match self {
            Self::Libc => "libc",
            Self::Plts => "plts",
            Self::Srg => "srg",
        }
    }

    /// What it is in one sentence.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Libc => "Walks from cell to cell: close to exact, fast",
            Self::Plts => "Locates every sample in its cell: exact, slow",
            Self::Srg => "Samples a resampled volume: fastest, blurs faults and thin layers",
        }
    }
}
