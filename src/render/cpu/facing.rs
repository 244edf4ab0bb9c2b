//! Faces of a cell: their number, corners and sense. Face 2 a is toward smaller, 2 a + 1 toward larger index along
//! axis a (i, j, k). The twin of `shaders/shared/facing.wgsl`.

use glam::{Vec2, Vec3A, Vec4};

use super::each::Each;
use super::grid::{Grid, all_coincide};
use crate::render::plan::layout::LIST_OFFSET;
use crate::render::plan::list_entry;

/// A face of a cell by its number, `(column * nk + layer) * 6 + side`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FacePlace {
    /// The cell's column.
    pub column: u32,
    /// The cell's layer.
    pub layer: u32,
    /// Which of its faces.
    pub side: u32,
}

impl FacePlace {
    /// The place of a face.
    #[inline]
    pub fn of(number: u32, nk: u32) -> Self {
        Self {
            column: number / 6 / nk,
            layer: number / 6 % nk,
            side: number % 6,
        }
    }
}

/// Corner (di + 2 dj + 4 dk) of a face: bit 0 of `number` counts along the first other axis, bit 1 along the second.
/// Two triangles, 0 1 3 and 0 3 2: both cells of a face cut it along the same diagonal.
#[inline]
pub fn face_corner(face: u32, number: u32) -> u32 {
    let (axis, side) = (face >> 1, face & 1);
    let (first, second) = (number & 1, number >> 1);
    match axis {
        0 => side + 2 * first + 4 * second,
        1 => first + 2 * side + 4 * second,
        _ => first + 2 * second + 4 * side,
    }
}

/// Parameters in the cell of a point on one of its faces.
#[inline]
pub fn on_face(face: u32, at: Vec2) -> Vec3A {
    let side = (face & 1) as f32;
    match face >> 1 {
        0 => Vec3A::new(side, at.x, at.y),
        1 => Vec3A::new(at.x, side, at.y),
        _ => Vec3A::new(at.x, at.y, side),
    }
}

/// +1 where the triangles' sense is that of the outward normal in a right-handed cell, else -1.
#[inline]
pub fn face_orientation(face: u32) -> f32 {
    let is_plus = face & 1 == 1;
    let is_second = face >> 1 == 1;
    if is_plus == is_second { -1.0 } else { 1.0 }
}

/// The column across a lateral face; `None` outside the grid.
#[inline]
pub fn column_behind(grid: &Grid, column: u32, face: u32) -> Option<u32> {
    let info = &grid.compact.info;
    let (at, size, stride) = match face < 2 {
        true => (column % info.ni, info.ni, 1),
        false => (column / info.ni, info.nj, info.ni),
    };
    match face & 1 == 1 {
        true => (at + 1 < size).then(|| column + stride),
        false => (at > 0).then(|| column - stride),
    }
}

/// The column's two depth lists on a lateral face.
#[inline]
pub fn side_lists(lists: [u32; 4], face: u32) -> [u32; 2] {
    let [a, b, c, d] = lists;
    match face {
        0 => [a, c],
        1 => [b, d],
        2 => [a, b],
        _ => [c, d],
    }
}

/// True where a layer of two columns, given by their lists on the face between them, is not displaced.
#[inline]
pub fn sides_join(grid: &Grid, mine: [u32; 2], theirs: [u32; 2], layer: u32) -> bool {
    // Flags aside, shared lists are one list: no fault.
    if mine.each(|l| l & LIST_OFFSET) == theirs.each(|l| l & LIST_OFFSET) {
        return true;
    }
    all_coincide(
        side_depths(grid, mine, layer),
        side_depths(grid, theirs, layer),
    )
}

#[inline]
fn side_depths(grid: &Grid, [a, b]: [u32; 2], layer: u32) -> Vec4 {
    let entry = list_entry;
    grid.depths_at([
        entry(a, layer, 0),
        entry(b, layer, 0),
        entry(a, layer, 1),
        entry(b, layer, 1),
    ])
}
