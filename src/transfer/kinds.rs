//! What kind of quantity a property is, by its name in simulators' files.

use super::opacity::Interest;

/// A kind of quantity, as far as it matters for how it looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Part of the pores that oil fills: 0 to 1.
    Oil,
    /// Part of the pores that water fills.
    Water,
    /// Part of the pores that gas, or carbon dioxide, fills.
    Gas,
    /// Part of the pores that another phase fills.
    OtherPhase,
    /// A pressure.
    Pressure,
    /// Permeabilities, transmissibilities and their multipliers, volumes: over many powers of ten.
    Wide,
    /// Numbers of regions or rock types.
    Region,
    /// A part of the rock: porosity, net to gross.
    Fraction,
    /// Difference to a step.
    Difference,
    /// Depths.
    Depth,
    /// Amplitudes of seismic, about zero.
    Amplitude,
    /// Anything else.
    Other,
}

/// Names, or their beginnings (`PERM*`) or ends (`*NUM`); the first that fits counts.
const NAMES: [(Quantity, &[&str]); 10] = [
    (
        Quantity::Region,
        &["*NUM", "FIP*", "FACIES*", "*FACIES", "ROCKTYPE", "NNC"],
    ),
    (Quantity::Oil, &["SOIL"]),
    (Quantity::Water, &["SWAT", "SWATINIT"]),
    (Quantity::Gas, &["SGAS", "XMF*", "YMF*"]),
    (Quantity::OtherPhase, &["SSOL*"]),
    (Quantity::Pressure, &["PRES*", "*PRES"]),
    (
        Quantity::Wide,
        &["PERM*", "TRAN*", "MULT*", "PORV", "CELL_VOLUME"],
    ),
    (Quantity::Fraction, &["PORO", "NTG"]),
    (Quantity::Depth, &["DEPTH", "TOPS"]),
    (Quantity::Amplitude, &["AMPLITUDE*", "SEISMIC*"]),
];

impl Quantity {
    /// The kind of the property called `name`, whatever its letter case; a difference is
    /// `PRESSURE-PRESSURE@0`.
    pub fn of(name: &str) -> Self {
        let name = name.to_ascii_uppercase();
        if name.contains('@') {
            return Self::Difference;
        }
        // How far the values of several cases are spread is another quantity than these.
        if name.ends_with(".STD") {
            return Self::Other;
        }
        // Of matrix, fractures or both, or a statistic over cases.
        let name = name.split('.').next().unwrap_or_default();
        let fits = |pattern: &&str| match (pattern.strip_suffix('*'), pattern.strip_prefix('*')) {
            (Some(start), _) => name.starts_with(start),
            (_, Some(end)) => name.ends_with(end),
            _ => name == *pattern,
        };
        let found = NAMES.iter().find(|(_, names)| names.iter().any(fits));
        found.map_or(Self::Other, |(quantity, _)| *quantity)
    }

    /// Which of its values one looks for.
    pub fn interest(self) -> Interest {
        match self {
            Self::Pressure => Interest::Low,
            Self::Difference | Self::Amplitude => Interest::Ends,
            Self::Region | Self::Depth => Interest::Alike,
            Self::Oil
            | Self::Water
            | Self::Gas
            | Self::OtherPhase
            | Self::Wide
            | Self::Fraction
            | Self::Other => Interest::High,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_their_kind() {
        for (name, kind) in [
            ("SWAT", Quantity::Water),
            ("soil", Quantity::Oil),
            ("SGAS", Quantity::Gas),
            ("PRESSURE", Quantity::Pressure),
            ("PERMX", Quantity::Wide),
            ("TRANZ", Quantity::Wide),
            ("MULTX-", Quantity::Wide),
            ("MULTNUM", Quantity::Region),
            ("SATNUM", Quantity::Region),
            ("FACIES", Quantity::Region),
            ("PORO", Quantity::Fraction),
            ("PRESSURE-PRESSURE@0", Quantity::Difference),
            ("DEPTH", Quantity::Depth),
            ("PORV", Quantity::Wide),
            ("Amplitude.far", Quantity::Amplitude),
            ("RS", Quantity::Other),
            ("SWAT.MEAN", Quantity::Water),
            ("SWAT.STD", Quantity::Other),
            ("", Quantity::Other),
        ] {
            assert_eq!(Quantity::of(name), kind, "{name}");
        }
    }
}
