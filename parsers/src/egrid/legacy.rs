//! The legacy GRID: eight corners for each cell, put together to pillars and depths.
//!
//! DIMENS, MAPUNITS, MAPAXES, GRIDUNIT, then for each cell COORDS (i, j, k from 1, cell number, and where written 1 for
//! active, host cell, coarse group) and CORNERS (x, y, depth of eight corners, i first, then j, then k), as the
//! open readers of the format have them (resdata's `rd_grid.cpp`). Local grids follow in the same way, each behind LGR
//! with its name and, where it refines another local grid, the name of that.
//!
//! Files may leave out cells. They are inactive here, and of no volume: their corners lie where the nearest cell of
//! their column ends, or on the upper end of a pillar that no cell has, which is taken from the nearest one.
//!
//! Nothing in a file says that it has dual porosity. It does where the cells of the lower half of its layers lie where
//! those of the upper half do, corner by corner: these are the matrix, and the others its fractures.

use std::collections::HashMap;

use super::section::{Section, dimensions};
use super::{Egrid, LocalGrid, MapKeywords, PorosityModel, local};
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::geometry::{Lengths, unaddressable, zeros};
use crate::records::Entry;

/// Most cells for each that the file has, so that memory stays in proportion to the file.
const MOST_ABSENT: usize = 100;
/// How far a corner may lie off its pillar, in parts of the grid's extent, and in parts of the coordinates, which
/// have 24 bits.
const OF_EXTENT: f32 = 1e-4;
const OF_VALUE: f32 = 1e-6;

/// A cell as written.
struct Cell {
    ijk: [usize; 3],
    /// Activity: 1 of a cell or the matrix, 2 of fractures, 0 of what is inactive.
    part: i32,
    /// Number of the cell that it lies in, from 1; 0 in the main grid.
    host: i32,
    /// x, y and depth of each corner.
    corners: [[f32; 3]; 8],
}

/// Reads the grids of a file.
pub(super) fn read(global: &Section<'_>, warnings: &mut Warnings) -> Result<Egrid, ParseError> {
    let map = MapKeywords::read(global, warnings)?;
    let (pillars, _) = grid(global, "", warnings)?;
    let porosity_model = match pillars.is_dual {
        true => PorosityModel::Dual,
        false => PorosityModel::Single,
    };
    Ok(Egrid {
        dims: pillars.dims,
        coord: pillars.coord,
        zcorn: pillars.zcorn,
        actnum: Some(pillars.actnum),
        coarse: None,
        map_units: map.units,
        map_axes: map.axes,
        grid_unit: map.grid_unit,
        porosity_model,
        nnc: Vec::new(),
        local_nnc: Vec::new(),
        reservoirs: Vec::new(),
        local_grids: local::read(global.file, warnings, local_grid),
    })
}

/// A local grid; `number` is its place among those of the file, from 1.
fn local_grid(
    section: &Section<'_>,
    number: i32,
    warnings: &mut Warnings,
) -> Result<LocalGrid, ParseError> {
    let names = section.find("LGR").map(|e| section.file.strings(e));
    let mut names = names.transpose()?.unwrap_or_default().into_iter();
    let [name, parent] = [(); 2].map(|()| names.next().unwrap_or_default());
    let (pillars, cells) = grid(section, &format!(" of local grid {name}"), warnings)?;
    let mut host = vec![0; pillars.actnum.len()];
    // Those of the matrix come first.
    for cell in cells.iter().rev() {
        host[pillars.cell(cell.ijk)] = cell.host;
    }
    if cells.iter().any(|cell| cell.host < 1) {
        let head = section.need_of_legacy("COORDS")?;
        let message = "names no host cell (its sixth value)";
        return Err(section.file.error(ErrorKind::BadValue, head, message));
    }
    // Cells that the file leaves out are without volume: any host will do.
    let mut last = cells.first().map_or(0, |cell| cell.host);
    for host in &mut host {
        match *host {
            0 => *host = last,
            known => last = known,
        }
    }
    Ok(LocalGrid {
        name,
        parent: Some(parent)
            .filter(|parent| parent != "GLOBAL")
            .unwrap_or_default(),
        number,
        dims: pillars.dims,
        coord: pillars.coord,
        zcorn: pillars.zcorn,
        actnum: Some(pillars.actnum),
        host,
        ..LocalGrid::default()
    })
}

