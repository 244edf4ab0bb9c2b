// Value to color and extinction, and sums of them along a ray.
#import frame
#import table

// Cells with a value are solid: nothing of their inside is seen.
override SOLID: bool = false;

fn transfer(value: f32) -> vec4f {
    return inside_at((value - frame.value_low) * frame.value_scale);
}

// Color and extinction of the inside of cells at a position of the transfer function.
fn inside_at(position: f32) -> vec4f {
    let entry = transfer_at(position);
    return vec4f(entry.rgb, select(entry.w, 0.0, SOLID));
}

// Means over the values between two: of extinction times color, and of extinction.
fn transfer_mean(a: f32, b: f32) -> vec4f {
    if SOLID {
        return vec4f(0.0);
    }
    let pa = clamp((a - frame.value_low) * frame.value_scale, 0.0, 1.0);
    let pb = clamp((b - frame.value_low) * frame.value_scale, 0.0, 1.0);
    if abs(pb - pa) * f32(LUT_SIZE - 1u) < 4.0 {
        // Differences of large sums would be rounding errors; the table is all but linear here.
        let entry = transfer(0.5 * (a + b));
        return vec4f(entry.rgb * entry.w, entry.w);
    }
    return (transfer_integral(pb) - transfer_integral(pa)) / (pb - pa);
}

// Integral from position 0; extinction and color are linear between entries.
fn transfer_integral(position: f32) -> vec4f {
    let at = position * f32(LUT_SIZE - 1u);
    let entry = min(u32(at), LUT_SIZE - 2u);
    return mix(integral_entry(entry), integral_entry(entry + 1u), at - f32(entry));
}

// Front-to-back emission and absorption; colors as they are blended, premultiplied.
struct Accumulated {
    color: vec3f,
    transmittance: f32,
}

// Adds a sample of a color and an extinction.
fn accumulate(a: Accumulated, entry: vec4f) -> Accumulated {
    let passed = exp(-entry.w * frame.step);
    return Accumulated(a.color + a.transmittance * (1.0 - passed) * entry.rgb, a.transmittance * passed);
}

// False once nothing behind can be seen.
fn is_open(a: Accumulated) -> bool {
    return a.transmittance > 0.0 && a.transmittance >= frame.early_termination;
}
