//! Several grids in one: the main grid and its local grids lie side by side in one lattice of columns.
//!
//! ```text
//! +-----------------+   Each grid is a patch of the lattice. Between patches there is a row or a column without
//! |                 |   cells, so that no two of them share a pillar, and neighbors are found by arithmetic as in
//! |    main grid    |   one grid: beside a patch there is nothing. Rays that leave it are found again as they are
//! |                 |   behind a fault.
//! +-------+-+-------+
//! | LGR 1 | | LGR 2 |   Columns have as many layers as the deepest grid; those that a grid does not have are
//! +-------+ +-------+   inactive, and have no thickness.
//! ```

use std::ops::Range;

use super::ids::{CellIndex, Dims, Ijk};

/// A grid of the model, by its place in the lattice.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patch {
    /// Name of a local grid; empty for the main one.
    pub name: String,
    /// Number of the patch that it refines; 0 for the main one.
    pub parent: usize,
    /// Cells along i, j and k.
    pub dims: Dims,
    /// Layers of the main grid whose place it takes: those of a reservoir with pillars of its own. `None` of local grids.
    pub layers: Option<Range<usize>>,
    /// How many cells of the lattice along j are one cell of the file: circles need more corners than sectors have.
    pub split: usize,
    /// True where J of the file runs the other way: angles that run from I + to J - would turn cells inside out.
    pub is_reversed: bool,
    /// Column of the lattice, along i and j, where it begins.
    pub(super) first: [usize; 2],
    /// By cell, in natural order: the parent's cell that it lies in. None for the main grid.
    pub(super) hosts: Vec<CellIndex>,
}

impl Patch {
    /// Cells along i, j and k as the file counts them.
    pub fn file_dims(&self) -> Dims {
        Dims {
            nj: self.dims.nj / self.split,
            ..self.dims
        }
    }

    /// J in the file of one of its rows.
    pub(super) fn file_row(&self, j: usize) -> usize {
        self.turned(j / self.split)
    }

    /// The first of the rows that are one of the file.
    pub(super) fn first_row(&self, j: usize) -> usize {
        self.turned(j) * self.split
    }

    fn turned(&self, j: usize) -> usize {
        match self.is_reversed {
            true => (self.file_dims().nj - 1).saturating_sub(j),
            false => j,
        }
    }

    /// By cell, in natural order: the parent's cell that it lies in.
    pub(super) fn hosts(&self) -> &[CellIndex] {
        &self.hosts
    }

    /// Where one of its cells is in the lattice.
    pub(super) fn to_lattice(&self, own: Ijk) -> Ijk {
        let [i, j] = self.first;
        Ijk {
            i: i + own.i,
            j: j + own.j,
            k: own.k,
        }
    }

    /// Which of its cells a cell of the lattice is; `None` of one outside.
    pub(super) fn own(&self, at: Ijk) -> Option<Ijk> {
        let own = Ijk {
            i: at.i.checked_sub(self.first[0])?,
            j: at.j.checked_sub(self.first[1])?,
            k: at.k,
        };
        let Dims { ni, nj, nk } = self.dims;
        (own.i < ni && own.j < nj && own.k < nk).then_some(own)
    }
}

/// A cell as its file knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridCell<'a> {
    /// Name of the local grid; empty for the main one.
    pub grid: &'a str,
    /// I, J and K in that grid, from 1.
    pub ijk: [usize; 3],
}

impl std::fmt::Display for GridCell<'_> {
    /// `I 3  J 5  K 1`, with the name of a local grid before it.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [i, j, k] = self.ijk;
        if !self.grid.is_empty() {
            write!(f, "{}  ", self.grid)?;
        }
        write!(f, "I {i}  J {j}  K {k}")
    }
}

/// The patches of a lattice.
#[derive(Debug)]
pub(super) struct Patches {
    pub list: Vec<Patch>,
    /// By column of the lattice the patch that it is part of, or [`NO_PATCH`]; empty where there is one patch only.
    of_column: Vec<u32>,
}

const NO_PATCH: u32 = u32::MAX;

impl Patches {
    /// Of one grid alone.
    pub fn one(dims: Dims) -> Self {
        Self {
            list: vec![Patch {
                name: String::new(),
                parent: 0,
                dims,
                layers: None,
                split: 1,
                is_reversed: false,
                first: [0; 2],
                hosts: Vec::new(),
            }],
            of_column: Vec::new(),
        }
    }

    /// Lays local grids in rows below the main one, and returns the lattice's dimensions too, which may be more than can
    /// be numbered.
    pub fn lay_out(main: Dims, locals: Vec<Patch>) -> (Self, Dims) {
        let widest = locals.iter().map(|local| local.dims.ni).max();
        let mut lattice = Dims {
            ni: main.ni.max(widest.unwrap_or(0)),
            ..main
        };
        let mut patches = Self::one(main);
        let [mut left, mut top] = [0, main.nj + 1];
        for local in locals {
            let dims = local.dims;
            if left + dims.ni > lattice.ni {
                (left, top) = (0, lattice.nj + 1);
            }
            patches.list.push(Patch {
                first: [left, top],
                ..local
            });
            left += dims.ni + 1;
            lattice.nj = lattice.nj.max(top + dims.nj);
            lattice.nk = lattice.nk.max(dims.nk);
        }
        patches.of_column = vec![NO_PATCH; lattice.ni * lattice.nj];
        for (number, patch) in patches.list.iter().enumerate() {
            for j in patch.first[1]..patch.first[1] + patch.dims.nj {
                let row = lattice.ni * j + patch.first[0];
                patches.of_column[row..row + patch.dims.ni].fill(number as u32);
            }
        }
        (patches, lattice)
    }

    /// The number of the patch of a column of a lattice `ni` columns wide.
    pub fn at(&self, i: usize, j: usize, ni: usize) -> Option<usize> {
        if self.of_column.is_empty() {
            return Some(0);
        }
        let number = self.of_column[i + ni * j];
        (number != NO_PATCH).then_some(number as usize)
    }
}