/// The pillars of a grid and the cells that its section has; `of` names it in warnings.
fn grid(
    section: &Section<'_>,
    of: &str,
    warnings: &mut Warnings,
) -> Result<(Pillars, Vec<Cell>), ParseError> {
    let file = section.file;
    let head = section.need_of_legacy("DIMENS")?;
    let values = file.i32s(head)?;
    let [ni, nj, nk, ..] = values[..] else {
        let message = format!("has {} values and needs 3", values.len());
        return Err(file.error(ErrorKind::WrongCount, head, message));
    };
    if let Some(radial) = section.find("RADIAL")
        && section
            .string("RADIAL")?
            .is_some_and(|s| s.starts_with('T'))
    {
        let message = "the grid is radial; only Cartesian pillar grids are read from GRID files: have the simulator write an EGRID";
        return Err(file.error(ErrorKind::Unsupported, radial, message));
    }
    let dims = dimensions(file, head, [ni, nj, nk])?;
    let mut cells = cells(section, dims)?;
    let half = dims[2] / 2;
    let is_dual = has_fractures(&cells, dims);
    let dims = match is_dual {
        true => {
            fold(&mut cells, half);
            let message = format!(
                "layers {} to {}{of} lie where layers 1 to {half} do: they are taken for the fractures of dual porosity",
                half + 1,
                2 * half
            );
            warnings.push(file.path(), At::File, message);
            [dims[0], dims[1], half]
        }
        false => dims,
    };
    let pillars = Pillars {
        is_dual,
        ..Pillars::new(section, head, dims, &cells)?
    };
    let total = pillars.actnum.len();
    let absent = pillars.is_there.iter().filter(|is| !**is).count();
    if absent > 0 {
        let message = format!(
            "{absent} of {total} cells{of} are not in the file: they are inactive, without volume"
        );
        warnings.push(file.path(), At::File, message);
    }
    Ok((pillars, cells))
}

/// True where cells of the lower half of the layers lie where those of the upper half do, and none of them elsewhere.
fn has_fractures(cells: &[Cell], [_, _, nk]: [usize; 3]) -> bool {
    let half = nk / 2;
    if nk % 2 != 0 {
        return false;
    }
    let upper = cells.iter().filter(|cell| cell.ijk[2] < half);
    let upper: HashMap<[usize; 3], &Cell> = upper.map(|cell| (cell.ijk, cell)).collect();
    let lower = cells.iter().filter(|cell| cell.ijk[2] >= half);
    let mut pairs = lower.filter_map(|cell| {
        let [i, j, k] = cell.ijk;
        Some((cell, *upper.get(&[i, j, k - half])?))
    });
    let mut found = false;
    pairs.all(|(lower, upper)| {
        found = true;
        lower.corners == upper.corners
    }) && found
}

/// Lays the lower half of the layers into the upper one, as fractures.
fn fold(cells: &mut [Cell], half: usize) {
    for cell in cells.iter_mut().filter(|cell| cell.ijk[2] >= half) {
        cell.ijk[2] -= half;
        cell.part *= 2;
    }
}

impl<'a> Section<'a> {
    fn need_of_legacy(&self, name: &str) -> Result<&'a Entry, ParseError> {
        self.find(name).ok_or_else(|| {
            let message = "is missing; a GRID file needs DIMENS, COORDS and CORNERS";
            let kind = ErrorKind::MissingKeyword;
            ParseError::of(kind, self.file.path(), At::File, name, message)
        })
    }
}

