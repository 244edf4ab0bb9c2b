//! The ray-casting strategies by name.

use serde::{Deserialize, Serialize};

/// Every strategy; the one list that command line, viewer and tests read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", try_from = "String")]
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
    pub const fn name(self) -> &'static str {
        match self {
            Self::Libc => "libc",
            Self::Plts => "plts",
            Self::Srg => "srg",
        }
    }

    /// What it is in one sentence.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Libc => "Walks from cell to cell: close to exact, fast",
            Self::Plts => "Locates every sample in its cell: exact, slow",
            Self::Srg => "Samples a resampled volume: fastest, blurs faults and thin layers",
        }
    }
}

impl TryFrom<String> for StrategyKind {
    type Error = String;

    /// The strategy called so, or a sentence that says which ones there are.
    fn try_from(name: String) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|s| s.name() == name);
        known.ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|s| s.name()).collect();
            format!("strategy: {name} is not known; use {}", names.join(", "))
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn strategies_go_by_their_names() {
        for kind in StrategyKind::ALL {
            let text = serde_json::to_string(&kind).unwrap();
            assert_eq!(text, format!("\"{}\"", kind.name()));
            assert_eq!(serde_json::from_str::<StrategyKind>(&text).unwrap(), kind);
        }
        let said = serde_json::from_str::<StrategyKind>("\"fast\"").unwrap_err();
        assert!(
            said.to_string()
                .contains("fast is not known; use libc, plts")
        );
    }
}
