//! The cells that a line goes through, as the path of a well.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::column::Column;
use super::corner_point::Hexahedron;
use super::face_tree::{is_met, meets_triangle};
use super::grid::Grid;
use super::ids::Ijk;
use super::topology::Face;

/// Parts of a segment shorter than this share of it are places where it touches a cell.
const TOUCHED: f64 = 1e-9;

/// The part of a line in a cell.
///
/// A place on a line of points is the number of the point before it, and the part of the way to the next one: 2.5 lies
/// in the middle between the third and the fourth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The cell.
    pub cell: Ijk,
    /// Places at which the line enters and leaves it, or ends in it.
    pub part: [f64; 2],
}

/// The point at a place on a line, as [`Crossing`] counts them.
pub fn point_at(line: &[DVec3], place: f64) -> DVec3 {
    let last = line.len().saturating_sub(1);
    let before = (place.max(0.0) as usize).min(last);
    let point = |n: usize| line.get(n).copied().unwrap_or_default();
    point(before).lerp(point((before + 1).min(last)), place - before as f64)
}

impl Grid {
    /// The active cells that a line of points in grid space goes through, in its order. A cell that it comes back to is
    /// there again; of cells that lie over each other, as one and the local grid that refines it, each is there.
    pub fn crossed_by(&self, line: &[DVec3]) -> Vec<Crossing> {
        let Some(box_of_all) = self.bounds() else {
            return Vec::new();
        };
        let segments: Vec<(usize, [DVec3; 2])> = line
            .windows(2)
            .map(|ends| [ends[0], ends[1]])
            .enumerate()
            .filter(|(_, ends)| is_near(box_of_all, *ends))
            .collect();
        if segments.is_empty() {
            return Vec::new();
        }
        let columns = self.columns();
        let each = columns.flat_map_iter(|column| in_column(&column, &segments));
        let mut parts: Vec<Crossing> = each.collect();
        parts.sort_by(|a, b| a.part[0].total_cmp(&b.part[0]));
        joined(parts)
    }
}

/// Parts of the segments in the active cells of a column.
fn in_column(column: &Column<'_>, segments: &[(usize, [DVec3; 2])]) -> Vec<Crossing> {
    let Some(ends) = column.ends(column.active()) else {
        return Vec::new();
    };
    let corners = ends.as_flattened();
    let bounds = bounds_of(corners);
    let near = segments.iter().filter(|(_, ends)| is_near(bounds, *ends));
    let near: Vec<_> = near.collect();
    if near.is_empty() {
        return Vec::new();
    }
    let mut found = Vec::new();
    for k in column.active().filter(|k| column.has_thickness(*k)) {
        let cell = column.hexahedron(k);
        let bounds = cell.bounds();
        for (number, ends) in near.iter().filter(|(_, ends)| is_near(bounds, *ends)) {
            let part = inside(&cell, *ends);
            found.extend(part.map(|part| Crossing {
                cell: Ijk {
                    i: column.i,
                    j: column.j,
                    k,
                },
                part: part.map(|t| *number as f64 + t),
            }));
        }
    }
    found
}

/// The part of a segment in a cell, 0 to 1: between the first and the last of its faces that the line meets, each of
/// them two triangles, as neighbors have them too.
fn inside(cell: &Hexahedron, [a, b]: [DVec3; 2]) -> Option<[f64; 2]> {
    let direction = b - a;
    let [low, high] = cell.bounds();
    // From outside of the cell, so that all faces lie ahead.
    let back = 1.0 + (low.distance(high) + a.distance(low)) / direction.length();
    let origin = a - back * direction;
    let mut part = [f64::INFINITY, f64::NEG_INFINITY];
    for face in Face::ALL {
        let [a, b, c, d] = face.corners()[0].map(|n| cell.0[n]);
        for triangle in [[a, b, d], [a, d, c]] {
            if let Some(distance) = meets_triangle(origin, direction, triangle) {
                part = [part[0].min(distance), part[1].max(distance)];
            }
        }
    }
    let part = part.map(|distance| (distance - back).clamp(0.0, 1.0));
    (part[1] - part[0] > TOUCHED).then_some(part)
}

