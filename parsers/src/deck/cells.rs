//! The arrays of a deck, made by playing its edits in their order.

use super::edit::{CellBox, Change, Edit, LeftOut, Place, cells_of};
use super::scan::{Block, Found, Section};
use super::{DeckProperty, assemble};
use crate::arrays::{default_value, is_cell_array, is_table};
use crate::error::{ParseError, Warnings};

/// A one-record keyword with more values than this and half a value per cell is taken for a property gone wrong.
const PROPERTY_LIKE: usize = 1000;

/// An array in the making.
pub(super) struct CellArray {
    pub(super) name: String,
    /// One value per cell; NaN where none was given.
    pub(super) values: Vec<f64>,
    /// Keywords that should have changed it and were not applied.
    doubts: Vec<String>,
    /// Where it was given first, or last for all cells.
    pub(super) place: Place,
    /// True where it was given as numbers for all cells.
    is_given: bool,
}

/// All arrays of a deck.
pub(super) struct CellArrays {
    dims: [usize; 3],
    arrays: Vec<CellArray>,
    left_out: LeftOut,
}

impl CellArrays {
    /// Plays the edits of a deck whose grid has `dims` cells.
    pub(super) fn play(
        found: &mut Found,
        dims: [usize; 3],
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let mut all = Self {
            dims,
            arrays: Vec::new(),
            left_out: LeftOut::default(),
        };
        for edit in std::mem::take(&mut found.edits) {
            match edit {
                Edit::Given(block, cells) => all.give(&block, cells, warnings)?,
                Edit::Changed {
                    place,
                    target,
                    change,
                    cells,
                } => all.change(&place, &target, &change, cells),
                Edit::NotApplied { place, target } => all.doubt(&place, &target),
            }
        }
        std::mem::take(&mut all.left_out).report(warnings);
        Ok(all)
    }

    fn cells(&self) -> usize {
        self.dims.iter().product()
    }

    fn find(&mut self, name: &str) -> Option<&mut CellArray> {
        self.arrays.iter_mut().find(|array| array.name == name)
    }

    /// The array called `name`, begun with what cells have where nothing is given.
    fn find_or_begin(&mut self, name: &str, place: &Place) -> &mut CellArray {
        let at = self.arrays.iter().position(|array| array.name == name);
        let at = at.unwrap_or_else(|| {
            let start = default_value(name).unwrap_or(f64::NAN);
            self.arrays.push(CellArray {
                name: name.to_owned(),
                values: vec![start; self.cells()],
                doubts: Vec::new(),
                place: place.clone(),
                is_given: false,
            });
            self.arrays.len() - 1
        });
        &mut self.arrays[at]
    }

    /// Takes an array out.
    pub(super) fn take(&mut self, name: &str) -> Option<CellArray> {
        let at = self.arrays.iter().position(|array| array.name == name)?;
        Some(self.arrays.remove(at))
    }

    /// The values of an array.
    pub(super) fn values(&self, name: &str) -> Option<&[f64]> {
        let array = self.arrays.iter().find(|array| array.name == name)?;
        Some(&array.values)
    }

    /// All arrays as properties.
    pub(super) fn into_properties(self) -> Vec<DeckProperty> {
        let arrays = self.arrays.into_iter();
        arrays
            .map(|array| DeckProperty {
                doubt: array.doubt(),
                name: array.name,
                values: array.values,
            })
            .collect()
    }

    fn give(
        &mut self,
        block: &Block,
        cells: CellBox,
        warnings: &mut Warnings,
    ) -> Result<(), ParseError> {
        let is_whole = cells.is_whole(self.dims);
        let Some(ranges) = cells.ranges(self.dims) else {
            let message = format!(
                "{} stands in a BOX outside the grid; it is left out",
                block.name
            );
            warnings.push(block.source.path(), block.source.at(block.at), message);
            return Ok(());
        };
        let count = ranges.iter().map(ExactSizeIterator::len).product();
        let counts = match block.name.as_str() {
            // The tops of the first layer are enough.
            "TOPS" if is_whole => vec![count, self.dims[0] * self.dims[1]],
            _ => vec![count],
        };
        let Some(values) = values(block, &counts, warnings)? else {
            return Ok(());
        };
        let place = Place {
            source: block.source.clone(),
            at: block.at,
            keyword: block.name.clone(),
        };
        let dims = self.dims;
        let array = self.find_or_begin(&block.name, &place);
        if is_whole {
            if array.is_given {
                let message = format!("{} is given again; the last one is used", block.name);
                place.warn(warnings, message);
            }
            array.doubts.clear();
            array.is_given = true;
            array.place = place;
        }
        // A value left to its default leaves what was there.
        for (cell, value) in cells_of(ranges, dims).zip(values) {
            if !value.is_nan() {
                array.values[cell] = value;
            }
        }
        Ok(())
    }

