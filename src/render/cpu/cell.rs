//! One cell as a trilinear map from [0, 1]^3, with the field as a fourth coordinate, and its inverse.
//! The twin of `shaders/shared/cell.wgsl`.
//!
//! Positions are relative to the cell's first corner, so that thin layers far from the origin keep their digits.

use glam::{Vec2, Vec3A, Vec4};

use super::each::Each;
use super::grid::{Grid, Pillar};

/// The map of a cell.
#[derive(Clone, Copy, Default)]
pub struct Cell {
    /// Its column.
    pub column: u32,
    /// Its layer.
    pub layer: u32,
    /// First corner, grid space relative to the origin: `base + offset`, kept apart for precision.
    base: Vec3A,
    offset: Vec3A,
    /// Coefficients of 1, u, v, w, uv, vw, uw, uvw; the fourth coordinate is the field.
    pub k0: Vec4,
    /// See [`Self::k0`].
    pub ku: Vec4,
    /// See [`Self::k0`].
    pub kv: Vec4,
    /// See [`Self::k0`].
    pub kw: Vec4,
    /// See [`Self::k0`].
    pub kuv: Vec4,
    /// See [`Self::k0`].
    pub kvw: Vec4,
    /// See [`Self::k0`].
    pub kuw: Vec4,
    /// See [`Self::k0`].
    pub kuvw: Vec4,
    /// All pillars of the grid are vertical: the inverse of the map has a closed form.
    is_vertical: bool,
}

/// Result of Newton's method: parameters in [0, 1]^3 where inside.
#[derive(Clone, Copy, Default)]
pub struct Solution {
    /// The parameters.
    pub uvw: Vec3A,
    /// They are in the cell.
    pub inside: bool,
    /// Inside, or outside of a cell that does not fold over.
    pub sure: bool,
    /// Newton steps that were taken.
    pub iterations: u32,
}

/// Slack for f32 at faces, in cells: points on a shared face are in at least one cell; callers take the first, so
/// in exactly one.
pub const INSIDE_SLACK: f32 = 1e-5;
const NEWTON_LIMIT: u32 = 10;
/// Newton steps below this converge: each next one is at most about a quarter of it.
const SURE_STEP: f32 = 0.25;
/// Determinants below this are those of a collapsed edge.
const NO_VOLUME: f32 = 1e-30;

/// Rows of an inverse Jacobian, as columns of its transpose.
pub struct Inverse {
    rows: [Vec3A; 3],
}

impl Inverse {
    /// How the parameters change along a displacement.
    #[inline]
    pub fn along(&self, displacement: Vec3A) -> Vec3A {
        let [u, v, w] = self.rows;
        Vec3A::new(
            u.dot(displacement),
            v.dot(displacement),
            w.dot(displacement),
        )
    }
}

impl Cell {
    /// The map of a drawn cell.
    #[inline]
    pub fn load(grid: &Grid, column: u32, layer: u32) -> Self {
        let lists = grid.lists(column);
        let [top, bottom] = grid.corner_depths(lists, layer);
        let pillars = grid.pillars(column);
        let values = grid.corner_values(column, layer);
        let corner = |n: usize| {
            let depths = if n < 4 { top } else { bottom };
            let value = values[n >> 2][n & 3];
            corner_at(&pillars[n & 3], &pillars[0], top.x, depths[n & 3], value)
        };
        let c0 = Vec4::new(0.0, 0.0, 0.0, values[0].x);
        let [c1, c2, c3, c4, c5, c6, c7] = [1, 2, 3, 4, 5, 6, 7].map(corner);
        let first = &pillars[0];
        Self {
            column,
            layer,
            base: first.at.extend(top.x).into(),
            offset: (first.low_bits + first.slope * top.x).extend(0.0).into(),
            k0: c0,
            ku: c1 - c0,
            kv: c2 - c0,
            kw: c4 - c0,
            kuv: (c3 - c2) - (c1 - c0),
            kvw: (c6 - c4) - (c2 - c0),
            kuw: (c5 - c4) - (c1 - c0),
            kuvw: ((c7 - c6) - (c5 - c4)) - ((c3 - c2) - (c1 - c0)),
            is_vertical: grid.compact.facts.vertical,
        }
    }

    /// A point of grid space relative to the cell's first corner.
    #[inline]
    pub fn relative_to(&self, point: Vec3A) -> Vec3A {
        (point - self.base) - self.offset
    }

    /// Place and value at parameters.
    #[inline]
    pub fn evaluate(&self, q: Vec3A) -> Vec4 {
        self.k0
            + q.x * (self.ku + q.y * self.kuv)
            + q.y * (self.kv + q.z * self.kvw)
            + q.z * (self.kw + q.x * (self.kuw + q.y * self.kuvw))
    }

