//! The arrays of a deck, made by playing its edits in their order.

use std::collections::HashSet;

use super::edit::{CellBox, Cells, Change, Edit, LeftOut, Operation, Place, cells_of};
use super::scan::{Block, Found, Section, product_text};
use super::{DeckProperty, assemble};
use crate::arrays::{default_value, is_cell_array, is_multiplier, is_table};
use crate::egrid::PorosityModel;
use crate::error::{ErrorKind, ParseError, Warnings};

/// A one-record keyword with more values than this and half a value per cell is taken for a property gone wrong.
const PROPERTY_LIKE: usize = 1000;

/// Most values of all arrays together that a deck may have whatever its length (4 GiB), so that a short text cannot ask for
/// all memory; longer ones may have one for each byte.
pub(super) const MOST_VALUES: usize = 1 << 29;

/// An array in the making.
pub(super) struct CellArray {
    pub(super) name: String,
    /// True of a factor that the EDIT section has on what the GRID section has under that name. Of PORV it is the one on
    /// volumes that are not given but follow from the geometry.
    is_edit_factor: bool,
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
    /// True where the lower half of the layers are the fractures.
    is_dual: bool,
    /// True where fractures have what their matrix has unless they are given their own (DPGRID).
    is_shared: bool,
    arrays: Vec<CellArray>,
    left_out: LeftOut,
    /// Of a local grid, the arrays that it does not have from its hosts.
    lost: Vec<String>,
    /// The array of regions that is meant where a record names none, and the one where that is not given.
    regions: [&'static str; 2],
}

/// Region arrays, where GRIDOPTS asks for regions of MULTNUM and where it does not.
const MULTIPLIER_REGIONS: [&str; 2] = ["MULTNUM", "FLUXNUM"];
const FLUX_REGIONS: [&str; 2] = ["FLUXNUM", "MULTNUM"];

impl CellArrays {
    /// The arrays of a deck whose main grid has `dims` cells, but for [what is joined](Self::join_factors).
    pub(super) fn of_main(
        found: &mut Found,
        dims: [usize; 3],
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let mut all = Self {
            dims,
            is_dual: found.porosity_model != PorosityModel::Single,
            is_shared: found.shares_matrix,
            arrays: Vec::new(),
            left_out: LeftOut::default(),
            lost: Vec::new(),
            regions: match found.has_multiplier_regions {
                true => MULTIPLIER_REGIONS,
                false => FLUX_REGIONS,
            },
        };
        if let Some((place, actnum)) = found.file_actnum.take() {
            let active = all.find_or_begin("ACTNUM", false, &place);
            active.values = actnum.into_iter().map(f64::from).collect();
        }
        check_values(found, dims)?;
        all.play(std::mem::take(&mut found.edits), warnings)?;
        Ok(all)
    }

    /// Plays edits in their order.
    pub(super) fn play(
        &mut self,
        edits: Vec<Edit>,
        warnings: &mut Warnings,
    ) -> Result<(), ParseError> {
        for edit in edits {
            match edit {
                Edit::Given(block, cells) => self.give(&block, cells, warnings)?,
                Edit::Changed(operation) => {
                    if let Err(why) = self.change(&operation, warnings) {
                        self.leave_out(&operation.place, &operation.target, why);
                    }
                }
                Edit::NotApplied { place, target, why } => self.leave_out(&place, &target, why),
            }
        }
        std::mem::take(&mut self.left_out).report(warnings);
        Ok(())
    }

    /// The arrays that a local grid of `dims` cells begins with: those of the host of each cell. `size` says how much of
    /// its host a cell is along an axis.
    pub(super) fn of_hosts(
        &self,
        dims: [usize; 3],
        hosts: &[usize],
        size: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let mut arrays = Vec::new();
        let mut lost = Vec::new();
        for array in &self.arrays {
            let of_host = |factor: &dyn Fn(usize) -> f64| -> Vec<f64> {
                let cells = hosts.iter().enumerate();
                let values = cells.map(|(cell, host)| factor(cell) * array.values[*host]);
                values.collect()
            };
            let values = match inheritance(&array.name, array.is_edit_factor) {
                Inheritance::Same => of_host(&|_| 1.0),
                Inheritance::Share(axis) => of_host(&|cell| size(cell, axis)),
                Inheritance::None => {
                    let start = array.start();
                    let is_start = |value: f64| value == start || value.is_nan() && start.is_nan();
                    // Where cells lie is told by the local grid itself.
                    let says = !is_size(&array.name)
                        && !hosts.iter().all(|host| is_start(array.values[*host]));
                    if says {
                        lost.push(array.name.clone());
                    }
                    continue;
                }
            };
            arrays.push(CellArray {
                name: array.name.clone(),
                is_edit_factor: array.is_edit_factor,
                values,
                doubts: array.doubts.clone(),
                place: array.place.clone(),
                is_given: false,
            });
        }
        Self {
            dims,
            is_dual: self.is_dual,
            is_shared: self.is_shared,
            arrays,
            left_out: LeftOut::default(),
            lost,
            regions: self.regions,
        }
    }

