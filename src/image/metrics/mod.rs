//! How far two pictures are apart.

mod ciede2000;
mod comparison;
mod psnr;
mod ssim;

pub use ciede2000::{ciede2000, ciede2000_map, lab, mean, percentile};
pub use comparison::{Comparison, UnlikeSizes};
pub use psnr::psnr_8bit;
pub use ssim::ssim_8bit;

/// Fraction of pixels, 0..1, whose four channels all differ by at most `tolerance`.
///
/// A channel that is not a number in either picture is never within. Pictures of different sizes
/// have nothing in common (0); two empty ones are equal (1).
pub fn fraction_within(a: &[[f32; 4]], b: &[[f32; 4]], tolerance: f32) -> f64 {
    if a.len() != b.len() {
        return 0.0;
    }
    if a.is_empty() {
        return 1.0;
    }
    let close = |(a, b): &(&[f32; 4], &[f32; 4])| {
        let mut channels = a.iter().zip(b.iter());
        channels.all(|(a, b)| (a - b).abs() <= tolerance)
    };
    a.iter().zip(b).filter(close).count() as f64 / a.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fraction_within_counts_pixels_by_their_worst_channel() {
        let a = [[0.5f32; 4]; 4];
        let mut b = a;
        assert_eq!(fraction_within(&a, &b, 0.0), 1.0);
        b[0][3] += 0.25; // just within
        b[1][0] += 0.251; // just not
        b[2][1] = f32::NAN;
        assert_eq!(fraction_within(&a, &b, 0.25), 0.5);
        assert_eq!(fraction_within(&b, &a, 0.25), 0.5);
        assert_eq!(fraction_within(&b, &b, f32::INFINITY), 0.75);
    }

    #[test]
    fn fraction_within_of_unlike_sizes() {
        assert_eq!(fraction_within(&[], &[], 0.0), 1.0);
        assert_eq!(fraction_within(&[[0.0; 4]], &[], 1.0), 0.0);
    }
}
