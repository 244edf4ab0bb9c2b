//! Values of a case, decoded from its files when they are asked for.

use std::path::Path;
use std::sync::Arc;

use strataray_parsers::arrays::is_cell_array;
use strataray_parsers::cells::CellArrays;
use strataray_parsers::deck::DeckProperty;
use strataray_parsers::records::{Entry, Kind};
use strataray_parsers::restart::Step as FileStep;
use strataray_parsers::{At, ErrorKind, ParseError};

use super::local::Places;
use super::resqml::PackageValues;
use super::restarts;
use super::slots::CellSlots;
use super::summary::SummaryFiles;
use super::volume::VolumeValues;
use super::wells::{self, WellFiles};
use crate::case::pores::{self, Pores};
use crate::case::{About, CaseError, Source, Vectors, Well};

/// Arrays that are no properties, though there may be as many values as cells: heads, wells, groups, connections.
const NOT_PROPERTIES: &[&str] = &[
    "ACTNUM", "SEQNUM", "INTEHEAD", "DOUBHEAD", "TABDIMS", "TAB", "CON", "REGDIMS", "IGRP", "SGRP",
    "XGRP", "IWEL", "SWEL", "XWEL", "ICON", "SCON", "XCON", "ISEG", "RSEG", "ILBS", "ILBR",
    "DLYTIM", "THRESHPR", "TRANNNC", "TRANGL", "TRANLL", "TRANNLL", "DIFFNNC", "HEATNNC",
];

/// The array of pore volumes.
const PORE_VOLUME: &str = "PORV";

/// Values from the case's files, decoded when asked for.
pub struct FileSource {
    pub cells: CellSlots,
    /// Where the cells of all grids have theirs, where there are local ones.
    pub local: Option<Places>,
    pub init: Option<CellArrays>,
    pub steps: Vec<FileStep>,
    /// Arrays of decks and other text.
    pub texts: Vec<DeckProperty>,
    /// Properties of a RESQML package.
    pub package: Option<PackageValues>,
    /// Properties of regular volumes.
    pub volumes: Vec<VolumeValues>,
    /// Curves over time.
    pub summary: SummaryFiles,
    /// Wells that are not of the steps.
    pub wells: WellFiles,
}

impl FileSource {
    /// Takes the results that are of this grid; what is of another one becomes a note.
    pub fn take_fitting(
        &mut self,
        init: Option<CellArrays>,
        runs: Vec<Vec<FileStep>>,
        about: &mut About,
    ) {
        if let Some(init) = init {
            match self.check(&init, init.file().path()) {
                Ok(()) => {
                    about.files.push(init.file().path().to_owned());
                    self.init = Some(init);
                }
                Err(error) => about.notes.push(format!("INIT was not loaded: {error}")),
            }
        }
        let mut fitting = Vec::new();
        for run in runs {
            let first = run.first().map(|s| &s.arrays);
            match first.map_or(Ok(()), |a| self.check(a, a.file().path())) {
                Ok(()) => {
                    let read = run.iter().map(|s| s.arrays.file().path().to_owned());
                    about.files.extend(read);
                    about.files.dedup();
                    fitting.push(run);
                }
                Err(error) => about
                    .notes
                    .push(format!("time steps were not loaded: {error}")),
            }
        }
        self.steps = restarts::merged(fitting, &mut about.notes);
    }

    /// The values of an array at a step, of the matrix or of the fractures.
    fn read(
        &self,
        name: &str,
        step: usize,
        is_matrix: bool,
    ) -> Result<Option<Vec<f32>>, CaseError> {
        let arrays = self.arrays(name, step);
        let Some((arrays, entry)) = arrays.and_then(|a| Some((a, a.find(name)?))) else {
            return Ok(None);
        };
        let values = arrays.values(entry)?;
        let values = match is_matrix {
            true => self.cells.pick(&values),
            false => self.cells.pick_fractures(&values),
        };
        Ok(Some(match &self.local {
            Some(places) => places.values(&values, arrays, name, is_matrix)?,
            None => values,
        }))
    }

