//! What a search for points has to know of each column: how wide of its section cells may lie, and where
//! nothing but a search of all cells will do.

use glam::DVec2;
use rayon::prelude::*;

use crate::model::{Column, Grid, Hexahedron};

/// One column.
#[derive(Debug, Clone, Copy, Default)]
pub struct ColumnShape {
    /// Depth does not grow with the layer on some pillar, so that no search by depth works.
    pub layers_cross: bool,
    /// Position in `COLUMN_MARGINS`.
    pub margin_level: usize,
    /// Points of it are found only by a search of all cells and of all their parts.
    pub is_odd: bool,
}

/// All columns of a grid, i fastest.
pub fn shapes(grid: &Grid) -> Vec<ColumnShape> {
    grid.columns().map(|column| shape(&column)).collect()
}

fn shape(column: &Column<'_>) -> ColumnShape {
    let slopes = Slopes::of(column);
    let mut margin = 0.0f64;
    let mut folded = false;
    for k in column.active() {
        let cell = column.hexahedron(k);
        margin = margin.max(cell_margin(&cell, slopes.spread));
        let may_fold = !folded && !slopes.leave_one_sign(&cell);
        folded |= may_fold && column.has_thickness(k) && folds(&cell);
    }
    let layers_cross = !column.is_sorted;
    let level = margin_level(margin);
    ColumnShape {
        layers_cross,
        margin_level: level.unwrap_or(COLUMN_MARGINS.len() - 1),
        is_odd: layers_cross || level.is_none() || folded,
    }
}

/// How a column's pillars lean.
struct Slopes {
    mean: DVec2,
    /// Largest distance of a slope from the mean.
    spread: f64,
}

impl Slopes {
    fn of(column: &Column<'_>) -> Self {
        let slopes = column.slopes();
        let mean = slopes.iter().sum::<DVec2>() / 4.0;
        let spread = slopes.iter().map(|s| s.distance(mean)).fold(0.0, f64::max);
        Self { mean, spread }
    }

    /// True where the Jacobian of a cell of the column has one sign for sure, which most cells show with little work.
    ///
    /// It is a mean of products of one edge along each axis. Along a pillar of slope `s` an edge is a height times
    /// `(s, 1)`, and the product the height times the cross product of the two others as they are seen along that
    /// pillar. So it has one sign where the heights have one, and all cross products within the bounds of these views.
    fn leave_one_sign(&self, cell: &Hexahedron) -> bool {
        let heights = [0, 1, 2, 3].map(|c| cell.0[c + 4].z - cell.0[c].z);
        let [x, y] = self.views(cell, [[0, 1], [2, 3], [4, 5], [6, 7]]);
        let [u, v] = self.views(cell, [[0, 2], [1, 3], [4, 6], [5, 7]]);
        let [low, high] = difference(product(x, v), product(y, u));
        let is_one = |of: &[f64]| of.iter().all(|h| *h >= 0.0) || of.iter().all(|h| *h <= 0.0);
        is_one(&heights) && (low > 0.0 || high < 0.0)
    }

    /// Bounds of x and of y of some edges as they are seen along any of the pillars.
    fn views(&self, cell: &Hexahedron, edges: [[usize; 2]; 4]) -> [[f64; 2]; 2] {
        let mut low = DVec2::INFINITY;
        let mut high = DVec2::NEG_INFINITY;
        let mut rise = 0.0f64;
        for [a, b] in edges {
            let edge = cell.0[b] - cell.0[a];
            let seen = edge.truncate() - self.mean * edge.z;
            (low, high) = (low.min(seen), high.max(seen));
            rise = rise.max(edge.z.abs());
        }
        let aside = DVec2::splat(self.spread * rise);
        let (low, high) = (low - aside, high + aside);
        [[low.x, high.x], [low.y, high.y]]
    }
}

/// Bounds of the product of two numbers within bounds.
fn product(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let all = [a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]];
    [
        all[0].min(all[1]).min(all[2].min(all[3])),
        all[0].max(all[1]).max(all[2].max(all[3])),
    ]
}

/// Bounds of the difference of two numbers within bounds.
fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[1], a[1] - b[0]]
}

/// Margins that a column can have; the shader has the same list.
pub const COLUMN_MARGINS: [f64; 8] = [0.002, 0.01, 0.03, 0.08, 0.2, 0.5, 1.0, 2.0];

/// The smallest level that covers a margin with half as much again to spare, if there is one.
fn margin_level(margin: f64) -> Option<usize> {
    let wanted = 1.5 * margin + 1e-3;
    COLUMN_MARGINS.iter().position(|m| *m >= wanted)
}

