//! What a deck does to arrays of cells, in its order: gives them, sets and changes them in boxes.

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use super::header::{name, positive, real};
use super::lexer::{Cursor, Item, Keyword, Mistake};
use super::scan::{Block, Scan};
use super::skip::ends_records;
use super::source::Source;
use crate::error::{ErrorKind, ParseError, Warnings};

/// A box of cells, counted from 1, both ends in it; `None` runs over the whole grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct CellBox([Option<[usize; 2]>; 3]);

impl CellBox {
    /// From up to six items; `None` where all of them are left to their defaults.
    pub(super) fn read(items: &[Item]) -> Result<Option<Self>, Mistake> {
        if items.iter().take(6).all(|item| item.text.is_none()) {
            return Ok(None);
        }
        let mut ranges = [None; 3];
        for (range, pair) in ranges.iter_mut().zip(items.chunks(2)) {
            let end = |n: usize| pair.get(n).filter(|item| item.text.is_some());
            let end = |n: usize| end(n).map(positive).transpose();
            *range = match [end(0)?, end(1)?] {
                [None, None] => None,
                [first, last] => Some([first.unwrap_or(1), last.unwrap_or(usize::MAX)]),
            };
        }
        Ok(Some(Self(ranges)))
    }

    /// Zero-based ranges in a grid; `None` where the box is empty or reaches out of it.
    pub(super) fn ranges(self, dims: [usize; 3]) -> Option<[Range<usize>; 3]> {
        let mut ranges = dims.map(|n| 0..n);
        for ((range, given), size) in ranges.iter_mut().zip(self.0).zip(dims) {
            if let Some([first, last]) = given {
                let last = if last == usize::MAX { size } else { last };
                *range = first - 1..last;
                if first > last || last > size {
                    return None;
                }
            }
        }
        Some(ranges)
    }

    pub(super) fn is_whole(self, dims: [usize; 3]) -> bool {
        self.ranges(dims) == Some(dims.map(|n| 0..n))
    }
}

/// Positions in natural order of the cells of a box, i fastest.
pub(super) fn cells_of(
    [i, j, k]: [Range<usize>; 3],
    [ni, nj, _]: [usize; 3],
) -> impl Iterator<Item = usize> {
    k.flat_map(move |k| {
        let i = i.clone();
        j.clone().flat_map(move |j| {
            let row = ni * (j + nj * k);
            row + i.start..row + i.end
        })
    })
}

/// Where in a deck something is done.
#[derive(Clone)]
pub(super) struct Place {
    pub(super) source: Rc<Source>,
    pub(super) at: usize,
    pub(super) keyword: String,
}

impl Place {
    pub(super) fn error(&self, kind: ErrorKind, message: impl Into<String>) -> ParseError {
        self.source.error(kind, self.at, &self.keyword, message)
    }

    pub(super) fn warn(&self, warnings: &mut Warnings, message: impl Into<String>) {
        warnings.push(self.source.path(), self.source.at(self.at), message);
    }
}

/// What happens to the values of a box.
pub(super) enum Change {
    Equals(f64),
    Add(f64),
    Multiply(f64),
    AtLeast(f64),
    AtMost(f64),
    CopyOf(String),
}

impl Change {
    /// The new value of a cell; `source` is that of the array that is copied.
    pub(super) fn apply(&self, value: f64, source: f64) -> f64 {
        match self {
            Self::Equals(new) => *new,
            Self::Add(term) => value + term,
            Self::Multiply(factor) => value * factor,
            // An undefined value stays undefined.
            Self::AtLeast(least) if value < *least => *least,
            Self::AtMost(most) if value > *most => *most,
            Self::AtLeast(_) | Self::AtMost(_) => value,
            Self::CopyOf(_) => source,
        }
    }
}

/// One step in the making of the arrays.
pub(super) enum Edit {
    /// An array as numbers, for all cells or those of a box.
    Given(Block, CellBox),
    /// A record of EQUALS, ADD, MULTIPLY, MINVALUE, MAXVALUE or COPY.
    Changed {
        place: Place,
        target: String,
        change: Change,
        cells: CellBox,
    },
    /// A record of a keyword that is not evaluated.
    NotApplied { place: Place, target: String },
}

impl Scan<'_> {
    /// The records of an operation up to the empty one.
    pub(super) fn operation(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let placed = |mistake| source.mistake(&keyword.name, mistake);
        let mut cells = self.input_box;
        while cursor.skip_blank() && !ends_records(cursor) {
            let at = cursor.at;
            let items = cursor.record().map_err(placed)?;
            if items.is_empty() {
                break;
            }
            let place = Place {
                source: Rc::clone(source),
                at,
                keyword: keyword.name.clone(),
            };
            let edit = edit(place, &items, &mut cells).map_err(placed)?;
            if !self.in_refinement() {
                self.found.edits.extend(edit);
            }
        }
        Ok(())
    }
}

/// The edit of a record. A box that it names holds for the records behind it too.
fn edit(place: Place, items: &[Item], cells: &mut CellBox) -> Result<Option<Edit>, Mistake> {
    let keyword = place.keyword.as_str();
    let target = usize::from(matches!(keyword, "COPY" | "COPYREG"));
    let Some(target) = name(items, target) else {
        return Ok(None);
    };
    let value = || items.get(1).map(real).transpose();
    let change = match keyword {
        "COPY" => name(items, 0).map(Change::CopyOf),
        "EQUALS" => value()?.map(Change::Equals),
        "ADD" => value()?.map(Change::Add),
        "MULTIPLY" => value()?.map(Change::Multiply),
        "MINVALUE" => value()?.map(Change::AtLeast),
        "MAXVALUE" => value()?.map(Change::AtMost),
        _ => None,
    };
    let Some(change) = change else {
        return Ok(Some(Edit::NotApplied { place, target }));
    };
    if let Some(named) = CellBox::read(items.get(2..).unwrap_or_default())? {
        *cells = named;
    }
    let cells = *cells;
    Ok(Some(Edit::Changed {
        place,
        target,
        change,
        cells,
    }))
}

/// What was left out, gathered so that each keyword is told of once, at its first place.
#[derive(Default)]
pub(super) struct LeftOut(BTreeMap<(String, &'static str), (Place, Vec<String>)>);

impl LeftOut {
    /// Notes that the keyword at `place` was not applied to `target`, for a reason that ends the sentence.
    pub(super) fn add(&mut self, place: &Place, target: &str, why: &'static str) {
        let key = (place.keyword.clone(), why);
        let (_, targets) = self
            .0
            .entry(key)
            .or_insert_with(|| (place.clone(), Vec::new()));
        if !targets.iter().any(|known| known == target) {
            targets.push(target.to_owned());
        }
    }

    pub(super) fn report(self, warnings: &mut Warnings) {
        for ((keyword, why), (place, targets)) in self.0 {
            let more = targets.len().saturating_sub(MOST_NAMED);
            let mut named = targets[..targets.len() - more].join(", ");
            if more > 0 {
                named = format!("{named} and {more} more arrays");
            }
            place.warn(
                warnings,
                format!("{keyword} was not applied to {named}{why}"),
            );
        }
    }
}

/// Arrays that a warning names.
const MOST_NAMED: usize = 20;
