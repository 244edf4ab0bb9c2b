//! Boundaries between materials, found in the values: where they change most, opacity is put.
//!
//! After Kindlmann and Durkin 1998, semi-automatic generation of transfer functions for direct volume
//! rendering: the mean first derivative g(v) and the mean second derivative h(v) of all places that have
//! the value v. A boundary is a step blurred by a Gaussian: g is largest in its middle, where h falls
//! through zero, and p(v) = -sigma^2 h(v) / g(v) is how far a place of value v lies from the middle. Where
//! they take g above a fixed threshold, here it must stand out from its surroundings, because simulated
//! fields change a little everywhere. And p is taken to first order, (v - v0) / g(v0), because second
//! derivatives of cell values are rough.

use rayon::prelude::*;

use super::function::{Curve, segment};
use crate::model::derivatives::Sample;

/// A value at which a boundary lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boundary {
    /// The value in its middle.
    pub value: f64,
    /// Values below and above it that still belong to it.
    pub ends: [f64; 2],
    /// How much the field changes there beside where it changes most, above 0 up to 1.
    pub strength: f64,
}

const BINS: usize = 128;
/// Standard deviation of the Gaussian by which sums over bins are smoothed, in bins.
const SMOOTHING: f64 = 1.5;
/// A value is left out that has fewer smoothed samples: this many, and this part of all.
const FEW: (f64, f64) = (1.0, 5e-5);
/// A boundary's g rises above the higher of the lowest g on either side by this part of it.
const PROMINENCE: f64 = 0.3;
/// And is at least this part of the largest.
const LEAST: f64 = 0.25;
/// Boundaries at most: with three points each, the curve can still be edited by hand.
const MOST: usize = 3;
/// Standard deviations of the blur are taken to be between these, in cells.
const BLUR: [f64; 2] = [0.5, 1.0];

/// A boundary reaches so many bins to either side, at least and at most.
const NARROWEST: f64 = 7.0;
const WIDEST: f64 = 24.0;

/// Opacity per reference length in the middle of the strongest boundary.
const PEAK: f64 = 0.97;
/// Opacity between boundaries.
const FAINT: f64 = 0.015;

/// The boundaries in the values of a field, the strongest three, by rising value. None where the values
/// change as much everywhere, or where there are too few.
pub fn find(samples: &[Sample]) -> Vec<Boundary> {
    let Some(means) = Means::of(samples) else {
        return Vec::new();
    };
    let largest = largest(means.bins.iter().map(|b| b.first));
    let blur = means.blur();
    let candidates = (0..means.bins.len()).filter(|&n| means.stands_out(n));
    let boundary = |n: usize| {
        let slopes = means.slopes(n);
        let value = means.middle(n, slopes);
        let least = NARROWEST * means.width;
        let reach = (blur * means.bins[n].steep).clamp(least, WIDEST * means.width);
        let [below, above] = [value - slopes[0], slopes[1] - value].map(|s| s.clamp(least, reach));
        Boundary {
            value,
            ends: [value - below, value + above],
            strength: means.bins[n].first / largest,
        }
    };
    let mut found: Vec<Boundary> = candidates
        .map(boundary)
        .filter(|b| b.strength >= LEAST)
        .collect();
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    found.truncate(MOST);
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    found
}

/// An opacity curve over a range of values with a peak at each boundary, so faint between them that what
/// is behind is seen; `None` where no boundary lies in the range.
///
/// **Invariants**: positions rise from 0 to 1; at most eleven points.
pub fn curve(boundaries: &[Boundary], [low, high]: [f64; 2]) -> Option<Curve<f64>> {
    let mut points: Curve<f64> = Vec::new();
    for boundary in boundaries {
        // Neighbors share what lies between them.
        let [low, high] = boundary.ends;
        let low = points.last().map_or(low, |p: &(f64, f64)| low.max(p.0));
        points.extend([
            (low, FAINT),
            (boundary.value, PEAK * boundary.strength.sqrt()),
            (high, FAINT),
        ]);
    }
    let is_seen = |b: &Boundary| low < b.value && b.value < high;
    if !boundaries.iter().any(is_seen) {
        return None;
    }
    let position = |value: f64| (value - low) / (high - low);
    for point in &mut points {
        point.0 = position(point.0);
    }
    let end = |at: f64| {
        let (a, b, fraction) = segment(&points, at);
        (at, a + (b - a) * fraction)
    };
    let ends = [end(0.0), end(1.0)];
    points.retain(|p| 0.0 < p.0 && p.0 < 1.0);
    points.insert(0, ends[0]);
    points.push(ends[1]);
    Some(points)
}

