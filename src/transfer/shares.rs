//! Values below which given shares of a weight lie.

use rayon::prelude::*;

/// Parts that a range of values is cut into.
const BINS: usize = 1024;
/// Values that one thread adds up at a time; sums do not depend on the number of threads.
const PIECE: usize = 1 << 16;

/// A value and its weight, which is not negative.
pub(super) type Weighted = (f64, f64);

/// The values below which the given shares of the weight lie; `None` without weight. A value without weight may be
/// anything.
///
/// Found by sums over bins, and over bins of the one bin that a share ends in: nothing is sorted.
pub(super) fn shares_below<const N: usize>(
    values: impl IndexedParallelIterator<Item = Weighted> + Clone,
    shares: [f64; N],
) -> Option<[f64; N]> {
    let bins = Bins::of(values.clone())?;
    let total: f64 = bins.sums.iter().sum();
    Some(shares.map(|share| bins.value_at(values.clone(), share * total)))
}

/// Sums of weights over equal parts of a range of values.
struct Bins {
    low: f64,
    high: f64,
    sums: Vec<f64>,
}

impl Bins {
    fn of(values: impl IndexedParallelIterator<Item = Weighted> + Clone) -> Option<Self> {
        let start = [f64::INFINITY, f64::NEG_INFINITY];
        let join = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let weighty = values.clone().filter(|v| v.1 > 0.0);
        let [low, high] = weighty.map(|v| [v.0; 2]).reduce(|| start, join);
        let mut bins = Self {
            low,
            high,
            sums: vec![0.0; BINS],
        };
        let none = || vec![0.0; BINS];
        let pieces = values.fold_chunks(PIECE, none, |mut sums: Vec<f64>, (value, weight)| {
            if weight > 0.0 {
                sums[bins.bin(value)] += weight;
            }
            sums
        });
        for piece in pieces.collect::<Vec<_>>() {
            let sums = bins.sums.iter_mut().zip(piece);
            sums.for_each(|(sum, more)| *sum += more);
        }
        (low <= high).then_some(bins)
    }

    fn bin(&self, value: f64) -> usize {
        let place = (value - self.low) / (self.high - self.low) * BINS as f64;
        (place as usize).min(BINS - 1)
    }

    /// The first of the rising values up to which the weight is as large as wanted.
    fn value_at(&self, values: impl ParallelIterator<Item = Weighted>, wanted: f64) -> f64 {
        if self.low == self.high {
            return self.low;
        }
        let mut before = 0.0;
        let mut found = (0, 0.0);
        for (bin, sum) in self.sums.iter().enumerate().filter(|(_, sum)| **sum > 0.0) {
            found = (bin, before);
            before += sum;
            if before >= wanted {
                break;
            }
        }
        let (bin, before) = found;
        let members = values.filter(|v| v.1 > 0.0 && self.bin(v.0) == bin);
        let members: Vec<Weighted> = members.collect();
        let members = members.par_iter().copied();
        let bins = Self::of(members.clone());
        bins.map_or(self.low, |bins| bins.value_at(members, wanted - before))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_the_sorted_values() {
        let mut random = fastrand::Rng::with_seed(4);
        // Many of one value, many without weight, and values far from all others.
        let mut values: Vec<Weighted> = (0..20_000)
            .map(|n| match n % 4 {
                0 => (0.2, 1.0),
                1 => (f64::NAN, 0.0),
                2 => (random.f64(), f64::from(random.u32(1..5))),
                _ => (1e-9 * random.f64(), 0.5),
            })
            .collect();
        values.push((1e6, 2.0));
        let shares = [1e-6, 0.015, 0.4, 0.5, 0.7, 0.99, 1.0];
        let found = shares_below(values.par_iter().copied(), shares).unwrap();
        let mut sorted: Vec<_> = values.into_iter().filter(|v| v.1 > 0.0).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = sorted.iter().map(|v| v.1).sum();
        for (share, found) in shares.into_iter().zip(found) {
            let mut sum = 0.0;
            let expected = sorted.iter().find(|v| {
                sum += v.1;
                sum >= share * total
            });
            assert_eq!(expected.unwrap().0, found, "{share}");
        }
        assert_eq!(shares_below([(1.0, 0.0)].par_iter().copied(), [0.5]), None);
    }
}