    /// Values of the matrix or of fractures, of text or else of arrays.
    fn values_of(
        &self,
        name: &str,
        pores: Pores,
        step: usize,
    ) -> Result<Option<Vec<f32>>, CaseError> {
        let is_matrix = pores == Pores::Matrix;
        let Some(text) = self.text(name) else {
            return self.read(name, step, is_matrix);
        };
        let values: Vec<f32> = text.values.iter().map(|v| *v as f32).collect();
        let picked = match is_matrix {
            true => self.cells.pick_of_all(&values),
            false if self.cells.has_all_fractures(values.len()) => {
                self.cells.pick_fractures(&values)
            }
            false => return Ok(None),
        };
        Ok(Some(match &self.local {
            Some(places) => places.values_of_texts(&picked, name, is_matrix),
            None => picked,
        }))
    }

    /// The array of text that is a property: one that changes with time is that of the steps.
    fn text(&self, name: &str) -> Option<&DeckProperty> {
        let text = self.texts.iter().find(|p| p.name == name)?;
        (!self.changes(name)).then_some(text)
    }

    /// True where text, or an array of INIT or of a step, has values of fractures too.
    pub fn has_fractures(&self, name: &str) -> bool {
        if let Some(text) = self.text(name) {
            return self.cells.has_all_fractures(text.values.len());
        }
        let arrays = self.steps.iter().map(|s| &s.arrays).chain(&self.init);
        let mut found = arrays.filter_map(|arrays| arrays.find(name));
        found.any(|entry| self.cells.has_fractures(entry.count as usize))
    }

    /// Refuses results of another grid.
    fn check(&self, arrays: &CellArrays, path: &Path) -> Result<(), ParseError> {
        let head = arrays.head()?;
        let active = usize::try_from(head.active).unwrap_or(0);
        let message = if active > 0 && !self.cells.are_as_many(active) {
            format!(
                "has {active} active cells and the grid {}; it belongs to another grid",
                self.cells.count()
            )
        } else if let Some([own, other]) = self.cells.other_dims(head.dims) {
            format!("has {other} cells and the grid {own}; it belongs to another grid")
        } else {
            return Ok(());
        };
        Err(ParseError::of(
            ErrorKind::Mismatch,
            path,
            At::File,
            "INTEHEAD",
            message,
        ))
    }

    fn arrays(&self, name: &str, step: usize) -> Option<&CellArrays> {
        let arrays = self.steps.get(step).map(|s| &s.arrays);
        arrays.filter(|a| self.holds(a, name)).or_else(|| {
            let init = self.init.as_ref();
            init.filter(|a| self.holds(a, name))
        })
    }

    fn holds(&self, arrays: &CellArrays, name: &str) -> bool {
        arrays.find(name).is_some_and(|e| self.is_property(e))
    }

    /// True where a step has the property.
    pub fn changes(&self, name: &str) -> bool {
        self.steps.iter().any(|s| self.holds(&s.arrays, name))
    }

    /// True where an array has one value a cell.
    pub fn is_property(&self, entry: &Entry) -> bool {
        entry.is_numeric()
            && self.cells.fits(entry.count as usize)
            && !NOT_PROPERTIES.contains(&entry.name())
    }

