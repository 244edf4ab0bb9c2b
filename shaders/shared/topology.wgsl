// Samples of a line, each from the one before it: by Newton's method in the same cell, then in the
// neighbor across the face that the result overshoots most, and through the acceleration grid where the
// cells do not join (campagnolo-2021, 4.1.3).
#import locate
#import facing

const TOPOLOGICAL_LIMIT: u32 = 6u;
// Steps below this end the iteration while marching; the error left is of its square.
const MARCH_ENOUGH: f32 = 5e-4;
// The same where no sample is taken at the place.
const WAY_ENOUGH: f32 = 1e-2;

// Ways through cells are followed, and places between the samples are found too.
override BY_SEGMENT: bool = false;

// Where a line of samples has come to, and what that cost.
struct Track {
    // The last sample lies in `cell`, at `solution`.
    has_cell: bool,
    cell: Cell,
    solution: Solution,
    // The next sample is to be located thoroughly.
    in_doubt: bool,
    // Samples found in no cell since the last one that was found, and how many of them surely lie in one all the same.
    gap: f32,
    lost_in_gap: u32,
    // A sample has been found before, in the cell of this column and layer.
    has_last: bool,
    last: vec2u,
    // The line paused in the midst of cells, the sample before the next one being in the last cell.
    has_paused: bool,
    // Times that the line came into the model, cells that it came into, samples lost.
    entries: u32,
    crossings: u32,
    lost: u32,
    iterations: u32,
    topological_steps: u32,
    fallbacks: u32,
    work: u32,
}

// Value at the last sample.
fn value_on(track: Track) -> f32 {
    return evaluate(track.cell, clamp(track.solution.uvw, vec3f(0.0), vec3f(1.0))).w;
}

fn needs_cell(track: Track) -> bool {
    return !track.has_cell && !track.in_doubt;
}

// Locates a sample anew, unless that leaves doubt. Where it lies in no cell, so do as many samples as are
// returned, this one included.
fn find(track: ptr<function, Track>, point: vec3f, advance: vec3f, interpolation: u32) -> f32 {
    let location = locate_quickly(Query(point, vec3f(0.0), MARCH_ENOUGH, interpolation), advance);
    (*track).fallbacks += 1u;
    return take(track, location);
}

fn take(track: ptr<function, Track>, location: Location) -> f32 {
    (*track).iterations += location.iterations;
    (*track).work += location.work + 2u;
    (*track).has_cell = location.found;
    (*track).in_doubt = location.in_doubt;
    if location.found {
        (*track).cell = location.cell;
        (*track).solution = location.solution;
    }
    let passed = select(location.skip, 0.0, location.found || location.in_doubt);
    (*track).gap += passed;
    return passed;
}

// What follows `find`, outside of its loop because it is rare: locates a sample that is in doubt, and looks back
// where samples outside all cells have come to an end, at one that is found or at the end of the line, which is
// `left` samples ahead. Returns how many samples lie in no cell, this one included.
fn settle(track: ptr<function, Track>, point: vec3f, advance: vec3f, left: f32, interpolation: u32) -> f32 {
    let passed = settle_doubt(track, point, interpolation);
    if (*track).has_cell || passed >= left {
        let lost = max(lost_at_ends(*track, point + passed * advance, advance, interpolation), (*track).lost_in_gap);
        (*track).lost += lost;
        let enters = (*track).has_cell && (!(*track).has_last || f32(lost) < (*track).gap);
        (*track).entries += select(0u, 1u, enters);
        (*track).gap = 0.0;
        (*track).lost_in_gap = 0u;
        if (*track).has_cell {
            arrive(track, enters);
        }
    }
    return passed;
}

// Locates a sample that is in doubt. Returns how many samples lie in no cell, this one included.
fn settle_doubt(track: ptr<function, Track>, point: vec3f, interpolation: u32) -> f32 {
    if !(*track).in_doubt {
        return 0.0;
    }
    var location: Location;
    location.in_doubt = true;
    location.skip = 1.0;
    locate_thoroughly(Query(point, vec3f(0.0), MARCH_ENOUGH, interpolation), &location);
    (*track).lost_in_gap += select(0u, 1u, location.is_lost);
    return take(track, location);
}

// Counts the cell of the last sample where the line has come into it.
fn arrive(track: ptr<function, Track>, enters: bool) {
    let here = vec2u((*track).cell.column, (*track).cell.layer);
    (*track).crossings += select(0u, 1u, enters || any(here != (*track).last));
    (*track).has_last = true;
    (*track).last = here;
}

