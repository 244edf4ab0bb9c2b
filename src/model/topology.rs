//! Which cells touch, and where a fault or the hull cuts them apart.

use rayon::prelude::*;

use super::activity::{ColumnBits, layers, ones};
use super::grid::Grid;
use super::ids::{Dims, Ijk};

/// Corners closer than this along their pillar coincide (length units of the file).
pub const COINCIDENT: f64 = 1e-3;

/// A face of a cell, by the neighbor behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    /// Toward smaller i.
    IMinus,
    /// Toward larger i.
    IPlus,
    /// Toward smaller j.
    JMinus,
    /// Toward larger j.
    JPlus,
    /// Toward smaller k, upward.
    KMinus,
    /// Toward larger k, downward.
    KPlus,
}

impl Face {
    /// All six faces.
    pub const ALL: [Self; 6] = [
        Self::IMinus,
        Self::IPlus,
        Self::JMinus,
        Self::JPlus,
        Self::KMinus,
        Self::KPlus,
    ];

    /// Corner numbers of the face in the cell, and of the same corners in the cell behind it.
    pub fn corners(self) -> [[usize; 4]; 2] {
        match self {
            Self::IMinus => [[0, 2, 4, 6], [1, 3, 5, 7]],
            Self::IPlus => [[1, 3, 5, 7], [0, 2, 4, 6]],
            Self::JMinus => [[0, 1, 4, 5], [2, 3, 6, 7]],
            Self::JPlus => [[2, 3, 6, 7], [0, 1, 4, 5]],
            Self::KMinus => [[0, 1, 2, 3], [4, 5, 6, 7]],
            Self::KPlus => [[4, 5, 6, 7], [0, 1, 2, 3]],
        }
    }
}

/// What lies behind a face of an active cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Behind {
    /// An active cell that shares the whole face.
    Neighbor(Ijk),
    /// An active cell of the next column or layer whose corners are displaced.
    Displaced(Ijk),
    /// The hull of the grid or an inactive cell.
    Nothing,
}

impl Grid {
    /// The cell next to `ijk` across `face`, active or not; `None` outside the grid.
    pub fn adjacent(&self, ijk: Ijk, face: Face) -> Option<Ijk> {
        let dims = self.dims();
        let Ijk { i, j, k } = ijk;
        let next = match face {
            Face::IMinus => Ijk {
                i: i.checked_sub(1)?,
                j,
                k,
            },
            Face::JMinus => Ijk {
                i,
                j: j.checked_sub(1)?,
                k,
            },
            Face::KMinus => Ijk {
                i,
                j,
                k: k.checked_sub(1)?,
            },
            Face::IPlus => Ijk { i: i + 1, j, k },
            Face::JPlus => Ijk { i, j: j + 1, k },
            Face::KPlus => Ijk { i, j, k: k + 1 },
        };
        (next.i < dims.ni && next.j < dims.nj && next.k < dims.nk).then_some(next)
    }

    /// What lies behind `face` of the active cell `ijk`.
    pub fn behind(&self, ijk: Ijk, face: Face) -> Behind {
        let Some(next) = self.adjacent(ijk, face).filter(|&n| self.is_active(n)) else {
            return Behind::Nothing;
        };
        match self.coincide(ijk, next, face) {
            true => Behind::Neighbor(next),
            false => Behind::Displaced(next),
        }
    }

    /// True where all four corners of a face of a cell are those of the cell behind it.
    pub(super) fn coincide(&self, ijk: Ijk, next: Ijk, face: Face) -> bool {
        let [mine, theirs] = face.corners();
        mine.iter().zip(theirs).all(|(&a, b)| {
            let (a, b) = (self.corner_entry(ijk, a), self.corner_entry(next, b));
            a == b || (self.depths()[a] - self.depths()[b]).abs() <= COINCIDENT
        })
    }

    /// The faces of the cells that `drawn` (by active index) names behind which no other of them
    /// shares the whole face: hull, fault faces, and those beside cells that are not drawn. Column by column.
    pub fn boundary_faces(&self, drawn: &[bool]) -> Vec<(Ijk, Face)> {
        let drawn = self.bits_of(drawn);
        self.faces_where(&drawn, |column, face| {
            let beside = self.behind_column(&drawn, column, face);
            let shared = self.sharing(column, face, &beside);
            let words = drawn.column(column).iter().zip(shared);
            words.map(|(drawn, shared)| drawn & !shared).collect()
        })
    }

    /// The lateral faces of cells behind which an active cell of equal k is displaced, as words of their layers.
    pub(super) fn displaced(&self, cells: &ColumnBits, column: usize, face: Face) -> Vec<u64> {
        let mut beside = self.behind_column(self.active_bits(), column, face);
        for (beside, cells) in beside.iter_mut().zip(cells.column(column)) {
            *beside &= cells;
        }
        let shared = self.sharing(column, face, &beside);
        let words = beside.iter().zip(shared);
        words.map(|(beside, shared)| beside & !shared).collect()
    }

