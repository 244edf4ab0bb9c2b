//! The depth lists that executors hold: those of columns with active cells, and where they lie.

use std::ops::Range;

use rayon::prelude::*;

use super::layout::BLOCK;
use crate::model::{DepthList, Grid, UsedDepths};
use crate::scene::Storage;

/// Depth lists in the order of their pillars, without gaps; or, where they are packed, with each row of pillars from the
/// begin of a block on: one row ends elsewhere than the next one begins, at other depths.
pub struct HeldLists<'a> {
    grid: &'a Grid,
    used: &'a UsedDepths,
    rows: Vec<Row>,
}

/// Lists without a gap between them.
struct Row {
    /// Their first entry among those that are used.
    used: usize,
    /// Where that is held.
    held: usize,
}

impl<'a> HeldLists<'a> {
    /// Of a grid.
    pub fn new(grid: &'a Grid, storage: Storage) -> Self {
        let used = grid.used_depths();
        let mut rows = vec![Row { used: 0, held: 0 }];
        if storage == Storage::Compact {
            let dims = grid.dims();
            for j in 0..=dims.nj {
                let first = (0..=dims.ni).find_map(|i| first_entry(grid, used, [i, j]));
                if let (Some(first), Some(before)) = (first, rows.last()) {
                    let end = before.held + first - before.used;
                    let held = end.next_multiple_of(BLOCK as usize);
                    rows.push(Row { used: first, held });
                }
            }
        }
        Self { grid, used, rows }
    }

    /// Where an entry is held that is used.
    fn place(&self, used: usize) -> usize {
        let behind = self.rows.partition_point(|row| row.used <= used);
        let row = &self.rows[behind.saturating_sub(1)];
        row.held + used - row.used
    }

    /// Where a list begins; `None` of one that is not held.
    pub fn offset(&self, list: DepthList) -> Option<usize> {
        self.used.offset(list).map(|used| self.place(used))
    }

    /// What is held of a pool; between rows there is what comes last before them.
    ///
    /// **Shape**: `pool` has one value for each entry of the pool of all lists.
    pub fn of<T: Copy + Send + Sync, H: Copy + Send>(
        &self,
        pool: &[T],
        made: impl Fn(T) -> H + Sync,
    ) -> Vec<H> {
        let used: Vec<&[T]> = self.used.of(pool).collect();
        let used = used.par_iter().flat_map(|part| part.par_iter());
        let held: Vec<H> = used.map(|entry| made(*entry)).collect();
        if self.rows.len() == 1 {
            return held;
        }
        let mut apart = Vec::with_capacity(self.place(held.len()));
        for (n, row) in self.rows.iter().enumerate() {
            if let Some(last) = apart.last() {
                apart.resize(row.held, *last);
            }
            let end = self.rows.get(n + 1).map_or(held.len(), |next| next.used);
            apart.extend_from_slice(&held[row.used..end]);
        }
        apart
    }

    /// The entries of each pillar, with those up to the next row.
    pub fn pillars(&self) -> Vec<Range<usize>> {
        let dims = self.grid.dims();
        let pillars = (0..(dims.ni + 1) * (dims.nj + 1)).into_par_iter();
        let starts = pillars.filter_map(|n| {
            let at = [n % (dims.ni + 1), n / (dims.ni + 1)];
            first_entry(self.grid, self.used, at).map(|used| self.place(used))
        });
        let mut starts: Vec<usize> = starts.collect();
        starts.push(self.place(self.used.count()));
        let pairs = starts.windows(2);
        pairs.map(|pair| pair[0]..pair[1]).collect()
    }
}

/// The first entry of the lists of a pillar among those that are used; `None` where none is.
fn first_entry(grid: &Grid, used: &UsedDepths, [pi, pj]: [usize; 2]) -> Option<usize> {
    let dims = grid.dims();
    let lists = (0..4).filter_map(|corner| {
        let i = pi.checked_sub(corner & 1).filter(|i| *i < dims.ni)?;
        let j = pj.checked_sub(corner >> 1).filter(|j| *j < dims.nj)?;
        used.offset(grid.column_lists(i + dims.ni * j)[corner])
    });
    lists.min()
}
