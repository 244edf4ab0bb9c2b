//! The grid of a case with what else its file says: EGRID or a deck.

use std::path::Path;
use std::time::Instant;

use strataray_parsers::case::{CaseFiles, GridSource};
use strataray_parsers::deck::{FaultFaces as DeckFault, Grdecl};
use strataray_parsers::egrid::{Egrid, PorosityModel};
use strataray_parsers::{At, ParseError, Warnings};

use super::slots::CellSlots;
use crate::case::{About, LoadTimes, LocalGrid, NamedFault};
use crate::model::topology::Face;
use crate::model::{CellIndex, Dims, FaultFaces, Grid, GridInput, Ijk, MapAxes, ModelError};

fn model_error(path: &Path, error: &ModelError) -> ParseError {
    ParseError::new(path, At::File, "", error.to_string())
}

/// What the file of the grid gives.
pub struct Loaded {
    pub grid: Grid,
    pub cells: CellSlots,
    pub deck: Option<Grdecl>,
    pub connections: Vec<[Ijk; 2]>,
    pub fault_faces: FaultFaces,
}

/// Reads the grid; what else its file says goes into `about`.
pub fn read(
    files: &CaseFiles,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<Loaded, ParseError> {
    match &files.grid {
        GridSource::Egrid(path) => {
            let mut loaded = read_egrid(path, about, warnings)?;
            if let Some(deck) = &files.deck {
                loaded.fault_faces = deck_faults(deck, loaded.grid.dims(), about, warnings);
            }
            Ok(loaded)
        }
        GridSource::Deck(path) => read_deck(path, about, warnings),
    }
}

fn read_egrid(
    path: &Path,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<Loaded, ParseError> {
    let egrid = Egrid::read(path, warnings)?;
    let start = Instant::now();
    let is_map = egrid.grid_unit.as_ref().is_some_and(|u| u.is_map);
    let grid = Grid::new(&GridInput {
        dims: dims(egrid.dims),
        coord: &egrid.coord,
        zcorn: &egrid.zcorn,
        actnum: egrid.actnum.as_deref(),
        map_axes: egrid
            .map_axes
            .and_then(MapAxes::from_keyword)
            .filter(|_| !is_map),
    })
    .map_err(|e| model_error(path, &e))?;
    about.load_times = LoadTimes {
        model: start.elapsed(),
    };
    about.files.push(path.to_owned());
    about.length_unit = egrid
        .grid_unit
        .map_or_else(|| "METRES".into(), |u| u.length);
    about.map_axes = egrid.map_axes;
    about.nnc = egrid.nnc.len();
    about.porosity_model = match egrid.porosity_model {
        PorosityModel::Single => "single",
        PorosityModel::Dual => "dual porosity",
        PorosityModel::DualPermeability => "dual permeability",
    }
    .into();
    if egrid.porosity_model != PorosityModel::Single {
        about.notes.push(format!(
            "the case is of {}: the values of the matrix are shown, those of the fractures are not",
            about.porosity_model
        ));
    }
    for local in &egrid.local_grids {
        about.notes.push(format!(
            "local grid {} ({} x {} x {}) is not shown; its place shows the host cells",
            local.name, local.dims[0], local.dims[1], local.dims[2]
        ));
    }
    about.local_grids = egrid
        .local_grids
        .into_iter()
        .map(|l| LocalGrid {
            name: l.name,
            dims: l.dims,
            active: l.active,
        })
        .collect();
    let slots = CellSlots::new(&grid, egrid.actnum.as_deref(), egrid.porosity_model);
    let connections = connections(&egrid.nnc, grid.dims());
    Ok(Loaded {
        grid,
        cells: slots,
        deck: None,
        connections,
        fault_faces: FaultFaces::default(),
    })
}

fn read_deck(
    path: &Path,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<Loaded, ParseError> {
    let deck = Grdecl::read(path, warnings)?;
    let start = Instant::now();
    let is_map = deck.grid_unit.as_ref().is_some_and(|u| u.is_map);
    let grid = Grid::new(&GridInput {
        dims: dims(deck.dims),
        coord: &deck.coord,
        zcorn: &deck.zcorn,
        actnum: deck.actnum.as_deref(),
        map_axes: deck
            .map_axes
            .and_then(MapAxes::from_keyword)
            .filter(|_| !is_map),
    })
    .map_err(|e| model_error(path, &e))?;
    about.load_times = LoadTimes {
        model: start.elapsed(),
    };
    about.files.extend(deck.files.iter().cloned());
    about.length_unit = match &deck.grid_unit {
        Some(unit) => unit.name.clone(),
        None => "METRES".into(),
    };
    about.map_axes = deck.map_axes;
    about.porosity_model = "single".into();
    about.named_faults = named_faults(&deck.faults);
    let slots = CellSlots::new(&grid, deck.actnum.as_deref(), PorosityModel::Single);
    let fault_faces = fault_faces(&deck.faults, &about.named_faults);
    let deck = Grdecl {
        coord: Vec::new(),
        zcorn: Vec::new(),
        ..deck
    };
    Ok(Loaded {
        grid,
        cells: slots,
        deck: Some(deck),
        connections: Vec::new(),
        fault_faces,
    })
}

/// Pairs of cells by their numbers in the file, which count from 1; pairs of cells outside the grid are
/// left out.
fn connections(pairs: &[[i32; 2]], dims: Dims) -> Vec<[Ijk; 2]> {
    let cell = |number: i32| {
        let index = u32::try_from(number).ok()?.checked_sub(1)?;
        ((index as usize) < dims.cells()).then(|| dims.ijk(CellIndex(index)))
    };
    let pair = |[a, b]: &[i32; 2]| Some([cell(*a)?, cell(*b)?]);
    pairs.iter().filter_map(pair).collect()
}

/// The named faults of a deck beside an EGRID file.
fn deck_faults(path: &Path, dims: Dims, about: &mut About, warnings: &mut Warnings) -> FaultFaces {
    match Grdecl::read_faults(path, [dims.ni, dims.nj, dims.nk], warnings) {
        Ok(faults) => {
            about.named_faults = named_faults(&faults);
            if !faults.is_empty() {
                about.files.push(path.to_owned());
            }
            fault_faces(&faults, &about.named_faults)
        }
        Err(error) => {
            let note = format!("names of faults were not read: {error}");
            about.notes.push(note);
            FaultFaces::default()
        }
    }
}

/// The faults of a deck in the order of their names' first use.
fn named_faults(faults: &[DeckFault]) -> Vec<NamedFault> {
    let mut named: Vec<NamedFault> = Vec::new();
    for fault in faults {
        let span = |[a, b]: [usize; 2]| b.saturating_sub(a) + 1;
        let faces = span(fault.i) * span(fault.j) * span(fault.k);
        match named.iter_mut().find(|f| f.name == fault.name) {
            Some(known) => known.faces += faces,
            None => named.push(NamedFault {
                name: fault.name.clone(),
                faces,
            }),
        }
    }
    named
}

/// Which faces lie on which of the named faults.
fn fault_faces(faults: &[DeckFault], named: &[NamedFault]) -> FaultFaces {
    let mut faces = FaultFaces::default();
    for fault in faults {
        let number = named.iter().position(|f| f.name == fault.name);
        if let (Some(number), Some(face)) = (number, lateral_face(&fault.face)) {
            // Files count from 1.
            let cells = [fault.i, fault.j, fault.k].map(|[a, b]| a - 1..=b - 1);
            faces.add(number, cells, face);
        }
    }
    faces
}

/// The lateral face that FAULTS calls `I`, `X-`, `J+` and so on; `None` for upper and lower ones.
fn lateral_face(name: &str) -> Option<Face> {
    let is_minus = name.ends_with('-');
    Some(match (name.chars().next()?, is_minus) {
        ('X' | 'I', true) => Face::IMinus,
        ('X' | 'I', false) => Face::IPlus,
        ('Y' | 'J', true) => Face::JMinus,
        ('Y' | 'J', false) => Face::JPlus,
        _ => return None,
    })
}

fn dims([ni, nj, nk]: [usize; 3]) -> Dims {
    Dims { ni, nj, nk }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn a_deck_beside_an_egrid_names_its_faults() {
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor");
        let folder = tempfile::tempdir().unwrap();
        let case = folder.path().join("SCISSOR.EGRID");
        std::fs::copy(sample.join("SCISSOR.EGRID"), &case).unwrap();
        let names = |case: &crate::case::Case| -> Vec<String> {
            let faults = case.about.named_faults.iter();
            faults.map(|f| f.name.clone()).collect()
        };
        let without = crate::load::open(&case).unwrap();
        assert!(names(&without).is_empty());
        // The deck includes a file that is not there: its names are missing, and a note says so.
        std::fs::copy(
            sample.join("SCISSOR.DATA"),
            folder.path().join("SCISSOR.DATA"),
        )
        .unwrap();
        let incomplete = crate::load::open(&case).unwrap();
        assert!(names(&incomplete).is_empty());
        let told = |note: &String| note.starts_with("names of faults were not read");
        assert!(incomplete.about.notes.iter().any(told));
        let whole = crate::load::open(&sample.join("SCISSOR.EGRID")).unwrap();
        assert_eq!(names(&whole), ["F1", "F2", "F3"]);
        // F2 lies between columns 24 and 25, counted from 1.
        let cell = Ijk { i: 23, j: 3, k: 0 };
        assert_eq!(whole.fault_faces.fault_of(cell, Face::IPlus), Some(1));
        assert_eq!(whole.fault_faces.fault_of(cell, Face::JPlus), None);
        assert!(!whole.about.notes.iter().any(told));
    }
}
