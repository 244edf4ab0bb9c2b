//! Local grids of an EGRID file: their cells beside those of the main grid, and their values from the same files.

use std::collections::HashMap;

use glam::DVec2;
use strataray_parsers::ParseError;
use strataray_parsers::cells::CellArrays;
use strataray_parsers::egrid::{GridConnections, LocalGrid as FileGrid};

use super::slots::{CellFlags, CellSlots, ResultCells};
use crate::model::{CellIndex, Dims, Grid, GridInput, Ijk, LocalGrid, Pillar};

/// Degrees that a cell of a radial grid spans at most: its faces are flat.
const WIDEST_SECTOR: f32 = 30.0;

/// A local grid, and where in files its values stand.
pub struct Local {
    pub grid: LocalGrid,
    /// Of its file's cells.
    slots: CellSlots,
    /// The number by which connections know it.
    number: i32,
}

/// The local grids of a file that can be shown beside `main`; why one cannot goes into the notes.
///
/// `init` has its arrays, of which PORV says which cells are active where the results are for fewer.
pub fn read(
    files: Vec<FileGrid>,
    main: &Grid,
    init: Option<&CellArrays>,
    notes: &mut Vec<String>,
) -> Vec<Local> {
    let inits = init.and_then(|init| init.local_grids().ok());
    let mut locals: Vec<Local> = Vec::new();
    for file in by_parents(files, notes) {
        let arrays = inits.iter().flatten().find(|a| a.name == file.name);
        let parent = match file.parent.is_empty() {
            true => 0,
            // Parents come first.
            false => {
                1 + locals
                    .iter()
                    .position(|l| l.grid.name == file.parent)
                    .unwrap_or(locals.len())
            }
        };
        let name = file.name.clone();
        let of_parent = match parent.checked_sub(1) {
            None => Some(main),
            Some(number) => locals.get(number).map(|l| &l.grid.grid),
        };
        let made = match of_parent {
            Some(of_parent) => local(file, of_parent, main, arrays.map(|a| &a.arrays), notes),
            None => Err("the grid that it refines is not shown".to_owned()),
        };
        match made {
            Ok(mut made) => {
                made.grid.parent = parent;
                locals.push(made);
            }
            Err(why) => notes.push(format!(
                "local grid {name} is not shown; its place shows the host cells: {why}"
            )),
        }
    }
    locals
}

/// Each grid behind the one that it refines; those that refine no grid of the file become notes.
fn by_parents(mut files: Vec<FileGrid>, notes: &mut Vec<String>) -> Vec<FileGrid> {
    let mut sorted: Vec<FileGrid> = Vec::with_capacity(files.len());
    loop {
        let is_known = |file: &FileGrid| {
            file.parent.is_empty() || sorted.iter().any(|known| known.name == file.parent)
        };
        let (ready, rest): (Vec<_>, Vec<_>) = files.into_iter().partition(is_known);
        if ready.is_empty() {
            notes.extend(rest.iter().map(|file| {
                format!(
                    "local grid {} is not shown; its place shows the host cells: there is no grid {}, which it refines",
                    file.name, file.parent
                )
            }));
            return sorted;
        }
        sorted.extend(ready);
        files = rest;
    }
}

fn local(
    mut file: FileGrid,
    parent: &Grid,
    main: &Grid,
    init: Option<&CellArrays>,
    notes: &mut Vec<String>,
) -> Result<Local, String> {
    let dims = dims(file.dims);
    let hosts = hosts(&file, parent.dims())?;
    // Several coordinate systems follow each other; layers of the first one are those of all but rare grids.
    if file.coord.len() > 6 * dims.pillars() {
        let systems = file.coord.len() / (6 * dims.pillars());
        notes.push(format!(
            "local grid {} has {systems} coordinate systems, of which the first is used",
            file.name
        ));
        file.coord.truncate(6 * dims.pillars());
    }
    let built = |dims, coord: &[f32], zcorn: &[f32], actnum: Option<&[i32]>| {
        let map_axes = None;
        let input = GridInput {
            dims,
            coord,
            zcorn,
            actnum,
            map_axes,
        };
        Grid::new(&input).map_err(|e| e.to_string())
    };
    let mut grid = built(dims, &file.coord, &file.zcorn, file.actnum.as_deref())?;
    let results = ResultCells {
        active: init
            .and_then(|init| init.head().ok())
            .and_then(|head| usize::try_from(head.active).ok())
            .filter(|active| *active > 0),
        init,
    };
    let slots = CellSlots::new(&mut grid, &CellFlags::default(), &results, notes);
    if file.is_radial {
        return radial(&file, (grid, hosts, slots), parent, main, built, notes);
    }
    Ok(Local {
        grid: LocalGrid {
            name: file.name,
            parent: 0,
            grid,
            split: 1,
            hosts,
        },
        slots,
        number: file.number,
    })
}

