// Surface points of a part of the picture, rasterized layer by layer: one vertex = one corner of one of a
// face's two triangles, one fragment = where the ray of a pixel meets a face, from either side. Reads the
// grid, the list of faces and the layer before; the nearest point behind that is the next layer. Or the last point
// of all.
#import raster

struct PeelInfo {
    // Number of the layer among those of the same faces.
    layer: u32,
    // Faces on both sides of a fault lie within this distance.
    gap: f32,
    // How far behind its place a face that is turned away counts as.
    behind: f32,
    // 1 where the last point is looked for.
    is_last: u32,
}

@group(3) @binding(0) var<uniform> peel: PeelInfo;
// (column * nk + layer) * 6 + side.
@group(3) @binding(1) var<storage, read> faces: array<u32>;
@group(3) @binding(2) var layer_before: texture_2d<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    return face_vertex(faces[index / 6u], index % 6u);
}

@fragment
fn fragment(in: Corner, @builtin(front_facing) is_front: bool) -> Met {
    let in_part = vec2u(in.position.xy);
    let pixel = tile.origin + in_part;
    let ray = pixel_ray(pixel);
    let distance = in.depth * ray.slant;
    if !is_kept(ray.origin + distance * ray.direction) {
        discard;
    }
    if peel.layer > 0u {
        let before = textureLoad(layer_before, vec2i(in_part), 0).xy;
        // Sheets that touch, or lie between the same two columns, are one.
        if before.x == 0u || distance < bitcast<f32>(before.y) + peel.gap || sheet_of(before.x - 1u) == sheet_of(in.face) {
            discard;
        }
    }
    let counts_as = distance + select(peel.behind, 0.0, is_front);
    var out: Met;
    out.met = vec2u(in.face + 1u, bitcast<u32>(distance));
    let depth = clamp(counts_as / (1.0001 * frame.farthest + peel.behind), 0.0, 1.0);
    out.depth = select(depth, 1.0 - depth, peel.is_last == 1u);
    return out;
}

// A number for the lateral faces that lie between the same two columns.
fn sheet_of(face: u32) -> u32 {
    let side = face % 6u;
    let column = face / 6u / grid.nk;
    let lower = select(column, column_behind(column, side), (side & 1u) == 0u);
    return 2u * lower + (side >> 1u);
}
