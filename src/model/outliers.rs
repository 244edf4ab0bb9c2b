//! Cells far outside of the model, as one damaged number of a file makes them. They would be most of what a camera
//! frames and what rays have to cross, so they are made inactive, and what their columns share with others is mended.

use glam::DVec3;
use rayon::prelude::*;

use super::column::Column;
use super::depth_lists::DepthList;
use super::grid::{Grid, Pillar};
use super::ids::{CellIndex, Ijk};

/// Distance of an outlier from the middle half of the corners, in parts of the extent of these.
pub const FAR: f64 = 1000.0;
/// Least height of that extent, in parts of its width: models are flat, and their layers may dip.
const FLATTEST: f64 = 0.01;
/// As [`FAR`], for the ends of a slanted pillar: beyond that 32 bits do not tell the way of the line near the model.
const FAR_END: f64 = 1e6;
/// Cells whose corners tell the extent.
const SAMPLED: usize = 4096;

/// The part of space in which cells can be.
#[derive(Debug, Clone, Copy)]
struct Reach {
    low: DVec3,
    high: DVec3,
    /// Width of the middle half of the corners.
    width: f64,
    /// Depths between which pillars end.
    ends: [f64; 2],
}

impl Reach {
    /// Of the active cells; `None` where they have no extent. Up to a quarter of the corners may be anywhere.
    fn of(grid: &Grid) -> Option<Self> {
        let cells = grid.active_cells();
        let sampled = cells.iter().step_by(cells.len().div_ceil(SAMPLED).max(1));
        let corners = sampled.flat_map(|cell| grid.hexahedron(grid.dims().ijk(*cell)).0);
        let corners: Vec<DVec3> = corners.collect();
        if corners.is_empty() {
            return None;
        }
        let quartiles = [0, 1, 2].map(|axis| {
            let mut values: Vec<f64> = corners.iter().map(|corner| corner[axis]).collect();
            let quarter = values.len() / 4;
            [quarter, 3 * quarter].map(|n| *values.select_nth_unstable_by(n, f64::total_cmp).1)
        });
        let [low, high] = [0, 1].map(|end| DVec3::from_array(quartiles.map(|q| q[end])));
        let size = high - low;
        let width = size.x.max(size.y);
        let height = size.z.max(FLATTEST * width);
        let width = width.max(FLATTEST * height);
        let is_known = width > 0.0 && width.is_finite() && height.is_finite();
        let far = FAR * DVec3::new(width, width, height);
        is_known.then_some(Self {
            low: low - far,
            high: high + far,
            width,
            ends: [low.z - FAR_END * height, high.z + FAR_END * height],
        })
    }

    /// False of what is not a number, too.
    fn holds(&self, point: DVec3) -> bool {
        self.low.cmple(point).all() && point.cmple(self.high).all()
    }

    fn holds_depth(&self, depth: f64) -> bool {
        (self.low.z..=self.high.z).contains(&depth)
    }

    /// True where the line of a pillar is well known.
    fn holds_ends(&self, pillar: &Pillar) -> bool {
        let [top, bottom] = [pillar.top, pillar.bottom];
        let [least, most] = self.ends;
        let is_near = |end: DVec3| (least..=most).contains(&end.z);
        let lean = (bottom - top).truncate().length();
        is_near(top) && is_near(bottom) || lean <= 1e-9 * self.width
    }
}

impl Grid {
    /// Makes the active cells inactive that have a corner far outside of the others ([`FAR`]), and gives them in natural
    /// order. Their columns then lie within the box of the others.
    pub fn leave_outliers(&mut self) -> Vec<CellIndex> {
        let Some(reach) = Reach::of(self) else {
            return Vec::new();
        };
        let columns: Vec<usize> = self.columns_beyond(&reach);
        let cells = columns.iter().flat_map(|column| {
            let column = self.column(*column);
            let has_pillars = self.knows_pillars(&reach, &column);
            let is_out = move |k: &usize| {
                let corners = column.hexahedron(*k).0;
                !has_pillars || corners.iter().any(|corner| !reach.holds(*corner))
            };
            let layers: Vec<usize> = column.active().filter(is_out).collect();
            let (i, j) = (column.i, column.j);
            layers.into_iter().map(move |k| Ijk { i, j, k })
        });
        let mut outliers: Vec<CellIndex> = cells.map(|cell| self.dims.cell(cell)).collect();
        outliers.sort_unstable();
        if !outliers.is_empty() {
            self.retain_active(|cell| outliers.binary_search(&cell).is_err());
        }
        if let Some(bounds) = self.bounds() {
            self.mend(&columns, &reach, bounds);
        }
        outliers
    }

