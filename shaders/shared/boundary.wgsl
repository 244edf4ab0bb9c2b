// Where a ray passes the boundary faces of the drawn cells: between two passages all its samples lie in cells, or none
// does, so that nothing need be searched. Faces are listed by the bins of the acceleration grid; a ray looks through
// the bins on its way until it meets some.
//
// A face that is not flat is met over a span of the ray, within which its cell may begin or end anywhere. Places on
// the ray are numbers of samples, and parts of them.
#import projection
#import topology

// First entry and end of each bin's list, then the entries: a face that may touch the bin, as
// (column * nk + layer) * 6 + side, and its depth range in 2 x 16 bits.
@group(3) @binding(0) var<storage, read> face_bins: array<vec2u>;

// Samples nearer to a face than this are asked of its cell, against rounding.
const PASSAGE_MARGIN: f32 = 0.02;
// Cells of faces that are tried for a sample, at most.
const MOST_TRIED: u32 = 8u;
// Faces and bins that are looked at in one go, about.
const MOST_LOOKED: u32 = 2000u;
// Behind a face, and how far behind the face that it seems to begin at a cell is looked for again, at first: in samples.
const BEHIND: f32 = 1e-3;
const LATER: f32 = 0.1;
const FAR_AWAY: f32 = 1e30;
// Instead of a face: none up to the place; or all is to be searched from there on.
const NO_FACE: u32 = 0xffffffffu;
const ODD_BIN: u32 = 0xfffffffeu;

// A face that a ray passes.
struct Passage {
    face: u32,
    // Samples from here on may lie behind the face, and do from there on.
    near: f32,
    far: f32,
    // +1 where the ray comes into the face's cell, -1 where it leaves, 0 where it does both or neither.
    turn: f32,
}

// What a look for the next passage goes by.
struct Look {
    // Coordinates along the ray count samples.
    frame: RayFrame,
    ray: Ray,
    // The sample that is to be found, all before it being settled.
    n: f32,
    // The last passage whose cell was tried for it.
    tried: Passage,
}

// Looks for a sample in the cells of the faces that the ray passes there; where it lies in none, goes on to the next
// sample that does. Searches where that leaves doubt. Returns how many samples lie in no cell.
//
// There is one place that tries cells and one that searches, for drivers put what is called in the place of each call.
fn find_behind_faces(track: ptr<function, Track>, ray: Ray, n: f32) -> f32 {
    let nothing = Passage(0u, -FAR_AWAY, -FAR_AWAY, 0.0);
    var look = Look(frame_at(ray.base, ray.advance, 0.0), ray, n, nothing);
    var until = -FAR_AWAY;
    // A ray that paused may go on in its cell. One that starts inside came into its cell before; one that has just
    // left a cell may still be in one, where a bent cell does not say where it ends: the grid is asked.
    var cell = (*track).last;
    let is_given = (*track).has_paused;
    (*track).has_paused = false;
    let leaves = (*track).has_last && (*track).gap == 0.0 && !is_given;
    let is_searched = leaves || (!(*track).has_last && (*track).gap == 0.0 && ray.starts_inside);
    for (var attempt = select(0u, MOST_TRIED, is_searched); attempt < MOST_TRIED; attempt++) {
        if !is_given {
            let passage = next_passage(look, track);
            // Where it is tried first: at a sample, or past a face where that is flat.
            let begin = select(ceil(passage.near), passage.near, BY_SEGMENT);
            let at = select(begin, min(passage.far + BEHIND, passage.near + LATER), BY_SEGMENT);
            if begin > look.n {
                if until >= look.n {
                    // A cell that was tried may begin behind this sample.
                    let stride = clamp(look.n - look.tried.near, LATER, 1.0);
                    let later = select(look.n + 1.0, min(until + BEHIND, look.n + stride), BY_SEGMENT);
                    return pass_by(track, later - n);
                }
                if passage.face == ODD_BIN || passage.turn < 0.0 {
                    // The samples up to there lie in a cell, or may do so.
                    break;
                }
                if passage.face == NO_FACE || at >= ray.count {
                    return pass_by(track, min(at, ray.count) - n);
                }
                look.n = at;
                until = -FAR_AWAY;
            }
            if passage.face >= ODD_BIN {
                break;
            }
            look.tried = passage;
            until = max(until, passage.far);
            let number = passage.face / 6u;
            cell = vec2u(number / grid.nk, number % grid.nk);
        }
        if try_from(track, cell, ray.base + look.n * ray.advance, frame.interpolation) {
            return pass_by(track, look.n - n);
        }
        if is_given || !(*track).solution.sure {
            break;
        }
    }
    let passed = pass_by(track, look.n - n);
    let more = find(track, ray.base + look.n * ray.advance, ray.advance, frame.interpolation);
    // Behind a cell the next one may begin before the next sample.
    return passed + select(more, min(more, LATER), BY_SEGMENT && leaves);
}

// Counts samples that lie in no cell.
fn pass_by(track: ptr<function, Track>, samples: f32) -> f32 {
    (*track).gap += samples;
    return samples;
}

