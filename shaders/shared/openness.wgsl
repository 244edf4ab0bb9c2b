// What a mean transmittance over all directions counts for: a point of an even surface, to which light comes from half
// of them, is as open as can be.
fn openness(mean: f32) -> f32 {
    return min(2.0 * mean, 1.0);
}
