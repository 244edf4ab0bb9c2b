//! The geometry of a package's grid: nodes of coordinate lines as pillars and depths.

use rayon::prelude::*;
use strataray_parsers::resqml::{IjkGrid, LineKind, Lines, Points};
use strataray_parsers::units::LengthUnit;

use super::place::Place;

/// Corners that pillars miss by less than this, in the unit of the grid, are on them.
const STRAIGHT: f64 = 0.01;

/// Nodes of coordinate lines on the map.
pub(super) struct Nodes<'a> {
    grid: &'a IjkGrid,
    /// All lines of a node, then those of the next one.
    points: Vec<[f64; 3]>,
    lines: usize,
    /// By column, the lines at its corners, `2 * dj + di`.
    corners: Vec<[u32; 4]>,
}

/// How far corners are off straight pillars.
pub(super) struct Bent {
    pillars: usize,
    of: usize,
    most: f64,
}

impl Bent {
    pub(super) fn sentence(&self, unit: LengthUnit) -> String {
        format!(
            "{} of {} pillars are not straight: corners were moved along their layers by up to {:.3} {} onto straight ones",
            self.pillars,
            self.of,
            self.most,
            unit.name()
        )
    }
}

impl<'a> Nodes<'a> {
    pub(super) fn of(grid: &'a IjkGrid, place: &Place) -> Self {
        let lines = pillar_count(grid.dims) + grid.splits.len();
        let points = match &grid.points {
            Points::Nodes(numbers) => {
                let (points, _) = numbers.as_chunks::<3>();
                points.par_iter().map(|p| place.map(*p)).collect()
            }
            Points::Lines {
                parameters,
                lines: of_pillars,
            } => {
                let point = |(n, parameter): (usize, &f64)| {
                    let pillar = pillar_of(grid, n % lines);
                    place.map(point_at(of_pillars, pillar, *parameter))
                };
                parameters.par_iter().enumerate().map(point).collect()
            }
        };
        Self {
            points,
            lines,
            corners: corners(grid),
            grid,
        }
    }

    /// The points along a line, from the first node on.
    fn along(&self, line: usize) -> impl Iterator<Item = [f64; 3]> {
        let points = self.points[line..].iter().step_by(self.lines);
        points.copied().filter(|p| p.iter().all(|v| v.is_finite()))
    }

    /// Pillars through the uppermost and the lowest of their nodes, upper end first, and how far others are off them.
    /// A pillar without nodes takes the place of one before it, or behind.
    pub(super) fn pillars(&self) -> (Vec<[f64; 6]>, Option<Bent>) {
        let count = pillar_count(self.grid.dims);
        let mut of_pillar: Vec<Vec<usize>> = (0..count).map(|p| vec![p]).collect();
        for (n, split) in self.grid.splits.iter().enumerate() {
            of_pillar[split.pillar].push(count + n);
        }
        let has = |pillar: usize| self.grid.has_pillars.as_ref().is_none_or(|has| has[pillar]);
        let line = |(pillar, lines): (usize, &Vec<usize>)| {
            let lines = lines.iter().filter(|_| has(pillar));
            let points: Vec<[f64; 3]> = lines.flat_map(|line| self.along(*line)).collect();
            let top = points
                .iter()
                .copied()
                .min_by(|a, b| a[2].total_cmp(&b[2]))?;
            let bottom = points
                .iter()
                .copied()
                .max_by(|a, b| a[2].total_cmp(&b[2]))?;
            let off = points.iter().map(|p| off_line(top, bottom, *p));
            Some(([top, bottom], off.fold(0.0, f64::max)))
        };
        let found: Vec<Option<([[f64; 3]; 2], f64)>> =
            of_pillar.par_iter().enumerate().map(line).collect();
        let off = || found.iter().flatten().map(|(_, off)| *off);
        let bent = off().filter(|off| *off > STRAIGHT).count();
        let bent = (bent > 0).then(|| Bent {
            pillars: bent,
            of: count,
            most: off().fold(0.0, f64::max),
        });
        let first = found.iter().flatten().next();
        let mut last = first.map_or([[0.0; 3]; 2], |(line, _)| *line);
        let ends = found.iter().map(|found| {
            last = found.map_or(last, |(line, _)| line);
            let [[x, y, z], [u, v, w]] = last;
            [x, y, z, u, v, w]
        });
        (ends.collect(), bent)
    }

    /// Depths of all corners as decks have them, from the uppermost layer on, and which cells have all of theirs.
    pub(super) fn depths(&self, lines: &[[f64; 6]]) -> (Vec<f64>, Vec<bool>) {
        let [ni, nj, nk] = self.grid.dims;
        let upper = first_nodes(self.grid);
        let mut zcorn = vec![0.0; 8 * ni * nj * nk];
        let mut is_whole = vec![true; ni * nj * nk];
        let layers = zcorn.par_chunks_mut(8 * ni * nj);
        let layers = layers.zip(is_whole.par_chunks_mut(ni * nj)).enumerate();
        layers.for_each(|(k, (zcorn, is_whole))| {
            let is_upward = self.grid.is_upward;
            let node = upper[if is_upward { nk - 1 - k } else { k }];
            for (column, whole) in is_whole.iter_mut().enumerate() {
                for corner in 0..8 {
                    let [di, dj, dk] = [corner & 1, corner >> 1 & 1, corner >> 2];
                    let line = self.corners[column][corner & 3] as usize;
                    let below = if is_upward { 1 - dk } else { dk };
                    let [x, y, depth] = self.points[(node + below) * self.lines + line];
                    let pillar = pillar_of(self.grid, line);
                    let has_pillar = self.grid.has_pillars.as_ref().is_none_or(|h| h[pillar]);
                    let is_there =
                        has_pillar && x.is_finite() && y.is_finite() && depth.is_finite();
                    *whole &= is_there;
                    let (i, j) = (column % ni, column / ni);
                    let at = 2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * dk;
                    zcorn[at] = if is_there { depth } else { lines[pillar][2] };
                }
            }
        });
        (zcorn, is_whole)
    }
}

