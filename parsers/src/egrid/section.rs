//! The arrays of one grid, global or local: head, pillars, depths, active cells.

use crate::error::{At, ErrorKind, ParseError};
use crate::geometry::{Lengths, MOST_CELLS, unaddressable};
use crate::records::{Entry, Kind, RecordFile};

/// The arrays of a file that belong to one grid.
#[derive(Clone, Copy)]
pub(super) struct Section<'a> {
    pub(super) file: &'a RecordFile,
    pub(super) entries: &'a [Entry],
}

/// What GRIDHEAD says.
pub(super) struct Head {
    pub(super) dims: [usize; 3],
    /// Number of the grid (item 5): 0 for the global one.
    pub(super) number: i32,
    /// Sectors around the axis (item 27) above 0.
    pub(super) is_radial: bool,
    /// First and last cell along i, j, k that a local grid refines, from 1 (items 28 to 33).
    pub(super) host_box: Option<[[i32; 3]; 2]>,
}

/// The shape of a grid.
pub(super) struct Geometry {
    /// Values of COORD for one coordinate system; `coord` may hold several.
    pub(super) pillars: usize,
    pub(super) coord: Vec<f32>,
    pub(super) zcorn: Vec<f32>,
    pub(super) actnum: Option<Vec<i32>>,
}

impl<'a> Section<'a> {
    pub(super) fn find(&self, name: &str) -> Option<&'a Entry> {
        self.entries.iter().find(|e| e.name() == name)
    }

    pub(super) fn need(&self, name: &str) -> Result<&'a Entry, ParseError> {
        self.find(name).ok_or_else(|| {
            let message = "is missing; a grid needs GRIDHEAD, COORD and ZCORN";
            let kind = ErrorKind::MissingKeyword;
            ParseError::of(kind, self.file.path(), At::File, name, message)
        })
    }

    /// The first string of an array, if it is there.
    pub(super) fn string(&self, name: &str) -> Result<Option<String>, ParseError> {
        let strings = self.find(name).map(|e| self.file.strings(e)).transpose()?;
        Ok(strings.and_then(|s| s.into_iter().next()))
    }

    /// GRIDHEAD, or the SPECGRID that binary GRDECL has in its place.
    pub(super) fn head_entry(&self) -> Result<&'a Entry, ParseError> {
        let spec = self.find("SPECGRID").filter(|e| e.kind == Kind::Inte);
        match (self.find("GRIDHEAD"), spec) {
            (None, Some(spec)) => Ok(spec),
            _ => self.need("GRIDHEAD"),
        }
    }

    pub(super) fn head(&self) -> Result<Head, ParseError> {
        let (file, head) = (self.file, self.head_entry()?);
        let values = file.i32s(head)?;
        if head.name() == "SPECGRID" {
            // Cells along i, j, k, coordinate systems, and 1 where these are radial.
            let item = |n: usize| values.get(n).copied().unwrap_or(0);
            return Ok(Head {
                dims: dimensions(file, head, [item(0), item(1), item(2)])?,
                number: 0,
                is_radial: item(4) > 0,
                host_box: None,
            });
        }
        let [kind, ni, nj, nk, ..] = values[..] else {
            return Err(file.error(
                ErrorKind::WrongCount,
                head,
                format!("has {} values and needs at least 4", values.len()),
            ));
        };
        if kind != 1 {
            return Err(file.error(
                ErrorKind::Unsupported,
                head,
                format!("the grid is of type {kind}; only corner-point grids (type 1) are read"),
            ));
        }
        let item = |n: usize| values.get(n - 1).copied().unwrap_or(0);
        let host_box = [28, 31].map(|n| [item(n), item(n + 1), item(n + 2)]);
        Ok(Head {
            dims: dimensions(file, head, [ni, nj, nk])?,
            number: item(5),
            is_radial: item(27) > 0,
            host_box: (host_box[0][0] > 0).then_some(host_box),
        })
    }

    /// COORD, ZCORN and ACTNUM.
    pub(super) fn geometry(&self, dims: [usize; 3]) -> Result<Geometry, ParseError> {
        let Some(lengths) = Lengths::of(dims) else {
            let head = self.head_entry()?;
            let message = unaddressable(dims);
            return Err(self.file.error(ErrorKind::TooLarge, head, message));
        };
        Ok(Geometry {
            pillars: lengths.coord,
            coord: sized(self.file, self.need("COORD")?, lengths.coord, true)?,
            zcorn: sized(self.file, self.need("ZCORN")?, lengths.zcorn, false)?,
            actnum: self.of_cells("ACTNUM", lengths.cells)?,
        })
    }

    /// An array of one integer per cell, if it is there.
    pub(super) fn of_cells(
        &self,
        name: &str,
        cells: usize,
    ) -> Result<Option<Vec<i32>>, ParseError> {
        match self.find(name) {
            None => Ok(None),
            Some(entry) if entry.count == cells as u64 => self.file.i32s(entry).map(Some),
            Some(entry) => {
                let message = format!("expected {cells} values, found {}", entry.count);
                Err(self.file.error(ErrorKind::WrongCount, entry, message))
            }
        }
    }
}

/// Dimensions that a grid can have.
pub(super) fn dimensions(
    file: &RecordFile,
    head: &Entry,
    sizes: [i32; 3],
) -> Result<[usize; 3], ParseError> {
    let dims = sizes.map(|n| usize::try_from(n).unwrap_or(0));
    let cells = dims
        .iter()
        .try_fold(1usize, |product, &n| product.checked_mul(n));
    match cells {
        Some(1..=MOST_CELLS) => Ok(dims),
        _ => {
            let kind = match dims.contains(&0) {
                true => ErrorKind::BadValue,
                false => ErrorKind::TooLarge,
            };
            let [ni, nj, nk] = sizes;
            let message = format!("dimensions {ni} x {nj} x {nk} are not possible");
            Err(file.error(kind, head, message))
        }
    }
}

fn sized(
    file: &RecordFile,
    entry: &Entry,
    expected: usize,
    more_allowed: bool,
) -> Result<Vec<f32>, ParseError> {
    let (found, needed) = (entry.count, expected as u64);
    let fits = found == needed || more_allowed && found > needed && found.is_multiple_of(needed);
    if !fits {
        return Err(file.error(
            ErrorKind::WrongCount,
            entry,
            format!("expected {expected} values, found {found}"),
        ));
    }
    file.f32s(entry)
}
