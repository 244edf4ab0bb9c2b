// Pyramids over a resampled volume (volumetric-ray-tracing survey, 8.3 to 8.7).
//
// `average`: the average pyramid, the volume's own coarser levels, each voxel the mean of what it covers of the
// level below; one thread = one voxel.
// `summarize`: range of values and least presence of each brick; one thread = one brick.
// `weigh`: the largest extinction that the transfer function gives to a brick's range.
// `reduce`: the next level of the pyramid of bricks; one thread = one part of it.
// `classify`: of each brick, how rays pass it: the largest part of the pyramid around it that is empty,
// even or thin.
// Departures from the survey: a part covers what is interpolated inside it, half a voxel beyond its sides;
// rays do not climb the pyramid, each brick knows the part they may pass at once; and what is even is so by
// its values, not by its colors, so that a peak of opacity within the range is stepped over.
#import layout
#import mean

// Values are divided by presence when they are sampled, else absent voxels count as zero.
override WEIGHTED: bool = true;

// Voxels have two words.
override WIDE: bool = false;

struct Part {
    // Stored values of its voxels that are present; high < low where there are none.
    low: f32,
    high: f32,
    presence: f32,
    extinction: f32,
}

@group(3) @binding(0) var<uniform> bricks: BricksInfo;
@group(3) @binding(1) var<uniform> slab: Slab;
// The level of the volume that is read.
@group(3) @binding(2) var volume: texture_3d<f32>;
// As in resample.wgsl.
@group(3) @binding(3) var<storage, read_write> voxels: array<u32>;
// All levels of the pyramid, bricks first, each x fastest.
@group(3) @binding(4) var<storage, read_write> parts: array<Part>;
// Of each brick, a PASS constant and the level of the part, times 256.
@group(3) @binding(5) var<storage, read_write> passes: array<u32>;
// Largest extinctions of 2^l entries of the transfer table from each on, level after level.
@group(3) @binding(6) var<storage, read> maxima: array<f32>;

@compute @workgroup_size(8, 8)
fn average(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= slab.size) {
        return;
    }
    let fine = vec3i(textureDimensions(volume));
    let coarse = max(fine / 2, vec3i(1));
    let voxel = vec3i(slab.first + id);
    // An odd number of voxels has no pairs: up to four along an axis lie within a larger one, in whole or in part.
    let first = voxel * fine / coarse;
    let end = ((voxel + 1) * fine + coarse - 1) / coarse;
    var sum = vec4f(0.0);
    for (var z = first.z; z < end.z; z++) {
        for (var y = first.y; y < end.y; y++) {
            let weight = overlap(z, voxel.z, fine.z, coarse.z) * overlap(y, voxel.y, fine.y, coarse.y);
            for (var x = first.x; x < end.x; x++) {
                sum += weight * overlap(x, voxel.x, fine.x, coarse.x) * textureLoad(volume, vec3i(x, y, z), 0);
            }
        }
    }
    let mean = sum / (f32(fine.x) * f32(fine.y) * f32(fine.z));
    let at = (id.z * slab.size.y + id.y) * slab.row + id.x;
    if WIDE {
        voxels[2u * at] = pack2x16float(mean.xy);
        voxels[2u * at + 1u] = pack2x16float(mean.zw);
    } else {
        voxels[at] = pack2x16float(mean.xy);
    }
}

@compute @workgroup_size(8, 8)
fn summarize(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= slab.size) {
        return;
    }
    let brick = slab.first + id;
    let last = vec3i(textureDimensions(volume)) - vec3i(1);
    // With the voxels around it, from which values near its sides are interpolated.
    let from_voxel = max(vec3i(brick * BRICK) - vec3i(1), vec3i(0));
    let to_voxel = min(vec3i((brick + vec3u(1u)) * BRICK), last);
    var part = Part(1.0, 0.0, 1.0, 0.0);
    for (var z = from_voxel.z; z <= to_voxel.z; z++) {
        for (var y = from_voxel.y; y <= to_voxel.y; y++) {
            for (var x = from_voxel.x; x <= to_voxel.x; x++) {
                let voxel = textureLoad(volume, vec3i(x, y, z), 0).xy;
                part.presence = min(part.presence, voxel.y);
                part.low = select(part.low, min(part.low, voxel.x), voxel.y > 0.0);
                part.high = max(part.high, voxel.x);
            }
        }
    }
    parts[index_in(brick, bricks.count)] = part;
}

