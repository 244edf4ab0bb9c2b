//! Color maps of parts that have one color each: bands and categories.

use palette::{FromColor, Hsv, Oklab, Srgb};

use super::function::Curve;
use super::presets::from_hex;

/// Twelve colors that people with each kind of color blindness tell apart as far as twelve can be, after
/// Krzywinski's palette for color blindness, in an order in which neighbors differ in hue and lightness.
pub const PALETTE: [u32; 12] = [
    0x008df9, 0xff6e3a, 0x009f81, 0xe20134, 0xffc33b, 0x8400cd, 0x00fccf, 0x9f0162, 0xffb2fd,
    0xa40122, 0x00c2f9, 0xff5aaf,
];

/// Hues, saturations and values of the colors that the palette is continued with.
const MORE_HUES: u16 = 40;
const MORE_TONES: [(f32, f32); 6] = [
    (0.45, 0.95),
    (0.75, 0.9),
    (0.95, 0.8),
    (0.5, 0.7),
    (0.85, 0.55),
    (0.3, 0.8),
];
/// How much more the color before counts than those farther away.
const NEIGHBOR: f32 = 0.6;

/// Colors for `count` categories: those of [`PALETTE`], then each time the one that is farthest, in Oklab, from
/// all before it and above all from its neighbor. The first 240 or so have no repeats.
pub fn palette(count: usize) -> Vec<[f64; 3]> {
    let lab = |[r, g, b]: [f64; 3]| Oklab::from_color(Srgb::new(r, g, b).into_linear());
    let mut colors: Vec<[f64; 3]> = PALETTE
        .iter()
        .take(count)
        .map(|hex| from_hex(*hex))
        .collect();
    let mut more: Vec<More> = candidates()
        .map(|color| More {
            color,
            lab: lab(color),
            nearest: f64::INFINITY,
        })
        .collect();
    for color in &colors {
        more.iter_mut().for_each(|m| m.meet(lab(*color)));
    }
    while let Some(last) = colors.last().copied().filter(|_| colors.len() < count) {
        let last = lab(last);
        let apart = |m: &More| m.nearest.min(f64::from(NEIGHBOR) * m.distance(last));
        let best = more.iter().max_by(|a, b| apart(a).total_cmp(&apart(b)));
        let Some(color) = best.map(|m| m.color) else {
            break;
        };
        more.iter_mut().for_each(|m| m.meet(lab(color)));
        colors.push(color);
    }
    colors
}

/// A color that may continue the palette.
struct More {
    color: [f64; 3],
    lab: Oklab<f64>,
    /// Distance to the nearest color that was taken.
    nearest: f64,
}

impl More {
    fn distance(&self, other: Oklab<f64>) -> f64 {
        let lab = self.lab;
        let [l, a, b] = [lab.l - other.l, lab.a - other.a, lab.b - other.b];
        (l * l + a * a + b * b).sqrt()
    }

    fn meet(&mut self, taken: Oklab<f64>) {
        self.nearest = self.nearest.min(self.distance(taken));
    }
}

fn candidates() -> impl Iterator<Item = [f64; 3]> {
    let hues = (0..MORE_HUES).map(|n| 360.0 * f32::from(n) / f32::from(MORE_HUES));
    hues.flat_map(|hue| {
        MORE_TONES.map(|(saturation, value)| {
            let rgb: Srgb<f32> = Srgb::from_color(Hsv::new(hue, saturation, value));
            [rgb.red, rgb.green, rgb.blue].map(f64::from)
        })
    })
}

/// Each color over an equal part of 0..1: two points at one position where they meet.
pub fn parts(colors: &[[f64; 3]]) -> Curve<[f64; 3]> {
    let count = colors.len() as f64;
    let ends = |(n, color): (usize, &[f64; 3])| [n, n + 1].map(|end| (end as f64 / count, *color));
    colors.iter().enumerate().flat_map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::metrics::ciede2000_map;

    #[test]
    fn colors_of_the_palette_are_far_apart() {
        let bytes = |hex: u32| [16, 8, 0].map(|shift| (hex >> shift & 255) as u8);
        for (n, a) in PALETTE.iter().enumerate() {
            for b in &PALETTE[..n] {
                let apart = ciede2000_map(&[bytes(*a)], &[bytes(*b)]).unwrap()[0];
                assert!(apart > 10.0, "{a:06x} {b:06x}: {apart}");
            }
        }
    }

    #[test]
    fn many_categories_have_no_repeats_and_unlike_neighbors() {
        let colors = palette(64);
        assert_eq!(colors.len(), 64);
        let bytes = colors.iter().map(|c| c.map(|v| (255.0 * v).round() as u8));
        let bytes: Vec<[u8; 3]> = bytes.collect();
        for (n, a) in bytes.iter().enumerate() {
            for (m, b) in bytes[..n].iter().enumerate() {
                let apart = ciede2000_map(&[*a], &[*b]).unwrap()[0];
                let least = if m + 1 == n { 15.0 } else { 3.0 };
                assert!(apart > least, "{m} and {n}: {apart}");
            }
        }
        assert_eq!(palette(5), colors[..5]);
    }

    #[test]
    fn parts_are_constant_and_meet_sharply() {
        let map = parts(&[[0.0; 3], [0.5; 3], [1.0; 3]]);
        assert_eq!(map.len(), 6);
        assert_eq!(map[1].0, map[2].0);
        assert_eq!((map[0].0, map[5].0), (0.0, 1.0));
        assert!(map.is_sorted_by(|a, b| a.0 <= b.0));
    }
}
