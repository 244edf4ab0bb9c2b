// Camera rays, the sample lattice, the tile being made, and the counters.
#import layout

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> tile: Tile;
@group(0) @binding(2) var target_image: texture_storage_2d<rgba32float, write>;
// Pairs of low and high words, see the COUNT constants.
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>, 12>;
// Two a pixel of the tile: color and transmittance so far; next sample, or DONE.
@group(0) @binding(4) var<storage, read_write> ray_states: array<vec4f>;

const COUNT_SAMPLES: u32 = 0u;
const COUNT_ITERATIONS: u32 = 1u;
const COUNT_STEPS: u32 = 2u;
const COUNT_FALLBACKS: u32 = 3u;
const COUNT_FINISHED: u32 = 4u;
const COUNT_WORK: u32 = 5u;
const DONE: f32 = -1.0;

struct Ray {
    // Sample n lies at `base + (n - first) * advance`, grid space relative to the origin.
    base: vec3f,
    advance: vec3f,
    first: f32,
    // Number of samples inside the model's box.
    count: f32,
}

// The ray of a pixel, cut to the lattice samples inside the model's box.
fn ray_of(pixel: vec2u) -> Ray {
    let x = 2.0 * (f32(pixel.x) + 0.5) / f32(frame.width) - 1.0;
    let y = 1.0 - 2.0 * (f32(pixel.y) + 0.5) / f32(frame.height);
    let world = normalize(frame.forward + x * frame.right + y * frame.up);
    let direction = world.x * frame.grid_from_world_x + world.y * frame.grid_from_world_y
        + world.z * frame.grid_from_world_z;
    let safe = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let a = (frame.box_low - frame.eye) / safe;
    let b = (frame.box_high - frame.eye) / safe;
    let near = min(a, b);
    let far = max(a, b);
    let enter = max(max(near.x, near.y), max(near.z, 0.0));
    let leave = min(min(far.x, far.y), far.z);
    var ray: Ray;
    ray.first = max(0.0, floor(enter / frame.step - 0.5));
    ray.count = max(0.0, ceil(leave / frame.step - 0.5) - ray.first + 1.0);
    if leave <= enter {
        ray.count = 0.0;
    }
    ray.base = frame.eye + (ray.first + 0.5) * frame.step * direction;
    ray.advance = frame.step * direction;
    return ray;
}

fn count(counter: u32, amount: u32) {
    let before = atomicAdd(&counters[2u * counter], amount);
    if before + amount < before {
        atomicAdd(&counters[2u * counter + 1u], 1u);
    }
}
