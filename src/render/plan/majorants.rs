//! The largest extinction that a transfer function gives to values of a range.

use super::layout::LUT_SIZE;
use super::transfer::extinctions;
use crate::transfer::TransferFunction;

/// Levels of the table.
const LEVELS: usize = LUT_SIZE.ilog2() as usize + 1;
/// Entries of a level.
const WIDTH: usize = LUT_SIZE as usize;

/// Largest extinctions of spans of the transfer table.
pub struct Majorants {
    /// Entry n of level l is that of 2^l entries of the transfer table from n on.
    table: Vec<f32>,
}

impl Majorants {
    /// Entries of all levels.
    pub const ENTRIES: usize = LEVELS * WIDTH;

    /// Those of a transfer function.
    pub fn new(transfer: &TransferFunction) -> Self {
        let entries = extinctions(transfer);
        let wider = |(level, below): &(usize, Vec<f32>)| {
            let half = 1 << level;
            let maximum = |n: usize| below[n].max(*below.get(n + half).unwrap_or(&0.0));
            Some((level + 1, (0..below.len()).map(maximum).collect()))
        };
        let levels = std::iter::successors(Some((0, entries)), wider).take(LEVELS);
        Self {
            table: levels.flat_map(|(_, level)| level).collect(),
        }
    }

    /// All levels, one after the other.
    pub fn table(&self) -> &[f32] {
        &self.table
    }

    /// The largest extinction between two positions in the transfer function, from 0 to 1: that of two spans of 2^l
    /// entries which overlap.
    pub fn between(&self, low: f32, high: f32) -> f32 {
        let [low, high] = [low, high].map(|position| position * (WIDTH - 1) as f32);
        let (first, last) = (low.floor() as usize, high.ceil() as usize);
        let level = (last - first + 1).ilog2() as usize;
        let row = &self.table[level * WIDTH..(level + 1) * WIDTH];
        row[first].max(row[last + 1 - (1 << level)])
    }

    /// True where some values show nothing.
    pub fn hide_some(&self) -> bool {
        self.table[..WIDTH].contains(&0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn majorants_are_the_largest_of_every_range() {
        let transfer = TransferFunction {
            color: vec![(0.0, [1.0; 3])],
            opacity: vec![(0.0, 0.3), (0.4, 0.0), (0.7, 0.9), (1.0, 0.1)],
            range: [0.0, 1.0],
            scale: crate::transfer::Scale::Linear,
            bands: None,
            reference_length: 1.0,
        };
        let entries = extinctions(&transfer);
        let majorants = Majorants::new(&transfer);
        let position = |n: usize| n as f32 / (entries.len() - 1) as f32;
        let mut random = fastrand::Rng::with_seed(3);
        let mut unlike_first = 0;
        for _ in 0..2000 {
            let first = random.usize(0..entries.len());
            let last = random.usize(first..entries.len());
            let found = majorants.between(position(first), position(last));
            let expected = entries[first..=last].iter().copied().fold(0.0, f32::max);
            // Positions are rounded, perhaps to an entry more on either side.
            let wider = &entries[first.saturating_sub(1)..(last + 2).min(entries.len())];
            let most = wider.iter().copied().fold(0.0, f32::max);
            assert!((expected..=most).contains(&found), "{first} {last}");
            unlike_first += usize::from(found != entries[first]);
        }
        assert!(unlike_first > 500);
    }
}
