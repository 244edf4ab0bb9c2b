//! EGRID, and the legacy GRID: the geometry of a case, as written.
//!
//! Keywords: FILEHEAD, MAPUNITS, MAPAXES, GRIDUNIT, GRIDHEAD, COORD, COORDSYS, ZCORN, ACTNUM, CORSNUM; sections of local grids
//! start at LGR and end at ENDLGR; then connections, NNCHEAD and NNCHEADA with what follows them. The README lists
//! what is skipped.

mod connections;
mod legacy;
mod local;
mod section;
mod write;

use std::ops::Range;
use std::path::Path;

use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::radial;
use crate::records::{Entry, RecordFile};
use section::{Head, Section};

pub use connections::GridConnections;
pub use local::LocalGrid;

/// Unit of the grid's coordinates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridUnit {
    /// METRES, FEET or CM.
    pub length: String,
    /// True where coordinates are map coordinates already.
    pub is_map: bool,
}

/// One value per cell, or one for the matrix and one for the fractures.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PorosityModel {
    /// Single porosity.
    #[default]
    Single,
    /// Dual porosity.
    Dual,
    /// Dual porosity and permeability.
    DualPermeability,
}

/// Layers of the global grid on a further coordinate system.
#[derive(Debug, Clone, PartialEq)]
pub struct Reservoir {
    /// The layers, from 0.
    pub layers: Range<usize>,
    /// Their pillars, in the shape of [`Egrid::coord`].
    pub coord: Vec<f32>,
}

/// The grids of an EGRID file: the global one, and the local ones within it.
#[derive(Debug, Clone, PartialEq)]
pub struct Egrid {
    /// Cells along i, j and k.
    pub dims: [usize; 3],
    /// **Shape**: 6 values per pillar: x, y, depth of the upper, then of the lower end; for all layers but those of
    /// [`Self::reservoirs`]. Radii and angles of a radial
    /// grid are made into x and y, around the origin. As the file has
    /// them: a damaged one may be no finite number, here and in `zcorn`.
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
    /// Layers that have pillars of their own (NUMRES above 1).
    pub reservoirs: Vec<Reservoir>,
    /// Connections within a local grid, to the global one, or from one local grid to another.
    pub local_nnc: Vec<GridConnections>,
    /// Local grids, nested ones too, in the order of the file.
    pub local_grids: Vec<LocalGrid>,
}

impl Egrid {
    /// Reads the grids of an EGRID, FEGRID, GRID or FGRID file, or of binary GRDECL; which one it is its content says.
    ///
    /// A local grid that is damaged is left out with a warning.
    ///
    /// # Errors
    /// When the file is damaged, lacks a keyword, is no corner-point grid, or an array has the
    /// wrong length.
    pub fn read(path: &Path, warnings: &mut Warnings) -> Result<Self, ParseError> {
        Self::of(&RecordFile::open(path)?, warnings)
    }

