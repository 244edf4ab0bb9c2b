// One cell as a trilinear map from [0, 1]^3, with the field as a fourth coordinate, and its inverse.
// Positions are relative to the cell's first corner, so that thin layers far from the origin keep
// their digits.
#import grid

// All pillars of the grid are vertical: the inverse of the map has a closed form.
override VERTICAL: bool = false;

struct Cell {
    column: u32,
    layer: u32,
    // First corner, grid space relative to the origin: `base + offset`, kept apart for precision.
    base: vec3f,
    offset: vec3f,
    // Coefficients of 1, u, v, w, uv, vw, uw, uvw; .w is the field.
    k0: vec4f,
    ku: vec4f,
    kv: vec4f,
    kw: vec4f,
    kuv: vec4f,
    kvw: vec4f,
    kuw: vec4f,
    kuvw: vec4f,
}

// Result of Newton's method: parameters in [0, 1]^3 where inside.
struct Solution {
    uvw: vec3f,
    inside: bool,
    // Inside, or outside of a cell that does not fold over.
    sure: bool,
    iterations: u32,
    // Rows of the inverse Jacobian of the last iteration.
    inverse_u: vec3f,
    inverse_v: vec3f,
    inverse_w: vec3f,
}

// Slack for f32 at faces, in cells: points on a shared face are in at least one cell; callers take
// the first, so in exactly one.
const INSIDE_SLACK: f32 = 1e-5;
const NEWTON_LIMIT: u32 = 10u;
// Newton steps below this converge: each next one is at most about a quarter of it.
const SURE_STEP: f32 = 0.25;

fn load_cell(column: u32, layer: u32, interpolation: u32) -> Cell {
    let lists = column_lists(column);
    let p = pillar_index(column);
    let top_entries = layer_entries(lists, layer, 0u);
    let bottom_entries = layer_entries(lists, layer, 1u);
    let top = depths_at(top_entries);
    let bottom = depths_at(bottom_entries);
    let pillar0 = load_pillar(p.x);
    let pillar1 = load_pillar(p.y);
    let pillar2 = load_pillar(p.z);
    let pillar3 = load_pillar(p.w);
    var top_values = vec4f(0.0);
    var bottom_values = vec4f(0.0);
    if interpolation == INTERPOLATION_VERTEX {
        top_values = values_at(top_entries);
        bottom_values = values_at(bottom_entries);
    } else {
        top_values = vec4f(cell_value(column, layer));
        bottom_values = top_values;
    }
    let c0 = vec4f(0.0, 0.0, 0.0, top_values.x);
    let c1 = corner_at(pillar1, pillar0, top.x, top.y, top_values.y);
    let c2 = corner_at(pillar2, pillar0, top.x, top.z, top_values.z);
    let c3 = corner_at(pillar3, pillar0, top.x, top.w, top_values.w);
    let c4 = corner_at(pillar0, pillar0, top.x, bottom.x, bottom_values.x);
    let c5 = corner_at(pillar1, pillar0, top.x, bottom.y, bottom_values.y);
    let c6 = corner_at(pillar2, pillar0, top.x, bottom.z, bottom_values.z);
    let c7 = corner_at(pillar3, pillar0, top.x, bottom.w, bottom_values.w);
    var cell: Cell;
    cell.column = column;
    cell.layer = layer;
    cell.base = vec3f(pillar0.at, top.x);
    cell.offset = vec3f(pillar0.low_bits + pillar0.slope * top.x, 0.0);
    cell.k0 = c0;
    cell.ku = c1 - c0;
    cell.kv = c2 - c0;
    cell.kw = c4 - c0;
    cell.kuv = (c3 - c2) - (c1 - c0);
    cell.kvw = (c6 - c4) - (c2 - c0);
    cell.kuw = (c5 - c4) - (c1 - c0);
    cell.kuvw = ((c7 - c6) - (c5 - c4)) - ((c3 - c2) - (c1 - c0));
    return cell;
}

// A corner relative to the first one; differences of large numbers first.
fn corner_at(pillar: Pillar, pillar0: Pillar, top0: f32, depth: f32, value: f32) -> vec4f {
    let down = depth - top0;
    let xy = (pillar.at - pillar0.at)
        + ((pillar.low_bits - pillar0.low_bits) + (pillar.slope - pillar0.slope) * top0 + pillar.slope * down);
    return vec4f(xy, down, value);
}

