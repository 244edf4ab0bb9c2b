//! Samples of a ray, each from the one before it: in the same cell, then in the neighbor across the face that the
//! result overshoots most, then in the cell of a boundary face that the ray has passed, and through the acceleration
//! grid where all that does not help (campagnolo-2021, 4.1.3). The twin of `shaders/shared/topology.wgsl`,
//! and of `boundary.wgsl` and `ways.wgsl` there.

use glam::{Vec3A, Vec4};

use super::boundary::{Boundary, Passage};
use super::cell::{Cell, Solution};
use super::each::Each;
use super::facing::{FacePlace, column_behind, side_lists, sides_join};
use super::frame::Ray;
use super::grid::Grid;
use super::locate::{Query, is_odd, locate};
use super::tally::Tally;
use super::thorough::encloses;
use crate::render::plan::layout::COLUMN_FLAG;

const TOPOLOGICAL_LIMIT: u32 = 6;
/// Newton steps below this end the iteration while marching; the error left is of its square.
const MARCH_ENOUGH: f32 = 1e-2;
/// Cells of boundary faces that are tried for a sample, at most.
const MOST_TRIED: usize = 4;
/// How far behind the face that it seems to begin at a cell is looked for again, in samples.
const LATER: f32 = 0.1;
/// Surely past a face, in samples.
const PAST_FACE: f32 = 1e-2;
/// A sample that seems to be so far outside of a cell is looked for in the neighbor at once.
const SURELY_OUTSIDE: f32 = 0.02;
/// Ends of a way that are tried; halves of it where a cell is bent.
const MOST_TRIES: usize = 8;
/// Parameters so near to a face that the rest is straight.
const AT_FACE: f32 = 0.03;
/// Samples are interpolated between two of a cell where parameters are off a straight line by less than this.
const MOST_BENT: f32 = 0.2;

/// Where a ray's samples have come to.
pub struct Track<'a> {
    grid: &'a Grid,
    ray: &'a Ray,
    /// Bits of the cells that it meets, where these are not all drawn cells.
    visible: Option<&'a [u32]>,
    /// Where it passes the boundary; `None` where nothing is known of that, and all is searched.
    boundary: Option<&'a Boundary>,
    /// The cell of the current sample, and where in it that is.
    cell: Cell,
    solution: Solution,
    /// Change of the parameters from a sample to the next.
    rate: Vec3A,
    /// The last way has ended at a face of its cell.
    at_face: bool,
    /// The cell that was counted last.
    last: Option<(u32, u32)>,
    /// Samples found in no cell since the last one that was found.
    gap: f32,
    /// What that has cost.
    pub tally: &'a mut Tally,
}

/// Samples in one cell, or the way through it: places are numbers of samples, and parts of them.
pub struct Stretch {
    /// The first.
    pub first: f32,
    /// How much more there is.
    pub more: f32,
    from: Vec3A,
    to: Vec3A,
    from_rate: Vec3A,
    to_rate: Vec3A,
}

impl Stretch {
    /// Parameters u, v and w of four samples by their numbers, a cubic between the ends.
    pub fn parameters(&self, n: Vec4) -> [Vec4; 3] {
        let length = if self.more > 0.0 { self.more } else { 1.0 };
        let s = (n - self.first) / length;
        let [m0, m1] = [self.from_rate, self.to_rate].each(|rate| self.more * rate);
        let way = self.to - self.from;
        let (square, cube) = (3.0 * way - 2.0 * m0 - m1, m0 + m1 - 2.0 * way);
        [0, 1, 2]
            .each(|axis| self.from[axis] + s * (m0[axis] + s * (square[axis] + s * cube[axis])))
    }
}

impl<'a> Track<'a> {
    /// A ray before its first sample.
    pub fn new(
        grid: &'a Grid,
        visible: Option<&'a [u32]>,
        ray: &'a Ray,
        boundary: &'a Boundary,
        tally: &'a mut Tally,
    ) -> Self {
        Self {
            visible,
            boundary: Some(boundary),
            ..Self::through(grid, ray, tally)
        }
    }

    /// A ray of which nothing is known, before its first sample.
    pub fn through(grid: &'a Grid, ray: &'a Ray, tally: &'a mut Tally) -> Self {
        Self {
            grid,
            ray,
            visible: None,
            boundary: None,
            cell: Cell::default(),
            solution: Solution::default(),
            rate: Vec3A::ZERO,
            at_face: false,
            last: None,
            gap: 0.0,
            tally,
        }
    }