    /// The arrays that a local grid does not have from its hosts though they say something there.
    pub(super) fn take_lost(&mut self) -> Vec<String> {
        std::mem::take(&mut self.lost)
    }

    pub(super) fn is_dual(&self) -> bool {
        self.is_dual
    }

    pub(super) fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// How many arrays there are.
    pub(super) fn count(&self) -> usize {
        self.arrays.len()
    }

    /// Multiplies what the EDIT section has as factors into what they are factors of.
    pub(super) fn join_factors(&mut self) {
        let all = std::mem::take(&mut self.arrays);
        let (factors, arrays) = all.into_iter().partition(|array| array.is_edit_factor);
        self.arrays = arrays;
        let factors: Vec<CellArray> = factors;
        let volumes = factors.iter().find(|factor| factor.name == "MULTPV");
        if let (Some(factor), Some(given)) = (volumes, self.find("PORV", false)) {
            given.multiply(factor);
        }
        for factor in factors {
            let name = match factor.name.as_str() {
                "PORV" => "MULTPV",
                name => name,
            };
            self.find_or_begin(name, false, &factor.place)
                .multiply(&factor);
        }
        self.arrays
            .retain(|array| array.name != "PORV" || array.values.iter().any(|v| !v.is_nan()));
    }

    fn cells(&self) -> usize {
        self.dims.iter().product()
    }

    fn place_of(&self, name: &str, is_edit_factor: bool) -> Option<usize> {
        let is_meant = |a: &CellArray| a.name == name && a.is_edit_factor == is_edit_factor;
        self.arrays.iter().position(is_meant)
    }

    fn find(&mut self, name: &str, is_edit_factor: bool) -> Option<&mut CellArray> {
        let at = self.place_of(name, is_edit_factor)?;
        self.arrays.get_mut(at)
    }

    /// The array called `name`, begun with what cells have where nothing is given.
    fn find_or_begin(&mut self, name: &str, is_edit_factor: bool, place: &Place) -> &mut CellArray {
        let at = self.place_of(name, is_edit_factor);
        let at = at.unwrap_or_else(|| {
            self.arrays.push(CellArray {
                name: name.to_owned(),
                is_edit_factor,
                values: vec![start(name, is_edit_factor); self.cells()],
                doubts: Vec::new(),
                place: place.clone(),
                is_given: false,
            });
            self.arrays.len() - 1
        });
        &mut self.arrays[at]
    }

    /// Goes on with the first `dims` cells: of dual porosity the matrix, whose values those of the fractures follow.
    /// These are left out of what has none of its own, and of what says where cells lie.
    pub(super) fn show(&mut self, dims: [usize; 3]) {
        self.dims = dims;
        let cells = self.cells();
        for array in self.arrays.iter_mut().filter(|a| a.values.len() > cells) {
            let (matrix, fractures) = array.values.split_at_mut(cells);
            let is_size = is_size(&array.name);
            if is_size || fractures.iter().all(|value| value.is_nan()) && !self.is_shared {
                array.values.truncate(cells);
            } else if self.is_shared {
                for (value, of_matrix) in fractures.iter_mut().zip(matrix) {
                    *value = if value.is_nan() { *of_matrix } else { *value };
                }
            }
        }
    }

    /// Takes an array out.
    pub(super) fn take(&mut self, name: &str) -> Option<CellArray> {
        let at = self.arrays.iter().position(|array| array.name == name)?;
        Some(self.arrays.remove(at))
    }

    /// Where an array was given.
    pub(super) fn place(&self, name: &str) -> Option<&Place> {
        let array = self.arrays.iter().find(|array| array.name == name)?;
        Some(&array.place)
    }

    /// The values of an array, one for each cell that is shown.
    pub(super) fn values(&self, name: &str) -> Option<&[f64]> {
        let array = self.arrays.iter().find(|array| array.name == name)?;
        array.values.get(..self.cells())
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
            "TOPS" if is_whole => {
                let half = if self.is_dual { count / 2 } else { count };
                vec![count, self.dims[0] * self.dims[1], half]
            }
            // The matrix alone.
            _ if is_whole && self.is_dual => vec![count, count / 2],
            _ => vec![count],
        };
        let Some(values) = values(block, &counts, warnings)? else {
            return Ok(());
        };
        let place = block.place();
        let dims = self.dims;
        let is_factor = is_edit_factor(&block.name, block.section);
        let array = self.find_or_begin(&block.name, is_factor, &place);
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

