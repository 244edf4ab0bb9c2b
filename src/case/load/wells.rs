//! From the wells of restart files, decks and files with paths to those of a case.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use strataray_parsers::deck::Schedule;
use strataray_parsers::wells::{self, Completion, Direction, Kind, Status};
use strataray_parsers::{ParseError, Warnings, calendar, restart};

use crate::case::{About, Connection, ConnectionAxis, Step, Well, WellKind, WellPath};
use crate::model::{Dims, Ijk};

/// Where the wells of a case are from, beside its restart.
#[derive(Default)]
pub struct WellFiles {
    /// What decks say, of a case whose restart has no wells.
    schedule: Option<(Schedule, [usize; 3])>,
    /// Wells of the restart or the schedule, by name.
    simulated: Vec<String>,
    /// Paths.
    paths: Vec<Arc<WellPath>>,
}

impl WellFiles {
    /// Reads the decks of a case whose restart has no wells; what is odd about them goes into the notes.
    pub fn read_schedule(
        &mut self,
        decks: &[PathBuf],
        dims: Dims,
        start: Option<f64>,
        about: &mut About,
    ) {
        let decks: Vec<&Path> = decks.iter().map(PathBuf::as_path).collect();
        let mut warnings = Warnings::default();
        let schedule = match Schedule::read(&decks, start, &mut warnings) {
            Ok(schedule) => schedule,
            Err(error) => {
                let note = format!("wells of the deck were not read: {error}");
                about.notes.push(note);
                return;
            }
        };
        about.notes.extend(warnings.iter().map(ToString::to_string));
        if schedule.names.is_empty() {
            return;
        }
        let dims = [dims.ni, dims.nj, dims.nk];
        about.notes.extend(schedule_notes(&schedule, dims, start));
        for file in &schedule.files {
            if !about.files.contains(file) {
                about.files.push(file.clone());
            }
        }
        about.wells.clone_from(&schedule.names);
        self.schedule = Some((schedule, dims));
    }

    /// Adds paths to the wells that are known so far.
    pub fn add_paths(&mut self, paths: Vec<Arc<WellPath>>, about: &mut About) {
        self.simulated.clone_from(&about.wells);
        for path in &paths {
            if !about.wells.iter().any(|well| path.is_of(well)) {
                about.wells.push(path.name.clone());
            }
        }
        about.paths.clone_from(&paths);
        self.paths = paths;
    }

    /// The wells at a step, given those of its restart.
    pub fn at(&self, step: Option<&Step>, restart: Vec<Well>) -> Vec<Well> {
        let mut found = match &self.schedule {
            Some((schedule, dims)) => {
                let moment = step.and_then(Step::moment);
                schedule.wells(moment, *dims).iter().map(well).collect()
            }
            None => restart,
        };
        for path in &self.paths {
            match found.iter_mut().find(|well| path.is_of(&well.name)) {
                Some(well) => well.path = Some(path.clone()),
                // A well that comes at a later step has no path before.
                None if self.simulated.iter().any(|well| path.is_of(well)) => {}
                None => found.push(Well::of_path(path)),
            }
        }
        found
    }
}

/// What is to be known of the wells of a schedule.
fn schedule_notes(schedule: &Schedule, dims: [usize; 3], start: Option<f64>) -> Vec<String> {
    let mut notes = Vec::new();
    let by_itself = "what a run opens and closes by itself is not known";
    notes.push(match start {
        Some(_) => format!("wells are as the deck's schedule says: {by_itself}"),
        None => format!(
            "wells are as the deck's schedule has them at its end, {}: {by_itself}",
            calendar::text(schedule.end)
        ),
    });
    if !schedule.not_evaluated.is_empty() {
        notes.push(format!(
            "not evaluated of the deck's schedule, so that wells may be otherwise: {}",
            schedule.not_evaluated.join(", ")
        ));
    }
    match schedule.outside(dims) {
        0 => {}
        count => notes.push(format!(
            "{count} records of COMPDAT name cells outside of the grid and were left out"
        )),
    }
    notes
}

/// The wells of a step, in the order of the file.
///
/// # Errors
/// When their arrays are damaged.
pub fn of(step: &restart::Step) -> Result<Vec<Well>, ParseError> {
    Ok(wells::read(&step.arrays)?.iter().map(well).collect())
}

fn well(well: &wells::Well) -> Well {
    let global = well.completions.iter().filter_map(|c| connection(None, c));
    let local = well.local.iter().flat_map(|local| {
        let completions = local.completions.iter();
        completions.filter_map(|c| connection(Some(&local.grid), c))
    });
    Well {
        name: well.name.clone(),
        kind: match well.kind {
            Kind::Producer => WellKind::Producer,
            Kind::OilInjector => WellKind::OilInjector,
            Kind::WaterInjector => WellKind::WaterInjector,
            Kind::GasInjector => WellKind::GasInjector,
            Kind::Undefined => WellKind::Unknown,
        },
        is_open: well.status != Status::Shut,
        connections: global.chain(local).collect(),
        path: None,
        targets: well.targets.iter().map(|t| (t.name, t.value)).collect(),
    }
}

/// A connection to a cell of a grid; `None` where the file gives it no place.
fn connection(grid: Option<&str>, completion: &Completion) -> Option<Connection> {
    let [i, j, k] = completion
        .cell
        .map(|n| usize::try_from(n).ok()?.checked_sub(1));
    Some(Connection {
        grid: grid.map(str::to_owned),
        cell: Ijk {
            i: i?,
            j: j?,
            k: k?,
        },
        is_open: completion.is_open,
        axis: match completion.direction {
            Some(Direction::X) => ConnectionAxis::I,
            Some(Direction::Y) => ConnectionAxis::J,
            Some(Direction::Z) | None => ConnectionAxis::K,
        },
    })
}
