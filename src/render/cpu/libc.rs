//! LIBC: linear interpolation with barycentric coordinates (campagnolo-2021, 4.1.2). The twin of `shaders/libc.wgsl`.
//!
//! From each boundary face at which a ray comes in, it walks from cell to cell through shared faces. Each face is two
//! triangles, cut along one diagonal for both of its cells; parameters are linear between the points of entry and exit.
//!
//! Corners are projected along the ray, so that it is the origin: edges are cross products, and a shared edge gives the
//! same number in each of its cells, so that no ray slips between two of them.
//! Departures from the paper: across a fault the cell behind is found by its column's depth lists, through collapsed
//! layers by the next one that is not; a segment can be integrated as a whole.

use glam::{Vec2, Vec3A, Vec4};

use super::each::Each;
use super::facing::{
    FacePlace, column_behind, face_corner, face_orientation, on_face, side_lists, sides_join,
};
use super::frame::{PixelRay, Ray};
use super::grid::{Grid, all_coincide};
use super::locate::{Query, locate};
use super::projection::{RayFrame, cross2d};
use super::raster::Met;
use super::samples::Samples;
use super::scene::Scene;
use super::section::SECTION_ENOUGH;
use super::segments::Span;
use super::surfaces::Layers;
use super::tally::Tally;
use super::thorough::encloses;
use super::transfer::Accumulated;
use crate::render::plan::layout::COLUMN_FLAG;
use crate::render::plan::list_entry;
use crate::scene::{Integration, LibcSettings};

/// Steps without progress after which a ray is set right by point location.
const MOST_STALLS: u32 = 32;
/// Recoveries of one ray after which it counts as lost.
const MOST_RECOVERIES: u32 = 1000;

/// A boundary face through which a ray comes in.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    distance: f32,
    face: u32,
}

/// The entries of a ray, nearest first.
pub fn gather(met: &[Met], through: &PixelRay, entries: &mut Vec<Entry>) {
    let of = |m: &Met| {
        let (depth, _) = m.point.filter(|(_, turn)| *turn > 0)?;
        Some(Entry {
            distance: (depth * f64::from(through.slant)) as f32,
            face: m.face,
        })
    };
    entries.clear();
    entries.extend(met.iter().filter_map(of));
    entries.sort_unstable_by(|a, b| {
        let order = a.distance.total_cmp(&b.distance);
        order.then(a.face.cmp(&b.face))
    });
}

/// What a ray walks through.
pub struct Way<'a> {
    /// What all rays read.
    pub scene: &'a Scene<'a>,
    /// The ray.
    pub ray: &'a Ray,
    /// Its entries.
    pub entries: &'a [Entry],
    /// What the user chose.
    pub settings: LibcSettings,
    /// How far before the end of what is done the next entry may lie: faces of a fault need not meet.
    pub margin: f32,
}

/// What a ray is about to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    NeedsEntry,
    Walks,
    /// Stands at a fault, behind which a cell is to be found.
    CrossesFault,
    /// Found no way out of its cell.
    Strayed,
    Ended,
}

/// Where a ray has come to.
struct Walk<'a> {
    way: &'a Way<'a>,
    r: RayFrame,
    corners: Corners,
    phase: Phase,
    column: u32,
    layer: u32,
    /// Distance along the ray and parameters at which the current cell was entered.
    t: f32,
    uvw: Vec3A,
    /// Face through which the last cell was left.
    exit_face: u32,
    /// Distance up to which the ray is done.
    done: f32,
    /// Next sample of the lattice.
    n: f32,
    /// The next entry.
    entry: usize,
    peels: u64,
    recoveries: u32,
    /// Steps in a row that have brought the ray no further.
    stalls: u32,
}

