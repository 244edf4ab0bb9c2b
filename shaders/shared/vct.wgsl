// Light along a cone through the pyramid of values (shih-2016; src/render/plan/vct.rs says how).
#import inside
#import light

// Optical depth behind which the paper looks no further: a hundredth of the light is left.
const ENOUGH: f32 = 4.6051702;

// Transmittance from a point toward an emitter.
fn vct_transmittance(emitter: Emitter, p: vec3f) -> f32 {
    let way = toward(emitter, p);
    // Where the cone starts, and the factor on optical depths.
    let cone = section_at(emitter.first);
    let end = min(min(emitter.length, way.w), leaves(p, way.xyz, emitter.length * emitter.tangent + 0.5));
    var t = cone.x;
    var depth = 0.0;
    while t < end && cone.z * depth < ENOUGH {
        let step = min(max(t * emitter.tangent, 1.0), end - t);
        let middle = t + 0.5 * step;
        let level = log2(max(2.0 * middle * emitter.tangent, 1.0));
        depth -= step * log(1.0 - min(voxel_opacity(p + middle * way.xyz, level), 0.999999));
        t += step;
    }
    return exp(-cone.z * depth);
}

// Distance at which a ray leaves the box made wider by a margin.
fn leaves(p: vec3f, direction: vec3f, margin: f32) -> f32 {
    let safe = select(direction, vec3f(1e-9), abs(direction) < vec3f(1e-9));
    let ends = max((-margin - p) / safe, (lighting.size + margin - p) / safe);
    return min(ends.x, min(ends.y, ends.z));
}

// Opacity of a unit of length of a voxel around a point.
fn voxel_opacity(p: vec3f, level: f32) -> f32 {
    let at = min(level, f32(textureNumLevels(value_pyramid) - 1u));
    let below = floor(at);
    var held = textureSampleLevel(value_pyramid, smooth_sampler, p / lighting.size, below);
    if at > below {
        let above = textureSampleLevel(value_pyramid, smooth_sampler, p / lighting.size, below + 1.0);
        held = mix(held, above, at - below);
    }
    let covered = max(held.z, 1e-4);
    let ghost = textureLoad(value_opacities, in_rows(VCT_MEANS * VCT_DEVIATIONS), 0).x;
    let opacity = held.z * opacity_of(held.x / covered, held.y / covered) + held.w * ghost;
    return opacity * part_inside(p, 0.5 * exp2(level));
}

// Opacity of values with a mean and a deviation.
fn opacity_of(mean: f32, deviation: f32) -> f32 {
    let last = f32(VCT_DEVIATIONS - 1u);
    let row = clamp(last + 3.0 * log2(max(2.0 * deviation, 1e-6)), 0.0, last);
    let column = clamp(mean, 0.0, 1.0) * f32(VCT_MEANS - 1u);
    let texel = textureLoad(value_opacities, in_rows(u32(row) * VCT_MEANS + u32(column)), 0);
    let both = mix(texel.xz, texel.yw, fract(column));
    return mix(both.x, both.y, fract(row));
}
