//! Names of units as they stand in pictures.

/// A length unit of a grid file as it is written behind numbers.
pub fn short_unit(name: &str) -> String {
    match name {
        "METRES" => "m".into(),
        "FEET" => "ft".into(),
        other => other.to_lowercase(),
    }
}
