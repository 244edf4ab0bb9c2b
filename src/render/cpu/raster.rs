//! Where the rays of pixels meet faces of cells: faces are projected once a frame, sorted into tiles of the picture,
//! and met pixel by pixel there. Triangles, their sense and their distances are those of
//! `shaders/shared/raster.wgsl`; in f64, so that no ray slips between two faces.

use glam::{DVec3, Vec2};
use rayon::prelude::*;

use super::each::Each;
use super::facing::{FacePlace, face_corner, face_orientation};
use super::frame::Frame;
use super::grid::Grid;
use crate::render::plan::list_entry;

/// Pixels along the side of a tile.
pub const TILE: u32 = 16;

/// What projects corners of cells.
pub struct Projector<'a> {
    grid: &'a Grid,
    eye: DVec3,
    /// Rows of the transform from grid space relative to the eye to picture and depth.
    rows: [DVec3; 3],
    is_parallel: bool,
    world_handedness: f64,
    /// Width and height in pixels.
    size: [u32; 2],
}

/// Where a ray meets a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// Number of the face.
    pub face: u32,
    /// Depth along the camera's axis of the point, and +1 where the ray comes into the cell there, -1 where it
    /// leaves.
    pub point: Option<(f64, i32)>,
    /// Depths between which the ray is among the face's corners: where the face is bent, its cell may begin or
    /// end anywhere there.
    pub span: [f64; 2],
}

/// A face in the picture: what a pixel needs to meet it.
struct Projected {
    number: u32,
    /// Of the pairs of corners 01, 13, 30, 32, 20 and 12, so that a product with (x, y, 1) says on which side of a
    /// pair the ray passes.
    edges: [DVec3; 6],
    depths: [f64; 4],
    /// +1 where a triangle that turns counterclockwise in the picture is turned to the viewer.
    sense: f64,
}

/// Corners of a face in the picture: x and y times a weight, that weight, and the depth.
type Corners = [(DVec3, f64); 4];

impl<'a> Projector<'a> {
    /// That of a frame.
    pub fn new(grid: &'a Grid, frame: &Frame) -> Self {
        let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let numbers = &frame.numbers;
        Self {
            grid,
            eye: wide(numbers.eye),
            rows: [numbers.view_x, numbers.view_y, numbers.view_z].map(wide),
            is_parallel: numbers.is_parallel == 1.0,
            world_handedness: f64::from(numbers.world_handedness),
            size: [numbers.width, numbers.height],
        }
    }

    fn corners(&self, number: u32) -> Corners {
        let place = FacePlace::of(number, self.grid.nk());
        let lists = self.grid.lists(place.column);
        let pillars = self.grid.pillar_index(place.column);
        [0, 1, 2, 3].each(|n| {
            let corner = face_corner(place.side, n);
            let of_column = (corner & 3) as usize;
            let entry = list_entry(lists[of_column], place.layer, corner >> 2);
            let depth = f64::from(self.grid.depth(entry));
            let pillar = self.grid.pillar(pillars[of_column]);
            let wide = |v: Vec2| v.as_dvec2();
            let xy = wide(pillar.at) + (wide(pillar.low_bits) + wide(pillar.slope) * depth);
            let from_eye = xy.extend(depth) - self.eye;
            let [x, y, z] = self.rows.each(|row| row.dot(from_eye));
            let weight = if self.is_parallel { 1.0 } else { z };
            (DVec3::new(x, y, weight), z)
        })
    }

    /// Columns and rows of pixels that a face may cover; `None` where it covers none.
    fn pixels(&self, number: u32) -> Option<[[u32; 2]; 2]> {
        let corners = self.corners(number);
        let in_front = corners.iter().filter(|(_, depth)| *depth > 0.0).count();
        if in_front == 0 {
            return None;
        }
        if in_front < 4 {
            return Some(self.size.map(|n| [0, n - 1]));
        }
        let along = |axis: usize, sign: f64| {
            // In pixels, whose middles are whole numbers.
            let scale = 0.5 * f64::from(self.size[axis]);
            let at = corners.each(|(h, _)| scale * (1.0 + sign * h[axis] / h.z) - 0.5);
            let low = at.iter().copied().fold(f64::MAX, f64::min) - 1e-3;
            let high = at.iter().copied().fold(f64::MIN, f64::max) + 1e-3;
            let last = f64::from(self.size[axis] - 1);
            let (low, high) = (low.ceil().max(0.0), high.floor().min(last));
            (low <= high).then_some([low as u32, high as u32])
        };
        Some([along(0, 1.0)?, along(1, -1.0)?])
    }

    fn project(&self, number: u32) -> Projected {
        let corners = self.corners(number);
        let edge = |a: usize, b: usize| corners[a].0.cross(corners[b].0);
        let side = number % 6;
        Projected {
            number,
            edges: [
                edge(0, 1),
                edge(1, 3),
                edge(3, 0),
                edge(3, 2),
                edge(2, 0),
                edge(1, 2),
            ],
            depths: corners.each(|(_, depth)| depth),
            sense: self.world_handedness * f64::from(face_orientation(side)),
        }
    }
}

