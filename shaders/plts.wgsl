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
#import boundary
#import section
#import shading
#import surfaces
#import topology

// There are lists of boundary faces; else all samples are searched.
override BY_FACES: bool = false;

// State of a ray: its sums; then the number of the next sample, layers of surfaces that are blended and above them
// the gap before the sample, column of the last cell, and its layer with whether there is one.
const PASSED_BITS: u32 = 8u;
const MOST_PASSED: u32 = 0xffu;
const MOST_GAP: f32 = 16777215.0;
const HAS_LAST: u32 = 0x80000000u;

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
        track.last = vec2u(words.z, words.w & ~HAS_LAST);
        track.has_paused = track.has_last && track.gap == 0.0;
        let sums = bitcast<vec4f>(ray_states[state]);
        sum = Accumulated(sums.rgb, sums.a);
    } else {
        let section = section_color(whole);
        sum = Accumulated(section.rgb, 1.0 - section.a);
    }
    var layers = layers_of(pixel, passed);
    let ray = before_opaque(whole, layers);
    var samples = 0u;
    // Two phases, so that rays side by side locate together and march together.
    while n < ray.count && is_open(sum) && track.work < tile.work_limit {
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
    if n < ray.count && is_open(sum) {
        ray_states[state] = bitcast<vec4u>(vec4f(sum.color, sum.transmittance));
        let gap = u32(min(track.gap, MOST_GAP));
        ray_states[state + 1u] = vec4u(bitcast<u32>(n), layers.passed | gap << PASSED_BITS, track.last.x,
            track.last.y | select(0u, HAS_LAST, track.has_last));
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
}
