// A cube beside the model: its samples on a ray, blended between what else the ray meets (`ShownCube` in view/cube.rs
// says what is seen). The twin of src/render/cpu/cube.rs.
#import frame
#import light
#import transfer

// There is one.
override CUBE: bool = false;

// Value times presence, and presence.
@group(2) @binding(13) var cube_voxels: texture_3d<f32>;
// In rows of LUT_ROW texels: red, green, blue, as they are blended, and extinction at LUT_SIZE positions; then three
// rows from grid space relative to the origin to the cube's box, its low corner with the distance of samples, its
// high corner, and offset and factor from stored values to positions.
@group(2) @binding(14) var cube_table: texture_2d<f32>;

// The samples that a ray has not passed yet.
struct March {
    // Numbers of the next one and of the last.
    next: f32,
    last: f32,
    // World-space distance of samples.
    step: f32,
    // Samples that were taken.
    samples: u32,
    // Place in the box of the ray's origin, and what a unit of distance adds.
    origin: vec3f,
    along: vec3f,
}

fn cube_texel(at: u32) -> vec4f {
    return textureLoad(cube_table, in_rows(at), 0);
}

// The samples of a pixel's ray that lie behind a distance.
fn march_of(pixel: vec2u, behind: f32) -> March {
    let ray = pixel_ray(pixel);
    let rows = mat3x4f(cube_texel(LUT_SIZE), cube_texel(LUT_SIZE + 1u), cube_texel(LUT_SIZE + 2u));
    let low = cube_texel(LUT_SIZE + 3u);
    let high = cube_texel(LUT_SIZE + 4u).xyz;
    var march: March;
    march.step = low.w;
    march.origin = vec4f(ray.origin, 1.0) * rows;
    march.along = vec4f(ray.direction, 0.0) * rows;
    let safe = select(march.along, vec3f(1e-12), abs(march.along) < vec3f(1e-12));
    let a = (low.xyz - march.origin) / safe;
    let b = (high - march.origin) / safe;
    let near = min(a, b);
    let far = max(a, b);
    let kept = clipped(ray.origin, ray.direction);
    let enter = max(max(near.x, near.y), max(near.z, kept.enter));
    let leave = min(min(far.x, far.y), min(far.z, kept.leave));
    march.next = max(max(1.0, ceil(enter / march.step)), floor(behind / march.step) + 1.0);
    march.last = floor(leave / march.step);
    return march;
}

// Blends the samples up to a distance.
fn blend_cube(march: ptr<function, March>, sum: ptr<function, Accumulated>, distance: f32) {
    let step = (*march).step;
    let stored = cube_texel(LUT_SIZE + 5u);
    while (*march).next <= (*march).last && (*march).next * step <= distance && is_open(*sum) {
        let at = (*march).origin + (*march).next * step * (*march).along;
        (*march).next += 1.0;
        (*march).samples += 1u;
        let voxel = textureSampleLevel(cube_voxels, smooth_sampler, at, 0.0).xy;
        let entry = cube_entry(stored.x + stored.y * voxel.x / max(voxel.y, 1e-6));
        let opacity = voxel.y * (1.0 - exp(-entry.w * step));
        let transmittance = (*sum).transmittance;
        *sum = Accumulated((*sum).color + transmittance * opacity * entry.rgb, transmittance * (1.0 - opacity));
    }
}

// Color and extinction at a position.
fn cube_entry(position: f32) -> vec4f {
    let at = clamp(position, 0.0, 1.0) * f32(LUT_SIZE - 1u);
    let entry = min(u32(at), LUT_SIZE - 2u);
    return mix(cube_texel(entry), cube_texel(entry + 1u), at - f32(entry));
}
