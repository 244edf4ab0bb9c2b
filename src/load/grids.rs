//! The grid of a case with what else its file says: EGRID or a deck.

use std::path::Path;
use std::time::Instant;

use strataray_parsers::case::GridSource;
use strataray_parsers::deck::Grdecl;
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
    source: &GridSource,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<Loaded, ParseError> {
    match source {
        GridSource::Egrid(path) => read_egrid(path, about, warnings),
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
    about.named_faults = named_faults(&deck);
    let slots = CellSlots::new(&grid, deck.actnum.as_deref(), PorosityModel::Single);
    let fault_faces = fault_faces(&deck, &about.named_faults);
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

/// The faults of a deck in the order of their names' first use.
fn named_faults(deck: &Grdecl) -> Vec<NamedFault> {
    let mut named: Vec<NamedFault> = Vec::new();
    for fault in &deck.faults {
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
fn fault_faces(deck: &Grdecl, named: &[NamedFault]) -> FaultFaces {
    let mut faces = FaultFaces::default();
    for fault in &deck.faults {
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
