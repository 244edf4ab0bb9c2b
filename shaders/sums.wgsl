// The summed-area table of extinction (schlegel-2011; src/render/plan/sat.rs says how).
//
// One thread = a voxel; dispatch covers a slab. The first pass counts optical depths of values; each of the others adds
// up SUM_PARTS sums along an axis that are `source_count` voxels apart, so that few passes add up a whole row
// (recursive doubling). Sums wrap around.
#import opacity

// Optical depths are counted.
override FIRST: bool = false;

@group(3) @binding(1) var<uniform> slab: Slab;
@group(3) @binding(2) var source: texture_3d<u32>;
@group(3) @binding(3) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(16, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= slab.size) {
        return;
    }
    let voxel = slab.first + id;
    var sum = 0u;
    if FIRST {
        // Outside of the texture, where there are none, this is 0.
        let others = f32(textureLoad(source, voxel, 0).x) / 255.0;
        let opacity = with_others(vec3i(voxel), others);
        let depth = -log(1.0 - min(opacity, 0.999999));
        sum = u32(min(depth, DEEPEST) * blur.counts + 0.5);
    } else {
        var at = voxel;
        for (var n = 0u; n < SUM_PARTS; n++) {
            sum += textureLoad(source, at, 0).x;
            if at[blur.axis] < blur.source_count {
                break;
            }
            at[blur.axis] -= blur.source_count;
        }
    }
    voxels[slab.row * (id.y + slab.size.y * id.z) + id.x] = sum;
}
