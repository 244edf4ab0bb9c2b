//! The ray-casting strategies: one host file and one shader each, chosen at run time by name.

/// Every strategy; the one list that command line, viewer and tests read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrategyKind {
    /// Point location with topological search.
    Plts,
}

impl StrategyKind {
    /// All strategies.
    pub const ALL: [Self; 1] = [Self::Plts];

    /// The name that users type.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plts => "plts",
        }
    }

    /// The strategy called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    /// One sentence for a name that is no strategy of this version.
    pub fn refusal(name: &str) -> String {
        let known: Vec<_> = Self::ALL.iter().map(|s| s.name()).collect();
        match name {
            "srg" | "libc" => format!("{name} is not supported yet; use {}", known.join(", ")),
            _ => format!("{name} is not known; use {}", known.join(", ")),
        }
    }
}
