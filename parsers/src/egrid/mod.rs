//! EGRID: the geometry of a case, as written.
//!
//! Keywords: FILEHEAD, MAPUNITS, MAPAXES, GRIDUNIT, GRIDHEAD, COORD, ZCORN, ACTNUM, CORSNUM, NNC1 with NNC2;
//! sections of local grids start at LGR and end at ENDLGR. The README lists what is skipped.

mod write;

use std::path::Path;

use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::geometry::{Lengths, MOST_CELLS, first_not, unaddressable};
use crate::records::{Entry, RecordFile};

/// Unit of the grid's coordinates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridUnit {
    /// METRES, FEET or CM.
    pub length: String,
    /// True where coordinates are map coordinates already.
    pub is_map: bool,
}

/// One value per cell, or one for the matrix and one for the fractures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PorosityModel {
    /// Single porosity.
    Single,
    /// Dual porosity.
    Dual,
    /// Dual porosity and permeability.
    DualPermeability,
}

/// A local grid, by name only: its geometry is not read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LocalGrid {
    /// Name.
    pub name: String,
    /// Name of the grid it refines; empty for the global grid.
    pub parent: String,
    /// Cells along i, j and k.
    pub dims: [usize; 3],
    /// Active cells.
    pub active: usize,
    /// True where COORD holds radii and angles.
    pub is_radial: bool,
}

/// The global grid of an EGRID file.
#[derive(Debug, Clone, PartialEq)]
pub struct Egrid {
    /// Cells along i, j and k.
    pub dims: [usize; 3],
    /// **Shape**: 6 values per pillar: x, y, depth of the upper, then of the lower end.
    pub coord: Vec<f32>,
    /// **Shape**: 8 depths per cell, index `2i+di + 2ni(2j+dj) + 4ni*nj(2k+dk)`.
    pub zcorn: Vec<f32>,
    /// One value per cell; absent = all active. Dual porosity: 1 matrix, 2 fracture, 3 both.
    pub actnum: Option<Vec<i32>>,
    /// CORSNUM: number of the coarse cell that each cell was made part of, or 0.
    pub coarse: Option<Vec<i32>>,
    /// Unit of MAPAXES.
    pub map_units: Option<String>,
    /// A point on the y axis, the origin, a point on the x axis.
    pub map_axes: Option<[f64; 6]>,
    /// Unit of the coordinates.
    pub grid_unit: Option<GridUnit>,
    /// Single or dual porosity.
    pub porosity_model: PorosityModel,
    /// Non-neighbor connections of the global grid: cell numbers from 1.
    pub nnc: Vec<[i32; 2]>,
    /// Number of connections within a local grid, to its host or to another one.
    pub local_connections: u64,
    /// Local grids.
    pub local_grids: Vec<LocalGrid>,
}

impl Egrid {
    /// Reads the global grid.
    ///
    /// # Errors
    /// When the file is damaged, lacks a keyword, is no corner-point grid, or an array has the
    /// wrong length.
    pub fn read(path: &Path, warnings: &mut Warnings) -> Result<Self, ParseError> {
        Self::from_bytes(FileBytes::open(path)?, warnings)
    }

