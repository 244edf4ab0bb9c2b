//! Local grids of a grid file or a deck: their cells beside those of the main grid, and their values from the same files.

use std::collections::HashMap;

use strataray_parsers::ParseError;
use strataray_parsers::cells::CellArrays;
use strataray_parsers::deck::{DeckLocalGrid, DeckProperty};
use strataray_parsers::egrid::{GridConnections, LocalGrid as FileGrid, Reservoir};
use strataray_parsers::records::{Entry, Kind};

use super::outliers;
use super::pore_volume::{self, Least};
use super::radial;
use super::slots::{CellFlags, CellSlots, ResultCells};
use crate::model::{CellIndex, Dims, Grid, GridInput, Ijk, LocalGrid};

/// A local grid, and where in files its values stand.
pub struct Local {
    pub grid: LocalGrid,
    /// Of its file's cells; `None` of a reservoir, whose values are among those of the main grid.
    slots: Option<CellSlots>,
    /// Arrays of a deck.
    texts: Vec<DeckProperty>,
    /// The number by which connections know it.
    number: i32,
}

/// What local grids lie beside.
pub struct Beside<'a> {
    pub main: &'a Grid,
    /// Arrays, of which PORV says which cells are active where the results are for fewer.
    pub init: Option<&'a CellArrays>,
    /// Which cells of a deck are too small.
    pub least: Option<&'a Least>,
    /// True where cells have matrix and fractures.
    pub is_dual: bool,
    /// Of a deck, a cubic length unit of the grid as pore volume.
    pub volume_unit: Option<f64>,
}

