//! From files to a [`Case`]: the one module that knows both the file formats and the model.

pub mod cube;
mod grids;
mod local;
mod outliers;
mod paths;
mod pore_volume;
mod properties;
mod radial;
mod resqml;
mod restarts;
mod roff;
mod slots;
mod source;
mod summary;
mod volume;
mod wells;

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use strataray_parsers::case::{CaseFiles, GridSource, RestartSource, find, find_with};
use strataray_parsers::cells::{CellArrays, Head};
use strataray_parsers::deck::{Grdecl, UnitSystem};
use strataray_parsers::restart::Step as FileStep;
use strataray_parsers::{At, ErrorKind, ParseError, Warnings, init};

use self::grids::Loaded;
use self::local::{Beside, Local};
use self::properties::Setting;
use self::slots::{CellSlots, ResultCells};
use self::source::FileSource;
use self::summary::SummaryFiles;
use self::wells::WellFiles;
use crate::case::{
    About, Case, FieldCache, GridPool, OverSteps, Simbox, Step, WellsOfSteps, ensemble,
};
use crate::model::{Dims, Ijk};

/// Opens the case that `path` names: any of its files, or its base name.
///
/// # Errors
/// When there is no readable grid. A missing or unfitting INIT or restart only leaves a note.
pub fn open(path: &Path) -> Result<Case, ParseError> {
    open_with(path, &[])
}

/// As [`open`], with files added to the case: text with properties, faults or wells, paths of wells, an INIT or restart
/// of another name.
///
/// # Errors
/// As [`open`], and when an added file is not there or is damaged.
pub fn open_with(path: &Path, with: &[PathBuf]) -> Result<Case, ParseError> {
    match open_reporting(path, with, &|_| true)? {
        Some(case) => Ok(case),
        None => Err(ParseError::new(path, At::File, "", "was not opened")),
    }
}

/// A case by one of its files, with files that were added to it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CasePaths {
    /// What names the case.
    pub path: PathBuf,
    /// Files added to it.
    pub with: Vec<PathBuf>,
    /// Cases on the same grid of which, with this one, statistics are taken.
    pub others: Vec<CasePaths>,
}

impl CasePaths {
    /// A case alone.
    pub fn of(path: PathBuf) -> Self {
        Self {
            path,
            with: Vec::new(),
            others: Vec::new(),
        }
    }
}

/// Opens a case, or several as one with statistics over them ([`crate::case::ensemble`]); grids that are equal to one in the
/// pool are held once. `progress` as in [`open_reporting`].
///
/// # Errors
/// As [`open_with`], and when grids of several cases differ.
pub fn open_paths(
    paths: &CasePaths,
    pool: &GridPool,
    progress: &dyn Fn(&str) -> bool,
) -> Result<Option<Case>, ParseError> {
    let open = |paths: &CasePaths| -> Result<Option<Case>, ParseError> {
        let mut case = open_reporting(&paths.path, &paths.with, progress)?;
        if let Some(case) = &mut case {
            pool.share(case);
        }
        Ok(case)
    };
    let Some(first) = open(paths)? else {
        return Ok(None);
    };
    if paths.others.is_empty() {
        return Ok(Some(first));
    }
    let mut cases = vec![Arc::new(first)];
    for other in &paths.others {
        match open(other)? {
            Some(case) => cases.push(Arc::new(case)),
            None => return Ok(None),
        }
    }
    let wrong = |why: String| ParseError::of(ErrorKind::Mismatch, &paths.path, At::File, "", why);
    let mut case = ensemble(&cases).map_err(wrong)?;
    // What is odd about all of them is told once.
    let known = &cases[0].about.notes;
    let own = cases[1..].iter().flat_map(|case| {
        let notes = case.about.notes.iter().filter(|note| !known.contains(note));
        notes.map(|note| format!("{}: {note}", case.about.name))
    });
    let notes: Vec<String> = known.iter().cloned().chain(own).collect();
    case.about.notes.splice(0..0, notes);
    Ok(Some(case))
}

