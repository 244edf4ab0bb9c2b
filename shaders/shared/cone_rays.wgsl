// Transmittance of a cone by many rays through the volume of opacities: slow, for comparison
// (campagnolo-2021, 3.1.1).
#import light
#import random
#import openness

// Optical depth of a unit of length at a point.
fn sharp_depth(p: vec3f) -> f32 {
    let opacity = textureSampleLevel(opacities, smooth_sampler, p / lighting.size, 0.0).x;
    return -log(1.0 - min(opacity, 0.999999));
}

// Mean of the transmittances of rays over a cone, weighted by the cosine of their angle to the axis, or alike where the
// cone is all of the sphere. Their
// directions are uniform in solid angle, one in each of as many rings; samples of a ray begin at a random
// part of a step.
fn rays_transmittance(emitter: Emitter, p: vec3f) -> f32 {
    let way = toward(emitter, p);
    let side = across(way.xyz);
    let is_around = emitter.cosine < 0.0;
    let range = vec2f(lighting.rays_gap, select(min(emitter.length, way.w), emitter.length, is_around));
    let bits = bitcast<vec3u>(p);
    let seed = pcg(bits.x ^ pcg(bits.y ^ pcg(bits.z ^ pcg(lighting.seed))));
    var sum = 0.0;
    var weights = 0.0;
    for (var n = 0u; n < lighting.rays; n++) {
        let chance = unit3(seed + n);
        let ring = (f32(n) + chance.x) / f32(lighting.rays);
        let cosine = mix(1.0, emitter.cosine, ring);
        let sine = sqrt(max(0.0, 1.0 - cosine * cosine));
        // Golden angles spread the rings' directions; one random turn for all of them.
        let turn = 2.3999632 * f32(n) + 6.2831853 * unit3(seed).y;
        let direction = cosine * way.xyz + sine * (cos(turn) * side[0] + sin(turn) * side[1]);
        let weight = select(cosine, 1.0, is_around);
        sum += weight * exp(-ray_depth(p, direction, range, chance.z));
        weights += weight;
    }
    return select(sum / weights, openness(sum / weights), is_around);
}

// Optical depth of a ray within a range of distances, up to where it leaves the box.
fn ray_depth(p: vec3f, direction: vec3f, range: vec2f, offset: f32) -> f32 {
    let safe = select(direction, vec3f(1e-9), abs(direction) < vec3f(1e-9));
    let ends = max(-p / safe, (lighting.size - p) / safe);
    let end = min(range.y, min(ends.x, min(ends.y, ends.z)));
    let begins = min(-p / safe, (lighting.size - p) / safe);
    let begin = max(range.x, max(begins.x, max(begins.y, begins.z)));
    var depth = 0.0;
    var t = begin + offset * lighting.step;
    while t < end && depth < 8.0 {
        depth += lighting.step * sharp_depth(p + t * direction);
        t += lighting.step;
    }
    return depth;
}

fn unit3(seed: u32) -> vec3f {
    let a = pcg(seed);
    let b = pcg(a);
    return vec3f(vec3u(a, b, pcg(b)) >> vec3u(8u)) / 16777216.0;
}
