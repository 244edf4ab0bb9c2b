// The boundary faces of the drawn cells, rasterized: one vertex = one corner of one of a face's two
// triangles, one fragment = where the ray of a pixel meets a face. Reads the grid, the list of faces
// and, to peel, the states of the rays; writes face number + 1 and the bits of the distance, nearest
// first by the fragment's depth.
#import frame
#import grid
#import facing

struct FacesInfo {
    // FACES_PEEL, FACES_FIRST or FACES_LAST.
    mode: u32,
    // How far before the end of the last peel the next entry may lie: faces of a fault need not meet.
    margin: f32,
}

const FACES_PEEL: u32 = 0u;
const FACES_FIRST: u32 = 1u;
const FACES_LAST: u32 = 2u;

@group(3) @binding(0) var<uniform> faces_info: FacesInfo;
// (column * nk + layer) * 6 + face.
@group(3) @binding(1) var<storage, read> boundary_faces: array<u32>;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) face: u32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    let face = boundary_faces[index / 6u];
    let column = face / 6u / grid.nk;
    let layer = face / 6u % grid.nk;
    var triangle = array<u32, 6>(0u, 1u, 3u, 0u, 3u, 2u);
    var number = index % 6u;
    if frame.world_handedness * face_orientation(face % 6u) < 0.0 {
        // Every triangle is counterclockwise as seen from outside its cell.
        number = (number / 3u) * 3u + (3u - number % 3u) % 3u;
    }
    let corner = face_corner(face % 6u, triangle[number]);
    let pillars_of = pillar_index(column);
    let lists = column_lists[column];
    let pillar = load_pillar(pillars_of[corner & 3u]);
    let depth = depths[list_entry(lists[corner & 3u], layer, corner >> 2u)];
    let from_eye = vec3f((pillar.at - frame.eye.xy) + (pillar.low_bits + pillar.slope * depth), depth - frame.eye.z);
    let w = dot(frame.view_z, from_eye);
    // The picture's clip space, then the tile's.
    let scale = vec2f(f32(frame.width), f32(frame.height)) / vec2f(tile.size);
    let shift = scale - vec2f(1.0) - 2.0 * vec2f(tile.origin) / vec2f(tile.size);
    var out: Corner;
    out.position = vec4f(
        scale.x * dot(frame.view_x, from_eye) + shift.x * w,
        scale.y * dot(frame.view_y, from_eye) - shift.y * w,
        0.5 * w,
        w,
    );
    out.depth = w;
    out.face = face;
    return out;
}

struct Met {
    @builtin(frag_depth) depth: f32,
    @location(0) met: vec2u,
}

@fragment
fn fragment(in: Corner, @builtin(front_facing) is_front: bool) -> Met {
    let in_tile = vec2u(in.position.xy);
    let slant = length(view_direction(tile.origin + in_tile));
    let distance = in.depth * slant;
    var out: Met;
    out.met = vec2u(in.face + 1u, bitcast<u32>(distance));
    out.depth = clamp(distance / frame.farthest, 0.0, 1.0);
    if faces_info.mode == FACES_LAST {
        out.depth = 1.0 - out.depth;
        if is_front {
            discard;
        }
        return out;
    }
    if !is_front {
        discard;
    }
    if faces_info.mode == FACES_PEEL {
        // Entries come in the order of distance and face; nothing before the end of the last peel.
        let state = ray_states[LIBC_STATE * (in_tile.y * tile.size.x + in_tile.x) + 1u];
        let last = bitcast<f32>(state.z);
        let last_face = state.w;
        if distance < bitcast<f32>(state.y) - faces_info.margin || distance < last
            || (distance == last && in.face + 1u <= last_face) {
            discard;
        }
    }
    return out;
}
