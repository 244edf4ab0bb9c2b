// Ways of a ray through cells, from where it comes into each of them to where it leaves. Places on the ray are numbers
// of samples, and parts of them.
#import boundary

// Surely past a face, in samples.
const PAST_FACE: f32 = 1e-2;
// Ends of a way that are tried; halves of it where a cell is bent.
const MOST_TRIES: u32 = 8u;
// Parameters so near to a face that the rest is straight.
const AT_FACE: f32 = 0.03;
// A way goes to where parameters are off a straight line by less than this.
const MOST_BENT: f32 = 0.2;

// The way through a cell, or a part of it.
struct Way {
    first: f32,
    // How much more there is.
    more: f32,
    // Parameters at both ends, and their changes along a sample.
    start: vec3f,
    end: vec3f,
    start_rate: vec3f,
    end_rate: vec3f,
    // It ends at a face of the cell, or nobody knows where.
    at_face: bool,
    is_lost: bool,
}

// Parameters at a place: a cubic between the ends.
fn parameters_on(way: Way, place: f32) -> vec3f {
    let s = (place - way.first) / select(1.0, way.more, way.more > 0.0);
    let m0 = way.more * way.start_rate;
    let m1 = way.more * way.end_rate;
    let whole = way.end - way.start;
    return way.start + s * (m0 + s * (3.0 * whole - 2.0 * m0 - m1 + s * (m0 + m1 - 2.0 * whole)));
}

fn largest(q: vec3f) -> f32 {
    return max(abs(q.x), max(abs(q.y), abs(q.z)));
}

// Samples up to where parameters leave a cell; negative where they have left it.
fn steps_to_face(q: vec3f, rate: vec3f) -> f32 {
    let room = select(q, vec3f(1.0) - q, rate > vec3f(0.0));
    let steps = room / max(abs(rate), vec3f(1e-9));
    return clamp(min(steps.x, min(steps.y, steps.z)), -1e6, 1e6);
}

// Finds the cell that a ray without one comes into at a place or behind it, and returns where it does; it has none where
// there is none, or where the ray has to pause.
fn enter(track: ptr<function, Track>, ray: Ray, from_place: f32, by_faces: bool) -> f32 {
    // At the face itself the cell that was left seems to hold the ray still.
    var n = from_place + PAST_FACE;
    while needs_cell(*track) && n < ray.count && (*track).work < tile.work_limit {
        if by_faces {
            n += find_behind_faces(track, ray, n);
        } else {
            n += find(track, ray.base + n * ray.advance, ray.advance, frame.interpolation);
        }
    }
    n += settle_doubt(track, ray.base + n * ray.advance, frame.interpolation);
    if !(*track).has_cell {
        return n;
    }
    (*track).lost += (*track).lost_in_gap;
    (*track).lost_in_gap = 0u;
    let found = (*track).solution.uvw;
    let rate = parameters_along((*track).cell, found, ray.advance);
    let back = clamp(steps_to_face(found, -rate), 0.0, n - from_place);
    (*track).solution.uvw = clamp(found - back * rate, vec3f(0.0), vec3f(1.0));
    return n - back;
}

// The way through the cell of a ray from a place on; a part of that way where the cell is bent.
fn cross_cell(track: ptr<function, Track>, ray: Ray, from_place: f32) -> Way {
    let enters = !(*track).has_last || (*track).gap > 0.0;
    (*track).entries += select(0u, 1u, enters);
    (*track).gap = 0.0;
    arrive(track, enters);
    let start = (*track).solution.uvw;
    let rate = parameters_along((*track).cell, start, ray.advance);
    var way = Way(from_place, max(steps_to_face(start, rate), 0.0), start, start, rate, rate, false, false);
    var expected = start + way.more * rate;
    for (var n = 0u; n < MOST_TRIES; n++) {
        let point = relative_to((*track).cell, ray.base + (from_place + way.more) * ray.advance);
        let reached = solve((*track).cell, point, expected, WAY_ENOUGH);
        (*track).iterations += reached.iterations;
        (*track).work += reached.iterations + 2u;
        let is_near = largest(reached.uvw - expected) < MOST_BENT;
        way.end = reached.uvw;
        way.end_rate = parameters_along((*track).cell, reached.uvw, ray.advance);
        let off = steps_to_face(reached.uvw, way.end_rate);
        let left = off * way.end_rate;
        // What that leaves is of its square.
        way.at_face = is_near && largest(left) < AT_FACE;
        if way.at_face {
            way.more = max(way.more + off, 0.0);
            way.end += left;
        }
        if way.at_face || (is_near && reached.inside) {
            (*track).solution.uvw = way.end;
            return way;
        }
        if is_near && largest(left) < MOST_BENT {
            way.more = max(way.more + off, 0.0);
            expected = way.end + left;
        } else {
            way.more *= 0.5;
            expected = start + way.more * rate;
        }
    }
    // Too bent to be followed.
    way.end = start + way.more * rate;
    way.end_rate = rate;
    way.is_lost = true;
    return way;
}

// Goes on where a way has ended, in the same cell or through its face; the ray has no cell where none joins there.
fn leave_cell(track: ptr<function, Track>, way: Way) {
    if way.is_lost {
        (*track).has_cell = false;
    } else if way.at_face {
        var start = (*track).solution.uvw;
        (*track).has_cell = step_to_neighbor(track, &start, frame.interpolation);
        (*track).solution.uvw = clamp(start, vec3f(0.0), vec3f(1.0));
        if (*track).has_cell {
            (*track).topological_steps += 1u;
        }
    }
}
