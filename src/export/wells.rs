//! The wells of a case as restart files have them.

use strataray_parsers::wells::{Completion, Direction, Kind, Status, Well};

use super::contents::Contents;
use super::error::ExportError;
use super::output::Output;
use crate::case::{self, ConnectionAxis, WellKind};
use crate::model::Ijk;

/// Bytes of a name in a restart file, at most.
const LONGEST_NAME: usize = 8;

/// An open well with connections to cells of the main grid, each of them open or not.
pub(super) fn open_to(
    name: &str,
    kind: Kind,
    cells: impl Iterator<Item = (Ijk, bool, Direction)>,
) -> Well {
    let completions: Vec<Completion> = (1..)
        .zip(cells)
        .map(|(order, (cell, is_open, direction))| {
            let cell = cell.one_based().map(|n| n as i32);
            Completion {
                is_open,
                ..Completion::open(cell, direction, order)
            }
        })
        .collect();
    let first = completions.first().map_or([0; 3], |first| first.cell);
    Well {
        head: [first[0], first[1]],
        kind,
        status: Status::Open,
        completions,
        ..Well::named(name)
    }
}

/// The wells at a step, but for those of which only a path is known; connections to cells of the main grid.
pub(super) fn of_step(contents: &Contents<'_>, step: usize) -> Result<Vec<Well>, ExportError> {
    let wells = contents.case.wells(step)?;
    Ok(wells
        .iter()
        .filter(|well| is_written(well))
        .map(well)
        .collect())
}

/// Notes what of wells is not written.
pub(super) fn note_paths(contents: &Contents<'_>, output: &mut Output<'_>) {
    let about = &contents.case.about;
    if !about.paths.is_empty() {
        output.note("paths of wells are not written".into());
    }
    let is_long = |name: &&String| name.len() > LONGEST_NAME;
    let long: Vec<&str> = about
        .wells
        .iter()
        .filter(is_long)
        .map(String::as_str)
        .collect();
    if !long.is_empty() && contents.dynamics().next().is_some() {
        let names = long.join(", ");
        output.note(format!(
            "wells whose names have more than {LONGEST_NAME} bytes are not written: {names}"
        ));
    }
}

fn is_written(well: &case::Well) -> bool {
    well.kind != WellKind::Path && well.name.len() <= LONGEST_NAME
}

fn well(well: &case::Well) -> Well {
    let kind = match well.kind {
        WellKind::Producer => Kind::Producer,
        WellKind::OilInjector => Kind::OilInjector,
        WellKind::WaterInjector => Kind::WaterInjector,
        WellKind::GasInjector => Kind::GasInjector,
        WellKind::Unknown | WellKind::Path => Kind::Undefined,
    };
    let connections = well.connections.iter().filter(|c| c.grid.is_none());
    let cells = connections.map(|c| {
        let direction = match c.axis {
            ConnectionAxis::I => Direction::X,
            ConnectionAxis::J => Direction::Y,
            ConnectionAxis::K => Direction::Z,
        };
        (c.cell, c.is_open, direction)
    });
    let status = match well.is_open {
        true => Status::Open,
        false => Status::Shut,
    };
    Well {
        status,
        ..open_to(&well.name, kind, cells)
    }
}
