//! A tree of boxes over faces of cells: which of many faces a ray meets.

use glam::DVec3;
use rayon::prelude::*;

use super::grid::Grid;
use super::ids::{CellIndex, Ijk};
use super::topology::Face;

/// Faces in a leaf at most.
const LEAF: usize = 4;
/// Faces below which a part of the tree is built by one thread.
const ALONE: usize = 4096;
/// Part of a box's size by which it is wider than what is in it: a ray along a side must not miss it.
const SLACK: f64 = 1e-9;

/// A binary tree over faces of a grid, split at the median of their middles along the widest axis.
///
/// A face is two triangles, 0 1 3 and 0 3 2 of its corners in the order of [`Face::corners`].
#[derive(Debug, Default)]
pub struct FaceTree {
    /// Leaf by leaf.
    faces: Vec<(CellIndex, Face)>,
    /// In depth-first order.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// Smallest and largest corner in grid space.
    bounds: [DVec3; 2],
    content: Content,
}

#[derive(Debug, Clone, Copy)]
enum Content {
    /// How far behind this node the second child lies; the first one is the next node.
    Children(u32),
    /// Range of the faces.
    Faces(u32, u32),
}

/// A point at which a ray meets a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceHit {
    /// Along the ray, in lengths of its direction.
    pub distance: f64,
    /// The cell whose face it is.
    pub cell: Ijk,
    /// The face.
    pub face: Face,
    /// The ray leaves the cell there.
    pub is_exit: bool,
}

/// A face, and its box.
struct Member {
    face: (CellIndex, Face),
    bounds: [DVec3; 2],
}

impl FaceTree {
    /// A tree over faces of cells of `grid`.
    pub fn new(grid: &Grid, faces: &[(Ijk, Face)]) -> Self {
        let member = |&(ijk, face): &(Ijk, Face)| Member {
            face: (grid.dims().cell(ijk), face),
            bounds: bounds_of(corners(grid, ijk, face).map(|c| [c; 2])),
        };
        let mut members: Vec<Member> = faces.par_iter().map(member).collect();
        let nodes = match members.is_empty() {
            true => Vec::new(),
            false => build(&mut members, 0),
        };
        Self {
            faces: members.into_iter().map(|m| m.face).collect(),
            nodes,
        }
    }

    /// Where a ray of grid space meets faces of `grid`, at distances above 0 and in no order.
    pub fn meets(&self, grid: &Grid, origin: DVec3, direction: DVec3) -> Vec<FaceHit> {
        let mut hits = Vec::new();
        let mut left = vec![0];
        while let Some(at) = left.pop() {
            let node = self.nodes.get(at).copied();
            let Some(node) = node.filter(|n| is_met(n.bounds, origin, direction)) else {
                continue;
            };
            match node.content {
                Content::Children(second) => left.extend([at + second as usize, at + 1]),
                Content::Faces(from, to) => {
                    for &(cell, face) in &self.faces[from as usize..to as usize] {
                        let ijk = grid.dims().ijk(cell);
                        hits.extend(FaceHit::of(grid, ijk, face, origin, direction));
                    }
                }
            }
        }
        hits
    }
}

/// The nodes of a tree over members that begin at position `first` of all; they are put in its order.
fn build(members: &mut [Member], first: usize) -> Vec<Node> {
    let bounds = bounds_of(members.iter().map(|m| m.bounds));
    let slack = DVec3::splat(SLACK * bounds[0].distance(bounds[1]));
    let mut root = Node {
        bounds: [bounds[0] - slack, bounds[1] + slack],
        content: Content::Faces(first as u32, (first + members.len()) as u32),
    };
    if members.len() <= LEAF {
        return vec![root];
    }
    let middle = |m: &Member| m.bounds[0] + m.bounds[1];
    let middles = bounds_of(members.iter().map(|m| [middle(m); 2]));
    let axis = (middles[1] - middles[0]).max_position();
    let half = members.len() / 2;
    let along = |m: &Member| middle(m)[axis];
    members.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)));
    let (low, high) = members.split_at_mut(half);
    let (low, high) = match half > ALONE {
        true => rayon::join(|| build(low, first), || build(high, first + half)),
        false => (build(low, first), build(high, first + half)),
    };
    root.content = Content::Children(1 + low.len() as u32);
    let mut nodes = vec![root];
    nodes.extend(low);
    nodes.extend(high);
    nodes
}

impl FaceHit {
    /// Where a ray meets the two triangles of a face.
    fn of(
        grid: &Grid,
        cell: Ijk,
        face: Face,
        origin: DVec3,
        direction: DVec3,
    ) -> impl Iterator<Item = Self> {
        let [a, b, c, d] = corners(grid, cell, face);
        let center = grid.hexahedron(cell).center();
        let triangles = [[a, b, d], [a, d, c]].into_iter();
        triangles.filter_map(move |[a, b, c]| {
            let normal = (b - a).cross(c - a);
            let outward = normal * normal.dot(a - center).signum();
            Some(Self {
                distance: meets_triangle(origin, direction, [a, b, c])?,
                cell,
                face,
                is_exit: outward.dot(direction) > 0.0,
            })
        })
    }
}

