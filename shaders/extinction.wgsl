// Representative extinction: opacities of the values, their means in larger voxels, and Gaussians of these
// along one axis; three of them make a level of the pyramid (campagnolo-2021, 3.2.1 and 3.5.3).
//
// One thread = two voxels along x, which share a word; dispatch covers a slab. Reads packed values, or
// opacities of a unit of length. Writes opacities, or in the last of three passes optical depths, which is
// what the pyramid holds. Unit of length is the finest level's standard deviation in world space. Nothing is
// outside the box.
#import mean
#import opacity

// What is done.
override WORK: u32 = 1u;
// Depths are written.
override WRITES_DEPTHS: bool = false;

// Opacities are kept below one, as in the transfer function.
const MOST_OPACITY: f32 = 0.999999;
// Standard deviations after which a Gaussian ends; voxels that lie there in part count.
const REACH: f32 = 3.0;

@group(3) @binding(1) var<uniform> slab: Slab;
@group(3) @binding(2) var source: texture_3d<f32>;
@group(3) @binding(3) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(16, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if 2u * id.x >= slab.size.x || any(id.yz >= slab.size.yz) {
        return;
    }
    let first = slab.first + vec3u(2u * id.x, id.yz);
    let word = (slab.row * (id.y + slab.size.y * id.z)) / 2u + id.x;
    voxels[word] = pack2x16float(vec2f(blurred(first), blurred(first + vec3u(1u, 0u, 0u))));
}

fn blurred(voxel: vec3u) -> f32 {
    if WORK == WORK_VALUES {
        // Outside of the texture, where there are none, this is 0.
        return with_others(vec3i(voxel), textureLoad(source, voxel, 0).x);
    }
    let ratio = f32(blur.source_count) / f32(blur.made_count);
    let center = (f32(voxel[blur.axis]) + 0.5) * ratio - 0.5;
    var reach = REACH * blur.deviation + 0.5;
    if WORK == WORK_MEAN {
        reach = 0.5 * ratio + 0.5;
    }
    let count = i32(blur.source_count);
    var sum = 0.0;
    var weights = 0.0;
    for (var n = i32(ceil(center - reach)); n <= i32(floor(center + reach)); n++) {
        let off = f32(n) - center;
        let relative = off / max(blur.deviation, 1e-3);
        // A Gaussian, or the part of a voxel that lies within the larger one.
        let part = overlap(n, i32(voxel[blur.axis]), count, i32(blur.made_count));
        let weight = select(exp(-0.5 * relative * relative), part, WORK == WORK_MEAN);
        weights += weight;
        if n >= 0 && n < count {
            var at = vec3i(voxel);
            at[blur.axis] = n;
            sum += weight * textureLoad(source, at, 0).x;
        }
    }
    let opacity = sum / max(weights, 1e-30);
    if WRITES_DEPTHS {
        return -log(1.0 - min(opacity, MOST_OPACITY));
    }
    return opacity;
}
