// Colors of a layer of surface points: one thread = one pixel of some rows of a part of the picture. Reads the
// points that were rasterized, the grid, transfer function and light; puts
// distance, color and opacity among the layers of the pixel that are there, and counts the work.
#import edges
#import facing
#import projection
#import shading
#import surfaces

@group(3) @binding(0) var<uniform> paint: PaintInfo;
// Face number + 1, or 0, and the bits of its distance; of tubes a color in 10 bits a channel below a bit that is set.
@group(3) @binding(1) var points: texture_2d<u32>;
// Faces on faults, in rising order, each with the number of its color.
@group(3) @binding(2) var<storage, read> fault_faces: array<vec2u>;

// A point on a face: its parameters along the face's two axes, and their change from a pixel to the next to
// the right and below. And the face's normal in grid space, of any length and sense.
struct Spot {
    at: vec2f,
    right: vec2f,
    down: vec2f,
    normal: vec3f,
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= tile.size.x || id.y >= paint.rows {
        return;
    }
    let in_part = vec2u(id.x, paint.first_row + id.y);
    let first = first_layer(in_part);
    let point = textureLoad(points, vec2i(in_part), 0).xy;
    if point.x == 0u {
        store_layer(first + paint.layer, Layer(NO_LAYER, vec3f(0.0), 0.0));
        return;
    }
    let ray = pixel_ray(tile.origin + in_part);
    let distance = bitcast<f32>(point.y);
    if paint.look == LOOK_TUBE {
        insert(first, tube_layer(point.x, distance, ray));
    } else {
        insert(first, layer_at(point.x - 1u, distance, ray));
    }
    count(COUNT_WORK, PAINT_WORK + select(lighting.work, 0u, paint.look == LOOK_FAINT));
}

// Puts a layer among those that are there, behind all that are not farther.
fn insert(first: u32, layer: Layer) {
    var at = first + paint.layer;
    while at > first && bitcast<f32>(ray_states[at - 1u].x) > layer.distance {
        ray_states[at] = ray_states[at - 1u];
        at -= 1u;
    }
    store_layer(at, layer);
}

// A point of a well, which carries no number, as ghosts do.
fn tube_layer(packed: u32, distance: f32, ray: PixelRay) -> Layer {
    let color = vec3f((vec3u(packed) >> vec3u(20u, 10u, 0u)) & vec3u(0x3ffu)) / 1023.0;
    return Layer(distance, shade(color, ray.origin + distance * ray.direction, true), 1.0);
}

fn layer_at(face: u32, distance: f32, ray: PixelRay) -> Layer {
    let column = face / 6u / grid.nk;
    let layer = face / 6u % grid.nk;
    let direction = ray.direction;
    let place = ray.origin + distance * direction;
    let spot = spot_on(column, layer, face % 6u, frame_at(place, direction, distance), pixel_steps(direction, distance));
    if !HULL && paint.look == LOOK_FAINT {
        let away = 1.0 - turned_to_ray(spot.normal, direction);
        return Layer(distance, paint.faint.rgb, mix(paint.facing, paint.edge_on, away * away));
    }
    var color = fault_color(face);
    if HULL {
        let own = transfer(value_on(column, layer, face % 6u, spot.at)).rgb;
        color = vec4f(mix(own, color.rgb, SHEET_OPACITY * color.a), 1.0);
    }
    if HULL {
        color = vec4f(headlight(spot.normal, direction) * color.rgb, 1.0);
    }
    // A sheet carries no number, as ghosts do.
    let lit = shade(color.rgb, place, !HULL);
    let opacity = select(SHEET_OPACITY, 1.0, HULL);
    if !CELL_EDGES {
        return Layer(distance, lit, opacity);
    }
    let lined = with_edges(lit, vec3f(spot.at, 0.5), vec3f(spot.right, 0.0), vec3f(spot.down, 0.0));
    return Layer(distance, lined, opacity);
}

// Color of the fault that a face lies on, and 1; zero where it lies on none.
fn fault_color(face: u32) -> vec4f {
    var low = 0u;
    var high = paint.faults;
    while low < high {
        let middle = (low + high) / 2u;
        if fault_faces[middle].x < face {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if low >= paint.faults || fault_faces[low].x != face {
        return vec4f(0.0);
    }
    return vec4f(paint.palette[fault_faces[low].y].rgb, 1.0);
}

fn value_on(column: u32, layer: u32, side: u32, at: vec2f) -> f32 {
    if frame.interpolation == INTERPOLATION_CELL {
        return cell_value(column, layer);
    }
    let lists = column_lists(column);
    var corners: vec4f;
    for (var n = 0u; n < 4u; n++) {
        let corner = face_corner(side, n);
        corners[n] = value_at(list_entry(lists[corner & 3u], layer, corner >> 2u));
    }
    let pair = mix(corners.xz, corners.yw, at.x);
    return mix(pair.x, pair.y, at.y);
}

// Where the ray, whose frame has its origin there, meets a face: parameters are linear in each triangle.
fn spot_on(column: u32, layer: u32, side: u32, r: RayFrame, steps: mat2x3f) -> Spot {
    let lists = column_lists(column);
    let numbers = pillar_index(column);
    var corners: array<vec3f, 4>;
    var q: array<vec3f, 4>;
    for (var n = 0u; n < 4u; n++) {
        let corner = face_corner(side, n);
        let depth = depth_at(list_entry(lists[corner & 3u], layer, corner >> 2u));
        corners[n] = from_origin(r, load_pillar(numbers[corner & 3u]), depth);
        q[n] = projected(r, corners[n]);
    }
    // The ray is in triangle 0 1 3 where it lies on the same side of the diagonal as corner 1.
    let corner_side = cross2d(q[3] - q[0], q[1] - q[0]);
    let is_first = corner_side * cross2d(q[0], q[3]) > 0.0;
    let first_axis = select(q[3] - q[2], q[1] - q[0], is_first);
    let second_axis = select(q[2] - q[0], q[3] - q[1], is_first);
    let area = cross2d(first_axis, second_axis);
    let scale = select(0.0, 1.0 / area, abs(area) > 1e-20);
    let to_x = scale * vec3f(second_axis.y, -second_axis.x, 0.0);
    let to_y = scale * vec3f(-first_axis.y, first_axis.x, 0.0);
    let right = vec3f(dot(r.across_x, steps[0]), dot(r.across_y, steps[0]), 0.0);
    let down = vec3f(dot(r.across_x, steps[1]), dot(r.across_y, steps[1]), 0.0);
    var spot: Spot;
    spot.at = clamp(-vec2f(dot(to_x, q[0]), dot(to_y, q[0])), vec2f(0.0), vec2f(1.0));
    spot.right = vec2f(dot(to_x, right), dot(to_y, right));
    spot.down = vec2f(dot(to_x, down), dot(to_y, down));
    // At right angles to both diagonals: one normal for both triangles.
    spot.normal = cross(corners[3] - corners[0], corners[2] - corners[1]);
    return spot;
}