fn pillar_count([ni, nj, _]: [usize; 3]) -> usize {
    (ni + 1) * (nj + 1)
}

/// The pillar that a line belongs to.
fn pillar_of(grid: &IjkGrid, line: usize) -> usize {
    match line.checked_sub(pillar_count(grid.dims)) {
        Some(split) => grid.splits[split].pillar,
        None => line,
    }
}

/// By layer of the file, the node of the side where it begins.
fn first_nodes(grid: &IjkGrid) -> Vec<usize> {
    let mut node = 0;
    let first = |k: usize| {
        let first = node;
        node += 1 + usize::from(grid.gaps.get(k) == Some(&true));
        first
    };
    (0..grid.dims[2]).map(first).collect()
}

/// By column, the lines at its corners.
fn corners(grid: &IjkGrid) -> Vec<[u32; 4]> {
    let [ni, nj, _] = grid.dims;
    let pillar = |column: usize, corner: usize| {
        let [i, j] = [column % ni + (corner & 1), column / ni + (corner >> 1)];
        i + (ni + 1) * j
    };
    let columns = 0..ni * nj;
    let mut corners: Vec<[u32; 4]> = columns
        .map(|column| std::array::from_fn(|corner| pillar(column, corner) as u32))
        .collect();
    for (n, split) in grid.splits.iter().enumerate() {
        let line = pillar_count(grid.dims) + n;
        for &column in &split.columns {
            // A column that is not at the pillar has no corner there.
            let at = (0..4).find(|corner| pillar(column, *corner) == split.pillar);
            if let Some(corner) = at {
                corners[column][corner] = line as u32;
            }
        }
    }
    corners
}

/// Distance of a point from the line between two others, at its depth.
fn off_line(top: [f64; 3], bottom: [f64; 3], point: [f64; 3]) -> f64 {
    let height = bottom[2] - top[2];
    let share = match height > 0.0 {
        true => (point[2] - top[2]) / height,
        false => 0.0,
    };
    let off = |axis: usize| point[axis] - (top[axis] + share * (bottom[axis] - top[axis]));
    off(0).hypot(off(1))
}

/// The point of a pillar's line at a parameter; not finite where it has none.
fn point_at(lines: &Lines, pillar: usize, parameter: f64) -> [f64; 3] {
    let pillars = lines.kinds.len();
    let point = |knot: usize| -> [f64; 3] {
        std::array::from_fn(|axis| lines.points[3 * (knot * pillars + pillar) + axis])
    };
    match (lines.kinds[pillar], &lines.parameters) {
        (Some(LineKind::Vertical), _) => {
            let [x, y, _] = point(0);
            [x, y, parameter]
        }
        (Some(LineKind::Linear), Some(parameters)) => {
            let at = |knot: usize| parameters[knot * pillars + pillar];
            // Of the pieces the one that the parameter is in; the outer ones go on.
            let is_within = |knot: &usize| (parameter - at(*knot)) * (at(1) - at(0)) > 0.0;
            let knot = (1..lines.knots - 1).rev().find(is_within).unwrap_or(0);
            let share = (parameter - at(knot)) / (at(knot + 1) - at(knot));
            let (a, b) = (point(knot), point(knot + 1));
            std::array::from_fn(|axis| a[axis] + share * (b[axis] - a[axis]))
        }
        _ => [f64::NAN; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_lines_lie_between_their_knots() {
        let lines = Lines {
            knots: 3,
            kinds: vec![Some(LineKind::Linear), Some(LineKind::Vertical), None],
            points: [[0.0, 0.0, 100.0], [5.0, 6.0, 0.0], [0.0; 3]]
                .into_iter()
                .chain([[10.0, 0.0, 200.0], [0.0; 3], [0.0; 3]])
                .chain([[10.0, 40.0, 400.0], [0.0; 3], [0.0; 3]])
                .flatten()
                .collect(),
            parameters: Some([[0.0; 3], [1.0; 3], [2.0; 3]].concat()),
        };
        let at = |pillar, parameter| point_at(&lines, pillar, parameter);
        assert_eq!(at(0, 0.5), [5.0, 0.0, 150.0]);
        assert_eq!(at(0, 1.5), [10.0, 20.0, 300.0]);
        assert_eq!(at(0, 3.0), [10.0, 80.0, 600.0]);
        assert_eq!(at(1, 77.0), [5.0, 6.0, 77.0]);
        assert!(at(2, 1.0).iter().all(|v| v.is_nan()));
        // Parameters may fall along a line.
        let falling = Lines {
            parameters: Some([[4.0; 3], [2.0; 3], [0.0; 3]].concat()),
            ..lines
        };
        assert_eq!(point_at(&falling, 0, 3.0), [5.0, 0.0, 150.0]);
        assert_eq!(point_at(&falling, 0, 1.0), [10.0, 20.0, 300.0]);
    }
}