    /// The cell of the current samples.
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// The samples in the cell that sample `n` or the first one behind it lies in; `None` where there are no more.
    /// `is_next` says that the samples before `n` were the last stretch.
    pub fn next(&mut self, mut n: f32, is_next: bool) -> Option<Stretch> {
        if n >= self.ray.count {
            return None;
        }
        if !(is_next && self.follow(n) && !self.layers_cross()) {
            // The last sample of which it is known where it lies.
            let mut known = if is_next { n - 1.0 } else { f32::MIN };
            loop {
                let passed = self.find(n, known);
                if passed == 0.0 {
                    break;
                }
                known = n;
                n = (n + passed).ceil();
                self.gap += n - known;
                if n >= self.ray.count {
                    return None;
                }
            }
        }
        self.arrive();
        Some(self.stretch(n))
    }

    /// True where layers of the current column cross: a point of several cells belongs to the first of them, so that
    /// each sample has to be located.
    fn layers_cross(&self) -> bool {
        self.grid.lists(self.cell.column)[0] & COLUMN_FLAG != 0
    }

    /// Counts the cell where the ray has come into it.
    fn arrive(&mut self) {
        let enters = self.last.is_none() || self.gap > 0.0;
        let here = (self.cell.column, self.cell.layer);
        self.tally.entries += u64::from(enters);
        self.tally.crossings += u64::from(enters || self.last != Some(here));
        self.last = Some(here);
        self.gap = 0.0;
    }

    /// The samples from `n` on that lie in its cell.
    fn stretch(&mut self, n: f32) -> Stretch {
        let from = self.solution.uvw;
        let from_rate = self.cell.parameters_along(from, self.ray.advance);
        self.rate = from_rate;
        let mut stretch = Stretch {
            first: n,
            more: 0.0,
            from,
            to: from,
            from_rate,
            to_rate: from_rate,
        };
        let left = match self.layers_cross() {
            true => 0.0,
            false => self.ray.count - 1.0 - n,
        };
        let mut ahead = steps_inside(from, from_rate).min(left);
        for _ in 0..2 {
            if ahead < 1.0 {
                break;
            }
            let expected = from + ahead * from_rate;
            let s = self.solve(n + ahead, expected);
            if s.inside && (s.uvw - expected).abs().max_element() < MOST_BENT {
                self.solution = s;
                self.rate = self.cell.parameters_along(s.uvw, self.ray.advance);
                stretch.more = ahead;
                stretch.to = s.uvw;
                stretch.to_rate = self.rate;
                break;
            }
            ahead = match s.inside {
                true => (0.5 * ahead).floor(),
                false => steps_inside(from, (s.uvw - from) / ahead).min(ahead - 1.0),
            };
        }
        stretch
    }

    /// The way through the cell that the ray is in at a place, or comes into behind it; a part of that way where the
    /// cell is bent. `None` where there is none. `joins` says that the ray came there by the way before.
    pub fn cross(&mut self, mut from: f32, joins: bool) -> Option<Stretch> {
        if !joins {
            from = self.enter(from)?;
        }
        self.arrive();
        let start = self.solution.uvw;
        let rate = self.cell.parameters_along(start, self.ray.advance);
        let mut stretch = Stretch {
            first: from,
            more: steps_to_face(start, rate).max(0.0),
            from: start,
            to: start,
            from_rate: rate,
            to_rate: rate,
        };
        self.at_face = false;
        let mut expected = start + stretch.more * rate;
        for _ in 0..MOST_TRIES {
            let reached = self.solve(from + stretch.more, expected);
            let is_near = (reached.uvw - expected).abs().max_element() < MOST_BENT;
            stretch.to = reached.uvw;
            stretch.to_rate = self.cell.parameters_along(reached.uvw, self.ray.advance);
            let off = steps_to_face(reached.uvw, stretch.to_rate);
            let left = off * stretch.to_rate;
            let most_left = left.abs().max_element();
            // What that leaves is of its square.
            self.at_face = is_near && most_left < AT_FACE;
            if self.at_face {
                stretch.more = (stretch.more + off).max(0.0);
                stretch.to += left;
            }
            if self.at_face || (is_near && reached.inside) {
                self.solution.uvw = stretch.to;
                return Some(stretch);
            }
            if is_near && most_left < MOST_BENT {
                stretch.more = (stretch.more + off).max(0.0);
                expected = stretch.to + left;
            } else {
                stretch.more *= 0.5;
                expected = start + stretch.more * rate;
            }
        }
        // Too bent to be followed: the next place is looked for.
        self.at_face = true;
        (stretch.to, stretch.to_rate) = (start + stretch.more * rate, rate);
        self.solution.uvw = Vec3A::splat(0.5);
        Some(stretch)
    }

