// Layers of surface points that rays meet, blended between the samples. They lie behind the states of the
// rays, nearest first, for each pixel of the part of the picture that the tile lies in (`Surfaces` in
// view/surfaces.rs says what is seen).
#import cube
#import frame
#import grid
#import transfer

override SURFACES: bool = false;
// The hull is opaque: it ends rays, and all layers are opaque.
override HULL: bool = false;
// Rays may meet tubes of wells, which are opaque.
override TUBES: bool = false;
// How many layers a ray has.
override LAYERS: u32 = 1u;

// Distance where there is no layer, and one that is nearer than that and beyond all layers.
const NO_LAYER: f32 = 1e30;
const BEYOND_LAYERS: f32 = 1e29;

// What colors of layers may reach: they are kept in 24 bits a channel, opacity in the other eight of each.
const BRIGHTEST: f32 = 16.0;
const LAYER_STEPS: f32 = 16777215.0;

// A point of a surface.
struct Layer {
    // Along the ray.
    distance: f32,
    color: vec3f,
    opacity: f32,
}

fn load_layer(place: u32) -> Layer {
    let words = ray_states[place];
    let opacity = words.y >> 24u | (words.z >> 24u) << 8u | (words.w >> 24u) << 16u;
    let color = vec3f(words.yzw & vec3u(0xffffffu)) * (BRIGHTEST / LAYER_STEPS);
    return Layer(bitcast<f32>(words.x), color, f32(opacity) / LAYER_STEPS);
}

fn store_layer(place: u32, layer: Layer) {
    let color = vec3u(round(clamp(layer.color / BRIGHTEST, vec3f(0.0), vec3f(1.0)) * LAYER_STEPS));
    let opacity = u32(round(clamp(layer.opacity, 0.0, 1.0) * LAYER_STEPS));
    let high = (vec3u(opacity) >> vec3u(0u, 8u, 16u)) & vec3u(0xffu);
    ray_states[place] = vec4u(bitcast<u32>(layer.distance), color | high << vec3u(24u));
}

// The layers of a ray, and the samples of a cube, which lie between them and those of the cells.
struct Layers {
    // Position of the first.
    first: u32,
    // How many are blended.
    passed: u32,
    // Distance of the next.
    distance: f32,
    march: March,
}

// Position of a pixel's first layer, by its place in the part.
fn first_layer(in_part: vec2u) -> u32 {
    return tile.layers + LAYERS * (in_part.y * tile.part_width + in_part.x);
}

fn layer_distance(first: u32, number: u32) -> f32 {
    if number >= LAYERS {
        return NO_LAYER;
    }
    return bitcast<f32>(ray_states[first + number].x);
}

// The layers of a pixel's ray, of which some are blended, and of a cube the samples up to a distance.
fn layers_of(pixel: vec2u, passed: u32, distance: f32) -> Layers {
    var layers: Layers;
    layers.distance = NO_LAYER;
    if SURFACES {
        layers.first = first_layer(pixel - tile.part_origin);
        layers.passed = passed;
        layers.distance = layer_distance(layers.first, passed);
    }
    if CUBE {
        layers.march = march_of(pixel, distance);
    }
    return layers;
}

// Blends the next layer if it lies in front of a distance; true where it does. Otherwise samples of a cube up to there.
fn blend_layer(layers: ptr<function, Layers>, sum: ptr<function, Accumulated>, distance: f32) -> bool {
    if blend_surface(layers, sum, distance) {
        return true;
    }
    if CUBE {
        blend_cube_until(layers, sum, distance);
    }
    return false;
}

// Blends the samples of a cube up to a distance.
fn blend_cube_until(layers: ptr<function, Layers>, sum: ptr<function, Accumulated>, distance: f32) {
    var march = (*layers).march;
    blend_cube(&march, sum, distance);
    (*layers).march = march;
}

// Blends the next layer if it lies in front of a distance, with the samples of a cube before it; true where it does.
fn blend_surface(layers: ptr<function, Layers>, sum: ptr<function, Accumulated>, distance: f32) -> bool {
    if !SURFACES || (*layers).distance > distance {
        return false;
    }
    if CUBE {
        blend_cube_until(layers, sum, (*layers).distance);
    }
    let layer = load_layer((*layers).first + (*layers).passed);
    let transmittance = (*sum).transmittance;
    *sum = Accumulated((*sum).color + transmittance * layer.opacity * layer.color,
        transmittance * (1.0 - layer.opacity));
    (*layers).passed += 1u;
    (*layers).distance = layer_distance((*layers).first, (*layers).passed);
    return true;
}

// Counts the samples of a cube that a ray has taken since it began or went on.
fn count_cube(layers: Layers) {
    if CUBE {
        count(COUNT_CUBE, layers.march.samples);
        count(COUNT_WORK, layers.march.samples);
    }
}

// A ray up to the first opaque layer, which ends it. Nothing of it is left where that is the hull and nothing can be in
// front: only ghosts are outside.
fn before_opaque(ray: Ray, layers: Layers) -> Ray {
    var cut = ray;
    let distance = opaque_distance(layers);
    if distance < NO_LAYER {
        let has_more = !HULL || ray.starts_inside || GHOSTS;
        let samples = ceil(distance / frame.step - 0.5) - ray.first;
        cut.count = select(0.0, clamp(samples, 0.0, ray.count), has_more);
        cut.leave = select(ray.enter, min(ray.leave, distance), has_more);
    }
    return cut;
}

// Distance of the first opaque layer: of an opaque hull or of a tube.
fn opaque_distance(layers: Layers) -> f32 {
    if !SURFACES || !(HULL || TUBES) {
        return NO_LAYER;
    }
    if HULL {
        return layers.distance;
    }
    for (var n = layers.passed; n < LAYERS; n++) {
        let layer = load_layer(layers.first + n);
        if layer.distance >= NO_LAYER || layer.opacity >= 1.0 {
            return layer.distance;
        }
    }
    return NO_LAYER;
}
