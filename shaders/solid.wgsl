// Solid cells: nothing is seen but sections and surfaces, so no ray is cast.
//
// One thread = one pixel; dispatch covers the tile. Reads the layers of surfaces, and the grid where a section
// is opaque; writes the target.
#import section
#import surfaces

// A clip plane has an opaque section.
override SECTIONS: bool = false;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= tile.size) {
        return;
    }
    let pixel = tile.origin + id.xy;
    var section = vec4f(0.0);
    if SECTIONS {
        section = section_color(ray_of(pixel));
    }
    var sum = Accumulated(section.rgb, 1.0 - section.a);
    var layers = layers_of(pixel, 0u, 0.0);
    while blend_layer(&layers, &sum, BEYOND_LAYERS) {}
    count_cube(layers);
    textureStore(target_image, vec2i(pixel), vec4f(sum.color, 1.0 - sum.transmittance));
    count(COUNT_FINISHED, 1u);
    count(COUNT_WORK, 1u);
}
