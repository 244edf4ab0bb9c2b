//! What kind of quantity a property is, by its name in simulators' files.

/// A kind of quantity, as far as it matters for colors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Part of the pores that a phase fills: 0 to 1.
    Saturation,
    /// A pressure.
    Pressure,
    /// Permeabilities, transmissibilities and their multipliers: over many powers of ten.
    Conductivity,
    /// Numbers of regions or rock types.
    Region,
    /// A part of the rock: porosity, net to gross.
    Fraction,
    /// Difference to a step.
    Difference,
    /// Depths.
    Depth,
    /// Anything else.
    Other,
}

/// Names, or their beginnings (`PERM*`) or ends (`*NUM`); the first that fits counts.
const NAMES: [(Quantity, &[&str]); 6] = [
    (
        Quantity::Region,
        &["*NUM", "FIP*", "FACIES*", "*FACIES", "ROCKTYPE", "NNC"],
    ),
    (Quantity::Saturation, &["SWAT", "SGAS", "SOIL", "SSOL"]),
    (Quantity::Pressure, &["PRES*", "*PRES"]),
    (Quantity::Conductivity, &["PERM*", "TRAN*", "MULT*"]),
    (Quantity::Fraction, &["PORO", "NTG"]),
    (Quantity::Depth, &["DEPTH", "TOPS"]),
];

impl Quantity {
    /// The kind of the property called `name`, whatever its letter case; a difference is
    /// `PRESSURE-PRESSURE@0`.
    pub fn of(name: &str) -> Self {
        let name = name.to_ascii_uppercase();
        if name.contains('@') {
            return Self::Difference;
        }
        let fits = |pattern: &&str| match (pattern.strip_suffix('*'), pattern.strip_prefix('*')) {
            (Some(start), _) => name.starts_with(start),
            (_, Some(end)) => name.ends_with(end),
            _ => name == **pattern,
        };
        let found = NAMES.iter().find(|(_, names)| names.iter().any(fits));
        found.map_or(Self::Other, |(quantity, _)| *quantity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_their_kind() {
        for (name, kind) in [
            ("SWAT", Quantity::Saturation),
            ("soil", Quantity::Saturation),
            ("PRESSURE", Quantity::Pressure),
            ("PERMX", Quantity::Conductivity),
            ("TRANZ", Quantity::Conductivity),
            ("MULTX-", Quantity::Conductivity),
            ("MULTNUM", Quantity::Region),
            ("SATNUM", Quantity::Region),
            ("FACIES", Quantity::Region),
            ("PORO", Quantity::Fraction),
            ("PRESSURE-PRESSURE@0", Quantity::Difference),
            ("DEPTH", Quantity::Depth),
            ("SWATINIT", Quantity::Other),
            ("", Quantity::Other),
        ] {
            assert_eq!(Quantity::of(name), kind, "{name}");
        }
    }
}