    /// The properties of a step. Beside its solution (STARTSOL to ENDSOL, where marked) stand lists of other things,
    /// of which whole and double numbers are no properties, unless they are known to be.
    pub fn properties_of<'a>(&self, arrays: &'a CellArrays) -> Vec<&'a Entry> {
        let mut is_solution = arrays.find("STARTSOL").is_none();
        let mut found = Vec::new();
        for entry in arrays.iter() {
            match entry.name() {
                "STARTSOL" => is_solution = true,
                "ENDSOL" => is_solution = false,
                name => {
                    let may_be = is_solution || entry.kind == Kind::Real || is_cell_array(name);
                    found.extend((may_be && self.is_property(entry)).then_some(entry));
                }
            }
        }
        found
    }

    /// One sentence for each array that should have one value a cell and has another number of them.
    pub fn misfits(&self) -> Vec<String> {
        let mut found: Vec<Misfit<'_>> = Vec::new();
        let mut note = |arrays: &CellArrays, step: Option<usize>, entry: &Entry| {
            let known = found.iter_mut().find(|m| {
                m.name == entry.name()
                    && m.count == entry.count
                    && m.step.is_some() == step.is_some()
            });
            match known {
                Some(known) => known.more += 1,
                None => found.push(Misfit {
                    file: arrays.file().path().display().to_string(),
                    name: entry.name().to_owned(),
                    count: entry.count,
                    step,
                    more: 0,
                    expected: &self.cells,
                }),
            }
        };
        if let Some(init) = &self.init {
            let known = init.iter().filter(|e| is_cell_array(e.name()));
            for entry in known.filter(|e| self.is_misfit(e)) {
                note(init, None, entry);
            }
        }
        for (n, step) in self.steps.iter().enumerate() {
            let mut is_solution = false;
            for entry in step.arrays.iter() {
                match entry.name() {
                    "STARTSOL" => is_solution = true,
                    "ENDSOL" => is_solution = false,
                    name => {
                        let is_cells = is_solution && entry.kind == Kind::Real;
                        if (is_cells || is_cell_array(name)) && self.is_misfit(entry) {
                            note(&step.arrays, Some(n), entry);
                        }
                    }
                }
            }
        }
        found.iter().map(ToString::to_string).collect()
    }

    fn is_misfit(&self, entry: &Entry) -> bool {
        entry.is_numeric() && entry.count > 0 && !self.cells.fits(entry.count as usize)
    }
}

/// An array with another number of values than there are cells.
struct Misfit<'a> {
    file: String,
    name: String,
    count: u64,
    /// The first step where it is so; `None` in INIT.
    step: Option<usize>,
    /// Further steps.
    more: usize,
    expected: &'a CellSlots,
}

impl std::fmt::Display for Misfit<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.file, self.name)?;
        if let Some(step) = self.step {
            write!(f, " of step {step}")?;
        }
        if self.more > 0 {
            write!(f, " and {} further steps", self.more)?;
        }
        write!(
            f,
            " has {} values for {} active cells: it was left out",
            self.count,
            self.expected.count()
        )
    }
}

impl Source for FileSource {
    fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, CaseError> {
        let package = self.package.as_ref().filter(|p| p.has(name));
        if let Some(package) = package.filter(|_| !self.changes(name) && self.text(name).is_none())
        {
            let values = package.values(name, step)?;
            return Ok(values.map(|values| self.cells.pick_of_all(&values)));
        }
        let volume = self.volumes.iter().find(|v| v.name() == name);
        if let Some(volume) = volume.filter(|_| self.text(name).is_none()) {
            return Ok(Some(self.cells.pick_of_whole(volume.read()?)));
        }
        let (array, pores) = match self.text(name) {
            Some(_) => (name, Pores::Matrix),
            None => Pores::of(name),
        };
        match pores {
            Pores::Matrix | Pores::Fracture => self.values_of(array, pores, step),
            Pores::Total => {
                let both = |name: &str| {
                    let matrix = self.values_of(name, Pores::Matrix, step)?;
                    let fractures = self.values_of(name, Pores::Fracture, step)?;
                    Ok::<_, CaseError>(matrix.zip(fractures))
                };
                let (Some(of), Some(volumes)) = (both(array)?, both(PORE_VOLUME)?) else {
                    return Ok(None);
                };
                Ok(Some(pores::means([&of.0, &of.1], [&volumes.0, &volumes.1])))
            }
        }
    }

    fn wells(&self, step: usize) -> Result<Vec<Well>, CaseError> {
        let step = self.steps.get(step);
        let of_restart = step.map(wells::of).transpose()?.unwrap_or_default();
        Ok(self.wells.at(step.map(super::step).as_ref(), of_restart))
    }

    fn vectors(&self) -> Result<Option<Arc<Vectors>>, CaseError> {
        Ok(self.summary.vectors()?)
    }
}