    /// As [`Self::read`], for a file that is in memory.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_bytes(
        file: impl Into<FileBytes>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let file = RecordFile::from_bytes(file)?;
        let path = file.path();
        let entries = file.entries();
        // The global grid comes first; sections of local grids start at LGR, and NNC lists follow.
        let first_local = entries
            .iter()
            .position(|e| e.name() == "LGR")
            .unwrap_or(entries.len());
        let global = &entries[..first_local];
        let find = |name: &str| global.iter().find(|e| e.name() == name);
        let need = |name: &str| {
            find(name).ok_or_else(|| {
                ParseError::of(
                    ErrorKind::MissingKeyword,
                    path,
                    At::File,
                    name,
                    "is missing; a grid needs GRIDHEAD, COORD and ZCORN",
                )
            })
        };
        let head = need("GRIDHEAD")?;
        let dims = dimensions(&file, head)?;
        let Some(lengths) = Lengths::of(dims) else {
            return Err(file.error(ErrorKind::TooLarge, head, unaddressable(dims)));
        };
        let cells = lengths.cells;
        let mut coord = sized(&file, need("COORD")?, lengths.coord, true)?;
        if coord.len() > lengths.coord {
            warnings.push(
                path,
                At::File,
                "COORD has several coordinate reservoirs; the first is used for all layers",
            );
            coord.truncate(lengths.coord);
        }
        let zcorn = sized(&file, need("ZCORN")?, lengths.zcorn, false)?;
        let of_cells = |name: &str| match find(name) {
            None => Ok(None),
            Some(entry) if entry.count == cells as u64 => file.i32s(entry).map(Some),
            Some(entry) => {
                let found = entry.count;
                Err(file.error(
                    ErrorKind::WrongCount,
                    entry,
                    format!("expected {cells} values, found {found}"),
                ))
            }
        };
        let actnum = of_cells("ACTNUM")?;
        let coarse = of_cells("CORSNUM")?;
        let grid_unit = find("GRIDUNIT").map(|e| grid_unit(&file, e)).transpose()?;
        let map_axes = match find("MAPAXES") {
            Some(entry) => map_axes(&file, entry, warnings)?,
            None => None,
        };
        let porosity_model = porosity_model(&file)?;
        // Fracture cells are numbered on behind the matrix cells.
        let numbered = match porosity_model {
            PorosityModel::Single => cells,
            _ => cells.saturating_mul(2),
        };
        let (nnc, local_connections) = connections(&file, numbered, warnings)?;
        Ok(Self {
            dims,
            coord,
            zcorn,
            actnum,
            coarse,
            map_units: find("MAPUNITS")
                .map(|e| file.strings(e))
                .transpose()?
                .and_then(|s| s.into_iter().next()),
            map_axes,
            grid_unit,
            porosity_model,
            nnc,
            local_connections,
            local_grids: local_grids(&file)?,
        })
    }
}

fn dimensions(file: &RecordFile, head: &Entry) -> Result<[usize; 3], ParseError> {
    let values = file.i32s(head)?;
    let [kind, ni, nj, nk, ..] = values[..] else {
        return Err(file.error(
            ErrorKind::WrongCount,
            head,
            format!("has {} values and needs at least 4", values.len()),
        ));
    };
    if kind != 1 {
        return Err(file.error(
            ErrorKind::Unsupported,
            head,
            format!("the grid is of type {kind}; only corner-point grids (type 1) are read"),
        ));
    }
    if is_radial(&values) {
        let message = "the grid is radial; only Cartesian corner-point grids are read";
        return Err(file.error(ErrorKind::Unsupported, head, message));
    }
    let dims = [ni, nj, nk].map(|n| usize::try_from(n).unwrap_or(0));
    let cells = dims
        .iter()
        .try_fold(1usize, |product, &n| product.checked_mul(n));
    match cells {
        Some(1..=MOST_CELLS) => Ok(dims),
        _ => {
            let kind = match dims.contains(&0) {
                true => ErrorKind::BadValue,
                false => ErrorKind::TooLarge,
            };
            let message = format!("dimensions {ni} x {nj} x {nk} are not possible");
            Err(file.error(kind, head, message))
        }
    }
}

/// Item 27 of GRIDHEAD: sectors around the axis.
fn is_radial(grid_head: &[i32]) -> bool {
    grid_head.get(26).is_some_and(|&sectors| sectors > 0)
}

fn grid_unit(file: &RecordFile, entry: &Entry) -> Result<GridUnit, ParseError> {
    let strings = file.strings(entry)?;
    Ok(GridUnit {
        length: strings.first().cloned().unwrap_or_default(),
        is_map: strings.get(1).is_some_and(|m| m.trim() == "MAP"),
    })
}

fn map_axes(
    file: &RecordFile,
    entry: &Entry,
    warnings: &mut Warnings,
) -> Result<Option<[f64; 6]>, ParseError> {
    let values = file.f64s(entry)?.try_into().ok();
    if values.is_none() {
        let message = format!("MAPAXES has {} values, not 6: left out", entry.count);
        warnings.push(file.path(), file.place(entry.offset), message);
    }
    Ok(values)
}

