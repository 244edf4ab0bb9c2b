//! What readers and writers of a grid check: its dimensions, the lengths of its arrays, their values.

use std::io;

use crate::parallel;
use crate::records::refused;

/// Most cells of a grid, so that cell numbers fit in 32 bits.
pub(crate) const MOST_CELLS: usize = 0x7fff_ffff;

/// Lengths of the arrays of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Lengths {
    /// `ni*nj*nk`.
    pub(crate) cells: usize,
    /// Six values per pillar.
    pub(crate) coord: usize,
    /// Eight depths per cell.
    pub(crate) zcorn: usize,
}

impl Lengths {
    /// The lengths for a grid of `dims` cells; `None` where it has none, more than [`MOST_CELLS`], or arrays that an
    /// address space of this machine cannot hold, as with 32 bits.
    pub(crate) fn of(dims: [usize; 3]) -> Option<Self> {
        Self::within(isize::MAX as usize, dims)
    }

    fn within(most_bytes: usize, [ni, nj, nk]: [usize; 3]) -> Option<Self> {
        let cells = ni.checked_mul(nj)?.checked_mul(nk)?;
        let pillars = (ni.checked_add(1)?).checked_mul(nj.checked_add(1)?)?;
        let coord = pillars.checked_mul(6)?;
        let zcorn = cells.checked_mul(8)?;
        let bytes = coord.max(zcorn).checked_mul(size_of::<f64>())?;
        let fits = (1..=MOST_CELLS).contains(&cells) && bytes <= most_bytes;
        fits.then_some(Self {
            cells,
            coord,
            zcorn,
        })
    }
}

/// The sentence about dimensions for which there are no [`Lengths`].
pub(crate) fn unaddressable([ni, nj, nk]: [usize; 3]) -> String {
    format!("no grid of {ni} x {nj} x {nk} cells can be addressed on this machine")
}

/// An array of zeros; `None` where there is not enough memory.
pub(crate) fn zeros<T: Clone + Default>(count: usize) -> Option<Vec<T>> {
    // A plain allocation would end the process where memory is short, so ask first.
    Vec::<T>::new().try_reserve_exact(count).ok()?;
    Some(vec![T::default(); count])
}

/// Refuses dimensions, array lengths and coordinates with which the file could not be read again.
pub(crate) fn check<T: Sync>(
    dims: [usize; 3],
    coord: &[T],
    zcorn: &[T],
    actnum: Option<&[i32]>,
    is_finite: impl Fn(&T) -> bool + Sync,
) -> io::Result<()> {
    let [ni, nj, nk] = dims;
    let Some(expected) = Lengths::of(dims) else {
        let message = format!("{ni} x {nj} x {nk} cells are not supported");
        return Err(refused(message));
    };
    let cells = expected.cells;
    let lengths = [
        ("COORD", expected.coord, coord.len()),
        ("ZCORN", expected.zcorn, zcorn.len()),
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
        // All at once first, which takes a fraction of the time of one after the other.
        let all = values.iter().fold(true, |all, v| all & is(v));
        let at = if all {
            None
        } else {
            values.iter().position(|v| !is(v))
        };
        Some(piece * PIECE + at? + 1)
    });
    found.into_iter().flatten().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_a_grid() {
        let lengths = Lengths::of([3, 2, 5]).map(|l| [l.cells, l.coord, l.zcorn]);
        assert_eq!(lengths, Some([30, 72, 240]));
        assert_eq!(Lengths::of([3, 0, 5]), None);
        assert_eq!(Lengths::of([usize::MAX, 1, 1]), None);
    }

    #[test]
    fn lengths_that_32_bits_cannot_address() {
        let within = |dims| Lengths::within(0x7fff_ffff, dims);
        // 2^25 cells have 2^28 depths, which take 2^31 bytes.
        assert_eq!(within([1 << 10, 1 << 10, 1 << 5]), None);
        assert!(within([1 << 10, 1 << 10, (1 << 5) - 1]).is_some());
        // Columns and no layers: pillars are more than depths.
        assert_eq!(within([22_369_621, 1, 1]), None);
        assert!(within([22_369_620, 1, 1]).is_some());
    }

    #[test]
    fn zeros_beyond_all_memory_are_refused() {
        assert_eq!(zeros::<f32>(3), Some(vec![0.0; 3]));
        assert_eq!(zeros::<f64>(usize::MAX / 8), None);
    }
}
