//! Where wells go, in world space.

use glam::{DMat3, DVec3};

use super::{BEYOND, Measures};
use crate::case::{Connection, ConnectionAxis, Well, WellPath};
use crate::model::crossings::point_at;
use crate::model::{Crossing, Grid, Ijk};

/// What flows between a well and the cells around a part of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Flow {
    /// It is not connected to them.
    None,
    /// It is open to them.
    Open,
    /// Its connection is closed.
    Closed,
}

impl Flow {
    fn of(connection: &Connection) -> Self {
        match connection.is_open {
            true => Self::Open,
            false => Self::Closed,
        }
    }
}

/// A straight part of a well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    pub(super) ends: [DVec3; 2],
    pub(super) flow: Flow,
}

/// A well from its head on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Course {
    pub(super) head: DVec3,
    pub(super) pieces: Vec<Piece>,
}

/// A well through its cells, and up to a head above the model: those that it is connected to, or, where it has no
/// connections, those that its path goes through. `None` where it has no cell in a grid shown.
pub(super) fn through_cells(grid: &Grid, well: &Well, measures: &Measures<'_>) -> Option<Course> {
    let in_cells = match &well.path {
        Some(path) if well.connections.is_empty() => on_path(grid, path, measures),
        _ => connected(grid, well, measures),
    };
    let tops = measures.corners.iter().map(|corner| corner.z);
    let top = tops.fold(f64::MIN, f64::max) + BEYOND * measures.diagonal();
    let head = in_cells.first()?.ends[0].with_z(top);
    let mut pieces = Vec::new();
    let mut before = head;
    for piece in in_cells {
        if before.distance(piece.ends[0]) > 1e-9 * measures.diagonal() {
            pieces.push(Piece {
                ends: [before, piece.ends[0]],
                flow: Flow::None,
            });
        }
        before = piece.ends[1];
        pieces.push(piece);
    }
    Some(Course { head, pieces })
}

/// The parts of a well in the cells that it is connected to, from the head on.
fn connected(grid: &Grid, well: &Well, measures: &Measures<'_>) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    for connection in well.finest_connections(grid) {
        let Some([a, b]) = ends(grid, connection, measures) else {
            continue;
        };
        // The nearer end comes first; of the first cell the upper one.
        let is_turned = match pieces.last().map(|piece| piece.ends[1]) {
            Some(before) => before.distance(b) < before.distance(a),
            None => b.z > a.z,
        };
        pieces.push(Piece {
            ends: if is_turned { [b, a] } else { [a, b] },
            flow: Flow::of(connection),
        });
    }
    pieces
}

/// Middles of the two faces through which a well passes a cell; `None` where that lies in no grid.
fn ends(grid: &Grid, connection: &Connection, measures: &Measures<'_>) -> Option<[DVec3; 2]> {
    let cell = grid.placed(connection.cell_in(grid)?);
    let corners = grid.hexahedron(cell).0;
    let bit = match connection.axis {
        ConnectionAxis::I => 0,
        ConnectionAxis::J => 1,
        ConnectionAxis::K => 2,
    };
    let middle = |end: usize| {
        let of_face = (0..8).filter(|n| n >> bit & 1 == end);
        0.25 * of_face.map(|n| corners[n]).sum::<DVec3>()
    };
    let world_from_grid = measures.spaces.world_from_grid;
    Some([middle(0), middle(1)].map(|p| world_from_grid.transform_point3(p)))
}

/// The parts of a path in the cells of a grid of any space, between the places in them where it enters and leaves.
fn on_path(grid: &Grid, path: &WellPath, measures: &Measures<'_>) -> Vec<Piece> {
    let piece = |crossing: &Crossing| {
        let cell = grid.in_map_space().hexahedron(crossing.cell);
        let here = grid.hexahedron(grid.placed(crossing.cell));
        let end = |place: f64| {
            let inside = cell.parameters_near(point_at(&path.points, place));
            let world_from_grid = measures.spaces.world_from_grid;
            world_from_grid.transform_point3(here.at(inside))
        };
        Piece {
            ends: crossing.part.map(end),
            flow: Flow::None,
        }
    };
    path.finest_crossings(grid).map(piece).collect()
}

