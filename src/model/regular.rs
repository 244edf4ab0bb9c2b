//! Grids of equal cells: the lattice of a regular volume, whose samples are the middles of cells.

use std::sync::Arc;

use glam::DVec3;

use super::activity::Activity;
use super::corner_point::NO_THICKNESS;
use super::depth_lists::DepthList;
use super::grid::{Found, Grid, ModelError, Pillar};
use super::ids::{CellIndex, Dims};
use super::patches::Patches;

/// Cells whose edges span less than this part of a box of these lengths are flat.
const FLAT: f64 = 1e-9;

/// A lattice of equal cells, parallelepipeds of any shape whose layers go down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularLattice {
    /// Cells along each axis.
    pub dims: Dims,
    /// Middle of the first cell (x, y, depth).
    pub first: DVec3,
    /// Steps to the next cell along i, j and k.
    pub edges: [DVec3; 3],
}

impl RegularLattice {
    /// The place that is so many steps from the middle of the first cell.
    pub fn place(&self, steps: [f64; 3]) -> DVec3 {
        let moves = self.edges.iter().zip(steps).map(|(edge, n)| *edge * n);
        moves.fold(self.first, |place, step| place + step)
    }

    /// Why there is no grid of such cells; `None` where there is one.
    fn objection(&self) -> Option<&'static str> {
        let [i, j, k] = self.edges;
        let longest = i.length() * j.length() * k.length();
        match () {
            () if !longest.is_finite() || !self.first.is_finite() => {
                Some("steps between cells are no finite numbers")
            }
            () if k.z <= NO_THICKNESS => Some("layers do not go down by more than 1e-6"),
            () if i.cross(j).dot(k).abs() <= FLAT * longest => {
                Some("the axes lie in one plane, or one of them has no length")
            }
            () => None,
        }
    }
}