/// Adds what a ray meets to what is there.
pub fn cast(way: &Way<'_>, layers: &mut Layers, sum: &mut Accumulated, tally: &mut Tally) {
    let ray = way.ray;
    if ray.leave <= ray.enter {
        return;
    }
    let t = ray.enter.max(0.0);
    let mut walk = Walk {
        way,
        r: RayFrame::at(ray.at(t), ray.direction, t),
        corners: Corners::default(),
        phase: Phase::NeedsEntry,
        column: 0,
        layer: 0,
        t: ray.enter,
        uvw: Vec3A::ZERO,
        exit_face: 0,
        done: ray.enter,
        n: 0.0,
        entry: 0,
        peels: 0,
        recoveries: 0,
        stalls: 0,
    };
    if ray.starts_inside {
        walk.locate_again(tally);
        tally.entries += u64::from(walk.phase == Phase::Walks);
    }
    while walk.phase != Phase::Ended && walk.recoveries <= MOST_RECOVERIES {
        match walk.phase {
            Phase::NeedsEntry => walk.enter(tally),
            Phase::Walks => walk.step(layers, sum, tally),
            Phase::CrossesFault => walk.cross_fault(),
            Phase::Strayed => walk.set_right(tally),
            Phase::Ended => {}
        }
    }
    tally.lost_rays += u64::from(walk.recoveries > MOST_RECOVERIES);
    tally.peels = tally.peels.max(walk.peels);
}