    /// Applies a record, or says why that is not done.
    fn change(
        &mut self,
        operation: &Operation,
        warnings: &mut Warnings,
    ) -> Result<(), &'static str> {
        let mut read = self.read(operation)?;
        let target = operation.target.as_str();
        let is_known = is_edit_factor(target, operation.section)
            || target == "PORV"
            || default_value(target).is_some()
            || self.place_of(target, false).is_some();
        if !operation.change.is_absolute() && !is_known {
            return Err(NOT_GIVEN);
        }
        let dims = self.dims;
        match &operation.cells {
            Cells::Box(cells) => {
                let ranges = cells.ranges(dims);
                let ranges = ranges.ok_or(": its box is outside the grid")?;
                read.is_whole = cells.is_whole(dims);
                self.set(operation, cells_of(ranges, dims), &read, warnings)
            }
            Cells::Region(array, number) => {
                let (cells, doubts) = self.region(array.as_deref(), *number)?;
                read.doubts.extend(doubts);
                self.set(operation, cells.into_iter(), &read, warnings)
            }
        }
    }

    /// The array that a record reads, which is empty where it reads none.
    fn read(&self, operation: &Operation) -> Result<Read, &'static str> {
        let Some(name) = operation.change.source() else {
            return Ok(Read::default());
        };
        let at = self.place_of(name, is_edit_factor(name, operation.section));
        let at = at.or_else(|| self.place_of(name, false));
        let array = at.and_then(|at| self.arrays.get(at));
        let array = array.ok_or(": the array that it reads is not in the deck")?;
        Ok(Read {
            values: array.values.clone(),
            doubts: array.doubts.clone(),
            is_whole: false,
        })
    }

    /// Changes the values of cells.
    fn set(
        &mut self,
        operation: &Operation,
        cells: impl Iterator<Item = usize>,
        read: &Read,
        warnings: &mut Warnings,
    ) -> Result<(), &'static str> {
        let Operation { place, change, .. } = operation;
        let target = operation.target.as_str();
        let is_factor = is_edit_factor(target, operation.section);
        let array = self.find_or_begin(target, is_factor, place);
        if read.is_whole && change.is_absolute() {
            array.doubts.clear();
        }
        for doubt in &read.doubts {
            array.add_doubt(doubt);
        }
        if target == "PORV" && !change.is_absolute() {
            return self.change_volumes(operation, cells, read);
        }
        let mut undefined = 0_usize;
        for cell in cells {
            let value = change.apply(array.values[cell], read.value(cell));
            undefined += usize::from(value.is_nan() && !read.value(cell).is_nan());
            array.values[cell] = value;
        }
        if undefined > 0 {
            let cells = if undefined == 1 { "cell" } else { "cells" };
            let message = format!("{target} becomes undefined in {undefined} {cells}");
            place.warn(warnings, message);
        }
        Ok(())
    }

    /// The cells of a region, and what is in doubt about the array that says which they are.
    fn region(
        &self,
        array: Option<&str>,
        number: i32,
    ) -> Result<(Vec<usize>, Vec<String>), &'static str> {
        let at = match array {
            Some(name) => self.place_of(name, false),
            None => self
                .regions
                .iter()
                .find_map(|name| self.place_of(name, false)),
        };
        let regions = at.and_then(|at| self.arrays.get(at));
        let regions = regions.ok_or(": the array of its regions is not in the deck")?;
        let is_in = |value: f64| value == f64::from(number);
        let cells = (0..self.cells()).filter(|cell| is_in(regions.values[*cell]));
        let cells: Vec<usize> = cells.collect();
        match cells.is_empty() {
            true => Err(EMPTY),
            false => Ok((cells, regions.doubts.clone())),
        }
    }

    /// Changes pore volumes by what they are: those that are given, and by a factor those that follow from the geometry.
    fn change_volumes(
        &mut self,
        operation: &Operation,
        cells: impl Iterator<Item = usize>,
        read: &Read,
    ) -> Result<(), &'static str> {
        let Operation { place, change, .. } = operation;
        let given = self.find_or_begin("PORV", false, place);
        let mut computed = Vec::new();
        for cell in cells {
            let value = &mut given.values[cell];
            if value.is_nan() {
                computed.push(cell);
            } else {
                *value = change.apply(*value, read.value(cell));
            }
        }
        let factor = match change {
            _ if computed.is_empty() => return Ok(()),
            Change::Multiply(factor) => *factor,
            _ => return Err(" where it follows from the geometry"),
        };
        let factors = self.find_or_begin("PORV", true, place);
        for cell in computed {
            factors.values[cell] *= factor;
        }
        Ok(())
    }

    /// Notes a record that is not applied, for a reason that ends the sentence.
    fn leave_out(&mut self, place: &Place, target: &str, why: &'static str) {
        self.left_out.add(place, target, why);
        if let Some(array) = self
            .find(target, false)
            .filter(|_| ![NOT_GIVEN, EMPTY].contains(&why))
        {
            array.add_doubt(&place.keyword);
        }
    }
}

