// Fills a volume over the box of the active cells by point location at the middle of each voxel
// (campagnolo-2021, 4.1.1).
//
// One thread = RUN voxels down a line, or down two lines that share words, each found from the one above it
// where cells join; dispatch covers the columns of a slab one run deep. Reads the grid and its values; writes
// half floats, two a voxel: the value as a part of the property's range times presence, and presence, which
// is 1 in a drawn cell and 0 elsewhere. Where inactive cells are shown there are two more: 1 in a ghost, and
// 0. Packed voxels hold how much of them cells cover, and the mean value there, both from PARTS samples down
// the line. The slab is zero before; the host copies it into the texture.
#import topology

// Voxels of coverage and value.
override PACKED: bool = false;
// Samples of a packed voxel: without them the model's top would have steps that light shows.
const PARTS: f32 = 4.0;

@group(3) @binding(0) var<uniform> volume: VolumeInfo;
@group(3) @binding(1) var<uniform> slab: Slab;
// Half a word a voxel, one, or two; rows of slab.row voxels, slices of slab.size.y rows.
@group(3) @binding(2) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(8, 8)
fn fill(@builtin(global_invocation_id) id: vec3u) {
    let wide = select(1u, 2u, PACKED);
    for (var side = 0u; side < wide; side++) {
        let x = wide * id.x + side;
        if x < slab.size.x && id.y < slab.size.y {
            fill_line(vec2u(x, id.y));
        }
    }
}

fn fill_line(line: vec2u) {
    let spacing = volume.box_extent / vec3f(volume.size);
    let parts = select(1.0, PARTS, PACKED);
    let middle = vec3f(0.5, 0.5, 0.5 / parts);
    let top = volume.box_low + (vec3f(slab.first + vec3u(line, 0u)) + middle) * spacing;
    let advance = vec3f(0.0, 0.0, spacing.z / parts);
    let count = parts * f32(slab.size.z);
    let slice = slab.row * slab.size.y;
    let at = line.y * slab.row + line.x;
    var track: Track;
    var packing: Packing;
    var n = 0.0;
    // Two phases, so that lines side by side locate together and march together.
    while n < count {
        while needs_cell(track) && n < count {
            n += find(&track, top + n * advance, advance, volume.interpolation);
        }
        n += settle(&track, top + n * advance, advance, count - n, volume.interpolation);
        while track.has_cell {
            let voxel = at + u32(n / parts) * slice;
            let stored = clamp((value_on(track) - volume.value_low) * volume.value_scale, 0.0, 1.0);
            let is_ghost = is_ghost(track.cell.column, track.cell.layer);
            if PACKED {
                add_part(&packing, voxel, stored, is_ghost);
            } else {
                store(voxel, stored, is_ghost);
            }
            n += 1.0;
            if n >= count {
                break;
            }
            follow(&track, top + n * advance, advance, volume.interpolation);
        }
    }
    if PACKED {
        pack(packing);
    }
}

// Writes the voxel of a number in the slab.
fn store(voxel: u32, stored: f32, is_ghost: bool) {
    var word = voxel;
    var halves = vec2f(stored, 1.0);
    if GHOSTS {
        word = 2u * word + select(0u, 1u, is_ghost);
        halves = select(halves, vec2f(1.0, 0.0), is_ghost);
    }
    voxels[word] = pack2x16float(halves);
}

// A voxel of which some parts have been met.
struct Packing {
    voxel: u32,
    parts: f32,
    ghosts: f32,
    sum: f32,
}

// Adds a part of a voxel; the one before is written once another begins.
fn add_part(packing: ptr<function, Packing>, voxel: u32, stored: f32, is_ghost: bool) {
    if voxel != (*packing).voxel {
        pack(*packing);
        *packing = Packing(voxel, 0.0, 0.0, 0.0);
    }
    (*packing).parts += 1.0;
    (*packing).ghosts += select(0.0, 1.0, is_ghost);
    (*packing).sum += select(stored, 0.0, is_ghost);
}

fn pack(packing: Packing) {
    if packing.parts == 0.0 {
        return;
    }
    let mean = packing.sum / max(packing.parts - packing.ghosts, 1.0);
    let value = select(u32(round(mean * f32(PACKED_VALUES))), PACKED_GHOST, 2.0 * packing.ghosts > packing.parts);
    let coverage = u32(round(packing.parts / PARTS * f32(PACKED_COVERAGE)));
    voxels[packing.voxel / 2u] |= (coverage << PACKED_SHIFT | value) << (16u * (packing.voxel & 1u));
}
