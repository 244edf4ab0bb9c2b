// SRG: structured resampled grid (campagnolo-2021, 4.1.1; accelerations: volumetric-ray-tracing survey, 8).
//
// One thread = one pixel; dispatch covers the tile. `begin` cuts the ray to what lies between the first
// and the last boundary face, which were rasterized before, and draws its section where a clip plane opens
// the model; `march` takes samples of the common lattice from the volume. Reads volume, bricks, faces and
// the transfer table; writes states, target and counters. Only `begin` reads the grid.
// A ray passes a brick, or a larger part of the pyramid, at once where it is empty; in one step where it
// is even; in longer steps, from the average pyramid, where it is thin.
#import section
#import surfaces
#import random

// A clip plane has an opaque section.
override SECTIONS: bool = false;
// Values are divided by presence, so that they do not fade toward voxels that are absent.
override WEIGHTED: bool = true;
// Rays ask the bricks how to pass them; else every sample is taken.
override BY_BRICK: bool = true;
// A sample may stand for several.
override LONG_STEPS: bool = true;
// Transmittance below which a ray ends with a probability; zero for never.
override ROULETTE: f32 = 0.0;

@group(3) @binding(0) var<uniform> volume: VolumeInfo;
@group(3) @binding(1) var<uniform> bricks: BricksInfo;
// Value times presence, presence, and presence of ghosts.
@group(3) @binding(2) var voxels: texture_3d<f32>;
@group(3) @binding(3) var linear: sampler;
@group(3) @binding(4) var<storage, read> passes: array<u32>;
// Face number + 1 of the first entry and of the last exit, or 0, and the bits of their distances.
@group(3) @binding(5) var entries: texture_2d<u32>;
@group(3) @binding(6) var exits: texture_2d<u32>;

// Samples that are taken alike.
struct Stretch {
    end: f32,
    // Samples that one stands for, and the level of the average pyramid that it is taken from.
    stride: f32,
    level: f32,
}


@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= tile.size) {
        return;
    }
    let pixel = tile.origin + id.xy;
    let whole = ray_of(pixel);
    let ray = before_opaque(whole, layers_of(pixel, 0u, 0.0));
    let entry = textureLoad(entries, vec2i(id.xy), 0).xy;
    let exit = textureLoad(exits, vec2i(id.xy), 0).xy;
    let enter = select(bitcast<f32>(entry.y), ray.enter, ray.starts_inside);
    let first = max(0.0, ceil(enter / frame.step - 0.5) - ray.first);
    let last = min(ray.count - 1.0, floor(bitcast<f32>(exit.y) / frame.step - 0.5) - ray.first);
    let is_met = exit.x != 0u && (entry.x != 0u || ray.starts_inside);
    var color = vec4f(0.0);
    if SECTIONS {
        color = section_color(whole);
    }
    let state = RAY_STATE * (id.y * tile.size.x + id.x);
    ray_states[state] = bitcast<vec4u>(vec4f(color.rgb, 1.0 - color.a));
    ray_states[state + 1u] = vec4u(bitcast<vec2u>(vec2f(first, select(0.0, last + 1.0, is_met))), 0u, 0u);
    count(COUNT_ENTRIES, select(0u, 1u, is_met));
}

