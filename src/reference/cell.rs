//! The inverse of one cell's trilinear map.

use std::collections::VecDeque;

use glam::{DMat3, DVec3};

use crate::model::Hexahedron;

/// Parameters beyond one by less than this still count as inside.
const ON_FACE: f64 = 1e-9;

/// Newton's method ends at a step this small.
const CONVERGED: f64 = 1e-12;

/// Residuals below this share of the cell's size are rounding errors.
const ROUNDING: f64 = 4e-15;

/// Steps of Newton's method at most.
const MAX_STEPS: usize = 50;

/// Slack of the tests that exclude a point, as a share of the cell's size: more than [`ON_FACE`].
const SLACK: f64 = 1e-8;

/// Halvings of the parameters at most, and parts in which a point is looked for at most.
const FINEST: f64 = 1.0 / 64.0;
const MOST_PARTS: usize = 1000;

/// The trilinear map of a cell as a polynomial about its first corner, with what excludes points.
#[derive(Debug)]
pub struct CellMap {
    origin: DVec3,
    /// Factors of 1, s, t, r, st, tr, sr and str.
    factors: [DVec3; 8],
    /// Length of the box's diagonal.
    size: f64,
    slabs: [Slab; 3],
    curvature: Curvature,
}

/// The space between two parallel planes.
#[derive(Debug)]
struct Slab {
    normal: DVec3,
    range: [f64; 2],
}

/// Bounds on the part of the map that is not affine, in units of the affine part at the center:
/// largest row sums of its bilinear and of its trilinear factors.
#[derive(Debug)]
struct Curvature {
    bilinear: f64,
    trilinear: f64,
}

impl CellMap {
    /// The map of a cell.
    pub fn new(hexahedron: &Hexahedron) -> Self {
        let origin = hexahedron.0[0];
        let corners = hexahedron.0.map(|corner| corner - origin);
        let [low, high] = hexahedron.bounds();
        let size = low.distance(high);
        let factors = factors(&corners);
        let [_, s, t, r, ..] = factors;
        Self {
            origin,
            factors,
            size,
            slabs: [t.cross(r), r.cross(s), s.cross(t)]
                .map(|normal| Slab::around(&corners, normal, SLACK * size)),
            curvature: Curvature::new(&factors),
        }
    }

    /// Smallest and largest coordinates of all points that can count as inside.
    pub fn bounds(hexahedron: &Hexahedron) -> [DVec3; 2] {
        let [low, high] = hexahedron.bounds();
        let slack = DVec3::splat(SLACK * low.distance(high));
        [low - slack, high + slack]
    }

    /// Parameters (s, t, r) of a point; `None` where it is not in the cell. A cell that folds over has some
    /// points more than once: then any of their parameters.
    ///
    /// Newton's method starts in the middle of the cell, then in the middle of each octant in which the point may
    /// be, then in the middle of the octants of these, and so on.
    pub fn parameters(&self, point: DVec3) -> Option<DVec3> {
        let target = point - self.origin;
        // The cell lies in the convex hull of its corners, which lies in each of the slabs.
        if !self.slabs.iter().all(|slab| slab.contains(target)) {
            return None;
        }
        let mut part = Part::WHOLE;
        let mut others = VecDeque::new();
        for _ in 0..MOST_PARTS {
            if let Some(root) = self.solve(target, part.middle) {
                let reach = root.abs().max_element();
                if reach <= 1.0 + ON_FACE {
                    return Some(root);
                }
                // On a collapsed edge one parameter is undetermined, and any in the cell will do.
                let nearest = root.clamp(DVec3::NEG_ONE, DVec3::ONE);
                if (self.at(nearest) - target).length() <= ROUNDING * self.size {
                    return Some(nearest);
                }
                if self.curvature.one_to_one_within(reach) {
                    return None;
                }
            }
            if part.half > FINEST {
                others.extend(part.octants().filter(|o| self.may_hold(o, target)));
            }
            part = others.pop_front()?;
        }
        None
    }