/// How far outside the column's horizontal section, in cell widths, a point of a cell may lie: pillars
/// that are not parallel meet a dipping layer at different depths.
fn cell_margin(cell: &Hexahedron, spread: f64) -> f64 {
    if spread == 0.0 {
        return 0.0;
    }
    let corners = &cell.0;
    let dip = |c: [usize; 4]| {
        let [a, b, c, d] = c.map(|c| corners[c].z);
        a.max(b).max(c.max(d)) - a.min(b).min(c.min(d))
    };
    let width = [[0, 1], [2, 3], [0, 2], [1, 3]]
        .iter()
        .map(|&[a, b]| (corners[a] - corners[b]).truncate().length_squared())
        .fold(f64::MAX, f64::min)
        .sqrt();
    spread * dip([0, 1, 2, 3]).max(dip([4, 5, 6, 7])) / width.max(1e-9)
}

/// Part of the largest coefficient that one of the other sign must have to count.
const ROUNDING: f64 = 1e-6;

/// True where the Jacobian of a cell may change its sign inside, so that the cell has some points twice, and
/// Newton's method may find a place outside though there is one inside.
///
/// The Jacobian is of degree two in each parameter. Its values are means, with weights that are not negative,
/// of its Bernstein coefficients; these are sums of products of one edge along each axis.
fn folds(cell: &Hexahedron) -> bool {
    let edge = |corner: usize, axis: usize| cell.0[corner | 1 << axis] - cell.0[corner];
    let mut coefficients = [0.0f64; 27];
    for n in 0..64 {
        let bit = |b: usize| n >> b & 1;
        let (u, v, w) = (
            edge(2 * bit(0) + 4 * bit(1), 0),
            edge(bit(2) + 4 * bit(3), 1),
            edge(bit(4) + 2 * bit(5), 2),
        );
        let at = [bit(2) + bit(4), bit(0) + bit(5), bit(1) + bit(3)];
        coefficients[at[0] + 3 * at[1] + 9 * at[2]] += u.dot(v.cross(w));
    }
    let high = coefficients.iter().fold(0.0f64, |a, &b| a.max(b));
    let low = coefficients.iter().fold(0.0f64, |a, &b| a.max(-b));
    high.min(low) > ROUNDING * high.max(low)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn unit_cell(mut by: impl FnMut(usize, DVec3) -> DVec3) -> Hexahedron {
        Hexahedron(std::array::from_fn(|c| {
            let at = DVec3::new((c & 1) as f64, (c >> 1 & 1) as f64, (c >> 2) as f64);
            by(c, at)
        }))
    }

    #[test]
    fn folds_are_where_the_jacobian_has_both_signs() {
        let mut random = fastrand::Rng::with_seed(5);
        let [mut folded, mut plain] = [0; 2];
        for n in 0..2000 {
            let off = f64::from(n % 10) / 10.0;
            let cell = unit_cell(|_, p| {
                let mut one = || off * (2.0 * random.f64() - 1.0);
                p + DVec3::new(one(), one(), one())
            });
            let mut signs = [false; 2];
            for _ in 0..200 {
                let mut one = || 2.0 * random.f64() - 1.0;
                let at = DVec3::new(one(), one(), one());
                signs[usize::from(cell.jacobian(at).determinant() < 0.0)] = true;
            }
            // The coefficients enclose the values, so none is overlooked; most that are flagged do fold.
            assert!(folds(&cell) || signs != [true; 2]);
            folded += usize::from(folds(&cell));
            plain += usize::from(folds(&cell) && signs != [true; 2]);
        }
        assert!(folded > 500 && 2 * plain < folded, "{folded} {plain}");
    }

    #[test]
    fn ok_pinched_and_turned_cells_do_not_fold() {
        for by in [
            (|c, p| if c == 4 { DVec3::ZERO } else { p }) as fn(usize, DVec3) -> DVec3,
            |c, p| {
                if c & 1 == 1 {
                    p * DVec3::new(1.0, 0.0, 1.0)
                } else {
                    p
                }
            },
            |_, p| p * DVec3::new(1.0, 1.0, -1.0),
            |_, _| DVec3::ZERO,
        ] {
            assert!(!folds(&unit_cell(by)));
        }
        // A reflex corner in plan.
        assert!(folds(&unit_cell(|c, p| if c & 3 == 3 {
            p * DVec3::new(0.4, 0.4, 1.0)
        } else {
            p
        })));
    }
}
