// Point location through the acceleration grid: bin, columns in the bin, layer by depth, Newton.
// (campagnolo-2021, 4.1; the regular grid here is two-dimensional, with a search by depth in the column.)
// That is quick and right where cells do not fold over. Bins where some do are searched thoroughly, and so
// is a bin where the quick search finds no cell but cannot be sure that there is none.
#import cell
#import thorough

struct Location {
    found: bool,
    iterations: u32,
    // Loop iterations of any kind, about.
    work: u32,
    cell: Cell,
    solution: Solution,
    // Where not found: how many steps of `advance` surely lie outside all cells (at least 1).
    skip: f32,
    // The quick search has found nothing, but cannot be sure.
    in_doubt: bool,
    // Not found by the thorough search, and yet inside a drawn cell.
    is_lost: bool,
}

const LAYER_MOVES: u32 = 8u;
// Part of a skip that is taken: pillars that are not parallel turn the sides of a section meanwhile.
const SAFE_SKIP: f32 = 0.9;
// Loop iterations for a column before any cell is tried: inverse bilinear map and search by depth.
const COLUMN_WORK: u32 = 24u;

// A point to locate.
struct Query {
    point: vec3f,
    // Its rounding error.
    low_bits: vec3f,
    // Newton steps below this end the iteration.
    enough: f32,
    interpolation: u32,
}

// Finds the cell that holds a point.
fn locate(query: Query) -> Location {
    var location = locate_quickly(query, vec3f(0.0));
    locate_thoroughly(query, &location);
    return location;
}

fn bin_at(point: vec3f) -> vec2u {
    let at = floor((point.xy - grid.bin_origin) / grid.bin_size);
    return vec2u(clamp(at, vec2f(0.0), vec2f(f32(grid.bins_x - 1u), f32(grid.bins_y - 1u))));
}

// Finds the cell that holds a point, or is in doubt; `advance` is the displacement to the next sample, used to
// skip what is empty.
fn locate_quickly(query: Query, advance: vec3f) -> Location {
    let point = query.point;
    var result: Location;
    result.skip = 1.0;
    let bin_xy = bin_at(point);
    let bin = bin_xy.x + grid.bins_x * bin_xy.y;
    let words = bin_words(bin);
    let shallow = grid.depth_low + grid.depth_scale * f32(words.y & 0xffffu);
    let deep = grid.depth_low + grid.depth_scale * f32(words.y >> 16u);
    let first = words.x & ~BIN_IS_ODD;
    let last = bin_words(bin + 1u).x & ~BIN_IS_ODD;
    if first == last || point.z < shallow || point.z > deep {
        let low = grid.bin_origin + vec2f(bin_xy) * grid.bin_size;
        var skip = min(steps_to_leave(point.x, advance.x, low.x, low.x + grid.bin_size.x),
            steps_to_leave(point.y, advance.y, low.y, low.y + grid.bin_size.y));
        if first != last {
            if point.z < shallow && advance.z > 0.0 {
                skip = min(skip, (shallow - point.z) / advance.z);
            } else if point.z > deep && advance.z < 0.0 {
                skip = min(skip, (deep - point.z) / advance.z);
            }
        }
        result.skip = max(1.0, ceil(skip - 1e-3));
        return result;
    }
    let low = grid.bin_origin + vec2f(bin_xy) * grid.bin_size;
    result.skip = min(steps_to_leave(point.x, advance.x, low.x, low.x + grid.bin_size.x),
        steps_to_leave(point.y, advance.y, low.y, low.y + grid.bin_size.y));
    let is_odd = (words.x & BIN_IS_ODD) != 0u;
    for (var n = first; n < last && !is_odd && !result.found; n++) {
        result.found = locate_in_column(bin_column(n), query, advance, &result);
    }
    result.in_doubt = (result.in_doubt || is_odd) && !result.found;
    result.skip = select(max(1.0, ceil(result.skip - 1e-3)), 1.0, result.in_doubt);
    return result;
}