    /// Place at parameters.
    #[inline]
    pub fn place(&self, q: Vec3A) -> Vec3A {
        Vec3A::from_vec4(self.evaluate(q))
    }

    /// Value at parameters, which are clamped into the cell.
    pub fn value(&self, q: Vec3A) -> f32 {
        self.values(q.to_array().map(Vec4::splat)).x
    }

    /// Values at four places, by their parameters u, v and w, which are clamped into the cell.
    #[inline]
    pub fn values(&self, parameters: [Vec4; 3]) -> Vec4 {
        let [u, v, w] = parameters.each(|q| q.clamp(Vec4::ZERO, Vec4::ONE));
        let flat = self.k0.w + u * self.ku.w + v * (self.kv.w + u * self.kuv.w);
        let per_w = self.kw.w + u * self.kuw.w + v * (self.kvw.w + u * self.kuvw.w);
        flat + w * per_w
    }

    /// How a place in the cell changes with each of the parameters.
    #[inline]
    pub fn tangents(&self, q: Vec3A) -> [Vec3A; 3] {
        [
            self.ku + q.y * self.kuv + q.z * (self.kuw + q.y * self.kuvw),
            self.kv + q.x * self.kuv + q.z * (self.kvw + q.x * self.kuvw),
            self.kw + q.x * self.kuw + q.y * (self.kvw + q.x * self.kuvw),
        ]
        .map(Vec3A::from_vec4)
    }

    /// The inverse Jacobian; `None` in a cell without volume.
    #[inline]
    pub fn inverse(&self, q: Vec3A) -> Option<Inverse> {
        let [tu, tv, tw] = self.tangents(q);
        let nu = tv.cross(tw);
        let determinant = tu.dot(nu);
        let scale = 1.0 / determinant;
        (determinant.abs() > NO_VOLUME).then(|| Inverse {
            rows: [scale * nu, scale * tw.cross(tu), scale * tu.cross(tv)],
        })
    }

    /// How the parameters change along a displacement; not at all in a cell without volume.
    #[inline]
    pub fn parameters_along(&self, q: Vec3A, displacement: Vec3A) -> Vec3A {
        self.inverse(q)
            .map_or(Vec3A::ZERO, |inverse| inverse.along(displacement))
    }

    /// Newton's method for the parameters of `point` (relative to the cell's first corner), from `start`.
    ///
    /// Stops once a step is below `enough`; convergence is quadratic, so the step after it is far smaller. In
    /// layers of millimeters f32 cannot get there: a small step that no longer shrinks is the end too.
    pub fn solve(&self, point: Vec3A, start: Vec3A, enough: f32) -> Solution {
        if self.is_vertical {
            return self.solve_vertical(point);
        }
        let mut s = Solution {
            uvw: start,
            ..Solution::default()
        };
        let mut converged = false;
        let mut previous = 1e30;
        for n in 0..NEWTON_LIMIT {
            let q = s.uvw;
            s.iterations = n + 1;
            let Some(inverse) = self.inverse(q) else {
                // On a collapsed edge; the tangents span a volume again further inside.
                s.uvw = q.lerp(Vec3A::splat(0.5), 0.1);
                continue;
            };
            let step = inverse.along(point - self.place(q));
            let length = step.abs().max_element();
            // Damped: a step never leads further than one cell. In thin layers the point may lie hundreds of
            // cells away: two steps outside is enough to know.
            let next = q + step * (1.0f32).min(1.0 / length.max(1e-30));
            s.uvw = next.clamp(Vec3A::splat(-1.01), Vec3A::splat(2.01));
            if s.uvw != next {
                break;
            }
            if length < enough || (length < 1e-2 && length > 0.5 * previous) {
                converged = true;
                break;
            }
            // What is left is of the square of the step: so far outside it will not come in again.
            let outside = (-s.uvw).max(s.uvw - Vec3A::ONE).max_element();
            if length < SURE_STEP && outside > length {
                s.sure = true;
                break;
            }
            previous = length;
        }
        s.inside = converged && is_inside(s.uvw);
        s.sure |= converged;
        s
    }

    /// The parameters of `point` where the pillars are vertical: x and y do not depend on w, so (u, v) solves a
    /// bilinear equation, and w then a linear one.
    pub fn solve_vertical(&self, point: Vec3A) -> Solution {
        let xy = |k: Vec4| Vec2::new(k.x, k.y);
        let q0 = xy(self.k0) - Vec2::new(point.x, point.y);
        let [u, v, uv] = [self.ku, self.kv, self.kuv].map(xy);
        let roots = inverse_bilinear([q0, q0 + u, q0 + v, q0 + u + v + uv]);
        let first = self.below(point, roots[0]);
        if first.inside || !is_between(roots[1], INSIDE_SLACK) {
            return first;
        }
        let second = self.below(point, roots[1]);
        if second.inside { second } else { first }
    }

