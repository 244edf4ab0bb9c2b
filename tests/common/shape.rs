//! Grids whose pillars, depths and values are functions of their place, written as decks and loaded.

use std::fmt::Write;

use strataray::case::{Case, load};

/// A grid by formula; points are (x, y, depth).
pub struct Shape<'a> {
    pub dims: [usize; 3],
    /// Upper and lower end of pillar (i, j).
    pub pillar: &'a dyn Fn(usize, usize) -> [[f64; 3]; 2],
    /// Depth of a corner (di, dj, dk) of cell (i, j, k).
    pub depth: &'a dyn Fn([usize; 3], [usize; 3]) -> f64,
    /// Value of a cell.
    pub value: &'a dyn Fn([usize; 3]) -> f64,
    /// True for an active cell.
    pub active: &'a dyn Fn([usize; 3]) -> bool,
    /// Keywords behind the others.
    pub keywords: &'a str,
}

impl Default for Shape<'_> {
    /// Two by two by two cells of 100 x 100 x 20, the top at depth 1000; every value 0.5.
    fn default() -> Self {
        Self {
            dims: [2, 2, 2],
            pillar: &|i, j| {
                let [x, y] = [100.0 * i as f64, 100.0 * j as f64];
                [[x, y, 900.0], [x, y, 1100.0]]
            },
            depth: &|[_, _, k], [_, _, dk]| 1000.0 + 20.0 * (k + dk) as f64,
            value: &|_| 0.5,
            active: &|_| true,
            keywords: "",
        }
    }
}

impl Shape<'_> {
    /// The grid with its property `VALUE`, as the program loads it from a file.
    pub fn case(&self) -> Case {
        let [ni, nj, nk] = self.dims;
        let mut text = format!("SPECGRID\n {ni} {nj} {nk} 1 F /\nCOORD\n");
        for j in 0..=nj {
            for i in 0..=ni {
                for v in (self.pillar)(i, j).as_flattened() {
                    write!(text, "{v} ").unwrap();
                }
            }
        }
        text += "/\nZCORN\n";
        for at in 0..8 * ni * nj * nk {
            let (x, rest) = (at % (2 * ni), at / (2 * ni));
            let (y, z) = (rest % (2 * nj), rest / (2 * nj));
            let depth = (self.depth)([x / 2, y / 2, z / 2], [x % 2, y % 2, z % 2]);
            write!(text, "{depth} ").unwrap();
        }
        let cells = || (0..ni * nj * nk).map(|c| [c % ni, c / ni % nj, c / ni / nj]);
        text += "/\nACTNUM\n";
        for ijk in cells() {
            write!(text, "{} ", u8::from((self.active)(ijk))).unwrap();
        }
        text += "/\nVALUE\n";
        for ijk in cells() {
            write!(text, "{} ", (self.value)(ijk)).unwrap();
        }
        text += "/\n";
        text += self.keywords;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shape.grdecl");
        std::fs::write(&path, text).unwrap();
        load::open(&path).unwrap()
    }
}

/// Boxes between planes, the first depth at the top; values by cell.
pub fn boxes(x: &[f64], y: &[f64], depth: &[f64], value: &dyn Fn([usize; 3]) -> f64) -> Case {
    Shape {
        dims: [x, y, depth].map(|planes| planes.len() - 1),
        pillar: &|i, j| [depth[0], depth[depth.len() - 1]].map(|d| [x[i], y[j], d]),
        depth: &|[_, _, k], [_, _, dk]| depth[k + dk],
        value,
        ..Shape::default()
    }
    .case()
}

/// Equal parallelepipeds, 6 x 5 x 4: leaning pillars, dipping layers. There the mean of the cells around
/// an inner vertex is a linear field's value.
pub mod parallelepipeds {
    use glam::DVec3;

    use super::Shape;
    use strataray::case::Case;

    pub const DIMS: [usize; 3] = [6, 5, 4];

    /// A vertex in grid space.
    pub fn corner(i: usize, j: usize, k: usize) -> DVec3 {
        let [i, j, k] = [i as f64, j as f64, k as f64];
        let depth = 2000.0 + 12.0 * i - 7.0 * j + 15.0 * k;
        let lean = DVec3::new(0.3, -0.2, 0.0) * (depth - 2000.0);
        DVec3::new(110.0 * i + 8.0 * j, 90.0 * j - 5.0 * i, depth) + lean
    }

    /// The grid with a linear field, to which a quadratic one may be added, as cells have it.
    pub fn case(square: f64) -> Case {
        let center = |[i, j, k]: [usize; 3]| 0.5 * (corner(i, j, k) + corner(i + 1, j + 1, k + 1));
        Shape {
            dims: DIMS,
            pillar: &|i, j| [corner(i, j, 0), corner(i, j, 4)].map(|p| p.to_array()),
            depth: &|[i, j, k], [di, dj, dk]| corner(i + di, j + dj, k + dk).z,
            value: &|ijk| value(center(ijk), square),
            ..Shape::default()
        }
        .case()
    }

    /// The field at a point of grid space.
    pub fn value(p: DVec3, square: f64) -> f64 {
        3.0 + p.dot(DVec3::new(2e-3, -3e-3, 4e-3)) + square * p.x.powi(2)
    }
}

/// Three by three columns of two layers that cross: from 1000 to 1020, and from 1010 to 1030.
pub fn crossing() -> Case {
    Shape {
        dims: [3, 3, 2],
        depth: &|[_, _, k], [_, _, dk]| 1000.0 + 10.0 * k as f64 + 20.0 * dk as f64,
        value: &|[_, _, k]| 0.1 + 0.2 * k as f64,
        ..Shape::default()
    }
    .case()
}
