//! Text decks: the grid, its faults and its cell properties from GRDECL and DATA files.
//!
//! The reader follows INCLUDE, skips what does not describe the grid, and stops at the SUMMARY or
//! SCHEDULE section, of which [`Schedule`] takes the wells. It works in two steps: a scan over all files that notes where each array
//! lies and what is done to it, and, once the dimensions are known, the parallel conversion of the
//! arrays and, in the deck's order, what is done to them in boxes (EQUALS, COPY, ...), regions (EQUALREG, ...) and by
//! formulas (OPERATE).

mod array;
mod assemble;
mod blocks;
mod cells;
mod edit;
mod faults;
mod files;
mod formula;
mod header;
mod include;
mod lexer;
mod numbers;
mod refine;
mod scan;
mod schedule;
mod skip;
mod source;
mod walk;
mod write;

use std::path::{Path, PathBuf};

use crate::egrid::{LocalGrid, PorosityModel};
use crate::error::{ParseError, Warnings};
pub use crate::units::UnitSystem;
pub use files::{DeckFiles, Folders, MemoryFiles};
pub use schedule::Schedule;
pub use write::{DeckWriter, GridText, Number};

/// A corner-point grid as its deck gives it, without any geometry computed from it.
///
/// Shape: `ni`, `nj`, `nk` are `dims[0]`, `dims[1]`, `dims[2]`; cell arrays run i fastest, then j, then k.
#[derive(Debug, Clone, PartialEq)]
pub struct Grdecl {
    /// Number of cells in i, j and k, each at least 1, their product below 2^31. Of dual porosity those of the matrix,
    /// which are half of the deck's layers.
    pub dims: [usize; 3],
    /// Pillars: 6 numbers (x, y, z of top, x, y, z of bottom) for each of `(ni+1)*(nj+1)`, i fastest; all finite.
    pub coord: Vec<f64>,
    /// Corner depths, `8*ni*nj*nk` in the file's order (`2ni` fastest, then `2nj`, then `2nk`); all finite.
    pub zcorn: Vec<f64>,
    /// Activity of each cell as written (0 is inactive), `None` where the deck has no ACTNUM. With dual porosity always
    /// there: 1 matrix, 2 fractures, 3 both.
    pub actnum: Option<Vec<i32>>,
    /// DUALPORO or DUALPERM of the RUNSPEC section.
    pub porosity_model: PorosityModel,
    /// NODPPM: permeabilities of fractures are effective ones. Without it a simulator multiplies them by the porosity of
    /// the fractures.
    pub has_effective_fractures: bool,
    /// MAPAXES: x and y of a point on the map's y axis, of the origin, of a point on its x axis.
    pub map_axes: Option<[f64; 6]>,
    /// MAPUNITS: the length unit of MAPAXES, such as `METRES`.
    pub map_units: Option<String>,
    /// GRIDUNIT: the length unit of COORD and ZCORN.
    pub grid_unit: Option<GridUnit>,
    /// GDORIENT: directions of i, j, k (`INC`, `DEC`), of depth (`UP`, `DOWN`) and handedness (`RIGHT`, `LEFT`).
    pub gdorient: Option<[String; 5]>,
    /// The unit system a full deck names in its RUNSPEC section.
    pub unit_system: Option<UnitSystem>,
    /// Phases that RUNSPEC names, as INTEHEAD numbers them: 1 oil, 2 water, 4 gas, added; 0 where it names none.
    pub phases: i32,
    /// MINPV: pore volume below which a cell is inactive, in the unit system's reservoir volumes.
    pub min_pore_volume: Option<f64>,
    /// Keywords with one number per cell, in the order of their first appearance.
    pub properties: Vec<DeckProperty>,
    /// Local grids (CARFIN, RADFIN), each behind the one that it refines.
    pub local_grids: Vec<DeckLocalGrid>,
    /// Faces of named faults, in file order.
    pub faults: Vec<FaultFaces>,
    /// All files read, in the order they were opened, each once.
    pub files: Vec<PathBuf>,
}

/// A local grid of a deck: the cells that a simulator makes of CARFIN or RADFIN, and their values.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckLocalGrid {
    /// Its cells, in the place of those that it refines.
    pub grid: LocalGrid<f64>,
    /// Those of the cells that it refines, changed by what the deck does between CARFIN or REFINE and ENDFIN; one value
    /// for each of its cells, with dual porosity as in [`Grdecl::properties`].
    pub properties: Vec<DeckProperty>,
}

/// What decks say of the cells of a grid that is read from elsewhere.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DeckCells {
    /// Keywords with one number per cell, in the order of their first appearance.
    pub properties: Vec<DeckProperty>,
    /// Faces of named faults, in file order.
    pub faults: Vec<FaultFaces>,
    /// The unit system of a RUNSPEC section.
    pub unit_system: Option<UnitSystem>,
    /// As in [`Grdecl::phases`].
    pub phases: i32,
    /// All files read, in the order they were opened, each once.
    pub files: Vec<PathBuf>,
}