    /// False where a plane along two tangents or two axes separates the point from a part of the cell.
    fn may_hold(&self, part: &Part, target: DVec3) -> bool {
        let corners = part.corners().map(|corner| self.at(corner));
        let tangents = self.jacobian(part.middle);
        let [s, t, r] = [tangents.x_axis, tangents.y_axis, tangents.z_axis];
        [
            t.cross(r),
            r.cross(s),
            s.cross(t),
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
        ]
        .into_iter()
        .all(|normal| Slab::around(&corners, normal, SLACK * self.size).contains(target))
    }

    /// Newton's method from `start`, with steps halved until they bring the point nearer.
    fn solve(&self, target: DVec3, start: DVec3) -> Option<DVec3> {
        let mut str = start;
        let mut residual = self.at(str) - target;
        for _ in 0..MAX_STEPS {
            if residual.length() <= ROUNDING * self.size {
                return Some(str);
            }
            let jacobian = self.jacobian(str);
            if let Some(step) = newton_step(jacobian, residual) {
                (str, residual) = self.damped(str, step, jacobian, target);
                if step.length() <= CONVERGED {
                    return Some(str);
                }
            } else {
                // Singular, as at the collapsed edge of a wedge: back toward the center.
                str *= 0.9;
                residual = self.at(str) - target;
            }
        }
        None
    }

    /// The place after a step, and the residual there.
    ///
    /// Nearness is measured in parameters, by the step that would follow with the same Jacobian:
    /// cells are up to a hundred thousand times as wide as thick, so lengths would mean nothing.
    fn damped(&self, str: DVec3, step: DVec3, jacobian: DMat3, target: DVec3) -> (DVec3, DVec3) {
        let mut scale = 1.0;
        loop {
            let next = str - scale * step;
            let residual = self.at(next) - target;
            let following = newton_step(jacobian, residual);
            if scale < 1e-3 || following.is_some_and(|f| f.length() < step.length()) {
                return (next, residual);
            }
            scale *= 0.5;
        }
    }

    /// The point at (s, t, r), from the first corner.
    fn at(&self, str: DVec3) -> DVec3 {
        let [one, s, t, r, st, tr, sr, all] = self.factors;
        let (x, y, z) = str.into();
        one + s * x + t * y + r * z + st * (x * y) + tr * (y * z) + sr * (x * z) + all * (x * y * z)
    }

    fn jacobian(&self, str: DVec3) -> DMat3 {
        let [_, s, t, r, st, tr, sr, all] = self.factors;
        let (x, y, z) = str.into();
        DMat3::from_cols(
            s + st * y + sr * z + all * (y * z),
            t + st * x + tr * z + all * (x * z),
            r + tr * y + sr * x + all * (x * y),
        )
    }
}

impl Slab {
    fn around(corners: &[DVec3; 8], normal: DVec3, slack: f64) -> Self {
        // A collapsed cell has no such direction: the slab of the null vector is all space.
        let normal = normal.normalize_or_zero();
        let along = corners.map(|corner| corner.dot(normal));
        Self {
            normal,
            range: [
                along.iter().fold(f64::INFINITY, |a, &b| a.min(b)) - slack,
                along.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b)) + slack,
            ],
        }
    }

    fn contains(&self, point: DVec3) -> bool {
        let along = point.dot(self.normal);
        self.range[0] <= along && along <= self.range[1]
    }
}

impl Curvature {
    fn new(factors: &[DVec3; 8]) -> Self {
        let [_, s, t, r, st, tr, sr, all] = *factors;
        let to_affine = DMat3::from_cols(s, t, r).inverse();
        if !to_affine.is_finite() {
            let [bilinear, trilinear] = [f64::INFINITY; 2];
            return Self {
                bilinear,
                trilinear,
            };
        }
        let [st, tr, sr, all] = [st, tr, sr, all].map(|factor| (to_affine * factor).abs());
        Self {
            bilinear: (st + tr + sr).max_element(),
            trilinear: all.max_element(),
        }
    }

    /// True where no two parameters in the cube [-reach, reach]^3 give the same point.
    ///
    /// In units of the affine part the map is `x + N(x)`; it is one-to-one where the derivative of
    /// `N` has row sums below one: each bilinear factor adds at most twice its size times the
    /// reach, the trilinear one three times its size times the reach squared.
    fn one_to_one_within(&self, reach: f64) -> bool {
        2.0 * self.bilinear * reach + 3.0 * self.trilinear * reach * reach < 0.999
    }
}