/// The cases that several paths name together: a file without a grid of its own is added to the case before it, or
/// to the first one; further files of the same case are left out.
pub fn group(paths: &[PathBuf]) -> Vec<CasePaths> {
    let case = |path: &PathBuf| CasePaths::of(path.clone());
    if let [only] = paths {
        return vec![case(only)];
    }
    let grids: Vec<Option<GridSource>> = paths.iter().map(|path| own_grid(path)).collect();
    let mut cases: Vec<(CasePaths, &GridSource)> = Vec::new();
    let mut early = Vec::new();
    for (path, grid) in paths.iter().zip(&grids) {
        if let Some(grid) = grid {
            if !cases.iter().any(|(_, known)| *known == grid) {
                cases.push((case(path), grid));
            }
        } else {
            let last = cases.last_mut().map(|(case, _)| &mut case.with);
            last.unwrap_or(&mut early).push(path.clone());
        }
    }
    match cases.first_mut() {
        Some((first, _)) => first.with.splice(0..0, early).for_each(drop),
        // Nothing can be opened: each path tells why.
        None => return paths.iter().map(case).collect(),
    }
    cases.into_iter().map(|(case, _)| case).collect()
}

/// True where `path` alone names a case; a file of properties or fault names only belongs to one.
pub fn is_case(path: &Path) -> bool {
    own_grid(path).is_some()
}

/// True where there is something at `path`: a file, a folder, or a case of that base name.
pub fn is_there(path: &Path) -> bool {
    path.exists() || is_case(path)
}

/// The grid of the case that `path` names; `None` for a file that only belongs to one.
fn own_grid(path: &Path) -> Option<GridSource> {
    let grid = find(path).ok()?.grid;
    match &grid {
        GridSource::Deck(deck) if !Grdecl::is_grid(deck).unwrap_or(true) => None,
        GridSource::Roff(file) if !roff::is_grid(file) => None,
        _ => Some(grid),
    }
}

/// As [`open_with`]; `progress` is told what is read next, and returns false to leave it: the result is `None`
/// then.
///
/// # Errors
/// As [`open_with`].
pub fn open_reporting(
    path: &Path,
    with: &[PathBuf],
    progress: &dyn Fn(&str) -> bool,
) -> Result<Option<Case>, ParseError> {
    let files = find_with(path, with)?;
    if !progress("the grid") {
        return Ok(None);
    }
    let mut warnings = Warnings::default();
    let mut about = About {
        name: files.name.clone(),
        summary: files.summary.iter().flat_map(summary::paths).collect(),
        ..About::default()
    };
    for (file, why) in &files.not_read {
        let note = format!("{} was not read: {why}", file.display());
        about.notes.push(note);
    }
    let loaded = grids::read(&files, &mut about, &mut warnings)?;
    if !progress("static properties") {
        return Ok(None);
    }
    let init = open_init(&files, &mut about, &mut warnings);
    if !progress("time steps") {
        return Ok(None);
    }
    let runs = restarts::open(&files.restart, &mut about.notes, &mut warnings);
    if !progress("wells") {
        return Ok(None);
    }
    let paths = files.paths.iter().map(PathBuf::as_path);
    let paths = paths::read(paths, &mut about, &mut warnings)?;
    note_missing(&files, &mut about);
    let read = Read {
        init,
        runs,
        summary: SummaryFiles::new(files.summary),
        schedules: &files.schedules,
        paths,
    };
    Ok(Some(build(loaded, read, about, &warnings)))
}

/// What was read of a case beside its grid.
struct Read<'a> {
    init: Option<CellArrays>,
    runs: Vec<Vec<FileStep>>,
    summary: SummaryFiles,
    /// Decks that may have wells.
    schedules: &'a [PathBuf],
    paths: paths::Files<'a>,
}

/// What the heads of results say.
struct Told {
    units: Option<UnitSystem>,
    phases: Option<i32>,
    /// Number of active cells.
    active: Option<usize>,
}