/// The parent's cell of each cell.
fn hosts(file: &FileGrid, parent: Dims) -> Result<Vec<CellIndex>, String> {
    let all = dims(file.dims);
    if !file.host.is_empty() {
        let hosts = file.host.iter().map(|&number| {
            let host = u32::try_from(number).ok()?.checked_sub(1)?;
            ((host as usize) < parent.cells()).then_some(CellIndex(host))
        });
        let hosts: Option<Vec<CellIndex>> = hosts.collect();
        return hosts.ok_or_else(|| "HOSTNUM names cells outside the grid that it refines".into());
    }
    let Some([first, last]) = file.host_box else {
        return Err("neither HOSTNUM nor GRIDHEAD says which cells it refines".into());
    };
    let outside = || "GRIDHEAD names cells outside the grid that it refines".to_owned();
    let ends = [first, last].map(|end| end.map(|n| usize::try_from(n).unwrap_or(0)));
    let ends = ends.map(|end| parent.one_based(end));
    let [Some(first), Some(last)] = ends else {
        return Err(outside());
    };
    // As many cells in each host, or one more.
    let along = |at: usize, count: usize, [first, last]: [usize; 2]| {
        let hosts = last.checked_sub(first)? + 1;
        Some(first + at * hosts / count)
    };
    let host = |cell: u32| {
        let own = all.ijk(CellIndex(cell));
        Some(parent.cell(Ijk {
            i: along(own.i, all.ni, [first.i, last.i])?,
            j: along(own.j, all.nj, [first.j, last.j])?,
            k: along(own.k, all.nk, [first.k, last.k])?,
        }))
    };
    let hosts: Option<Vec<CellIndex>> = (0..all.cells() as u32).map(host).collect();
    hosts.ok_or_else(outside)
}

