//! Properties that follow from the geometry alone.

use super::fields::CellField;
use super::grid::Grid;
use super::ids::Ijk;

/// A property computed from the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derived {
    /// Depth of the cell's center (mean of its corners).
    Depth,
    /// Mean length of the four edges along the pillars, measured vertically.
    Thickness,
    /// Volume of the trilinear map, without sign.
    Volume,
    /// Column number along i, from 1, of a local grid in that grid.
    I,
    /// Column number along j, from 1, likewise.
    J,
    /// Layer, from 1, likewise.
    K,
    /// 1 in every active cell.
    Actnum,
}

impl Derived {
    /// All of them, with the name under which a user asks for each.
    pub const ALL: [(&'static str, Self); 7] = [
        ("DEPTH", Self::Depth),
        ("THICKNESS", Self::Thickness),
        ("CELL_VOLUME", Self::Volume),
        ("I", Self::I),
        ("J", Self::J),
        ("K", Self::K),
        ("ACTNUM", Self::Actnum),
    ];

    /// The property over the active cells of a grid.
    pub fn field(self, grid: &Grid) -> CellField {
        let along = |axis: usize, i: usize, j: usize, k: usize| {
            grid.cell_name(Ijk { i, j, k }).ijk[axis] as f64
        };
        CellField::new(grid.map_active(|column, k| {
            let value = match self {
                Self::Depth => column.hexahedron(k).center().z,
                Self::Thickness => column.thickness(k),
                Self::Volume => column.hexahedron(k).signed_volume().abs(),
                Self::I => along(0, column.i, column.j, k),
                Self::J => along(1, column.i, column.j, k),
                Self::K => along(2, column.i, column.j, k),
                Self::Actnum => 1.0,
            };
            value as f32
        }))
    }
}

/// A saturation that follows from others: 1 minus their sum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SaturationRest {
    /// Its name.
    pub name: &'static str,
    /// The saturations that are taken away from 1.
    pub of: Vec<&'static str>,
    /// A saturation that should be taken away too and is not there.
    pub lacks: Option<&'static str>,
}

/// The saturation that files leave out because it follows from those they have, if there is one.
///
/// `phases` is 1 for oil, 2 for water, 4 for gas, added; 0 where unknown, which is taken for oil and water with
/// gas where that has a saturation. Solvent takes its part of the pore space beside them.
pub fn rest_of_saturations(phases: i32, has: impl Fn(&str) -> bool) -> Option<SaturationRest> {
    let phases = match phases {
        0 if has("SGAS") => 7,
        0 => 3,
        known => known,
    };
    let all = [(1, "SOIL"), (2, "SWAT"), (4, "SGAS")];
    let of_case = all.iter().filter(|(bit, _)| phases & bit != 0);
    let (mut of, missing): (Vec<_>, Vec<_>) = of_case.map(|(_, name)| *name).partition(|n| has(n));
    let (name, lacks) = match missing[..] {
        [name] if !of.is_empty() => (name, None),
        // Water alone is written where the run has no free gas.
        ["SOIL", lacks] if of == ["SWAT"] => ("SOIL", Some(lacks)),
        _ => return None,
    };
    of.extend(["SSOLVENT", "SSOL"].into_iter().find(|name| has(name)));
    Some(SaturationRest { name, of, lacks })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saturations_follow_from_the_phases_of_the_case() {
        let rest = |phases: i32, known: &[&str]| {
            let rest = rest_of_saturations(phases, |name| known.contains(&name));
            rest.map(|r| (r.name, r.of.join(" "), r.lacks))
        };
        let of = |name, of: &str| Some((name, of.to_owned(), None));
        assert_eq!(rest(7, &["SWAT", "SGAS"]), of("SOIL", "SWAT SGAS"));
        assert_eq!(rest(3, &["SWAT"]), of("SOIL", "SWAT"));
        assert_eq!(
            rest(7, &["SWAT", "SGAS", "SSOLVENT"]),
            of("SOIL", "SWAT SGAS SSOLVENT")
        );
        // Without an oil phase there is no oil.
        assert_eq!(rest(6, &["SWAT"]), of("SGAS", "SWAT"));
        assert_eq!(rest(6, &["SWAT", "SGAS"]), None);
        assert_eq!(rest(2, &["SWAT"]), None);
        assert_eq!(rest(5, &["SGAS"]), of("SOIL", "SGAS"));
        assert_eq!(rest(0, &["SWAT"]), of("SOIL", "SWAT"));
        assert_eq!(rest(0, &["SWAT", "SGAS"]), of("SOIL", "SWAT SGAS"));
        assert_eq!(rest(7, &["SWAT", "SGAS", "SOIL"]), None);
        assert_eq!(
            rest(7, &["SWAT"]),
            Some(("SOIL", "SWAT".into(), Some("SGAS")))
        );
        assert_eq!(rest(0, &["PORO"]), None);
    }
}
