//! Radial local grids as hexahedra around the middle of their hosts.
//!
//! Files give rings that are as large as the cells that they refine, not of their shape: here the outermost ring reaches
//! the sides of these. J runs around, and each sector is as many cells as keep its flat faces near to the circle.
//!
//! Angles begin at the side of I +, and run to that of J - in files of Eclipse: the sectors of LGR_TESTMOD lie in these
//! columns by HOSTNUM, and are connected to the neighbors there.

use glam::DVec2;
use strataray_parsers::egrid::LocalGrid as FileGrid;

use crate::model::{CellIndex, Dims, Grid, GridInput, Ijk, LocalGrid, Pillar};

/// Degrees that a cell spans at most: its faces are flat.
const WIDEST_SECTOR: f64 = 30.0;

/// A grid whose x and y are radii and angles with its cells in space.
pub fn straightened(
    file: &FileGrid<f64>,
    grid: LocalGrid,
    parent: &Grid,
) -> Result<LocalGrid, String> {
    let outline = Outline::of(parent, &grid.hosts);
    let sectors = Sectors::of(file, grid.grid.dims(), |cell| {
        parent.dims().ijk(grid.hosts[cell.0 as usize]).j
    })?;
    let cells = || (0..sectors.whole.cells() as u32).map(|cell| sectors.of_file(CellIndex(cell)));
    let actnum = cells().map(|cell| i32::from(grid.grid.active_index(cell).is_some()));
    let actnum: Vec<i32> = actnum.collect();
    let shown = Grid::new(&GridInput {
        dims: sectors.whole,
        coord: &sectors.coord(&outline),
        zcorn: &sectors.zcorn(),
        actnum: Some(&actnum),
        map_axes: None,
    });
    Ok(LocalGrid {
        grid: shown.map_err(|e| e.to_string())?,
        layers: None,
        split: sectors.split,
        is_reversed: sectors.is_reversed,
        hosts: cells().map(|cell| grid.hosts[cell.0 as usize]).collect(),
        ..grid
    })
}

/// Sectors of a file's grid, each split into several.
struct Sectors<'a> {
    file: &'a FileGrid<f64>,
    /// Cells of the file, and all that these are split into.
    dims: Dims,
    whole: Dims,
    split: usize,
    /// True where angles run to the side of J -, else to that of J +.
    is_clockwise: bool,
    /// True where J runs the other way than in the file: faces are told from their backs by the handedness of the whole
    /// model.
    is_reversed: bool,
}

impl<'a> Sectors<'a> {
    /// `host_row` is J of the cell that one lies in.
    fn of(
        file: &'a FileGrid<f64>,
        dims: Dims,
        host_row: impl Fn(CellIndex) -> usize,
    ) -> Result<Self, String> {
        let angle = |row: usize| file.coord[6 * (dims.ni + 1) * row + 1];
        let widths = (0..dims.nj).map(|j| (angle(j + 1) - angle(j)).abs());
        let split = (widths.fold(0.0, f64::max) / WIDEST_SECTOR).ceil();
        if !(0.0..=360.0 / WIDEST_SECTOR).contains(&split) {
            return Err("angles of COORD are no sectors of a circle".into());
        }
        let split = (split as usize).max(1);
        let nj = dims.nj * split;
        let rows = (0..dims.nj).map(|j| host_row(dims.cell(Ijk { i: 0, j, k: 0 })) as f64);
        let rows: Vec<f64> = rows.collect();
        let mean = rows.iter().sum::<f64>() / rows.len() as f64;
        let side = |j: usize| (0.5 * (angle(j) + angle(j + 1))).to_radians().sin();
        // Of one column it does not matter, and Eclipse's way is taken.
        let to_high_j: f64 = (0..dims.nj).map(|j| side(j) * (rows[j] - mean)).sum();
        let is_clockwise = to_high_j <= 0.0;
        Ok(Self {
            is_clockwise,
            is_reversed: is_clockwise == (angle(dims.nj) >= angle(0)),
            file,
            dims,
            whole: Dims { nj, ..dims },
            split,
        })
    }

    /// The cell of the file that a cell is a part of.
    fn of_file(&self, cell: CellIndex) -> CellIndex {
        let own = self.whole.ijk(cell);
        let j = own.j / self.split;
        let j = if self.is_reversed {
            self.dims.nj - 1 - j
        } else {
            j
        };
        self.dims.cell(Ijk { j, ..own })
    }