impl Grid {
    /// The grid of a regular lattice, all of whose cells are active.
    ///
    /// # Errors
    /// When there are no cells, more than 2^31-1, more than there is memory for, or cells without a volume.
    pub fn regular(lattice: &RegularLattice) -> Result<Self, ModelError> {
        let dims = lattice.dims;
        let Dims { ni, nj, nk } = dims;
        let cells = dims.checked_cells();
        let cells = cells.ok_or(ModelError::Dimensions(ni, nj, nk))?;
        if let Some(why) = lattice.objection() {
            return Err(ModelError::Lattice(why));
        }
        let count = nk + 1;
        // Offsets of lists have 31 bits.
        let entries = count.checked_mul(dims.pillars()).filter(|n| n >> 31 == 0);
        let entries = entries.ok_or(ModelError::Dimensions(ni, nj, nk))?;
        // A plain allocation would end the process where memory is short.
        let mut depths: Vec<f64> = Vec::new();
        let mut active_cells: Vec<CellIndex> = Vec::new();
        let room = depths.try_reserve_exact(entries);
        room.and_then(|()| active_cells.try_reserve_exact(cells))
            .map_err(|_| ModelError::Memory(ni, nj, nk))?;
        let node = |i: usize, j: usize, k: usize| lattice.place([i, j, k].map(|n| n as f64 - 0.5));
        let mut pillars = Vec::with_capacity(dims.pillars());
        for j in 0..=nj {
            for i in 0..=ni {
                pillars.push(Pillar {
                    top: node(i, j, 0),
                    bottom: node(i, j, nk),
                });
                // A list for each pillar: values at vertices are by place in the pool.
                depths.extend((0..count).map(|k| node(i, j, k).z));
            }
        }
        let list = |n: usize| {
            let (i, j) = (n / 4 % ni + (n & 1), n / 4 / ni + (n >> 1 & 1));
            DepthList::new(count * (i + (ni + 1) * j), false)
        };
        active_cells.extend((0..cells as u32).map(CellIndex));
        Ok(Self {
            dims,
            slopes: pillars.iter().map(Pillar::slope).collect(),
            pillars: pillars.into(),
            lists: Arc::new((0..4 * dims.columns()).map(list).collect()),
            depths: Arc::new(depths),
            sorted: Arc::new(vec![true; dims.columns()]),
            activity: Activity::new(dims, &active_cells),
            active_cells,
            map_axes: None,
            patches: Arc::new(Patches::one(dims)),
            flat: None,
            found: Found::default(),
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::model::GridInput;

    fn sheared() -> RegularLattice {
        RegularLattice {
            dims: Dims {
                ni: 4,
                nj: 3,
                nk: 5,
            },
            first: DVec3::new(431_000.0, 6_470_000.0, 1000.0),
            edges: [
                DVec3::new(20.0, -9.0, 1.0),
                DVec3::new(7.5, 21.0, -0.5),
                DVec3::new(1.0, 0.5, 4.0),
            ],
        }
    }

    #[test]
    fn middles_of_cells_are_the_places_of_samples() {
        let lattice = sheared();
        let grid = Grid::regular(&lattice).unwrap();
        assert_eq!(grid.active_cells().len(), 60);
        for cell in grid.active_cells() {
            let ijk = grid.dims().ijk(*cell);
            let steps = [ijk.i as f64, ijk.j as f64, ijk.k as f64];
            let middle = grid.hexahedron(ijk).at(DVec3::ZERO);
            assert!(middle.distance(lattice.place(steps)) < 1e-8, "{ijk:?}");
            // Half a cell away it is not.
            let off = lattice.place(steps.map(|n| n + 0.5));
            assert!(middle.distance(off) > 5.0);
        }
        let volume = lattice.edges[0].cross(lattice.edges[1]);
        let volume = 60.0 * volume.dot(lattice.edges[2]);
        assert!((grid.signed_bulk_volume() / volume - 1.0).abs() < 1e-9);
        assert_eq!(grid.fault_faces(), [0, 0]);
    }

    /// As the same corners written as arrays of a file.
    #[test]
    fn it_is_the_grid_of_the_same_corners() {
        let lattice = sheared();
        let Dims { ni, nj, nk } = lattice.dims;
        let node = |i: usize, j: usize, k: usize| lattice.place([i, j, k].map(|n| n as f64 - 0.5));
        let mut coord = Vec::new();
        for j in 0..=nj {
            for i in 0..=ni {
                coord.extend(node(i, j, 0).to_array());
                coord.extend(node(i, j, nk).to_array());
            }
        }
        let mut zcorn = Vec::new();
        for z in 0..2 * nk {
            for y in 0..2 * nj {
                for x in 0..2 * ni {
                    zcorn.push(node(x.div_ceil(2), y.div_ceil(2), z.div_ceil(2)).z);
                }
            }
        }
        let input = |zcorn: &[f64]| {
            Grid::new(&GridInput {
                dims: lattice.dims,
                coord: &coord,
                zcorn,
                actnum: None,
                map_axes: None,
            })
            .unwrap()
        };
        let grid = Grid::regular(&lattice).unwrap();
        assert!(grid.has_equal_geometry(&input(&zcorn)));
        zcorn[7] += 0.25;
        assert!(!grid.has_equal_geometry(&input(&zcorn)));
    }

    #[test]
    fn lattices_without_volume_are_refused() {
        let said = |change: &dyn Fn(&mut RegularLattice)| {
            let mut lattice = sheared();
            change(&mut lattice);
            Grid::regular(&lattice).map(drop).map_err(|e| e.to_string())
        };
        assert_eq!(said(&|_| {}), Ok(()));
        let upward = said(&|l| l.edges[2].z = -4.0).unwrap_err();
        assert!(upward.contains("do not go down"), "{upward}");
        let flat = said(&|l| l.edges[1] = 2.0 * l.edges[0]).unwrap_err();
        assert!(flat.contains("one plane"), "{flat}");
        let endless = said(&|l| l.first.x = f64::INFINITY).unwrap_err();
        assert!(endless.contains("finite"), "{endless}");
        let none = said(&|l| l.dims.nk = 0).unwrap_err();
        assert!(none.contains("not supported"), "{none}");
    }
}
