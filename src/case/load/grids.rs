//! The grid of a case with what else its files say: EGRID or a deck, and text that was added.

use std::path::{Path, PathBuf};
use std::time::Instant;

use strataray_parsers::case::{CaseFiles, GridSource};
use strataray_parsers::deck::{
    DeckCells, DeckLocalGrid, DeckProperty, FaultFaces as DeckFault, Grdecl,
};
use strataray_parsers::egrid::{Egrid, GridConnections, LocalGrid, PorosityModel, Reservoir};
use strataray_parsers::roff::Pillars;
use strataray_parsers::units::{LengthUnit, UnitSystem};
use strataray_parsers::{At, ErrorKind, ParseError, Warnings};

use super::outliers::{self, Coordinate};
use super::resqml::{self, PackageValues};
use super::roff;
use super::slots::CellFlags;
use super::volume::{self, VolumeValues};
use crate::case::{About, LoadTimes, NamedFault};
use crate::model::topology::Face;
use crate::model::{
    CellIndex, Dims, FaultFaces, Grid, GridInput, Ijk, MapAxes, MapUnit, ModelError,
};

fn model_error(path: &Path, error: &ModelError) -> ParseError {
    let kind = match error {
        ModelError::Length { .. } => ErrorKind::WrongCount,
        ModelError::NotFinite { .. } | ModelError::Lattice(_) => ErrorKind::BadValue,
        ModelError::Dimensions(..) | ModelError::Memory(..) | ModelError::Empty(..) => {
            ErrorKind::TooLarge
        }
    };
    ParseError::of(kind, path, At::File, "", error.to_string())
}

/// What the files of the grid give.
pub struct Loaded {
    pub grid: Grid,
    pub flags: CellFlags,
    /// Arrays of decks and other text.
    pub texts: Vec<DeckProperty>,
    /// Properties and steps of a RESQML package.
    pub package: Option<PackageValues>,
    /// Values of regular volumes.
    pub volumes: Vec<VolumeValues>,
    pub connections: Vec<[Ijk; 2]>,
    /// With arrays of text, where they are of a deck.
    pub local_grids: Vec<DeckLocalGrid>,
    /// Layers with pillars of their own.
    pub reservoirs: Vec<Reservoir>,
    pub local_connections: Vec<GridConnections>,
    pub fault_faces: FaultFaces,
    /// What a deck's RUNSPEC says.
    pub units: Option<UnitSystem>,
    pub phases: i32,
    /// MINPV.
    pub min_pore_volume: Option<f64>,
    pub is_deck: bool,
    map: MapKeywords,
}

/// Where a grid lies in the map, and the units, as its file says.
#[derive(Default)]
struct MapKeywords {
    axes: Option<[f64; 6]>,
    unit: Option<String>,
    /// GRIDUNIT.
    length: Option<String>,
    /// True where coordinates are map coordinates already.
    is_map: bool,
}

impl Loaded {
    /// Settles the length unit, from GRIDUNIT or else the results' unit system or the deck's, and with it the map axes.
    pub fn settle_units(&mut self, results: Option<UnitSystem>, about: &mut About) -> LengthUnit {
        let system = results.or(self.units);
        let implied = system.map_or(LengthUnit::Metre, UnitSystem::length);
        let named = self.map.length.as_deref().filter(|name| !name.is_empty());
        let length = named.map_or(Some(implied), LengthUnit::from_name);
        let length = length.unwrap_or_else(|| {
            about.notes.push(format!(
                "GRIDUNIT {} is not known: lengths are taken as {}",
                named.unwrap_or_default(),
                implied.name()
            ));
            implied
        });
        // Without MAPUNITS, and where coordinates are those of the map, everything is in one unit.
        let map = self.map.unit.as_deref().filter(|_| !self.map.is_map);
        let map = map.and_then(LengthUnit::from_name).unwrap_or(length);
        let axes = self.map.axes.and_then(MapAxes::from_keyword);
        let axes = axes.filter(|_| !self.map.is_map);
        self.grid.set_map_axes(axes.map(|axes| match map == length {
            true => axes,
            false => axes.in_unit(MapUnit {
                name: map.name(),
                length: map.meters() / length.meters(),
            }),
        }));
        about.length_unit = length.name().to_owned();
        about.map_unit = map.name().to_owned();
        length
    }
}

