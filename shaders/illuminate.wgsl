// Light volumes: what the rays sample instead of tracing cones (campagnolo-2021, 3.3.3 and 4.2).
//
// Dispatch covers a slab. `main`: one thread = the transmittances of the cones from two voxels along x to
// one emitter, or to all sides; reads the pyramid of extinction or of values, sums of extinction, or mean opacities. `gradient`: one thread = the gradient of the field around a voxel; reads
// the volume of values.
#import around
#import sat
#import vct

@group(3) @binding(0) var<uniform> slab: Slab;
// The emitter, and the slice at which its volume begins.
@group(3) @binding(1) var<uniform> which: vec4u;
@group(3) @binding(2) var<storage, read_write> voxels: array<u32>;

// By which method light is found.
override METHOD: u32 = 0u;

@compute @workgroup_size(16, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if 2u * id.x >= slab.size.x || any(id.yz >= slab.size.yz) {
        return;
    }
    let emitter = emitter_at(which.x);
    let first = slab.first + vec3u(2u * id.x, id.yz) - vec3u(0u, 0u, which.y);
    var pair = vec2f(0.0);
    for (var side = 0u; side < 2u; side++) {
        let p = middle_of(first + vec3u(side, 0u, 0u));
        if METHOD == METHOD_SURROUND {
            pair[side] = surround_openness(emitter, p);
        } else if METHOD == METHOD_SPAO_MIPMAP {
            pair[side] = shells_openness(p);
        } else if METHOD == METHOD_VCT {
            pair[side] = vct_transmittance(emitter, p);
        } else if METHOD == METHOD_SAT {
            pair[side] = sat_transmittance(emitter, p);
        } else {
            pair[side] = cone_transmittance(emitter, p);
        }
    }
    voxels[(slab.row * (id.y + slab.size.y * id.z)) / 2u + id.x] = pack2x16float(pair);
}

fn middle_of(voxel: vec3u) -> vec3f {
    return (vec3f(voxel) + 0.5) / vec3f(lighting.light_size) * lighting.size;
}

// Least squares over the voxels of values around, each axis for itself; those in no cell say nothing.
@compute @workgroup_size(16, 4)
fn gradient(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= slab.size) {
        return;
    }
    let size = vec3i(textureDimensions(field_volume));
    let spacing = lighting.size / vec3f(size);
    let place = middle_of(slab.first + id) / spacing - 0.5;
    let nearest = vec3i(round(place));
    var weights = 0.0;
    var mean = 0.0;
    var off = vec3f(0.0);
    var square = vec3f(0.0);
    var product = vec3f(0.0);
    for (var n = 0; n < 125; n++) {
        let at = nearest + vec3i(n % 5, n / 5 % 5, n / 25) - 2;
        let is_in = all(at >= vec3i(0)) && all(at < size);
        let voxel = field_voxel(clamp(at, vec3i(0), size - 1));
        if is_in && voxel.coverage > 0.0 && !voxel.is_ghost {
            let d = vec3f(at) - place;
            let weight = voxel.coverage * exp(-0.5 * dot(d, d));
            weights += weight;
            mean += weight * voxel.value;
            off += weight * d;
            square += weight * d * d;
            product += weight * voxel.value * d;
        }
    }
    let total = max(weights, 1e-6);
    let spread = square - off * off / total;
    let slope = select(vec3f(0.0), (product - mean * off / total) / spread, spread > vec3f(0.01 * total));
    let change = slope * lighting.position_scale / spacing;
    let presence = select(0.0, 1.0, weights > 1e-3);
    let word = 2u * (slab.row * (id.y + slab.size.y * id.z) + id.x);
    voxels[word] = pack2x16float(presence * change.xy);
    voxels[word + 1u] = pack2x16float(vec2f(presence * change.z, presence));
}
