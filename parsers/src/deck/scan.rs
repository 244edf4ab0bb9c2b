//! The first step: walks through all files, reads the short keywords and notes where the arrays lie.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::edit::{CellBox, Edit, Place};
use super::files::DeckFiles;
use super::lexer::{Cursor, Item, Keyword, Mistake, line_end, record_end};
use super::refine::{Refinement, Target};
use super::skip::{Skipped, ends_records, is_operation, skip_records};
use super::source::Source;
use super::walk::{Flow, Visitor, Walk};
use super::{FaultFaces, GridUnit, faults, header};
use crate::bytes::FileBytes;
use crate::egrid::PorosityModel;
use crate::error::{ErrorKind, ParseError, Warnings};
use crate::records::{Entry, RecordFile};
use crate::units::UnitSystem;

/// An array that is not yet numbers.
pub(super) struct Block {
    pub(super) source: Rc<Source>,
    pub(super) name: String,
    /// Offset of the keyword.
    pub(super) at: usize,
    pub(super) data: Data,
    /// The section it stands in; `None` in a file without sections.
    pub(super) section: Option<Section>,
}

/// Where the values of an array are.
pub(super) enum Data {
    /// In the text, from behind the keyword to the closing `/`.
    Text(Range<usize>),
    /// In a file that the keyword names.
    Imported(Rc<RecordFile>, Entry),
}

impl Block {
    pub(super) fn place(&self) -> Place {
        Place {
            source: Rc::clone(&self.source),
            at: self.at,
            keyword: self.name.clone(),
        }
    }

    /// The offset that people are told of its length: that of the closing `/`, or of the keyword that names the file.
    pub(super) fn end(&self) -> usize {
        match &self.data {
            Data::Text(range) => range.end,
            Data::Imported(..) => self.at,
        }
    }
}

/// The sections of a deck that describe the grid and its first state.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    Runspec,
    Grid,
    Edit,
    Props,
    Regions,
    Solution,
}

impl Section {
    fn from_keyword(name: &str) -> Option<Self> {
        Some(match name {
            "RUNSPEC" => Self::Runspec,
            "GRID" => Self::Grid,
            "EDIT" => Self::Edit,
            "PROPS" => Self::Props,
            "REGIONS" => Self::Regions,
            "SOLUTION" => Self::Solution,
            _ => return None,
        })
    }
}

/// A record of ADDZCORN: depth added to the corners of the cells of a box.
pub(super) struct DepthShift {
    pub(super) place: Place,
    pub(super) value: f64,
    pub(super) cells: CellBox,
}

/// What the scan has gathered.
#[derive(Default)]
pub(super) struct Found {
    pub(super) dims: Option<[usize; 3]>,
    /// True when `dims` is from SPECGRID, which overrides DIMENS.
    specgrid: bool,
    pub(super) coord: Option<Block>,
    pub(super) zcorn: Option<Block>,
    /// What is done to arrays of cells, in order.
    pub(super) edits: Vec<Edit>,
    /// Local grids, in order.
    pub(super) refinements: Vec<Refinement>,
    /// Sizes by column, row and layer (DXV, DYV, DZV, DRV, DTHETAV), and radii (INRAD, OUTRAD).
    pub(super) vectors: Vec<Block>,
    /// A binary file with the geometry, where GDFILE names one, or why it cannot be opened.
    pub(super) grid_file: Option<(Place, Result<FileBytes, ParseError>)>,
    /// ACTNUM of that file, and where it is named.
    pub(super) file_actnum: Option<(Place, Vec<i32>)>,
    pub(super) depth_shifts: Vec<DepthShift>,
    pub(super) faults: Vec<(Place, FaultFaces)>,
    /// MULTFLT: names with multipliers, in order.
    pub(super) fault_multipliers: Vec<(String, f64)>,
    pub(super) map_axes: Option<[f64; 6]>,
    pub(super) map_units: Option<String>,
    pub(super) grid_unit: Option<GridUnit>,
    pub(super) gdorient: Option<[String; 5]>,
    pub(super) unit_system: Option<UnitSystem>,
    /// Phases as INTEHEAD numbers them: 1 oil, 2 water, 4 gas, added.
    pub(super) phases: i32,
    pub(super) min_pore_volume: Option<f64>,
    /// True where GRIDOPTS has regions of MULTNUM.
    pub(super) has_multiplier_regions: bool,
    /// True where the grid is radial.
    pub(super) radial: bool,
    /// True where COORD has radii and angles (`T` of SPECGRID).
    pub(super) radial_corners: bool,
    pub(super) porosity_model: PorosityModel,
    /// DPGRID: fractures have what their matrix has unless they are given their own.
    pub(super) shares_matrix: bool,
    /// NODPPM: permeabilities of fractures are effective ones.
    pub(super) has_effective_fractures: bool,
    pub(super) files: Vec<PathBuf>,
    /// Bytes of all files, each time they are included.
    pub(super) bytes: usize,
}

