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

/// Zero-based position of a cell; k grows downwards.
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