/// Means over the places that have about one value.
struct Bin {
    value: f64,
    first: f64,
    second: f64,
    /// Mean first derivative weighted by itself, so that faces along the boundary do not count.
    steep: f64,
}

/// Bins by rising value; those with next to no samples are not there.
struct Means {
    bins: Vec<Bin>,
    /// Of a bin.
    width: f64,
}

impl Means {
    fn of(samples: &[Sample]) -> Option<Self> {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let values = samples.par_iter().filter(is_finite).map(|s| [s.value; 2]);
        let [low, high] = values.reduce(|| none, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let width = (high - low) / BINS as f64;
        if !(width > 0.0 && width.is_finite()) {
            return None;
        }
        let sums = smoothed(&sums(samples, low, width));
        let few = FEW.0.max(FEW.1 * samples.len() as f64);
        let bin = |(n, [count, first, second, squared]): (usize, [f64; 4])| {
            (count >= few).then(|| Bin {
                value: low + (n as f64 + 0.5) * width,
                first: first / count,
                second: second / count,
                steep: if first > 0.0 { squared / first } else { 0.0 },
            })
        };
        let bins = sums.into_iter().enumerate().filter_map(bin).collect();
        Some(Self { bins, width })
    }

    /// Standard deviation of the Gaussian that would have blurred steps into these boundaries: at the
    /// largest g and h, of the error function.
    fn blur(&self) -> f64 {
        let [first, second] = [
            largest(self.bins.iter().map(|b| b.first)),
            largest(self.bins.iter().map(|b| b.second)),
        ];
        let blur = first / (0.5f64.exp() * second);
        if blur.is_nan() {
            BLUR[0]
        } else {
            blur.clamp(BLUR[0], BLUR[1])
        }
    }

    /// True where g falls by enough on both sides before it is as large again.
    fn stands_out(&self, n: usize) -> bool {
        let top = self.bins[n].first;
        let lowest = |bins: &mut dyn Iterator<Item = &Bin>, ends: &dyn Fn(f64) -> bool| {
            let until = bins.map(|b| b.first).take_while(|g| !ends(*g));
            until.fold(top, f64::min)
        };
        // Of equal ones the last stands out.
        let before = lowest(&mut self.bins[..n].iter().rev(), &|g| g > top);
        let after = lowest(&mut self.bins[n + 1..].iter(), &|g| g >= top);
        top > 0.0 && top - before.max(after) >= PROMINENCE * top
    }

    /// Values below and above a bin at which g has fallen by half of what it falls by on that side.
    fn slopes(&self, n: usize) -> [f64; 2] {
        let top = self.bins[n].first;
        let side = |bins: &mut dyn Iterator<Item = &Bin>| {
            let side: Vec<&Bin> = bins.take_while(|b| b.first <= top).collect();
            let least = side.iter().map(|b| b.first).fold(top, f64::min);
            let half = 0.5 * (top + least);
            let end = side.iter().find(|b| b.first <= half);
            end.map_or(self.bins[n].value, |b| b.value)
        };
        let (before, after) = self.bins.split_at(n);
        [
            side(&mut before.iter().rev()),
            side(&mut after.iter().skip(1)),
        ]
    }

    /// The value nearest to that of a bin at which h falls through zero, between two values; the bin's
    /// own where there is none.
    fn middle(&self, n: usize, [low, high]: [f64; 2]) -> f64 {
        let crossings = self.bins.windows(2).filter_map(|pair| {
            let [a, b] = pair else { return None };
            // Between bins that are apart nothing is known of h.
            let are_adjacent = b.value - a.value < 1.5 * self.width;
            let falls = are_adjacent && a.second > 0.0 && b.second <= 0.0;
            let fraction = a.second / (a.second - b.second);
            let value = a.value + fraction * (b.value - a.value);
            (falls && low <= value && value <= high).then_some(value)
        });
        let own = self.bins[n].value;
        let distance = |v: &f64| (v - own).abs();
        crossings
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(own)
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

fn is_finite(sample: &&Sample) -> bool {
    let terms = [sample.value, sample.first.powi(2), sample.second];
    terms.iter().all(|v| v.is_finite())
}

/// Samples that one thread adds up at once; parts, so that the sums are the same with any number of them.
const PART: usize = 1 << 16;

/// Number of samples and sums of their first, second and squared first derivative, by bin.
fn sums(samples: &[Sample], low: f64, width: f64) -> Vec<[f64; 4]> {
    let part = |samples: &[Sample]| {
        let mut sums = vec![[0.0; 4]; BINS];
        for sample in samples.iter().filter(is_finite) {
            let bin = (((sample.value - low) / width) as usize).min(BINS - 1);
            add(
                &mut sums[bin],
                [1.0, sample.first, sample.second, sample.first.powi(2)],
            );
        }
        sums
    };
    let parts: Vec<_> = samples.par_chunks(PART).map(part).collect();
    let mut sums = vec![[0.0; 4]; BINS];
    for (bin, terms) in parts.iter().flat_map(|p| p.iter().enumerate()) {
        add(&mut sums[bin], *terms);
    }
    sums
}

fn add(sum: &mut [f64; 4], terms: [f64; 4]) {
    for (s, term) in sum.iter_mut().zip(terms) {
        *s += term;
    }
}

fn smoothed(sums: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let reach = (3.0 * SMOOTHING).ceil() as usize;
    let weight = |apart: usize| (-0.5 * (apart as f64 / SMOOTHING).powi(2)).exp();
    let total: f64 = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f64>();
    let smooth = |n: usize| {
        let mut sum = [0.0; 4];
        let around = n.saturating_sub(reach)..(n + reach + 1).min(sums.len());
        for (m, terms) in around.clone().zip(&sums[around]) {
            let weight = weight(n.abs_diff(m)) / total;
            add(&mut sum, terms.map(|term| weight * term));
        }
        sum
    };
    (0..sums.len()).map(smooth).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples along a line of a field of its place.
    fn along(field: impl Fn(f64) -> f64) -> Vec<Sample> {
        let h = 0.05;
        let places = (-4000..4000).map(|n| f64::from(n) * 0.01);
        let sample = |x: f64| Sample {
            value: field(x),
            first: ((field(x + h) - field(x - h)) / (2.0 * h)).abs(),
            second: (field(x + h) - 2.0 * field(x) + field(x - h)) / (h * h),
        };
        places.map(sample).collect()
    }

    /// A step from 0 to 1 blurred over about two lengths.
    fn front(x: f64) -> f64 {
        0.5 + 0.5 * (x / 1.2).tanh()
    }

    #[test]
    fn fronts_are_found_and_ramps_are_not() {
        let found = find(&along(|x| 20.0 + 60.0 * front(x)));
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].value - 50.0).abs() < 1.0, "{found:?}");
        let two = find(&along(|x| front(x + 20.0) + 2.0 * front(x - 20.0)));
        let values: Vec<f64> = two.iter().map(|b| b.value).collect();
        assert_eq!(two.len(), 2, "{two:?}");
        assert!((values[0] - 0.5).abs() < 0.05 && (values[1] - 2.0).abs() < 0.1);
        assert!(two[0].strength < two[1].strength);
        // Twins: a ramp, steep or not, and a curve that only gets steeper.
        for ramp in [|x: f64| x, |x: f64| 1e-6 * x, |x: f64| (0.05 * x).exp()] {
            assert_eq!(find(&along(ramp)), []);
        }
    }

