//! Cell arrays by grid: the part that INIT and restart steps have in common.

use std::collections::HashMap;
use std::io::{self, Write};
use std::ops::Range;
use std::sync::Arc;

use crate::arrays::is_region;
use crate::error::ParseError;
use crate::records::{Entry, RecordFile, RecordWriter, refused};
use crate::units::UnitSystem;
use crate::wells::ITEMS;

/// Items of an INTEHEAD array that is written, of LOGIHEAD, and the simulator that item 95 names.
const INTEHEAD_ITEMS: usize = 411;
const LOGIHEAD_ITEMS: usize = 121;
const SIMULATOR: i32 = 100;

/// The arrays of a grid within an INIT file or a step; those of the global grid know where local grids have theirs.
#[derive(Debug, Clone)]
pub struct CellArrays {
    file: Arc<RecordFile>,
    entries: Vec<usize>,
    /// Sections of local grids, each from its LGR on.
    sections: Vec<Range<usize>>,
}

/// The arrays of a local grid.
#[derive(Debug, Clone)]
pub struct LocalArrays {
    /// Name of the grid, as the EGRID has it.
    pub name: String,
    /// Its arrays. INIT files have several sections for a grid, which stand one after the other here. In the one of
    /// the transmissibilities, TRANNNC belongs to NNC1 and NNC2 of the EGRID, and TRANGL to NNCL and NNCG.
    pub arrays: CellArrays,
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
    /// Most connections of a well (item 18).
    pub connections_per_well: i32,
    /// Strings per well in ZWEL (item 28).
    pub strings_per_well: i32,
}

impl CellArrays {
    /// The arrays within `range` of a file that are not in a section of a local grid.
    pub(crate) fn new(file: &Arc<RecordFile>, range: Range<usize>) -> Self {
        let mut inside_local = false;
        let mut entries = Vec::new();
        let mut sections: Vec<Range<usize>> = Vec::new();
        for n in range {
            let name = file.entries()[n].name();
            if name == "LGR" || name == "LGRHEADI" && !inside_local {
                inside_local = true;
                sections.push(n..n);
            } else if matches!(name, "LGRSGONE" | "ENDLGR") {
                inside_local = false;
            } else if !inside_local {
                entries.push(n);
            }
            if let Some(section) = sections.last_mut().filter(|_| inside_local) {
                section.end = n + 1;
            }
        }
        Self {
            file: Arc::clone(file),
            entries,
            sections,
        }
    }

    /// The arrays of local grids, in the order in which the file first has them.
    ///
    /// # Errors
    /// When the name of a grid cannot be read.
    pub fn local_grids(&self) -> Result<Vec<LocalArrays>, ParseError> {
        let mut grids: Vec<LocalArrays> = Vec::new();
        let mut places = HashMap::new();
        for section in &self.sections {
            let entry = &self.file.entries()[section.start];
            let is_named = entry.name() == "LGR";
            let names = is_named.then(|| self.file.strings(entry)).transpose()?;
            let name = names.and_then(|n| n.into_iter().next()).unwrap_or_default();
            let entries = section.start + usize::from(is_named)..section.end;
            let known = *places.entry(name.clone()).or_insert(grids.len());
            match grids.get_mut(known) {
                Some(grid) => grid.arrays.entries.extend(entries),
                None => grids.push(LocalArrays {
                    name,
                    arrays: Self {
                        file: Arc::clone(&self.file),
                        entries: entries.collect(),
                        sections: Vec::new(),
                    },
                }),
            }
        }
        Ok(grids)
    }

    /// Transmissibilities between local grids: each TRANLL with the names of the two grids, from the LGRJOIN before it.
    /// They belong to NNA1 and NNA2 of the EGRID.
    ///
    /// # Errors
    /// When a LGRJOIN cannot be read.
    pub fn joins(&self) -> Result<Vec<([String; 2], Entry)>, ParseError> {
        let sections = self.sections.iter().cloned().flatten();
        let all = self.entries.iter().copied().chain(sections);
        let all: Vec<&Entry> = all.map(|n| &self.file.entries()[n]).collect();
        let mut joins = Vec::new();
        for pair in all.windows(2) {
            if (pair[0].name(), pair[1].name()) == ("LGRJOIN", "TRANLL") {
                let names = self.file.strings(pair[0])?.try_into();
                joins.extend(names.ok().map(|names| (names, *pair[1])));
            }
        }
        Ok(joins)
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
                date_text([year, month, day])
            } else {
                String::new()
            },
            clock: [item(207), item(208), item(411)],
            wells: item(17),
            connections_per_well: item(18),
            strings_per_well: item(28),
        })
    }
}