/// A cube of parameters.
#[derive(Debug, Clone, Copy)]
struct Part {
    middle: DVec3,
    /// Half its edge.
    half: f64,
}

impl Part {
    const WHOLE: Self = Self {
        middle: DVec3::ZERO,
        half: 1.0,
    };

    fn corners(&self) -> [DVec3; 8] {
        let sign = |c: usize, axis: usize| if c >> axis & 1 == 1 { 1.0 } else { -1.0 };
        std::array::from_fn(|c| {
            self.middle + self.half * DVec3::new(sign(c, 0), sign(c, 1), sign(c, 2))
        })
    }

    fn octants(self) -> impl Iterator<Item = Self> {
        let half = 0.5 * self.half;
        let inner = Self { half, ..self };
        let middles = inner.corners().into_iter();
        middles.map(move |middle| Self { middle, half })
    }
}

/// Solution of `jacobian * step = residual`; `None` where the columns lie (nearly) in a plane.
fn newton_step(jacobian: DMat3, residual: DVec3) -> Option<DVec3> {
    let [a, b, c] = [jacobian.x_axis, jacobian.y_axis, jacobian.z_axis];
    let determinant = a.dot(b.cross(c));
    let flat = 1e-14 * a.length() * b.length() * c.length();
    (determinant.abs() > flat).then(|| {
        DVec3::new(
            residual.dot(b.cross(c)),
            residual.dot(c.cross(a)),
            residual.dot(a.cross(b)),
        ) / determinant
    })
}