    #[test]
    fn odd_samples_give_no_boundary() {
        assert_eq!(find(&[]), []);
        let sample = |value, first| Sample {
            value,
            first,
            second: 0.0,
        };
        assert_eq!(find(&[sample(1.0, 2.0)]), []);
        assert_eq!(find(&[sample(1.0, 0.0); 50]), []);
        // One place alone, however steep, is no boundary of many.
        let mut flat: Vec<Sample> = (0..20_000).map(|n| sample(f64::from(n), 0.1)).collect();
        flat.push(sample(7.0, 1e6));
        flat.push(sample(1e5, 1e6));
        assert!(
            find(&flat).iter().all(|b| b.value < 1e3),
            "{:?}",
            find(&flat)
        );
        for odd in [f64::NAN, f64::INFINITY, 1e308, -1e308] {
            find(&[sample(odd, 1.0), sample(0.0, odd), sample(1.0, 1.0)]);
        }
    }

    #[test]
    fn curves_rise_within_the_range() {
        let at = |value: f64, strength: f64| Boundary {
            value,
            ends: [value - 0.1, value + 0.1],
            strength,
        };
        let three = [at(0.3, 0.4), at(0.45, 1.0), at(0.9, 0.6)];
        for range in [[0.0, 1.0], [0.4, 0.5], [-1e6, 1e6], [0.35, 2.0]] {
            let curve = curve(&three, range).unwrap();
            assert!((2..=11).contains(&curve.len()), "{curve:?}");
            assert!(curve.is_sorted_by(|a, b| a.0 <= b.0));
            assert_eq!((curve[0].0, curve[curve.len() - 1].0), (0.0, 1.0));
            assert!(curve.iter().all(|p| (0.0..=PEAK).contains(&p.1)));
        }
        assert_eq!(curve(&three, [1.0, 2.0]), None);
        assert_eq!(curve(&three, [0.45, 0.45]), None);
        assert_eq!(curve(&[], [0.0, 1.0]), None);
    }
}
