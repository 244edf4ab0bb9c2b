// Layers of surface points that rays meet, blended between the samples. They lie behind the states of the
// rays, nearest first: the bits of distance and of red, green and blue, for each pixel of the part of
// the picture that the tile lies in (`Surfaces` in scene/surfaces.rs says what is seen).
#import frame
#import grid
#import transfer

override SURFACES: bool = false;
// One opaque layer, the hull; else sheets.
override HULL: bool = false;

// Distance where there is no layer, and one that is nearer than that and beyond all layers.
const NO_LAYER: f32 = 1e30;
const BEYOND_LAYERS: f32 = 1e29;

// The layers of a ray.
struct Layers {
    // Position of the first.
    first: u32,
    // How many are blended.
    passed: u32,
    // Distance of the next.
    distance: f32,
}

fn layers_a_ray() -> u32 {
    return select(SHEET_LAYERS, 1u, HULL);
}

// Position of a pixel's first layer, by its place in the part.
fn first_layer(in_part: vec2u) -> u32 {
    return tile.layers + layers_a_ray() * (in_part.y * tile.part_width + in_part.x);
}

fn layer_distance(first: u32, number: u32) -> f32 {
    if number >= layers_a_ray() {
        return NO_LAYER;
    }
    return bitcast<f32>(ray_states[first + number].x);
}

// The layers of a pixel's ray, of which some are blended.
fn layers_of(pixel: vec2u, passed: u32) -> Layers {
    if !SURFACES {
        return Layers(0u, 0u, NO_LAYER);
    }
    let first = first_layer(pixel - tile.part_origin);
    return Layers(first, passed, layer_distance(first, passed));
}

// Blends the next layer if it lies in front of a distance; true where it does.
fn blend_layer(layers: ptr<function, Layers>, sum: ptr<function, Accumulated>, distance: f32) -> bool {
    if !SURFACES || (*layers).distance > distance {
        return false;
    }
    let color = bitcast<vec3f>(ray_states[(*layers).first + (*layers).passed].yzw);
    let opacity = select(SHEET_OPACITY, 1.0, HULL);
    let transmittance = (*sum).transmittance;
    *sum = Accumulated((*sum).color + transmittance * opacity * color, transmittance * (1.0 - opacity));
    (*layers).passed += 1u;
    (*layers).distance = layer_distance((*layers).first, (*layers).passed);
    return true;
}

// A ray up to the hull, which ends it; nothing of it where nothing can be in front: only ghosts are outside.
fn before_hull(ray: Ray, layers: Layers) -> Ray {
    var cut = ray;
    if SURFACES && HULL && layers.distance < NO_LAYER {
        let has_more = ray.starts_inside || GHOSTS;
        let samples = ceil(layers.distance / frame.step - 0.5) - ray.first;
        cut.count = select(0.0, clamp(samples, 0.0, ray.count), has_more);
        cut.leave = select(ray.enter, min(ray.leave, layers.distance), has_more);
    }
    return cut;
}
