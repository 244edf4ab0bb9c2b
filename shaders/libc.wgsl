// LIBC: linear interpolation with barycentric coordinates (campagnolo-2021, 4.1.2).
//
// One thread = one ray. The first dispatch covers the tile; those after it only the rays that are left,
// for there are many dispatches and ever fewer rays. From an entry, which depth peeling of the boundary
// faces gives (faces.wgsl), a ray walks from cell to cell through shared faces. Each face is two
// triangles, cut along one diagonal for both of its cells; parameters are linear between the points of
// entry and exit. Reads the grid, the transfer table and the entries; writes states, target, counters.
//
// Corners are projected along the ray, so that it is the origin: edges are cross products, and a shared
// edge gives the same number in each of its cells, so that no ray slips between two of them.
// Departures from the paper: across a fault the cell behind is found by its column's depth lists,
// through collapsed layers by the next one that is not; a segment can be integrated as a whole.
//
// Entry points: `begin` begins rays; `walk` takes entries and walks; `set_right` finds by point location
// the rays that found no way out of their cell. Software adapters run both sides of every branch for
// eight rays together, so what is rare stands outside the loops, and options are pipeline constants.
#import section
#import shading
#import surfaces
#import facing
#import projection
#import segments

// Rays go on across faults and collapsed layers.
override CROSSES: bool = true;
// Segments are integrated as a whole, else samples on the lattice.
override BY_SEGMENT: bool = false;
// Values vary inside a cell.
override BY_VERTEX: bool = true;

// Rays of the tile that have not ended, as pixel numbers.
struct Rays {
    // How many go on after this dispatch.
    left: atomic<u32>,
    // Those before this dispatch and those after it, from where the stage says.
    numbers: array<u32>,
}

// What the dispatch does, how many rays there are, and where the numbers of rays before and after it begin.
@group(3) @binding(0) var<uniform> stage: vec4u;
// Face number + 1 of the next entry, or 0, and the bits of its distance.
@group(3) @binding(1) var entries: texture_2d<u32>;
@group(3) @binding(2) var<storage, read_write> rays: Rays;

// What `stage.x` says: 1 where rays take the entries just drawn, 0 where only paused ones go on.
const ENTERS: u32 = 1u;

// Phases of a ray.
const NEEDS_ENTRY: u32 = 0u;
const WALKS: u32 = 1u;
// Stands at a fault, behind which a cell is to be found.
const CROSSES_FAULT: u32 = 2u;
// Found no way out of its cell.
const STRAYED: u32 = 3u;
const ENDED: u32 = 4u;

// Loop iterations that a step costs beside its samples.
const STEP_WORK: u32 = 8u;
// Steps without progress after which a ray is set right by point location.
const MOST_STALLS: u32 = 32u;
// Recoveries of one ray after which it counts as lost.
const MOST_RECOVERIES: u32 = 1000u;
const NOWHERE: f32 = -1e30;

struct Walk {
    phase: u32,
    column: u32,
    layer: u32,
    // Distance along the ray and parameters at which the current cell was entered.
    t: f32,
    uvw: vec3f,
    // Face through which the last cell was left.
    exit_face: u32,
    // Distance up to which the ray is done.
    done: f32,
    // Next sample of the lattice.
    n: f32,
    // Distance and number of the last entry.
    entry_t: f32,
    entry: u32,
    peels: u32,
    recoveries: u32,
    // Steps in a row that have brought the ray no further.
    stalls: u32,
    // Layers of surfaces that are blended.
    passed: u32,
}

// Corners of a cell relative to the ray: two coordinates across it and the distance along it.
struct Projected {
    p0: vec3f, p1: vec3f, p2: vec3f, p3: vec3f,
    p4: vec3f, p5: vec3f, p6: vec3f, p7: vec3f,
}

struct Exit {
    t: f32,
    face: u32,
    // Parameters on the face along its two axes.
    at: vec2f,
}