/// Parts that go on in the same cell behind a point of the line are one.
fn joined(parts: Vec<Crossing>) -> Vec<Crossing> {
    let mut joined: Vec<Crossing> = Vec::new();
    let mut last: HashMap<Ijk, usize> = HashMap::new();
    for part in parts {
        let before = last.get(&part.cell).and_then(|at| joined.get_mut(*at));
        match before {
            Some(before) if part.part[0] - before.part[1] < TOUCHED => {
                before.part[1] = before.part[1].max(part.part[1]);
            }
            _ => {
                last.insert(part.cell, joined.len());
                joined.push(part);
            }
        }
    }
    joined
}

fn bounds_of(points: &[DVec3]) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let widened = |[low, high]: [DVec3; 2], p: &DVec3| [low.min(*p), high.max(*p)];
    points.iter().fold(start, widened)
}

/// False where a segment misses a box.
fn is_near([low, high]: [DVec3; 2], [a, b]: [DVec3; 2]) -> bool {
    a != b
        && a.min(b).cmple(high).all()
        && a.max(b).cmpge(low).all()
        && is_met([low, high], a, b - a)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::model::{Dims, GridInput};

    /// Cells of 10 x 10 x 2 on pillars that lean toward x.
    fn leaning() -> Grid {
        let dims = Dims {
            ni: 4,
            nj: 3,
            nk: 5,
        };
        let coord: Vec<f64> = (0..20)
            .flat_map(|n| {
                let (x, y) = (10.0 * f64::from(n % 5), 10.0 * f64::from(n / 5));
                [x, y, 0.0, x + 5.0, y, 10.0]
            })
            .collect();
        let zcorn: Vec<f64> = (0..8 * dims.cells())
            .map(|at| 2.0 * (at / 48).div_ceil(2) as f64)
            .collect();
        let input = GridInput {
            dims,
            coord: &coord,
            zcorn: &zcorn,
            actnum: None,
            map_axes: None,
        };
        Grid::new(&input).unwrap()
    }

    #[test]
    fn lines_go_through_the_cells_in_which_their_points_lie() {
        let grid = leaning();
        let mut random = fastrand::Rng::with_seed(7);
        let mut place = |low: f64, high: f64| low + (high - low) * random.f64();
        let mut parts = 0;
        for _ in 0..200 {
            let mut point = || DVec3::new(place(-5.0, 50.0), place(-5.0, 35.0), place(-2.0, 12.0));
            let line = [point(), point(), point()];
            let found = grid.crossed_by(&line);
            parts += found.len();
            for n in 0..400 {
                let at = 2.0 * (f64::from(n) + 0.5) / 400.0;
                let p = point_at(&line, at);
                let (i, j, k) = ((p.x - 0.5 * p.z) / 10.0, p.y / 10.0, p.z / 2.0);
                let is_inside = (0.0..4.0).contains(&i) && (0.0..3.0).contains(&j);
                let is_inside = is_inside && (0.0..5.0).contains(&k);
                let cell = is_inside.then_some(Ijk {
                    i: i as usize,
                    j: j as usize,
                    k: k as usize,
                });
                let mut over = found.iter().filter(|c| c.part[0] < at && at < c.part[1]);
                let said = over.next().map(|c| c.cell);
                // Beside a face one of both cells is as good.
                let is_near_face = [i, j, k].iter().any(|v| (v - v.round()).abs() < 1e-6);
                assert!(is_near_face || said == cell, "{p} {said:?} {cell:?}");
                assert!(is_near_face || over.next().is_none());
            }
            assert!(found.is_sorted_by(|a, b| a.part[0] <= b.part[0]));
        }
        assert!(parts > 1000, "{parts}");
    }

    #[test]
    fn a_line_on_diagonals_and_along_points_is_whole() {
        let grid = leaning();
        // Down through the middle of a column, with points inside of cells and on their faces.
        let line: Vec<DVec3> = [-3.0, 1.0, 2.0, 5.5, 20.0]
            .iter()
            .map(|z| DVec3::new(15.0 + 0.5 * z, 15.0, *z))
            .collect();
        let found = grid.crossed_by(&line);
        let cells: Vec<_> = found
            .iter()
            .map(|c| (c.cell.i, c.cell.j, c.cell.k))
            .collect();
        assert_eq!(cells, [0, 1, 2, 3, 4].map(|k| (1, 1, k)));
        assert!((found[0].part[0] - 0.75).abs() < 1e-9);
        assert_eq!(grid.crossed_by(&line[..1]), []);
        let beside: Vec<DVec3> = line.iter().map(|p| *p + DVec3::X * 100.0).collect();
        assert_eq!(grid.crossed_by(&beside), []);
    }
}
