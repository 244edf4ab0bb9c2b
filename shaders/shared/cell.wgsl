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
    let lists = column_lists[column];
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
        top_values = vec4f(values[drawn_rank(column, layer)]);
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
            break;
        }
        previous = length;
    }
    s.inside = converged && is_inside(s.uvw);
    return s;
}

// The parameters of `point` where the pillars are vertical: x and y do not depend on w, so u solves a
// quadratic equation, v and w linear ones.
fn solve_vertical(cell: Cell, point: vec3f) -> Solution {
    let a = cell.ku.xy;
    let b = cell.kv.xy;
    let c = cell.kuv.xy;
    let p = point.xy - cell.k0.xy;
    // cross(p - u a, b + u c) = 0; of its roots the one that stays finite as the sides become parallel.
    let linear = cross2(p, c) - cross2(a, b);
    let constant = cross2(p, b);
    let discriminant = linear * linear + 4.0 * cross2(a, c) * constant;
    let root = linear + select(-1.0, 1.0, linear >= 0.0) * sqrt(max(discriminant, 0.0));
    var s: Solution;
    s.uvw = vec3f(-1.0);
    if discriminant < 0.0 || abs(root) < 1e-30 {
        return s;
    }
    let u = clamp(-2.0 * constant / root, -1.0, 2.0);
    let across = b + u * c;
    let v = clamp(dot(p - u * a, across) / max(dot(across, across), 1e-30), -1.0, 2.0);
    let top = evaluate(cell, vec3f(u, v, 0.0)).z;
    let thickness = evaluate(cell, vec3f(u, v, 1.0)).z - top;
    // Without thickness there is no inside.
    let w = select(-1.0, clamp((point.z - top) / thickness, -1.0, 2.0), abs(thickness) > 1e-9);
    s.uvw = vec3f(u, v, w);
    s.inside = is_inside(s.uvw);
    return s;
}

fn cross2(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}