fn frame_of(ray: Ray) -> RayFrame {
    let t = max(ray.enter, 0.0);
    return frame_at(ray.origin + t * ray.direction, ray.direction, t);
}

fn project_cell(r: RayFrame, column: u32, layer: u32) -> Projected {
    let p = pillar_index(column);
    let lists = column_lists(column);
    let top = depths_at(layer_entries(lists, layer, 0u));
    let bottom = depths_at(layer_entries(lists, layer, 1u));
    let pillar0 = load_pillar(p.x);
    let pillar1 = load_pillar(p.y);
    let pillar2 = load_pillar(p.z);
    let pillar3 = load_pillar(p.w);
    return Projected(
        project(r, pillar0, top.x), project(r, pillar1, top.y), project(r, pillar2, top.z), project(r, pillar3, top.w),
        project(r, pillar0, bottom.x), project(r, pillar1, bottom.y), project(r, pillar2, bottom.z),
        project(r, pillar3, bottom.w),
    );
}

// Where the ray leaves through a face, if that lies farther than what was found so far. `sense` is the
// sign that the triangles have on the way out. All edges are taken in the direction of rising indices.
fn leave_through(best: ptr<function, Exit>, face: u32, sense: f32, q00: vec3f, q10: vec3f, q01: vec3f, q11: vec3f) {
    let e0 = sense * cross2d(q00, q10);
    let e1 = sense * cross2d(q10, q11);
    let d = sense * cross2d(q00, q11);
    let f = sense * cross2d(q01, q11);
    let g = sense * cross2d(q00, q01);
    let sum1 = e0 + e1 - d;
    if e0 >= 0.0 && e1 >= 0.0 && d <= 0.0 && sum1 > 0.0 {
        let t = (e1 * q00.z - d * q10.z + e0 * q11.z) / sum1;
        if t > (*best).t {
            *best = Exit(t, face, vec2f((e0 - d) / sum1, e0 / sum1));
        }
    }
    let sum2 = d - f - g;
    if d >= 0.0 && f <= 0.0 && g <= 0.0 && sum2 > 0.0 {
        let t = (d * q01.z - f * q00.z - g * q11.z) / sum2;
        if t > (*best).t {
            *best = Exit(t, face, vec2f(-g / sum2, (d - g) / sum2));
        }
    }
}

fn exit_of(c: Projected) -> Exit {
    var best = Exit(NOWHERE, 0u, vec2f(0.0));
    let h = frame.grid_handedness;
    leave_through(&best, 0u, -h, c.p0, c.p2, c.p4, c.p6);
    leave_through(&best, 1u, h, c.p1, c.p3, c.p5, c.p7);
    leave_through(&best, 2u, h, c.p0, c.p1, c.p4, c.p5);
    leave_through(&best, 3u, -h, c.p2, c.p3, c.p6, c.p7);
    leave_through(&best, 4u, -h, c.p0, c.p1, c.p2, c.p3);
    leave_through(&best, 5u, h, c.p4, c.p5, c.p6, c.p7);
    return best;
}

// Distance and parameters on a face of the point at which a ray comes in, clamped into the face.
fn enter_through(c: Projected, face: u32) -> vec3f {
    var q00 = c.p0;
    var q10 = c.p2;
    var q01 = c.p4;
    var q11 = c.p6;
    switch face {
        case 1u: { q00 = c.p1; q10 = c.p3; q01 = c.p5; q11 = c.p7; }
        case 2u: { q00 = c.p0; q10 = c.p1; q01 = c.p4; q11 = c.p5; }
        case 3u: { q00 = c.p2; q10 = c.p3; q01 = c.p6; q11 = c.p7; }
        case 4u: { q00 = c.p0; q10 = c.p1; q01 = c.p2; q11 = c.p3; }
        case 5u: { q00 = c.p4; q10 = c.p5; q01 = c.p6; q11 = c.p7; }
        default: {}
    }
    let sense = -frame.grid_handedness * face_orientation(face);
    let e0 = max(sense * cross2d(q00, q10), 0.0);
    let e1 = max(sense * cross2d(q10, q11), 0.0);
    let d = sense * cross2d(q00, q11);
    let f = max(-sense * cross2d(q01, q11), 0.0);
    let g = max(-sense * cross2d(q00, q01), 0.0);
    if d <= 0.0 {
        let sum = max(e0 + e1 - d, 1e-30);
        return vec3f((e1 * q00.z - d * q10.z + e0 * q11.z) / sum, (e0 - d) / sum, e0 / sum);
    }
    let sum = max(d + f + g, 1e-30);
    return vec3f((d * q01.z + f * q00.z + g * q11.z) / sum, g / sum, (d + g) / sum);
}