    /// Goes on where a way has ended, in the same cell or through its face; false where no cell joins there.
    pub fn leave(&mut self) -> bool {
        if !self.at_face {
            return true;
        }
        let mut start = self.solution.uvw;
        let joins = self.step_to_neighbor(&mut start);
        self.tally.steps += u64::from(joins);
        self.solution.uvw = start.clamp(Vec3A::ZERO, Vec3A::ONE);
        joins
    }

    /// Finds the cell that the ray comes into at a place or behind it, and where it does.
    fn enter(&mut self, from: f32) -> Option<f32> {
        // At the face itself the cell that was left seems to hold the ray still.
        let (mut n, mut known) = (from + PAST_FACE, from);
        let mut tries = 0;
        loop {
            let passed = self.find(n, known);
            if passed == 0.0 {
                break;
            }
            // Behind a bent face the cell may begin a little later.
            let begins = tries < MOST_TRIES && self.boundary.is_some_and(|b| b.depth(n) > 0);
            let passed = if begins { passed.min(LATER) } else { passed };
            tries = if begins { tries + 1 } else { 0 };
            self.gap += passed;
            known = n;
            n += passed;
            if n >= self.ray.count {
                return None;
            }
        }
        let found = self.solution.uvw;
        let rate = self.cell.parameters_along(found, self.ray.advance);
        let back = steps_to_face(found, -rate).clamp(0.0, n - from);
        self.solution.uvw = (found - back * rate).clamp(Vec3A::ZERO, Vec3A::ONE);
        Some(n - back)
    }

    /// Newton in the current cell.
    fn solve(&mut self, n: f32, start: Vec3A) -> Solution {
        let point = self.cell.relative_to(self.ray.sample(n));
        let s = self.cell.solve(point, start, MARCH_ENOUGH);
        self.tally.iterations += u64::from(s.iterations);
        s
    }

    /// Goes on to a sample from the one before it; false where the cells do not join.
    fn follow(&mut self, n: f32) -> bool {
        let start = self.solution.uvw + self.rate;
        let start = start.clamp(Vec3A::splat(-1.0), Vec3A::splat(2.0));
        let is_near = overshoot(start) < SURELY_OUTSIDE;
        self.walk(n, start, is_near)
    }

    /// Looks for a sample in the current cell and in those that join. `is_near` says that it may lie in this one.
    fn walk(&mut self, n: f32, mut start: Vec3A, is_near: bool) -> bool {
        for attempt in 0..=TOPOLOGICAL_LIMIT {
            if attempt > 0 || is_near {
                let s = self.solve(n, start);
                self.solution = s;
                if s.inside {
                    return true;
                }
                start = s.uvw;
            }
            if attempt == TOPOLOGICAL_LIMIT || !self.step_to_neighbor(&mut start) {
                break;
            }
            self.tally.steps += 1;
        }
        false
    }

    /// Loads the drawn cell that shares the whole face which `uvw` overshoots most; `uvw` becomes a start in it. False
    /// where the cells do not join: hull, fault, gap, a cell that is not drawn.
    fn step_to_neighbor(&mut self, uvw: &mut Vec3A) -> bool {
        let grid = self.grid;
        let q = *uvw;
        let axis = (-q).max(q - Vec3A::ONE).max_position();
        let plus = q[axis] > 0.5;
        let face = 2 * axis as u32 + u32::from(plus);
        let Some((column, layer)) = self.behind(face) else {
            return false;
        };
        self.cell = Cell::load(grid, column, layer);
        let mut start = q;
        start[axis] = if plus { q[axis] - 1.0 } else { q[axis] + 1.0 };
        *uvw = start.clamp(Vec3A::splat(-1.0), Vec3A::splat(2.0));
        true
    }

    /// The cell behind a face of the current one, where rays meet it and it shares the whole face.
    fn behind(&self, face: u32) -> Option<(u32, u32)> {
        let (grid, Cell { column, layer, .. }) = (self.grid, self.cell);
        let is_met = |column, layer| grid.is_met(self.visible, column, layer);
        let lists = grid.lists(column);
        if face < 4 {
            let next = column_behind(grid, column, face)?;
            let theirs = side_lists(grid.lists(next), face ^ 1);
            let joins = || sides_join(grid, side_lists(lists, face), theirs, layer);
            return (is_met(next, layer) && joins()).then_some((next, layer));
        }
        let next = match face & 1 {
            0 => layer.checked_sub(1)?,
            _ => layer + 1,
        };
        let joins = || grid.layers_join(lists, layer.min(next));
        (next < grid.nk() && is_met(column, next) && joins()).then_some((column, next))
    }