// A point of grid space relative to the cell's first corner.
fn relative_to(cell: Cell, point: vec3f) -> vec3f {
    return (point - cell.base) - cell.offset;
}

fn evaluate(cell: Cell, q: vec3f) -> vec4f {
    return cell.k0 + q.x * (cell.ku + q.y * cell.kuv) + q.y * (cell.kv + q.z * cell.kvw)
        + q.z * (cell.kw + q.x * (cell.kuw + q.y * cell.kuvw));
}

// How a place in the cell changes with each of the parameters.
fn tangents(cell: Cell, q: vec3f) -> mat3x3f {
    return mat3x3f(
        (cell.ku + q.y * cell.kuv + q.z * (cell.kuw + q.y * cell.kuvw)).xyz,
        (cell.kv + q.x * cell.kuv + q.z * (cell.kvw + q.x * cell.kuvw)).xyz,
        (cell.kw + q.x * cell.kuw + q.y * (cell.kvw + q.x * cell.kuvw)).xyz,
    );
}

// How the parameters change along a displacement; not at all in a cell without volume.
fn parameters_along(cell: Cell, q: vec3f, displacement: vec3f) -> vec3f {
    let t = tangents(cell, q);
    let nu = cross(t[1], t[2]);
    let determinant = dot(t[0], nu);
    let scale = select(0.0, 1.0 / determinant, abs(determinant) > 1e-30);
    let rates = vec3f(dot(nu, displacement), dot(cross(t[2], t[0]), displacement), dot(cross(t[0], t[1]), displacement));
    return scale * rates;
}

fn is_inside(q: vec3f) -> bool {
    return all(q >= vec3f(-INSIDE_SLACK)) && all(q <= vec3f(1.0 + INSIDE_SLACK));
}

// Newton's method for the parameters of `point` (relative to the cell's first corner), from `start`.
// Stops once a step is below `enough`; convergence is quadratic, so the step after it is far smaller.
// In layers of millimeters f32 cannot get there: a small step that no longer shrinks is the end too.
fn solve(cell: Cell, point: vec3f, start: vec3f, enough: f32) -> Solution {
    if VERTICAL {
        return solve_vertical(cell, point);
    }
    var s: Solution;
    s.uvw = start;
    var converged = false;
    var previous = 1e30;
    for (var n = 0u; n < NEWTON_LIMIT; n++) {
        let q = s.uvw;
        let t = tangents(cell, q);
        let nu = cross(t[1], t[2]);
        let nv = cross(t[2], t[0]);
        let nw = cross(t[0], t[1]);
        let determinant = dot(t[0], nu);
        s.iterations = n + 1u;
        if abs(determinant) < 1e-30 {
            // On a collapsed edge; the tangents span a volume again further inside.
            s.uvw = mix(q, vec3f(0.5), 0.1);
            continue;
        }
        let scale = 1.0 / determinant;
        s.inverse_u = nu * scale;
        s.inverse_v = nv * scale;
        s.inverse_w = nw * scale;
        let residual = point - evaluate(cell, q).xyz;
        let step = vec3f(dot(s.inverse_u, residual), dot(s.inverse_v, residual), dot(s.inverse_w, residual));
        let length = max(abs(step.x), max(abs(step.y), abs(step.z)));
        // Damped: a step never leads further than one cell. In thin layers the point may lie hundreds of
        // cells away: two steps outside is enough to know.
        let next = q + step * min(1.0, 1.0 / max(length, 1e-30));
        s.uvw = clamp(next, vec3f(-1.01), vec3f(2.01));
        if any(s.uvw != next) {
            break;
        }
        if length < enough || (length < 1e-2 && length > 0.5 * previous) {
            converged = true;
            break;
        }
        // What is left is of the square of the step: so far outside it will not come in again.
        let outside = max(-s.uvw, s.uvw - vec3f(1.0));
        if length < SURE_STEP && max(outside.x, max(outside.y, outside.z)) > length {
            s.sure = true;
            break;
        }
        previous = length;
    }
    s.inside = converged && is_inside(s.uvw);
    s.sure = s.sure || converged;
    return s;
}

