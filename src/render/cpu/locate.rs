//! Point location through the acceleration grid: bin, columns in the bin, layer by depth, Newton.
//! (campagnolo-2021, 4.1; the regular grid here is two-dimensional, with a search by depth in the column.)
//! That is quick and right where cells do not fold over. Bins where some do are searched thoroughly, and so is a bin
//! where the quick search finds no cell but cannot be sure that there is none.
//! The twin of `shaders/shared/locate.wgsl`.

use glam::{UVec2, Vec2, Vec3A, Vec4};

use super::cell::{Cell, Solution, inverse_bilinear, is_between};
use super::each::Each;
use super::grid::{COINCIDENT, Grid, Pillar};
use super::thorough::{encloses, may_hold, solve_by_parts};
use crate::render::plan::layout::BIN_IS_ODD;

/// What a search has found.
#[derive(Clone, Copy, Default)]
pub struct Location {
    /// The cell, and where in it the point is.
    pub found: Option<(Cell, Solution)>,
    /// Newton steps that were taken.
    pub iterations: u32,
    /// Where not found: how many steps of `advance` surely lie outside all cells (at least 1).
    pub skip: f32,
    /// The quick search has found nothing, but cannot be sure.
    pub in_doubt: bool,
    /// Not found by the thorough search, and yet inside a drawn cell.
    pub is_lost: bool,
}

/// A point to locate.
#[derive(Clone, Copy)]
pub struct Query {
    /// The point, relative to the grid's origin.
    pub point: Vec3A,
    /// Its rounding error.
    pub low_bits: Vec3A,
    /// Newton steps below this end the iteration.
    pub enough: f32,
}

const LAYER_MOVES: u32 = 8;
/// Part of a skip that is taken: pillars that are not parallel turn the sides of a section meanwhile.
const SAFE_SKIP: f32 = 0.9;

/// Finds the cell that holds a point; `advance` is the displacement to the next sample, used to skip what is empty.
pub fn locate(grid: &Grid, query: Query, advance: Vec3A) -> Location {
    let mut search = Search {
        grid,
        query,
        advance,
        result: Location::default(),
        last: Solution::default(),
    };
    search.quickly();
    if search.result.in_doubt {
        search.thoroughly();
    }
    search.result
}

/// True where points are found only by a search of all cells of the bin.
pub fn is_odd(grid: &Grid, point: Vec3A) -> bool {
    let [first, _] = grid.compact.bins[bin_at(grid, point).1];
    first & BIN_IS_ODD != 0
}

/// The bin of a point, and its number.
fn bin_at(grid: &Grid, point: Vec3A) -> (UVec2, usize) {
    let info = &grid.compact.info;
    let [origin, size] = [info.bin_origin, info.bin_size].map(Vec2::from_array);
    let last = UVec2::new(info.bins_x - 1, info.bins_y - 1);
    let at = ((point.truncate() - origin) / size).floor();
    let at = at.clamp(Vec2::ZERO, last.as_vec2()).as_uvec2();
    (at, (at.x + info.bins_x * at.y) as usize)
}

struct Search<'a> {
    grid: &'a Grid,
    query: Query,
    advance: Vec3A,
    result: Location,
    /// Of the cell that was tried last.
    last: Solution,
}