@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= tile.size) {
        return;
    }
    let number = id.y * tile.size.x + id.x;
    let pixel = tile.origin + id.xy;
    let whole = ray_of(pixel);
    let layers = layers_of(pixel, 0u, 0.0);
    let ray = before_opaque(whole, layers);
    var walk: Walk;
    var tally: Tally;
    walk.done = ray.enter;
    walk.entry_t = NOWHERE;
    walk.t = ray.enter;
    walk.phase = select(NEEDS_ENTRY, STRAYED, ray.starts_inside);
    let section = section_color(whole);
    if ray.leave <= ray.enter || section.a == 1.0 {
        walk.phase = ENDED;
    }
    if walk.phase == STRAYED {
        locate_again(&walk, ray, &tally);
        tally.entries += select(0u, 1u, walk.phase == WALKS);
    }
    finish(number, walk, Accumulated(section.rgb, 1.0 - section.a), layers, tally);
}

@compute @workgroup_size(64)
fn set_right(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= stage.y {
        return;
    }
    let number = rays.numbers[stage.z + id.x];
    var walk = load_walk(number);
    if walk.phase != STRAYED {
        return;
    }
    var tally: Tally;
    let ray = ray_of(tile.origin + in_tile(number));
    walk.t += 0.25 * frame.step;
    let cell = load_cell(walk.column, walk.layer, frame.interpolation);
    locate_again(&walk, ray, &tally);
    // The next sample is lost where the ray has no cell, and yet the last one holds the sample.
    let n = max(walk.n, ceil(walk.t / frame.step - 0.5) - ray.first);
    let point = ray.base + n * ray.advance;
    if walk.phase != WALKS && n < ray.count && encloses(cell, relative_to(cell, point)) {
        tally.lost += 1u;
    }
    store_walk(number, walk);
    add_up(tally);
}

@compute @workgroup_size(64)
fn walk(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= stage.y {
        return;
    }
    let number = rays.numbers[stage.z + id.x];
    var walk = load_walk(number);
    let place = in_tile(number);
    let whole = ray_of(tile.origin + place);
    var layers = layers_of(tile.origin + place, walk.passed, distance_of(whole, walk.n));
    let ray = before_opaque(whole, layers);
    let r = frame_of(ray);
    let sums = bitcast<vec4f>(ray_states[LIBC_STATE * number]);
    var sum = Accumulated(sums.rgb, sums.a);
    var tally: Tally;
    if walk.phase == NEEDS_ENTRY && stage.x == ENTERS {
        enter(&walk, r, textureLoad(entries, vec2i(place), 0).xy);
        tally.entries += select(0u, 1u, walk.phase == WALKS);
    }
    while (walk.phase == WALKS || walk.phase == CROSSES_FAULT) && tally.work < tile.work_limit {
        while walk.phase == WALKS && tally.work < tile.work_limit {
            tally.work += STEP_WORK;
            tally.steps += 1u;
            let exit = exit_of(project_cell(r, walk.column, walk.layer));
            walk.stalls = select(0u, walk.stalls + 1u, exit.t <= walk.t);
            if exit.t == NOWHERE || walk.stalls > MOST_STALLS {
                walk.phase = STRAYED;
                break;
            }
            let uvw = on_face(exit.face, exit.at);
            let t = max(exit.t, walk.t);
            if !integrate(&walk, &sum, &layers, ray, t, uvw, &tally) {
                break;
            }
            walk.t = t;
            walk.done = t;
            walk.uvw = uvw;
            walk.exit_face = exit.face;
            tally.crossings += 1u;
            step_through(&walk);
            if !is_open(sum) || walk.n >= ray.count || t >= ray.leave {
                walk.phase = ENDED;
            }
        }
        if walk.phase == CROSSES_FAULT {
            cross_fault(&walk, r);
        }
    }
    finish(number, walk, sum, layers, tally);
}

