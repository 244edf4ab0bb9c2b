//! Non-neighbor connections: within a grid, from a local grid to the global one, between local grids.

use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::records::{Entry, RecordFile};

/// Connections between the cells of two grids, or of one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridConnections {
    /// Numbers of the two grids: 0 the global one, else [`super::LocalGrid::number`].
    pub grids: [i32; 2],
    /// Pairs of cell numbers in the first and the second grid, from 1.
    pub cells: Vec<[i32; 2]>,
}

/// The connections of the global grid, and all others in the order of the file.
///
/// NNCHEAD names a grid (item 2) for NNC1 and NNC2, within it, and for NNCL and NNCG, from it to the global grid;
/// NNCHEADA names two (items 1 and 2) for NNA1 and NNA2. `sizes` are the numbers of the grids and of their cells.
pub(super) fn read(
    file: &RecordFile,
    sizes: &[(i32, usize)],
    warnings: &mut Warnings,
) -> Result<(Vec<[i32; 2]>, Vec<GridConnections>), ParseError> {
    let mut grid = 0;
    let mut pair = [0; 2];
    let mut first: Option<(&Entry, Vec<i32>)> = None;
    let mut lists: Vec<GridConnections> = Vec::new();
    for entry in file.entries() {
        let grids = match entry.name() {
            "NNCHEAD" => {
                grid = file.i32s(entry)?.get(1).copied().unwrap_or(0);
                continue;
            }
            "NNCHEADA" => {
                let head = file.i32s(entry)?;
                pair = [0, 1].map(|n| head.get(n).copied().unwrap_or(0));
                continue;
            }
            "NNC1" | "NNCL" | "NNA1" => {
                first = Some((entry, file.i32s(entry)?));
                continue;
            }
            "NNC2" => [grid; 2],
            "NNCG" => [grid, 0],
            "NNA2" => pair,
            _ => continue,
        };
        let Some((named, from)) = first.take() else {
            continue;
        };
        let to = file.i32s(entry)?;
        if to.len() != from.len() {
            let (expected, found) = (from.len(), to.len());
            let named = named.name();
            let message = format!("expected {expected} values as in {named}, found {found}");
            return Err(file.error(ErrorKind::WrongCount, entry, message));
        }
        let cells = from.into_iter().zip(to).map(|(a, b)| [a, b]).collect();
        lists.push(GridConnections { grids, cells });
    }
    leave_unknown(file, sizes, &mut lists, warnings);
    let mut nnc = Vec::new();
    lists.retain_mut(|list| {
        let is_global = list.grids == [0, 0];
        if is_global {
            nnc.append(&mut list.cells);
        }
        !is_global && !list.cells.is_empty()
    });
    Ok((nnc, lists))
}

/// Leaves out connections of cells that are in no grid.
fn leave_unknown(
    file: &RecordFile,
    sizes: &[(i32, usize)],
    lists: &mut [GridConnections],
    warnings: &mut Warnings,
) {
    let (mut all, mut left) = (0, 0);
    for list in lists {
        let cells = list.grids.map(|grid| {
            let size = sizes.iter().find(|(number, _)| *number == grid);
            size.map_or(0, |(_, cells)| *cells)
        });
        let known = |n: usize, cell: i32| {
            let cell = usize::try_from(cell).unwrap_or(0);
            (1..=cells[n]).contains(&cell)
        };
        let before = list.cells.len();
        list.cells.retain(|[a, b]| known(0, *a) && known(1, *b));
        all += before;
        left += before - list.cells.len();
    }
    if left > 0 {
        let message = format!(
            "{left} of {all} connections name cells outside the grid, or of a grid that is not there: left out"
        );
        warnings.push(file.path(), At::File, message);
    }
}
