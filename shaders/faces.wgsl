// The boundary faces of the drawn cells, rasterized: one vertex = one corner of one of a face's two
// triangles, one fragment = where the ray of a pixel meets a face. Reads the grid, the list of faces
// and, to peel, the states of the rays; writes face number + 1 and the bits of the distance, nearest
// first by the fragment's depth.
#import raster

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

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    return face_vertex(boundary_faces[index / 6u], index % 6u);
}

@fragment
fn fragment(in: Corner, @builtin(front_facing) is_front: bool) -> Met {
    let in_tile = vec2u(in.position.xy);
    let distance = in.depth * pixel_ray(tile.origin + in_tile).slant;
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
