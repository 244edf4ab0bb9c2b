//! What a deck does to arrays of cells, in its order: gives them, sets and changes them in boxes and regions.

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use super::formula::Formula;
use super::header::{name, positive, real, whole};
use super::lexer::{Cursor, Item, Keyword, Mistake};
use super::scan::{Block, Scan, Section};
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

/// What happens to the values of cells.
pub(super) enum Change {
    Equals(f64),
    Add(f64),
    Multiply(f64),
    AtLeast(f64),
    AtMost(f64),
    CopyOf(String),
    /// A formula of OPERATE over the values of another array.
    Operate(Formula, String),
}

impl Change {
    /// The array that is read, if not the one that is changed alone.
    pub(super) fn source(&self) -> Option<&str> {
        match self {
            Self::CopyOf(source) | Self::Operate(_, source) => Some(source),
            _ => None,
        }
    }

    /// True where the new values do not follow from those before.
    pub(super) fn is_absolute(&self) -> bool {
        match self {
            Self::Equals(_) | Self::CopyOf(_) => true,
            Self::Operate(formula, _) => !formula.needs_target(),
            _ => false,
        }
    }

    /// The new value of a cell; `source` is that of the array that is read.
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
            Self::Operate(formula, _) => formula.value(value, source),
        }
    }
}

/// The cells that a record is for.
pub(super) enum Cells {
    Box(CellBox),
    /// Those that have a number in an array of regions; `None` is the array that is meant where none is named.
    Region(Option<String>, i32),
}

/// A record of an operation.
pub(super) struct Operation {
    pub(super) place: Place,
    pub(super) section: Option<Section>,
    pub(super) target: String,
    pub(super) change: Change,
    pub(super) cells: Cells,
}

/// One step in the making of the arrays.
pub(super) enum Edit {
    /// An array as numbers, for all cells or those of a box.
    Given(Block, CellBox),
    /// A record that sets or changes an array.
    Changed(Operation),
    /// A record that is not evaluated.
    NotApplied {
        place: Place,
        target: String,
        /// The end of the sentence that says so.
        why: &'static str,
    },
}

impl Edit {
    pub(super) fn place(&self) -> Place {
        match self {
            Self::Given(block, _) => block.place(),
            Self::Changed(operation) => operation.place.clone(),
            Self::NotApplied { place, .. } => place.clone(),
        }
    }
}

impl Edit {
    /// The array that it gives or changes.
    pub(super) fn target(&self) -> &str {
        match self {
            Self::Given(block, _) => &block.name,
            Self::Changed(operation) => &operation.target,
            Self::NotApplied { target, .. } => target,
        }
    }
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
            let edit = edit(place, self.section, &items, &mut cells).map_err(placed)?;
            if let Some(edits) = self.edits() {
                edits.extend(edit);
            }
        }
        Ok(())
    }
}

/// The edit of a record. A box that it names holds for the records behind it too.
fn edit(
    place: Place,
    section: Option<Section>,
    items: &[Item],
    cells: &mut CellBox,
) -> Result<Option<Edit>, Mistake> {
    let keyword = place.keyword.as_str();
    let target = usize::from(matches!(keyword, "COPY" | "COPYREG"));
    let Some(target) = name(items, target) else {
        return Ok(None);
    };
    let why = match (change(keyword, items)?, of_cells(keyword, items, cells)?) {
        (Some(change), Some(cells)) => {
            return Ok(Some(Edit::Changed(Operation {
                place,
                section,
                target,
                change,
                cells,
            })));
        }
        (_, None) => ": its record names no region, or an array of regions that is not known",
        (None, _) if keyword.starts_with("OPERATE") => ": its formula is not known",
        (None, _) if keyword == "COPYBOX" => ": this keyword is not evaluated",
        (None, _) => ": its record is incomplete",
    };
    Ok(Some(Edit::NotApplied { place, target, why }))
}

/// What a record does; `None` where that is not known.
fn change(keyword: &str, items: &[Item]) -> Result<Option<Change>, Mistake> {
    let value = || items.get(1).map(real).transpose();
    Ok(match keyword {
        "COPY" | "COPYREG" => name(items, 0).map(Change::CopyOf),
        "EQUALS" | "EQUALREG" => value()?.map(Change::Equals),
        "ADD" | "ADDREG" => value()?.map(Change::Add),
        "MULTIPLY" | "MULTIREG" => value()?.map(Change::Multiply),
        "MINVALUE" => value()?.map(Change::AtLeast),
        "MAXVALUE" => value()?.map(Change::AtMost),
        "OPERATE" => operate(items.get(7..).unwrap_or_default())?,
        "OPERATER" => operate(items.get(2..).unwrap_or_default())?,
        _ => None,
    })
}

/// A formula, the array that it reads, and up to two parameters.
fn operate(items: &[Item]) -> Result<Option<Change>, Mistake> {
    let parameter = |index: usize| {
        let given = items.get(index).filter(|item| item.text.is_some());
        given.map_or(Ok(0.0), real)
    };
    let parameters = [parameter(2)?, parameter(3)?];
    let formula = name(items, 0).and_then(|name| Formula::of(&name, parameters));
    let read = name(items, 1);
    Ok(formula
        .zip(read)
        .map(|(formula, read)| Change::Operate(formula, read)))
}

/// The cells of a record; `None` where they cannot be told.
fn of_cells(
    keyword: &str,
    items: &[Item],
    current: &mut CellBox,
) -> Result<Option<Cells>, Mistake> {
    let (number, letter) = match keyword {
        "EQUALREG" | "ADDREG" | "MULTIREG" | "COPYREG" => (2, 3),
        "OPERATER" => (1, 6),
        _ => {
            let first = if keyword == "OPERATE" { 1 } else { 2 };
            let ends = items.get(first..).unwrap_or_default();
            if let Some(named) = CellBox::read(&ends[..ends.len().min(6)])? {
                *current = named;
            }
            return Ok(Some(Cells::Box(*current)));
        }
    };
    let Some(number) = items.get(number).map(whole).transpose()? else {
        return Ok(None);
    };
    let array = match name(items, letter).as_deref() {
        None if keyword == "OPERATER" => Some("OPERNUM".to_owned()),
        None => None,
        Some("F") => Some("FLUXNUM".to_owned()),
        Some("M") => Some("MULTNUM".to_owned()),
        Some("O") => Some("OPERNUM".to_owned()),
        // OPERATER may name an array of regions.
        Some(named) if named.len() > 1 => Some(named.to_owned()),
        Some(_) => return Ok(None),
    };
    Ok(Some(Cells::Region(array, number)))
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
