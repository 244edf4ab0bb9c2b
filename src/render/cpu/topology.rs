//! Samples of a ray, each from the one before it: in the same cell, then in the neighbor across the face that the
//! result overshoots most, then in the cell of a boundary face that the ray has passed, and through the acceleration
//! grid where all that does not help (campagnolo-2021, 4.1.3). The twin of `shaders/shared/topology.wgsl` and
//! `boundary.wgsl` there.

use glam::Vec3A;

use super::boundary::{Boundary, Passage};
use super::cell::{Cell, Solution};
use super::facing::{FacePlace, column_behind, side_lists, sides_join};
use super::frame::Ray;
use super::grid::{Grid, all_coincide};
use super::locate::{Query, is_odd, locate};
use super::tally::Tally;
use super::thorough::encloses;
use crate::render::plan::layout::COLUMN_FLAG;

const TOPOLOGICAL_LIMIT: u32 = 6;
/// Newton steps below this end the iteration while marching; the error left is of its square.
const MARCH_ENOUGH: f32 = 1e-2;
/// Cells of boundary faces that are tried for a sample, at most.
const MOST_TRIED: usize = 4;
/// A sample that seems to be so far outside of a cell is looked for in the neighbor at once.
const SURELY_OUTSIDE: f32 = 0.02;
/// Samples are interpolated between two of a cell where parameters are off a straight line by less than this.
const MOST_BENT: f32 = 0.2;

/// Where a ray's samples have come to.
pub struct Track<'a> {
    grid: &'a Grid,
    ray: &'a Ray,
    /// Where it passes the boundary; `None` where nothing is known of that, and all is searched.
    boundary: Option<&'a Boundary>,
    /// The cell of the current sample, and where in it that is.
    cell: Cell,
    solution: Solution,
    /// Change of the parameters from a sample to the next.
    rate: Vec3A,
    /// The cell that was counted last.
    last: Option<(u32, u32)>,
    /// Samples found in no cell since the last one that was found.
    gap: f32,
    /// What that has cost.
    pub tally: &'a mut Tally,
}

/// Samples in one cell.
pub struct Stretch {
    /// Number of the first.
    pub first: f32,
    /// How many more there are.
    pub more: f32,
    from: Vec3A,
    to: Vec3A,
    from_rate: Vec3A,
    to_rate: Vec3A,
}

impl Stretch {
    /// Parameters of a sample, a cubic between the ends.
    pub fn parameters(&self, n: f32) -> Vec3A {
        if self.more == 0.0 {
            return self.from;
        }
        let s = (n - self.first) / self.more;
        let [m0, m1] = [self.from_rate, self.to_rate].map(|rate| self.more * rate);
        let way = self.to - self.from;
        self.from + s * (m0 + s * ((3.0 * way - 2.0 * m0 - m1) + s * (m0 + m1 - 2.0 * way)))
    }
}

impl<'a> Track<'a> {
    /// A ray before its first sample.
    pub fn new(grid: &'a Grid, ray: &'a Ray, boundary: &'a Boundary, tally: &'a mut Tally) -> Self {
        Self {
            boundary: Some(boundary),
            ..Self::through(grid, ray, tally)
        }
    }

    /// A ray of which nothing is known, before its first sample.
    pub fn through(grid: &'a Grid, ray: &'a Ray, tally: &'a mut Tally) -> Self {
        Self {
            grid,
            ray,
            boundary: None,
            cell: Cell::default(),
            solution: Solution::default(),
            rate: Vec3A::ZERO,
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
                self.gap += passed;
                known = n;
                n += passed;
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
        let Some((column, layer)) = behind(grid, self.cell.column, self.cell.layer, face) else {
            return false;
        };
        self.cell = Cell::load(grid, column, layer);
        let mut start = q;
        start[axis] = if plus { q[axis] - 1.0 } else { q[axis] + 1.0 };
        *uvw = start.clamp(Vec3A::splat(-1.0), Vec3A::splat(2.0));
        true
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

/// The drawn cell behind a face of a cell, where it shares the whole face.
fn behind(grid: &Grid, column: u32, layer: u32, face: u32) -> Option<(u32, u32)> {
    let lists = grid.lists(column);
    if face < 4 {
        let next = column_behind(grid, column, face)?;
        let theirs = side_lists(grid.lists(next), face ^ 1);
        let joins = || sides_join(grid, side_lists(lists, face), theirs, layer);
        return (grid.is_drawn(next, layer) && joins()).then_some((next, layer));
    }
    let bottom = face & 1;
    let next = match bottom {
        0 => layer.checked_sub(1)?,
        _ => layer + 1,
    };
    let mine = grid.layer_depths(lists, layer, bottom);
    let joins = || all_coincide(mine, grid.layer_depths(lists, next, 1 - bottom));
    (next < grid.nk() && grid.is_drawn(column, next) && joins()).then_some((column, next))
}

/// How far parameters are outside of a cell.
fn overshoot(q: Vec3A) -> f32 {
    (-q).max(q - Vec3A::ONE).max_element()
}

/// Steps of a change that parameters can make before they leave a cell.
fn steps_inside(q: Vec3A, rate: Vec3A) -> f32 {
    let room = Vec3A::select(rate.cmpgt(Vec3A::ZERO), Vec3A::ONE - q, q);
    let steps = room / rate.abs().max(Vec3A::splat(1e-9));
    steps.min_element().clamp(0.0, 1e6).trunc()
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
        for n in [2.0, 3.0, 4.5, 7.0] {
            let off = (stretch.parameters(n) - cubic(n)).abs().max_element();
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
