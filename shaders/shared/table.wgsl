// The transfer function's table, and what it says at a position.
#import layout

// Red, green, blue, as they are blended, and extinction per world-space length at LUT_SIZE positions over the range.
@group(2) @binding(0) var<storage, read> transfer_table: array<vec4f>;

// Integrals of extinction times color, and of extinction, over the position from 0 to each entry.
@group(2) @binding(1) var<storage, read> transfer_integrals: array<vec4f>;

fn transfer_at(position: f32) -> vec4f {
    let at = clamp(position, 0.0, 1.0) * f32(LUT_SIZE - 1u);
    let entry = min(u32(at), LUT_SIZE - 2u);
    return mix(transfer_table[entry], transfer_table[entry + 1u], at - f32(entry));
}
