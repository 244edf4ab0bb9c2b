//! Which cells of a grid are active: bits in natural order, from which ranks follow, and bits column by column.

use rayon::prelude::*;

use super::ids::{CellIndex, Dims};

/// Cells of a word.
const WORD: usize = 64;

/// A bit for each cell, column by column: layers from the lowest bit on, in words that each belong to one column.
#[derive(Debug, Clone)]
pub struct ColumnBits {
    /// Words of a column.
    per_column: usize,
    words: Vec<u64>,
}

impl ColumnBits {
    /// The words of a column (`i + ni * j`).
    pub fn column(&self, column: usize) -> &[u64] {
        &self.words[self.per_column * column..][..self.per_column]
    }

    /// The layers of a column that have a bit, downward.
    pub fn layers(&self, column: usize) -> impl Iterator<Item = usize> + use<'_> {
        layers(self.column(column))
    }
}

/// The layers of a column's words that have a bit, downward.
pub(super) fn layers(words: &[u64]) -> impl Iterator<Item = usize> + use<'_> {
    let words = words.iter().enumerate();
    words.flat_map(|(n, word)| ones(*word).map(move |bit| WORD * n + bit))
}

/// Numbers of the bits of a word, rising.
pub(super) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = word.trailing_zeros() as usize;
        word &= word.wrapping_sub(1);
        (bit < WORD).then_some(bit)
    })
}

/// The active cells of a grid.
#[derive(Debug, Clone)]
pub(super) struct Activity {
    dims: Dims,
    /// Bits in natural order, and the number of active cells before each word.
    words: Vec<(u64, u32)>,
    columns: ColumnBits,
}

impl Activity {
    /// Of the active cells in natural order.
    pub fn new(dims: Dims, active: &[CellIndex]) -> Self {
        // One more word, so that every cell has one behind it.
        let mut words = vec![(0, 0); dims.cells() / WORD + 1];
        for cell in active {
            words[cell.0 as usize / WORD].0 |= 1 << (cell.0 as usize % WORD);
        }
        let mut before = 0;
        for (bits, rank) in &mut words {
            *rank = before;
            before += u64::count_ones(*bits);
        }
        let mut made = Self {
            dims,
            words,
            columns: ColumnBits {
                per_column: 0,
                words: Vec::new(),
            },
        };
        made.columns = made.bits_of(|_| true);
        made
    }

    /// Column by column.
    pub fn columns(&self) -> &ColumnBits {
        &self.columns
    }

    /// Rank of a cell among the active ones, `None` where it is inactive.
    pub fn rank(&self, cell: usize) -> Option<u32> {
        let is_active = self.words[cell / WORD].0 >> (cell % WORD) & 1 == 1;
        is_active.then(|| self.before(cell))
    }

    /// Number of active cells before a cell, or before the end.
    pub fn before(&self, cell: usize) -> u32 {
        let (bits, before) = self.words[cell / WORD];
        before + (bits & ((1 << (cell % WORD)) - 1)).count_ones()
    }

    /// The active cells of the row along i that begins with a cell: i and rank of each.
    pub fn row(&self, first: usize) -> impl Iterator<Item = (usize, usize)> + use<'_> {
        let is_active =
            move |i: &usize| self.words[(first + i) / WORD].0 >> ((first + i) % WORD) & 1 == 1;
        let ranks = self.before(first) as usize..;
        (0..self.dims.ni).filter(is_active).zip(ranks)
    }

    /// Bits of the active cells that `holds` (of the rank) holds for.
    pub fn bits_of(&self, holds: impl Fn(usize) -> bool + Sync) -> ColumnBits {
        let Dims { ni, nj, nk } = self.dims;
        let per_column = nk.div_ceil(WORD);
        let mut words = vec![0; per_column * ni * nj];
        let rows = words.par_chunks_mut(per_column * ni).enumerate();
        rows.for_each(|(j, row)| {
            for k in 0..nk {
                for (i, _) in self.row(ni * (j + nj * k)).filter(|(_, rank)| holds(*rank)) {
                    row[per_column * i + k / WORD] |= 1 << (k % WORD);
                }
            }
        });
        ColumnBits { per_column, words }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Ijk;

    #[test]
    fn ranks_rows_and_columns_tell_of_the_same_cells() {
        let dims = Dims {
            ni: 5,
            nj: 3,
            nk: 70,
        };
        let mut random = fastrand::Rng::with_seed(2);
        let is_active: Vec<bool> = (0..dims.cells()).map(|_| random.bool()).collect();
        let active = (0..dims.cells()).filter(|&cell| is_active[cell]);
        let active: Vec<_> = active.map(|cell| CellIndex(cell as u32)).collect();
        let activity = Activity::new(dims, &active);
        let odd = activity.bits_of(|rank| rank % 2 == 1);
        assert_eq!(activity.before(dims.cells()) as usize, active.len());
        for cell in 0..dims.cells() {
            let rank = active.binary_search(&CellIndex(cell as u32)).ok();
            assert_eq!(activity.rank(cell).map(|rank| rank as usize), rank);
            let Ijk { i, j, k } = dims.ijk(CellIndex(cell as u32));
            let has = |bits: &ColumnBits| bits.layers(i + dims.ni * j).any(|layer| layer == k);
            assert_eq!(has(activity.columns()), rank.is_some());
            assert_eq!(has(&odd), rank.is_some_and(|rank| rank % 2 == 1));
            let mut row = activity.row(cell - i);
            let found = row.find(|(at, _)| *at == i).map(|(_, rank)| rank);
            assert_eq!(found, rank);
        }
    }
}
