//! Index types: what a number counts is in its type.

/// Number of cells along i, j and k.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dims {
    /// Cells along i.
    pub ni: usize,
    /// Cells along j.
    pub nj: usize,
    /// Layers.
    pub nk: usize,
}

impl Dims {
    /// The cell by I, J, K counted from 1, as engineers do; `None` outside the grid.
    pub fn one_based(self, ijk: [usize; 3]) -> Option<Ijk> {
        let [i, j, k] = ijk;
        let inside = |n: usize, most: usize| (1..=most).contains(&n);
        (inside(i, self.ni) && inside(j, self.nj) && inside(k, self.nk)).then(|| Ijk {
            i: i - 1,
            j: j - 1,
            k: k - 1,
        })
    }

    /// All cells, active or not.
    pub fn cells(self) -> usize {
        self.ni * self.nj * self.nk
    }

    /// All cells, where that is at least one and at most 2^31-1, as files can number them.
    pub fn checked_cells(self) -> Option<usize> {
        let cells = self.ni.checked_mul(self.nj)?.checked_mul(self.nk)?;
        (1..1 << 31).contains(&cells).then_some(cells)
    }

    /// Columns of cells.
    pub fn columns(self) -> usize {
        self.ni * self.nj
    }

    /// Pillars: one more than the columns, each way.
    pub fn pillars(self) -> usize {
        (self.ni + 1) * (self.nj + 1)
    }

    /// The cell at `ijk`, in natural order (i fastest, then j, then k).
    pub fn cell(self, ijk: Ijk) -> CellIndex {
        CellIndex((ijk.i + self.ni * (ijk.j + self.nj * ijk.k)) as u32)
    }

    /// The position of a cell in natural order.
    pub fn ijk(self, cell: CellIndex) -> Ijk {
        let cell = cell.0 as usize;
        Ijk {
            i: cell % self.ni,
            j: cell / self.ni % self.nj,
            k: cell / self.columns(),
        }
    }
}

/// A cell among all cells, active or not, in natural order (i fastest, then j, then k).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellIndex(pub u32);

/// A cell among the active ones, in natural order; what result arrays are indexed by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ActiveIndex(pub u32);

/// Zero-based position of a cell; k grows downward.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Ijk {
    /// Along i.
    pub i: usize,
    /// Along j.
    pub j: usize,
    /// Layer, 0 on top.
    pub k: usize,
}

impl Ijk {
    /// The one-based triple that engineers and files use.
    pub fn one_based(self) -> [usize; 3] {
        [self.i + 1, self.j + 1, self.k + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_counted_from_one_lie_in_the_grid_or_are_none() {
        let dims = Dims {
            ni: 3,
            nj: 2,
            nk: 1,
        };
        assert_eq!(dims.one_based([3, 2, 1]), Some(Ijk { i: 2, j: 1, k: 0 }));
        for outside in [[0, 1, 1], [4, 1, 1], [1, 3, 1], [1, 1, 2], [usize::MAX; 3]] {
            assert_eq!(dims.one_based(outside), None, "{outside:?}");
        }
    }
}
