//! From files to a [`Case`]: the one module that knows both the file formats and the model.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use strataray_parsers::case::{GridSource, RestartSource, find};
use strataray_parsers::cells::CellArrays;
use strataray_parsers::deck::Grdecl;
use strataray_parsers::egrid::{Egrid, PorosityModel};
use strataray_parsers::restart::{self, Step as FileStep};
use strataray_parsers::units::UnitSystem;
use strataray_parsers::{At, ParseError, Warnings, init};

use crate::case::{
    About, Case, CaseError, FieldCache, Kind, LoadTimes, LocalGrid, NamedFault, POROSITY_THICKNESS,
    Property, SOIL, Source, Step,
};
use crate::model::derived::Derived;
use crate::model::topology::Face;
use crate::model::{Dims, FaultFaces, Grid, GridInput, MapAxes, ModelError};

/// Arrays of cell count that are no properties: solver and well bookkeeping.
const NOT_PROPERTIES: [&str; 3] = ["ACTNUM", "SEQNUM", "INTEHEAD"];

/// Opens the case that `path` names: any of its files, or its base name.
///
/// # Errors
/// When there is no readable grid. A missing or unfitting INIT or restart only leaves a note.
pub fn open(path: &Path) -> Result<Case, ParseError> {
    match open_with(path, &|_| true)? {
        Some(case) => Ok(case),
        None => Err(ParseError::new(path, At::File, "", "was not opened")),
    }
}

/// As [`open`]; `progress` is told what is read next, and returns false to leave it: the result is `None`
/// then.
///
/// # Errors
/// As [`open`].
pub fn open_with(path: &Path, progress: &dyn Fn(&str) -> bool) -> Result<Option<Case>, ParseError> {
    let files = find(path)?;
    if !progress("the grid") {
        return Ok(None);
    }
    let mut warnings = Warnings::default();
    let mut about = About {
        name: files.name.clone(),
        ..About::default()
    };
    for (file, why) in &files.not_read {
        about
            .notes
            .push(format!("{} was not read: {why}", file.display()));
    }
    let (grid, cells, deck) = match &files.grid {
        GridSource::Egrid(path) => read_egrid(path, &mut about, &mut warnings)?,
        GridSource::Deck(path) => read_deck(path, &mut about, &mut warnings)?,
    };
    let mut source = FileSource {
        cells,
        init: None,
        steps: Vec::new(),
        deck,
    };
    let fault_faces = source
        .deck
        .as_ref()
        .map(|deck| fault_faces(deck, &about.named_faults));
    if !progress("static properties") {
        return Ok(None);
    }
    if let Some(path) = &files.init {
        match init::open(path).and_then(|a| source.check(&a, path).map(|()| a)) {
            Ok(arrays) => {
                about.files.push(path.clone());
                source.init = Some(arrays);
            }
            Err(error) => about.notes.push(format!("INIT was not loaded: {error}")),
        }
    }
    if !progress("time steps") {
        return Ok(None);
    }
    match open_restart(&files.restart, &source, &mut warnings) {
        Ok(steps) => {
            about
                .files
                .extend(steps.iter().map(|s| s.arrays.file().path().to_owned()));
            about.files.dedup();
            source.steps = steps;
        }
        Err(error) => about
            .notes
            .push(format!("time steps were not loaded: {error}")),
    }
    note_missing(&files.restart, files.init.is_some(), &source, &mut about);
    if let Some(last) = source.steps.last() {
        match last.wells() {
            Ok(wells) => about.wells = wells,
            Err(error) => about.notes.push(format!("wells were not loaded: {error}")),
        }
    }
    let steps: Vec<Step> = source
        .steps
        .iter()
        .map(|s| Step {
            report: s.report,
            date: s.head.date.clone(),
            days: s.days,
        })
        .collect();
    let properties = properties(&source, &about.length_unit, &mut about.notes);
    about.notes.extend(warnings.iter().map(ToString::to_string));
    Ok(Some(Case {
        grid,
        about,
        fault_faces: Arc::new(fault_faces.unwrap_or_default()),
        steps,
        properties,
        source: Box::new(source),
        cache: FieldCache::default(),
    }))
}