impl Walk<'_> {
    fn grid(&self) -> &Grid {
        self.way.scene.grid
    }

    /// Takes the next entry; a ray without one has ended.
    fn enter(&mut self, tally: &mut Tally) {
        let first = self.done - self.way.margin;
        let left = self.way.entries.iter().skip(self.entry);
        let passed = left.take_while(|e| e.distance < first).count();
        let Some(entry) = self.way.entries.get(self.entry + passed) else {
            self.phase = Phase::Ended;
            return;
        };
        self.entry += passed + 1;
        self.peels += 1;
        tally.entries += 1;
        let place = FacePlace::of(entry.face, self.grid().nk());
        self.come_into(place.column, place.layer);
        let (t, at) = self
            .corners
            .enter_through(place.side, self.sense(place.side));
        self.t = t;
        self.uvw = on_face(place.side, at);
    }

    /// Goes on in a cell.
    fn come_into(&mut self, column: u32, layer: u32) {
        self.phase = Phase::Walks;
        self.column = column;
        self.layer = layer;
        self.corners
            .project(self.way.scene.grid, &self.r, column, layer);
    }

    /// Sign that the triangles of a face have where the ray comes in.
    fn sense(&self, face: u32) -> f32 {
        -self.way.scene.frame.numbers.grid_handedness * face_orientation(face)
    }

    /// Through the current cell, and into the one behind its exit.
    fn step(&mut self, layers: &mut Layers, sum: &mut Accumulated, tally: &mut Tally) {
        tally.steps += 1;
        let handedness = self.way.scene.frame.numbers.grid_handedness;
        let exit = self.corners.exit(handedness);
        let is_stalled = exit.as_ref().is_none_or(|exit| exit.t <= self.t);
        self.stalls = if is_stalled { self.stalls + 1 } else { 0 };
        let Some(exit) = exit.filter(|_| self.stalls <= MOST_STALLS) else {
            self.phase = Phase::Strayed;
            return;
        };
        let uvw = on_face(exit.face, exit.at);
        let t = exit.t.max(self.t);
        self.integrate(t, uvw, layers, sum, tally);
        self.t = t;
        self.done = t;
        self.uvw = uvw;
        self.exit_face = exit.face;
        tally.crossings += 1;
        let ray = self.way.ray;
        if !self.way.scene.transfer.is_open(sum) || self.n >= ray.count || t >= ray.leave {
            self.phase = Phase::Ended;
        } else {
            self.step_through();
        }
    }

    /// Moves the ray into the cell behind its exit, to the fault there, or to where it needs an entry.
    fn step_through(&mut self) {
        let grid = self.way.scene.grid;
        let face = self.exit_face;
        let (column, layer) = (self.column, self.layer);
        self.phase = Phase::NeedsEntry;
        if face >= 4 {
            if let Some(next) = next_layer(self.way, column, layer, face & 1) {
                self.uvw.z = 1.0 - self.uvw.z;
                self.come_into(column, next);
            }
            return;
        }
        let Some(next) = column_behind(grid, column, face) else {
            return;
        };
        let [mine, theirs] = [column, next].each(|c| grid.lists(c));
        let sides = [side_lists(mine, face), side_lists(theirs, face ^ 1)];
        if sides_join(grid, sides[0], sides[1], layer) {
            if self.way.scene.is_met(next, layer) {
                let axis = (face >> 1) as usize;
                self.uvw[axis] = 1.0 - self.uvw[axis];
                self.come_into(next, layer);
            }
        } else if self.way.settings.cross_faults && theirs[0] & COLUMN_FLAG == 0 {
            self.phase = Phase::CrossesFault;
        }
    }

    /// Enters the cell of the next column that the ray meets at a fault: the layer whose upper and lower edge have the
    /// ray between them. Where there is none the ray needs an entry.
    fn cross_fault(&mut self) {
        self.phase = Phase::NeedsEntry;
        let grid = self.way.scene.grid;
        let Some(next) = column_behind(grid, self.column, self.exit_face) else {
            return;
        };
        let face = self.exit_face ^ 1;
        // Edges have the sense of the face that was left.
        let sense = -self.sense(self.exit_face);
        let lists = side_lists(grid.lists(next), face);
        let pillars = grid.pillars(next);
        let [a, b] = [0, 1].each(|n| pillars[face_corner(face, n) as usize]);
        let is_below = |layer: u32, bottom: u32| {
            let depth = |list: u32| grid.depth(list_entry(list, layer, bottom));
            let p = self.r.project(&a, depth(lists[0]));
            let q = self.r.project(&b, depth(lists[1]));
            sense * cross2d(p, q) > 0.0
        };
        let (mut low, mut high) = (0, grid.nk());
        while low < high {
            let middle = (low + high) / 2;
            if is_below(middle, 1) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        if low < grid.nk() && self.way.scene.is_met(next, low) && is_below(low, 0) {
            self.come_into(next, low);
            let (_, at) = self.corners.enter_through(face, self.sense(face));
            self.uvw = on_face(face, at);
        }
    }

    /// Finds by point location a ray that found no way out of its cell.
    fn set_right(&mut self, tally: &mut Tally) {
        let (grid, ray) = (self.way.scene.grid, self.way.ray);
        let step = self.way.scene.frame.numbers.step;
        let cell = super::cell::Cell::load(grid, self.column, self.layer);
        tally.recovered += 1;
        self.t += 0.25 * step;
        self.locate_again(tally);
        // The next sample is lost where the ray has no cell, and yet the last one holds the sample.
        let n = self.n.max((self.t / step - 0.5).ceil() - ray.first);
        let holds = || encloses(&cell, cell.relative_to(ray.sample(n)));
        if self.phase != Phase::Walks && n < ray.count && holds() {
            tally.lost_samples += 1;
        }
    }

    /// Locates the ray at its distance; it walks on in its cell, or needs an entry where there is none.
    fn locate_again(&mut self, tally: &mut Tally) {
        let query = Query {
            point: self.way.ray.at(self.t),
            low_bits: Vec3A::ZERO,
            enough: SECTION_ENOUGH,
        };
        let location = locate(self.way.scene.grid, query, Vec3A::ZERO);
        tally.locations += 1;
        tally.iterations += u64::from(location.iterations);
        self.done = self.done.max(self.t);
        self.stalls = 0;
        self.recoveries += 1;
        self.phase = Phase::NeedsEntry;
        if let Some((cell, solution)) = location.found {
            self.come_into(cell.column, cell.layer);
            self.uvw = solution.uvw.clamp(Vec3A::ZERO, Vec3A::ONE);
        }
    }

    /// Adds what lies between the current place of the ray and its exit at distance `t`. Surfaces lie on faces, so those
    /// that are nearer than the exit lie at the entry, and what is opaque ends the ray.
    fn integrate(
        &mut self,
        t: f32,
        uvw: Vec3A,
        layers: &mut Layers,
        sum: &mut Accumulated,
        tally: &mut Tally,
    ) {
        let (scene, ray) = (self.way.scene, self.way.ray);
        layers.blend_surfaces_until(scene, sum, 0.5 * (self.t + t.min(ray.leave)));
        let is_ghost = scene.grid.is_ghost(self.column, self.layer);
        if self.way.settings.integration == Integration::Segments {
            let from = self.t.max(self.done).max(ray.enter);
            let to = t.min(ray.leave);
            if to <= from {
                return;
            }
            let span = Span {
                scene,
                ray,
                from,
                to,
            };
            let segment = self.segment(t, uvw);
            tally.samples += span.add(is_ghost, sum, |t| segment.values(t));
            return;
        }
        // Samples from the first one at or behind the entry to the last one before the exit.
        let step = scene.frame.numbers.step;
        let until = |t: f32| (t / step - 0.5).ceil() - ray.first;
        let end = until(t).min(ray.count);
        let first = self.n.max(until(self.t));
        let count = end - first;
        self.n = self.n.max(end);
        if count <= 0.0 {
            return;
        }
        let samples = Samples {
            scene,
            ray,
            first,
            count,
        };
        let taken = match scene.entry_of(self.column, self.layer) {
            Some(entry) => samples.of_one(entry, is_ghost, layers, sum),
            None => {
                let segment = self.segment(t, uvw);
                let distance = |n: Vec4| (ray.first + n + 0.5) * step;
                samples.by_value(layers, sum, |n| segment.values(distance(n)))
            }
        };
        tally.samples += taken as u64;
    }

    /// The values from where the current cell was entered to an exit.
    fn segment(&self, t: f32, uvw: Vec3A) -> Segment {
        let [top, bottom] = self.grid().corner_values(self.column, self.layer);
        Segment {
            t: self.t,
            length: (t - self.t).max(1e-20),
            uvw: self.uvw,
            along: uvw - self.uvw,
            top,
            bottom,
        }
    }
}

