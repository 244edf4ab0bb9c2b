// Light along a cone by boxes of a summed-area table (schlegel-2011; src/render/plan/sat.rs says how).
#import light

// Optical depth behind which nothing more is seen to change.
const SUMS_DARK: f32 = 8.0;

// A box along an axis: the planes between a voxel that it cuts, whole ones, and another that it cuts; and what part of
// each of the three counts.
struct Along {
    planes: vec4u,
    parts: vec3f,
}

// Sums of a layer of a box: the three along x of each of the three along y.
struct BoxLayer {
    first: vec3u,
    second: vec3u,
    third: vec3u,
}

// Transmittance from a point toward an emitter.
fn sat_transmittance(emitter: Emitter, p: vec3f) -> f32 {
    let way = toward(emitter, p);
    let per_unit = vec3f(textureDimensions(sums)) / lighting.size;
    var depth = 0.0;
    for (var n = 0u; n < emitter.ones; n++) {
        // Distance of the middle, edge, attenuation a count, length.
        let s = section_at(emitter.first + n);
        let start = s.x - 0.5 * s.w;
        if start > way.w || depth > SUMS_DARK {
            break;
        }
        let middle = (p + s.x * way.xyz) * per_unit;
        let half_edges = 0.5 * s.y * per_unit;
        let mean = sum_over(middle - half_edges, middle + half_edges) / (8.0 * half_edges.x * half_edges.y * half_edges.z);
        depth += min(s.w, way.w - start) * s.z * mean;
    }
    return exp(-depth);
}

fn along(low: f32, high: f32, count: u32) -> Along {
    let from_low = clamp(low, 0.0, f32(count));
    let to_high = clamp(high, 0.0, f32(count));
    let first = u32(from_low);
    let end = u32(to_high);
    let second = min(first + 1u, count);
    let third = max(end, second);
    let behind = select(0.0, to_high - f32(end), end > first);
    return Along(vec4u(first, second, third, min(third + 1u, count)),
        vec3f(min(to_high, f32(second)) - from_low, 1.0, behind));
}

// The sum of all voxels before a corner.
fn sum_before(x: u32, y: u32, z: u32) -> u32 {
    if x == 0u || y == 0u || z == 0u {
        return 0u;
    }
    return textureLoad(sums, vec3u(x, y, z) - 1u, 0).x;
}

// Differences along x of the sums before y and z.
fn sums_along_x(x: vec4u, y: u32, z: u32) -> vec3u {
    let at = vec4u(sum_before(x.x, y, z), sum_before(x.y, y, z), sum_before(x.z, y, z), sum_before(x.w, y, z));
    return at.yzw - at.xyz;
}

// The sum over a box whose corners are in voxels; of voxels that it cuts a part counts. Differences that wrap around
// are exact while whole numbers.
fn sum_over(low: vec3f, high: vec3f) -> f32 {
    let count = textureDimensions(sums);
    let x = along(low.x, high.x, count.x);
    let y = along(low.y, high.y, count.y);
    let z = along(low.z, high.z, count.z);
    var sum = 0.0;
    var behind = BoxLayer(vec3u(0u), vec3u(0u), vec3u(0u));
    for (var layer = 0u; layer < 4u; layer++) {
        let at = z.planes[layer];
        let a = sums_along_x(x.planes, y.planes.x, at);
        let b = sums_along_x(x.planes, y.planes.y, at);
        let c = sums_along_x(x.planes, y.planes.z, at);
        let d = sums_along_x(x.planes, y.planes.w, at);
        let here = BoxLayer(b - a, c - b, d - c);
        if layer > 0u {
            let rows = vec3f(
                dot(x.parts, vec3f(here.first - behind.first)),
                dot(x.parts, vec3f(here.second - behind.second)),
                dot(x.parts, vec3f(here.third - behind.third)),
            );
            sum += z.parts[layer - 1u] * dot(y.parts, rows);
        }
        behind = here;
    }
    return sum;
}