// The parameters of `point` where the pillars are vertical: x and y do not depend on w, so (u, v) solves a
// bilinear equation, and w then a linear one.
fn solve_vertical(cell: Cell, point: vec3f) -> Solution {
    let q0 = cell.k0.xy - point.xy;
    let roots = inverse_bilinear(q0, q0 + cell.ku.xy, q0 + cell.kv.xy, q0 + (cell.ku + cell.kv + cell.kuv).xy);
    var s = below(cell, point, roots.first);
    if !s.inside && is_between(roots.second, INSIDE_SLACK) {
        let other = below(cell, point, roots.second);
        if other.inside {
            s = other;
        }
    }
    return s;
}

// The solution at (u, v), vertical pillars given.
fn below(cell: Cell, point: vec3f, uv: vec2f) -> Solution {
    let top = evaluate(cell, vec3f(uv, 0.0)).z;
    let thickness = evaluate(cell, vec3f(uv, 1.0)).z - top;
    // Without thickness there is no inside.
    let w = select(-1.0, clamp((point.z - top) / thickness, -1.0, 2.0), abs(thickness) > 1e-9);
    var s: Solution;
    s.uvw = vec3f(clamp(uv, vec2f(-1.0), vec2f(2.0)), w);
    s.inside = is_inside(s.uvw);
    s.sure = true;
    return s;
}

// The two parameters at which a bilinear map takes the value zero, the one nearer to the quadrilateral first.
struct Roots {
    first: vec2f,
    second: vec2f,
}

// Parameters of no place in or near a quadrilateral.
const NO_ROOT: f32 = -8.0;

// Parameters of the origin in a quadrilateral with corners at (0, 0), (1, 0), (0, 1) and (1, 1); one that is
// not convex may cover it twice.
//
// The ends of a line of constant u lie on one line with the origin where
// c0 (1 - u)^2 + 2 c1 u (1 - u) + c2 u^2 = 0. In this form nothing cancels: of a point inside a convex
// quadrilateral c0 and c2, areas to both sides of it, differ in sign, so that both terms of the discriminant
// are positive, and numerator and denominator of u have the same sign.
fn inverse_bilinear(q0: vec2f, q1: vec2f, q2: vec2f, q3: vec2f) -> Roots {
    let c0 = cross2(q0, q2);
    let c1 = 0.5 * (cross2(q0, q3) + cross2(q1, q2));
    let c2 = cross2(q1, q3);
    let discriminant = c1 * c1 - c0 * c2;
    // Slightly below zero it is rounding, where the map folds.
    if discriminant < -1e-6 * c1 * c1 {
        return Roots(vec2f(NO_ROOT), vec2f(NO_ROOT));
    }
    let q = -(c1 + select(-1.0, 1.0, c1 >= 0.0) * sqrt(max(discriminant, 0.0)));
    let a = on_line(q, q + c2, q0, q1, q2, q3);
    let b = on_line(c0, c0 + q, q0, q1, q2, q3);
    if off_middle(a) <= off_middle(b) {
        return Roots(a, b);
    }
    return Roots(b, a);
}

// Parameters of the origin on the line of constant u = part / whole, where it lies on it.
fn on_line(part: f32, whole: f32, q0: vec2f, q1: vec2f, q2: vec2f, q3: vec2f) -> vec2f {
    let u = part / whole;
    if !(abs(u - 0.5) < 8.0) {
        return vec2f(NO_ROOT);
    }
    let low = mix(q0, q1, u);
    let along = mix(q2, q3, u) - low;
    let length2 = dot(along, along);
    let v = clamp(-dot(low, along) / max(length2, 1e-30), -8.0, 9.0);
    // Where an edge has no length any place on it has this u.
    let off = low + v * along;
    let extent = q3 - q0;
    let across = q2 - q1;
    if dot(off, off) > 1e-4 * (length2 + 1e-4 * (dot(extent, extent) + dot(across, across))) {
        return vec2f(NO_ROOT);
    }
    return vec2f(u, v);
}

fn off_middle(uv: vec2f) -> f32 {
    let off = abs(uv - vec2f(0.5));
    return max(off.x, off.y);
}

fn is_between(uv: vec2f, slack: f32) -> bool {
    return off_middle(uv) <= 0.5 + slack;
}

fn cross2(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}