/// Factors of 1, s, t, r, st, tr, sr and str of the map through eight corners.
fn factors(corners: &[DVec3; 8]) -> [DVec3; 8] {
    // Bits of the corner number that a monomial's sign depends on.
    [0, 1, 2, 4, 3, 6, 5, 7].map(|bits: usize| {
        let signed = corners.iter().enumerate().map(|(c, &corner)| {
            let minus = bits.count_ones() - (c & bits).count_ones();
            if minus % 2 == 1 { -corner } else { corner }
        });
        signed.sum::<DVec3>() / 8.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 100 x 80 x 5 with every corner moved by up to `twist` of its edges, far from the
    /// origin as map coordinates are.
    fn twisted(random: &mut fastrand::Rng, twist: f64) -> Hexahedron {
        let edges = DVec3::new(100.0, 80.0, 5.0);
        let shear = DVec3::new(0.0, 0.0, 30.0);
        Hexahedron(std::array::from_fn(|c| {
            let d = DVec3::new((c & 1) as f64, (c >> 1 & 1) as f64, (c >> 2) as f64);
            let mut off = || twist * (2.0 * random.f64() - 1.0);
            let moved = d + DVec3::new(off(), off(), off());
            DVec3::new(460_000.0, 5_930_000.0, 1_700.0) + edges * moved + shear * moved.x
        }))
    }

    fn parameters(random: &mut fastrand::Rng, reach: f64) -> DVec3 {
        let mut one = || reach * (2.0 * random.f64() - 1.0);
        DVec3::new(one(), one(), one())
    }

    #[test]
    fn polynomial_is_the_trilinear_map() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..100 {
            let hexahedron = twisted(&mut random, 0.2);
            let map = CellMap::new(&hexahedron);
            let str = parameters(&mut random, 1.0);
            assert!((map.at(str) + map.origin).distance(hexahedron.at(str)) < 1e-8);
            let difference = map.jacobian(str) - hexahedron.jacobian(str);
            assert!(difference.abs_diff_eq(DMat3::ZERO, 1e-8));
        }
    }

    #[test]
    fn ok_parameters_come_back() {
        let mut random = fastrand::Rng::with_seed(2);
        for _ in 0..10_000 {
            let map = CellMap::new(&twisted(&mut random, 0.15));
            let str = parameters(&mut random, 1.0);
            // From the first corner, for absolute coordinates are rounded to 1e-9.
            let found = map.solve_from_all_starts(map.at(str));
            assert!(
                found.is_some_and(|f| f.distance(str) < 1e-9),
                "{str} {found:?}"
            );
            let point = map.at(str) + map.origin;
            let found = map.parameters(point);
            assert!(
                found.is_some_and(|f| f.distance(str) < 1e-8),
                "{str} {found:?}"
            );
        }
    }

    #[test]
    fn err_points_outside_have_no_parameters() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut outside = 0;
        while outside < 10_000 {
            let map = CellMap::new(&twisted(&mut random, 0.1));
            let str = parameters(&mut random, 1.3);
            // Far enough beyond a face for the rounding of absolute coordinates.
            if str.abs().max_element() > 1.0 + 1e-7 {
                assert_eq!(map.parameters(map.at(str) + map.origin), None, "{str}");
                outside += 1;
            }
        }
    }

    #[test]
    fn ok_wedges_have_finite_parameters_everywhere() {
        let mut random = fastrand::Rng::with_seed(4);
        for _ in 0..1_000 {
            let mut hexahedron = twisted(&mut random, 0.1);
            // No thickness on the two pillars of the side s = -1, or on one of them.
            hexahedron.0[4] = hexahedron.0[0];
            if random.bool() {
                hexahedron.0[6] = hexahedron.0[2];
            }
            let map = CellMap::new(&hexahedron);
            let str = parameters(&mut random, 0.99);
            let found = map.parameters(map.at(str) + map.origin);
            assert!(
                found.is_some_and(|f| f.distance(str) < 1e-6),
                "{str} {found:?}"
            );
            let edge = map.parameters(hexahedron.0[0]);
            assert!(edge.is_some_and(|f| f.is_finite() && (f.x + 1.0).abs() < 1e-9));
        }
    }

    #[test]
    fn ok_warped_wedges_of_millimeters_over_a_hundred_meters() {
        // Like the pinched layers of a real field model: three edges collapsed, top warped by 8 m.
        let mut random = fastrand::Rng::with_seed(6);
        let mut hexahedron = Hexahedron(std::array::from_fn(|c| match c & 3 {
            0 => DVec3::new(3346.0, 4674.0, 1722.0),
            1 => DVec3::new(3493.0, 4755.0, 1720.5),
            2 => DVec3::new(3426.0, 4537.0, 1722.0),
            _ => DVec3::new(3561.5, 4617.0, 1713.5),
        }));
        hexahedron.0[7] += DVec3::new(0.004, 0.0005, 0.003);
        let map = CellMap::new(&hexahedron);
        for _ in 0..10_000 {
            let str = parameters(&mut random, 0.9);
            let found = map.parameters(map.at(str) + map.origin);
            assert!(
                found.is_some_and(|f| f.distance(str) < 1e-5),
                "{str} {found:?}"
            );
        }
    }

    #[test]
    fn ok_cells_that_fold_over_have_all_their_points() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut hard = 0;
        for _ in 0..3_000 {
            let map = CellMap::new(&twisted(&mut random, 0.7));
            let str = parameters(&mut random, 1.0);
            let target = map.at(str);
            let found = map.parameters(target + map.origin);
            assert!(
                found.is_some_and(|f| map.at(f).distance(target) < 1e-8),
                "{str} {found:?}"
            );
            // Points that nine starts of Newton's method do not find.
            hard += usize::from(map.solve_from_all_starts(target).is_none());
        }
        assert!(hard > 0);
    }

    #[test]
    fn err_flat_and_point_cells_contain_nothing() {
        let mut random = fastrand::Rng::with_seed(5);
        let mut flat = twisted(&mut random, 0.0);
        for c in 0..4 {
            flat.0[c + 4] = flat.0[c];
        }
        let middle = flat.center();
        assert_eq!(CellMap::new(&flat).parameters(middle + DVec3::Z), None);
        let collapsed = CellMap::new(&Hexahedron([middle; 8]));
        assert_eq!(collapsed.parameters(middle + DVec3::Z), None);
    }

    impl CellMap {
        fn solve_from_all_starts(&self, target: DVec3) -> Option<DVec3> {
            let octants = Part::WHOLE.octants().map(|part| part.middle);
            std::iter::once(DVec3::ZERO)
                .chain(octants)
                .filter_map(|start| self.solve(target, start))
                .find(|root| root.abs().max_element() <= 1.0 + ON_FACE)
        }
    }
}
