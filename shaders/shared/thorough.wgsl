// Point location that takes nothing for granted: every drawn cell of a bin whose corners surround the point, and
// every part of such a cell. It is for cells that fold over, for layers that cross, and for where a quicker search
// ends in doubt. In a cell that folds over a point may have several parameters; any of them will do.
#import cell

// How often parameters are halved.
const FINEST_PART: u32 = 6u;
// Parts of a cell that are looked at, at most.
const MOST_PARTS: u32 = 400u;
// Newton steps in one part.
const PART_LIMIT: u32 = 12u;
// Loop iterations that one of them costs with all that is looked at beside it, about.
const PART_WORK: u32 = 8u;
// A residual below this share of a cell's extent is rounding.
const GRAIN: f32 = 1e-6;
// Share of a cell's size that a point must lie within its faces to be lost if it is not found: rounding is less.
const LOST_DEPTH: f32 = 1e-3;

// Looks for the point (relative to the cell's first corner) in the cell, then in its halves along each axis, and
// so on; parts that a plane separates from the point are left out.
fn solve_by_parts(cell: Cell, point: vec3f, enough: f32) -> Solution {
    var result: Solution;
    var level = 0u;
    // Which half along u, v and w at each level: three bits, the finest level lowest.
    var code = 0u;
    for (var n = 0u; n < MOST_PARTS; n++) {
        let side = exp2(-f32(level));
        var place = vec3u(0u);
        for (var l = 0u; l < level; l++) {
            place |= (vec3u(code, code >> 1u, code >> 2u) >> vec3u(3u * l) & vec3u(1u)) << vec3u(l);
        }
        let middle = side * (vec3f(place) + 0.5);
        if may_hold(cell, point, middle, side) {
            let s = solve_in_part(cell, point, middle, side, enough);
            result.iterations += s.iterations;
            if s.inside {
                let iterations = result.iterations;
                result = s;
                result.iterations = iterations;
                return result;
            }
            if level < FINEST_PART {
                level += 1u;
                code = code << 3u;
                continue;
            }
        }
        while level > 0u && (code & 7u) == 7u {
            code = code >> 3u;
            level -= 1u;
        }
        if level == 0u {
            return result;
        }
        code += 1u;
    }
    return result;
}

// False where a plane along two tangents or two axes separates the point from a part of a cell.
fn may_hold(cell: Cell, point: vec3f, middle: vec3f, side: f32) -> bool {
    let t = tangents(cell, middle);
    let normals = mat3x3f(cross(t[1], t[2]), cross(t[2], t[0]), cross(t[0], t[1]));
    let sizes = mat3x3f(abs(normals[0]), abs(normals[1]), abs(normals[2]));
    var low = vec3f(1e30);
    var high = vec3f(-1e30);
    var reach = vec3f(0.0);
    var low_along = vec3f(1e30);
    var high_along = vec3f(-1e30);
    var reach_along = vec3f(0.0);
    for (var c = 0u; c < 8u; c++) {
        let corner = middle + side * (vec3f(vec3u(c, c >> 1u, c >> 2u) & vec3u(1u)) - 0.5);
        let off = evaluate(cell, corner).xyz - point;
        low = min(low, off);
        high = max(high, off);
        reach = max(reach, abs(off));
        let along = off * normals;
        low_along = min(low_along, along);
        high_along = max(high_along, along);
        reach_along = max(reach_along, abs(off) * sizes);
    }
    return all(low <= GRAIN * reach) && all(high >= -GRAIN * reach)
        && all(low_along <= GRAIN * reach_along) && all(high_along >= -GRAIN * reach_along);
}

