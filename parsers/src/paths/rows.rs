//! Lists of points with names between them, and well traces.

use std::path::Path;

use super::columns::{Columns, is_survey};
use super::line::{Line, labeled_name, lines, name};
use super::{Vertical, WellPath, settle, wrong};
use crate::error::{ErrorKind, ParseError};
use crate::units::LengthUnit;

/// Marks the end of a well.
const END: f64 = 999.0;

/// Wells in the making.
struct Reading<'a> {
    path: &'a Path,
    wells: Vec<WellPath>,
    /// Name of the well whose rows come next.
    name: Option<String>,
    columns: Option<Columns>,
    unit: Option<LengthUnit>,
    /// The next row begins a well.
    is_new: bool,
}

/// Reads all wells; those without a name have that of the file.
pub(super) fn read(path: &Path, text: &str, stem: &str) -> Result<Vec<WellPath>, ParseError> {
    let mut reading = Reading {
        path,
        wells: Vec::new(),
        name: None,
        columns: None,
        unit: None,
        is_new: true,
    };
    for (number, line) in lines(text) {
        match Line::of(line) {
            Line::Blank => {}
            Line::Comment(words) => reading.comment(words),
            Line::Words(words) => reading.words(number, words)?,
            Line::Numbers(row) if row.iter().all(|v| v.abs() == END) => reading.is_new = true,
            Line::Numbers(row) => reading.row(number, &row)?,
            Line::Damaged { word, column } => {
                let message = format!("column {column} of this row is no number: '{word}'");
                return Err(wrong(ErrorKind::BadValue, path, Some(number), message));
            }
        }
    }
    let Reading {
        mut wells,
        columns,
        unit,
        ..
    } = reading;
    let mut unnamed = 0;
    for well in &mut wells {
        well.unit = unit;
        if well.name.is_empty() {
            unnamed += 1;
            well.name = match unnamed {
                1 => stem.to_owned(),
                _ => format!("{stem} {unnamed}"),
            };
        }
    }
    settle(&mut wells, columns.and_then(|columns| columns.vertical));
    Ok(wells)
}

impl Reading<'_> {
    /// A comment may name the well, the columns, or the unit of lengths.
    fn comment(&mut self, words: &str) {
        if let Some(name) = labeled_name(words) {
            self.begin(name);
        } else if let Some(columns) = Columns::of(words) {
            self.columns = Some(columns);
        }
        self.unit = self.unit.or_else(|| unit(words));
    }

    fn words(&mut self, number: usize, words: &str) -> Result<(), ParseError> {
        if let Some(columns) = Columns::of(words) {
            self.columns = Some(columns);
        } else if is_survey(words) {
            let message = "this file has measured depths and angles without X and Y: export the path with coordinates";
            return Err(wrong(
                ErrorKind::Unsupported,
                self.path,
                Some(number),
                message,
            ));
        } else if words.chars().any(char::is_alphanumeric) {
            self.begin(name(words));
        }
        Ok(())
    }

    fn begin(&mut self, name: &str) {
        self.name = Some(name.to_owned());
        self.is_new = true;
    }

    fn row(&mut self, number: usize, row: &[f64]) -> Result<(), ParseError> {
        let columns = self.columns.unwrap_or_else(|| Columns::unnamed(row.len()));
        if row.len() < columns.needed() {
            let expected = match self.columns {
                Some(columns) => format!("the columns named above are {}", columns.count),
                None => "expected x, y, z and perhaps measured depth".to_owned(),
            };
            let message = format!("this row has {} numbers; {expected}", row.len());
            return Err(wrong(
                ErrorKind::WrongCount,
                self.path,
                Some(number),
                message,
            ));
        }
        if std::mem::take(&mut self.is_new) {
            self.wells.push(WellPath {
                name: self.name.take().unwrap_or_default(),
                points: Vec::new(),
                measured: columns.measured.map(|_| Vec::new()),
                unit: None,
                vertical: Vertical::DepthBySign,
            });
        }
        if let Some(well) = self.wells.last_mut() {
            well.points
                .push([columns.x, columns.y, columns.z].map(|n| row[n]));
            match (columns.measured, &mut well.measured) {
                (Some(column), Some(measured)) => measured.push(row[column]),
                // Rows of one well that differ in what they have.
                _ => well.measured = None,
            }
        }
        Ok(())
    }
}

/// The unit that a comment of a well trace gives all lengths: `... (m)` or `... GIVEN IN m-UNITS`.
fn unit(words: &str) -> Option<LengthUnit> {
    let in_brackets = || {
        let (_, behind) = words.rsplit_once('(')?;
        words.contains("COORDINATE").then_some(())?;
        behind.split_once(')').map(|(unit, _)| unit)
    };
    let in_words = || {
        let (before, _) = words.split_once("-UNITS")?;
        before.rsplit(' ').next()
    };
    LengthUnit::from_name(in_words().or_else(in_brackets)?)
}
