// Lines along the edges of cells, as wide at any distance (`Surfaces` in view/surfaces.rs says how).
#import layout

override CELL_EDGES: bool = false;

// A color with the lines in its pixel. `uvw` are parameters in the cell, `right` and `down` their change from
// a pixel to the next ones; a parameter that is constant must be 1/2.
fn with_edges(color: vec3f, uvw: vec3f, right: vec3f, down: vec3f) -> vec3f {
    let pixels_across = 1.0 / max(sqrt(right * right + down * down), vec3f(1e-9));
    let away = min(uvw, vec3f(1.0) - uvw) * pixels_across;
    let covered = clamp(vec3f(0.5 * EDGE_WIDTH + 0.5) - away, vec3f(0.0), vec3f(1.0));
    let lines = covered * smoothstep(vec3f(EDGE_FADE_LOW), vec3f(EDGE_FADE_HIGH), pixels_across);
    return color * (1.0 - EDGE_DARKNESS * max(lines.x, max(lines.y, lines.z)));
}