// Settles a location that is in doubt.
fn locate_thoroughly(query: Query, location: ptr<function, Location>) {
    let bin_xy = bin_at(query.point);
    let bin = bin_xy.x + grid.bins_x * bin_xy.y;
    let last = bin_words(bin + 1u).x & ~BIN_IS_ODD;
    for (var n = bin_words(bin).x & ~BIN_IS_ODD; n < last && (*location).in_doubt && !(*location).found; n++) {
        (*location).found = search_all_layers(bin_column(n), query, location);
    }
    (*location).in_doubt = false;
    (*location).is_lost = (*location).is_lost && !(*location).found;
}

// Number of steps until `at` leaves (low, high); a large number where it never does.
fn steps_to_leave(at: f32, advance: f32, low: f32, high: f32) -> f32 {
    if abs(advance) < 1e-20 {
        return 1e6;
    }
    return clamp(select(low - at, high - at, advance > 0.0) / advance, 0.0, 1e6);
}

fn locate_in_column(column: u32, query: Query, advance: vec3f, result: ptr<function, Location>) -> bool {
    (*result).work += COLUMN_WORK;
    let point = query.point;
    let p = pillar_index(column);
    let pillar0 = load_pillar(p.x);
    let pillar1 = load_pillar(p.y);
    let pillar2 = load_pillar(p.z);
    let pillar3 = load_pillar(p.w);
    let q0 = section_corner(pillar0, query);
    let q1 = section_corner(pillar1, query);
    let q2 = section_corner(pillar2, query);
    let q3 = section_corner(pillar3, query);
    let lists = column_lists(column);
    let margin = column_margin(lists);
    // Motion across the section in one step.
    let motion = advance.xy - 0.25 * advance.z * (pillar0.slope + pillar1.slope + pillar2.slope + pillar3.slope);
    let steps_beside = steps_to_section(q0, q1, q2, q3, motion, margin);
    if steps_beside >= 0.0 {
        (*result).skip = min((*result).skip, SAFE_SKIP * steps_beside);
        return false;
    }
    // A section that is not convex may cover the point twice.
    let roots = inverse_bilinear(q0, q1, q2, q3);
    if !is_between(roots.first, margin) {
        (*result).skip = 1.0;
        return false;
    }
    let speed = section_speed(q0, q1, q2, q3, motion);
    return search_column(column, query, roots.first, speed, advance.z, result)
        || (is_between(roots.second, margin) && search_column(column, query, roots.second, speed, advance.z, result));
}

