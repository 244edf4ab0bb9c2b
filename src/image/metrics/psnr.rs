//! Peak signal-to-noise ratio.

/// Peak signal-to-noise ratio of two 8-bit pictures over all channels, in dB (peak 255).
///
/// Infinite where they are equal; not a number where their lengths differ.
pub fn psnr_8bit(a: &[u8], b: &[u8]) -> f64 {
    if a.len() != b.len() {
        return f64::NAN;
    }
    let squared = |(&a, &b): (&u8, &u8)| u64::from(a.abs_diff(b)).pow(2);
    let sum: u64 = a.iter().zip(b).map(squared).sum();
    if sum == 0 {
        return f64::INFINITY;
    }
    let mean = sum as f64 / a.len() as f64;
    10.0 * (255.0 * 255.0 / mean).log10()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn psnr_by_hand() {
        // Mean square (3^2 + 4^2) / 4 = 6.25; 10 log10(65025 / 6.25) = 40.1720 dB.
        let found = psnr_8bit(&[10, 20, 30, 40], &[13, 16, 30, 40]);
        assert!((found - 40.172_003_435_238_4).abs() < 1e-9, "{found}");
        // One step everywhere: 20 log10 255.
        let found = psnr_8bit(&[7; 9], &[8; 9]);
        assert!((found - 20.0 * 255f64.log10()).abs() < 1e-12);
    }

    #[test]
    fn psnr_of_equal_opposite_and_unlike_pictures() {
        assert_eq!(psnr_8bit(&[1, 2, 3], &[1, 2, 3]), f64::INFINITY);
        assert_eq!(psnr_8bit(&[], &[]), f64::INFINITY);
        assert_eq!(psnr_8bit(&[0; 4], &[255; 4]), 0.0);
        assert!(psnr_8bit(&[1, 2], &[1]).is_nan());
    }
}