/// Distance of a triangle (Moller and Trumbore 1997); `None` where the ray misses it.
pub(super) fn meets_triangle(
    origin: DVec3,
    direction: DVec3,
    [a, b, c]: [DVec3; 3],
) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let volume = ab.dot(across);
    if volume == 0.0 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(across) / volume;
    let other = from_a.cross(ab);
    let v = direction.dot(other) / volume;
    let distance = ac.dot(other) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

pub(super) fn is_met([low, high]: [DVec3; 2], origin: DVec3, direction: DVec3) -> bool {
    let (mut enter, mut leave) = (0.0, f64::INFINITY);
    for axis in 0..3 {
        let to = |plane: DVec3| (plane[axis] - origin[axis]) / direction[axis];
        let (a, b) = (to(low), to(high));
        // A ray along a side gives 0 / 0, which `max` and `min` pass over.
        enter = f64::max(enter, a.min(b));
        leave = f64::min(leave, a.max(b));
    }
    enter <= leave
}

fn corners(grid: &Grid, ijk: Ijk, face: Face) -> [DVec3; 4] {
    let hexahedron = grid.hexahedron(ijk);
    face.corners()[0].map(|n| hexahedron.0[n])
}

fn bounds_of(boxes: impl IntoIterator<Item = [DVec3; 2]>) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let widened = |[low, high]: [DVec3; 2], [a, b]: [DVec3; 2]| [low.min(a), high.max(b)];
    boxes.into_iter().fold(start, widened)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Dims, GridInput};

    /// Columns of two layers, each thrown by another depth, on inclined pillars.
    fn stepped(ni: usize, nj: usize) -> Grid {
        let dims = Dims { ni, nj, nk: 2 };
        let pillars =
            (0..(ni + 1) * (nj + 1)).map(|n| ((n % (ni + 1)) as f64, (n / (ni + 1)) as f64));
        let coord: Vec<f64> = pillars
            .flat_map(|(x, y)| [x, y, 0.0, x + 0.1 * y, y, 10.0])
            .collect();
        let mut random = fastrand::Rng::with_seed(3);
        let throws: Vec<f64> = (0..ni * nj).map(|_| 2.0 * random.f64()).collect();
        let zcorn: Vec<f64> = (0..8 * dims.cells())
            .map(|at| {
                let (x, y, z) = (at % (2 * ni), at / (2 * ni) % (2 * nj), at / (4 * ni * nj));
                4.0 + z.div_ceil(2) as f64 + throws[x / 2 + ni * (y / 2)]
            })
            .collect();
        Grid::new(&GridInput {
            dims,
            coord: &coord,
            zcorn: &zcorn,
            actnum: None,
            map_axes: None,
        })
        .unwrap()
    }

    #[test]
    fn a_ray_meets_the_faces_that_it_meets_one_by_one() {
        let grid = stepped(40, 35);
        let faces = grid.boundary_faces(&vec![true; grid.active_cells().len()]);
        assert!(faces.len() > 2 * ALONE, "{}", faces.len());
        let tree = FaceTree::new(&grid, &faces);
        let mut random = fastrand::Rng::with_seed(5);
        let mut met = 0;
        for _ in 0..200 {
            let mut place = |low: f64, high: f64| low + (high - low) * random.f64();
            let origin = DVec3::new(place(-20.0, 60.0), place(-20.0, 60.0), place(-10.0, 20.0));
            let toward = DVec3::new(place(0.0, 40.0), place(0.0, 35.0), place(4.0, 8.0));
            let direction = toward - origin;
            let mut found = tree.meets(&grid, origin, direction);
            let all = faces
                .iter()
                .flat_map(|&(ijk, face)| FaceHit::of(&grid, ijk, face, origin, direction));
            let mut all: Vec<FaceHit> = all.collect();
            for hits in [&mut found, &mut all] {
                // Faces of two cells may be one place.
                let order = |hit: &FaceHit| {
                    (
                        hit.distance.to_bits(),
                        grid.dims().cell(hit.cell),
                        hit.face as usize,
                    )
                };
                hits.sort_by_key(order);
            }
            assert!(found == all);
            // What is entered is left, the ray starting outside of all cells or not.
            let exits = found.iter().filter(|hit| hit.is_exit).count();
            assert!(exits.abs_diff(found.len() - exits) <= 1);
            met += found.len();
        }
        assert!(met > 2000, "{met}");
    }

    #[test]
    fn a_tree_without_faces_is_met_nowhere() {
        let grid = stepped(1, 1);
        let hits = FaceTree::new(&grid, &[]).meets(&grid, DVec3::ZERO, DVec3::Z);
        assert_eq!(hits, []);
    }
}
