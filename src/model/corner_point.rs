//! One cell as a trilinear hexahedron.

use glam::{DMat3, DVec3};

/// A cell whose four edges along the pillars are all at most this long has no thickness
/// and is never drawn (length units of the file).
pub const NO_THICKNESS: f64 = 1e-6;

/// Steps of Newton's method, which doubles the right digits in each.
const STEPS: usize = 8;

/// Eight corners, number `di + 2 dj + 4 dk`, of the trilinear map from (s, t, r) in [-1, 1]^3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hexahedron(pub [DVec3; 8]);

impl Hexahedron {
    /// The point at parameters (s, t, r) in [-1, 1]^3.
    pub fn at(&self, str: DVec3) -> DVec3 {
        let w = weights(str);
        (0..8).map(|c| self.0[c] * w[c]).sum()
    }

    /// Parameters of a point in the cell, or of one near it, by some steps of Newton's method from the middle.
    pub fn parameters_near(&self, point: DVec3) -> DVec3 {
        let mut str = DVec3::ZERO;
        for _ in 0..STEPS {
            let jacobian = self.jacobian(str);
            if jacobian.determinant() == 0.0 {
                break;
            }
            let step = jacobian.inverse() * (point - self.at(str));
            str = (str + step).clamp(DVec3::NEG_ONE, DVec3::ONE);
        }
        str
    }

    /// Derivative of [`Self::at`]: columns are the tangents along s, t and r.
    pub fn jacobian(&self, str: DVec3) -> DMat3 {
        let mut columns = [DVec3::ZERO; 3];
        for (c, &corner) in self.0.iter().enumerate() {
            for (axis, column) in columns.iter_mut().enumerate() {
                let mut weight = if c >> axis & 1 == 1 { 0.5 } else { -0.5 };
                for other in (0..3).filter(|&o| o != axis) {
                    weight *= linear(str[other], c >> other & 1);
                }
                *column += corner * weight;
            }
        }
        DMat3::from_cols(columns[0], columns[1], columns[2])
    }

    /// Volume of the trilinear map, negative where the corner order is left-handed.
    ///
    /// Three products instead of one for each triangle of the faces (Grandy 1997, efficient computation of volume
    /// of hexahedral cells): below a bilinear face lies the mean of what lies below its two triangulations.
    pub fn signed_volume(&self) -> f64 {
        let way = |from: usize, to: usize| self.0[to] - self.0[from];
        let product = |u: DVec3, v: DVec3, w: DVec3| u.dot(v.cross(w));
        let products = product(way(1, 2) + way(3, 6), way(2, 7), way(0, 3))
            + product(way(2, 4) + way(6, 5), way(4, 7), way(0, 6))
            + product(way(4, 1) + way(5, 3), way(1, 7), way(0, 5));
        products / 12.0
    }

    /// Mean of the eight corners.
    pub fn center(&self) -> DVec3 {
        self.0.iter().sum::<DVec3>() / 8.0
    }

    /// Smallest and largest corner coordinates.
    pub fn bounds(&self) -> [DVec3; 2] {
        let start = [self.0[0], self.0[0]];
        self.0
            .iter()
            .fold(start, |[low, high], &c| [low.min(c), high.max(c)])
    }

    /// Mean length of the edges along s, t and r.
    pub fn mean_edges(&self) -> DVec3 {
        let mean = |step: usize, starts: [usize; 4]| {
            starts
                .iter()
                .map(|&c| self.0[c].distance(self.0[c + step]))
                .sum::<f64>()
                / 4.0
        };
        DVec3::new(
            mean(1, [0, 2, 4, 6]),
            mean(2, [0, 1, 4, 5]),
            mean(4, [0, 1, 2, 3]),
        )
    }
}

fn linear(x: f64, upper: usize) -> f64 {
    0.5 * if upper == 1 { 1.0 + x } else { 1.0 - x }
}

/// Trilinear weights of the eight corners at (s, t, r).
pub fn weights(str: DVec3) -> [f64; 8] {
    std::array::from_fn(|c| {
        linear(str.x, c & 1) * linear(str.y, c >> 1 & 1) * linear(str.z, c >> 2)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheared() -> Hexahedron {
        Hexahedron(std::array::from_fn(|c| {
            let d = DVec3::new((c & 1) as f64, (c >> 1 & 1) as f64, (c >> 2) as f64);
            DVec3::new(2.0 * d.x + 0.5 * d.z, 3.0 * d.y, 4.0 * d.z + 0.25 * d.x)
        }))
    }

    #[test]
    fn volume_of_a_sheared_box_is_its_determinant() {
        // det of columns (2, 0, .25), (0, 3, 0), (.5, 0, 4) = 3 * (8 - 0.125)
        assert!((sheared().signed_volume() - 3.0 * 7.875).abs() < 1e-12);
    }

    #[test]
    fn volume_is_the_integral_of_the_jacobian() {
        let mut random = fastrand::Rng::with_seed(1);
        let mut jitter = || DVec3::from_array(std::array::from_fn(|_| random.f64() - 0.5));
        for _ in 0..100 {
            let hexahedron = Hexahedron(sheared().0.map(|c| c + 1e4 + 3.0 * jitter()));
            // Two Gauss points a direction are exact for the determinant.
            let g = 1.0 / 3f64.sqrt();
            let at = |c: usize| [0, 1, 2].map(|axis| if c >> axis & 1 == 1 { g } else { -g });
            let points = (0..8).map(|c| hexahedron.jacobian(DVec3::from_array(at(c))));
            let integral: f64 = points.map(|j| j.determinant()).sum();
            assert!((hexahedron.signed_volume() - integral).abs() < 1e-8);
            let mut other = hexahedron;
            other.0[3] += DVec3::splat(0.1);
            assert!((other.signed_volume() - integral).abs() > 1e-8);
        }
    }

    #[test]
    fn parameters_are_the_inverse_of_points() {
        let mut hexahedron = sheared();
        hexahedron.0[7] += DVec3::new(0.3, -0.2, 0.4);
        for n in 0..27 {
            let at = [n % 3, n / 3 % 3, n / 9].map(|n| 0.9 * (f64::from(n) - 1.0));
            let at = DVec3::from_array(at);
            let found = hexahedron.parameters_near(hexahedron.at(at));
            assert!(found.distance(at) < 1e-9, "{at} {found}");
        }
        let beside = hexahedron.parameters_near(DVec3::splat(100.0));
        assert!(beside.abs().max_element() <= 1.0);
    }

    #[test]
    fn jacobian_is_the_difference_quotient() {
        let mut hexahedron = sheared();
        hexahedron.0[7] += DVec3::new(0.3, -0.2, 0.4);
        let at = DVec3::new(0.2, -0.4, 0.7);
        let jacobian = hexahedron.jacobian(at);
        for axis in 0..3 {
            let mut step = DVec3::ZERO;
            step[axis] = 1e-6;
            let difference = (hexahedron.at(at + step) - hexahedron.at(at - step)) / 2e-6;
            assert!(difference.distance(jacobian.col(axis)) < 1e-8);
        }
    }
}
