//! All figures of two pictures.

use serde::Serialize;

use super::{ciede2000_map, mean, percentile, psnr_8bit, ssim_8bit};
use crate::image::Rgb8;

/// How far two 8-bit sRGB pictures are apart.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Comparison {
    /// Peak signal-to-noise ratio over all channels in dB; infinite where the pictures are equal,
    /// which JSON shows as `null`.
    pub psnr_db: f64,
    /// Mean structural similarity of the luma, at most 1.
    pub ssim: f64,
    /// Mean CIEDE2000 difference over the pixels.
    pub ciede2000_mean: f64,
    /// CIEDE2000 difference that 99 % of the pixels do not exceed.
    pub ciede2000_p99: f64,
}

/// The pictures have unlike sizes, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "images of {}x{} and {}x{} pixels cannot be compared: render both at one size",
    .0[0][0], .0[0][1], .0[1][0], .0[1][1]
)]
pub struct UnlikeSizes([[u32; 2]; 2]);

impl Comparison {
    /// Compares two pictures; which one is the reference makes no difference.
    ///
    /// # Errors
    /// When their sizes differ, when they have no pixels, or when a picture's number of pixels is
    /// not that of its size.
    pub fn of(a: &Rgb8, b: &Rgb8) -> Result<Self, UnlikeSizes> {
        let error = UnlikeSizes([a.size, b.size]);
        let ssim = ssim_8bit(a.size, &a.pixels, &b.pixels);
        let differences = ciede2000_map(&a.pixels, &b.pixels).ok_or(error)?;
        if a.size != b.size || differences.is_empty() || ssim.is_nan() {
            return Err(error);
        }
        Ok(Self {
            psnr_db: psnr_8bit(a.pixels.as_flattened(), b.pixels.as_flattened()),
            ssim,
            ciede2000_mean: mean(&differences),
            ciede2000_p99: percentile(&differences, 99.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(size: [u32; 2], value: u8) -> Rgb8 {
        Rgb8::filled(size, [value; 3])
    }

    #[test]
    fn ok_figures_by_their_names() {
        let (a, mut b) = (picture([20, 10], 0), picture([20, 10], 0));
        let equal = Comparison::of(&a, &b).unwrap();
        let json = r#"{"psnr_db":null,"ssim":1.0,"ciede2000_mean":0.0,"ciede2000_p99":0.0}"#;
        assert_eq!(serde_json::to_string(&equal).unwrap(), json);
        // Three of 200 pixels are white instead of black, so the mean square is 3/200 of the peak's.
        b.pixels[..3].fill([255; 3]);
        let found = Comparison::of(&a, &b).unwrap();
        assert!((found.psnr_db - 10.0 * (200.0f64 / 3.0).log10()).abs() < 1e-9);
        assert!((found.ciede2000_mean - 1.5).abs() < 1e-4);
        // Rank 0.99 * 199 = 197.01 of 0..199 lies among the three white ones, 197 to 199.
        assert!((found.ciede2000_p99 - 100.0).abs() < 1e-2);
        assert!(found.ssim < 1.0);
    }

    #[test]
    fn err_unlike_sizes() {
        let a = picture([4, 3], 7);
        let mut broken = a.clone();
        broken.pixels.pop();
        for (a, b) in [
            (&a, &picture([3, 4], 7)),
            (&a, &picture([4, 4], 7)),
            (&a, &broken),
            (&broken, &broken),
            (&picture([0, 5], 7), &picture([0, 5], 7)),
        ] {
            let error = Comparison::of(a, b).unwrap_err().to_string();
            assert!(error.contains(&format!("{}x{}", b.size[0], b.size[1])));
        }
        assert!(Comparison::of(&a, &a).is_ok());
    }
}
