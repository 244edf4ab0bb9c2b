// Transmittance of a cone from sections of the extinction pyramid (campagnolo-2021, 3.2 and appendix A).
#import light

// Centers of three circles packed in a circle, as a part of its radius; and of the outer six of seven.
const THREE_AT: f32 = 0.5358984;
const SEVEN_AT: f32 = 0.6666667;
// Optical depth behind which nothing more is seen to change.
const DARK: f32 = 8.0;

// Optical depth of a unit of length at a point, from a level of the pyramid. Outside the box the value at
// the border fades as a Gaussian does.
fn pyramid_depth(p: vec3f, level: f32) -> f32 {
    let outside = max(max(-p, p - lighting.size), vec3f(0.0));
    let fade = exp(-0.5 * dot(outside, outside) * exp2(-2.0 * level));
    let at = min(level, f32(lighting.levels - 1u));
    return fade * textureSampleLevel(extinction, smooth_sampler, p / lighting.size, at).x;
}

// Transmittance from a point toward an emitter.
//
// One cone goes on as three and these as seven, where the table says so. Three inherit the one's optical
// depth; of seven the middle one takes the mean of three, the outer ones that of the nearest.
fn cone_transmittance(emitter: Emitter, p: vec3f) -> f32 {
    let way = toward(emitter, p);
    let axis = way.xyz;
    let reach = way.w;
    var n = emitter.first;
    var end = n + emitter.ones;
    var depth = 0.0;
    var before = 0.0;
    while n < end {
        let s = section_at(n);
        if s.x > reach || depth > DARK {
            break;
        }
        let now = s.z * pyramid_depth(p + s.x * axis, s.y);
        depth += s.w * (before + now);
        before = now;
        n += 1u;
    }
    if emitter.threes + emitter.sevens == 0u {
        return exp(-depth);
    }
    let side = across(axis);
    let part = THREE_AT * emitter.tangent;
    let down = -0.5 * part * side[1];
    let right = 0.8660254 * part * side[0];
    let d0 = normalize(axis + part * side[1]);
    let d1 = normalize(axis + down - right);
    let d2 = normalize(axis + down + right);
    var depths = vec3f(depth);
    var befores = vec3f(before);
    n = end;
    end += emitter.threes;
    while n < end {
        let s = section_at(n);
        if s.x > reach || min(depths.x, min(depths.y, depths.z)) > DARK {
            break;
        }
        let now = s.z * vec3f(
            pyramid_depth(p + s.x * d0, s.y),
            pyramid_depth(p + s.x * d1, s.y),
            pyramid_depth(p + s.x * d2, s.y),
        );
        depths += s.w * (befores + now);
        befores = now;
        n += 1u;
    }
    if emitter.sevens == 0u {
        return dot(exp(-depths), vec3f(1.0 / 3.0));
    }
    // The outer six lie 30 degrees to either side of the three.
    let wide = SEVEN_AT * emitter.tangent;
    let far = 0.8660254 * wide * side[1];
    let near = 0.5 * wide * side[0];
    let a0 = normalize(axis + far + near);
    let b0 = normalize(axis + far - near);
    let a1 = normalize(axis - wide * side[0]);
    let b1 = normalize(axis - far - near);
    let a2 = normalize(axis - far + near);
    let b2 = normalize(axis + wide * side[0]);
    var middle = dot(depths, vec3f(1.0 / 3.0));
    var middle_before = dot(befores, vec3f(1.0 / 3.0));
    var depths_b = depths;
    var befores_b = befores;
    n = end;
    end += emitter.sevens;
    while n < end {
        let s = section_at(n);
        let least = min(middle, min(min(depths.x, min(depths.y, depths.z)), min(depths_b.x, min(depths_b.y, depths_b.z))));
        if s.x > reach || least > DARK {
            break;
        }
        let now_middle = s.z * pyramid_depth(p + s.x * axis, s.y);
        let now = s.z * vec3f(
            pyramid_depth(p + s.x * a0, s.y),
            pyramid_depth(p + s.x * a1, s.y),
            pyramid_depth(p + s.x * a2, s.y),
        );
        let now_b = s.z * vec3f(
            pyramid_depth(p + s.x * b0, s.y),
            pyramid_depth(p + s.x * b1, s.y),
            pyramid_depth(p + s.x * b2, s.y),
        );
        middle += s.w * (middle_before + now_middle);
        depths += s.w * (befores + now);
        depths_b += s.w * (befores_b + now_b);
        middle_before = now_middle;
        befores = now;
        befores_b = now_b;
        n += 1u;
    }
    let cosine = inverseSqrt(1.0 + wide * wide);
    let outer = dot(exp(-depths) + exp(-depths_b), vec3f(1.0));
    return (exp(-middle) + cosine * outer) / (1.0 + 6.0 * cosine);
}
