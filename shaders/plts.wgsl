// PLTS: point location with topological search (campagnolo-2021, 4.1.3).
//
// One thread = one pixel; dispatch covers the tile. Reads the grid and the transfer table, writes
// the target and the counters. The first sample of a ray that lies in a cell is found behind the boundary
// face that the ray passes; each next one by Newton's method in the same cell, then in the neighbor across the
// face that the result overshoots most, and behind a boundary face again where the cells do not join.
// Departures from the paper: the start value is extrapolated with the last inverse Jacobian, so that
// one iteration usually does; where the neighbor is not drawn, the grid is asked at once and no other
// neighbor; and the hull is met in bins instead of rasterized. A ray that
// has done tile.work_limit loop iterations pauses: drivers end long loops without a word (llvmpipe
// after 65,535 iterations of all loops together), and no submission may run for long.
//
// By segments a ray goes from where it comes into each cell to where it leaves, and what lies between is integrated as
// a whole; it pauses between two cells.
#import boundary
#import section
#import segments
#import shading
#import surfaces
#import topology
#import ways

// There are lists of boundary faces; else all samples are searched.
override BY_FACES: bool = false;

// State of a ray: its sums; then the number of the next sample, layers of surfaces that are blended and above them
// the gap before the sample, column of the last cell, and its layer with whether there is one.
const PASSED_BITS: u32 = 8u;
const MOST_PASSED: u32 = 0xffu;
const MOST_GAP: f32 = 16777215.0;
const HAS_LAST: u32 = 0x80000000u;
// By segments: the ray goes on in its last cell.
const GOES_ON: u32 = 0x40000000u;

// Ways without length in a row after which a ray is located anew, and how far ahead, in samples.
const MOST_STALLS: u32 = 32u;
const NUDGE: f32 = 0.25;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= tile.size) {
        return;
    }
    let pixel = tile.origin + id.xy;
    let whole = ray_of(pixel);
    let state = RAY_STATE * (id.y * tile.size.x + id.x);
    var sum = Accumulated(vec3f(0.0), 1.0);
    var n = 0.0;
    var passed = 0u;
    var track: Track;
    if tile.resume == 1u {
        n = bitcast<f32>(ray_states[state + 1u].x);
        if n == DONE {
            return;
        }
        let words = ray_states[state + 1u];
        passed = words.y & MOST_PASSED;
        track.gap = f32(words.y >> PASSED_BITS);
        track.has_last = (words.w & HAS_LAST) != 0u;
        track.last = vec2u(words.z, words.w & ~(HAS_LAST | GOES_ON));
        track.has_paused = !BY_SEGMENT && track.has_last && track.gap == 0.0;
        track.has_cell = (words.w & GOES_ON) != 0u;
        let sums = bitcast<vec4f>(ray_states[state]);
        sum = Accumulated(sums.rgb, sums.a);
    } else {
        let section = section_color(whole);
        sum = Accumulated(section.rgb, 1.0 - section.a);
    }
    let behind = select(0.0, distance_of(whole, n), tile.resume == 1u);
    var layers = layers_of(pixel, passed, behind);
    let ray = before_opaque(whole, layers);
    let end = select(ray.count, place_of(ray, ray.leave), BY_SEGMENT);
    var samples = 0u;
    if BY_SEGMENT {
        if tile.resume != 1u {
            n = place_of(ray, ray.enter);
        } else if track.has_cell {
            go_on(&track, ray, n);
        }
        n = follow_ways(&track, &layers, &sum, ray, vec2f(n, end), &samples);
    }
    // Two phases, so that rays side by side locate together and march together.
    while !BY_SEGMENT && n < ray.count && is_open(sum) && track.work < tile.work_limit {
        while needs_cell(track) && n < ray.count && track.work < tile.work_limit {
            if BY_FACES {
                n += find_behind_faces(&track, ray, n);
            } else {
                n += find(&track, ray.base + n * ray.advance, ray.advance, frame.interpolation);
            }
        }
        n += settle(&track, ray.base + n * ray.advance, ray.advance, ray.count - n, frame.interpolation);
        while track.has_cell {
            if blend_layer(&layers, &sum, (ray.first + n + 0.5) * frame.step) {
                continue;
            }
            samples += 1u;
            let is_ghost = is_ghost(track.cell.column, track.cell.layer);
            var entry = transfer(value_on(track));
            if is_ghost {
                entry = frame.ghost;
            }
            if LIT && entry.w > 0.0 {
                entry = vec4f(shade(entry.rgb, ray.base + n * ray.advance, is_ghost), entry.w);
                track.work += lighting.work;
            }
            sum = accumulate(sum, entry);
            n += 1.0;
            if n >= ray.count || !is_open(sum) || track.work >= tile.work_limit {
                break;
            }
            follow(&track, ray.base + n * ray.advance, ray.advance, frame.interpolation);
        }
    }
    if CUBE && n < end {
        // The march begins here where the ray goes on.
        while blend_layer(&layers, &sum, distance_of(ray, n)) {}
    }
    if n < end && is_open(sum) {
        ray_states[state] = bitcast<vec4u>(vec4f(sum.color, sum.transmittance));
        let gap = u32(min(track.gap, MOST_GAP));
        let goes_on = BY_SEGMENT && track.has_cell;
        let last = select(track.last, vec2u(track.cell.column, track.cell.layer), goes_on);
        ray_states[state + 1u] = vec4u(bitcast<u32>(n), layers.passed | gap << PASSED_BITS, last.x,
            last.y | select(0u, HAS_LAST, track.has_last) | select(0u, GOES_ON, goes_on));
    } else {
        while blend_layer(&layers, &sum, BEYOND_LAYERS) {}
        ray_states[state + 1u] = vec4u(bitcast<u32>(DONE), 0u, 0u, 0u);
        textureStore(target_image, vec2i(pixel), vec4f(sum.color, 1.0 - sum.transmittance));
        count(COUNT_FINISHED, 1u);
    }
    count(COUNT_SAMPLES, samples);
    count(COUNT_ITERATIONS, track.iterations);
    count(COUNT_STEPS, track.topological_steps);
    count(COUNT_FALLBACKS, track.fallbacks);
    count(COUNT_WORK, track.work);
    count(COUNT_ENTRIES, track.entries);
    count(COUNT_CROSSINGS, track.crossings);
    count(COUNT_LOST_SAMPLES, track.lost);
    count_cube(layers);
}

