//! Which cells touch, and where a fault or the hull cuts them apart.

use rayon::prelude::*;

use super::grid::Grid;
use super::ids::Ijk;

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
        let [mine, theirs] = face.corners();
        let coincide = mine.iter().zip(theirs).all(|(&a, b)| {
            let (a, b) = (self.corner_entry(ijk, a), self.corner_entry(next, b));
            a == b || (self.depths()[a] - self.depths()[b]).abs() <= COINCIDENT
        });
        if coincide {
            Behind::Neighbor(next)
        } else {
            Behind::Displaced(next)
        }
    }

    /// The faces of the cells that `drawn` (by active index) names behind which no other of them
    /// shares the whole face: hull, fault faces, and those beside cells that are not drawn.
    pub fn boundary_faces(&self, drawn: &[bool]) -> Vec<(Ijk, Face)> {
        let is_drawn = |ijk: Ijk| {
            let active = self.active_index(self.dims().cell(ijk));
            active.is_some_and(|a| drawn.get(a.0 as usize) == Some(&true))
        };
        let is_open = |ijk: Ijk, face: Face| match self.behind(ijk, face) {
            Behind::Neighbor(next) => !is_drawn(next),
            Behind::Displaced(_) | Behind::Nothing => true,
        };
        self.faces_where(drawn, is_open)
    }

    pub(super) fn faces_where(
        &self,
        drawn: &[bool],
        holds: impl Fn(Ijk, Face) -> bool + Sync,
    ) -> Vec<(Ijk, Face)> {
        let holds = &holds;
        let cells = self.active_cells().par_iter().zip(drawn);
        cells
            .filter(|(_, drawn)| **drawn)
            .flat_map_iter(|(&cell, _)| {
                let ijk = self.dims().ijk(cell);
                let faces = Face::ALL.into_iter().filter(move |&f| holds(ijk, f));
                faces.map(move |face| (ijk, face))
            })
            .collect()
    }

    /// Number of fault faces along i and along j (`[I, J]`): lateral faces between two active
    /// cells of equal k whose corners do not all coincide.
    pub fn fault_faces(&self) -> [usize; 2] {
        [Face::IPlus, Face::JPlus].map(|face| {
            self.active_by_column()
                .filter(|&ijk| matches!(self.behind(ijk, face), Behind::Displaced(_)))
                .count()
        })
    }
}
