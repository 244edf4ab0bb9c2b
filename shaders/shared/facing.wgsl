// Faces of a cell: their number, corners and sense. Face 2 a is toward smaller, 2 a + 1 toward larger
// index along axis a (i, j, k).
#import grid

// Corner (di + 2 dj + 4 dk) of a face: bit 0 of `number` counts along the first other axis, bit 1 along
// the second. Two triangles, 0 1 3 and 0 3 2: both cells of a face cut it along the same diagonal.
fn face_corner(face: u32, number: u32) -> u32 {
    let axis = face >> 1u;
    let side = face & 1u;
    let first = number & 1u;
    let second = number >> 1u;
    if axis == 0u {
        return side + 2u * first + 4u * second;
    }
    if axis == 1u {
        return first + 2u * side + 4u * second;
    }
    return first + 2u * second + 4u * side;
}

// Parameters in the cell of a point on one of its faces.
fn on_face(face: u32, at: vec2f) -> vec3f {
    let side = f32(face & 1u);
    let axis = face >> 1u;
    if axis == 0u {
        return vec3f(side, at);
    }
    if axis == 1u {
        return vec3f(at.x, side, at.y);
    }
    return vec3f(at, side);
}

// +1 where the triangles' sense is that of the outward normal in a right-handed cell, else -1.
fn face_orientation(face: u32) -> f32 {
    let plus = select(-1.0, 1.0, (face & 1u) == 1u);
    return select(plus, -plus, (face >> 1u) == 1u);
}

// The column across a lateral face, or NOT_FOUND outside the grid.
fn column_behind(column: u32, face: u32) -> u32 {
    let at = select(column / grid.ni, column % grid.ni, face < 2u);
    let size = select(grid.nj, grid.ni, face < 2u);
    let stride = select(grid.ni, 1u, face < 2u);
    let plus = (face & 1u) == 1u;
    if (plus && at + 1u >= size) || (!plus && at == 0u) {
        return NOT_FOUND;
    }
    return select(column - stride, column + stride, plus);
}

// The column's two depth lists on a lateral face.
fn side_lists(lists: vec4u, face: u32) -> vec2u {
    if face >> 1u == 0u {
        return select(lists.xz, lists.yw, face == 1u);
    }
    return select(lists.xy, lists.zw, face == 3u);
}

// True where a layer of two columns, given by their lists on the face between them, is not displaced.
fn sides_join(mine: vec2u, theirs: vec2u, layer: u32) -> bool {
    // Flags aside, shared lists are one list: no fault.
    if all((mine & vec2u(LIST_OFFSET)) == (theirs & vec2u(LIST_OFFSET))) {
        return true;
    }
    return all_coincide(side_depths(mine, layer), side_depths(theirs, layer));
}

fn side_depths(lists: vec2u, layer: u32) -> vec4f {
    return depths_at(vec4u(list_entry(lists.x, layer, 0u), list_entry(lists.y, layer, 0u),
        list_entry(lists.x, layer, 1u), list_entry(lists.y, layer, 1u)));
}
