//! Properties that follow from the geometry alone.

use rayon::prelude::*;

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
    /// Column number along i, from 1.
    I,
    /// Column number along j, from 1.
    J,
    /// Layer, from 1.
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
        let dims = grid.dims();
        let of = |ijk: Ijk| match self {
            Self::Depth => grid.hexahedron(ijk).center().z,
            Self::Thickness => thickness(grid, ijk),
            Self::Volume => grid.hexahedron(ijk).signed_volume().abs(),
            Self::I => (ijk.i + 1) as f64,
            Self::J => (ijk.j + 1) as f64,
            Self::K => (ijk.k + 1) as f64,
            Self::Actnum => 1.0,
        };
        let values = grid.active_cells().par_iter();
        CellField::new(values.map(|&cell| of(dims.ijk(cell)) as f32).collect())
    }
}

fn thickness(grid: &Grid, ijk: Ijk) -> f64 {
    let edge = |c: usize| grid.corner_depth(ijk, c + 4) - grid.corner_depth(ijk, c);
    (0..4).map(edge).sum::<f64>() / 4.0
}
