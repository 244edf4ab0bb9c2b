//! Cell arrays of the global grid: the part that INIT and restart steps have in common.

use std::ops::Range;
use std::sync::Arc;

use crate::error::ParseError;
use crate::records::{Entry, RecordFile};
use crate::units::UnitSystem;

/// A run of arrays that belongs to the global grid.
#[derive(Debug, Clone)]
pub struct CellArrays {
    file: Arc<RecordFile>,
    entries: Vec<usize>,
}

/// Facts of an INTEHEAD array.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Head {
    /// Unit system (item 3).
    pub units: Option<UnitSystem>,
    /// NX, NY, NZ (items 9 to 11).
    pub dims: [i32; 3],
    /// Active cells (item 12).
    pub active: i32,
    /// Phases (item 15): 1 oil, 2 water, 4 gas, added.
    pub phases: i32,
    /// `YYYY-MM-DD` (items 65 to 67); empty where absent.
    pub date: String,
    /// Hour, minute and microsecond of the minute (items 207, 208, 411); zero where absent.
    pub clock: [i32; 3],
    /// Number of wells (item 17).
    pub wells: i32,
    /// Strings a well in ZWEL (item 28).
    pub strings_a_well: i32,
}

impl CellArrays {
    /// The arrays within `range` of a file that are not in a section of a local grid.
    pub(crate) fn new(file: &Arc<RecordFile>, range: Range<usize>, ends_local: &[&str]) -> Self {
        let mut inside_local = false;
        let mut entries = Vec::new();
        for n in range {
            let name = file.entries()[n].name();
            if name == "LGR" || name == "LGRHEADI" && !inside_local {
                inside_local = true;
            } else if ends_local.contains(&name) {
                inside_local = false;
            } else if !inside_local {
                entries.push(n);
            }
        }
        Self {
            file: Arc::clone(file),
            entries,
        }
    }

    /// The arrays in file order.
    pub fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().map(|&n| &self.file.entries()[n])
    }

    /// The first array called `name`.
    pub fn find(&self, name: &str) -> Option<&Entry> {
        self.iter().find(|e| e.name() == name)
    }

    /// The file.
    pub fn file(&self) -> &RecordFile {
        &self.file
    }

    /// Decodes an array of numbers.
    ///
    /// # Errors
    /// When it holds no numbers or is damaged.
    pub fn values(&self, entry: &Entry) -> Result<Vec<f32>, ParseError> {
        self.file.f32s(entry)
    }

    /// What INTEHEAD says; all zero where there is none.
    ///
    /// # Errors
    /// When it is damaged.
    pub fn head(&self) -> Result<Head, ParseError> {
        let Some(entry) = self.find("INTEHEAD") else {
            return Ok(Head::default());
        };
        let items = self.file.i32s(entry)?;
        let item = |n: usize| items.get(n - 1).copied().unwrap_or(0);
        let (day, month, year) = (item(65), item(66), item(67));
        Ok(Head {
            units: UnitSystem::from_code(item(3)),
            dims: [item(9), item(10), item(11)],
            active: item(12),
            phases: item(15),
            date: if year > 0 {
                format!("{year:04}-{month:02}-{day:02}")
            } else {
                String::new()
            },
            clock: [item(207), item(208), item(411)],
            wells: item(17),
            strings_a_well: item(28),
        })
    }
}