/// The local grids of a file that can be shown beside the main grid; why one cannot goes into the notes.
pub fn read(files: Vec<DeckLocalGrid>, beside: &Beside<'_>, notes: &mut Vec<String>) -> Vec<Local> {
    let main = beside.main;
    let inits = beside.init.and_then(|init| init.local_grids().ok());
    let mut locals: Vec<Local> = Vec::new();
    for file in by_parents(files, notes) {
        let DeckLocalGrid {
            grid: file,
            properties: texts,
        } = file;
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
        let is_split = |number: usize| locals.get(number).is_some_and(|l| l.grid.split > 1);
        let made = match of_parent {
            // HOSTNUM counts its sectors.
            _ if parent.checked_sub(1).is_some_and(is_split) => Err(
                "it refines a radial grid, whose sectors are shown as several cells each".into(),
            ),
            Some(of_parent) => {
                let beside = Beside {
                    init: arrays.map(|a| &a.arrays),
                    ..*beside
                };
                local(file, texts, of_parent, &beside, notes)
            }
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

/// Reservoirs with pillars of their own (NUMRES above 1) as grids beside the main one, of which their layers are left out.
///
/// # Errors
/// When pillars are not finite.
pub fn reservoirs(main: &Grid, files: &[Reservoir]) -> Result<(Grid, Vec<Local>), String> {
    let mut rest = main.clone();
    let layer_of = |cell: CellIndex| main.dims().ijk(cell).k;
    rest.retain_active(|cell| !files.iter().any(|r| r.layers.contains(&layer_of(cell))));
    let all: Result<Vec<Local>, String> = (2..)
        .zip(files)
        .map(|(number, file)| reservoir(main, file, number))
        .collect();
    Ok((rest, all?))
}

/// One sentence on what reservoirs there are and where they are shown.
pub fn told(files: &[Reservoir]) -> String {
    let one = |(number, file): (usize, &Reservoir)| {
        let [first, last] = [file.layers.start + 1, file.layers.end];
        format!("layers {first} to {last} are shown as grid RES{number}")
    };
    let all: Vec<String> = (2..).zip(files).map(one).collect();
    format!(
        "the grid has {} coordinate systems (NUMRES): {}",
        1 + files.len(),
        all.join(", ")
    )
}

fn reservoir(main: &Grid, file: &Reservoir, number: i32) -> Result<Local, String> {
    let dims = Dims {
        nk: file.layers.len(),
        ..main.dims()
    };
    let of_main = |k: usize| k * dims.ni * dims.nj;
    let cells = of_main(file.layers.start)..of_main(file.layers.end);
    let (_, zcorn) = main.main_corners(|depth| depth);
    let hosts: Vec<CellIndex> = cells.clone().map(|cell| CellIndex(cell as u32)).collect();
    let is_active = |cell: &CellIndex| i32::from(main.active_index(*cell).is_some());
    let actnum: Vec<i32> = hosts.iter().map(is_active).collect();
    let grid = Grid::new(&GridInput {
        dims,
        coord: &file.coord,
        zcorn: &zcorn[8 * cells.start..8 * cells.end],
        actnum: Some(&actnum),
        map_axes: None,
    });
    Ok(Local {
        grid: LocalGrid {
            name: format!("RES{number}"),
            parent: 0,
            grid: grid.map_err(|e| e.to_string())?,
            layers: Some(file.layers.clone()),
            split: 1,
            is_reversed: false,
            hosts,
        },
        slots: None,
        texts: Vec::new(),
        // No connection knows it by a number.
        number: -number,
    })
}

/// Each grid behind the one that it refines; those that refine no grid of the file become notes.
fn by_parents(mut files: Vec<DeckLocalGrid>, notes: &mut Vec<String>) -> Vec<DeckLocalGrid> {
    let mut sorted: Vec<DeckLocalGrid> = Vec::with_capacity(files.len());
    loop {
        let is_known = |DeckLocalGrid { grid: file, .. }: &DeckLocalGrid| {
            let mut known = sorted.iter().map(|known| &known.grid.name);
            file.parent.is_empty() || known.any(|name| *name == file.parent)
        };
        let (ready, rest): (Vec<_>, Vec<_>) = files.into_iter().partition(is_known);
        if ready.is_empty() {
            notes.extend(rest.iter().map(|DeckLocalGrid { grid: file, .. }| {
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
    mut file: FileGrid<f64>,
    mut texts: Vec<DeckProperty>,
    parent: &Grid,
    beside: &Beside<'_>,
    notes: &mut Vec<String>,
) -> Result<Local, String> {
    let dims = dims(file.dims);
    let hosts = hosts(&file, parent.dims())?;
    let init = beside.init;
    // Several coordinate systems follow each other; layers of the first one are those of all but rare grids.
    if file.coord.len() > 6 * dims.pillars() {
        let systems = file.coord.len() / (6 * dims.pillars());
        notes.push(format!(
            "local grid {} has {systems} coordinate systems, of which the first is used",
            file.name
        ));
        file.coord.truncate(6 * dims.pillars());
    }
    let of_file = |note: String| format!("local grid {}: {note}", file.name);
    let input = GridInput {
        dims,
        coord: &file.coord,
        zcorn: &file.zcorn,
        actnum: file.actnum.as_deref(),
        map_axes: None,
    };
    let mut found = Vec::new();
    let mut grid = outliers::built(&input, &mut found).map_err(|e| e.to_string())?;
    let mut flags = CellFlags {
        porosity: file.actnum.clone().filter(|_| beside.is_dual),
        coarse: None,
    };
    let cells = match file.is_radial {
        true => pore_volume::Cells::Rings,
        false => pore_volume::Cells::Boxes,
    };
    if let Some(least) = beside.least {
        least.leave_small_of_local(&file.name, cells, &mut grid, &mut flags, &texts, notes);
    }
    if let Some(unit) = beside.volume_unit.filter(|_| flags.porosity.is_some()) {
        pore_volume::complete(cells, &grid, &mut texts, unit);
    }
    let results = ResultCells {
        active: init
            .and_then(|init| init.head().ok())
            .and_then(|head| usize::try_from(head.active).ok())
            .filter(|active| *active > 0),
        init,
    };
    let mut slots = CellSlots::new(&mut grid, &flags, &results, notes);
    found.extend(outliers::leave_out(&mut grid, &mut slots));
    notes.extend(found.into_iter().map(of_file));
    let mut grid = LocalGrid {
        name: file.name.clone(),
        parent: 0,
        grid,
        layers: None,
        split: 1,
        is_reversed: false,
        hosts,
    };
    if file.is_radial {
        grid = radial::straightened(&file, grid, parent)?;
        notes.push(format!(
            "local grid {} is radial: it is shown with flat faces, and its outer rings reach the sides of the cells that \
             it refines, but not corners that no edge of a sector meets",
            file.name
        ));
    }
    Ok(Local {
        grid,
        slots: Some(slots),
        texts,
        number: file.number,
    })
}

/// The parent's cell of each cell.
fn hosts(file: &FileGrid<f64>, parent: Dims) -> Result<Vec<CellIndex>, String> {
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

/// One sentence for each local grid that has arrays of cells which the main grid does not have: these are no properties.
///
/// `main` has the main grid's arrays of text.
pub fn arrays_left_out(
    locals: &[Local],
    main: &[DeckProperty],
    arrays: &[&CellArrays],
) -> Vec<String> {
    let of_local = |local: &Local| {
        let is_new = |text: &&DeckProperty| !main.iter().any(|p| p.name == text.name);
        let new = local.texts.iter().filter(is_new);
        let mut names: Vec<String> = new.map(|text| text.name.clone()).collect();
        for arrays in arrays {
            let grids = arrays.local_grids().unwrap_or_default();
            let own = grids.iter().find(|grid| grid.name == local.grid.name);
            for entry in own.iter().flat_map(|own| own.arrays.iter()) {
                let slots = local.slots.as_ref();
                let fits = slots.is_some_and(|slots| slots.fits(entry.count as usize));
                let is_of_cells = entry.kind == Kind::Real && fits;
                let is_new = !names.iter().any(|name| name == entry.name());
                if is_of_cells && is_new && arrays.find(entry.name()).is_none() {
                    names.push(entry.name().to_owned());
                }
            }
        }
        (!names.is_empty()).then(|| {
            format!(
                "{} of local grid {} are not shown: the main grid does not have them",
                names.join(", "),
                local.grid.name
            )
        })
    };
    locals.iter().filter_map(of_local).collect()
}

/// Where the values of a lattice's cells stand.
pub struct Places {
    locals: Vec<LocalPlaces>,
    /// By active cell of the lattice the grid, and the rank of the cell among its active ones.
    of: Vec<(u32, u32)>,
}

/// Where the values of a local grid's cells stand.
struct LocalPlaces {
    name: String,
    /// `None` of a reservoir, whose values are among those of the main grid.
    slots: Option<CellSlots>,
    texts: Vec<DeckProperty>,
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
        .map(|l| (l.grid, (l.slots, l.texts, l.number)))
        .unzip();
    let joined = main.clone().with_local_grids(&grids);
    let grid = joined.map_err(|e| e.to_string())?;
    let numbers: HashMap<i32, usize> = [(0, 0)]
        .into_iter()
        .chain(
            kept.iter()
                .enumerate()
                .map(|(n, (_, _, number))| (*number, n + 1)),
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
        pairs.map(move |pair| [(a, pair[0]), (b, pair[1])])
    });
    let pairs = pairs.filter_map(|[a, b]| Some([cell(a.0, a.1)?, cell(b.0, b.1)?]));
    let pairs: Vec<[Ijk; 2]> = pairs.collect();
    let locals: Vec<LocalPlaces> = grids
        .into_iter()
        .zip(kept)
        .map(|(grid, (slots, texts, _))| LocalPlaces {
            name: grid.name,
            slots,
            texts,
        })
        .collect();
    let of = grid.active_cells().iter().map(|&cell| {
        let at = grid.dims().ijk(cell);
        let (patch, cell) = grid.file_cell(at);
        let own = patch.checked_sub(1).and_then(|n| locals[n].slots.as_ref());
        let (number, rank) = match own {
            Some(slots) => (patch, slots.rank(cell)),
            None => (0, slots.rank(grid.main_dims().cell(grid.main_cell(at)))),
        };
        (number as u32, rank.unwrap_or(u32::MAX))
    });
    let of = of.collect();
    Ok((grid, Places { locals, of }, pairs))
}

impl Places {
    /// Values of all grids: those of the main one, and those that local grids have of an array, of the matrix or of the
    /// fractures. A grid that does not have them has no values.
    ///
    /// # Errors
    /// When a file is damaged.
    pub fn values(
        &self,
        main: &[f32],
        arrays: &CellArrays,
        name: &str,
        is_matrix: bool,
    ) -> Result<Vec<f32>, ParseError> {
        let grids = arrays.local_grids()?;
        let of_local = |local: &LocalPlaces| -> Result<Vec<f32>, ParseError> {
            let slots = &local.slots;
            let arrays = grids.iter().find(|grid| grid.name == local.name);
            let arrays = arrays.map(|grid| &grid.arrays);
            let found = arrays.and_then(|arrays| Some((arrays, arrays.find(name)?)));
            let fits = |e: &Entry| {
                let slots = slots.as_ref()?;
                let count = e.count as usize;
                let has = slots.fits(count) && (is_matrix || slots.has_fractures(count));
                (e.is_numeric() && has).then_some(slots)
            };
            match found.and_then(|(arrays, entry)| Some((arrays, entry, fits(entry)?))) {
                Some((arrays, entry, slots)) => {
                    let values = arrays.values(entry)?;
                    Ok(match is_matrix {
                        true => slots.pick(&values),
                        false => slots.pick_fractures(&values),
                    })
                }
                None => Ok(Vec::new()),
            }
        };
        let locals: Result<Vec<_>, _> = self.locals.iter().map(of_local).collect();
        Ok(self.of_all(main, &locals?))
    }

    /// As [`Self::values`], from arrays of text.
    pub fn values_of_texts(&self, main: &[f32], name: &str, is_matrix: bool) -> Vec<f32> {
        let of_local = |local: &LocalPlaces| {
            let text = local.texts.iter().find(|text| text.name == name);
            let Some((text, slots)) = text.zip(local.slots.as_ref()) else {
                return Vec::new();
            };
            let values: Vec<f32> = text.values.iter().map(|v| *v as f32).collect();
            match is_matrix {
                true => slots.pick_of_all(&values),
                false if slots.has_all_fractures(values.len()) => slots.pick_fractures(&values),
                false => Vec::new(),
            }
        };
        let locals: Vec<_> = self.locals.iter().map(of_local).collect();
        self.of_all(main, &locals)
    }

    /// Values by active cell of the lattice, from those by active cell of each grid.
    fn of_all(&self, main: &[f32], locals: &[Vec<f32>]) -> Vec<f32> {
        let value = |&(grid, rank): &(u32, u32)| {
            let values = match grid {
                0 => main,
                number => &locals[number as usize - 1],
            };
            values.get(rank as usize).copied().unwrap_or(f32::NAN)
        };
        self.of.iter().map(value).collect()
    }
}

fn dims([ni, nj, nk]: [usize; 3]) -> Dims {
    Dims { ni, nj, nk }
}