    fn change(&mut self, place: &Place, target: &str, change: &Change, cells: CellBox) {
        let Some(ranges) = cells.ranges(self.dims) else {
            self.left_out
                .add(place, target, ": its box is outside the grid");
            return self.mark(place, target);
        };
        let (source, doubts) = match change {
            Change::CopyOf(name) => match self.find(name) {
                Some(source) => (source.values.clone(), source.doubts.clone()),
                None => {
                    self.left_out
                        .add(place, target, ": the array to copy is not in the deck");
                    return self.mark(place, target);
                }
            },
            Change::Equals(_) => (Vec::new(), Vec::new()),
            _ if self.find(target).is_none() && default_value(target).is_none() => {
                return self
                    .left_out
                    .add(place, target, ", which the deck does not give");
            }
            _ => (Vec::new(), Vec::new()),
        };
        let (dims, is_whole) = (self.dims, cells.is_whole(self.dims));
        let array = self.find_or_begin(target, place);
        if is_whole && matches!(change, Change::Equals(_) | Change::CopyOf(_)) {
            array.doubts.clear();
        }
        for doubt in doubts {
            array.add_doubt(&doubt);
        }
        for cell in cells_of(ranges, dims) {
            let copied = source.get(cell).copied().unwrap_or(f64::NAN);
            array.values[cell] = change.apply(array.values[cell], copied);
        }
    }

    /// Notes a record that is not evaluated.
    fn doubt(&mut self, place: &Place, target: &str) {
        self.left_out
            .add(place, target, ": this keyword is not evaluated");
        self.mark(place, target);
    }

    fn mark(&mut self, place: &Place, target: &str) {
        if let Some(array) = self.find(target) {
            array.add_doubt(&place.keyword);
        }
    }
}

impl CellArray {
    fn add_doubt(&mut self, keyword: &str) {
        if !self.doubts.iter().any(|known| known == keyword) {
            self.doubts.push(keyword.to_owned());
        }
    }

    fn doubt(&self) -> Option<String> {
        let keywords = match self.doubts.as_slice() {
            [] => return None,
            [one] => return Some(format!("{one} of the deck was not applied")),
            [more @ .., last] => format!("{} and {last}", more.join(", ")),
        };
        Some(format!("{keywords} of the deck were not applied"))
    }
}

/// The values of a block that has one of `counts` of them; `None`, with a warning where it matters, for one that
/// has not.
fn values(
    block: &Block,
    counts: &[usize],
    warnings: &mut Warnings,
) -> Result<Option<Vec<f64>>, ParseError> {
    if block.name == "ACTNUM" {
        return assemble::array(block, assemble::ACTIVITY, counts[0]).map(Some);
    }
    if !may_be_cells(block) {
        return Ok(None);
    }
    let known = is_cell_array(&block.name);
    let runs = match assemble::numbers(block, assemble::PROPERTY) {
        Ok(runs) => runs,
        Err(mistake) if known || assemble::is_swallowed_keyword(block, &mistake) => {
            return Err(assemble::error(block, mistake));
        }
        // Numbers and words in one record: no array.
        Err(_) => return Ok(None),
    };
    if counts.contains(&runs.count) {
        let count = runs.count;
        return assemble::expand(block, runs, count).map(Some);
    }
    let cells = counts[0];
    if known || (runs.count > PROPERTY_LIKE && runs.count >= cells / 2) {
        let message = format!(
            "{} has {} values for {cells} cells: it is left out",
            block.name, runs.count
        );
        let at = block.source.at(block.data.end);
        warnings.push(block.source.path(), at, message);
    }
    Ok(None)
}

/// True where a keyword can give one value per cell: any that is known to, and unknown ones where nothing but the grid
/// is described.
fn may_be_cells(block: &Block) -> bool {
    match block.section {
        None | Some(Section::Grid) => !is_table(&block.name),
        Some(Section::Runspec) => false,
        Some(_) => is_cell_array(&block.name),
    }
}