impl Search<'_> {
    fn quickly(&mut self) {
        let info = &self.grid.compact.info;
        let (xy, bin) = bin_at(self.grid, self.query.point);
        let [first, range] = self.grid.compact.bins[bin];
        let columns = self.columns(bin);
        let depth = |n: u32| info.depth_low + info.depth_scale * n as f32;
        let (shallow, deep) = (depth(range & 0xffff), depth(range >> 16));
        let size = Vec2::from_array(info.bin_size);
        let low = Vec2::from_array(info.bin_origin) + xy.as_vec2() * size;
        let (point, advance) = (self.query.point, self.advance);
        let mut skip = steps_to_leave(point.x, advance.x, low.x, low.x + size.x)
            .min(steps_to_leave(point.y, advance.y, low.y, low.y + size.y));
        if columns.is_empty() || point.z < shallow || point.z > deep {
            if !columns.is_empty() {
                if point.z < shallow && advance.z > 0.0 {
                    skip = skip.min((shallow - point.z) / advance.z);
                } else if point.z > deep && advance.z < 0.0 {
                    skip = skip.min((deep - point.z) / advance.z);
                }
            }
            self.result.skip = whole(skip);
            return;
        }
        self.result.skip = skip;
        let is_odd = first & BIN_IS_ODD != 0;
        if !is_odd {
            for at in columns {
                if self.in_column(self.grid.compact.bin_columns[at]) {
                    break;
                }
            }
        }
        let result = &mut self.result;
        result.in_doubt = (result.in_doubt || is_odd) && result.found.is_none();
        result.skip = match result.in_doubt {
            true => 1.0,
            false => whole(result.skip),
        };
    }

    /// Settles a location that is in doubt.
    fn thoroughly(&mut self) {
        let (_, bin) = bin_at(self.grid, self.query.point);
        for at in self.columns(bin) {
            if self.all_layers(self.grid.compact.bin_columns[at]) {
                self.result.is_lost = false;
                break;
            }
        }
        self.result.in_doubt = false;
    }

    /// Positions of a bin's columns.
    fn columns(&self, bin: usize) -> std::ops::Range<usize> {
        let bins = &self.grid.compact.bins;
        let first = |bin: usize| (bins[bin][0] & !BIN_IS_ODD) as usize;
        first(bin)..first(bin + 1)
    }

    fn in_column(&mut self, column: u32) -> bool {
        let pillars = self.grid.pillars(column);
        let corners = [0, 1, 2, 3].each(|n| self.section_corner(&pillars[n]));
        let margin = Grid::column_margin(self.grid.lists(column));
        // Motion across the section in one step.
        let slope: Vec2 = pillars.iter().map(|p| p.slope).sum();
        let motion = self.advance.truncate() - 0.25 * self.advance.z * slope;
        if let Some(steps) = steps_to_section(corners, motion, margin) {
            self.result.skip = self.result.skip.min(SAFE_SKIP * steps);
            return false;
        }
        // A section that is not convex may cover the point twice.
        let roots = inverse_bilinear(corners);
        if !is_between(roots[0], margin) {
            self.result.skip = 1.0;
            return false;
        }
        let speed = section_speed(corners, motion);
        self.layers(column, roots[0], speed)
            || (is_between(roots[1], margin) && self.layers(column, roots[1], speed))
    }

    /// Finds the cell of a column that holds the point, whose parameters in the column's section are about `uv`.
    fn layers(&mut self, column: u32, uv: Vec2, speed: f32) -> bool {
        let grid = self.grid;
        let lists = grid.lists(column);
        let margin = Grid::column_margin(lists);
        let inner = uv.clamp(Vec2::ZERO, Vec2::ONE);
        let [x, y] = [[1.0 - inner.x, inner.x], [1.0 - inner.y, inner.y]];
        let weights = Vec4::new(x[0] * y[0], x[1] * y[0], x[0] * y[1], x[1] * y[1]);
        let last = grid.nk() - 1;
        let above = self.clear_of(grid.layer_depths(lists, 0, 0), 1.0, weights, margin, speed);
        let below = self.clear_of(
            grid.layer_depths(lists, last, 1),
            -1.0,
            weights,
            margin,
            speed,
        );
        if let Some(steps) = above.into_iter().chain(below).reduce(f32::max) {
            self.result.skip = self.result.skip.min(SAFE_SKIP * steps);
            return false;
        }
        self.result.skip = 1.0;
        // The first layer whose bottom lies below the point.
        let (mut low, mut high) = (0, grid.nk());
        while low < high {
            let middle = (low + high) / 2;
            if self.height(weights, grid.layer_depths(lists, middle, 1)) > 0.0 {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        self.near_layer(column, low.min(last), uv, weights)
    }

    /// Pillar position at the point's depth, relative to the point.
    fn section_corner(&self, pillar: &Pillar) -> Vec2 {
        let Query {
            point, low_bits, ..
        } = self.query;
        (pillar.at - point.truncate())
            + (pillar.low_bits + pillar.slope * point.z - low_bits.truncate())
    }

    /// How far a bilinear patch in the column lies below the point.
    fn height(&self, weights: Vec4, depths: Vec4) -> f32 {
        weights.dot(depths - Vec4::splat(self.query.point.z)) - self.query.low_bits.z
    }

    /// Steps after which the point may come to a patch from above (`sign` 1) or from below (-1); `None` where it is
    /// not clear of it.
    fn clear_of(
        &self,
        depths: Vec4,
        sign: f32,
        weights: Vec4,
        margin: f32,
        speed: f32,
    ) -> Option<f32> {
        let clear = sign * self.height(weights, depths) - depth_slack(depths, margin);
        let approach = sign * self.advance.z + 2.0 * speed * depth_spread(depths);
        (clear > 0.0).then(|| match approach > clear * 1e-6 {
            true => clear / approach,
            false => 1e6,
        })
    }

    /// Newton in `start` and, where the result lies above or below, in the layers there.
    fn near_layer(&mut self, column: u32, start: u32, uv: Vec2, weights: Vec4) -> bool {
        let grid = self.grid;
        let lists = grid.lists(column);
        let margin = Grid::column_margin(lists);
        let mut layer = start;
        let mut direction = 0;
        let mut is_pinched = false;
        for _ in 0..LAYER_MOVES {
            let [top_depths, bottom_depths] = [0, 1].each(|b| grid.layer_depths(lists, layer, b));
            let edges = (bottom_depths - top_depths).abs();
            is_pinched |= edges.cmple(Vec4::splat(COINCIDENT)).any();
            let top = self.height(weights, top_depths);
            let bottom = self.height(weights, bottom_depths);
            let thickness = (bottom - top).max(1e-20);
            let w = (-top / thickness).clamp(0.0, 1.0);
            let toward = |low: bool, high: bool| match (low, high) {
                (true, _) => -1,
                (_, true) => 1,
                _ => 0,
            };
            let mut step = toward(
                top > depth_slack(top_depths, margin),
                bottom < -depth_slack(bottom_depths, margin),
            );
            if step == 0 {
                if grid.is_drawn(column, layer) && top_depths != bottom_depths {
                    if self.try_cell(column, layer, uv.extend(w).into()) {
                        return true;
                    }
                    let reached = self.last.uvw.z;
                    step = toward(reached < 0.0, reached > 1.0);
                } else if thickness <= COINCIDENT && direction != 0 {
                    step = direction;
                } else {
                    // Not drawn: near its top or bottom the point may belong to the layer beyond.
                    step = toward(w < 0.25, w > 0.75);
                }
            }
            if step == 0 {
                return false;
            }
            if direction != 0 && step != direction {
                // Between two layers, so near to both that rounding may hide the point.
                self.result.in_doubt = true;
                return false;
            }
            direction = step;
            match layer.checked_add_signed(step).filter(|l| *l < grid.nk()) {
                Some(next) => layer = next,
                None => {
                    // Where edges have no length the way may have been the wrong one.
                    self.result.in_doubt |= is_pinched;
                    return false;
                }
            }
        }
        self.result.in_doubt = true;
        false
    }

    /// Newton in one cell.
    fn try_cell(&mut self, column: u32, layer: u32, start: Vec3A) -> bool {
        let cell = Cell::load(self.grid, column, layer);
        let point = cell.relative_to(self.query.point) + self.query.low_bits;
        let s = cell.solve(point, start, self.query.enough);
        self.result.iterations += s.iterations;
        self.last = s;
        if s.inside {
            self.result.found = Some((cell, s));
            return true;
        }
        // No answer, or beside the cell, which contradicts the column's section; and yet among the corners.
        let is_beside = s.uvw.z >= 0.0 && s.uvw.z <= 1.0;
        self.result.in_doubt |= (is_beside && is_between(start.truncate(), 0.0))
            || ((is_beside || !s.sure) && may_hold(&cell, point, Vec3A::splat(0.5), 1.0));
        false
    }

    /// Finds the uppermost drawn cell of a column that holds the point, by a thorough search of all of them.
    fn all_layers(&mut self, column: u32) -> bool {
        let grid = self.grid;
        let lists = grid.lists(column);
        for layer in (0..grid.nk()).filter(|layer| grid.is_drawn(column, *layer)) {
            let [top, bottom] = [0, 1]
                .each(|b| grid.layer_depths(lists, layer, b) - Vec4::splat(self.query.point.z));
            if top.min(bottom).min_element() > COINCIDENT
                || top.max(bottom).max_element() < -COINCIDENT
                || top == bottom
            {
                continue;
            }
            let cell = Cell::load(grid, column, layer);
            let point = cell.relative_to(self.query.point) + self.query.low_bits;
            let mut s = solve_by_parts(&cell, point, self.query.enough);
            self.result.iterations += s.iterations;
            if grid.compact.facts.vertical && !s.inside {
                s = cell.solve_vertical(point);
            }
            if s.inside {
                self.result.found = Some((cell, s));
                return true;
            }
            self.result.is_lost |= encloses(&cell, point);
        }
        false
    }
}

/// A skip in whole steps, at least one.
fn whole(skip: f32) -> f32 {
    (skip - 1e-3).ceil().max(1.0)
}

/// Number of steps until `at` leaves (low, high); a large number where it never does.
fn steps_to_leave(at: f32, advance: f32, low: f32, high: f32) -> f32 {
    if advance.abs() < 1e-20 {
        return 1e6;
    }
    let way = if advance > 0.0 { high - at } else { low - at };
    (way / advance).clamp(0.0, 1e6)
}

/// Steps of `motion` after which the origin may come within the margin of a quadrilateral; `None` where it is
/// already. A quadrilateral that is not convex has no outside here.
fn steps_to_section([q0, q1, q2, q3]: [Vec2; 4], motion: Vec2, margin: f32) -> Option<f32> {
    let edges = [q1 - q0, q3 - q1, q2 - q3, q0 - q2];
    let corners = [q0, q1, q3, q2];
    let area = 0.5 * ((q1 - q0).perp_dot(q3 - q0) + (q3 - q0).perp_dot(q2 - q0));
    let turns = [0, 1, 2, 3].each(|n| edges[n].perp_dot(edges[(n + 1) % 4]) / area);
    if !turns.iter().all(|turn| *turn >= 0.0) {
        return None;
    }
    // How far outside each side, in cell widths, and how much nearer a step comes.
    let sides = edges.iter().zip(corners).filter_map(|(edge, corner)| {
        let outside = edge.perp_dot(corner) / area - margin;
        let approach = -motion.perp_dot(*edge) / area;
        (outside > 0.0).then(|| match approach > outside * 1e-6 {
            true => outside / approach,
            false => 1e6,
        })
    });
    sides.reduce(f32::max)
}

/// Cell widths that a step crosses, at most: many where the section folds over.
fn section_speed([q0, q1, q2, q3]: [Vec2; 4], motion: Vec2) -> f32 {
    let turns = Vec4::new(
        (q1 - q0).perp_dot(q2 - q0),
        (q1 - q0).perp_dot(q3 - q1),
        (q3 - q2).perp_dot(q2 - q0),
        (q3 - q2).perp_dot(q3 - q1),
    );
    let along = [q1 - q0, q3 - q2, q2 - q0, q3 - q1].each(|edge| motion.perp_dot(edge).abs());
    let along = Vec4::from_array(along).max_element();
    along / turns.min_element().max(-turns.max_element()).max(1e-20)
}

/// How far off the depth of a bilinear patch may be where (u, v) is off by the column's margin.
fn depth_slack(depths: Vec4, margin: f32) -> f32 {
    2.0 * margin * depth_spread(depths) + COINCIDENT
}

fn depth_spread(depths: Vec4) -> f32 {
    depths.max_element() - depths.min_element()
}
