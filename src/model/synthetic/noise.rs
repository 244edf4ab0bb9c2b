//! Smooth noise: random values at the points of a lattice, blended between them.

use glam::{DVec2, DVec3};

/// A smooth random function.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise(u64);

impl Noise {
    pub(super) fn new(random: &mut fastrand::Rng) -> Self {
        Self(random.u64(..))
    }

    /// A value in [-1, 1]; features are about one unit across, with finer ones of half their height.
    pub(super) fn at(self, p: DVec2) -> f64 {
        self.at3(p.extend(0.0))
    }

    /// The same over space.
    pub(super) fn at3(self, p: DVec3) -> f64 {
        // The second octave is moved so that lattice points do not fall together.
        (self.octave(p) + 0.5 * self.octave(2.0 * p + 0.37)) / 1.5
    }

    /// The sum of so many octaves, each of half the size and height of the one before, in [-1, 1].
    pub(super) fn fractal(self, p: DVec3, octaves: u32) -> f64 {
        let (mut sum, mut most) = (0.0, 0.0);
        for n in 0..octaves {
            let scale = f64::from(1_u32 << n);
            // Moved, so that lattice points do not fall together.
            sum += self.octave(scale * p + 0.37 * f64::from(n)) / scale;
            most += 1.0 / scale;
        }
        sum / most
    }

    fn octave(self, p: DVec3) -> f64 {
        let corner = p.floor();
        let f = p - corner;
        let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
        let [x, y, z] = corner.to_array().map(|v| v as i64);
        let along_x = |dy: i64, dz: i64| {
            let [a, b] = [0, 1].map(|dx| self.lattice(x + dx, y + dy, z + dz));
            a + w.x * (b - a)
        };
        let plane = |dz: i64| {
            let [a, b] = [0, 1].map(|dy| along_x(dy, dz));
            a + w.y * (b - a)
        };
        plane(0) + w.z * (plane(1) - plane(0))
    }

    /// A value in [-1, 1) that looks random.
    fn lattice(self, x: i64, y: i64, z: i64) -> f64 {
        let mut h = self.0;
        for v in [x, y, z] {
            h = (h ^ v as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            h ^= h >> 32;
        }
        (h >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// 0 up to 0, 1 from 1 on, smooth between them.
pub(super) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_and_uses_its_range() {
        let noise = Noise::new(&mut fastrand::Rng::with_seed(1));
        let values: Vec<f64> = (0..20_000)
            .map(|n| noise.at(DVec2::new(0.01 * f64::from(n), 0.003 * f64::from(n))))
            .collect();
        let (low, high) = values
            .iter()
            .fold((1.0f64, -1.0f64), |(a, b), v| (a.min(*v), b.max(*v)));
        assert!((-1.0..-0.6).contains(&low) && (0.6..1.0).contains(&high));
        assert!(values.windows(2).all(|w| (w[0] - w[1]).abs() < 0.1));
        let other = Noise::new(&mut fastrand::Rng::with_seed(2));
        assert_ne!(noise.at(DVec2::ONE), other.at(DVec2::ONE));
    }
}