// Number of samples in a gap before `point` that lie in the cell before it, or in the one behind it.
fn lost_at_ends(track: Track, point: vec3f, advance: vec3f, interpolation: u32) -> u32 {
    var lost = 0u;
    for (var side = 0u; side < 2u; side++) {
        let is_before = side == 0u;
        var cell = track.cell;
        if is_before {
            cell = load_cell(track.last.x, track.last.y, interpolation);
        }
        // From that end.
        let start = select(-1.0, -track.gap, is_before);
        let step = select(-1.0, 1.0, is_before);
        let is_known = select(track.has_cell, track.has_last, is_before);
        var n = 0.0;
        while is_known && f32(lost) < track.gap
            && encloses(cell, relative_to(cell, point + (start + step * n) * advance)) {
            n += 1.0;
            lost += 1u;
        }
    }
    return lost;
}

// Goes on to the next sample of a line that has a cell; it has none where the cells do not join.
fn follow(track: ptr<function, Track>, point: vec3f, advance: vec3f, interpolation: u32) {
    (*track).has_cell = false;
    if (column_lists((*track).cell.column).x & COLUMN_FLAG) != 0u {
        // Layers cross: a point of several cells belongs to the first of them, so each sample is located.
        return;
    }
    let last = (*track).solution;
    // Extrapolated with the last inverse Jacobian, so that one iteration usually does.
    let ahead = vec3f(dot(last.inverse_u, advance), dot(last.inverse_v, advance), dot(last.inverse_w, advance));
    if walk_to(track, point, clamp(last.uvw + ahead, vec3f(-1.0), vec3f(2.0)), interpolation) {
        arrive(track, false);
    }
}

// Looks for a sample in a drawn cell, by column and layer, and in those that join.
fn try_from(track: ptr<function, Track>, cell: vec2u, point: vec3f, interpolation: u32) -> bool {
    (*track).cell = load_cell(cell.x, cell.y, interpolation);
    return walk_to(track, point, vec3f(0.5), interpolation);
}

// Looks for a sample in the current cell, from parameters that it may have there, and in those that join.
fn walk_to(track: ptr<function, Track>, point: vec3f, first: vec3f, interpolation: u32) -> bool {
    var start = first;
    for (var attempt = 0u; attempt <= TOPOLOGICAL_LIMIT; attempt++) {
        let s = solve((*track).cell, relative_to((*track).cell, point), start, select(MARCH_ENOUGH, WAY_ENOUGH, BY_SEGMENT));
        (*track).solution = s;
        (*track).iterations += s.iterations;
        (*track).work += s.iterations + 2u;
        if s.inside {
            (*track).has_cell = true;
            break;
        }
        start = s.uvw;
        if attempt == TOPOLOGICAL_LIMIT || !step_to_neighbor(track, &start, interpolation) {
            break;
        }
        (*track).topological_steps += 1u;
    }
    return (*track).has_cell;
}

// Loads the drawn cell that shares the whole face which `uvw` overshoots most; `uvw` becomes a start
// in it. False where the cells do not join: hull, fault, gap, a cell that is not met.
fn step_to_neighbor(track: ptr<function, Track>, uvw: ptr<function, vec3f>, interpolation: u32) -> bool {
    let here = (*track).cell.column;
    let q = *uvw;
    let excess = max(-q, q - vec3f(1.0));
    let axis = select(select(2u, 1u, excess.y >= excess.z), 0u, excess.x >= max(excess.y, excess.z));
    let plus = q[axis] > 0.5;
    let face = 2u * axis + select(0u, 1u, plus);
    let layer = (*track).cell.layer;
    var column = here;
    var next_layer = layer;
    if axis < 2u {
        column = column_behind(here, face);
        if column == NOT_FOUND {
            return false;
        }
    } else {
        if (plus && layer + 1u >= grid.nk) || (!plus && layer == 0u) {
            return false;
        }
        next_layer = select(layer - 1u, layer + 1u, plus);
    }
    if !is_met(column, next_layer) || !faces_join(here, layer, column, next_layer, face) {
        return false;
    }
    (*track).cell = load_cell(column, next_layer, interpolation);
    var start = q;
    start[axis] = select(q[axis] + 1.0, q[axis] - 1.0, plus);
    *uvw = clamp(start, vec3f(-1.0), vec3f(2.0));
    return true;
}

fn faces_join(a: u32, a_layer: u32, b: u32, b_layer: u32, face: u32) -> bool {
    let a_lists = column_lists(a);
    if face >= 4u {
        let mine = depths_at(layer_entries(a_lists, a_layer, face & 1u));
        return all_coincide(mine, depths_at(layer_entries(a_lists, b_layer, 1u - (face & 1u))));
    }
    return sides_join(side_lists(a_lists, face), side_lists(column_lists(b), face ^ 1u), a_layer);
}