// The first passage behind that of the last try whose cell may hold the sample, or one behind it.
fn next_passage(look: Look, track: ptr<function, Track>) -> Passage {
    let ray = look.ray;
    var at = look.n - 1.0;
    let place = (ray.base.xy + at * ray.advance.xy - grid.bin_origin) / grid.bin_size;
    let bins = vec2f(f32(grid.bins_x), f32(grid.bins_y));
    var bin = clamp(floor(place), vec2f(0.0), bins - vec2f(1.0));
    // From bin to bin: where the ray leaves this one along each axis, and samples across one.
    let speed = ray.advance.xy / grid.bin_size;
    let moves = abs(speed) > vec2f(1e-12);
    let safe = select(vec2f(1.0), speed, moves);
    let strides = select(vec2f(FAR_AWAY), abs(1.0 / safe), moves);
    let sides = select(bin, bin + vec2f(1.0), speed > vec2f(0.0));
    var ends = select(vec2f(FAR_AWAY), vec2f(at) + (sides - place) / safe, moves);
    var next = Passage(NO_FACE, FAR_AWAY, FAR_AWAY, 0.0);
    var looked = 0u;
    while looked < MOST_LOOKED {
        let end = min(ends.x, ends.y);
        let number = u32(bin.x) + grid.bins_x * u32(bin.y);
        if end >= look.n && (bin_words(number).x & BIN_IS_ODD) != 0u {
            next = Passage(ODD_BIN, at, at, 0.0);
            break;
        }
        let list = face_bins[number];
        looked += 1u + list.y - list.x;
        let depth_range = ray.base.z + vec2f(at, end) * ray.advance.z;
        for (var entry = list.x; entry < list.y; entry++) {
            let face = face_bins[entry];
            if are_apart(face.y, depth_range) {
                continue;
            }
            let passage = meet(look.frame, face.x);
            let may_hold = passage.far >= look.n || (passage.turn > 0.0 && passage.far >= look.n - 1.0);
            if may_hold && passage.near <= end && is_before(look.tried, passage) && is_before(passage, next) {
                next = passage;
            }
        }
        let along_x = ends.x < ends.y;
        bin += select(vec2f(0.0, sign(speed.y)), vec2f(sign(speed.x), 0.0), along_x);
        ends += select(vec2f(0.0, strides.y), vec2f(strides.x, 0.0), along_x);
        at = end;
        // Beyond the end of a ray that a plane cuts off its passages say whether that lies in a cell.
        if any(bin < vec2f(0.0)) || any(bin >= bins) {
            at = FAR_AWAY;
        }
        if next.face != NO_FACE || at == FAR_AWAY {
            break;
        }
    }
    (*track).work += looked;
    if next.face == NO_FACE {
        next.near = at;
    }
    return next;
}

fn is_before(a: Passage, b: Passage) -> bool {
    return a.near < b.near || (a.near == b.near && a.face < b.face);
}

// True where a depth range in 2 x 16 bits does not touch that between two depths.
fn are_apart(packed: u32, depths_between: vec2f) -> bool {
    let shallow = grid.depth_low + grid.depth_scale * f32(packed & 0xffffu);
    let deep = grid.depth_low + grid.depth_scale * f32(packed >> 16u);
    return deep < min(depths_between.x, depths_between.y) || shallow > max(depths_between.x, depths_between.y);
}

// Where the ray of a frame passes a face; nowhere, which is before all else, where it misses all of its triangles. The
// cell's own are 0 1 3 and 0 3 2; those along the other diagonal say how far a bent face may reach.
fn meet(r: RayFrame, number: u32) -> Passage {
    let column = number / 6u / grid.nk;
    let layer = number / 6u % grid.nk;
    let side = number % 6u;
    let pillars = pillar_index(column);
    let lists = column_lists(column);
    var q: array<vec3f, 4>;
    for (var n = 0u; n < 4u; n++) {
        let corner = face_corner(side, n);
        let depth = depth_at(list_entry(lists[corner & 3u], layer, corner >> 2u));
        q[n] = project(r, load_pillar(pillars[corner & 3u]), depth);
    }
    let a = cross2d(q[0], q[1]);
    let b = cross2d(q[1], q[3]);
    let c = cross2d(q[3], q[0]);
    let d = cross2d(q[3], q[2]);
    let e = cross2d(q[2], q[0]);
    let f = cross2d(q[1], q[2]);
    let first = hit(vec3f(b, c, a), vec3f(q[0].z, q[1].z, q[3].z));
    let second = hit(vec3f(d, e, -c), vec3f(q[0].z, q[3].z, q[2].z));
    let third = hit(vec3f(f, e, a), vec3f(q[0].z, q[1].z, q[2].z));
    let fourth = hit(vec3f(d, -f, b), vec3f(q[1].z, q[3].z, q[2].z));
    let low = min(min(first.x, second.x), min(third.x, fourth.x));
    let high = max(max(first.y, second.y), max(third.y, fourth.y));
    let way_out = face_orientation(side) * frame.grid_handedness;
    // Where both triangles are met, one each way, or neither, the cell does not begin or end there for sure.
    let turn = -way_out * sign(first.z + second.z);
    return Passage(number, low - PASSAGE_MARGIN, high + PASSAGE_MARGIN, turn);
}

// Place at which a ray meets a triangle, twice, and the sense in which that turns, from the sides on which it passes
// the edge across from each corner; an empty range where it does not.
fn hit(sides: vec3f, places: vec3f) -> vec3f {
    let is_inside = all(sides >= vec3f(0.0)) || all(sides <= vec3f(0.0));
    let sum = sides.x + sides.y + sides.z;
    if !is_inside || sum == 0.0 {
        return vec3f(FAR_AWAY, -FAR_AWAY, 0.0);
    }
    let place = dot(sides, places) / sum;
    return vec3f(place, place, sign(sum));
}
