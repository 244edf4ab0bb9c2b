//! CIEDE2000 color difference.

use palette::color_difference::Ciede2000;
use palette::white_point::D65;
use palette::{FromColor, Lab, Xyz};
use rayon::prelude::*;

use crate::image::color::linear_from_srgb;

/// CIEDE2000 difference of two colors in L\*a\*b\*, with all three parametric factors 1.
///
/// `palette` does not take mean hues beyond 360 degrees back to the circle's start, which changes
/// such a difference by less than 5e-6 of itself.
///
/// **Source**: Sharma, Wu and Dalal 2005.
pub fn ciede2000(a: [f64; 3], b: [f64; 3]) -> f64 {
    let lab = |[l, a, b]: [f64; 3]| Lab::<D65, f64>::new(l, a, b);
    lab(a).difference(lab(b))
}

/// Linear sRGB to XYZ with the digits that scikit-image has, so that figures agree with it.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_453, 0.357_580, 0.180_423],
    [0.212_671, 0.715_160, 0.072_169],
    [0.019_334, 0.119_193, 0.950_227],
];

/// CIEDE2000 difference of each pixel of two 8-bit sRGB pictures; `None` where their lengths differ.
///
/// L\*a\*b\* refers to D65 and the observer of 2 degrees.
pub fn ciede2000_map(a: &[[u8; 3]], b: &[[u8; 3]]) -> Option<Vec<f64>> {
    let linear: [f64; 256] = std::array::from_fn(|v| linear_from_srgb(v as f64 / 255.0));
    let lab = |pixel: &[u8; 3]| lab_of(pixel.map(|v| linear[usize::from(v)]));
    let difference = |(a, b): (&[u8; 3], &[u8; 3])| match a == b {
        // Most of two pictures, often: background.
        true => 0.0,
        false => lab(a).difference(lab(b)),
    };
    let pairs = a.par_iter().zip(b);
    (a.len() == b.len()).then(|| pairs.map(difference).collect())
}

/// L\*a\*b\* of a color in sRGB, 0..1; D65 and the observer of 2 degrees.
pub fn lab(srgb: [f64; 3]) -> [f64; 3] {
    let Lab { l, a, b, .. } = lab_of(srgb.map(linear_from_srgb));
    [l, a, b]
}

fn lab_of(linear: [f64; 3]) -> Lab<D65, f64> {
    let [x, y, z] =
        XYZ_FROM_RGB.map(|row| row[0] * linear[0] + row[1] * linear[1] + row[2] * linear[2]);
    Lab::from_color(Xyz::<D65, f64>::new(x, y, z))
}

/// Mean of values; not a number where there are none.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Value that `percent` of the values do not exceed, linear between neighbors in rank; not a number
/// where there are no values.
pub fn percentile(values: &[f64], percent: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let rank = (percent / 100.0).clamp(0.0, 1.0) * (values.len() - 1) as f64;
    let mut values = values.to_vec();
    let (_, &mut below, rest) = values.select_nth_unstable_by(rank as usize, f64::total_cmp);
    let above = rest.iter().copied().min_by(f64::total_cmp);
    below + (above.unwrap_or(below) - below) * rank.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ciede2000_by_hand() {
        // Of two grays only lightness counts: dL / (1 + 0.015 (L - 50)^2 / sqrt(20 + (L - 50)^2)),
        // L their mean: 20 / (1 + 0.015 * 100 / sqrt(120)).
        let found = ciede2000([50.0, 0.0, 0.0], [70.0, 0.0, 0.0]);
        let expected = 20.0 / (1.0 + 1.5 / 120f64.sqrt());
        assert!((found - expected).abs() < 1e-12, "{found}");
        // Black and white are 100 apart: the mean lightness 50 has the weight 1.
        let found = ciede2000_map(&[[0; 3]], &[[255; 3]]).unwrap();
        assert!((found[0] - 100.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn ciede2000_of_equal_and_swapped_pictures() {
        let mut random = fastrand::Rng::with_seed(5);
        let mut picture = || -> Vec<[u8; 3]> {
            let pixel = |_| std::array::from_fn(|_| random.u8(..));
            (0..1000).map(pixel).collect()
        };
        let (a, b) = (picture(), picture());
        let [there, back] = [(&a, &b), (&b, &a)].map(|(a, b)| ciede2000_map(a, b).unwrap());
        assert!(there.iter().zip(&back).all(|(t, b)| (t - b).abs() < 1e-9));
        assert!(there.iter().all(|&d| d > 0.0 && d < 150.0));
        assert_eq!(ciede2000_map(&a, &a).unwrap(), vec![0.0; 1000]);
        // The formula itself, not only the short cut for equal pixels.
        assert_eq!(ciede2000([40.0, 20.0, -60.0], [40.0, 20.0, -60.0]), 0.0);
    }

    #[test]
    fn ciede2000_of_unlike_sizes() {
        assert_eq!(ciede2000_map(&[[0; 3]; 2], &[[0; 3]; 3]), None);
        assert_eq!(ciede2000_map(&[], &[]), Some(Vec::new()));
    }

    #[test]
    fn percentiles_by_hand() {
        let values = [40.0, 10.0, 30.0, 20.0];
        assert_eq!(mean(&values), 25.0);
        let found = [0.0, 25.0, 50.0, 99.0, 100.0, 300.0].map(|p| percentile(&values, p));
        // Rank 2.97 of 0..3 lies 0.97 of the way from 30 to 40.
        for (found, expected) in found.iter().zip([10.0, 17.5, 25.0, 39.7, 40.0, 40.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(percentile(&[7.0], 99.0), 7.0);
        assert!(percentile(&[], 99.0).is_nan() && mean(&[]).is_nan());
    }
}
