// Occlusion from all sides: by cones in even directions, or by mean opacities of shells around a point (SPAO,
// kroes-2014). src/render/plan/around.rs says how.
#import cones
#import inside
#import openness

// Each shell counts as one voxel.
override PER_SHELL: bool = false;

const GOLDEN_ANGLE: f32 = 2.3999632;
const FAR: f32 = 1e30;

// Openness of a point by cones to all sides, which have the sections of an emitter.
fn surround_openness(emitter: Emitter, p: vec3f) -> f32 {
    var cone = emitter;
    cone.kind = EMITTER_DIRECTIONAL;
    var sum = 0.0;
    for (var n = 0u; n < lighting.around; n++) {
        let z = 1.0 - (2.0 * f32(n) + 1.0) / f32(lighting.around);
        let turn = GOLDEN_ANGLE * f32(n);
        cone.at = vec3f(sqrt(1.0 - z * z) * vec2f(cos(turn), sin(turn)), z);
        cone.axis = FAR * cone.at;
        sum += cone_transmittance(cone, p);
    }
    return openness(sum / f32(lighting.around));
}

// Openness of a point: light passes the shells around it one after the other.
fn shells_openness(p: vec3f) -> f32 {
    var before = cube_opacity(p, 0u);
    var depth = 0.0;
    for (var level = 1u; level <= lighting.around; level++) {
        let now = cube_opacity(p, level);
        let shell = clamp((8.0 * now - before) / 7.0, 0.0, 0.999999);
        let thickness = select(exp2(f32(level) - 2.0), 1.0, PER_SHELL);
        depth -= thickness * log(1.0 - shell);
        before = now;
    }
    return openness(exp(-lighting.around_attenuation * depth));
}

// Mean opacity of a cube of 2^level voxels around a point; there is nothing outside of the box.
fn cube_opacity(p: vec3f, level: u32) -> f32 {
    let mean = textureSampleLevel(opacities, smooth_sampler, p / lighting.size, f32(level)).x;
    return part_inside(p, 0.5 * exp2(f32(level))) * mean;
}
