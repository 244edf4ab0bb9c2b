//! What every writer of a grid checks first.

use std::io;

use rayon::prelude::*;

use crate::records::refused;

/// Refuses dimensions, array lengths and coordinates with which the file could not be read again.
pub(crate) fn check<T: Sync>(
    dims: [usize; 3],
    coord: &[T],
    zcorn: &[T],
    actnum: Option<&[i32]>,
    is_finite: impl Fn(&T) -> bool + Sync,
) -> io::Result<()> {
    let [ni, nj, nk] = dims;
    let cells = ni.checked_mul(nj).and_then(|n| n.checked_mul(nk));
    let Some(cells @ 1..=0x7fff_ffff) = cells else {
        let message = format!("{ni} x {nj} x {nk} cells are not possible");
        return Err(refused(message));
    };
    let lengths = [
        ("COORD", 6 * (ni + 1) * (nj + 1), coord.len()),
        ("ZCORN", 8 * cells, zcorn.len()),
        ("ACTNUM", cells, actnum.map_or(cells, <[i32]>::len)),
    ];
    if let Some((name, expected, found)) = lengths.iter().find(|l| l.1 != l.2) {
        let message = format!("{name}: expected {expected} values, found {found}");
        return Err(refused(message));
    }
    for (name, values) in [("COORD", coord), ("ZCORN", zcorn)] {
        if let Some(at) = values.par_iter().position_any(|v| !is_finite(v)) {
            let message = format!("{name}: value {} is not a finite number", at + 1);
            return Err(refused(message));
        }
    }
    Ok(())
}