// Distance of a sample.
fn distance_of(ray: Ray, n: f32) -> f32 {
    return (ray.first + n + 0.5) * frame.step;
}

fn in_tile(number: u32) -> vec2u {
    return vec2u(number % tile.size.x, number / tile.size.x);
}

// Writes the picture where a ray has ended; else its state, and lists it for the next dispatch.
fn finish(number: u32, walk: Walk, sum: Accumulated, layers: Layers, tally: Tally) {
    let is_lost = walk.recoveries > MOST_RECOVERIES;
    if walk.phase == ENDED || is_lost {
        let pixel = tile.origin + in_tile(number);
        var whole = sum;
        var rest = layers;
        while blend_layer(&rest, &whole, BEYOND_LAYERS) {}
        count_cube(rest);
        textureStore(target_image, vec2i(pixel), vec4f(whole.color, 1.0 - whole.transmittance));
        count(COUNT_FINISHED, 1u);
        count(COUNT_LOST, select(0u, 1u, is_lost));
        atomicMax(&counters[2u * COUNT_PEELS], walk.peels);
    } else {
        var whole = sum;
        var before = layers;
        if CUBE {
            // The march begins at the next sample where the ray goes on.
            let next = distance_of(ray_of(tile.origin + in_tile(number)), walk.n);
            while blend_layer(&before, &whole, next) {}
            count_cube(before);
        }
        ray_states[LIBC_STATE * number] = bitcast<vec4u>(vec4f(whole.color, whole.transmittance));
        var state = walk;
        state.passed = before.passed;
        store_walk(number, state);
        rays.numbers[stage.w + atomicAdd(&rays.left, 1u)] = number;
        count(COUNT_PAUSED, select(0u, 1u, walk.phase != NEEDS_ENTRY));
        count(COUNT_RECOVERED, select(0u, 1u, walk.phase == STRAYED));
    }
    add_up(tally);
}

fn add_up(tally: Tally) {
    count(COUNT_SAMPLES, tally.samples);
    count(COUNT_ITERATIONS, tally.iterations);
    count(COUNT_STEPS, tally.steps);
    count(COUNT_FALLBACKS, tally.fallbacks);
    count(COUNT_WORK, tally.work);
    count(COUNT_ENTRIES, tally.entries);
    count(COUNT_CROSSINGS, tally.crossings);
    count(COUNT_LOST_SAMPLES, tally.lost);
}

// What a dispatch adds to the counters.
struct Tally {
    samples: u32,
    iterations: u32,
    steps: u32,
    fallbacks: u32,
    work: u32,
    entries: u32,
    crossings: u32,
    lost: u32,
}

fn load_walk(number: u32) -> Walk {
    let state = LIBC_STATE * number;
    let a = ray_states[state + 1u];
    let b = bitcast<vec4f>(ray_states[state + 2u]);
    let c = ray_states[state + 3u];
    return Walk(c.y & 7u, c.x, c.y >> 6u, b.w, b.xyz, c.y >> 3u & 7u, bitcast<f32>(a.y), bitcast<f32>(a.x),
        bitcast<f32>(a.z), a.w, c.z & 0xffffffu, c.w & 0xffffu, c.w >> 16u, c.z >> 24u);
}

