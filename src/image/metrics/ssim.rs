//! Structural similarity.

use rayon::prelude::*;

/// Standard deviation of the Gaussian window, in pixels.
const SIGMA: f64 = 1.5;
/// The window has this many pixels on each side of its middle: 11 x 11 in all.
const RADIUS: usize = 5;
/// Constants that keep the quotients finite: (0.01 * 255)^2 and (0.03 * 255)^2.
const C1: f64 = 6.5025;
const C2: f64 = 58.5225;

/// Weighted means of a, b, a^2, b^2 and a*b under a window.
type Moments = [f64; 5];

/// Mean structural similarity of two 8-bit pictures' luma; 1 where they are equal.
///
/// Luma is `0.2126 R + 0.7152 G + 0.0722 B` of the sRGB values. Only windows that lie inside the
/// picture count; where a picture is narrower or lower than 11 pixels, the window is as wide or
/// high as the largest odd number of pixels that fits. Not a number where the lengths differ from
/// each other or from the size.
///
/// **Shape**: `a[y * width + x]`.
/// **Source**: Wang, Bovik, Sheikh and Simoncelli 2004, equation 13, with the covariance of the
/// population.
pub fn ssim_8bit(size: [u32; 2], a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    let [width, height] = size.map(|n| n as usize);
    let pixels = width.checked_mul(height);
    if pixels != Some(a.len()) || pixels != Some(b.len()) {
        return f64::NAN;
    }
    if a.is_empty() {
        return 1.0;
    }
    let [across, down] = [width, height].map(window);
    let [a, b] = [a, b].map(|p| p.iter().map(luma).collect::<Vec<f64>>());
    let row = |top: usize| {
        let rows = top * width..(top + down.len()) * width;
        let columns = column_moments(&a[rows.clone()], &b[rows], width, &down);
        let windows = columns.windows(across.len());
        windows.map(|w| similarity(row_moments(w, &across))).sum()
    };
    let rows = height + 1 - down.len();
    // Summed in order, so that the last digit does not depend on the threads.
    let sums: Vec<f64> = (0..rows).into_par_iter().map(row).collect();
    sums.iter().sum::<f64>() / (rows * (width + 1 - across.len())) as f64
}

