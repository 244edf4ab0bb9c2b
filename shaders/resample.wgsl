// Fills a volume over the box of the active cells by point location at the middle of each voxel
// (campagnolo-2021, 4.1.1).
//
// One thread = RUN voxels down a line, or down two lines that share words, each found from the one above it
// where cells join; dispatch covers the columns of a slab one run deep. Reads the grid and its values; writes
// half floats, two a voxel: the value as a part of the property's range times presence, and presence, which
// is 1 in a drawn cell and 0 elsewhere. Where inactive cells are shown there are two more: 1 in a ghost, and
// 0. Single numbers are 0 in no cell, 1 to 2 for the range of values, and 3 in a ghost. The slab is zero
// before; the host copies it into the texture.
#import topology

// Voxels of one half float.
override SINGLE: bool = false;

@group(3) @binding(0) var<uniform> volume: VolumeInfo;
@group(3) @binding(1) var<uniform> slab: Slab;
// Half a word a voxel, one, or two; rows of slab.row voxels, slices of slab.size.y rows.
@group(3) @binding(2) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(8, 8)
fn fill(@builtin(global_invocation_id) id: vec3u) {
    let wide = select(1u, 2u, SINGLE);
    for (var side = 0u; side < wide; side++) {
        let x = wide * id.x + side;
        if x < slab.size.x && id.y < slab.size.y {
            fill_line(vec2u(x, id.y));
        }
    }
}

fn fill_line(line: vec2u) {
    let spacing = volume.box_extent / vec3f(volume.size);
    let top = volume.box_low + (vec3f(slab.first + vec3u(line, 0u)) + vec3f(0.5)) * spacing;
    let advance = vec3f(0.0, 0.0, spacing.z);
    let count = f32(slab.size.z);
    let slice = slab.row * slab.size.y;
    let at = line.y * slab.row + line.x;
    var track: Track;
    var n = 0.0;
    // Two phases, so that lines side by side locate together and march together.
    while n < count {
        while !track.has_cell && n < count {
            n += find(&track, top + n * advance, advance, volume.interpolation);
        }
        while track.has_cell {
            store(at + u32(n) * slice, track);
            n += 1.0;
            if n >= count {
                break;
            }
            follow(&track, top + n * advance, advance, volume.interpolation);
        }
    }
}

// Writes the voxel of a number in the slab.
fn store(voxel: u32, track: Track) {
    let stored = clamp((value_on(track) - volume.value_low) * volume.value_scale, 0.0, 1.0);
    let is_ghost = is_ghost(track.cell.column, track.cell.layer);
    if SINGLE {
        let number = select(1.0 + stored, GHOST_NUMBER, is_ghost);
        voxels[voxel / 2u] |= pack2x16float(vec2f(number, 0.0)) << (16u * (voxel & 1u));
        return;
    }
    var word = voxel;
    var halves = vec2f(stored, 1.0);
    if GHOSTS {
        word = 2u * word + select(0u, 1u, is_ghost);
        halves = select(halves, vec2f(1.0, 0.0), is_ghost);
    }
    voxels[word] = pack2x16float(halves);
}