/// The layer below (`bottom` 1) or above that the ray comes into.
fn next_layer(way: &Way<'_>, column: u32, layer: u32, bottom: u32) -> Option<u32> {
    let grid = way.scene.grid;
    let lists = grid.lists(column);
    let mut at = layer;
    loop {
        let next = match bottom {
            0 => at.checked_sub(1)?,
            _ => at + 1,
        };
        if next >= grid.nk() || !grid.layers_join(lists, at.min(next)) {
            return None;
        }
        if way.scene.is_met(column, next) {
            return Some(next);
        }
        // A layer without thickness hides nothing; what is behind it joins.
        let [top, bottom] = grid.corner_depths(lists, next);
        if !way.settings.cross_faults || !all_coincide(top, bottom) {
            return None;
        }
        at = next;
    }
}

/// Where a ray leaves a cell.
struct Exit {
    t: f32,
    face: u32,
    /// Parameters on the face along its two axes.
    at: Vec2,
}

/// Corners of a cell relative to the ray, the four of its top and the four of its bottom: two coordinates across the
/// ray and the distance along it.
#[derive(Default)]
struct Corners {
    /// Pillars of a column as the ray sees them: where they are at depth 0, and their change per unit of depth.
    pillars: Option<(u32, [[Vec4; 2]; 3])>,
    x: [Vec4; 2],
    y: [Vec4; 2],
    z: [Vec4; 2],
}

impl Corners {
    fn project(&mut self, grid: &Grid, r: &RayFrame, column: u32, layer: u32) {
        let known = self.pillars.filter(|(known, _)| *known == column);
        let (_, pillars) = *self.pillars.insert(match known {
            Some(known) => known,
            None => (column, pillars_of(grid, r, column)),
        });
        let lists = grid.lists(column);
        let depths = grid.corner_depths(lists, layer);
        let [x, y, z] = pillars.each(|[at, slope]| depths.each(|depth| at + depth * slope));
        (self.x, self.y, self.z) = (x, y, z);
    }