    /// The layers of a column behind whose `face` one of `cells` lies.
    fn behind_column(&self, cells: &ColumnBits, column: usize, face: Face) -> Vec<u64> {
        let own = cells.column(column);
        let at = |n: usize| own.get(n).copied().unwrap_or(0);
        match face {
            Face::KPlus => (0..own.len())
                .map(|n| at(n) >> 1 | at(n + 1) << 63)
                .collect(),
            Face::KMinus => (0..own.len())
                .map(|n| at(n) << 1 | at(n.wrapping_sub(1)) >> 63)
                .collect(),
            _ => match self.column_behind(column, face) {
                Some(next) => cells.column(next).to_vec(),
                None => vec![0; own.len()],
            },
        }
    }

    /// The column behind a lateral face of a column; the column itself behind the others.
    fn column_behind(&self, column: usize, face: Face) -> Option<usize> {
        let Dims { ni, nj, .. } = self.dims();
        let (i, j) = (column % ni, column / ni);
        let is_inside = match face {
            Face::IMinus => i > 0,
            Face::IPlus => i + 1 < ni,
            Face::JMinus => j > 0,
            Face::JPlus => j + 1 < nj,
            Face::KMinus | Face::KPlus => true,
        };
        let next = match face {
            Face::IMinus => column.wrapping_sub(1),
            Face::IPlus => column + 1,
            Face::JMinus => column.wrapping_sub(ni),
            Face::JPlus => column + ni,
            Face::KMinus | Face::KPlus => column,
        };
        is_inside.then_some(next)
    }

    /// Of some layers of a column, each with a cell behind its `face`, those whose cells share the whole face.
    fn sharing(&self, column: usize, face: Face, beside: &[u64]) -> Vec<u64> {
        let Some(next) = self.column_behind(column, face) else {
            return vec![0; beside.len()];
        };
        let [lists, behind] = [column, next].map(|c| self.column_lists(c));
        let [mine, theirs] = face.corners();
        let are_one = mine.iter().zip(theirs).all(|(a, b)| match next == column {
            // Of lists without gaps each bottom is the next top.
            true => !lists[a & 3].gapped(),
            false => lists[a & 3] == behind[b & 3],
        });
        if are_one {
            return beside.to_vec();
        }
        let (i, j) = (column % self.dims().ni, column / self.dims().ni);
        let mut shared = vec![0; beside.len()];
        for ijk in layers(beside).map(|k| Ijk { i, j, k }) {
            let next = self.adjacent(ijk, face);
            if next.is_some_and(|next| self.coincide(ijk, next, face)) {
                shared[ijk.k / 64] |= 1 << (ijk.k % 64);
            }
        }
        shared
    }

    /// Of the faces of some cells those that `open` finds, given a column and a face: as words of the column's layers.
    /// Column by column, downward.
    pub(super) fn faces_where(
        &self,
        cells: &ColumnBits,
        open: impl Fn(usize, Face) -> Vec<u64> + Sync,
    ) -> Vec<(Ijk, Face)> {
        let Dims { ni, .. } = self.dims();
        let of_column = |column: usize| {
            let mut found = Vec::new();
            if cells.column(column).iter().all(|word| *word == 0) {
                return found;
            }
            let faces = Face::ALL.map(|face| open(column, face));
            let (i, j) = (column % ni, column / ni);
            for n in 0..cells.column(column).len() {
                for bit in ones(faces.iter().fold(0, |any, words| any | words[n])) {
                    let k = 64 * n + bit;
                    let opens = |face: &Face| faces[*face as usize][n] >> bit & 1 == 1;
                    let of_cell = Face::ALL.into_iter().filter(opens);
                    found.extend(of_cell.map(|face| (Ijk { i, j, k }, face)));
                }
            }
            found
        };
        let columns = (0..self.dims().columns()).into_par_iter();
        columns.flat_map_iter(of_column).collect()
    }

    /// Number of fault faces of the main grid along i and along j (`[I, J]`): lateral faces between two active
    /// cells of equal k whose corners do not all coincide.
    pub fn fault_faces(&self) -> [usize; 2] {
        let active = self.active_bits();
        let ([lattice, main], nj) = ([self.dims().ni, self.main_dims().ni], self.main_dims().nj);
        let is_main = move |column: &usize| column % lattice < main && column / lattice < nj;
        [Face::IPlus, Face::JPlus].map(|face| {
            let columns = (0..self.dims().columns()).into_par_iter().filter(is_main);
            let words = columns.flat_map_iter(|column| self.displaced(active, column, face));
            words.map(|word| word.count_ones() as usize).sum()
        })
    }
}
