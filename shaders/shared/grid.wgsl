// The compact corner-point grid: the only place that indexes its buffers.
// Depths and positions are grid space relative to the model's origin, depth positive down.
#import layout

@group(1) @binding(0) var<uniform> grid: GridInfo;
// One after the other, in pairs of words, from where `grid` says:
// - three pairs a pillar: x, y at depth 0 of the origin, what rounding to f32 cut off there, and their change
//   per unit of depth;
// - two pairs a column: its four depth lists;
// - one a bin of the acceleration grid over x and y: first entry in the list of columns, and the depth range
//   in 2 x 16 bits;
// - columns of the bins, two a pair.
@group(1) @binding(1) var<storage, read> grid_words: array<vec2u>;
// Depths and values are f32, or in blocks where they take 16 bits: a word with the smallest number in steps above the
// exponent of the step, and two words for each four numbers, how many steps each lies above the smallest.
@group(1) @binding(2) var<storage, read> depth_words: array<u32>;
// One bit a cell, column by column. A pair for each 32 cells: bits of the drawn ones, and how many are drawn
// before; then, two words a pair, where inactive cells are shown the bits of these, and where rays pass what shows
// nothing those of the cells that they meet.
@group(1) @binding(3) var<storage, read> cell_bits: array<vec2u>;
// One value a drawn cell, or one a depth-list entry, by frame.interpolation.
@group(1) @binding(4) var<storage, read> value_words: array<u32>;

// Inactive cells are shown, and drawn as any other but for their look.
override GHOSTS: bool = false;
// Depths and values take 16 bits.
override PACKED_GRID: bool = false;

struct Pillar {
    at: vec2f,
    low_bits: vec2f,
    slope: vec2f,
}

fn load_pillar(index: u32) -> Pillar {
    let at = 3u * index;
    return Pillar(bitcast<vec2f>(grid_words[at]), bitcast<vec2f>(grid_words[at + 1u]), bitcast<vec2f>(grid_words[at + 2u]));
}

// The four depth lists of a column, with their flags.
fn column_lists(column: u32) -> vec4u {
    let at = grid.column_lists + 2u * column;
    return vec4u(grid_words[at], grid_words[at + 1u]);
}

// First entry of a bin in the list of columns, with its flag, and its depth range.
fn bin_words(bin: u32) -> vec2u {
    return grid_words[grid.bins + bin];
}

fn bin_column(entry: u32) -> u32 {
    return grid_words[grid.bin_columns + (entry >> 1u)][entry & 1u];
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
    return (cell_bits[slot >> 5u].x >> (slot & 31u) & 1u) == 1u;
}

// True where rays meet a cell: where something shows in it, if it is told which these are, and else where it is drawn.
fn is_met(column: u32, layer: u32) -> bool {
    if grid.visible == 0u {
        return is_drawn(column, layer);
    }
    return has_bit(grid.visible, column, layer);
}

// The bit of a cell among those that begin at a pair of words.
fn has_bit(first: u32, column: u32, layer: u32) -> bool {
    let slot = column * grid.nk + layer;
    let word = slot >> 5u;
    return (cell_bits[first + (word >> 1u)][word & 1u] >> (slot & 31u) & 1u) == 1u;
}

fn is_ghost(column: u32, layer: u32) -> bool {
    return GHOSTS && has_bit(grid.ghosts, column, layer);
}

// Rank among the drawn cells.
fn drawn_rank(column: u32, layer: u32) -> u32 {
    let slot = column * grid.nk + layer;
    let word = cell_bits[slot >> 5u];
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

fn depth_at(entry: u32) -> f32 {
    if !PACKED_GRID {
        return bitcast<f32>(depth_words[entry]);
    }
    let block = BLOCK_WORDS * (entry / BLOCK);
    return unpacked(depth_words[block], depth_words[block + 1u + entry % BLOCK / 2u], entry);
}

fn value_at(entry: u32) -> f32 {
    if !PACKED_GRID {
        return bitcast<f32>(value_words[entry]);
    }
    let block = BLOCK_WORDS * (entry / BLOCK);
    return unpacked(value_words[block], value_words[block + 1u + entry % BLOCK / 2u], entry);
}

// A number of a block from its first word and the one that has it: steps are powers of two, and no bit is lost.
fn unpacked(head: u32, pair: u32, entry: u32) -> f32 {
    let above = pair >> (16u * (entry & 1u)) & 0xffffu;
    return f32((bitcast<i32>(head) >> 8u) + i32(above)) * bitcast<f32>((head & 0xffu) << 23u);
}

// The value of a drawn cell, where values are constant in cells.
fn cell_value(column: u32, layer: u32) -> f32 {
    return value_at(drawn_rank(column, layer));
}

fn depths_at(entries: vec4u) -> vec4f {
    return vec4f(depth_at(entries.x), depth_at(entries.y), depth_at(entries.z), depth_at(entries.w));
}

fn values_at(entries: vec4u) -> vec4f {
    return vec4f(value_at(entries.x), value_at(entries.y), value_at(entries.z), value_at(entries.w));
}

fn all_coincide(a: vec4f, b: vec4f) -> bool {
    return all(abs(a - b) <= vec4f(COINCIDENT));
}