fn cells(global: &Section<'_>, dims: [usize; 3]) -> Result<Vec<Cell>, ParseError> {
    let file = global.file;
    global.need_of_legacy("CORNERS")?;
    let mut cells: Vec<Cell> = Vec::new();
    let mut coords: Option<&Entry> = None;
    for entry in global.entries {
        if entry.name() == "COORDS" {
            coords = Some(entry);
        }
        let ("CORNERS", Some(head)) = (entry.name(), coords) else {
            continue;
        };
        coords = None;
        let values = file.i32s(head)?;
        let place = match values[..] {
            [i, j, k, ..] => [i, j, k].map(|n| usize::try_from(n).unwrap_or(0)),
            _ => [0; 3],
        };
        if place.iter().zip(dims).any(|(n, size)| *n < 1 || *n > size) {
            let numbers: Vec<String> = values.iter().take(3).map(ToString::to_string).collect();
            let message = format!(
                "names the cell {}, and DIMENS says {} x {} x {} cells; the file is damaged",
                numbers.join(" "),
                dims[0],
                dims[1],
                dims[2]
            );
            return Err(file.error(ErrorKind::BadValue, head, message));
        }
        let corners = file.f32s(entry)?;
        if corners.len() != 24 || corners.iter().any(|v| !v.is_finite()) {
            let message = "is not 24 finite numbers: x, y and depth of eight corners";
            return Err(file.error(ErrorKind::BadValue, entry, message));
        }
        cells.push(Cell {
            ijk: place.map(|n| n - 1),
            part: i32::from(values.get(4).is_none_or(|active| *active != 0)),
            host: values.get(5).copied().unwrap_or(0),
            corners: std::array::from_fn(|c| std::array::from_fn(|n| corners[3 * c + n])),
        });
    }
    Ok(cells)
}

/// The arrays of an EGRID.
struct Pillars {
    dims: [usize; 3],
    coord: Vec<f32>,
    zcorn: Vec<f32>,
    actnum: Vec<i32>,
    /// Which cells the file has.
    is_there: Vec<bool>,
    /// Which pillars a cell of the file has.
    is_known: Vec<bool>,
    /// Matrix and fractures.
    is_dual: bool,
}

impl Pillars {
    fn new(
        global: &Section<'_>,
        head: &Entry,
        dims: [usize; 3],
        cells: &[Cell],
    ) -> Result<Self, ParseError> {
        let file = global.file;
        let lengths = Lengths::of(dims)
            .ok_or_else(|| file.error(ErrorKind::TooLarge, head, unaddressable(dims)))?;
        if lengths.cells / MOST_ABSENT > cells.len() || cells.is_empty() {
            let message = format!(
                "says {} cells, and the file has {}",
                lengths.cells,
                cells.len()
            );
            return Err(file.error(ErrorKind::WrongCount, head, message));
        }
        let memory = || file.error(ErrorKind::TooLarge, head, "not enough memory for its cells");
        let mut pillars = Self {
            dims,
            coord: zeros(lengths.coord).ok_or_else(memory)?,
            zcorn: zeros(lengths.zcorn).ok_or_else(memory)?,
            actnum: zeros(lengths.cells).ok_or_else(memory)?,
            is_there: zeros(lengths.cells).ok_or_else(memory)?,
            is_known: zeros(lengths.coord / 6).ok_or_else(memory)?,
            is_dual: false,
        };
        cells.iter().for_each(|cell| pillars.add(cell));
        pillars.settle_known();
        pillars.check(cells).map_err(|place| {
            let message = format!(
                "the corners of cells at pillar {} {} do not lie on one line; only pillar grids are read",
                place[0] + 1,
                place[1] + 1
            );
            file.error(ErrorKind::Unsupported, head, message)
        })?;
        pillars.settle_absent();
        Ok(pillars)
    }

    fn pillar(&self, i: usize, j: usize) -> usize {
        j * (self.dims[0] + 1) + i
    }

    /// Index of a depth, with `c` the number of the corner in the cell.
    fn depth(&self, [i, j, k]: [usize; 3], c: usize) -> usize {
        let [ni, nj, _] = self.dims;
        let (di, dj, dk) = (c & 1, c >> 1 & 1, c >> 2);
        2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * (2 * k + dk)
    }