    /// As [`Self::read`], for a file that is in memory.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_bytes(
        file: impl Into<FileBytes>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        Self::of(&RecordFile::from_bytes(file)?, warnings)
    }

    fn of(file: &RecordFile, warnings: &mut Warnings) -> Result<Self, ParseError> {
        let entries = file.entries();
        // The global grid comes first; sections of local grids start at LGR, and NNC lists follow.
        let first_local = entries.iter().position(|e| e.name() == "LGR");
        let global = Section {
            file,
            entries: &entries[..first_local.unwrap_or(entries.len())],
        };
        let is_legacy = global.find("COORD").is_none() && global.find("COORDS").is_some();
        if is_legacy {
            return legacy::read(&global, warnings);
        }
        let head = global.head()?;
        let geometry = global.geometry(head.dims)?;
        let mut coord = geometry.coord;
        let mut reservoirs = Vec::new();
        if coord.len() > geometry.pillars {
            reservoirs = further_systems(&global, &head, &coord[geometry.pillars..])?;
            if reservoirs.is_empty() {
                let note = "COORD has several coordinate systems (NUMRES), and no COORDSYS of a Cartesian grid says which layers are theirs; the first is used for all layers";
                warnings.push(file.path(), At::File, note);
            }
            coord.truncate(geometry.pillars);
        }
        if head.is_radial {
            let mut wide: Vec<f64> = coord.iter().map(|v| f64::from(*v)).collect();
            let note = radial::straighten(&mut wide, head.dims[0]);
            warnings.push(file.path(), At::File, note);
            coord = wide.into_iter().map(|v| v as f32).collect();
        }
        let cells = geometry.zcorn.len() / 8;
        let map = MapKeywords::read(&global, warnings)?;
        let porosity_model = porosity_model(file)?;
        // Fracture cells are numbered on behind the matrix cells.
        let numbered = |cells: usize| match porosity_model {
            PorosityModel::Single => cells,
            _ => cells.saturating_mul(2),
        };
        let local_grids = local::read(file, warnings, local::grid);
        let sizes = local_grids.iter().map(|g| (g.number, g.zcorn.len() / 8));
        let sizes: Vec<_> = [(0, cells)].into_iter().chain(sizes).collect();
        let sizes: Vec<_> = sizes.into_iter().map(|(n, c)| (n, numbered(c))).collect();
        let (nnc, local_nnc) = connections::read(file, &sizes, warnings)?;
        Ok(Self {
            dims: head.dims,
            coord,
            zcorn: geometry.zcorn,
            actnum: geometry.actnum,
            coarse: global.of_cells("CORSNUM", cells)?,
            map_units: map.units,
            map_axes: map.axes,
            grid_unit: map.grid_unit,
            porosity_model,
            nnc,
            reservoirs,
            local_nnc,
            local_grids,
        })
    }
}

/// The coordinate systems behind the first one, whose pillars `coord` has one set after the other; none where it is not
/// said which layers they are for. COORDSYS has six numbers for each system, of which the first two are its layers.
fn further_systems(
    global: &Section<'_>,
    head: &Head,
    coord: &[f32],
) -> Result<Vec<Reservoir>, ParseError> {
    let Some(entry) = global.find("COORDSYS").filter(|_| !head.is_radial) else {
        return Ok(Vec::new());
    };
    let [ni, nj, nk] = head.dims;
    let systems = global.file.i32s(entry)?;
    let systems = systems.as_chunks::<6>().0.iter().skip(1);
    let pillars = coord.chunks_exact(6 * (ni + 1) * (nj + 1));
    if systems.len() != pillars.len() {
        return Ok(Vec::new());
    }
    let reservoir = |([first, last, ..], coord): (&[i32; 6], &[f32])| {
        let [first, last] = [first, last].map(|layer| usize::try_from(*layer).unwrap_or(0));
        (1 <= first && first <= last && last <= nk).then(|| Reservoir {
            layers: first - 1..last,
            coord: coord.to_vec(),
        })
    };
    let all: Option<Vec<_>> = systems.zip(pillars).map(reservoir).collect();
    all.ok_or_else(|| {
        let message = format!("names layers outside of the grid, which has {nk}");
        global.file.error(ErrorKind::BadValue, entry, message)
    })
}

/// MAPUNITS, MAPAXES and GRIDUNIT.
struct MapKeywords {
    units: Option<String>,
    axes: Option<[f64; 6]>,
    grid_unit: Option<GridUnit>,
}

impl MapKeywords {
    fn read(global: &Section<'_>, warnings: &mut Warnings) -> Result<Self, ParseError> {
        let file = global.file;
        let axes = match global.find("MAPAXES") {
            Some(entry) => map_axes(file, entry, warnings)?,
            None => None,
        };
        let unit = global.find("GRIDUNIT");
        Ok(Self {
            units: global.string("MAPUNITS")?,
            axes,
            grid_unit: unit.map(|e| grid_unit(file, e)).transpose()?,
        })
    }
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
