//! What readers and writers of a grid check.

use std::io;

use crate::parallel;
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
        let message = format!("{ni} x {nj} x {nk} cells are not supported");
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
        if let Some(number) = first_not(values, &is_finite) {
            let message = format!("{name}: value {number} is not a finite number");
            return Err(refused(message));
        }
    }
    Ok(())
}

/// Values that a thread looks at before it takes the next ones.
const PIECE: usize = 1 << 14;

/// Number from 1 of the first value that is not as it should be.
pub(crate) fn first_not<T: Sync>(values: &[T], is: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    let pieces = values.chunks(PIECE).enumerate().collect();
    let found = parallel::map(pieces, |(piece, values)| {
        let at = values.iter().position(|v| !is(v))?;
        Some(piece * PIECE + at + 1)
    });
    found.into_iter().flatten().next()
}