    /// Where the ray leaves, at the farthest of all exits.
    fn exit(&self, handedness: f32) -> Option<Exit> {
        let sides = self.sides(handedness);
        let mut best: Option<Exit> = None;
        for (group, first_face) in sides.iter().zip([0, 4]) {
            let [first, second] = group.left();
            let mut left = first | second;
            while left != 0 {
                let lane = left.trailing_zeros();
                left &= left - 1;
                let face = first_face + lane;
                let is_first = first >> lane & 1 == 1;
                let exit = self.leave(face, group.of(lane as usize), is_first);
                best = match (best, exit) {
                    (Some(best), Some(exit)) if exit.t <= best.t => Some(best),
                    (best, exit) => exit.or(best),
                };
            }
        }
        best
    }

    /// Twice the areas that the ray and the edges and diagonals of faces span: of the lateral faces, then of top and
    /// bottom.
    fn sides(&self, h: f32) -> [Sides; 2] {
        let ([xt, xb], [yt, yb]) = (self.x, self.y);
        let area = |[ax, ay]: [Vec4; 2], [bx, by]: [Vec4; 2]| ax * by - ay * bx;
        // Of edges along u 01, 23, 45, 67, along v 02, 13, 46, 57, and along w 04, 15, 26, 37.
        let lanes = |t: Vec4, b: Vec4, [i, j]: [usize; 2]| Vec4::new(t[i], t[j], b[i], b[j]);
        let pick = |n: [usize; 2]| [lanes(xt, xb, n), lanes(yt, yb, n)];
        let u = area(pick([0, 2]), pick([1, 3]));
        let v = area(pick([0, 1]), pick([2, 3]));
        let w = area([xt, yt], [xb, yb]);
        // Of diagonals 06, 17, 05, 27, and 03, 47.
        let lateral = area(
            [xt, yt].each(|top| Vec4::new(top.x, top.y, top.x, top.z)),
            [xb, yb].each(|bottom| Vec4::new(bottom.z, bottom.w, bottom.y, bottom.w)),
        );
        let flat = area(pick([0, 0]), pick([3, 3]));
        [
            Sides {
                e0: Vec4::new(v.x, v.y, u.x, u.y),
                e1: Vec4::new(w.z, w.w, w.y, w.w),
                d: lateral,
                f: Vec4::new(v.z, v.w, u.z, u.w),
                g: Vec4::new(w.x, w.y, w.x, w.z),
            }
            .turned(Vec4::new(-h, h, h, -h)),
            Sides {
                e0: Vec4::new(u.x, u.z, 0.0, 0.0),
                e1: Vec4::new(v.y, v.w, 0.0, 0.0),
                d: Vec4::new(flat.x, flat.z, 0.0, 0.0),
                f: Vec4::new(u.y, u.w, 0.0, 0.0),
                g: Vec4::new(v.x, v.z, 0.0, 0.0),
            }
            .turned(Vec4::new(-h, h, 0.0, 0.0)),
        ]
    }

    /// Where the ray leaves through a triangle of a face.
    fn leave(&self, face: u32, [e0, e1, d, f, g]: [f32; 5], is_first: bool) -> Option<Exit> {
        let z = |n: u32| self.depth(face_corner(face, n));
        let (sum, t, at) = match is_first {
            true => (
                e0 + e1 - d,
                e1 * z(0) - d * z(1) + e0 * z(3),
                Vec2::new(e0 - d, e0),
            ),
            false => (
                d - f - g,
                d * z(2) - f * z(0) - g * z(3),
                Vec2::new(-g, d - g),
            ),
        };
        (sum > 0.0).then(|| Exit {
            t: t / sum,
            face,
            at: at / sum,
        })
    }

    fn depth(&self, corner: u32) -> f32 {
        self.z[(corner >> 2) as usize][(corner & 3) as usize]
    }