    /// What COORD has at a place of the pillars of ring `i`, in a row of pillars between which those of the file are.
    fn value(&self, i: usize, row: usize, place: usize) -> f64 {
        let of_file = |row: usize| self.file.coord[6 * (i + (self.dims.ni + 1) * row) + place];
        let (before, part) = (row / self.split, row % self.split);
        let near = of_file(before);
        match part {
            0 => near,
            _ => near + part as f64 / self.split as f64 * (of_file(before + 1) - near),
        }
    }

    fn coord(&self, outline: &Outline) -> Vec<f64> {
        let Dims { ni, nj, .. } = self.whole;
        let mut coord = Vec::with_capacity(6 * self.whole.pillars());
        for row in 0..=nj {
            let row = if self.is_reversed { nj - row } else { row };
            for i in 0..=ni {
                for end in [0, 3] {
                    let [radius, angle, depth] = [0, 1, 2].map(|n| self.value(i, row, end + n));
                    let outermost = self.value(ni, row, end);
                    let way = DVec2::from_angle(angle.to_radians());
                    let way = if self.is_clockwise {
                        DVec2::new(way.x, -way.y)
                    } else {
                        way
                    };
                    let place = outline.place(way, radius, outermost, depth);
                    coord.extend([place.x, place.y, depth]);
                }
            }
        }
        coord
    }

    fn zcorn(&self) -> Vec<f64> {
        let Dims { ni, nj, nk } = self.dims;
        let depth = |plane: usize, row: usize, x: usize| {
            self.file.zcorn[x + 2 * ni * (row + 2 * nj * plane)]
        };
        let mut zcorn = Vec::with_capacity(8 * self.whole.cells());
        for plane in 0..2 * nk {
            let rows = 2 * self.whole.nj;
            for row in 0..rows {
                let row = if self.is_reversed {
                    rows - 1 - row
                } else {
                    row
                };
                let j = row / 2 / self.split;
                let part = (row / 2 % self.split + row % 2) as f64 / self.split as f64;
                zcorn.extend((0..2 * ni).map(|x| {
                    let [near, far] = [0, 1].map(|dj| depth(plane, 2 * j + dj, x));
                    near + part * (far - near)
                }));
            }
        }
        zcorn
    }
}

/// The sides of the cells that a radial grid refines, by the pillars at their corners.
struct Outline([Pillar; 4]);

impl Outline {
    fn of(grid: &Grid, hosts: &[CellIndex]) -> Self {
        let cells = hosts.iter().map(|cell| grid.dims().ijk(*cell));
        let start = [[usize::MAX; 2], [0; 2]];
        let [low, high] = cells.fold(start, |[a, b], c| {
            [
                [a[0].min(c.i), a[1].min(c.j)],
                [b[0].max(c.i), b[1].max(c.j)],
            ]
        });
        // One around after the other.
        Self([
            *grid.pillar(low[0], low[1], 0),
            *grid.pillar(high[0], low[1], 1),
            *grid.pillar(high[0], high[1], 3),
            *grid.pillar(low[0], high[1], 2),
        ])
    }

    /// The place in plan of a point that lies in a direction (of length 1, along I and across it on the side of J +) from
    /// the middle, at a radius, where the outermost radius is `outermost`: rings near the middle stay circles.
    fn place(&self, way: DVec2, radius: f64, outermost: f64, depth: f64) -> DVec2 {
        let corners = self.0.map(|pillar| pillar.at(depth).truncate());
        let middle = corners.iter().sum::<DVec2>() / 4.0;
        let [a, b, c, d] = corners;
        let along = (b + c - a - d).normalize_or(DVec2::X);
        let across = along.perp() * along.perp_dot(c + d - a - b).signum();
        let way = way.x * along + way.y * across;
        let reach = (0..4).filter_map(|n| {
            let (from, to) = (corners[n] - middle, corners[(n + 1) % 4] - middle);
            // The middle plus t times the way is from plus s times the side.
            let side = to - from;
            let across = way.perp_dot(side);
            let (t, s) = (from.perp_dot(side) / across, from.perp_dot(way) / across);
            (t > 0.0 && (-1e-9..=1.0 + 1e-9).contains(&s)).then_some(t)
        });
        let reach = reach.fold(f64::INFINITY, f64::min);
        let factor = match reach.is_finite() && outermost > 0.0 {
            true => 1.0 + (reach / outermost - 1.0) * (radius / outermost),
            false => 1.0,
        };
        middle + radius * factor * way
    }
}