    /// Finds a sample that no neighbor has, `known` being the last one of which it is known where it lies. Where it
    /// lies in no cell, so do as many samples as are returned, this one included; else 0.
    fn find(&mut self, n: f32, known: f32) -> f32 {
        let point = self.ray.sample(n);
        let before = (self.last.is_some() && self.gap == 0.0).then_some(self.cell);
        let Some(boundary) = self.boundary else {
            return self.search(point, before);
        };
        let passed = boundary.until(n);
        let may_hold = |p: &&Passage| p.far >= n || (p.turn > 0 && p.far >= known);
        let mut in_doubt = before.is_some() && self.layers_cross();
        if !in_doubt {
            for passage in passed.iter().rev().filter(may_hold).take(MOST_TRIED) {
                let FacePlace { column, layer, .. } = FacePlace::of(passage.face, self.grid.nk());
                self.cell = Cell::load(self.grid, column, layer);
                let found = self.walk(n, Vec3A::splat(0.5), true);
                if found && !self.layers_cross() {
                    return 0.0;
                }
                in_doubt |= found || !self.solution.sure;
            }
        }
        if !in_doubt
            && boundary.depth(n) == 0
            && !(boundary.surrounds(n) && is_odd(self.grid, point))
        {
            return boundary.next(n).map_or(f32::MAX, |next| next - n);
        }
        self.search(point, before)
    }

    /// Searches for the cell of a sample; `before` is that of the one before it. Returns as [`Self::find`].
    fn search(&mut self, point: Vec3A, before: Option<Cell>) -> f32 {
        let query = Query {
            point,
            low_bits: Vec3A::ZERO,
            enough: MARCH_ENOUGH,
        };
        let location = locate(self.grid, query, self.ray.advance);
        self.tally.locations += 1;
        self.tally.iterations += u64::from(location.iterations);
        if let Some((cell, solution)) = location.found {
            self.cell = cell;
            self.solution = solution;
            return 0.0;
        }
        let holds = |cell: &Cell| encloses(cell, cell.relative_to(point));
        let is_lost = location.is_lost || before.is_some_and(|cell| holds(&cell));
        self.tally.lost_samples += u64::from(is_lost);
        location.skip
    }
}

/// How far parameters are outside of a cell.
fn overshoot(q: Vec3A) -> f32 {
    (-q).max(q - Vec3A::ONE).max_element()
}

/// Whole steps of a change that parameters can make before they leave a cell.
fn steps_inside(q: Vec3A, rate: Vec3A) -> f32 {
    steps_to_face(q, rate).max(0.0).trunc()
}

/// Steps of a change up to where parameters leave a cell; negative where they have left it.
fn steps_to_face(q: Vec3A, rate: Vec3A) -> f32 {
    let room = Vec3A::select(rate.cmpgt(Vec3A::ZERO), Vec3A::ONE - q, q);
    let steps = room / rate.abs().max(Vec3A::splat(1e-9));
    steps.min_element().clamp(-1e6, 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_between_two_samples_keep_places_and_changes_of_both() {
        let cubic = |n: f32| Vec3A::new(0.1 * n, 0.02 * n * n, 0.9 - 0.001 * n * n * n);
        let change = |n: f32| Vec3A::new(0.1, 0.04 * n, -0.003 * n * n);
        let stretch = Stretch {
            first: 2.0,
            more: 5.0,
            from: cubic(2.0),
            to: cubic(7.0),
            from_rate: change(2.0),
            to_rate: change(7.0),
        };
        let places = Vec4::new(2.0, 3.0, 4.5, 7.0);
        let [u, v, w] = stretch.parameters(places);
        for (lane, n) in places.to_array().into_iter().enumerate() {
            let found = Vec3A::new(u[lane], v[lane], w[lane]);
            let off = (found - cubic(n)).abs().max_element();
            assert!(off < 1e-6, "{n}: {off}");
        }
    }

    #[test]
    fn steps_are_counted_to_the_nearest_face() {
        let q = Vec3A::new(0.5, 0.2, 0.9);
        assert_eq!(steps_inside(q, Vec3A::new(0.2, -0.05, 0.0)), 2.0);
        assert_eq!(steps_inside(q, Vec3A::new(0.0, 0.0, 0.2)), 0.0);
        assert!(steps_inside(q, Vec3A::ZERO) >= 1e6);
        assert_eq!(steps_inside(Vec3A::splat(1.1), Vec3A::ONE), 0.0);
    }
}
