//! The first step: walks through all files, reads the short keywords and notes where the arrays lie.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::include::canonical;
use super::lexer::{Cursor, Item, Keyword, keyword, line_end, record_end};
use super::operations::Operation;
use super::skip::{Skipped, is_operation, skip_records};
use super::source::{Places, Source};
use super::{FaultFaces, GridUnit, faults, header};
use crate::error::{ParseError, Warnings};
use crate::units::UnitSystem;

/// An array that is still text.
pub(super) struct Block {
    pub(super) source: Rc<Source>,
    pub(super) name: String,
    /// Offset of the keyword.
    pub(super) at: usize,
    /// From behind the keyword to the closing `/`.
    pub(super) data: Range<usize>,
}

/// What the scan has gathered.
#[derive(Default)]
pub(super) struct Found {
    pub(super) dims: Option<[usize; 3]>,
    /// True when `dims` is from SPECGRID, which overrides DIMENS.
    specgrid: bool,
    pub(super) coord: Option<Block>,
    pub(super) zcorn: Option<Block>,
    pub(super) actnum: Option<Block>,
    /// One-record numeric keywords; those with one value a cell are properties.
    pub(super) candidates: Vec<Block>,
    pub(super) faults: Vec<(Rc<Source>, usize, FaultFaces)>,
    pub(super) map_axes: Option<[f64; 6]>,
    pub(super) map_units: Option<String>,
    pub(super) grid_unit: Option<GridUnit>,
    pub(super) gdorient: Option<[String; 5]>,
    pub(super) unit_system: Option<UnitSystem>,
    /// True when DX, DY, DZ or TOPS were met.
    pub(super) block_centered: bool,
    pub(super) files: Vec<PathBuf>,
    /// Bytes of all files, each time they are included.
    pub(super) bytes: usize,
}

/// What part of the grid the arrays at hand belong to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Scope {
    Whole,
    Box,
    Refinement,
}

/// How reading goes on after a keyword.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Flow {
    On,
    EndOfFile,
    EndOfDeck,
}

pub(super) struct Scan<'w> {
    warnings: &'w mut Warnings,
    pub(super) places: Places,
    found: Found,
    scope: Scope,
    /// Canonical paths of the files being read, outermost first.
    pub(super) open: Vec<PathBuf>,
    pub(super) opened: usize,
    pub(super) operations: BTreeMap<String, Operation>,
}

/// Reads the deck at `path` up to its arrays.
pub(super) fn scan(path: &Path, warnings: &mut Warnings) -> Result<Found, ParseError> {
    let mut scan = Scan {
        warnings,
        places: Places::new(path),
        found: Found::default(),
        scope: Scope::Whole,
        open: Vec::new(),
        opened: 0,
        operations: BTreeMap::new(),
    };
    scan.file(path, Vec::new())?;
    scan.report_operations();
    Ok(scan.found)
}