impl Found {
    /// True where pillars and depths, a file with them, or sizes of cells were found.
    pub(super) fn describes_grid(&self) -> bool {
        let has_corners = self.coord.is_some() && self.zcorn.is_some();
        has_corners || self.grid_file.is_some() || self.sets("TOPS")
    }

    /// True where sizes of cells were found and no corners.
    pub(super) fn is_block_centered(&self) -> bool {
        let has_corners = self.coord.is_some() || self.zcorn.is_some();
        let sizes = ["DX", "DY", "DZ", "TOPS"];
        !has_corners && (!self.vectors.is_empty() || sizes.iter().any(|name| self.sets(name)))
    }

    fn sets(&self, name: &str) -> bool {
        self.edits.iter().any(|edit| match edit {
            Edit::Given(block, _) => block.name == name,
            Edit::Changed(operation) => operation.target == name,
            Edit::NotApplied { .. } => false,
        })
    }
}

pub(super) struct Scan<'a> {
    pub(super) warnings: &'a mut Warnings,
    pub(super) found: Found,
    pub(super) section: Option<Section>,
    /// The cells that arrays at hand belong to.
    pub(super) input_box: CellBox,
    /// Whose cells keywords are for.
    pub(super) target: Target,
}

/// Reads decks up to their arrays, one after the other as if they were one.
pub(super) fn scan(
    files: &dyn DeckFiles,
    paths: &[&Path],
    warnings: &mut Warnings,
) -> Result<Found, ParseError> {
    let mut found = Found::default();
    for path in paths {
        let mut scan = Scan {
            warnings,
            found,
            section: None,
            input_box: CellBox::default(),
            target: Target::Main,
        };
        Walk::through(files, path, &mut scan)?;
        found = scan.found;
    }
    Ok(found)
}

impl Visitor for Scan<'_> {
    fn begin(&mut self, source: &Source) {
        self.found.bytes = self.found.bytes.saturating_add(source.text().len());
        let path = source.path();
        if !self.found.files.iter().any(|file| file == path) {
            self.found.files.push(path.to_owned());
        }
    }

    fn stray(&mut self, source: &Source, at: usize) {
        let message =
            "text that belongs to no keyword is skipped, here and in any later lines like it";
        self.warn(source, at, message);
    }

    fn keyword(
        &mut self,
        walk: &mut Walk<'_>,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        let name = keyword.name.as_str();
        match name {
            "SUMMARY" | "SCHEDULE" | "OPTIMIZE" => return Ok(Flow::EndOfDeck),
            // PFLOTRAN names files to include like this.
            "INCLUDE" | "EXTERNAL_FILE" => return walk.include(self, source, cursor, keyword),
            "GDFILE" | "IMPORT" => return self.array_file(walk, source, cursor, keyword),
            "METRIC" => self.found.unit_system = Some(UnitSystem::Metric),
            "FIELD" => self.found.unit_system = Some(UnitSystem::Field),
            "LAB" => self.found.unit_system = Some(UnitSystem::Lab),
            "PVT-M" => self.found.unit_system = Some(UnitSystem::PvtM),
            "OIL" => self.phase(1),
            "WATER" => self.phase(2),
            "GAS" => self.phase(4),
            "ENDBOX" => self.input_box = CellBox::default(),
            "CARFIN" | "RADFIN" | "RADFIN4" | "REFINE" | "ENDFIN" => {
                self.refine(source, cursor, keyword)?;
            }
            "COORD" | "ZCORN" | "ACTNUM" => self.array(source, cursor, keyword)?,
            "FAULTS" | "MULTFLT" | "ADDZCORN" => self.lists(source, cursor, keyword)?,
            "SPECGRID" | "DIMENS" | "MAPAXES" | "MAPUNITS" | "GRIDUNIT" | "GDORIENT" | "BOX"
            | "MINPV" | "MINPORV" | "GRIDOPTS" => {
                let items = cursor
                    .record()
                    .map_err(|mistake| source.mistake(name, mistake))?;
                self.header(source, keyword, &items)?;
            }
            _ if is_operation(name) => self.operation(source, cursor, keyword)?,
            _ => self.other(source, cursor, keyword)?,
        }
        Ok(Flow::On)
    }
}