// The place on a ray at a distance from its origin, and the distance of a place.
fn place_of(ray: Ray, distance: f32) -> f32 {
    return distance / frame.step - 0.5 - ray.first;
}

fn distance_of(ray: Ray, place: f32) -> f32 {
    return (ray.first + place + 0.5) * frame.step;
}

// Takes a ray that has paused back into its last cell.
fn go_on(track: ptr<function, Track>, ray: Ray, place: f32) {
    let last = (*track).last;
    (*track).cell = load_cell(last.x, last.y, frame.interpolation);
    let point = relative_to((*track).cell, ray.base + place * ray.advance);
    let s = solve((*track).cell, point, vec3f(0.5), MARCH_ENOUGH);
    (*track).iterations += s.iterations;
    (*track).solution.uvw = clamp(s.uvw, vec3f(0.0), vec3f(1.0));
}

// Takes a ray through cells between two places, and returns where it ends or pauses.
fn follow_ways(track: ptr<function, Track>, layers: ptr<function, Layers>, sum: ptr<function, Accumulated>, ray: Ray,
    places: vec2f, samples: ptr<function, u32>) -> f32 {
    var n = places.x;
    var stalls = 0u;
    var recovered = 0u;
    while n < places.y && is_open(*sum) && (*track).work < tile.work_limit {
        if !(*track).has_cell {
            n = enter(track, ray, n, BY_FACES);
        }
        while (*track).has_cell && n < places.y && is_open(*sum) && (*track).work < tile.work_limit {
            let way = cross_cell(track, ray, n);
            let to_place = way.first + way.more;
            stalls = select(stalls + 1u, 0u, to_place > n);
            *samples += integrate(track, layers, sum, ray, way, min(to_place, places.y));
            n = max(n, to_place);
            leave_cell(track, way);
            if stalls > MOST_STALLS {
                (*track).has_cell = false;
                stalls = 0u;
                recovered += 1u;
                n += NUDGE;
            }
        }
    }
    count(COUNT_RECOVERED, recovered);
    return n;
}

// Adds what lies on a way, up to a place; returns the number of pieces. Surfaces lie on faces, so those that are nearer
// than its end lie at its beginning.
fn integrate(track: ptr<function, Track>, layers: ptr<function, Layers>, sum: ptr<function, Accumulated>, ray: Ray,
    way: Way, to_place: f32) -> u32 {
    let from_place = way.first;
    let middle = distance_of(ray, 0.5 * (from_place + to_place));
    while blend_surface(layers, sum, middle) {}
    if to_place <= from_place {
        return 0u;
    }
    let length = (to_place - from_place) * frame.step;
    if is_ghost((*track).cell.column, (*track).cell.layer) {
        let entry = lit(track, ray, frame.ghost, 0.5 * (from_place + to_place), true);
        *sum = absorb(*sum, entry, entry.w * length);
        return 0u;
    }
    let first = value_at_place(*track, way, from_place);
    let center = value_at_place(*track, way, 0.5 * (from_place + to_place));
    let last = value_at_place(*track, way, to_place);
    let pieces = piece_count(vec3f(first, center, last), length);
    var before = first;
    var done = 0u;
    for (var piece = 1.0; piece <= pieces && is_open(*sum); piece += 1.0) {
        let value = value_at_place(*track, way, mix(from_place, to_place, piece / pieces));
        let at = mix(from_place, to_place, (piece - 0.5) / pieces);
        let entry = lit(track, ray, piece_entry(before, value), at, false);
        *sum = absorb(*sum, entry, entry.w * length / pieces);
        before = value;
        done += 1u;
    }
    (*track).work += done;
    return done;
}

fn value_at_place(track: Track, way: Way, place: f32) -> f32 {
    return evaluate(track.cell, clamp(parameters_on(way, place), vec3f(0.0), vec3f(1.0))).w;
}

// A color and extinction at a place on the ray, shaded.
fn lit(track: ptr<function, Track>, ray: Ray, entry: vec4f, place: f32, is_ghost: bool) -> vec4f {
    if LIT && entry.w > 0.0 {
        (*track).work += lighting.work;
        return vec4f(shade(entry.rgb, ray.base + place * ray.advance, is_ghost), entry.w);
    }
    return entry;
}
