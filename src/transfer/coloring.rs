//! Color maps of parts that have one color each: bands and categories.

use super::function::Curve;
use super::presets::from_hex;

/// Twelve colors that people with each kind of color blindness tell apart as far as twelve can be, after
/// Krzywinski's palette for color blindness, in an order in which neighbors differ in hue and lightness.
pub const PALETTE: [u32; 12] = [
    0x008df9, 0xff6e3a, 0x009f81, 0xe20134, 0xffc33b, 0x8400cd, 0x00fccf, 0x9f0162, 0xffb2fd,
    0xa40122, 0x00c2f9, 0xff5aaf,
];

/// Colors for `count` categories; those of [`PALETTE`] again and again.
pub fn palette(count: usize) -> Vec<[f64; 3]> {
    let colors = PALETTE.iter().cycle().take(count);
    colors.map(|hex| from_hex(*hex)).collect()
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
    use crate::metrics::ciede2000_map;

    #[test]
    fn colors_of_the_palette_are_far_apart() {
        let bytes = |hex: u32| [16, 8, 0].map(|shift| (hex >> shift & 255) as u8);
        for (n, a) in PALETTE.iter().enumerate() {
            for b in &PALETTE[..n] {
                let apart = ciede2000_map(&[bytes(*a)], &[bytes(*b)]).unwrap()[0];
                assert!(apart > 10.0, "{a:06x} {b:06x}: {apart}");
            }
        }
        let again = palette(14);
        assert!(again[0] == again[12] && again[0] != again[1]);
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