    fn corner(&self, corner: u32) -> Vec3A {
        let (layer, n) = ((corner >> 2) as usize, (corner & 3) as usize);
        Vec3A::new(self.x[layer][n], self.y[layer][n], self.z[layer][n])
    }

    /// Distance and parameters on a face of the point at which a ray comes in, clamped into the face.
    fn enter_through(&self, face: u32, sense: f32) -> (f32, Vec2) {
        let [q00, q10, q01, q11] = [0, 1, 2, 3].each(|n| self.corner(face_corner(face, n)));
        let e0 = (sense * cross2d(q00, q10)).max(0.0);
        let e1 = (sense * cross2d(q10, q11)).max(0.0);
        let d = sense * cross2d(q00, q11);
        let f = (-sense * cross2d(q01, q11)).max(0.0);
        let g = (-sense * cross2d(q00, q01)).max(0.0);
        if d <= 0.0 {
            let sum = (e0 + e1 - d).max(1e-30);
            let t = (e1 * q00.z - d * q10.z + e0 * q11.z) / sum;
            return (t, Vec2::new(e0 - d, e0) / sum);
        }
        let sum = (d + f + g).max(1e-30);
        let t = (d * q01.z + f * q00.z + g * q11.z) / sum;
        (t, Vec2::new(g, d + g) / sum)
    }
}

/// Pillars of a column as a ray sees them: x, y and distance, of the four of them.
fn pillars_of(grid: &Grid, r: &RayFrame, column: u32) -> [[Vec4; 2]; 3] {
    let pillars = grid.pillars(column).each(|pillar| {
        let at = r.project(&pillar, 0.0);
        [at, r.turned(pillar.slope.extend(1.0).into())]
    });
    [0, 1, 2].each(|axis| {
        [0, 1].each(|what| Vec4::from_array(pillars.each(|pillar: [Vec3A; 2]| pillar[what][axis])))
    })
}

/// Of up to four faces, on which side of their edges and diagonals the ray passes: of the pairs of corners 00 10,
/// 10 11, 00 11, 01 11 and 00 01, with the sign that triangles have on the way out.
struct Sides {
    e0: Vec4,
    e1: Vec4,
    d: Vec4,
    f: Vec4,
    g: Vec4,
}

impl Sides {
    fn turned(self, sense: Vec4) -> Self {
        Self {
            e0: sense * self.e0,
            e1: sense * self.e1,
            d: sense * self.d,
            f: sense * self.f,
            g: sense * self.g,
        }
    }

    /// One bit a face through whose first triangle the ray leaves, and through whose second one.
    fn left(&self) -> [u32; 2] {
        let zero = Vec4::ZERO;
        let first = self.e0.cmpge(zero) & self.e1.cmpge(zero) & self.d.cmple(zero);
        let second = self.d.cmpge(zero) & self.f.cmple(zero) & self.g.cmple(zero);
        [first.bitmask(), second.bitmask()]
    }

    fn of(&self, lane: usize) -> [f32; 5] {
        [
            self.e0[lane],
            self.e1[lane],
            self.d[lane],
            self.f[lane],
            self.g[lane],
        ]
    }
}

/// The value along a segment: trilinear at parameters that are linear in the distance.
struct Segment {
    t: f32,
    length: f32,
    uvw: Vec3A,
    along: Vec3A,
    top: Vec4,
    bottom: Vec4,
}

impl Segment {
    /// Values at four distances.
    #[inline]
    fn values(&self, t: Vec4) -> Vec4 {
        let s = ((t - self.t) / self.length).clamp(Vec4::ZERO, Vec4::ONE);
        let [u, v, w] = [0, 1, 2].each(|axis| self.uvw[axis] + s * self.along[axis]);
        let (top, change) = (self.top, self.bottom - self.top);
        let [c0, c1, c2, c3] = [0, 1, 2, 3].each(|corner| top[corner] + w * change[corner]);
        let low = c0 + u * (c1 - c0);
        let high = c2 + u * (c3 - c2);
        low + v * (high - low)
    }
}