fn store_walk(number: u32, walk: Walk) {
    let state = LIBC_STATE * number;
    ray_states[state + 1u] = vec4u(bitcast<vec3u>(vec3f(walk.n, walk.done, walk.entry_t)), walk.entry);
    ray_states[state + 2u] = bitcast<vec4u>(vec4f(walk.uvw, walk.t));
    ray_states[state + 3u] = vec4u(walk.column, walk.phase | walk.exit_face << 3u | walk.layer << 6u,
        walk.peels | walk.passed << 24u, walk.recoveries | walk.stalls << 16u);
}

// Locates the ray at its distance; it walks on in its cell, or needs an entry where there is none.
fn locate_again(walk: ptr<function, Walk>, ray: Ray, tally: ptr<function, Tally>) {
    let point = ray.origin + (*walk).t * ray.direction;
    let location = locate(Query(point, vec3f(0.0), SECTION_ENOUGH, frame.interpolation));
    (*tally).fallbacks += 1u;
    (*tally).iterations += location.iterations;
    (*tally).work += location.work;
    (*walk).done = max((*walk).done, (*walk).t);
    (*walk).stalls = 0u;
    (*walk).recoveries += 1u;
    (*walk).phase = NEEDS_ENTRY;
    if location.found {
        (*walk).phase = WALKS;
        (*walk).column = location.cell.column;
        (*walk).layer = location.cell.layer;
        (*walk).uvw = clamp(location.solution.uvw, vec3f(0.0), vec3f(1.0));
    }
}

// Takes the entry that peeling found; a ray without one has ended.
fn enter(walk: ptr<function, Walk>, r: RayFrame, entry: vec2u) {
    if entry.x == 0u {
        (*walk).phase = ENDED;
        return;
    }
    let face = (entry.x - 1u) % 6u;
    let slot = (entry.x - 1u) / 6u;
    (*walk).peels += 1u;
    (*walk).entry = entry.x;
    (*walk).entry_t = bitcast<f32>(entry.y);
    (*walk).phase = WALKS;
    (*walk).column = slot / grid.nk;
    (*walk).layer = slot % grid.nk;
    let at = enter_through(project_cell(r, (*walk).column, (*walk).layer), face);
    (*walk).t = at.x;
    (*walk).uvw = on_face(face, at.yz);
}

// Moves the ray into the cell behind its exit, to the fault there, or to the end of the peel.
fn step_through(walk: ptr<function, Walk>) {
    let face = (*walk).exit_face;
    let column = (*walk).column;
    let layer = (*walk).layer;
    (*walk).phase = NEEDS_ENTRY;
    if face >= 4u {
        let next = next_layer(column, layer, face == 5u);
        if next != NOT_FOUND {
            (*walk).layer = next;
            (*walk).uvw.z = 1.0 - (*walk).uvw.z;
            (*walk).phase = WALKS;
        }
        return;
    }
    let next = column_behind(column, face);
    if next == NOT_FOUND {
        return;
    }
    let lists = column_lists(next);
    if sides_join(side_lists(column_lists(column), face), side_lists(lists, face ^ 1u), layer) {
        if is_met(next, layer) {
            (*walk).column = next;
            let turned = vec3f(1.0) - (*walk).uvw;
            (*walk).uvw = vec3f(select((*walk).uvw.x, turned.x, face < 2u), select((*walk).uvw.y, turned.y, face >= 2u),
                (*walk).uvw.z);
            (*walk).phase = WALKS;
        }
    } else if CROSSES && (lists.x & COLUMN_FLAG) == 0u {
        (*walk).phase = CROSSES_FAULT;
    }
}

