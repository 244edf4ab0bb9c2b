//! Light along a ray: found at equal distances, and linear between them. Extinction is blurred by a Gaussian, so that
//! light changes no faster than that, while samples lie as close as layers ask for.

use glam::Vec3A;

/// Where light is found along a ray, in standard deviations of the extinction's finest level. At this distance images
/// differ from those with light at every sample by less than light volumes do.
pub const SPACING: f64 = 0.5;

/// What light makes of a color: its factor, and what is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shade {
    /// The factor.
    pub factor: Vec3A,
    /// What is added.
    pub highlight: Vec3A,
}

impl Shade {
    /// Leaves colors as they are.
    pub const NONE: Self = Self {
        factor: Vec3A::ONE,
        highlight: Vec3A::ZERO,
    };

    /// The shaded color.
    #[inline]
    pub fn of(self, color: Vec3A) -> Vec3A {
        color * self.factor + self.highlight
    }

    /// A part of the way to another one.
    #[inline]
    pub fn lerp(self, other: Self, part: f32) -> Self {
        Self {
            factor: self.factor.lerp(other.factor, part),
            highlight: self.highlight.lerp(other.highlight, part),
        }
    }
}

/// The two places of a ray between which light was needed last.
#[derive(Clone, Copy)]
pub struct LightAlong {
    /// Number of the first one along the ray; `None` at its beginning.
    first: Option<i32>,
    found: [Shade; 2],
}

impl Default for LightAlong {
    fn default() -> Self {
        Self {
            first: None,
            found: [Shade::NONE; 2],
        }
    }
}

impl LightAlong {
    /// Light at a distance along the ray; `find` finds it, at each `spacing`.
    #[inline]
    pub fn at(&mut self, spacing: f32, distance: f32, find: impl Fn(f32) -> Shade) -> Shade {
        let place = distance / spacing;
        let first = place.floor();
        let number = first as i32;
        if self.first != Some(number) {
            let find = |number: i32| find(number as f32 * spacing);
            let known = match self.first {
                Some(first) if first == number - 1 => self.found[1],
                _ => find(number),
            };
            self.found = [known, find(number + 1)];
            self.first = Some(number);
        }
        let [before, behind] = self.found;
        before.lerp(behind, place - first)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn light_is_found_once_at_each_place_and_linear_between_them() {
        let asked = Cell::new(0);
        let find = |distance: f32| {
            asked.set(asked.get() + 1);
            Shade {
                factor: Vec3A::splat(distance * distance),
                highlight: Vec3A::ZERO,
            }
        };
        let mut along = LightAlong::default();
        for n in 0..100 {
            let distance = 0.1 * n as f32;
            let found = along.at(2.0, distance, find).factor.x;
            let low = 2.0 * (distance / 2.0).floor();
            let linear = low * low + (distance - low) * (2.0 * low + 2.0);
            assert!((found - linear).abs() < 1e-3, "{distance} {found} {linear}");
        }
        assert_eq!(asked.get(), 6);
        // Far ahead both places are new.
        along.at(2.0, 100.0, find);
        assert_eq!(asked.get(), 8);
    }
}