fn sized(
    file: &RecordFile,
    entry: &Entry,
    expected: usize,
    more_allowed: bool,
) -> Result<Vec<f32>, ParseError> {
    let (found, needed) = (entry.count, expected as u64);
    let fits = found == needed || more_allowed && found > needed && found.is_multiple_of(needed);
    if !fits {
        return Err(file.error(
            ErrorKind::WrongCount,
            entry,
            format!("expected {expected} values, found {found}"),
        ));
    }
    let values = file.f32s(entry)?;
    match first_not(&values, |v| v.is_finite()) {
        Some(number) => Err(file.error(
            ErrorKind::BadValue,
            entry,
            format!("value {number} is not a finite number"),
        )),
        None => Ok(values),
    }
}

fn porosity_model(file: &RecordFile) -> Result<PorosityModel, ParseError> {
    let Some(head) = file.find("FILEHEAD") else {
        return Ok(PorosityModel::Single);
    };
    Ok(match file.i32s(head)?.get(5) {
        Some(1) => PorosityModel::Dual,
        Some(2) => PorosityModel::DualPermeability,
        _ => PorosityModel::Single,
    })
}

/// Connections of the global grid, the NNC1 and NNC2 that follow an NNCHEAD for grid 0, and the
/// number of all others.
fn connections(
    file: &RecordFile,
    numbered: usize,
    warnings: &mut Warnings,
) -> Result<(Vec<[i32; 2]>, u64), ParseError> {
    let mut global = true;
    let mut local = 0;
    let mut from = Vec::new();
    let mut pairs = Vec::new();
    for entry in file.entries() {
        match entry.name() {
            "NNCHEAD" => global = file.i32s(entry)?.get(1).is_none_or(|&grid| grid == 0),
            "NNC1" if global => from = file.i32s(entry)?,
            "NNC2" if global => {
                let to = file.i32s(entry)?;
                if to.len() != from.len() {
                    let (expected, found) = (from.len(), to.len());
                    let message = format!("expected {expected} values as in NNC1, found {found}");
                    return Err(file.error(ErrorKind::WrongCount, entry, message));
                }
                pairs.extend(from.drain(..).zip(to).map(|(a, b)| [a, b]));
            }
            "NNC1" | "NNCL" | "NNA1" => local += entry.count,
            _ => {}
        }
    }
    let known = |cell: i32| usize::try_from(cell).is_ok_and(|c| (1..=numbered).contains(&c));
    let all = pairs.len();
    pairs.retain(|pair| pair.iter().all(|&c| known(c)));
    if pairs.len() < all {
        let message = format!(
            "{} of {all} connections in NNC1 and NNC2 name cells outside the grid: left out",
            all - pairs.len()
        );
        warnings.push(file.path(), At::File, message);
    }
    Ok((pairs, local))
}

fn local_grids(file: &RecordFile) -> Result<Vec<LocalGrid>, ParseError> {
    let first_string = |entry| {
        let strings = file.strings(entry)?;
        Ok(strings.into_iter().next().unwrap_or_default())
    };
    let mut grids: Vec<LocalGrid> = Vec::new();
    let mut inside = false;
    for entry in file.entries() {
        if entry.name() == "LGR" {
            inside = true;
            grids.push(LocalGrid {
                name: first_string(entry)?,
                parent: String::new(),
                dims: [0; 3],
                active: 0,
                is_radial: false,
            });
            continue;
        }
        let Some(grid) = grids.last_mut().filter(|_| inside) else {
            continue;
        };
        match entry.name() {
            "ENDLGR" => inside = false,
            "LGRPARNT" => grid.parent = first_string(entry)?,
            "GRIDHEAD" => {
                let head = file.i32s(entry)?;
                grid.is_radial = is_radial(&head);
                if let [_, ni, nj, nk, ..] = head[..] {
                    grid.dims = [ni, nj, nk].map(|n| usize::try_from(n).unwrap_or(0));
                    grid.active = grid.dims.iter().fold(1, |p: usize, &n| p.saturating_mul(n));
                }
            }
            "ACTNUM" => grid.active = file.i32s(entry)?.iter().filter(|a| **a != 0).count(),
            _ => {}
        }
    }
    Ok(grids)
}