fn note_missing(restart: &RestartSource, has_init: bool, source: &FileSource, about: &mut About) {
    if source.deck.is_some() {
        return;
    }
    if !has_init {
        about
            .notes
            .push("there is no INIT file, so static properties such as PORO are missing".into());
    }
    if *restart == RestartSource::None {
        about.notes.push(
            "there is no restart file, so time steps and dynamic properties are missing".into(),
        );
    }
}

fn model_error(path: &Path, error: &ModelError) -> ParseError {
    ParseError::new(path, At::File, "", error.to_string())
}

type Loaded = (Grid, CellSlots, Option<Grdecl>);

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
    Ok((grid, slots, None))
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
    Ok((
        grid,
        slots,
        Some(Grdecl {
            coord: Vec::new(),
            zcorn: Vec::new(),
            ..deck
        }),
    ))
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

fn open_restart(
    restart: &RestartSource,
    source: &FileSource,
    warnings: &mut Warnings,
) -> Result<Vec<FileStep>, ParseError> {
    let steps = match restart {
        RestartSource::None => Vec::new(),
        RestartSource::Unified(path) => restart::open_unified(path, warnings)?,
        RestartSource::Separate(files) => restart::open_separate(files, warnings)?,
    };
    if let Some(first) = steps.first() {
        source.check(&first.arrays, first.arrays.file().path())?;
    }
    Ok(steps)
}

/// How cell arrays of a file map to the grid's active cells.
struct CellSlots {
    /// Natural index of each active cell.
    cells: Vec<u32>,
    /// All cells.
    total: usize,
    /// For dual porosity: by active cell, its rank among those with an active matrix.
    matrix: Option<Matrix>,
}

struct Matrix {
    rank: Vec<Option<u32>>,
    /// Active matrix cells, and matrix and fracture cells together.
    counts: [usize; 2],
}

impl CellSlots {
    fn new(grid: &Grid, actnum: Option<&[i32]>, model: PorosityModel) -> Self {
        let cells: Vec<u32> = grid.active_cells().iter().map(|c| c.0).collect();
        let matrix = actnum
            .filter(|_| model != PorosityModel::Single)
            .map(|actnum| {
                let mut counts = [0, 0];
                let rank = cells.iter().map(|&c| {
                    let flags = actnum[c as usize];
                    counts[1] += usize::from(flags & 2 != 0);
                    (flags & 1 != 0).then(|| {
                        counts[0] += 1;
                        counts[0] as u32 - 1
                    })
                });
                let rank = rank.collect();
                Matrix {
                    rank,
                    counts: [counts[0], counts[0] + counts[1]],
                }
            });
        Self {
            cells,
            total: grid.dims().cells(),
            matrix,
        }
    }

    /// True where an array of this length has a value for each active cell.
    fn fits(&self, count: usize) -> bool {
        let dual = self
            .matrix
            .as_ref()
            .is_some_and(|m| m.counts[1] == count || count == 2 * self.total);
        dual || count == self.total || count == self.cells.len() && self.matrix.is_none()
    }

    /// The values of the active cells from an array that fits.
    fn pick(&self, values: &[f32]) -> Vec<f32> {
        match &self.matrix {
            Some(m) if values.len() == m.counts[1] => m
                .rank
                .iter()
                .map(|r| r.map_or(f32::NAN, |r| values[r as usize]))
                .collect(),
            Some(m) => m
                .rank
                .iter()
                .zip(&self.cells)
                .map(|(r, &c)| {
                    if r.is_some() {
                        values[c as usize]
                    } else {
                        f32::NAN
                    }
                })
                .collect(),
            None if values.len() == self.cells.len() => values.to_vec(),
            None => self.cells.iter().map(|&c| values[c as usize]).collect(),
        }
    }
}

/// Values from the case's files, decoded when asked for.
struct FileSource {
    cells: CellSlots,
    init: Option<CellArrays>,
    steps: Vec<FileStep>,
    deck: Option<Grdecl>,
}

impl FileSource {
    /// Refuses results of another grid.
    fn check(&self, arrays: &CellArrays, path: &Path) -> Result<(), ParseError> {
        let head = arrays.head()?;
        let expected = self
            .cells
            .matrix
            .as_ref()
            .map_or(self.cells.cells.len(), |m| m.counts[1]);
        let active = usize::try_from(head.active).unwrap_or(0);
        if active == 0 || active == expected || active == self.cells.cells.len() {
            return Ok(());
        }
        let message = format!(
            "has {active} active cells and the grid {expected}; it belongs to another grid"
        );
        Err(ParseError::new(path, At::File, "INTEHEAD", message))
    }