impl Told {
    fn of(init: Option<&CellArrays>, first: Option<&CellArrays>) -> Self {
        let all = [init, first].into_iter().flatten();
        let heads: Vec<_> = all.filter_map(|arrays| arrays.head().ok()).collect();
        let active = |head: &Head| usize::try_from(head.active).ok();
        Self {
            units: heads.iter().find_map(|head| head.units),
            phases: heads.iter().map(|head| head.phases).find(|n| *n > 0),
            active: heads.iter().filter_map(active).find(|n| *n > 0),
        }
    }
}

/// The case of what was read.
fn build(mut loaded: Loaded, read: Read<'_>, mut about: About, warnings: &Warnings) -> Case {
    let Read {
        init,
        runs,
        summary,
        schedules,
        paths,
    } = read;
    let first = runs.iter().flatten().next().map(|s| &s.arrays);
    let told = Told::of(init.as_ref(), first);
    let length = loaded.settle_units(told.units, &mut about);
    let units = told.units.or(loaded.units).unwrap_or(match length.short() {
        "FT" => UnitSystem::Field,
        "CM" => UnitSystem::Lab,
        _ => UnitSystem::Metric,
    });
    let notes = &mut about.notes;
    let (least, volume_unit) = pore_volume::of_deck(&mut loaded, units, length, notes);
    let results = ResultCells {
        active: told.active,
        init: init.as_ref(),
    };
    let summary = summary.of_grid(loaded.grid.main_dims());
    let mut cells = CellSlots::new(&mut loaded.grid, &loaded.flags, &results, &mut about.notes);
    let left_out = outliers::leave_out(&mut loaded.grid, &mut cells);
    about.notes.extend(left_out);
    let local_grids = std::mem::take(&mut loaded.local_grids);
    let beside = Beside {
        main: &loaded.grid,
        init: init.as_ref(),
        least: least.as_ref(),
        is_dual: loaded.flags.porosity.is_some(),
        volume_unit,
    };
    let locals = local::read(local_grids, &beside, &mut about.notes);
    let mut source = FileSource {
        cells,
        local: None,
        init: None,
        steps: Vec::new(),
        texts: std::mem::take(&mut loaded.texts),
        package: loaded.package.take(),
        volumes: std::mem::take(&mut loaded.volumes),
        summary,
        wells: WellFiles::default(),
    };
    source.take_fitting(init, runs, &mut about);
    leave_unfinished(&mut source.steps, &mut about.notes);
    about.notes.extend(source.misfits());
    if let Some(package) = source.package.as_mut().filter(|_| !source.steps.is_empty()) {
        about.notes.extend(package.drop_steps());
    }
    read_wells(&mut source, schedules, loaded.grid.main_dims(), &mut about);
    add_local_grids(&mut loaded, &mut source, locals, &mut about);
    let paths = paths::placed(paths, &loaded.grid, &mut about);
    source.wells.add_paths(paths, &mut about);
    let setting = Setting {
        units,
        length,
        phases: told.phases.unwrap_or(loaded.phases),
        time: about.time_unit.clone(),
        has_connections: !loaded.connections.is_empty(),
    };
    let properties = properties::of(&source, &setting, &mut about);
    about.notes.extend(warnings.iter().map(ToString::to_string));
    Case {
        grid: Arc::new(loaded.grid),
        about,
        fault_faces: Arc::new(loaded.fault_faces),
        connections: loaded.connections,
        steps: steps_of(&source),
        properties,
        source: Arc::new(source),
        cache: Arc::new(FieldCache::default()),
        over_steps: Arc::new(OverSteps::default()),
        wells: Arc::new(WellsOfSteps::default()),
        minus: Vec::new(),
        ensemble: None,
        simbox: Simbox::default(),
        cubes: Arc::default(),
    }
}