/// A well along its path, in the model's box and a little beyond; cells that it is connected to and does not go
/// through are pieces beside it. `None` where it has no path near the model, or the space is not that of the map.
pub(super) fn along_path(grid: &Grid, well: &Well, measures: &Measures<'_>) -> Option<Course> {
    let path = well.path.as_ref().filter(|_| grid.space().is_map())?;
    let world_from_grid = measures.spaces.world_from_grid;
    let line: Vec<DVec3> = path
        .points
        .iter()
        .map(|p| world_from_grid.transform_point3(*p))
        .collect();
    let connections: Vec<(Ijk, &Connection)> = well
        .finest_connections(grid)
        .filter_map(|c| Some((c.cell_in(grid)?, c)))
        .collect();
    let flow_in = |cell: Ijk| {
        let known = connections.iter().find(|(at, _)| *at == cell);
        known.map(|(_, connection)| Flow::of(connection))
    };
    let flows: Vec<([f64; 2], Flow)> = path
        .finest_crossings(grid)
        .filter_map(|c| Some((c.part, flow_in(c.cell)?)))
        .collect();
    let bounds = Bounds::around(measures);
    let parts = parts(line.len(), &flows).into_iter();
    let mut pieces: Vec<Piece> = parts
        .filter_map(|([from, to], flow)| {
            let ends = [from, to].map(|place| point_at(&line, place));
            let ends = bounds.clip(ends)?;
            Some(Piece { ends, flow })
        })
        .collect();
    // Some files begin at the bottom.
    let [first, last] = [pieces.first()?.ends[0], pieces.last()?.ends[1]];
    let head = if last.z > first.z { last } else { first };
    let is_crossed = |cell: Ijk| path.crossings.iter().any(|c| c.cell == cell);
    let beside = connections.iter().filter(|(cell, _)| !is_crossed(*cell));
    pieces.extend(beside.filter_map(|(_, connection)| {
        Some(Piece {
            ends: ends(grid, connection, measures)?,
            flow: Flow::of(connection),
        })
    }));
    Some(Course { head, pieces })
}

/// The parts of a line of so many points between its points and where flows begin and end: from place to place.
fn parts(points: usize, flows: &[([f64; 2], Flow)]) -> Vec<([f64; 2], Flow)> {
    let borders = flows.iter().flat_map(|(part, _)| *part);
    let mut places: Vec<f64> = (0..points).map(|n| n as f64).chain(borders).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let mut parts = Vec::new();
    let mut next = 0;
    for ends in places.windows(2) {
        let middle = 0.5 * (ends[0] + ends[1]);
        // Flows are in the order of the line.
        while flows.get(next).is_some_and(|(part, _)| part[1] <= middle) {
            next += 1;
        }
        let flow = flows.get(next).filter(|(part, _)| part[0] < middle);
        let flow = flow.map_or(Flow::None, |(_, flow)| *flow);
        parts.push(([ends[0], ends[1]], flow));
    }
    parts
}

/// The model's box, and a little around it.
struct Bounds {
    corner: DVec3,
    /// Parts of the box's edges of a vector.
    of_edges: DMat3,
    /// How far beyond the box, in parts of its edges.
    beyond: DVec3,
}

impl Bounds {
    fn around(measures: &Measures<'_>) -> Self {
        let corner = measures.corners[0];
        let edges = [1, 2, 4].map(|n: usize| measures.corners[n] - corner);
        let beyond = BEYOND * measures.diagonal();
        Self {
            corner,
            of_edges: DMat3::from_cols(edges[0], edges[1], edges[2]).inverse(),
            beyond: DVec3::from_array(edges.map(|edge| beyond / edge.length())),
        }
    }

    /// The part of a line within.
    fn clip(&self, [a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
        let start = self.of_edges * (a - self.corner);
        let way = self.of_edges * (b - a);
        let (mut enter, mut leave) = (0.0, 1.0);
        for axis in 0..3 {
            let low = (-self.beyond[axis] - start[axis]) / way[axis];
            let high = (1.0 + self.beyond[axis] - start[axis]) / way[axis];
            if way[axis] == 0.0 {
                let place = start[axis];
                let is_inside = -self.beyond[axis] <= place && place <= 1.0 + self.beyond[axis];
                leave = if is_inside { leave } else { -1.0 };
                continue;
            }
            enter = f64::max(enter, low.min(high));
            leave = f64::min(leave, low.max(high));
        }
        (enter < leave).then(|| [enter, leave].map(|t| a.lerp(b, t)))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::model::Spaces;

    #[test]
    fn lines_are_cut_where_flows_begin_and_end() {
        let flows = [([0.5, 0.75], Flow::Open), ([0.75, 2.0], Flow::Closed)];
        let found = parts(4, &flows);
        let expected = [
            ([0.0, 0.5], Flow::None),
            ([0.5, 0.75], Flow::Open),
            ([0.75, 1.0], Flow::Closed),
            ([1.0, 2.0], Flow::Closed),
            ([2.0, 3.0], Flow::None),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn lines_end_a_little_beyond_the_box() {
        let turned = |n: usize| {
            let [x, y, z] = [n & 1, n >> 1 & 1, n >> 2].map(|d| d as f64);
            DVec3::new(3.0 * x - 4.0 * y, 4.0 * x + 3.0 * y, -5.0 * z)
        };
        let corners = std::array::from_fn(turned);
        let spaces = Spaces::new(None, 1.0);
        let measures = Measures::of(&spaces, &corners, DVec3::ONE);
        let beyond = BEYOND * measures.diagonal();
        let bounds = Bounds::around(&measures);
        let middle = 0.5 * (corners[0] + corners[3]);
        let line = [middle + 100.0 * DVec3::Z, middle - 2.0 * DVec3::Z];
        let [from, to] = bounds.clip(line).unwrap();
        assert!((from.z - beyond).abs() < 1e-9 && to == line[1]);
        let beside = line.map(|p| p + DVec3::new(6.0, 0.0, 0.0));
        assert_eq!(bounds.clip(beside), None);
    }
}
