//! From the wells of restart files to those of a case.

use strataray_parsers::wells::{self, Completion, Direction, Kind, Status};
use strataray_parsers::{ParseError, restart};

use crate::case::{Connection, ConnectionAxis, Well, WellKind};
use crate::model::Ijk;

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