    /// The columns with active cells that have a pillar or a layer beyond.
    fn columns_beyond(&self, reach: &Reach) -> Vec<usize> {
        let is_beyond = |(_, column): &(usize, Column<'_>)| {
            let mut active = column.active();
            let is_within = || {
                let ends = column.ends(0..self.dims.nk);
                let mut ends = ends.iter().flatten().flatten();
                ends.all(|end| reach.holds(*end)) && self.knows_pillars(reach, column)
            };
            active.next().is_some() && !is_within()
        };
        let columns = self.columns().enumerate().filter(is_beyond);
        columns.map(|(number, _)| number).collect()
    }

    fn knows_pillars(&self, reach: &Reach, column: &Column<'_>) -> bool {
        let mut pillars = (0..4).map(|corner| self.pillar(column.i, column.j, corner));
        pillars.all(|pillar| reach.holds_ends(pillar))
    }

    /// Brings depths and pillars of some columns that are beyond into the box of the active cells.
    fn mend(&mut self, columns: &[usize], reach: &Reach, [low, high]: [DVec3; 2]) {
        if columns.is_empty() {
            return;
        }
        let (dims, lists) = (self.dims, self.lists.clone());
        let mut depths = self.depths.to_vec();
        let mut pillars = self.pillars.to_vec();
        for &column in columns {
            let (i, j) = (column % dims.ni, column / dims.ni);
            for corner in 0..4 {
                for depth in &mut depths[lists[4 * column + corner].entries(dims.nk)] {
                    if !reach.holds_depth(*depth) {
                        *depth = depth.clamp(low.z, high.z);
                    }
                }
                let pillar = &mut pillars[self.pillar_index(i, j, corner)];
                let points = [low.z, high.z].map(|depth| pillar.at(depth));
                if !reach.holds_ends(pillar) || points.iter().any(|p| !reach.holds(*p)) {
                    let at = pillar.top.clamp(low, high);
                    *pillar = Pillar {
                        top: at.truncate().extend(low.z),
                        bottom: at.truncate().extend(high.z),
                    };
                }
            }
        }
        let lists = columns
            .iter()
            .map(|column| (*column, self.column_lists(*column)));
        let is_sorted = |list: &DepthList| depths[list.entries(dims.nk)].is_sorted();
        let mut sorted = self.sorted.to_vec();
        for (column, lists) in lists {
            sorted[column] = lists.iter().all(is_sorted);
        }
        self.sorted = sorted.into();
        self.slopes = pillars.iter().map(Pillar::slope).collect();
        self.pillars = pillars.into();
        self.depths = depths.into();
        self.found = Default::default();
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::model::{Dims, GridInput};

    const DIMS: Dims = Dims {
        ni: 6,
        nj: 5,
        nk: 4,
    };

    /// Cells of 100 by 100 by 10 at map coordinates, as `damage` leaves their COORD and ZCORN.
    fn grid(damage: impl Fn(&mut [f64], &mut [f64]), actnum: Option<&[i32]>) -> Grid {
        let pillar = |n: usize| {
            let (x, y) = (100.0 * (n % 7) as f64, 100.0 * (n / 7) as f64);
            let (x, y) = (460_000.0 + x, 6_780_000.0 + y);
            [x, y, 0.0, x + 50.0, y, 5000.0]
        };
        let mut coord: Vec<f64> = (0..DIMS.pillars()).flat_map(pillar).collect();
        let plane = |at: usize| at / (4 * DIMS.ni * DIMS.nj);
        let depth = |at: usize| 10_000.0 + 10.0 * plane(at).div_ceil(2) as f64;
        let mut zcorn: Vec<f64> = (0..8 * DIMS.cells()).map(depth).collect();
        damage(&mut coord, &mut zcorn);
        Grid::new(&GridInput {
            dims: DIMS,
            coord: &coord,
            zcorn: &zcorn,
            actnum,
            map_axes: None,
        })
        .unwrap()
    }

    /// Cells left out; the bounds of the others are those of the sound grid.
    fn left_out(mut grid: Grid) -> Vec<[usize; 3]> {
        let sound = self::grid(|_, _| {}, None).bounds().unwrap();
        let cells = grid.leave_outliers();
        let [low, high] = grid.bounds().unwrap();
        let is_within = low.cmpge(sound[0] - 1e-6).all() && high.cmple(sound[1] + 1e-6).all();
        assert!(is_within, "{low} {high}");
        assert!(grid.leave_outliers().is_empty());
        let cells = cells.iter().map(|cell| DIMS.ijk(*cell));
        cells.map(|c| [c.i, c.j, c.k]).collect()
    }

    #[test]
    fn cells_at_a_damaged_number_are_left_out_and_no_others() {
        assert!(left_out(grid(|_, _| {}, None)).is_empty());
        for wild in [1e30, -1e30, 1e12, 1e300] {
            // The first corner of the top of cell (3, 2, 0), counted from 0.
            let at = 2 * 3 + 2 * 6 * (2 * 2);
            let damaged = grid(|_, zcorn| zcorn[at] = wild, None);
            assert_eq!(left_out(damaged), [[3, 2, 0]], "{wild}");
            // The pillar between four columns; ends of the line and places on the map.
            for number in 0..6 {
                let pillar = 6 * (3 + 7 * 2) + number;
                let cells = left_out(grid(|coord, _| coord[pillar] = wild, None));
                assert_eq!(cells.len(), 4 * DIMS.nk, "{number} {wild}");
                let is_beside = |c: &[usize; 3]| (2..4).contains(&c[0]) && (1..3).contains(&c[1]);
                assert!(cells.iter().all(is_beside));
            }
        }
    }

    #[test]
    fn sound_models_stay_whole() {
        let all = |mut grid: Grid| grid.leave_outliers().is_empty();
        // Pillars that are far out, of inactive columns.
        let mut actnum = vec![1; DIMS.cells()];
        (0..DIMS.cells())
            .step_by(6)
            .for_each(|cell| actnum[cell] = 0);
        let far = |coord: &mut [f64], _: &mut [f64]| coord[6 * 7 * 2] = 1e20;
        assert!(all(grid(far, Some(&actnum))) && !all(grid(far, None)));
        // A column for an aquifer, a hundred times as wide and as high as the others.
        let aquifer = |coord: &mut [f64], zcorn: &mut [f64]| {
            for row in 0..=DIMS.nj {
                coord[6 * (7 * row + 6)] += 10_000.0;
                coord[6 * (7 * row + 6) + 3] += 10_000.0;
            }
            let last = zcorn.len() - 4 * DIMS.ni * DIMS.nj;
            zcorn[last..].iter_mut().for_each(|depth| *depth += 1000.0);
        };
        assert!(all(grid(aquifer, None)));
        // Ends of lines that are far off along them.
        let long = |coord: &mut [f64], _: &mut [f64]| {
            for ends in coord.chunks_exact_mut(6) {
                (ends[3], ends[5]) = (ends[0] + 5000.0, 500_000.0);
            }
        };
        assert!(all(grid(long, None)));
        // Half of the model elsewhere, and a model of one cell.
        let apart = |coord: &mut [f64], _: &mut [f64]| {
            let half = coord.len() / 2;
            coord[half..]
                .chunks_exact_mut(3)
                .for_each(|p| p[1] += 50_000.0);
        };
        assert!(all(grid(apart, None)));
        let mut one = vec![0; DIMS.cells()];
        one[40] = 1;
        assert!(all(grid(|_, _| {}, Some(&one))));
    }
}