// The layer below or above that the ray comes into, or NOT_FOUND.
fn next_layer(column: u32, layer: u32, plus: bool) -> u32 {
    let lists = column_lists(column);
    var at = layer;
    let mine = depths_at(layer_entries(lists, layer, select(0u, 1u, plus)));
    while (plus && at + 1u < grid.nk) || (!plus && at > 0u) {
        at = select(at - 1u, at + 1u, plus);
        if !all_coincide(mine, depths_at(layer_entries(lists, at, select(1u, 0u, plus)))) {
            return NOT_FOUND;
        }
        if is_met(column, at) {
            return at;
        }
        // A layer without thickness hides nothing; what is behind it joins.
        if !CROSSES || !all_coincide(mine, depths_at(layer_entries(lists, at, select(0u, 1u, plus)))) {
            return NOT_FOUND;
        }
    }
    return NOT_FOUND;
}

// Enters the cell of the next column that the ray meets at a fault: the layer whose upper and lower edge
// have the ray between them. Where there is none the peel ends.
fn cross_fault(walk: ptr<function, Walk>, r: RayFrame) {
    let next = column_behind((*walk).column, (*walk).exit_face);
    let face = (*walk).exit_face ^ 1u;
    // Edges have the sense of the face that was left.
    let sense = frame.grid_handedness * face_orientation((*walk).exit_face);
    let lists = side_lists(column_lists(next), face);
    let numbers = pillar_index(next);
    let pillar_a = load_pillar(numbers[face_corner(face, 0u)]);
    let pillar_b = load_pillar(numbers[face_corner(face, 1u)]);
    var low = 0u;
    var high = grid.nk;
    while low < high {
        let middle = (low + high) / 2u;
        if is_below(r, pillar_a, pillar_b, lists, middle, 1u, sense) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    (*walk).phase = NEEDS_ENTRY;
    if low < grid.nk && is_met(next, low) && is_below(r, pillar_a, pillar_b, lists, low, 0u, sense) {
        (*walk).phase = WALKS;
        (*walk).column = next;
        (*walk).layer = low;
        let at = enter_through(project_cell(r, next, low), face);
        (*walk).uvw = on_face(face, at.yz);
    }
}

// True where the ray passes below the upper or lower edge of a layer between two pillars.
fn is_below(r: RayFrame, a: Pillar, b: Pillar, lists: vec2u, layer: u32, bottom: u32, sense: f32) -> bool {
    let p = project(r, a, depth_at(list_entry(lists.x, layer, bottom)));
    let q = project(r, b, depth_at(list_entry(lists.y, layer, bottom)));
    return sense * cross2d(p, q) > 0.0;
}

// The value along a segment: trilinear at parameters that are linear in the distance.
struct Segment {
    t: f32,
    length: f32,
    uvw: vec3f,
    along: vec3f,
    top: vec4f,
    bottom: vec4f,
}

fn segment_value(s: Segment, t: f32) -> f32 {
    let q = s.uvw + s.along * clamp((t - s.t) / s.length, 0.0, 1.0);
    let values = mix(s.top, s.bottom, q.z);
    let pair = mix(values.xz, values.yw, q.x);
    return mix(pair.x, pair.y, q.y);
}

// Adds what lies between the current place of the ray and its exit at distance `t`; false where the ray
// pauses before. Surfaces lie on faces, so those that are nearer than the exit lie at the entry, and what is
// opaque ends the ray.
fn integrate(walk: ptr<function, Walk>, sum: ptr<function, Accumulated>, layers: ptr<function, Layers>, ray: Ray,
    t: f32, uvw: vec3f, tally: ptr<function, Tally>) -> bool {
    while blend_surface(layers, sum, 0.5 * ((*walk).t + min(t, ray.leave))) {}
    var s: Segment;
    s.t = (*walk).t;
    s.length = max(t - s.t, 1e-20);
    s.uvw = (*walk).uvw;
    s.along = uvw - s.uvw;
    if BY_VERTEX {
        let lists = column_lists((*walk).column);
        s.top = values_at(layer_entries(lists, (*walk).layer, 0u));
        s.bottom = values_at(layer_entries(lists, (*walk).layer, 1u));
    } else {
        s.top = vec4f(cell_value((*walk).column, (*walk).layer));
        s.bottom = s.top;
    }
    let is_ghost = is_ghost((*walk).column, (*walk).layer);
    if BY_SEGMENT {
        let from_t = max(max(s.t, (*walk).done), ray.enter);
        if is_ghost {
            let to_t = max(from_t, min(t, ray.leave));
            let entry = lit(frame.ghost, ray, 0.5 * (from_t + to_t), true, tally);
            *sum = absorb(*sum, entry, frame.ghost.w * (to_t - from_t));
            return true;
        }
        integrate_segment(s, sum, ray, from_t, min(t, ray.leave), tally);
        return true;
    }
    // Samples from the first one at or behind the entry to the last one before the exit.
    let first = ceil(s.t / frame.step - 0.5) - ray.first;
    let end = min(ceil(t / frame.step - 0.5) - ray.first, ray.count);
    var n = max((*walk).n, first);
    let count = max(0.0, end - n);
    if !LIT && !CUBE && (!BY_VERTEX || is_ghost) {
        var entry = transfer(s.top.x);
        if is_ghost {
            entry = frame.ghost;
        }
        let depth = entry.w * frame.step;
        // Not beyond the sample at which the ray ends.
        let needed = ceil(log(max(frame.early_termination, 1e-30) / (*sum).transmittance) / -max(depth, 1e-20));
        *sum = absorb(*sum, entry, depth * min(count, max(needed, 1.0)));
        (*tally).samples += u32(count);
        (*tally).work += 1u;
        n += count;
    }
    // Shaded samples may be so dear that a ray pauses within a cell.
    while n < end && is_open(*sum) && (!LIT || (*tally).work < tile.work_limit) {
        let at = distance_of(ray, n);
        if CUBE {
            // Surfaces behind the middle of the cell lie at its exit.
            blend_cube_until(layers, sum, at);
        }
        var entry = transfer(segment_value(s, at));
        if (LIT || CUBE) && is_ghost {
            entry = frame.ghost;
        }
        if LIT {
            entry = lit(entry, ray, at, is_ghost, tally);
        }
        *sum = accumulate(*sum, entry);
        n += 1.0;
        (*tally).samples += 1u;
        (*tally).work += 1u;
    }
    let is_whole = n >= end || !is_open(*sum);
    (*walk).n = select(n, max((*walk).n, max(end, n)), is_whole);
    return is_whole;
}

// The color and extinction of a sample at a distance along the ray, shaded.
fn lit(entry: vec4f, ray: Ray, t: f32, is_ghost: bool, tally: ptr<function, Tally>) -> vec4f {
    if LIT && entry.w > 0.0 {
        (*tally).work += lighting.work;
        return vec4f(shade(entry.rgb, ray.origin + t * ray.direction, is_ghost), entry.w);
    }
    return entry;
}

// Adds a segment in pieces.
fn integrate_segment(s: Segment, sum: ptr<function, Accumulated>, ray: Ray, from_t: f32, to_t: f32,
    tally: ptr<function, Tally>) {
    if to_t <= from_t {
        return;
    }
    let length = to_t - from_t;
    let first = segment_value(s, from_t);
    let middle = segment_value(s, from_t + 0.5 * length);
    let last = segment_value(s, to_t);
    let pieces = piece_count(vec3f(first, middle, last), length);
    var before = first;
    for (var n = 1.0; n <= pieces && is_open(*sum); n += 1.0) {
        let value = segment_value(s, from_t + length * n / pieces);
        let entry = piece_entry(before, value);
        let middle = from_t + length * (n - 0.5) / pieces;
        *sum = absorb(*sum, lit(entry, ray, middle, false, tally), entry.w * length / pieces);
        before = value;
        (*tally).samples += 1u;
        (*tally).work += 1u;
    }
}