@compute @workgroup_size(8, 8)
fn march(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= tile.size) {
        return;
    }
    let pixel = tile.origin + id.xy;
    let state = RAY_STATE * (id.y * tile.size.x + id.x);
    let span = bitcast<vec2f>(ray_states[state + 1u].xy);
    var n = span.x;
    if n == DONE {
        return;
    }
    let sums = bitcast<vec4f>(ray_states[state]);
    var sum = Accumulated(sums.rgb, sums.a);
    let ray = ray_of(pixel);
    var layers = layers_of(pixel, ray_states[state + 1u].z, select((ray.first + n + 0.5) * frame.step, 0.0, ray_states[state + 1u].w == 0u));
    let base = (ray.base - volume.box_low) / volume.box_extent;
    let advance = ray.advance / volume.box_extent;
    var samples = 0u;
    var work = 0u;
    var stretch = Stretch(select(span.y, 0.0, BY_BRICK), 1.0, 0.0);
    var sees_nothing = true;
    while n < span.y && is_open(sum) && work < tile.work_limit {
        work += 1u;
        // Where all steps are alike, bricks are asked only where a sample shows nothing.
        if BY_BRICK && n >= stretch.end && (LONG_STEPS || sees_nothing) {
            stretch = stretch_at(base + n * advance, advance, n, span.y);
        }
        if stretch.stride == 0.0 {
            n = stretch.end;
            continue;
        }
        var taken = stretch.stride;
        if LONG_STEPS {
            taken = min(taken, stretch.end - n);
        }
        if blend_layer(&layers, &sum, (ray.first + n + 0.5 * taken) * frame.step) {
            continue;
        }
        let at = base + (n + 0.5 * (taken - 1.0)) * advance;
        let voxel = textureSampleLevel(voxels, linear, at, stretch.level).xyz;
        let before = sum.transmittance;
        let place = ray.base + (n + 0.5 * (taken - 1.0)) * ray.advance;
        sum = add(sum, voxel, taken, place);
        work += select(0u, lighting.work, LIT && sum.transmittance < before);
        sees_nothing = sum.transmittance == before;
        samples += select(0u, 1u, voxel.y + voxel.z > 0.0);
        n += taken;
        if ROULETTE > 0.0 && sum.transmittance < ROULETTE {
            let survives = random(pixel, u32(n)) * ROULETTE < sum.transmittance;
            sum.transmittance = select(0.0, ROULETTE, survives);
        }
    }
    if CUBE && n < span.y {
        // The march begins here where the ray goes on.
        while blend_layer(&layers, &sum, (ray.first + n + 0.5) * frame.step) {}
    }
    if n < span.y && is_open(sum) {
        ray_states[state] = bitcast<vec4u>(vec4f(sum.color, sum.transmittance));
        ray_states[state + 1u].x = bitcast<u32>(n);
        ray_states[state + 1u].z = layers.passed;
        ray_states[state + 1u].w = 1u;
        count(COUNT_PAUSED, 1u);
    } else {
        while blend_layer(&layers, &sum, BEYOND_LAYERS) {}
        ray_states[state + 1u].x = bitcast<u32>(DONE);
        textureStore(target_image, vec2i(pixel), vec4f(sum.color, 1.0 - sum.transmittance));
        count(COUNT_FINISHED, 1u);
    }
    count(COUNT_SAMPLES, samples);
    count(COUNT_WORK, work);
    count_cube(layers);
}

// Adds a sample that stands for `taken` of them; its opacity is multiplied by presence.
fn add(a: Accumulated, voxel: vec3f, taken: f32, place: vec3f) -> Accumulated {
    var stored = voxel.x;
    if WEIGHTED {
        stored /= max(voxel.y, 1e-6);
    }
    let entry = inside_at(bricks.position_low + bricks.position_scale * stored);
    var color = entry.rgb;
    var opacity = voxel.y * (1.0 - exp(-entry.w * frame.step));
    if LIT && opacity > 0.0 {
        color = shade(color, place, false);
    }
    if GHOSTS {
        let ghost = voxel.z * (1.0 - exp(-frame.ghost.w * frame.step));
        var gray = frame.ghost.rgb;
        if LIT && ghost > 0.0 {
            gray = shade(gray, place, true);
        }
        color = (opacity * color + ghost * gray) / max(opacity + ghost, 1e-20);
        opacity += ghost;
    }
    var passed = 1.0 - opacity;
    if LONG_STEPS {
        passed = pow(passed, taken);
    }
    return Accumulated(a.color + a.transmittance * (1.0 - passed) * color, a.transmittance * passed);
}

// How a ray goes on from sample n at `at` (0..1 in the box), up to sample `end`.
fn stretch_at(at: vec3f, advance: vec3f, n: f32, end: f32) -> Stretch {
    let voxel = at * vec3f(volume.size);
    let motion = advance * vec3f(volume.size);
    let brick = min(vec3u(max(voxel, vec3f(0.0))) / BRICK, bricks.count - vec3u(1u));
    let code = passes[brick.x + bricks.count.x * (brick.y + bricks.count.y * brick.z)];
    let kind = code & 255u;
    let level = code >> 8u;
    let side = BRICK << level;
    let low = vec3f((brick >> vec3u(level)) * side);
    let ahead = select(low, low + f32(side), motion > vec3f(0.0)) - voxel;
    let steps = select(ahead / motion, vec3f(1e6), abs(motion) < vec3f(1e-12));
    let leaves = max(1.0, ceil(min(steps.x, min(steps.y, steps.z))));
    var stretch = Stretch(min(n + leaves, end), 1.0, 0.0);
    if kind == PASS_EMPTY {
        stretch.stride = 0.0;
    } else if kind == PASS_EVEN {
        stretch.stride = leaves;
    } else if kind == PASS_THIN {
        stretch.level = f32(min(level + 1u, bricks.averages));
        stretch.stride = exp2(stretch.level);
    }
    return stretch;
}

// A number in [0, 1) that depends on pixel and sample alone.
fn random(pixel: vec2u, sample: u32) -> f32 {
    return f32(pcg(pixel.x + pcg(pixel.y + pcg(sample))) >> 8u) / 16777216.0;
}