    fn cell(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.dims[0] * (j + self.dims[1] * k)
    }

    /// Takes in a cell: depths, and the ends of its pillars where it reaches farther than those before.
    fn add(&mut self, cell: &Cell) {
        let [i, j, _] = cell.ijk;
        let index = self.cell(cell.ijk);
        self.actnum[index] |= cell.part;
        self.is_there[index] = true;
        for (c, point) in cell.corners.iter().enumerate() {
            let depth = self.depth(cell.ijk, c);
            self.zcorn[depth] = point[2];
            let pillar = self.pillar(i + (c & 1), j + (c >> 1 & 1));
            let is_first = !std::mem::replace(&mut self.is_known[pillar], true);
            let ends = &mut self.coord[6 * pillar..6 * pillar + 6];
            if is_first || point[2] < ends[2] {
                ends[..3].copy_from_slice(point);
            }
            if is_first || point[2] > ends[5] {
                ends[3..].copy_from_slice(point);
            }
        }
    }

    /// Pillars without length, where all cells end in one point, become vertical.
    fn settle_known(&mut self) {
        for ends in self.coord.as_chunks_mut::<6>().0 {
            if ends[2] == ends[5] {
                (ends[3], ends[4]) = (ends[0], ends[1]);
                ends[5] += 1.0;
            }
        }
    }

    /// True where all corners lie on their pillars; else the pillar of the first that does not.
    fn check(&self, cells: &[Cell]) -> Result<(), [usize; 2]> {
        let mut low = [f32::INFINITY; 2];
        let mut high = [f32::NEG_INFINITY; 2];
        for point in cells.iter().flat_map(|cell| &cell.corners) {
            for n in 0..2 {
                low[n] = low[n].min(point[n]);
                high[n] = high[n].max(point[n]);
            }
        }
        let value = low.iter().chain(&high).fold(0.0_f32, |m, v| m.max(v.abs()));
        let extent = (high[0] - low[0]).max(high[1] - low[1]);
        let most = OF_EXTENT * extent + OF_VALUE * value;
        for cell in cells {
            for (c, [x, y, z]) in cell.corners.iter().enumerate() {
                let place = [cell.ijk[0] + (c & 1), cell.ijk[1] + (c >> 1 & 1)];
                let pillar = self.pillar(place[0], place[1]);
                let ends = &self.coord[6 * pillar..6 * pillar + 6];
                let along = (z - ends[2]) / (ends[5] - ends[2]);
                let off = |n: usize, v: f32| (ends[n] + along * (ends[n + 3] - ends[n]) - v).abs();
                let is_on = off(0, *x) <= most && off(1, *y) <= most;
                if !is_on {
                    return Err(place);
                }
            }
        }
        Ok(())
    }

    /// Gives a place to what the file leaves out.
    fn settle_absent(&mut self) {
        let [ni, nj, nk] = self.dims;
        // From the pillar before, along the rows; those at the start from the first one known.
        let first = self.is_known.iter().position(|known| *known).unwrap_or(0);
        let mut last = first;
        for pillar in 0..self.is_known.len() {
            match self.is_known[pillar] {
                true => last = pillar,
                false => self.coord.copy_within(6 * last..6 * last + 6, 6 * pillar),
            }
        }
        for j in 0..nj {
            for i in 0..ni {
                for c in 0..4 {
                    let layers = (0..nk).find(|k| self.is_there[self.cell([i, j, *k])]);
                    let pillar = self.pillar(i + (c & 1), j + (c >> 1));
                    let mut depth = match layers {
                        Some(k) => self.zcorn[self.depth([i, j, k], c)],
                        None => self.coord[6 * pillar + 2],
                    };
                    for k in 0..nk {
                        let [upper, lower] = [c, c + 4].map(|c| self.depth([i, j, k], c));
                        if self.is_there[self.cell([i, j, k])] {
                            depth = self.zcorn[lower];
                        } else {
                            self.zcorn[upper] = depth;
                            self.zcorn[lower] = depth;
                        }
                    }
                }
            }
        }
    }
}