/// What a record reads beside the values that it changes.
#[derive(Default)]
struct Read {
    values: Vec<f64>,
    doubts: Vec<String>,
    /// True where the record is for all cells.
    is_whole: bool,
}

impl Read {
    fn value(&self, cell: usize) -> f64 {
        self.values.get(cell).copied().unwrap_or(f64::NAN)
    }
}

/// Why a change of what is not there is not made.
const NOT_GIVEN: &str = ", which the deck does not give";

/// Why a change of no cells is not made.
const EMPTY: &str = ": no cell is in its region";

/// What cells have of an array where nothing is given.
fn start(name: &str, is_edit_factor: bool) -> f64 {
    match is_edit_factor {
        true => 1.0,
        false => default_value(name).unwrap_or(f64::NAN),
    }
}

/// What the cells of a local grid have from the cells that they divide.
enum Inheritance {
    Same,
    /// As much as they are of these along an axis.
    Share(usize),
    /// Nothing: amounts of whole cells, and what is between these.
    None,
}

fn inheritance(name: &str, is_edit_factor: bool) -> Inheritance {
    let sizes = [["DX", "DR"], ["DY", "DTHETA"], ["DZ", "DZNET"]];
    if let Some(axis) = sizes.iter().position(|names| names.contains(&name)) {
        return Inheritance::Share(axis);
    }
    let between = ["MULT", "TRAN", "DIFF", "HEATT"].iter().any(|start| {
        let direction = name.strip_prefix(start);
        direction.is_some_and(|d| ["X", "X-", "Y", "Y-", "Z", "Z-", "R", "THT"].contains(&d))
    });
    match name {
        "TOPS" => Inheritance::None,
        // As a factor it is one on volumes, which are in proportion.
        "PORV" if !is_edit_factor => Inheritance::None,
        _ if between => Inheritance::None,
        _ => Inheritance::Same,
    }
}

/// True of arrays that say how large cells are and where: fractures lie in their matrix.
pub(super) fn is_size(name: &str) -> bool {
    ["DX", "DY", "DZ", "DR", "DTHETA", "TOPS"].contains(&name)
}

/// True of an array of the EDIT section that is a factor on what the GRID section has under that name.
fn is_edit_factor(name: &str, section: Option<Section>) -> bool {
    section == Some(Section::Edit) && is_multiplier(name)
}

impl CellArray {
    fn start(&self) -> f64 {
        start(&self.name, self.is_edit_factor)
    }

    fn multiply(&mut self, factor: &Self) {
        for (value, factor) in self.values.iter_mut().zip(&factor.values) {
            *value *= factor;
        }
        for doubt in &factor.doubts {
            self.add_doubt(doubt);
        }
    }

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

/// Refuses more arrays than a text of this length may ask for, before any of them is made.
fn check_values(found: &Found, dims: [usize; 3]) -> Result<(), ParseError> {
    let most = MOST_VALUES.max(found.bytes) / dims.iter().product::<usize>();
    let mut names = HashSet::new();
    for edit in &found.edits {
        let name = match edit {
            Edit::Given(block, _) if may_be_cells(block) => block.name.as_str(),
            Edit::Changed(operation) => operation.target.as_str(),
            Edit::Given(..) | Edit::NotApplied { .. } => continue,
        };
        names.insert(name);
        if names.len() > most {
            let message = format!(
                "the deck has more than {most} arrays of {} cells: leave out those that are not needed",
                product_text(dims)
            );
            return Err(edit.place().error(ErrorKind::TooLarge, message));
        }
    }
    Ok(())
}

/// The values of a block that has one of `counts` of them; `None`, with a warning where it matters, for one that
/// has not.
fn values(
    block: &Block,
    counts: &[usize],
    warnings: &mut Warnings,
) -> Result<Option<Vec<f64>>, ParseError> {
    if block.name == "ACTNUM" {
        return assemble::array(block, assemble::ACTIVITY, counts).map(Some);
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
        let at = block.source.at(block.end());
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