    /// The solution at (u, v), vertical pillars given.
    fn below(&self, point: Vec3A, uv: Vec2) -> Solution {
        let top = self.evaluate(uv.extend(0.0).into()).z;
        let thickness = self.evaluate(uv.extend(1.0).into()).z - top;
        // Without thickness there is no inside.
        let w = if thickness.abs() > 1e-9 {
            ((point.z - top) / thickness).clamp(-1.0, 2.0)
        } else {
            -1.0
        };
        let uvw = uv
            .clamp(Vec2::splat(-1.0), Vec2::splat(2.0))
            .extend(w)
            .into();
        Solution {
            uvw,
            inside: is_inside(uvw),
            sure: true,
            iterations: 0,
        }
    }
}

/// A corner relative to the first one; differences of large numbers first.
#[inline]
fn corner_at(pillar: &Pillar, first: &Pillar, top: f32, depth: f32, value: f32) -> Vec4 {
    let down = depth - top;
    let xy = (pillar.at - first.at)
        + ((pillar.low_bits - first.low_bits)
            + (pillar.slope - first.slope) * top
            + pillar.slope * down);
    Vec4::new(xy.x, xy.y, down, value)
}

/// True where parameters are in the cell.
#[inline]
pub fn is_inside(q: Vec3A) -> bool {
    (q.cmpge(Vec3A::splat(-INSIDE_SLACK)) & q.cmple(Vec3A::splat(1.0 + INSIDE_SLACK))).all()
}

/// Parameters of no place in or near a quadrilateral.
const NO_ROOT: Vec2 = Vec2::splat(-8.0);

/// Parameters of the origin in a quadrilateral with corners at (0, 0), (1, 0), (0, 1) and (1, 1), those nearer to it
/// first; one that is not convex may cover it twice.
///
/// The ends of a line of constant u lie on one line with the origin where
/// c0 (1 - u)^2 + 2 c1 u (1 - u) + c2 u^2 = 0. In this form nothing cancels: of a point inside a convex
/// quadrilateral c0 and c2, areas to both sides of it, differ in sign, so that both terms of the discriminant
/// are positive, and numerator and denominator of u have the same sign.
pub fn inverse_bilinear(corners: [Vec2; 4]) -> [Vec2; 2] {
    let [q0, q1, q2, q3] = corners;
    let c0 = q0.perp_dot(q2);
    let c1 = 0.5 * (q0.perp_dot(q3) + q1.perp_dot(q2));
    let c2 = q1.perp_dot(q3);
    let discriminant = c1 * c1 - c0 * c2;
    // Slightly below zero it is rounding, where the map folds.
    if discriminant < -1e-6 * c1 * c1 {
        return [NO_ROOT; 2];
    }
    let sign = if c1 >= 0.0 { 1.0 } else { -1.0 };
    let q = -(c1 + sign * discriminant.max(0.0).sqrt());
    let a = on_line(q, q + c2, corners);
    let b = on_line(c0, c0 + q, corners);
    if off_middle(a) <= off_middle(b) {
        [a, b]
    } else {
        [b, a]
    }
}

/// Parameters of the origin on the line of constant u = part / whole, where it lies on it.
fn on_line(part: f32, whole: f32, [q0, q1, q2, q3]: [Vec2; 4]) -> Vec2 {
    let u = part / whole;
    // Not a number is none either.
    if (u - 0.5).abs() >= 8.0 || u.is_nan() {
        return NO_ROOT;
    }
    let low = q0.lerp(q1, u);
    let along = q2.lerp(q3, u) - low;
    let length2 = along.length_squared();
    let v = (-low.dot(along) / length2.max(1e-30)).clamp(-8.0, 9.0);
    // Where an edge has no length any place on it has this u.
    let off = low + v * along;
    let extent = (q3 - q0).length_squared() + (q2 - q1).length_squared();
    if off.length_squared() > 1e-4 * (length2 + 1e-4 * extent) {
        return NO_ROOT;
    }
    Vec2::new(u, v)
}

fn off_middle(uv: Vec2) -> f32 {
    (uv - Vec2::splat(0.5)).abs().max_element()
}

/// True where parameters are in a quadrilateral, or out of it by no more than `slack`.
pub fn is_between(uv: Vec2, slack: f32) -> bool {
    off_middle(uv) <= 0.5 + slack
}