impl Scan<'_> {
    pub(super) fn file(
        &mut self,
        path: &Path,
        included_from: Vec<(PathBuf, usize)>,
    ) -> Result<Flow, ParseError> {
        let source = Rc::new(Source::open(path, included_from)?);
        let text = source.text();
        if text.iter().take(512).any(|&byte| byte == 0) {
            return Err(source.error(0, "", "this is a binary file, not a text deck"));
        }
        self.opened += 1;
        self.found.bytes = self.found.bytes.saturating_add(text.len());
        if !self.found.files.iter().any(|file| file == path) {
            self.found.files.push(path.to_owned());
        }
        self.open.push(canonical(path));
        let flow = self.keywords(&source);
        self.open.pop();
        flow
    }

    fn keywords(&mut self, source: &Rc<Source>) -> Result<Flow, ParseError> {
        let mut cursor = Cursor::new(source.text(), 0);
        let mut stray = None;
        let mut flow = Flow::On;
        while flow == Flow::On && cursor.skip_blank() {
            if let Some(keyword) = keyword(cursor.text, cursor.at) {
                cursor.at = keyword.end;
                flow = self.keyword(source, &mut cursor, &keyword)?;
            } else {
                // A lone slash is common and harmless.
                if cursor.text.get(cursor.at) != Some(&b'/') {
                    stray.get_or_insert(cursor.at);
                }
                cursor.at = line_end(cursor.text, cursor.at);
            }
        }
        if let Some(at) = stray {
            self.warn(
                source,
                at,
                "text that belongs to no keyword is skipped, here and in any later lines like it",
            );
        }
        Ok(if flow == Flow::EndOfFile {
            Flow::On
        } else {
            flow
        })
    }

    fn keyword(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        let name = keyword.name.as_str();
        match name {
            "END" | "SUMMARY" | "SCHEDULE" | "OPTIMIZE" => return Ok(Flow::EndOfDeck),
            "ENDINC" => return Ok(Flow::EndOfFile),
            "INCLUDE" => return self.include(source, cursor, keyword),
            "TITLE" => skip_title(cursor),
            "SKIP" | "SKIP100" | "SKIP300" => self.skip_region(source, cursor, keyword)?,
            "METRIC" => self.found.unit_system = Some(UnitSystem::Metric),
            "FIELD" => self.found.unit_system = Some(UnitSystem::Field),
            "LAB" => self.found.unit_system = Some(UnitSystem::Lab),
            "PVT-M" => self.found.unit_system = Some(UnitSystem::PvtM),
            "BOX" | "ENDBOX" | "CARFIN" | "RADFIN" | "RADFIN4" | "REFINE" | "ENDFIN" => {
                self.change_scope(source, cursor, keyword)?;
            }
            "COORD" | "ZCORN" | "ACTNUM" => self.array(source, cursor, keyword)?,
            "PATHS" => self.paths(source, cursor)?,
            "FAULTS" => {
                let faults =
                    faults::faults(cursor).map_err(|mistake| source.mistake(name, mistake))?;
                let placed = faults
                    .into_iter()
                    .map(|(at, fault)| (Rc::clone(source), at, fault));
                self.found.faults.extend(placed);
            }
            "SPECGRID" | "DIMENS" | "MAPAXES" | "MAPUNITS" | "GRIDUNIT" | "GDORIENT" => {
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

    fn header(
        &mut self,
        source: &Source,
        keyword: &Keyword,
        items: &[Item],
    ) -> Result<(), ParseError> {
        let name = keyword.name.as_str();
        if self.scope == Scope::Refinement {
            return Ok(());
        }
        let placed = |mistake| source.mistake(name, mistake);
        match name {
            "MAPAXES" => {
                self.found.map_axes = Some(header::map_axes(items, keyword.at).map_err(placed)?);
            }
            "MAPUNITS" => self.found.map_units = header::name(items, 0),
            "GRIDUNIT" => self.found.grid_unit = Some(header::grid_unit(items)),
            "GDORIENT" => self.found.gdorient = Some(header::gdorient(items)),
            _ => {
                let dims = header::dims(items, keyword.at).map_err(placed)?;
                self.dims(source, keyword, dims);
            }
        }
        Ok(())
    }

    fn dims(&mut self, source: &Source, keyword: &Keyword, dims: [usize; 3]) {
        let from_specgrid = keyword.name == "SPECGRID";
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
                cursor.text.len(),
                name,
                "the file ends before the closing / of the array",
            )
        })?;
        cursor.at = line_end(cursor.text, end);
        let block = block(source, keyword, end);
        if self.scope == Scope::Refinement {
            return Ok(());
        }
        if name == "ACTNUM" && self.scope == Scope::Box {
            self.warn(source, keyword.at, "ACTNUM inside a BOX is not read");
            return Ok(());
        }
        let place = match name {
            "COORD" => &mut self.found.coord,
            "ZCORN" => &mut self.found.zcorn,
            _ => &mut self.found.actnum,
        };
        if place.replace(block).is_some() {
            self.warn(
                source,
                keyword.at,
                &format!("{name} is given again; the last one is used"),
            );
        }
        Ok(())
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
            Skipped::OneNumeric(end) => self.candidate(block(source, keyword, end)),
        }
        match name {
            "DX" | "DY" | "DZ" | "DXV" | "DYV" | "DZV" | "DR" | "DRV" | "TOPS" => {
                self.found.block_centered = true;
            }
            "RUNSPEC" | "GRID" | "EDIT" | "PROPS" | "REGIONS" | "SOLUTION" => {
                self.scope = Scope::Whole;
            }
            "GDFILE" | "IMPORT" => {
                self.warn(
                    source,
                    keyword.at,
                    &format!("the file that {name} names is not read; open it directly"),
                );
            }
            _ => {}
        }
        Ok(())
    }

    fn candidate(&mut self, block: Block) {
        match self.scope {
            Scope::Whole => self.found.candidates.push(block),
            Scope::Refinement => {}
            Scope::Box => {
                let message = format!("{} inside a BOX is not read", block.name);
                self.warn(&block.source, block.at, &message);
            }
        }
    }

    fn change_scope(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let name = keyword.name.as_str();
        skip_records(cursor, name).map_err(|mistake| source.mistake(name, mistake))?;
        self.scope = match name {
            "ENDBOX" | "ENDFIN" => Scope::Whole,
            "BOX" => Scope::Box,
            _ => Scope::Refinement,
        };
        if name == "BOX" {
            self.note_operation(source, keyword, Vec::new());
        } else if self.scope == Scope::Refinement {
            let message = format!(
                "{name}: local refinements are not read from text; run the simulator and open the EGRID to see them"
            );
            self.warn(source, keyword.at, &message);
        }
        Ok(())
    }

    fn skip_region(
        &mut self,
        source: &Source,
        cursor: &mut Cursor,
        skip: &Keyword,
    ) -> Result<(), ParseError> {
        while cursor.skip_blank() {
            let ends = keyword(cursor.text, cursor.at).is_some_and(|found| found.name == "ENDSKIP");
            cursor.at = line_end(cursor.text, cursor.at);
            if ends {
                return Ok(());
            }
        }
        Err(source.error(skip.at, &skip.name, "no ENDSKIP follows in this file"))
    }

    pub(super) fn warn(&mut self, source: &Source, at: usize, message: &str) {
        self.warnings.push(source.path(), source.at(at), message);
    }
}

/// `3 x 4 x 5`.
pub(super) fn product_text([ni, nj, nk]: [usize; 3]) -> String {
    format!("{ni} x {nj} x {nk}")
}

fn block(source: &Rc<Source>, keyword: &Keyword, end: usize) -> Block {
    Block {
        source: Rc::clone(source),
        name: keyword.name.clone(),
        at: keyword.at,
        data: keyword.end..end,
    }
}

/// The title is the next line with text.
fn skip_title(cursor: &mut Cursor) {
    if cursor.skip_blank() {
        cursor.at = line_end(cursor.text, cursor.at);
    }
}
