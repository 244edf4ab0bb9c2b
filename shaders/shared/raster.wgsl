// Faces of cells as triangles in the tile's clip space.
#import frame
#import grid
#import facing

// One corner of one of a face's two triangles.
struct Corner {
    @builtin(position) position: vec4f,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) face: u32,
}

// What a pixel gets: face number + 1 and the bits of the distance along its ray, nearest first by the
// fragment's depth.
struct Met {
    @builtin(frag_depth) depth: f32,
    @location(0) met: vec2u,
}

// Vertex 0 to 5 of a face, (column * nk + layer) * 6 + side.
fn face_vertex(face: u32, vertex: u32) -> Corner {
    let column = face / 6u / grid.nk;
    let layer = face / 6u % grid.nk;
    var triangle = array<u32, 6>(0u, 1u, 3u, 0u, 3u, 2u);
    var number = vertex;
    if frame.world_handedness * face_orientation(face % 6u) < 0.0 {
        // Every triangle is counterclockwise as seen from outside its cell.
        number = (number / 3u) * 3u + (3u - number % 3u) % 3u;
    }
    let corner = face_corner(face % 6u, triangle[number]);
    let pillars_of = pillar_index(column);
    let lists = column_lists(column);
    let pillar = load_pillar(pillars_of[corner & 3u]);
    let depth = depth_at(list_entry(lists[corner & 3u], layer, corner >> 2u));
    let from_eye = vec3f((pillar.at - frame.eye.xy) + (pillar.low_bits + pillar.slope * depth), depth - frame.eye.z);
    let depth_in_view = dot(frame.view_z, from_eye);
    let w = mix(depth_in_view, 1.0, frame.is_parallel);
    // The picture's clip space, then the tile's.
    let scale = vec2f(f32(frame.width), f32(frame.height)) / vec2f(tile.size);
    let shift = scale - vec2f(1.0) - 2.0 * vec2f(tile.origin) / vec2f(tile.size);
    var out: Corner;
    out.position = vec4f(
        scale.x * dot(frame.view_x, from_eye) + shift.x * w,
        scale.y * dot(frame.view_y, from_eye) - shift.y * w,
        // From 0 at the eye or its plane to 1/2; fragments have a depth of their own.
        0.5 * depth_in_view / mix(1.0, max(frame.farthest, 1e-20), frame.is_parallel),
        w,
    );
    out.depth = depth_in_view;
    out.face = face;
    return out;
}