/// A radial grid as hexahedra around the middle of its hosts, whose sides its outermost ring reaches: files give rings
/// that are as large, not of their shape. J runs around, and each sector is as many cells as keep its flat faces near
/// to the circle.
fn radial(
    file: &FileGrid,
    (grid, hosts, slots): (Grid, Vec<CellIndex>, CellSlots),
    parent: &Grid,
    main: &Grid,
    built: impl Fn(Dims, &[f32], &[f32], Option<&[i32]>) -> Result<Grid, String>,
    notes: &mut Vec<String>,
) -> Result<Local, String> {
    let dims = grid.dims();
    let Dims { ni, nj, nk } = dims;
    let angle = |row: usize| file.coord[6 * (ni + 1) * row + 1];
    let widest = (0..nj).map(|j| (angle(j + 1) - angle(j)).abs());
    let split = (widest.fold(0.0, f32::max) / WIDEST_SECTOR).ceil();
    if !(0.0..=360.0 / WIDEST_SECTOR).contains(&split) {
        return Err("angles of COORD are no sectors of a circle".into());
    }
    let split = (split as usize).max(1);
    let whole = Dims {
        nj: nj * split,
        ..dims
    };
    let outline = Outline::of(parent, &hosts);
    let radius = |i: usize, row: usize, end: usize| file.coord[6 * (i + (ni + 1) * row) + end];
    // Faces are told from their backs by the handedness of the whole model.
    let turn = if main.signed_bulk_volume() < 0.0 {
        -1.0
    } else {
        1.0
    };
    // Between the angles of a row of pillars and the next: what the two have, mixed.
    let mixed = |row: usize, of: &dyn Fn(usize) -> f32| {
        let (before, part) = (row / split, (row % split) as f32 / split as f32);
        let next = if row.is_multiple_of(split) {
            before
        } else {
            before + 1
        };
        of(before) + part * (of(next) - of(before))
    };
    let mut coord = Vec::with_capacity(6 * whole.pillars());
    for row in 0..=whole.nj {
        for i in 0..=ni {
            for end in [0, 3] {
                let at = |n: usize| move |row: usize| 6 * (i + (ni + 1) * row) + end + n;
                let value = |n: usize| mixed(row, &|row| file.coord[at(n)(row)]);
                let outermost = mixed(row, &|row| radius(ni, row, end));
                let way = DVec2::from_angle(f64::from(value(1)).to_radians());
                let way = DVec2::new(way.x, turn * way.y);
                let depth = f64::from(value(2));
                let place = outline.place(way, f64::from(value(0)), f64::from(outermost), depth);
                coord.extend([place.x as f32, place.y as f32, value(2)]);
            }
        }
    }
    let depth = |plane: usize, j: usize, dj: usize, x: usize| {
        file.zcorn[x + 2 * ni * (2 * j + dj + 2 * nj * plane)]
    };
    let mut zcorn = Vec::with_capacity(8 * whole.cells());
    for plane in 0..2 * nk {
        for y in 0..2 * whole.nj {
            let (j, part) = (y / 2 / split, (y / 2 % split + y % 2) as f32 / split as f32);
            zcorn.extend((0..2 * ni).map(|x| {
                let [near, far] = [0, 1].map(|dj| depth(plane, j, dj, x));
                near + part * (far - near)
            }));
        }
    }
    let of_file = |cell: u32| {
        let own = whole.ijk(CellIndex(cell));
        dims.cell(Ijk {
            j: own.j / split,
            ..own
        })
    };
    let cells = || (0..whole.cells() as u32).map(of_file);
    let actnum: Vec<i32> = cells()
        .map(|cell| i32::from(grid.active_index(cell).is_some()))
        .collect();
    let shown = built(whole, &coord, &zcorn, Some(&actnum))?;
    notes.push(format!(
        "local grid {} is radial: it is shown with flat faces, and its outer rings reach the sides of the cells that it \
         refines",
        file.name
    ));
    Ok(Local {
        grid: LocalGrid {
            name: file.name.clone(),
            parent: 0,
            grid: shown,
            split,
            hosts: cells().map(|cell| hosts[cell.0 as usize]).collect(),
        },
        slots,
        number: file.number,
    })
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

    /// The place in plan of a point that lies in a direction (of length 1) from the middle, at a radius, where the
    /// outermost radius is `outermost`: rings near the middle stay circles.
    fn place(&self, way: DVec2, radius: f64, outermost: f64, depth: f64) -> DVec2 {
        let corners = self.0.map(|pillar| pillar.at(depth).truncate());
        let middle = corners.iter().sum::<DVec2>() / 4.0;
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

/// Where the values of a lattice's cells stand.
pub struct Places {
    locals: Vec<(String, CellSlots)>,
    /// By active cell of the lattice the grid, and the rank of the cell among its active ones.
    of: Vec<(u32, u32)>,
}

/// The main grid and local grids in one lattice, the places of values, and the connections between the grids.
///
/// # Errors
/// When the lattice would be too large; the main grid is as it was then.
pub fn join(
    main: &Grid,
    slots: &CellSlots,
    locals: Vec<Local>,
    connections: &[GridConnections],
) -> Result<(Grid, Places, Vec<[Ijk; 2]>), String> {
    let (grids, kept): (Vec<_>, Vec<_>) = locals
        .into_iter()
        .map(|l| (l.grid, (l.slots, l.number)))
        .unzip();
    let joined = main.clone().with_local_grids(&grids);
    let grid = joined.map_err(|e| e.to_string())?;
    let numbers: HashMap<i32, usize> = [(0, 0)]
        .into_iter()
        .chain(
            kept.iter()
                .enumerate()
                .map(|(n, (_, number))| (*number, n + 1)),
        )
        .collect();
    let cell = |number: i32, cell: i32| {
        let patch = *numbers.get(&number)?;
        let cell = CellIndex(u32::try_from(cell).ok()?.checked_sub(1)?);
        let dims = grid.patches()[patch].file_dims();
        ((cell.0 as usize) < dims.cells()).then(|| grid.in_lattice(patch, dims.ijk(cell)))?
    };
    let pairs = connections.iter().flat_map(|list| {
        let [a, b] = list.grids;
        let pairs = list.cells.iter();
        pairs.filter_map(move |pair| Some([(a, pair[0]), (b, pair[1])]))
    });
    let pairs = pairs.filter_map(|[a, b]| Some([cell(a.0, a.1)?, cell(b.0, b.1)?]));
    let pairs: Vec<[Ijk; 2]> = pairs.collect();
    let locals: Vec<(String, CellSlots)> = grids
        .into_iter()
        .zip(kept)
        .map(|(grid, (slots, _))| (grid.name, slots))
        .collect();
    let of = grid.active_cells().iter().map(|&cell| {
        let (patch, cell) = grid.file_cell(grid.dims().ijk(cell));
        let slots = match patch {
            0 => slots,
            number => &locals[number - 1].1,
        };
        (patch as u32, slots.rank(cell).unwrap_or(u32::MAX))
    });
    let of = of.collect();
    Ok((grid, Places { locals, of }, pairs))
}

impl Places {
    /// Values of all grids: those of the main one, and those that local grids have of an array. A grid that does not have
    /// it has no values.
    ///
    /// # Errors
    /// When a file is damaged.
    pub fn values(
        &self,
        main: &[f32],
        arrays: Option<&CellArrays>,
        name: &str,
    ) -> Result<Vec<f32>, ParseError> {
        let grids = arrays.map(CellArrays::local_grids).transpose()?;
        let grids = grids.unwrap_or_default();
        let of_local = |(local, slots): &(String, CellSlots)| -> Result<Vec<f32>, ParseError> {
            let arrays = grids.iter().find(|grid| grid.name == *local);
            let arrays = arrays.map(|grid| &grid.arrays);
            let found = arrays.and_then(|arrays| Some((arrays, arrays.find(name)?)));
            match found.filter(|(_, e)| e.is_numeric() && slots.fits(e.count as usize)) {
                Some((arrays, entry)) => Ok(slots.pick(&arrays.values(entry)?)),
                None => Ok(Vec::new()),
            }
        };
        let locals: Result<Vec<_>, _> = self.locals.iter().map(of_local).collect();
        let locals = locals?;
        let value = |&(grid, rank): &(u32, u32)| {
            let values = match grid {
                0 => main,
                number => &locals[number as usize - 1],
            };
            values.get(rank as usize).copied().unwrap_or(f32::NAN)
        };
        Ok(self.of.iter().map(value).collect())
    }
}

fn dims([ni, nj, nk]: [usize; 3]) -> Dims {
    Dims { ni, nj, nk }
}