impl Scan<'_> {
    fn header(
        &mut self,
        source: &Source,
        keyword: &Keyword,
        items: &[Item],
    ) -> Result<(), ParseError> {
        let name = keyword.name.as_str();
        // A local grid has boxes of its own, and nothing else of what a head says.
        if self.target != Target::Main && name != "BOX" {
            return Ok(());
        }
        let placed = |mistake| source.mistake(name, mistake);
        match name {
            "BOX" => {
                let cells = CellBox::read(items).map_err(placed)?;
                self.input_box = cells.unwrap_or_default();
            }
            "MINPV" | "MINPORV" => {
                let least = items
                    .first()
                    .map(header::real)
                    .transpose()
                    .map_err(placed)?;
                self.found.min_pore_volume = least;
            }
            "GRIDOPTS" => {
                let regions = items.get(1).filter(|item| item.text.is_some());
                let regions = regions.map(header::whole).transpose().map_err(placed)?;
                self.found.has_multiplier_regions = regions.is_some_and(|count| count > 0);
            }
            "MAPAXES" => {
                self.found.map_axes = Some(header::map_axes(items, keyword.at).map_err(placed)?);
            }
            "MAPUNITS" => self.found.map_units = header::name(items, 0),
            "GRIDUNIT" => self.found.grid_unit = Some(header::grid_unit(items)),
            "GDORIENT" => self.found.gdorient = Some(header::gdorient(items)),
            _ => {
                let (dims, is_radial) = header::dims(items, keyword.at).map_err(placed)?;
                self.found.radial |= is_radial;
                self.found.radial_corners |= is_radial;
                self.dims(source, keyword, dims);
            }
        }
        Ok(())
    }

    fn dims(&mut self, source: &Source, keyword: &Keyword, dims: [usize; 3]) {
        let from_specgrid = keyword.name == "SPECGRID";
        // Some give the layers of the matrix alone.
        let [ni, nj, nk] = dims;
        if self.found.porosity_model != PorosityModel::Single
            && self.found.dims == Some([ni, nj, 2 * nk])
        {
            return;
        }
        if let Some(earlier) = self.found.dims.filter(|&earlier| earlier != dims) {
            let message = format!(
                "{} gives {} cells where the deck gave {} before; SPECGRID is followed",
                keyword.name,
                product_text(dims),
                product_text(earlier)
            );
            self.warn(source, keyword.at, &message);
        }
        if from_specgrid || !self.found.specgrid {
            self.found.dims = Some(dims);
            self.found.specgrid = from_specgrid;
        }
    }

    /// FAULTS, MULTFLT and ADDZCORN: records up to an empty one.
    fn lists(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let name = keyword.name.as_str();
        if self.target != Target::Main {
            let message = format!("{name} of local grids is not read");
            self.warn(source, keyword.at, &message);
            skip_records(cursor, name).map_err(|mistake| source.mistake(name, mistake))?;
            return Ok(());
        }
        let placed = |mistake| source.mistake(name, mistake);
        let place = |at| Place {
            source: Rc::clone(source),
            at,
            keyword: name.to_owned(),
        };
        match name {
            "FAULTS" => {
                let faults = faults::faults(cursor).map_err(placed)?.into_iter();
                let faults = faults.map(|(at, fault)| (place(at), fault));
                self.found.faults.extend(faults);
            }
            "MULTFLT" => {
                let multipliers = faults::multipliers(cursor).map_err(placed)?;
                self.found.fault_multipliers.extend(multipliers);
            }
            _ => {
                while cursor.skip_blank() && !ends_records(cursor) {
                    let at = cursor.at;
                    let items = cursor.record().map_err(placed)?;
                    if items.is_empty() {
                        break;
                    }
                    self.depth_shift(place(at), &items).map_err(placed)?;
                }
            }
        }
        Ok(())
    }

    fn depth_shift(&mut self, place: Place, items: &[Item]) -> Result<(), Mistake> {
        match header::depth_shift(items)? {
            Some((value, cells)) => self.found.depth_shifts.push(DepthShift {
                place,
                value,
                cells: cells.unwrap_or(self.input_box),
            }),
            None => place.warn(
                self.warnings,
                "ADDZCORN with more than a value and a box is not evaluated: depths are those of ZCORN",
            ),
        }
        Ok(())
    }

    fn phase(&mut self, bit: i32) {
        // The words mean phases in the first section alone.
        if self.section == Some(Section::Runspec) {
            self.found.phases |= bit;
        }
    }

    /// COORD, ZCORN, ACTNUM: notes where the array lies.
    fn array(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let name = keyword.name.as_str();
        let end = record_end(cursor.text, keyword.end).ok_or_else(|| {
            source.error(
                ErrorKind::Truncated,
                cursor.text.len(),
                name,
                "the file ends before the closing / of the array",
            )
        })?;
        cursor.at = line_end(cursor.text, end);
        let block = self.block(source, keyword, end);
        self.keep(block, self.input_box);
        Ok(())
    }

    /// Keeps an array for when the dimensions are known.
    pub(super) fn keep(&mut self, block: Block, cells: CellBox) {
        let (source, at, name) = (Rc::clone(&block.source), block.at, block.name.clone());
        let place = match name.as_str() {
            "COORD" if self.target == Target::Main => &mut self.found.coord,
            "ZCORN" if self.target == Target::Main => &mut self.found.zcorn,
            _ => {
                if let Some(edits) = self.edits() {
                    edits.push(Edit::Given(block, cells));
                }
                return;
            }
        };
        if place.replace(block).is_some() {
            let message = format!("{name} is given again; the last one is used");
            self.warn(&source, at, &message);
        }
    }

    /// A keyword that has no meaning here, or a property.
    fn other(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let name = keyword.name.as_str();
        match skip_records(cursor, name).map_err(|mistake| source.mistake(name, mistake))? {
            Skipped::Whole => {}
            Skipped::Unended(at) => {
                self.warn(source, at, &format!("the text behind {name} has no closing / up to the end of the file; it is skipped"));
            }
            Skipped::OneNumeric(end) => {
                let block = self.block(source, keyword, end);
                let is_main = self.target == Target::Main;
                match name {
                    "DXV" | "DYV" | "DZV" | "DRV" | "DTHETAV" | "INRAD" | "OUTRAD" if is_main => {
                        self.found.vectors.push(block);
                    }
                    _ if self.is_division(name) => self.division(block),
                    _ => self.keep(block, self.input_box),
                }
            }
        }
        if let Some(section) = Section::from_keyword(name) {
            self.section = Some(section);
            self.input_box = CellBox::default();
            self.target = Target::Main;
        }
        match name {
            "RADIAL" | "DR" | "DRV" | "DTHETA" | "DTHETAV" | "INRAD"
                if self.target == Target::Main =>
            {
                self.found.radial = true;
            }
            "DUALPORO" if self.section == Some(Section::Runspec) => {
                self.found.porosity_model = PorosityModel::Dual;
            }
            "DUALPERM" if self.section == Some(Section::Runspec) => {
                self.found.porosity_model = PorosityModel::DualPermeability;
            }
            "DPGRID" => self.found.shares_matrix = true,
            "NODPPM" => self.found.has_effective_fractures = true,
            "EQLZCORN" => self.warn(
                source,
                keyword.at,
                "EQLZCORN is not evaluated: depths are those of ZCORN",
            ),
            _ => {}
        }
        Ok(())
    }

    fn block(&self, source: &Rc<Source>, keyword: &Keyword, end: usize) -> Block {
        Block {
            source: Rc::clone(source),
            name: keyword.name.clone(),
            at: keyword.at,
            data: Data::Text(keyword.end..end),
            section: self.section,
        }
    }

    pub(super) fn warn(&mut self, source: &Source, at: usize, message: &str) {
        self.warnings.push(source.path(), source.at(at), message);
    }
}

/// `3 x 4 x 5`.
pub(super) fn product_text([ni, nj, nk]: [usize; 3]) -> String {
    format!("{ni} x {nj} x {nk}")
}