impl Head {
    /// Date and time of day, `YYYY-MM-DD`, `YYYY-MM-DD hh:mm` or `YYYY-MM-DD hh:mm:ss`: as much as is needed. Empty where
    /// there is no date.
    pub fn time(&self) -> String {
        let [hour, minute, micros] = self.clock;
        let is_clock = (0..24).contains(&hour) && (0..60).contains(&minute);
        let second = micros.max(0) / 1_000_000;
        match (hour, minute, second) {
            _ if self.date.is_empty() || !is_clock || second > 59 => self.date.clone(),
            (0, 0, 0) => self.date.clone(),
            (_, _, 0) => format!("{} {hour:02}:{minute:02}", self.date),
            _ => format!("{} {hour:02}:{minute:02}:{second:02}", self.date),
        }
    }

    /// The INTEHEAD array that [`CellArrays::head`] reads as this.
    ///
    /// # Errors
    /// When the date is neither empty nor `YYYY-MM-DD`.
    fn items(&self) -> io::Result<Vec<i32>> {
        let [year, month, day] = match self.date.as_str() {
            "" => [0; 3],
            date => {
                let parts: Option<Vec<i32>> = date.split('-').map(|p| p.parse().ok()).collect();
                let parts = parts.and_then(|p| <[i32; 3]>::try_from(p).ok());
                let known = parts.filter(|p| p[0] > 0 && self.date == date_text(*p));
                known.ok_or_else(|| refused(format!("{date:?} is not a date like 2001-06-30")))?
            }
        };
        let mut items = vec![0; INTEHEAD_ITEMS];
        let mut set = |n: usize, value: i32| items[n - 1] = value;
        set(3, self.units.map_or(0, UnitSystem::code));
        (9..).zip(self.dims).for_each(|(n, size)| set(n, size));
        set(12, self.active);
        set(15, self.phases);
        set(17, self.wells);
        set(18, self.connections_per_well);
        if self.wells > 0 {
            let items = [
                (25, ITEMS.iwel),
                (26, ITEMS.swel),
                (27, ITEMS.xwel),
                (33, ITEMS.icon),
                (34, ITEMS.scon),
            ];
            items
                .into_iter()
                .for_each(|(n, count)| set(n, count as i32));
        }
        set(28, self.strings_per_well);
        set(65, day);
        set(66, month);
        set(67, year);
        set(95, SIMULATOR);
        set(207, self.clock[0]);
        set(208, self.clock[1]);
        set(411, self.clock[2]);
        Ok(items)
    }
}

fn date_text([year, month, day]: [i32; 3]) -> String {
    format!("{year:04}-{month:02}-{day:02}")
}

/// Writes INTEHEAD, LOGIHEAD (all false) and DOUBHEAD (the days).
pub(crate) fn write_heads<W: Write>(
    out: &mut RecordWriter<W>,
    head: &Head,
    days: f64,
) -> io::Result<()> {
    out.inte("INTEHEAD", &head.items()?)?;
    out.logi("LOGIHEAD", &[false; LOGIHEAD_ITEMS])?;
    out.doub("DOUBHEAD", &[days])
}

/// Writes arrays of one value per active cell, or per cell as PORV has, each made only when its turn comes; numbers of
/// regions as INTE, all others as REAL.
pub(crate) fn write_arrays<W: Write, N: AsRef<str>>(
    out: &mut RecordWriter<W>,
    head: &Head,
    arrays: impl IntoIterator<Item = (N, Vec<f32>)>,
) -> io::Result<()> {
    for (name, values) in arrays {
        let name = name.as_ref();
        let cells = head.dims.iter().map(|n| i64::from(*n)).product();
        if ![i64::from(head.active), cells].contains(&(values.len() as i64)) {
            let (expected, found) = (head.active, values.len());
            let message = format!("{name}: expected {expected} values, found {found}");
            return Err(refused(message));
        }
        match whole(&values).filter(|_| is_region(name)) {
            Some(numbers) => out.inte(name, &numbers)?,
            None => out.real(name, &values)?,
        }
    }
    Ok(())
}

/// Whole numbers, where all are such.
fn whole(values: &[f32]) -> Option<Vec<i32>> {
    let number = |v: &f32| (f64::from(*v as i32) == f64::from(*v)).then_some(*v as i32);
    values.iter().map(number).collect()
}