    fn arrays(&self, name: &str, step: usize) -> Option<&CellArrays> {
        let holds = |a: &&CellArrays| a.find(name).is_some_and(|e| self.is_property(e));
        self.steps
            .get(step)
            .map(|s| &s.arrays)
            .filter(holds)
            .or_else(|| self.init.as_ref().filter(holds))
    }

    fn is_property(&self, entry: &strataray_parsers::records::Entry) -> bool {
        entry.is_numeric()
            && self.cells.fits(entry.count as usize)
            && !NOT_PROPERTIES.contains(&entry.name())
    }

    fn units(&self) -> Option<UnitSystem> {
        let heads = self
            .init
            .iter()
            .chain(self.steps.first().map(|s| &s.arrays));
        heads.filter_map(|a| a.head().ok()?.units).next()
    }
}

impl Source for FileSource {
    fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, CaseError> {
        if let Some(property) = self
            .deck
            .as_ref()
            .and_then(|d| d.properties.iter().find(|p| p.name == name))
        {
            let values: Vec<f32> = property.values.iter().map(|v| *v as f32).collect();
            return Ok(Some(self.cells.pick(&values)));
        }
        let Some((arrays, entry)) = self
            .arrays(name, step)
            .and_then(|a| Some((a, a.find(name)?)))
        else {
            return Ok(None);
        };
        Ok(Some(self.cells.pick(&arrays.values(entry)?)))
    }
}

fn properties(source: &FileSource, length_unit: &str, notes: &mut Vec<String>) -> Vec<Property> {
    let units = source.units().or(match length_unit {
        "FEET" => Some(UnitSystem::Field),
        "CM" => Some(UnitSystem::Lab),
        _ => Some(UnitSystem::Metric),
    });
    let unit = |name: &str| units.map_or("", |u| u.unit_of(name)).to_owned();
    let mut list: Vec<Property> = Vec::new();
    let mut add =
        |name: &str, kind: Kind, steps: usize| match list.iter_mut().find(|p| p.name == name) {
            Some(known) => known.steps = known.steps.max(steps),
            None => list.push(Property {
                name: name.to_owned(),
                kind,
                unit: unit(name),
                steps,
            }),
        };
    for property in source.deck.iter().flat_map(|d| &d.properties) {
        add(&property.name, Kind::Static, 0);
    }
    // Dynamic ones first claim their names: a property of both INIT and restart changes with time.
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for step in &source.steps {
        for entry in step.arrays.iter().filter(|e| source.is_property(e)) {
            match counts.iter_mut().find(|c| c.0 == entry.name()) {
                Some(count) => count.1 += 1,
                None => counts.push((entry.name(), 1)),
            }
        }
    }
    for entry in source
        .init
        .iter()
        .flat_map(CellArrays::iter)
        .filter(|e| source.is_property(e))
    {
        if !counts.iter().any(|c| c.0 == entry.name()) {
            add(entry.name(), Kind::Static, 0);
        }
    }
    for &(name, steps) in &counts {
        add(name, Kind::Dynamic, steps);
    }
    let has = |list: &[Property], name: &str| list.iter().any(|p| p.name == name);
    if !has(&list, SOIL) && has(&list, "SWAT") {
        let phases = source.steps.first().map_or(0, |s| s.head.phases);
        // Bit 1 oil: without oil there is no oil saturation to complete.
        if phases & 1 == 1 || phases == 0 {
            let steps = counts.iter().find(|c| c.0 == "SWAT").map_or(0, |c| c.1);
            list.push(Property {
                name: SOIL.into(),
                kind: Kind::Derived,
                unit: String::new(),
                steps,
            });
        } else {
            notes.push("SOIL is not derived: the case has no oil phase".into());
        }
    }
    if has(&list, "PORO") {
        list.push(Property {
            name: POROSITY_THICKNESS.into(),
            kind: Kind::Derived,
            unit: unit(POROSITY_THICKNESS),
            steps: 0,
        });
    }
    for (name, _) in Derived::ALL {
        if !has(&list, name) {
            list.push(Property {
                name: name.into(),
                kind: Kind::Derived,
                unit: unit(name),
                steps: 0,
            });
        }
    }
    list
}