fn luma(&[r, g, b]: &[u8; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// Weights of the window along a side of `length` pixels, at least one; their sum is 1.
fn window(length: usize) -> Vec<f64> {
    let radius = RADIUS.min((length - 1) / 2);
    let gauss = |n: usize| (-0.5 * ((n as f64 - radius as f64) / SIGMA).powi(2)).exp();
    let weights: Vec<f64> = (0..=2 * radius).map(gauss).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| w / sum).collect()
}

/// The window's means along each column of a band of rows.
fn column_moments(a: &[f64], b: &[f64], width: usize, weights: &[f64]) -> Vec<Moments> {
    let mut columns = vec![[0.0; 5]; width];
    let rows = a.chunks_exact(width).zip(b.chunks_exact(width));
    for ((a, b), weight) in rows.zip(weights) {
        for ((sum, a), b) in columns.iter_mut().zip(a).zip(b) {
            let (wa, wb) = (weight * a, weight * b);
            let terms = [wa, wb, wa * a, wb * b, wa * b];
            *sum = std::array::from_fn(|m| sum[m] + terms[m]);
        }
    }
    columns
}

fn row_moments(columns: &[Moments], weights: &[f64]) -> Moments {
    let add = |sum: Moments, (column, weight): (&Moments, &f64)| {
        std::array::from_fn(|m| sum[m] + weight * column[m])
    };
    columns.iter().zip(weights).fold([0.0; 5], add)
}

fn similarity([a, b, aa, bb, ab]: Moments) -> f64 {
    let (variances, covariance) = (aa - a * a + (bb - b * b), ab - a * b);
    let above = (2.0 * a * b + C1) * (2.0 * covariance + C2);
    above / ((a * a + b * b + C1) * (variances + C2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(values: &[u8]) -> Vec<[u8; 3]> {
        values.iter().map(|&v| [v; 3]).collect()
    }

    fn noise(size: [u32; 2], seed: u64) -> Vec<[u8; 3]> {
        let mut random = fastrand::Rng::with_seed(seed);
        let pixel = |_| std::array::from_fn(|_| random.u8(..));
        (0..size[0] * size[1]).map(pixel).collect()
    }

    /// The definition, window by window, without separating the directions.
    fn naive(size: [u32; 2], a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
        let [width, height] = size.map(|n| n as usize);
        let [radius_x, radius_y] = [width, height].map(|n| 5.min((n - 1) / 2));
        let (mut sum, mut windows) = (0.0, 0.0);
        for y in radius_y..height - radius_y {
            for x in radius_x..width - radius_x {
                let mut inside = Vec::new();
                for v in y - radius_y..=y + radius_y {
                    for u in x - radius_x..=x + radius_x {
                        let d2 = (u.abs_diff(x).pow(2) + v.abs_diff(y).pow(2)) as f64;
                        let at = u + width * v;
                        inside.push(((-d2 / 4.5).exp(), luma(&a[at]), luma(&b[at])));
                    }
                }
                let total: f64 = inside.iter().map(|i| i.0).sum();
                let mean = |f: &dyn Fn(f64, f64) -> f64| {
                    inside.iter().map(|i| i.0 * f(i.1, i.2)).sum::<f64>() / total
                };
                let (ma, mb) = (mean(&|a, _| a), mean(&|_, b| b));
                let var_a = mean(&|a, _| (a - ma).powi(2));
                let var_b = mean(&|_, b| (b - mb).powi(2));
                let cov = mean(&|a, b| (a - ma) * (b - mb));
                sum += (2.0 * ma * mb + 6.5025) / (ma * ma + mb * mb + 6.5025)
                    * (2.0 * cov + 58.5225)
                    / (var_a + var_b + 58.5225);
                windows += 1.0;
            }
        }
        sum / windows
    }

    #[test]
    fn ssim_by_hand() {
        // Even pictures have no variance: (2 * 100 * 50 + C1) / (100^2 + 50^2 + C1).
        let expected = 10_006.502_5 / 12_506.502_5;
        for size in [[1, 1], [3, 7], [11, 11], [20, 12]] {
            let pixels = (size[0] * size[1]) as usize;
            let found = ssim_8bit(size, &vec![[100; 3]; pixels], &vec![[50; 3]; pixels]);
            assert!((found - expected).abs() < 1e-9, "{size:?} {found}");
        }
        // Three pixels, one window; its middle weighs m = 1 / (1 + 2 exp(-1/4.5)) = 0.384397, so
        // the means are 100 m and 100 (1 - m), both variances 10000 m (1 - m), the covariance the
        // negative of that: 0.898638 * -0.975571.
        let found = ssim_8bit([3, 1], &gray(&[0, 100, 0]), &gray(&[100, 0, 100]));
        assert!((found + 0.876_686).abs() < 1e-6, "{found}");
    }

    #[test]
    fn ssim_is_that_of_the_definition_at_every_size() {
        let sizes = [
            [1, 1],
            [2, 3],
            [10, 4],
            [11, 11],
            [12, 10],
            [13, 17],
            [40, 5],
        ];
        for size in sizes {
            let [a, b] = [1, 2].map(|seed| noise(size, seed));
            let (found, expected) = (ssim_8bit(size, &a, &b), naive(size, &a, &b));
            assert!(
                (found - expected).abs() < 1e-11,
                "{size:?} {found} {expected}"
            );
            let swapped = ssim_8bit(size, &b, &a);
            assert!((found - swapped).abs() < 1e-14, "{size:?}");
            assert_eq!(ssim_8bit(size, &a, &a), 1.0, "{size:?}");
            assert!(found < 1.0, "{size:?}");
        }
    }

    #[test]
    fn ssim_of_unlike_sizes() {
        let (a, b) = (noise([4, 3], 1), noise([3, 3], 2));
        assert!(ssim_8bit([4, 3], &a, &b).is_nan());
        assert!(ssim_8bit([3, 3], &a, &a).is_nan());
        assert!(ssim_8bit([u32::MAX, u32::MAX], &a, &a).is_nan());
        assert_eq!(ssim_8bit([4, 0], &[], &[]), 1.0);
    }
}
