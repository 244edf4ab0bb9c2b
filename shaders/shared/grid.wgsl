// The compact corner-point grid: the only place that indexes its buffers.
// Depths and positions are grid space relative to the model's origin, depth positive down.
#import layout

@group(1) @binding(0) var<uniform> grid: GridInfo;
// Three a pillar: x, y at depth 0 of the origin, what rounding to f32 cut off there, and their change
// per unit of depth.
@group(1) @binding(1) var<storage, read> pillars: array<vec2f>;
@group(1) @binding(2) var<storage, read> column_lists: array<vec4u>;
@group(1) @binding(3) var<storage, read> depths: array<f32>;
// For each 32 cells, column by column: bits of the drawn ones, and how many are drawn before.
@group(1) @binding(4) var<storage, read> drawn_cells: array<vec2u>;
// One value a drawn cell, or one a depth-list entry, by frame.interpolation.
@group(1) @binding(5) var<storage, read> values: array<f32>;
// Acceleration grid over x and y: first entry in bin_columns, and the depth range in 2 x 16 bits.
@group(1) @binding(6) var<storage, read> bins: array<vec2u>;
@group(1) @binding(7) var<storage, read> bin_columns: array<u32>;
// One bit a cell, column by column: inactive cells that are shown.
@group(1) @binding(8) var<storage, read> ghost_cells: array<u32>;

// Inactive cells are shown, and drawn as any other but for their look.
override GHOSTS: bool = false;

struct Pillar {
    at: vec2f,
    low_bits: vec2f,
    slope: vec2f,
}

fn load_pillar(index: u32) -> Pillar {
    return Pillar(pillars[3u * index], pillars[3u * index + 1u], pillars[3u * index + 2u]);
}

// How far outside its column, in cell widths, a point may seem by the horizontal section: pillars that
// are not parallel meet a dipping layer at different depths.
const COLUMN_MARGINS = array<f32, 8>(0.002, 0.01, 0.03, 0.08, 0.2, 0.5, 1.0, 2.0);

fn column_margin(lists: vec4u) -> f32 {
    let bits = select(vec3u(0u), vec3u(1u, 2u, 4u), (lists.yzw & vec3u(COLUMN_FLAG)) != vec3u(0u));
    var margins = COLUMN_MARGINS;
    return margins[bits.x + bits.y + bits.z];
}

fn pillar_index(column: u32) -> vec4u {
    let first = column % grid.ni + (grid.ni + 1u) * (column / grid.ni);
    return vec4u(first, first + 1u, first + grid.ni + 1u, first + grid.ni + 2u);
}

fn is_drawn(column: u32, layer: u32) -> bool {
    let slot = column * grid.nk + layer;
    return (drawn_cells[slot >> 5u].x >> (slot & 31u) & 1u) == 1u;
}

fn is_ghost(column: u32, layer: u32) -> bool {
    if !GHOSTS {
        return false;
    }
    let slot = column * grid.nk + layer;
    return (ghost_cells[slot >> 5u] >> (slot & 31u) & 1u) == 1u;
}

// Rank among the drawn cells.
fn drawn_rank(column: u32, layer: u32) -> u32 {
    let slot = column * grid.nk + layer;
    let word = drawn_cells[slot >> 5u];
    return word.y + countOneBits(word.x & ((1u << (slot & 31u)) - 1u));
}

fn list_entry(list: u32, layer: u32, bottom: u32) -> u32 {
    return (list & LIST_OFFSET) + select(layer + bottom, 2u * layer + bottom, (list & LIST_GAPPED) != 0u);
}

// Positions in `depths` of the four corners of a layer's top (0) or bottom (1).
fn layer_entries(lists: vec4u, layer: u32, bottom: u32) -> vec4u {
    return vec4u(
        list_entry(lists.x, layer, bottom),
        list_entry(lists.y, layer, bottom),
        list_entry(lists.z, layer, bottom),
        list_entry(lists.w, layer, bottom),
    );
}

fn depths_at(entries: vec4u) -> vec4f {
    return vec4f(depths[entries.x], depths[entries.y], depths[entries.z], depths[entries.w]);
}

fn values_at(entries: vec4u) -> vec4f {
    return vec4f(values[entries.x], values[entries.y], values[entries.z], values[entries.w]);
}

fn all_coincide(a: vec4f, b: vec4f) -> bool {
    return all(abs(a - b) <= vec4f(COINCIDENT));
}
