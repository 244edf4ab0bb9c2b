// What light makes of a sample's color (`Lighting` in view/lighting.rs says how).
#import cones
#import frame
#import cone_rays
#import sat
#import vct

// Samples are shaded.
override LIT: bool = false;
// Where occlusion and the lights' shadows are found: LIGHT_OFF, LIGHT_IMAGE, LIGHT_VOLUME, LIGHT_RAYS.
override OCCLUSION: u32 = 0u;
override SHADOWS: u32 = 0u;
// By which method, at every sample.
override OCCLUSION_METHOD: u32 = 0u;
override SHADOWS_METHOD: u32 = 0u;
// There are lights.
override LIGHTS: bool = false;
// They make highlights and shade by the gradient.
override BLINN_PHONG: bool = false;
// Only inactive cells are shaded.
override EXACT_COLORS: bool = false;

// Color of a sample at a point of grid space relative to the origin.
fn shade(color: vec3f, point: vec3f, is_ghost: bool) -> vec3f {
    if !LIT || (EXACT_COLORS && !is_ghost) {
        return color;
    }
    let p = in_light(point);
    var light = vec3f(lighting.ambient);
    if OCCLUSION != LIGHT_OFF {
        light *= 1.0 - lighting.strength * (1.0 - transmittance(OCCLUSION, OCCLUSION_METHOD, emitter_at(0u), p));
    }
    var highlight = vec3f(0.0);
    if LIGHTS {
        let surface = surface_at(p, is_ghost);
        for (var n = 1u; n < lighting.emitters; n++) {
            let emitter = emitter_at(n);
            let way = toward(emitter, p).xyz;
            var arriving = emitter.color;
            if emitter.kind == EMITTER_SPOT {
                arriving *= smoothstep(emitter.cos_outer, emitter.cos_inner, dot(-way, emitter.axis));
            }
            if SHADOWS != LIGHT_OFF {
                arriving *= transmittance(SHADOWS, SHADOWS_METHOD, emitter, p);
            }
            if BLINN_PHONG {
                let half_way = normalize(way + toward(emitter_at(0u), p).xyz + vec3f(1e-6));
                light += arriving * (1.0 - surface.w + surface.w * abs(dot(surface.xyz, way)));
                highlight += arriving * SPECULAR * surface.w * pow(abs(dot(surface.xyz, half_way)), SHININESS);
            } else {
                light += arriving;
            }
        }
    }
    return color * light + highlight;
}

// What the lamp beside the viewer leaves of the color of a surface (`Surfaces` in view/surfaces.rs says how), by
// its normal of any length and sense, and the ray's direction: grid space.
fn headlight(normal: vec3f, direction: vec3f) -> f32 {
    if EXACT_COLORS {
        return 1.0;
    }
    // Products of normals and displacements are those of world space.
    let toward_viewer = -dot(normal, direction);
    let sense = select(-1.0, 1.0, toward_viewer >= 0.0);
    let lit = sense * (toward_viewer + dot(normal, frame.headlight)) * frame.headlight_scale;
    return mix(HEADLIGHT_AMBIENT, 1.0, clamp(lit / max(length(normal * to_grid()), 1e-30), 0.0, 1.0));
}

// Cosine between a surface's normal of any length and sense and a ray: both of grid space.
fn turned_to_ray(normal: vec3f, direction: vec3f) -> f32 {
    return min(abs(dot(normal, direction)) / max(length(normal * to_grid()), 1e-30), 1.0);
}

// Unit gradient of the field, and how much it counts.
fn surface_at(p: vec3f, is_ghost: bool) -> vec4f {
    if !BLINN_PHONG {
        return vec4f(0.0);
    }
    let sampled = textureSampleLevel(gradients, smooth_sampler, p / lighting.size, 0.0);
    let gradient = sampled.xyz / max(sampled.w, 1e-3);
    let size = length(gradient);
    let counts = smoothstep(GRADIENT_FADE_LOW, GRADIENT_FADE_HIGH, size * lighting.gradient_scale);
    return vec4f(gradient / max(size, 1e-9), select(counts, 0.0, is_ghost));
}

fn transmittance(mode: u32, method: u32, emitter: Emitter, p: vec3f) -> f32 {
    if mode == LIGHT_IMAGE {
        if method == METHOD_VCT {
            return vct_transmittance(emitter, p);
        }
        if method == METHOD_SAT {
            return sat_transmittance(emitter, p);
        }
        return cone_transmittance(emitter, p);
    }
    if mode == LIGHT_RAYS {
        return rays_transmittance(emitter, p);
    }
    // The volumes lie one above the other: a sample must not reach into the next.
    let slices = f32(lighting.light_size.z);
    let at = p / lighting.size;
    let slice = clamp(at.z * slices, 0.5, slices - 0.5) + f32(emitter.volume) * slices;
    let above = slice / (f32(lighting.volumes) * slices);
    return textureSampleLevel(light_volumes, smooth_sampler, vec3f(at.xy, above), 0.0).x;
}