impl Projected {
    /// Where the ray through a place of the picture meets the face.
    fn met(&self, place: DVec3) -> Option<Met> {
        let [a, b, c, d, e, f] = self.edges.map(|edge| edge.dot(place));
        let [z0, z1, z2, z3] = self.depths;
        let first = hit([b, c, a], [z0, z1, z3]);
        let second = hit([d, e, -c], [z0, z3, z2]);
        let others = [hit([f, e, a], [z0, z1, z2]), hit([d, -f, b], [z1, z3, z2])];
        let all = [first, second].into_iter().chain(others).flatten();
        let span = all.fold([f64::MAX, f64::MIN], |[low, high], (depth, _)| {
            [low.min(depth), high.max(depth)]
        });
        let turn =
            |(depth, turn): (f64, f64)| (depth, if self.sense * turn > 0.0 { 1 } else { -1 });
        // Where both triangles are met the ray passes the face twice, or along their diagonal.
        let point = match (first, second) {
            (Some(a), Some(b)) if a.1 != b.1 => None,
            (first, second) => first.or(second).map(turn),
        };
        (span[0] <= span[1] && span[1] > 0.0).then_some(Met {
            face: self.number,
            point: point.filter(|(depth, _)| *depth > 0.0),
            span,
        })
    }
}

/// Depth at which a ray meets a triangle, and the sense in which it turns, from the sides on which it passes the edge
/// across from each corner.
fn hit([a, b, c]: [f64; 3], depths: [f64; 3]) -> Option<(f64, f64)> {
    let is_inside = (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
    let sum = a + b + c;
    (is_inside && sum != 0.0).then(|| {
        let depth = (a * depths[0] + b * depths[1] + c * depths[2]) / sum;
        (depth, sum.signum())
    })
}

/// Faces by the tiles of the picture that they may be in.
pub struct FaceBins {
    /// Tiles in a row.
    across: u32,
    /// First entry of each tile, and one more.
    first: Vec<u32>,
    faces: Vec<u32>,
}

impl FaceBins {
    /// Sorts faces into tiles.
    pub fn new(projector: &Projector<'_>, numbers: &[u32]) -> Self {
        let [across, down] = projector.size.map(|n| n.div_ceil(TILE));
        let covered = |number: &u32| Some((*number, projector.pixels(*number)?));
        let covered: Vec<_> = numbers.par_iter().filter_map(covered).collect();
        let tiles = |[columns, rows]: [[u32; 2]; 2]| {
            let tile = move |range: [u32; 2]| range[0] / TILE..=range[1] / TILE;
            tile(rows).flat_map(move |y| tile(columns).map(move |x| (x + across * y) as usize))
        };
        let mut first = vec![0; (across * down) as usize + 1];
        for tile in covered.iter().flat_map(|(_, pixels)| tiles(*pixels)) {
            first[tile + 1] += 1;
        }
        for tile in 1..first.len() {
            first[tile] += first[tile - 1];
        }
        let mut next = first.clone();
        let mut faces = vec![0; first.last().map_or(0, |n| *n as usize)];
        for (number, pixels) in covered {
            for tile in tiles(pixels) {
                faces[next[tile] as usize] = number;
                next[tile] += 1;
            }
        }
        Self {
            across,
            first,
            faces,
        }
    }

    /// Gives every face that the ray of a pixel meets to that pixel of a tile, row by row, in the order of the faces.
    pub fn meet(&self, projector: &Projector<'_>, tile: &TileRect, met: &mut [Vec<Met>]) {
        met.iter_mut().for_each(Vec::clear);
        let number = (tile.origin[0] / TILE + self.across * (tile.origin[1] / TILE)) as usize;
        let faces = self.first[number] as usize..self.first[number + 1] as usize;
        for &face in &self.faces[faces] {
            let Some(covered) = projector.pixels(face) else {
                continue;
            };
            let within = |axis: usize| {
                let [low, high] = covered[axis];
                let origin = tile.origin[axis];
                low.max(origin) - origin..=high.min(origin + tile.size[axis] - 1) - origin
            };
            let projected = projector.project(face);
            for y in within(1) {
                for x in within(0) {
                    let [x_part, y_part] =
                        projector.middle([tile.origin[0] + x, tile.origin[1] + y]);
                    let place = DVec3::new(x_part, y_part, 1.0);
                    met[(x + tile.size[0] * y) as usize].extend(projected.met(place));
                }
            }
        }
    }
}

impl Projector<'_> {
    /// The middle of a pixel: from -1 to 1, to the right and up.
    fn middle(&self, [x, y]: [u32; 2]) -> [f64; 2] {
        let part = |n: u32, of: u32| 2.0 * (f64::from(n) + 0.5) / f64::from(of);
        [part(x, self.size[0]) - 1.0, 1.0 - part(y, self.size[1])]
    }
}

/// A tile of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TileRect {
    /// Left and top pixel.
    pub origin: [u32; 2],
    /// Pixels across and down.
    pub size: [u32; 2],
}

impl TileRect {
    /// The tiles of a picture, row by row.
    pub fn all(size: [u32; 2]) -> Vec<Self> {
        let [across, down] = size.map(|n| n.div_ceil(TILE));
        let tile = |n: u32| {
            let origin = [TILE * (n % across), TILE * (n / across)];
            Self {
                origin,
                size: std::array::from_fn(|axis| TILE.min(size[axis] - origin[axis])),
            }
        };
        (0..across * down).map(tile).collect()
    }

    /// Its pixels, row by row.
    pub fn pixels(self) -> impl Iterator<Item = [u32; 2]> {
        let [x, y] = self.origin;
        let [width, height] = self.size;
        (0..width * height).map(move |n| [x + n % width, y + n / width])
    }
}
