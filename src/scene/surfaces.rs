//! Surfaces of cells, and wells, as scenes ask for them.

use serde::{Deserialize, Serialize};

use super::names::matches_any;

/// How the boundary faces of the drawn cells look.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hull {
    /// Not at all: one looks into the volume.
    #[default]
    Hidden,
    /// A faint gray: the outline of what is drawn, with its steps and holes, around the volume.
    Faint,
    /// Opaque and colored by the field.
    Opaque,
}

/// Which faults are drawn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "show.faults must be true, false or a list of names such as [\"F1\", \"F2\"]"
)]
pub enum ShownFaults {
    /// All of them, with and without a name, or none.
    All(bool),
    /// Those of these names alone.
    Named(Vec<String>),
}

impl From<bool> for ShownFaults {
    fn from(all: bool) -> Self {
        Self::All(all)
    }
}

impl ShownFaults {
    /// True where at least one is asked for.
    pub fn are_shown(&self) -> bool {
        match self {
            Self::All(all) => *all,
            Self::Named(names) => !names.is_empty(),
        }
    }

    /// True where the fault of a name, or those without one, are asked for.
    pub fn shows(&self, name: Option<&str>) -> bool {
        match self {
            Self::All(all) => *all,
            Self::Named(names) => name.is_some_and(|name| names.iter().any(|n| n == name)),
        }
    }
}

/// Which wells are drawn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "show.wells must be true, false or a list of names or patterns such as [\"P*\"]"
)]
pub enum ShownWells {
    /// All of them, or none.
    All(bool),
    /// Those whose names match one of these patterns, see [`super::names`].
    Named(Vec<String>),
}

impl From<bool> for ShownWells {
    fn from(all: bool) -> Self {
        Self::All(all)
    }
}

impl ShownWells {
    /// True where at least one is asked for.
    pub fn are_shown(&self) -> bool {
        match self {
            Self::All(all) => *all,
            Self::Named(names) => !names.is_empty(),
        }
    }

    /// True where the well of a name is asked for.
    pub fn shows(&self, name: &str) -> bool {
        match self {
            Self::All(all) => *all,
            Self::Named(names) => matches_any(names, name),
        }
    }
}
