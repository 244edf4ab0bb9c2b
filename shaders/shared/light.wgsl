// What light needs: the emitters with the sections of their cones, and the volumes.
#import table

@group(2) @binding(2) var<uniform> lighting: LightingInfo;
@group(2) @binding(3) var<storage, read> emitters: array<Emitter>;
// Distance from the tip, level of the pyramid, amplitude times attenuation, weight.
@group(2) @binding(4) var<storage, read> sections: array<vec4f>;
// Representative extinction times the unit of lighting space, and its pyramid.
@group(2) @binding(5) var extinction: texture_3d<f32>;
// Transmittances of cones, one volume an emitter, one above the other.
@group(2) @binding(6) var light_volumes: texture_3d<f32>;
// What the pyramid was made from: packed voxels.
@group(2) @binding(7) var field_volume: texture_3d<u32>;
// Change of the transfer function's position a unit, times presence; and presence.
@group(2) @binding(8) var gradients: texture_3d<f32>;
@group(2) @binding(9) var smooth_sampler: sampler;
// Opacities of a unit of length that nothing has blurred.
@group(2) @binding(10) var opacities: texture_3d<f32>;

// Coverage of a packed voxel, 0 to 1; its value, as a part of the range; and whether it is an inactive cell.
struct FieldVoxel {
    coverage: f32,
    value: f32,
    is_ghost: bool,
}

fn field_voxel(at: vec3i) -> FieldVoxel {
    let packed = textureLoad(field_volume, at, 0).x;
    let value = packed & PACKED_GHOST;
    return FieldVoxel(f32(packed >> PACKED_SHIFT) / f32(PACKED_COVERAGE), f32(value) / f32(PACKED_VALUES),
        value == PACKED_GHOST);
}

// A point of grid space relative to the origin, in lighting space.
fn in_light(point: vec3f) -> vec3f {
    return (point - lighting.box_low) * lighting.scale;
}

// Unit vector toward an emitter, and the distance to it.
fn toward(emitter: Emitter, p: vec3f) -> vec4f {
    if emitter.kind == EMITTER_DIRECTIONAL {
        return vec4f(emitter.at, dot(emitter.at, emitter.axis - p));
    }
    let away = emitter.at - p;
    let distance = max(length(away), 1e-6);
    return vec4f(away / distance, distance);
}

// Two unit vectors across a unit vector (Duff and others 2017).
fn across(axis: vec3f) -> mat2x3f {
    let s = select(-1.0, 1.0, axis.z >= 0.0);
    let a = -1.0 / (s + axis.z);
    let b = axis.x * axis.y * a;
    return mat2x3f(
        vec3f(1.0 + s * axis.x * axis.x * a, s * b, -s * axis.x),
        vec3f(b, s + axis.y * axis.y * a, -axis.y),
    );
}
