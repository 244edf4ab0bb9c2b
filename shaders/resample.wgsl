// Fills a volume over the box of the active cells by point location at the middle of each voxel
// (campagnolo-2021, 4.1.1).
//
// One thread = RUN voxels down a line, each found from the one above it where cells join; dispatch covers
// the columns of a slab one run deep. Reads the grid and its values; writes half floats, two a voxel:
// the value as a part of the property's range times presence, and presence, which is 1 in a drawn cell and
// 0 elsewhere. Where inactive cells are shown there are two more: 1 in a ghost, and 0. The slab is zero
// before; the host copies it into the texture.
#import topology

@group(3) @binding(0) var<uniform> volume: VolumeInfo;
@group(3) @binding(1) var<uniform> slab: Slab;
// One word a voxel, or two; rows of slab.row voxels, slices of slab.size.y rows.
@group(3) @binding(2) var<storage, read_write> voxels: array<u32>;

@compute @workgroup_size(8, 8)
fn fill(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= slab.size.xy) {
        return;
    }
    let spacing = volume.box_extent / vec3f(volume.size);
    let top = volume.box_low + (vec3f(slab.first + vec3u(id.xy, 0u)) + vec3f(0.5)) * spacing;
    let advance = vec3f(0.0, 0.0, spacing.z);
    let count = f32(slab.size.z);
    let slice = slab.row * slab.size.y;
    var at = id.y * slab.row + id.x;
    var track: Track;
    var n = 0.0;
    // Two phases, so that lines side by side locate together and march together.
    while n < count {
        while !track.has_cell && n < count {
            n += find(&track, top + n * advance, advance, volume.interpolation);
        }
        while track.has_cell {
            let stored = clamp((value_on(track) - volume.value_low) * volume.value_scale, 0.0, 1.0);
            var word = at + u32(n) * slice;
            var halves = vec2f(stored, 1.0);
            if GHOSTS {
                let is_ghost = is_ghost(track.cell.column, track.cell.layer);
                word = 2u * word + select(0u, 1u, is_ghost);
                halves = select(halves, vec2f(1.0, 0.0), is_ghost);
            }
            voxels[word] = pack2x16float(halves);
            n += 1.0;
            if n >= count {
                break;
            }
            follow(&track, top + n * advance, advance, volume.interpolation);
        }
    }
}