/// Lays local grids beside the main one; what of them is not shown becomes a note.
fn add_local_grids(
    loaded: &mut Loaded,
    source: &mut FileSource,
    mut locals: Vec<Local>,
    about: &mut About,
) {
    let mut main = Cow::Borrowed(&loaded.grid);
    match local::reservoirs(&loaded.grid, &loaded.reservoirs) {
        _ if loaded.reservoirs.is_empty() => {}
        Ok((rest, reservoirs)) => {
            main = Cow::Owned(rest);
            locals.extend(reservoirs);
            about.notes.push(local::told(&loaded.reservoirs));
        }
        Err(why) => about.notes.push(format!(
            "the first coordinate system is used for all layers: {why}"
        )),
    }
    if locals.is_empty() {
        return;
    }
    let last = source.steps.last().map(|step| &step.arrays);
    let arrays: Vec<_> = source.init.iter().chain(last).collect();
    let left_out = local::arrays_left_out(&locals, &source.texts, &arrays);
    about.notes.extend(left_out);
    let connections = &loaded.local_connections;
    match local::join(&main, &source.cells, locals, connections) {
        Ok((grid, places, connections)) => {
            let in_lattice = |cell: &mut Ijk| *cell = grid.in_lattice(0, *cell).unwrap_or(*cell);
            loaded.connections.iter_mut().flatten().for_each(in_lattice);
            loaded.grid = grid;
            loaded.connections.extend(connections);
            source.local = Some(places);
        }
        Err(why) => about
            .notes
            .push(format!("local grids are not shown: {why}")),
    }
}

/// The steps of the results, else those of a package.
fn steps_of(source: &FileSource) -> Vec<Step> {
    match &source.package {
        Some(package) if source.steps.is_empty() => package.steps().to_vec(),
        _ => source.steps.iter().map(step).collect(),
    }
}

fn step(step: &FileStep) -> Step {
    Step {
        report: step.report,
        date: step.head.time(),
        days: step.days,
    }
}

fn open_init(files: &CaseFiles, about: &mut About, warnings: &mut Warnings) -> Option<CellArrays> {
    match init::open(files.init.as_ref()?, warnings) {
        Ok(arrays) => Some(arrays),
        Err(error) => {
            about.notes.push(format!("INIT was not loaded: {error}"));
            None
        }
    }
}

/// Leaves out a last step that is still being written: one whose file ends within an array, or that lacks
/// the mark of the end which the step before has.
fn leave_unfinished(steps: &mut Vec<FileStep>, notes: &mut Vec<String>) {
    let [.., before, last] = steps.as_slice() else {
        return;
    };
    let has_end = |step: &FileStep| step.arrays.find("ENDSOL").is_some();
    let lacks = before
        .arrays
        .iter()
        .any(|e| last.arrays.find(e.name()).is_none());
    let is_cut = last.arrays.file().is_cut() || has_end(before) && !has_end(last);
    if is_cut && lacks {
        notes.push(format!(
            "report {} was left out: its file ends before all of its arrays, as while it is being written",
            last.report
        ));
        steps.pop();
    }
}

/// The wells of the restart are the truth where it has some, else those of decks.
fn read_wells(source: &mut FileSource, decks: &[PathBuf], dims: Dims, about: &mut About) {
    if let Some(last) = source.steps.last() {
        let (names, wells) = (last.wells(), wells::of(last));
        if let Some(error) = names.as_ref().err().or(wells.as_ref().err()) {
            about.notes.push(format!("wells were not loaded: {error}"));
        }
        about.wells = names.unwrap_or_default();
    }
    if about.wells.is_empty() && !decks.is_empty() {
        let first = source.steps.first().map(step);
        let start = first.and_then(|step| Some(step.moment()? - step.days));
        source.wells.read_schedule(decks, dims, start, about);
    }
}

fn note_missing(files: &CaseFiles, about: &mut About) {
    if !matches!(files.grid, GridSource::Egrid(_)) {
        return;
    }
    if files.init.is_none() && files.added.is_empty() {
        about
            .notes
            .push("there is no INIT file, so static properties such as PORO are missing".into());
    }
    if files.restart == RestartSource::None {
        about.notes.push(
            "there is no restart file, so time steps and dynamic properties are missing".into(),
        );
    }
}
