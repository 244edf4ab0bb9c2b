//! Light along a ray: found at equal distances, and linear between them. Extinction is blurred by a Gaussian, so that
//! light changes no faster than that, while samples lie as close as layers ask for.

use super::frame::Ray;
use super::shading::{Shade, Shading};

/// Where light is found along a ray, in standard deviations of the extinction's finest level. At this distance images
/// differ from those with light at every sample by less than light volumes do.
pub const SPACING: f64 = 0.5;

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
    /// Light at a distance along the ray, where it is found at each `spacing`.
    #[inline]
    pub fn at(&mut self, shading: &Shading<'_>, ray: &Ray, spacing: f32, distance: f32) -> Shade {
        let place = distance / spacing;
        let first = place.floor();
        let number = first as i32;
        if self.first != Some(number) {
            self.found = self.around(shading, ray, spacing, number);
            self.first = Some(number);
        }
        let [before, behind] = self.found;
        before.lerp(behind, place - first)
    }

    /// Light at the places that have this number and the next one.
    fn around(&self, shading: &Shading<'_>, ray: &Ray, spacing: f32, number: i32) -> [Shade; 2] {
        let find = |number: i32| shading.find(ray.at(number as f32 * spacing), false);
        let known = match self.first {
            Some(first) if first == number - 1 => self.found[1],
            _ => find(number),
        };
        [known, find(number + 1)]
    }
}