@compute @workgroup_size(8, 8)
fn weigh(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= bricks.count) {
        return;
    }
    let at = index_in(id, bricks.count);
    let part = parts[at];
    var extinction = 0.0;
    if part.low <= part.high {
        let low = select(part.low, 0.0, !WEIGHTED && part.presence < 1.0);
        extinction = largest_extinction(position_of(low), position_of(part.high));
    }
    parts[at].extinction = extinction;
}

@compute @workgroup_size(8, 8)
fn reduce(@builtin(global_invocation_id) id: vec3u) {
    // From slab.level to the next one.
    var size = bricks.count;
    var start = 0u;
    for (var level = 0u; level < slab.level; level++) {
        start += size.x * size.y * size.z;
        size = coarser(size);
    }
    let reduced = coarser(size);
    if any(id >= reduced) {
        return;
    }
    var sum = parts[start + index_in(2u * id, size)];
    for (var n = 1u; n < 8u; n++) {
        let child = 2u * id + (vec3u(n, n >> 1u, n >> 2u) & vec3u(1u));
        if all(child < size) {
            let part = parts[start + index_in(child, size)];
            sum = Part(min(sum.low, part.low), max(sum.high, part.high), min(sum.presence, part.presence),
                max(sum.extinction, part.extinction));
        }
    }
    parts[start + size.x * size.y * size.z + index_in(id, reduced)] = sum;
}

@compute @workgroup_size(8, 8)
fn classify(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= bricks.count) {
        return;
    }
    // The highest level at which the part around the brick is empty, even or thin, and 1; 0 for none.
    var empty = 0u;
    var even = 0u;
    var thin = 0u;
    var at = id;
    var size = bricks.count;
    var start = 0u;
    for (var level = 1u; level <= bricks.levels; level++) {
        let part = parts[start + index_in(at, size)];
        let range = position_of(part.high) - position_of(part.low);
        empty = select(empty, level, part.extinction <= bricks.empty);
        even = select(even, level, part.presence == 1.0 && range <= bricks.even);
        thin = select(thin, level, part.extinction * exp2(f32(min(level, bricks.averages))) <= bricks.thin);
        start += size.x * size.y * size.z;
        at /= 2u;
        size = coarser(size);
    }
    var code = PASS_PLAIN;
    if empty > 0u {
        code = PASS_EMPTY + 256u * (empty - 1u);
    } else if even > 0u {
        code = PASS_EVEN + 256u * (even - 1u);
    } else if thin > 0u {
        code = PASS_THIN + 256u * (thin - 1u);
    }
    passes[index_in(id, bricks.count)] = code;
}

fn index_in(at: vec3u, size: vec3u) -> u32 {
    return at.x + size.x * (at.y + size.y * at.z);
}

fn coarser(size: vec3u) -> vec3u {
    return (size + vec3u(1u)) / 2u;
}

// Transfer-function position of a stored value.
fn position_of(stored: f32) -> f32 {
    return clamp(bricks.position_low + bricks.position_scale * stored, 0.0, 1.0);
}

// Largest extinction between two positions: of two overlapping spans of 2^l table entries.
fn largest_extinction(low: f32, high: f32) -> f32 {
    let first = u32(floor(low * f32(LUT_SIZE - 1u)));
    let last = u32(ceil(high * f32(LUT_SIZE - 1u)));
    let level = firstLeadingBit(last - first + 1u);
    let row = level * LUT_SIZE;
    return max(maxima[row + first], maxima[row + last + 1u - (1u << level)]);
}
