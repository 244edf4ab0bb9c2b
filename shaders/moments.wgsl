// The pyramid of values: mean and standard deviation of what cells hold, and how much of a voxel they cover
// (shih-2016; src/render/plan/vct.rs says how).
//
// One thread = a voxel; dispatch covers a slab. The finest level reads packed values, others the level below.
#import mean
#import opacity

// The finest level is made.
override FINEST: bool = false;

// Less than that of a voxel is covered by none.
const LEAST_COVERED: f32 = 1e-4;

@group(3) @binding(1) var<uniform> slab: Slab;
@group(3) @binding(2) var source: texture_3d<f32>;
@group(3) @binding(3) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(16, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= slab.size) {
        return;
    }
    let voxel = vec3i(slab.first + id);
    var held = vec4f(0.0);
    if FINEST {
        held = finest(voxel);
    } else {
        held = mean_of(voxel);
    }
    let word = 2u * (slab.row * (id.y + slab.size.y * id.z) + id.x);
    voxels[word] = pack2x16float(held.xy);
    voxels[word + 1u] = pack2x16float(held.zw);
}

fn finest(at: vec3i) -> vec4f {
    let voxel = field_voxel(at);
    let coverage = select(0.0, voxel.coverage, is_unclipped(at));
    return select(vec4f(coverage * voxel.value, 0.0, coverage, 0.0), vec4f(0.0, 0.0, 0.0, coverage), voxel.is_ghost);
}

// What a larger voxel holds of those below that it covers. The variance of all is the mean of theirs and of their
// means' distances.
fn mean_of(voxel: vec3i) -> vec4f {
    let fine = vec3i(textureDimensions(source));
    let coarse = max(fine / 2, vec3i(1));
    let first = voxel * fine / coarse;
    let end = ((voxel + 1) * fine + coarse - 1) / coarse;
    var sum = vec4f(0.0);
    for (var z = first.z; z < end.z; z++) {
        for (var y = first.y; y < end.y; y++) {
            for (var x = first.x; x < end.x; x++) {
                sum += part(vec3i(x, y, z), voxel, fine, coarse) * textureLoad(source, vec3i(x, y, z), 0);
            }
        }
    }
    if sum.z < LEAST_COVERED {
        return vec4f(0.0, 0.0, 0.0, sum.w);
    }
    let mean = sum.x / sum.z;
    var variance = 0.0;
    for (var z = first.z; z < end.z; z++) {
        for (var y = first.y; y < end.y; y++) {
            for (var x = first.x; x < end.x; x++) {
                let held = textureLoad(source, vec3i(x, y, z), 0);
                let covered = max(held.z, LEAST_COVERED);
                let off = held.x / covered - mean;
                let deviation = held.y / covered;
                variance += part(vec3i(x, y, z), voxel, fine, coarse) * held.z * (deviation * deviation + off * off);
            }
        }
    }
    return vec4f(sum.x, sum.z * sqrt(variance / sum.z), sum.z, sum.w);
}

// What part of a larger voxel a finer one is.
fn part(n: vec3i, voxel: vec3i, fine: vec3i, coarse: vec3i) -> f32 {
    let along = vec3f(
        overlap(n.x, voxel.x, fine.x, coarse.x),
        overlap(n.y, voxel.y, fine.y, coarse.y),
        overlap(n.z, voxel.z, fine.z, coarse.z),
    ) / vec3f(fine);
    return along.x * along.y * along.z;
}