// Finds the cell of a column that holds a point, whose parameters in the column's section are about `uv`.
fn search_column(
    column: u32, query: Query, uv: vec2f, speed: f32, sinking: f32, result: ptr<function, Location>,
) -> bool {
    let lists = column_lists(column);
    let margin = column_margin(lists);
    let inner = clamp(uv, vec2f(0.0), vec2f(1.0));
    let weights = vec4f((1.0 - inner.x) * (1.0 - inner.y), inner.x * (1.0 - inner.y),
        (1.0 - inner.x) * inner.y, inner.x * inner.y);
    let above = clear_of(lists, 0u, 0u, weights, query, margin, speed, sinking);
    let below = clear_of(lists, grid.nk - 1u, 1u, weights, query, margin, speed, sinking);
    if max(above, below) >= 0.0 {
        (*result).skip = min((*result).skip, SAFE_SKIP * max(above, below));
        return false;
    }
    (*result).skip = 1.0;
    // The first layer whose bottom lies below the point.
    var low = 0u;
    var high = grid.nk;
    while low < high {
        let middle = (low + high) / 2u;
        if height_above(lists, middle, 1u, weights, query.point.z, query.low_bits.z) > 0.0 {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return search_from_layer(column, min(low, grid.nk - 1u), query, uv, weights, result);
}

// Pillar position at the point's depth, relative to the point.
fn section_corner(pillar: Pillar, query: Query) -> vec2f {
    return (pillar.at - query.point.xy) + (pillar.low_bits + pillar.slope * query.point.z - query.low_bits.xy);
}

// Steps of `motion` after which the origin may come within the margin of a quadrilateral; negative
// where it is already. A quadrilateral that is not convex has no outside here.
fn steps_to_section(q0: vec2f, q1: vec2f, q2: vec2f, q3: vec2f, motion: vec2f, margin: f32) -> f32 {
    let edges = array<vec2f, 4>(q1 - q0, q3 - q1, q2 - q3, q0 - q2);
    let corners = array<vec2f, 4>(q0, q1, q3, q2);
    let area = 0.5 * (cross2(q1 - q0, q3 - q0) + cross2(q3 - q0, q2 - q0));
    let turns = vec4f(cross2(edges[0], edges[1]), cross2(edges[1], edges[2]), cross2(edges[2], edges[3]),
        cross2(edges[3], edges[0])) / area;
    if !all(turns >= vec4f(0.0)) {
        return -1.0;
    }
    var steps = -1.0;
    for (var n = 0; n < 4; n++) {
        // How far outside this side, in cell widths, and how much nearer a step comes.
        let outside = cross2(edges[n], corners[n]) / area - margin;
        if outside > 0.0 {
            let approach = -cross2(motion, edges[n]) / area;
            steps = max(steps, select(1e6, outside / approach, approach > outside * 1e-6));
        }
    }
    return steps;
}

// Cell widths that a step crosses, at most: many where the section folds over.
fn section_speed(q0: vec2f, q1: vec2f, q2: vec2f, q3: vec2f, motion: vec2f) -> f32 {
    let turns = vec4f(cross2(q1 - q0, q2 - q0), cross2(q1 - q0, q3 - q1), cross2(q3 - q2, q2 - q0),
        cross2(q3 - q2, q3 - q1));
    let low = min(min(turns.x, turns.y), min(turns.z, turns.w));
    let high = max(max(turns.x, turns.y), max(turns.z, turns.w));
    let along = max(max(abs(cross2(motion, q1 - q0)), abs(cross2(motion, q3 - q2))),
        max(abs(cross2(motion, q2 - q0)), abs(cross2(motion, q3 - q1))));
    return along / max(max(low, -high), 1e-20);
}

// Steps after which the point may come to a layer's top from above or to its bottom from below;
// negative where it is not clear of it.
fn clear_of(
    lists: vec4u, layer: u32, bottom: u32, weights: vec4f, query: Query, margin: f32, speed: f32, sinking: f32,
) -> f32 {
    let patch_depths = depths_at(layer_entries(lists, layer, bottom));
    let height = dot(weights, patch_depths - vec4f(query.point.z)) - query.low_bits.z;
    let sign = select(1.0, -1.0, bottom == 1u);
    let clear = sign * height - depth_slack(patch_depths, margin);
    if clear <= 0.0 {
        return -1.0;
    }
    let approach = sign * sinking + 2.0 * speed * depth_spread(patch_depths);
    return select(1e6, clear / approach, approach > clear * 1e-6);
}

// Depth of a layer's top or bottom below the point, bilinear in the column.
fn height_above(lists: vec4u, layer: u32, bottom: u32, weights: vec4f, depth: f32, low_bits: f32) -> f32 {
    return dot(weights, depths_at(layer_entries(lists, layer, bottom)) - vec4f(depth)) - low_bits;
}

// Newton in `start` and, where the result lies above or below, in the layers there.
fn search_from_layer(
    column: u32, start: u32, query: Query, uv: vec2f, weights: vec4f, result: ptr<function, Location>,
) -> bool {
    let lists = column_lists(column);
    let margin = column_margin(lists);
    var layer = i32(start);
    var direction = 0;
    var is_pinched = false;
    for (var n = 0u; n < LAYER_MOVES; n++) {
        if layer < 0 || layer >= i32(grid.nk) {
            // Where edges have no length the way may have been the wrong one.
            (*result).in_doubt = (*result).in_doubt || is_pinched;
            return false;
        }
        let top_depths = depths_at(layer_entries(lists, u32(layer), 0u));
        let bottom_depths = depths_at(layer_entries(lists, u32(layer), 1u));
        is_pinched = is_pinched || any(abs(bottom_depths - top_depths) <= vec4f(COINCIDENT));
        let top = dot(weights, top_depths - vec4f(query.point.z)) - query.low_bits.z;
        let bottom = dot(weights, bottom_depths - vec4f(query.point.z)) - query.low_bits.z;
        let thickness = max(bottom - top, 1e-20);
        let w = clamp(-top / thickness, 0.0, 1.0);
        var move_to = 0;
        if top > depth_slack(top_depths, margin) {
            move_to = -1;
        } else if bottom < -depth_slack(bottom_depths, margin) {
            move_to = 1;
        } else if is_drawn(column, u32(layer)) && any(top_depths != bottom_depths) {
            if try_cell(column, u32(layer), query, vec3f(uv, w), result) {
                return true;
            }
            let reached = (*result).solution.uvw.z;
            move_to = select(select(0, 1, reached > 1.0), -1, reached < 0.0);
        } else {
            // Not drawn: near its top or bottom the point may belong to the layer beyond.
            move_to = select(select(0, 1, w > 0.75), -1, w < 0.25);
            if thickness <= COINCIDENT && direction != 0 {
                move_to = direction;
            }
        }
        if move_to == 0 {
            return false;
        }
        if direction != 0 && move_to != direction {
            // Between two layers, so near to both that rounding may hide the point.
            (*result).in_doubt = true;
            return false;
        }
        direction = move_to;
        layer += move_to;
    }
    (*result).in_doubt = true;
    return false;
}

// How far off the depth of a bilinear patch may be where (u, v) is off by the column's margin.
fn depth_slack(patch_depths: vec4f, margin: f32) -> f32 {
    return 2.0 * margin * depth_spread(patch_depths) + COINCIDENT;
}

fn depth_spread(patch_depths: vec4f) -> f32 {
    let low = min(min(patch_depths.x, patch_depths.y), min(patch_depths.z, patch_depths.w));
    let high = max(max(patch_depths.x, patch_depths.y), max(patch_depths.z, patch_depths.w));
    return high - low;
}

// Newton in one cell; the result's solution is left there either way.
fn try_cell(column: u32, layer: u32, query: Query, start: vec3f, result: ptr<function, Location>) -> bool {
    let cell = load_cell(column, layer, query.interpolation);
    let point = relative_to(cell, query.point) + query.low_bits;
    let s = solve(cell, point, start, query.enough);
    (*result).iterations += s.iterations;
    (*result).work += s.iterations + 1u;
    (*result).solution = s;
    // No answer, or beside the cell, which contradicts the column's section; and yet among the corners.
    let is_beside = !s.inside && s.uvw.z >= 0.0 && s.uvw.z <= 1.0;
    (*result).in_doubt = (*result).in_doubt || (is_beside && is_between(start.xy, 0.0))
        || ((is_beside || !s.sure) && may_hold(cell, point, vec3f(0.5), 1.0));
    if s.inside {
        (*result).cell = cell;
    }
    return s.inside;
}

// Finds the uppermost drawn cell of a column that holds a point, by a thorough search of all of them.
fn search_all_layers(column: u32, query: Query, result: ptr<function, Location>) -> bool {
    let lists = column_lists(column);
    (*result).work += grid.nk;
    for (var layer = 0u; layer < grid.nk; layer++) {
        if !is_drawn(column, layer) {
            continue;
        }
        let top = depths_at(layer_entries(lists, layer, 0u)) - vec4f(query.point.z);
        let bottom = depths_at(layer_entries(lists, layer, 1u)) - vec4f(query.point.z);
        let shallow = min(top, bottom);
        let deep = max(top, bottom);
        if min(min(shallow.x, shallow.y), min(shallow.z, shallow.w)) > COINCIDENT
            || max(max(deep.x, deep.y), max(deep.z, deep.w)) < -COINCIDENT || all(top == bottom) {
            continue;
        }
        let cell = load_cell(column, layer, query.interpolation);
        let point = relative_to(cell, query.point) + query.low_bits;
        var s = solve_by_parts(cell, point, query.enough);
        (*result).iterations += s.iterations;
        if VERTICAL && !s.inside {
            s = solve_vertical(cell, point);
        }
        (*result).work += PART_WORK * (s.iterations + 1u);
        if s.inside {
            (*result).solution = s;
            (*result).cell = cell;
            return true;
        }
        (*result).is_lost = (*result).is_lost || encloses(cell, point);
    }
    return false;
}
