//! Voxel cone tracing (shih-2016) without a device: light along a cone through a pyramid of values.
//!
//! Each voxel of the pyramid holds how much of it cells cover, and mean and standard deviation of their values. The
//! opacity of a voxel is the mean of the curve's over values as a normal distribution has them; a table has it by mean
//! and deviation. So the pyramid follows the values alone, and an edited curve makes a new table.

use super::extinction::MOST_LEVELS;
use super::frame::ghost;
use super::layout::{VCT_DEVIATIONS, VCT_MEANS};
use crate::view::View;
use crate::view::lighting::Cone;
use crate::view::voxels::{Shape, Voxel};

/// Deviations of a value, as a part of the range, of one row of the table and of the next: a cube root of two.
const ROWS_PER_DOUBLING: f64 = 3.0;
/// The largest standard deviation that values from 0 to 1 can have.
const WIDEST: f64 = 0.5;
/// Standard deviations after which a normal distribution ends.
const REACH: f64 = 3.0;

/// What is known of a cone: where it starts, nothing, the factor on optical depths, nothing.
pub fn section(cone: &Cone) -> [f32; 4] {
    [cone.gap as f32, 0.0, cone.attenuation as f32, 0.0]
}

/// Steps along a cone, about, given the finest level's standard deviation in world space.
pub fn steps(cone: &Cone, sigma: f64) -> u32 {
    let (tangent, end) = (cone.half_angle.tan(), cone.length / sigma);
    let mut distance = cone.gap;
    let mut count = 0;
    while distance < end {
        distance += step(distance * tangent);
        count += 1;
    }
    count
}

/// Length of a step where the cone has a radius.
fn step(radius: f64) -> f64 {
    radius.max(1.0)
}

/// Standard deviation of values, as a part of the range, of a row of the table.
fn deviation(row: u32) -> f64 {
    match row {
        0 => 0.0,
        _ => WIDEST * (-f64::from(VCT_DEVIATIONS - 1 - row) / ROWS_PER_DOUBLING).exp2(),
    }
}

/// How a pyramid is laid out over a volume of values of a size.
pub fn shape(size: [u32; 3]) -> Shape {
    Shape {
        voxel: Voxel::Quad,
        ..Shape::single(size, MOST_LEVELS)
    }
}

/// Opacity of a unit of length by mean value and deviation, and that of inactive cells.
pub struct OpacityTable {
    /// Rows of means.
    rows: Vec<Vec<f64>>,
    ghost: f64,
}

impl OpacityTable {
    /// That of a view whose pyramid has the values of `range` as 0 and 1, with a unit of length in world space.
    pub fn new(view: &View, range: [f64; 2]) -> Self {
        let ghost = f64::from(ghost(view)[3]);
        let sigma = view.style.lighting.sigma();
        let [low, scale] = view.style.transfer.positions(range);
        let transfer = &view.style.transfer;
        let at = |n: u32| {
            let value = f64::from(n) / f64::from(VCT_MEANS - 1);
            let extinction = transfer.extinction((low + scale * value).clamp(0.0, 1.0));
            1.0 - (-extinction * sigma).exp()
        };
        let sharp: Vec<f64> = (0..VCT_MEANS).map(at).collect();
        Self {
            rows: (0..VCT_DEVIATIONS)
                .map(|row| blurred(&sharp, deviation(row)))
                .collect(),
            ghost: 1.0 - (-ghost * sigma).exp(),
        }
    }

    /// Texels row by row, each with the four numbers between which it is interpolated: of its mean and the next, and
    /// of these with the next deviation. Behind them the opacity of inactive cells.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        let last = |n: usize, count: u32| n.min(count as usize - 1);
        let mut texels = Vec::with_capacity((VCT_MEANS * VCT_DEVIATIONS + 1) as usize);
        for row in 0..self.rows.len() {
            let rows = [row, last(row + 1, VCT_DEVIATIONS)].map(|n| &self.rows[n]);
            for mean in 0..VCT_MEANS as usize {
                let next = last(mean + 1, VCT_MEANS);
                let [a, b] = rows.map(|row| [row[mean], row[next]]);
                texels.push([a[0], a[1], b[0], b[1]].map(|opacity| opacity as f32));
            }
        }
        texels.push([self.ghost as f32, 0.0, 0.0, 0.0]);
        texels
    }
}

/// Means of opacities over values around each one, as a normal distribution has them that ends where values do.
fn blurred(sharp: &[f64], deviation: f64) -> Vec<f64> {
    if deviation == 0.0 {
        return sharp.to_vec();
    }
    let width = deviation * (sharp.len() - 1) as f64;
    let reach = (REACH * width).ceil() as usize;
    let weights: Vec<f64> = (0..=reach)
        .map(|n| (-0.5 * (n as f64 / width).powi(2)).exp())
        .collect();
    let mean = |n: usize| {
        let (low, high) = (n.saturating_sub(reach), (n + reach).min(sharp.len() - 1));
        let (mut sum, mut total) = (0.0, 0.0);
        for at in low..=high {
            let weight = weights[at.abs_diff(n)];
            sum += weight * sharp[at];
            total += weight;
        }
        sum / total
    };
    (0..sharp.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_rise_to_the_widest_that_there_is() {
        assert_eq!([deviation(0), deviation(VCT_DEVIATIONS - 1)], [0.0, 0.5]);
        for row in 1..VCT_DEVIATIONS {
            assert!(deviation(row) > deviation(row - 1));
        }
        assert!(deviation(1) < 1.0 / f64::from(VCT_MEANS));
    }

    #[test]
    fn an_even_curve_stays_and_a_peak_is_spread() {
        let even = blurred(&[0.3; 64], 0.2);
        assert!(even.iter().all(|a| (a - 0.3).abs() < 1e-12));
        let mut sharp = vec![0.0; 1001];
        sharp[500] = 1.0;
        let spread = blurred(&sharp, 0.01);
        // A normal distribution of ten entries.
        assert!((spread[500] - 0.039_99).abs() < 1e-3, "{}", spread[500]);
        assert!((spread[510] / spread[500] - (-0.5f64).exp()).abs() < 1e-6);
        assert_eq!(spread[560], 0.0);
        assert_eq!(blurred(&sharp, 0.0), sharp);
    }

    #[test]
    fn steps_are_as_long_as_the_cone_is_wide() {
        let cone = |half_angle: f64, length| Cone {
            half_angle,
            splits: 1,
            attenuation: 1.0,
            gap: 3.0,
            length,
            even_media: false,
        };
        assert_eq!(steps(&cone(0.0, 13.0), 1.0), 10);
        assert_eq!(steps(&cone(0.0, 130.0), 10.0), 10);
        let wide = steps(&cone(20f64.to_radians(), 100.0), 1.0);
        assert!((11..14).contains(&wide), "{wide}");
    }
}
