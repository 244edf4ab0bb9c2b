// Parts of a ray in one cell, each integrated as a whole: in pieces so small that the order of colors within one does
// not matter; in each the means of extinction and color over its values are differences of integrals.
#import transfer

// Optical depth and part of the value range that one piece of a segment may have.
const PIECE_DEPTH: f32 = 0.5;
const PIECE_RANGE: f32 = 0.05;
const MOST_PIECES: f32 = 16.0;

// How many pieces a segment has, from its values at both ends and in the middle.
fn piece_count(values: vec3f, length: f32) -> f32 {
    let depth = length * max(max(transfer(values.x).w, transfer(values.y).w), transfer(values.z).w);
    let high = max(max(values.x, values.y), values.z);
    let low = min(min(values.x, values.y), values.z);
    return clamp(ceil(max(depth / PIECE_DEPTH, (high - low) * frame.value_scale / PIECE_RANGE)), 1.0, MOST_PIECES);
}

// Color and extinction of a piece, from its values at both ends.
fn piece_entry(before: f32, value: f32) -> vec4f {
    let mean = transfer_mean(before, value);
    return vec4f(mean.rgb / max(mean.w, 1e-30), mean.w);
}

// Adds a stretch of one color and an optical depth.
fn absorb(a: Accumulated, color: vec4f, optical_depth: f32) -> Accumulated {
    let passed = exp(-optical_depth);
    return Accumulated(a.color + a.transmittance * (1.0 - passed) * color.rgb, a.transmittance * passed);
}
