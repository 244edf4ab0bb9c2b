//! From files to a [`Case`]: the one module that knows both the file formats and the model.

mod grids;
mod properties;
mod slots;
mod source;

use std::path::Path;
use std::sync::Arc;

use strataray_parsers::case::{RestartSource, find};
use strataray_parsers::cells::CellArrays;
use strataray_parsers::restart::{self, Step as FileStep};
use strataray_parsers::{At, ParseError, Warnings, init};

use self::grids::Loaded;
use self::source::FileSource;
use crate::case::{About, Case, FieldCache, OverSteps, Step};

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
    let Loaded {
        grid,
        cells,
        deck,
        connections,
        fault_faces,
    } = grids::read(&files, &mut about, &mut warnings)?;
    let mut source = FileSource {
        cells,
        init: None,
        steps: Vec::new(),
        deck,
    };
    if !progress("static properties") {
        return Ok(None);
    }
    if let Some(path) = &files.init {
        source.init = open_init(path, &source, &mut about);
    }
    if !progress("time steps") {
        return Ok(None);
    }
    match open_restart(&files.restart, &source, &mut warnings) {
        Ok(steps) => {
            let read = steps.iter().map(|s| s.arrays.file().path().to_owned());
            about.files.extend(read);
            about.files.dedup();
            source.steps = steps;
            leave_unfinished(&mut source.steps, &mut about.notes);
        }
        Err(error) => about
            .notes
            .push(format!("time steps were not loaded: {error}")),
    }
    note_missing(&files.restart, files.init.is_some(), &source, &mut about);
    read_wells(&source, &mut about);
    let properties = properties::of(&source, !connections.is_empty(), &mut about);
    about.notes.extend(warnings.iter().map(ToString::to_string));
    Ok(Some(Case {
        grid: Arc::new(grid),
        about,
        fault_faces: Arc::new(fault_faces),
        connections,
        steps: source.steps.iter().map(step).collect(),
        properties,
        source: Box::new(source),
        cache: FieldCache::default(),
        over_steps: OverSteps::default(),
        minus: None,
    }))
}

fn step(step: &FileStep) -> Step {
    Step {
        report: step.report,
        date: step.head.date.clone(),
        days: step.days,
    }
}

fn open_init(path: &Path, source: &FileSource, about: &mut About) -> Option<CellArrays> {
    match init::open(path).and_then(|a| source.check(&a, path).map(|()| a)) {
        Ok(arrays) => {
            about.files.push(path.to_owned());
            Some(arrays)
        }
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

fn read_wells(source: &FileSource, about: &mut About) {
    if let Some(last) = source.steps.last() {
        match last.wells() {
            Ok(wells) => about.wells = wells,
            Err(error) => about.notes.push(format!("wells were not loaded: {error}")),
        }
    }
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
