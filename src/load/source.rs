//! Values of a case, decoded from its files when they are asked for.

use std::path::Path;

use strataray_parsers::cells::CellArrays;
use strataray_parsers::deck::Grdecl;
use strataray_parsers::records::Entry;
use strataray_parsers::restart::Step as FileStep;
use strataray_parsers::units::UnitSystem;
use strataray_parsers::{At, ParseError};

use super::slots::CellSlots;
use crate::case::{CaseError, Source};

/// Arrays of cell count that are no properties: solver and well bookkeeping.
const NOT_PROPERTIES: [&str; 3] = ["ACTNUM", "SEQNUM", "INTEHEAD"];

/// Values from the case's files, decoded when asked for.
pub struct FileSource {
    pub cells: CellSlots,
    pub init: Option<CellArrays>,
    pub steps: Vec<FileStep>,
    pub deck: Option<Grdecl>,
}

impl FileSource {
    /// Refuses results of another grid.
    pub fn check(&self, arrays: &CellArrays, path: &Path) -> Result<(), ParseError> {
        let head = arrays.head()?;
        let expected = self
            .cells
            .matrix
            .as_ref()
            .map_or(self.cells.cells.len(), |m| m.counts[1]);
        let active = usize::try_from(head.active).unwrap_or(0);
        if active == 0 || active == expected || active == self.cells.cells.len() {
            return Ok(());
        }
        let message = format!(
            "has {active} active cells and the grid {expected}; it belongs to another grid"
        );
        Err(ParseError::new(path, At::File, "INTEHEAD", message))
    }

    fn arrays(&self, name: &str, step: usize) -> Option<&CellArrays> {
        let holds = |a: &&CellArrays| a.find(name).is_some_and(|e| self.is_property(e));
        self.steps
            .get(step)
            .map(|s| &s.arrays)
            .filter(holds)
            .or_else(|| self.init.as_ref().filter(holds))
    }

    pub fn is_property(&self, entry: &Entry) -> bool {
        entry.is_numeric()
            && self.cells.fits(entry.count as usize)
            && !NOT_PROPERTIES.contains(&entry.name())
    }

    pub fn units(&self) -> Option<UnitSystem> {
        let heads = self
            .init
            .iter()
            .chain(self.steps.first().map(|s| &s.arrays));
        heads.filter_map(|a| a.head().ok()?.units).next()
    }
}

impl Source for FileSource {
    fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, CaseError> {
        if let Some(property) = self
            .deck
            .as_ref()
            .and_then(|d| d.properties.iter().find(|p| p.name == name))
        {
            let values: Vec<f32> = property.values.iter().map(|v| *v as f32).collect();
            return Ok(Some(self.cells.pick(&values)));
        }
        let Some((arrays, entry)) = self
            .arrays(name, step)
            .and_then(|a| Some((a, a.find(name)?)))
        else {
            return Ok(None);
        };
        Ok(Some(self.cells.pick(&arrays.values(entry)?)))
    }
}