// Newton's method from the middle of a part, as long as it stays near it.
fn solve_in_part(cell: Cell, point: vec3f, middle: vec3f, side: f32, enough: f32) -> Solution {
    var s: Solution;
    s.uvw = middle;
    for (var n = 0u; n < PART_LIMIT; n++) {
        let t = tangents(cell, s.uvw);
        let nu = cross(t[1], t[2]);
        let nv = cross(t[2], t[0]);
        let nw = cross(t[0], t[1]);
        let determinant = dot(t[0], nu);
        s.iterations = n + 1u;
        if abs(determinant) < 1e-30 {
            break;
        }
        let scale = 1.0 / determinant;
        s.inverse_u = nu * scale;
        s.inverse_v = nv * scale;
        s.inverse_w = nw * scale;
        let residual = point - evaluate(cell, s.uvw).xyz;
        let step = vec3f(dot(s.inverse_u, residual), dot(s.inverse_v, residual), dot(s.inverse_w, residual));
        let length = max(abs(step.x), max(abs(step.y), abs(step.z)));
        s.uvw += step * min(1.0, side / max(length, 1e-30));
        let off = abs(s.uvw - middle);
        if length < enough || max(off.x, max(off.y, off.z)) > 1.5 * side {
            s.inside = length < enough && is_inside(s.uvw);
            break;
        }
    }
    // Where the cell folds, or has next to no thickness, steps stay long though the place is right.
    let nearest = clamp(s.uvw, vec3f(0.0), vec3f(1.0));
    let extent = abs(cell.ku) + abs(cell.kv) + abs(cell.kw) + abs(cell.kuv) + abs(cell.kvw) + abs(cell.kuw)
        + abs(cell.kuvw);
    if !s.inside && all(abs(point - evaluate(cell, nearest).xyz) <= GRAIN * extent.xyz) {
        s.uvw = nearest;
        s.inside = true;
    }
    return s;
}

// True where the faces of a cell surely enclose a point (relative to its first corner), whatever Newton's method
// says: they wind around it, and do so however each face is cut into two triangles.
fn encloses(cell: Cell, point: vec3f) -> bool {
    // Corners relative to a point somewhat nearer to the faces.
    let center = evaluate(cell, vec3f(0.5)).xyz;
    let at = center + (1.0 + LOST_DEPTH) * (point - center);
    let p0 = cell.k0.xyz - at;
    let p1 = p0 + cell.ku.xyz;
    let p2 = p0 + cell.kv.xyz;
    let p3 = p1 + cell.kv.xyz + cell.kuv.xyz;
    let p4 = p0 + cell.kw.xyz;
    let p5 = p1 + cell.kw.xyz + cell.kuw.xyz;
    let p6 = p2 + cell.kw.xyz + cell.kvw.xyz;
    let p7 = p3 + cell.kw.xyz + cell.kuw.xyz + cell.kvw.xyz + cell.kuvw.xyz;
    let windings = crossings(p0, p4, p2, p6) + crossings(p1, p3, p5, p7) + crossings(p0, p1, p4, p5)
        + crossings(p2, p6, p3, p7) + crossings(p0, p2, p1, p3) + crossings(p4, p5, p6, p7);
    return all(windings != vec2i(0));
}

// How often a line down from the origin leaves through a face, less how often it comes in, for each of the two
// ways to cut the face; corners (0, 0), (1, 0), (0, 1) and (1, 1).
fn crossings(q00: vec3f, q10: vec3f, q01: vec3f, q11: vec3f) -> vec2i {
    return vec2i(crossing(q00, q10, q11) + crossing(q00, q11, q01), crossing(q00, q10, q01) + crossing(q10, q11, q01));
}

fn crossing(a: vec3f, b: vec3f, c: vec3f) -> i32 {
    let sides = vec3f(cross2(b.xy, c.xy), cross2(c.xy, a.xy), cross2(a.xy, b.xy));
    let is_positive = all(sides >= vec3f(0.0));
    if !is_positive && !all(sides < vec3f(0.0)) {
        return 0;
    }
    // Sign of the depth where the line meets the triangle, times that of its area.
    let depth = dot(sides, vec3f(a.z, b.z, c.z));
    if is_positive {
        return select(0, 1, depth > 0.0);
    }
    return select(0, -1, depth < 0.0);
}
