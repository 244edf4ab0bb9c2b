// What light needs: the emitters with the sections of their cones, and the volumes.
#import table

@group(2) @binding(2) var<uniform> lighting: LightingInfo;
// In rows of LUT_ROW texels: EMITTER_TEXELS an emitter, then a texel each section of their cones.
@group(2) @binding(3) var emitters_and_sections: texture_2d<u32>;
// Representative extinction times the unit of lighting space, and its pyramid.
@group(2) @binding(4) var extinction: texture_3d<f32>;
// Transmittances of cones, one volume an emitter, one above the other.
@group(2) @binding(5) var light_volumes: texture_3d<f32>;
// What the pyramid was made from: packed voxels.
@group(2) @binding(6) var field_volume: texture_3d<u32>;
// Change of the transfer function's position a unit, times presence; and presence.
@group(2) @binding(7) var gradients: texture_3d<f32>;
@group(2) @binding(8) var smooth_sampler: sampler;
// Opacities of a unit of length that nothing has blurred.
@group(2) @binding(9) var opacities: texture_3d<f32>;
// Mean of the values times the part of a voxel that cells cover, their deviation times that; the part; and that of
// inactive cells.
@group(2) @binding(10) var value_pyramid: texture_3d<f32>;
// Opacities by mean and deviation, in rows of LUT_ROW texels, each with the four between which it lies; behind them that
// of inactive cells.
@group(2) @binding(11) var value_opacities: texture_2d<f32>;
// Sums of counted optical depths over all voxels with smaller or equal indices, which wrap around.
@group(2) @binding(12) var sums: texture_3d<u32>;

fn light_texel(at: u32) -> vec4u {
    return textureLoad(emitters_and_sections, in_rows(at), 0);
}

fn emitter_at(number: u32) -> Emitter {
    let first = EMITTER_TEXELS * number;
    let t0 = light_texel(first);
    let t1 = bitcast<vec4f>(light_texel(first + 1u));
    let t2 = bitcast<vec4f>(light_texel(first + 2u));
    let t3 = light_texel(first + 3u);
    let t4 = light_texel(first + 4u);
    let cone = bitcast<vec3f>(t4.xyz);
    return Emitter(bitcast<vec3f>(t0.xyz), t0.w, t1.xyz, t1.w, t2.xyz, t2.w, t3.x, t3.y, t3.z, t3.w,
        cone.x, cone.y, cone.z, t4.w);
}

// Distance from the tip, level of the pyramid, amplitude times attenuation, weight.
fn section_at(number: u32) -> vec4f {
    return bitcast<vec4f>(light_texel(EMITTER_TEXELS * lighting.emitters + number));
}

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
