//! Point location that takes nothing for granted: every drawn cell of a bin whose corners surround the point, and
//! every part of such a cell. It is for cells that fold over, for layers that cross, and for where a quicker search
//! ends in doubt. In a cell that folds over a point may have several parameters; any of them will do.
//! The twin of `shaders/shared/thorough.wgsl`.

use glam::{Mat3A, Vec3A};

use super::cell::{Cell, Solution, is_inside};

/// How often parameters are halved.
const FINEST_PART: u32 = 6;
/// Parts of a cell that are looked at, at most.
const MOST_PARTS: u32 = 400;
/// Newton steps in one part.
const PART_LIMIT: u32 = 12;
/// A residual below this share of a cell's extent is rounding.
const GRAIN: f32 = 1e-6;
/// Share of a cell's size that a point must lie within its faces to be lost if it is not found: rounding is less.
const LOST_DEPTH: f32 = 1e-3;

/// Looks for the point (relative to the cell's first corner) in the cell, then in its halves along each axis, and
/// so on; parts that a plane separates from the point are left out.
pub fn solve_by_parts(cell: &Cell, point: Vec3A, enough: f32) -> Solution {
    let mut left = MOST_PARTS;
    let mut iterations = 0;
    let found = search_part(
        cell,
        point,
        enough,
        Vec3A::splat(0.5),
        0,
        &mut left,
        &mut iterations,
    );
    Solution {
        iterations,
        ..found.unwrap_or_default()
    }
}

/// Looks in a part, then in its eight halves.
fn search_part(
    cell: &Cell,
    point: Vec3A,
    enough: f32,
    middle: Vec3A,
    level: u32,
    left: &mut u32,
    iterations: &mut u32,
) -> Option<Solution> {
    *left = left.checked_sub(1)?;
    let side = (-(level as f32)).exp2();
    if !may_hold(cell, point, middle, side) {
        return None;
    }
    let s = solve_in_part(cell, point, middle, side, enough);
    *iterations += s.iterations;
    if s.inside {
        return Some(s);
    }
    if level == FINEST_PART {
        return None;
    }
    (0..8).find_map(|half| {
        let off = 0.5 * side * (corner(half) - 0.5);
        let middle = middle + off;
        search_part(cell, point, enough, middle, level + 1, left, iterations)
    })
}

/// Corner of the unit cube.
fn corner(number: u32) -> Vec3A {
    let bit = |n: u32| (number >> n & 1) as f32;
    Vec3A::new(bit(0), bit(1), bit(2))
}

/// False where a plane along two tangents or two axes separates the point from a part of a cell.
pub fn may_hold(cell: &Cell, point: Vec3A, middle: Vec3A, side: f32) -> bool {
    let [tu, tv, tw] = cell.tangents(middle);
    // Rows are the normals, so that a product gives distances along each of them.
    let normals = Mat3A::from_cols(tv.cross(tw), tw.cross(tu), tu.cross(tv)).transpose();
    let sizes = normals.abs();
    let [mut low, mut low_along] = [Vec3A::splat(1e30); 2];
    let [mut high, mut high_along] = [Vec3A::splat(-1e30); 2];
    let [mut reach, mut reach_along] = [Vec3A::ZERO; 2];
    for number in 0..8 {
        let off = cell.place(middle + side * (corner(number) - 0.5)) - point;
        low = low.min(off);
        high = high.max(off);
        reach = reach.max(off.abs());
        let along = normals * off;
        low_along = low_along.min(along);
        high_along = high_along.max(along);
        reach_along = reach_along.max(sizes * off.abs());
    }
    let surrounds = |low: Vec3A, high: Vec3A, reach: Vec3A| {
        (low.cmple(GRAIN * reach) & high.cmpge(-GRAIN * reach)).all()
    };
    surrounds(low, high, reach) && surrounds(low_along, high_along, reach_along)
}

/// Newton's method from the middle of a part, as long as it stays near it.
fn solve_in_part(cell: &Cell, point: Vec3A, middle: Vec3A, side: f32, enough: f32) -> Solution {
    let mut s = Solution {
        uvw: middle,
        ..Solution::default()
    };
    for n in 0..PART_LIMIT {
        s.iterations = n + 1;
        let Some(inverse) = cell.inverse(s.uvw) else {
            break;
        };
        let step = inverse.along(point - cell.place(s.uvw));
        let length = step.abs().max_element();
        s.uvw += step * (1.0f32).min(side / length.max(1e-30));
        let off = (s.uvw - middle).abs().max_element();
        if length < enough || off > 1.5 * side {
            s.inside = length < enough && is_inside(s.uvw);
            break;
        }
    }
    // Where the cell folds, or has next to no thickness, steps stay long though the place is right.
    let nearest = s.uvw.clamp(Vec3A::ZERO, Vec3A::ONE);
    let factors = [
        cell.ku, cell.kv, cell.kw, cell.kuv, cell.kvw, cell.kuw, cell.kuvw,
    ];
    let extent: Vec3A = factors.iter().map(|k| Vec3A::from_vec4(k.abs())).sum();
    let off = (point - cell.place(nearest)).abs();
    if !s.inside && off.cmple(GRAIN * extent).all() {
        s.uvw = nearest;
        s.inside = true;
    }
    s
}

/// True where the faces of a cell surely enclose a point (relative to its first corner), whatever Newton's method
/// says: they wind around it, and do so however each face is cut into two triangles.
pub fn encloses(cell: &Cell, point: Vec3A) -> bool {
    // Corners relative to a point somewhat nearer to the faces.
    let center = cell.place(Vec3A::splat(0.5));
    let at = center + (1.0 + LOST_DEPTH) * (point - center);
    let p: [Vec3A; 8] = std::array::from_fn(|n| cell.place(corner(n as u32)) - at);
    let faces = [
        [0, 4, 2, 6],
        [1, 3, 5, 7],
        [0, 1, 4, 5],
        [2, 6, 3, 7],
        [0, 2, 1, 3],
        [4, 5, 6, 7],
    ];
    let windings = faces.map(|face| crossings(face.map(|n| p[n])));
    (0..2).all(|cut| windings.iter().map(|w| w[cut]).sum::<i32>() != 0)
}

/// How often a line down from the origin leaves through a face, less how often it comes in, for each of the two
/// ways to cut the face; corners (0, 0), (1, 0), (0, 1) and (1, 1).
fn crossings([q00, q10, q01, q11]: [Vec3A; 4]) -> [i32; 2] {
    [
        crossing(q00, q10, q11) + crossing(q00, q11, q01),
        crossing(q00, q10, q01) + crossing(q10, q11, q01),
    ]
}

fn crossing(a: Vec3A, b: Vec3A, c: Vec3A) -> i32 {
    let area = |a: Vec3A, b: Vec3A| a.x * b.y - a.y * b.x;
    let sides = Vec3A::new(area(b, c), area(c, a), area(a, b));
    let is_positive = sides.cmpge(Vec3A::ZERO).all();
    if !is_positive && !sides.cmplt(Vec3A::ZERO).all() {
        return 0;
    }
    // Sign of the depth where the line meets the triangle, times that of its area.
    let depth = sides.dot(Vec3A::new(a.z, b.z, c.z));
    match is_positive {
        true => i32::from(depth > 0.0),
        false => -i32::from(depth < 0.0),
    }
}
