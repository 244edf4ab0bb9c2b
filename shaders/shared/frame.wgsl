// Camera rays, the sample lattice, the tile being made, and the counters.
#import layout

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> tile: Tile;
@group(0) @binding(2) var target_image: texture_storage_2d<rgba32float, write>;
// Pairs of low and high words, see the COUNT constants.
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>, 2u * COUNTERS>;
// What a strategy keeps of each ray of the tile from one dispatch to the next, and behind that the layers of
// surfaces; floats as their bits, for numbers kept as floats may be flushed to zero.
@group(0) @binding(4) var<storage, read_write> ray_states: array<vec4u>;

const DONE: f32 = -1.0;
const NO_CUT: u32 = 31u;

struct Ray {
    // Sample n of the ray lies at `base + n * advance`, grid space relative to the origin, and at
    // distance `(first + n + 1/2) * frame.step` from the origin.
    base: vec3f,
    advance: vec3f,
    first: f32,
    // Number of samples inside the model's box and the kept side of all clip planes.
    count: f32,
    // The eye, or in parallel a point of the plane through it.
    origin: vec3f,
    // Grid-space displacement per world-space length.
    direction: vec3f,
    // Distances from the origin between which the ray is kept; none where `leave <= enter`.
    enter: f32,
    leave: f32,
    // The clip plane through which it enters, or NO_CUT, and whether its section is opaque.
    cut: u32,
    opaque_cut: bool,
    // The ray starts inside the box: its origin is there, or a clip plane opens it.
    starts_inside: bool,
}

// The ray through the middle of a pixel.
struct PixelRay {
    origin: vec3f,
    // Grid-space displacement per world-space length.
    direction: vec3f,
    // World-space length a unit along the camera's axis.
    slant: f32,
}

fn pixel_ray(pixel: vec2u) -> PixelRay {
    let x = 2.0 * (f32(pixel.x) + 0.5) / f32(frame.width) - 1.0;
    let y = 1.0 - 2.0 * (f32(pixel.y) + 0.5) / f32(frame.height);
    let world = frame.forward + x * frame.right + y * frame.up;
    let slant = length(world);
    let origin = frame.eye + x * frame.origin_right + y * frame.origin_up;
    return PixelRay(origin, to_grid() * (world / slant), slant);
}

// From world-space displacements to those of grid space.
fn to_grid() -> mat3x3f {
    return mat3x3f(frame.grid_from_world_x, frame.grid_from_world_y, frame.grid_from_world_z);
}

// How a point of a ray moves from a pixel of the final image to the next one to the right, and to the one below:
// grid space.
fn pixel_steps(direction: vec3f, distance: f32) -> mat2x3f {
    let depth = distance * dot(frame.view_z, direction);
    let right = frame.origin_right + to_grid() * (depth * frame.right);
    let up = frame.origin_up + to_grid() * (depth * frame.up);
    let pixel = 2.0 * frame.rays_across / vec2f(f32(frame.width), f32(frame.height));
    return mat2x3f(pixel.x * right, -pixel.y * up);
}

// True on the kept side of all clip planes.
fn is_kept(point: vec3f) -> bool {
    for (var n = 0u; n < frame.clip_count; n++) {
        let plane = frame.clip_planes[n];
        if dot(plane.xyz, point) + plane.w < 0.0 {
            return false;
        }
    }
    return true;
}

// The stretch of a ray between clip planes.
struct Clipped {
    enter: f32,
    leave: f32,
    // The plane through which it enters, or NO_CUT.
    cut: u32,
}

// What clip planes leave of a ray.
fn clipped(origin: vec3f, direction: vec3f) -> Clipped {
    var clip = Clipped(0.0, 1e30, NO_CUT);
    for (var n = 0u; n < frame.clip_count; n++) {
        let plane = frame.clip_planes[n];
        let height = dot(plane.xyz, origin) + plane.w;
        let rate = dot(plane.xyz, direction);
        if abs(rate) < 1e-12 {
            clip.leave = select(clip.leave, -1.0, height < 0.0);
        } else if rate < 0.0 {
            clip.leave = min(clip.leave, -height / rate);
        } else if -height / rate > clip.enter {
            clip.enter = -height / rate;
            clip.cut = n;
        }
    }
    return clip;
}

// The ray of a pixel, cut to the model's box and the clip planes.
fn ray_of(pixel: vec2u) -> Ray {
    let through = pixel_ray(pixel);
    let origin = through.origin;
    let direction = through.direction;
    let safe = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let a = (frame.box_low - origin) / safe;
    let b = (frame.box_high - origin) / safe;
    let near = min(a, b);
    let far = max(a, b);
    let box_enter = max(near.x, max(near.y, near.z));
    let box_leave = min(min(far.x, far.y), far.z);
    let clip = clipped(origin, direction);
    let clip_enter = clip.enter;
    let clip_leave = clip.leave;
    let cut = clip.cut;
    var ray: Ray;
    ray.origin = origin;
    ray.direction = direction;
    ray.enter = max(box_enter, clip_enter);
    ray.leave = min(box_leave, clip_leave);
    // The box has slack of a sample, clip planes have none: they cut through cells.
    ray.first = max(max(0.0, floor(box_enter / frame.step - 0.5)), ceil(clip_enter / frame.step - 0.5));
    let end = min(ceil(box_leave / frame.step - 0.5), floor(clip_leave / frame.step - 0.5));
    ray.count = select(max(0.0, end - ray.first + 1.0), 0.0, ray.leave <= ray.enter);
    ray.starts_inside = ray.leave > ray.enter && clip_enter >= box_enter;
    ray.cut = cut;
    ray.opaque_cut = ray.starts_inside && cut != NO_CUT && (frame.opaque_cuts >> cut & 1u) == 1u;
    ray.base = origin + (ray.first + 0.5) * frame.step * direction;
    ray.advance = frame.step * direction;
    return ray;
}

fn count(counter: u32, amount: u32) {
    let before = atomicAdd(&counters[2u * counter], amount);
    if before + amount < before {
        atomicAdd(&counters[2u * counter + 1u], 1u);
    }
}