/// Reads the grid; what else its files say goes into `about`.
pub fn read(
    files: &CaseFiles,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<Loaded, ParseError> {
    let mut loaded = match &files.grid {
        GridSource::Egrid(path) => read_egrid(path, about, warnings)?,
        GridSource::Roff(path) => read_roff(path, about)?,
        GridSource::Resqml(path) => read_resqml(path, about)?,
        GridSource::Volume(path) => read_volumes(path, &files.volumes, about)?,
        GridSource::Deck(path) => {
            let deck = Grdecl::read_with(path, &files.added, warnings)?;
            read_deck(path, deck, about)?
        }
    };
    if !loaded.is_deck {
        add_texts(&mut loaded, files, about, warnings)?;
    }
    let Dims { ni, nj, nk } = loaded.grid.dims();
    roff::add(&mut loaded.texts, [ni, nj, nk], &files.roff)?;
    about.files.extend(files.roff.iter().cloned());
    Ok(loaded)
}

fn read_egrid(
    path: &Path,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<Loaded, ParseError> {
    let egrid = Egrid::read(path, warnings)?;
    let input = GridInput {
        dims: dims(egrid.dims),
        coord: &egrid.coord,
        zcorn: &egrid.zcorn,
        actnum: egrid.actnum.as_deref(),
        map_axes: None,
    };
    let grid = built(path, &input, about)?;
    about.files.push(path.to_owned());
    about.map_axes = egrid.map_axes;
    about.nnc = egrid.nnc.len();
    about.porosity_model = porosity_name(egrid.porosity_model).into();
    let connections = connections(&egrid.nnc, grid.dims());
    let unit = egrid.grid_unit;
    Ok(Loaded {
        grid,
        flags: CellFlags::new(egrid.actnum, egrid.coarse, egrid.porosity_model),
        texts: Vec::new(),
        package: None,
        volumes: Vec::new(),
        connections,
        local_grids: of_results(egrid.local_grids),
        reservoirs: egrid.reservoirs,
        local_connections: egrid.local_nnc,
        fault_faces: FaultFaces::default(),
        units: None,
        phases: 0,
        min_pore_volume: None,
        is_deck: false,
        map: MapKeywords {
            axes: egrid.map_axes,
            unit: egrid.map_units,
            is_map: unit.as_ref().is_some_and(|u| u.is_map),
            length: unit.map(|u| u.length),
        },
    })
}

/// Local grids whose arrays are in files of results.
fn of_results(grids: Vec<LocalGrid>) -> Vec<DeckLocalGrid> {
    let grid = |grid: LocalGrid| DeckLocalGrid {
        grid: grid.widened(),
        properties: Vec::new(),
    };
    grids.into_iter().map(grid).collect()
}

/// The grid of the arrays of a file; what building it takes is noted.
fn built<C: Coordinate, Z: Coordinate>(
    path: &Path,
    input: &GridInput<'_, C, Z>,
    about: &mut About,
) -> Result<Grid, ParseError> {
    let start = Instant::now();
    let grid = outliers::built(input, &mut about.notes);
    let grid = grid.map_err(|e| model_error(path, &e))?;
    about.load_times = LoadTimes {
        model: start.elapsed(),
    };
    Ok(grid)
}

fn porosity_name(model: PorosityModel) -> &'static str {
    match model {
        PorosityModel::Single => "single",
        PorosityModel::Dual => "dual",
        PorosityModel::DualPermeability => "dual_permeability",
    }
}

fn read_deck(path: &Path, deck: Grdecl, about: &mut About) -> Result<Loaded, ParseError> {
    let input = GridInput {
        dims: dims(deck.dims),
        coord: &deck.coord,
        zcorn: &deck.zcorn,
        actnum: deck.actnum.as_deref(),
        map_axes: None,
    };
    let grid = built(path, &input, about)?;
    about.notes.extend(fracture_permeabilities(&deck));
    about.files.extend(deck.files);
    about.map_axes = deck.map_axes;
    about.porosity_model = porosity_name(deck.porosity_model).into();
    about.named_faults = named_faults(&deck.faults);
    let fault_faces = fault_faces(&deck.faults, &about.named_faults);
    Ok(Loaded {
        grid,
        flags: CellFlags::new(deck.actnum, None, deck.porosity_model),
        texts: deck.properties,
        package: None,
        volumes: Vec::new(),
        connections: Vec::new(),
        local_grids: deck.local_grids,
        reservoirs: Vec::new(),
        local_connections: Vec::new(),
        fault_faces,
        units: deck.unit_system,
        phases: deck.phases,
        min_pore_volume: deck.min_pore_volume,
        is_deck: true,
        map: MapKeywords {
            axes: deck.map_axes,
            unit: deck.map_units,
            is_map: deck.grid_unit.as_ref().is_some_and(|u| u.is_map),
            length: deck.grid_unit.map(|u| u.name),
        },
    })
}

/// What the permeabilities of fractures are, where a simulator takes others than the deck's.
fn fracture_permeabilities(deck: &Grdecl) -> Option<String> {
    let is_taken = deck.porosity_model == PorosityModel::Single || deck.has_effective_fractures;
    let cells = deck.dims.iter().product::<usize>();
    let is_given =
        |p: &&DeckProperty| p.name.starts_with("PERM") && p.values.len() > cells && !is_taken;
    let given = deck.properties.iter().find(is_given)?;
    Some(format!(
        "{}.FRACTURE and other permeabilities of fractures are those of the deck: without NODPPM a simulator multiplies \
         them by the porosity of the fractures",
        given.name
    ))
}

fn read_roff(path: &Path, about: &mut About) -> Result<Loaded, ParseError> {
    let roff::Contents {
        pillars,
        properties,
    } = roff::read(path)?;
    let mut loaded = of_pillars(path, &pillars, about)?;
    loaded.texts = properties;
    let note = "ROFF files say no units: lengths are taken as METRES";
    about.notes.push(note.into());
    Ok(loaded)
}

fn read_resqml(path: &Path, about: &mut About) -> Result<Loaded, ParseError> {
    let contents = resqml::read(path, &mut about.notes)?;
    let mut loaded = of_pillars(path, &contents.pillars, about)?;
    about.files.extend(contents.values.array_files());
    loaded.package = Some(contents.values);
    loaded.map.length = Some(contents.unit.name().to_owned());
    Ok(loaded)
}

/// A grid of pillars in map coordinates, with nothing beside it.
fn of_pillars(path: &Path, pillars: &Pillars, about: &mut About) -> Result<Loaded, ParseError> {
    let input = GridInput {
        dims: dims(pillars.dims),
        coord: &pillars.coord,
        zcorn: &pillars.zcorn,
        actnum: pillars.actnum.as_deref(),
        map_axes: None,
    };
    let grid = built(path, &input, about)?;
    about.files.push(path.to_owned());
    Ok(of_grid(grid, about))
}

/// The cells of a regular volume, and the values of it and of others on the same lattice.
fn read_volumes(path: &Path, others: &[PathBuf], about: &mut About) -> Result<Loaded, ParseError> {
    let first = volume::open(path)?;
    let start = Instant::now();
    let lattice = first.lattice;
    let grid = Grid::regular(&lattice).map_err(|e| model_error(path, &e))?;
    about.load_times = LoadTimes {
        model: start.elapsed(),
    };
    about.files.push(path.to_owned());
    about.notes.extend(first.notes);
    about.time_unit = first.time;
    about.subject = Some(first.values.name().to_owned());
    let mut loaded = of_grid(grid, about);
    loaded.map.length = Some(first.length.into());
    loaded.volumes.push(first.values);
    for path in others {
        let mut other = volume::open(path)?;
        other.check_lattice(&lattice)?;
        other.values.rename(&loaded.volumes);
        about.files.push(path.clone());
        let new = other
            .notes
            .into_iter()
            .filter(|note| !about.notes.contains(note));
        let new: Vec<String> = new.collect();
        about.notes.extend(new);
        loaded.volumes.push(other.values);
    }
    Ok(loaded)
}

/// A grid in map coordinates, with nothing beside it.
fn of_grid(grid: Grid, about: &mut About) -> Loaded {
    about.porosity_model = "single".into();
    Loaded {
        grid,
        flags: CellFlags::default(),
        texts: Vec::new(),
        package: None,
        volumes: Vec::new(),
        connections: Vec::new(),
        local_grids: Vec::new(),
        reservoirs: Vec::new(),
        local_connections: Vec::new(),
        fault_faces: FaultFaces::default(),
        units: None,
        phases: 0,
        min_pore_volume: None,
        is_deck: false,
        map: MapKeywords {
            is_map: true,
            ..MapKeywords::default()
        },
    }
}

/// Faults of the deck beside an EGRID file, and all that was added by hand.
fn add_texts(
    loaded: &mut Loaded,
    files: &CaseFiles,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<(), ParseError> {
    let Dims { ni, nj, nk } = loaded.grid.dims();
    let added = DeckCells::read(&files.added, [ni, nj, nk], warnings)?;
    about.files.extend(added.files);
    loaded.texts.extend(added.properties);
    loaded.units = added.unit_system;
    loaded.phases = added.phases;
    let faults = match &files.deck {
        Some(deck) if added.faults.is_empty() => {
            deck_faults(deck, loaded.grid.dims(), about, warnings)
        }
        _ => added.faults,
    };
    about.named_faults = named_faults(&faults);
    loaded.fault_faces = fault_faces(&faults, &about.named_faults);
    Ok(())
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
fn deck_faults(
    path: &Path,
    dims: Dims,
    about: &mut About,
    warnings: &mut Warnings,
) -> Vec<DeckFault> {
    match Grdecl::read_faults(path, [dims.ni, dims.nj, dims.nk], warnings) {
        Ok(faults) => {
            if !faults.is_empty() {
                about.files.push(path.to_owned());
            }
            faults
        }
        Err(error) => {
            let note = format!("names of faults were not read: {error}");
            about.notes.push(note);
            Vec::new()
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
                multiplier: fault.multiplier,
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
        let without = crate::case::load::open(&case).unwrap();
        assert!(names(&without).is_empty());
        // The deck includes a file that is not there: its names are missing, and a note says so.
        std::fs::copy(
            sample.join("SCISSOR.DATA"),
            folder.path().join("SCISSOR.DATA"),
        )
        .unwrap();
        let incomplete = crate::case::load::open(&case).unwrap();
        assert!(names(&incomplete).is_empty());
        let told = |note: &String| note.starts_with("names of faults were not read");
        assert!(incomplete.about.notes.iter().any(told));
        let whole = crate::case::load::open(&sample.join("SCISSOR.EGRID")).unwrap();
        assert_eq!(names(&whole), ["F1", "F2", "F3"]);
        // F2 lies between columns 24 and 25, counted from 1.
        let cell = Ijk { i: 23, j: 3, k: 0 };
        assert_eq!(whole.fault_faces.fault_of(cell, Face::IPlus), Some(1));
        assert_eq!(whole.fault_faces.fault_of(cell, Face::JPlus), None);
        assert!(!whole.about.notes.iter().any(told));
    }
}
