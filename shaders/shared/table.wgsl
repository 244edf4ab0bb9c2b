// The transfer function's table, and what it says at a position.
#import layout

// In rows of LUT_ROW entries: red, green, blue, as they are blended, and extinction per world-space length at LUT_SIZE
// positions over the range.
@group(2) @binding(0) var transfer_table: texture_2d<f32>;
// As that, integrals of extinction times color, and of extinction, over the position from 0 to each entry.
@group(2) @binding(1) var transfer_integrals: texture_2d<f32>;

// The texel of an entry.
fn in_rows(entry: u32) -> vec2u {
    return vec2u(entry % LUT_ROW, entry / LUT_ROW);
}

fn table_entry(entry: u32) -> vec4f {
    return textureLoad(transfer_table, in_rows(entry), 0);
}

fn integral_entry(entry: u32) -> vec4f {
    return textureLoad(transfer_integrals, in_rows(entry), 0);
}

fn transfer_at(position: f32) -> vec4f {
    let at = clamp(position, 0.0, 1.0) * f32(LUT_SIZE - 1u);
    let entry = min(u32(at), LUT_SIZE - 2u);
    return mix(table_entry(entry), table_entry(entry + 1u), at - f32(entry));
}