/// The length unit of a grid and the system its coordinates are given in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridUnit {
    /// The unit as written, without blanks, such as `METRES`.
    pub name: String,
    /// True when the coordinates are map coordinates already (second item `MAP`).
    pub is_map: bool,
}

/// A keyword with one number per cell.
#[derive(Debug, Clone, PartialEq)]
pub struct DeckProperty {
    /// The keyword in upper case, such as `PORO`.
    pub name: String,
    /// One value for each of `ni*nj*nk` cells; NaN where the deck gives none. With dual porosity those of the matrix,
    /// and behind them as many of the fractures where they have any.
    pub values: Vec<f64>,
    /// What of the deck was not applied to it, as part of a sentence; `None` where the values are as the deck says.
    pub doubt: Option<String>,
}

/// One record of FAULTS: a box of cells whose named face lies on the fault.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultFaces {
    /// The fault's name.
    pub name: String,
    /// First and last column in i, counted from 1, both included.
    pub i: [usize; 2],
    /// First and last row in j, counted from 1, both included.
    pub j: [usize; 2],
    /// First and last layer in k, counted from 1, both included.
    pub k: [usize; 2],
    /// The face in upper case as written: `X`, `I`, `Y-`, `J+`, `Z`, `K-` and so on.
    pub face: String,
    /// MULTFLT: the factor of transmissibilities across the fault; 0 seals it.
    pub multiplier: Option<f64>,
}

impl Grdecl {
    /// Reads the grid of the deck at `path` and of all files it includes.
    ///
    /// What the reader leaves out or cannot evaluate (an operation on what is not given, ...) goes to `warnings`.
    ///
    /// # Errors
    /// When a file is missing or ends inside a record, when the grid is missing, damaged or of the wrong
    /// length, when numbers are not numbers, or when files include each other in a loop.
    pub fn read(path: &Path, warnings: &mut Warnings) -> Result<Self, ParseError> {
        Self::read_from(&Folders, path, &[], warnings)
    }

    /// As [`Self::read`], the decks of `with` going on where the one at `path` ends, so that properties may stand in
    /// files of their own.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_with(
        path: &Path,
        with: &[PathBuf],
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        Self::read_from(&Folders, path, with, warnings)
    }

    /// As [`Self::read_with`], for `files` that need not be on disk.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_from(
        files: &dyn DeckFiles,
        path: &Path,
        with: &[PathBuf],
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let with = with.iter().map(PathBuf::as_path);
        let paths: Vec<_> = std::iter::once(path).chain(with).collect();
        let found = scan::scan(files, &paths, warnings)?;
        assemble::assemble(path, found, warnings)
    }

    /// Reads FAULTS and MULTFLT alone of the deck at `path` and of all files it includes, for a grid of `dims` cells
    /// that was read from elsewhere. Faces outside it go to `warnings`.
    ///
    /// # Errors
    /// When a file is missing or ends inside a record, or when FAULTS is damaged.
    pub fn read_faults(
        path: &Path,
        dims: [usize; 3],
        warnings: &mut Warnings,
    ) -> Result<Vec<FaultFaces>, ParseError> {
        Self::read_faults_from(&Folders, path, dims, warnings)
    }

    /// As [`Self::read_faults`], for `files` that need not be on disk.
    ///
    /// # Errors
    /// As [`Self::read_faults`].
    pub fn read_faults_from(
        files: &dyn DeckFiles,
        path: &Path,
        dims: [usize; 3],
        warnings: &mut Warnings,
    ) -> Result<Vec<FaultFaces>, ParseError> {
        // What else the deck says is not asked for, so nobody has to know what of it was left out.
        let mut found = scan::scan(files, &[path], &mut Warnings::default())?;
        Ok(assemble::inside(&mut found, dims, dims, warnings))
    }

    /// True where the text file at `path`, or one that it includes, describes a grid and not only what belongs to
    /// one.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn is_grid(path: &Path) -> Result<bool, ParseError> {
        Self::is_grid_from(&Folders, path)
    }

    /// As [`Self::is_grid`], for `files` that need not be on disk.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn is_grid_from(files: &dyn DeckFiles, path: &Path) -> Result<bool, ParseError> {
        let found = scan::scan(files, &[path], &mut Warnings::default())?;
        Ok(found.describes_grid())
    }
}

impl DeckCells {
    /// Reads what the decks at `paths`, one going on where the other ends, say of the cells of a grid of `dims`.
    ///
    /// # Errors
    /// As [`Grdecl::read`], but for the grid.
    pub fn read(
        paths: &[PathBuf],
        dims: [usize; 3],
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        Self::read_from(&Folders, paths, dims, warnings)
    }

    /// As [`Self::read`], for `files` that need not be on disk.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_from(
        files: &dyn DeckFiles,
        paths: &[PathBuf],
        dims: [usize; 3],
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let paths: Vec<_> = paths.iter().map(PathBuf::as_path).collect();
        let found = scan::scan(files, &paths, warnings)?;
        let first = paths.first().copied().unwrap_or(Path::new(""));
        assemble::cells(first, found, dims, warnings)
    }
}
