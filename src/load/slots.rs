//! How cell arrays of files map to the grid's active cells.

use strataray_parsers::egrid::PorosityModel;

use crate::model::Grid;

/// How cell arrays of a file map to the grid's active cells.
pub struct CellSlots {
    /// Natural index of each active cell.
    pub cells: Vec<u32>,
    /// All cells.
    total: usize,
    /// For dual porosity: by active cell, its rank among those with an active matrix.
    pub matrix: Option<Matrix>,
}

pub struct Matrix {
    rank: Vec<Option<u32>>,
    /// Active matrix cells, and matrix and fracture cells together.
    pub counts: [usize; 2],
}

impl CellSlots {
    pub fn new(grid: &Grid, actnum: Option<&[i32]>, model: PorosityModel) -> Self {
        let cells: Vec<u32> = grid.active_cells().iter().map(|c| c.0).collect();
        let matrix = actnum
            .filter(|_| model != PorosityModel::Single)
            .map(|actnum| {
                let mut counts = [0, 0];
                let rank = cells.iter().map(|&c| {
                    let flags = actnum[c as usize];
                    counts[1] += usize::from(flags & 2 != 0);
                    (flags & 1 != 0).then(|| {
                        counts[0] += 1;
                        counts[0] as u32 - 1
                    })
                });
                let rank = rank.collect();
                Matrix {
                    rank,
                    counts: [counts[0], counts[0] + counts[1]],
                }
            });
        Self {
            cells,
            total: grid.dims().cells(),
            matrix,
        }
    }

    /// True where an array of this length has a value for each active cell.
    pub fn fits(&self, count: usize) -> bool {
        let dual = self
            .matrix
            .as_ref()
            .is_some_and(|m| m.counts[1] == count || count == 2 * self.total);
        dual || count == self.total || count == self.cells.len() && self.matrix.is_none()
    }

    /// The values of the active cells from an array that fits.
    pub fn pick(&self, values: &[f32]) -> Vec<f32> {
        match &self.matrix {
            Some(m) if values.len() == m.counts[1] => m
                .rank
                .iter()
                .map(|r| r.map_or(f32::NAN, |r| values[r as usize]))
                .collect(),
            Some(m) => m
                .rank
                .iter()
                .zip(&self.cells)
                .map(|(r, &c)| {
                    if r.is_some() {
                        values[c as usize]
                    } else {
                        f32::NAN
                    }
                })
                .collect(),
            None if values.len() == self.cells.len() => values.to_vec(),
            None => self.cells.iter().map(|&c| values[c as usize]).collect(),
        }
    }
}
