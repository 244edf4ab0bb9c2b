//! Summary vectors: curves over time of the field, groups, wells, regions and cells.
//!
//! SMSPEC says what the vectors are (KEYWORDS, WGNAMES or NAMES, NUMS, UNITS, and LGRS with NUMLX, NUMLY, NUMLZ for
//! local grids), UNSMRY or one file per report (S0001, ...) has all of their values at a time step in each PARAMS.
//! RESTART names the run that one goes on from, which is not opened here. ESMRY, as OPM Flow writes it, has an array for each vector instead. Formatted twins are read alike. A vector is
//! decoded when asked for, without the others.
//!
//! ```
//! use strataray_parsers::{Warnings, records::RecordWriter, summary::Summary};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut spec = RecordWriter::new(Vec::new());
//! spec.chars("KEYWORDS", &["TIME", "WOPR"])?;
//! spec.chars("WGNAMES", &[":+:+:+:+", "P1"])?;
//! spec.inte("NUMS", &[0, 1])?;
//! spec.chars("UNITS", &["DAYS", "SM3/DAY"])?;
//! spec.inte("STARTDAT", &[1, 1, 2000])?;
//! let mut data = RecordWriter::new(Vec::new());
//! data.inte("SEQHDR", &[1])?;
//! data.inte("MINISTEP", &[0])?;
//! data.real("PARAMS", &[31.5, 120.0])?;
//!
//! let [spec, data] = [("A.SMSPEC", spec.finish()?), ("A.UNSMRY", data.finish()?)];
//! let summary = Summary::from_bytes(spec, data, &mut Warnings::default())?;
//! let rate = summary.find("WOPR:P1").ok_or("no WOPR")?;
//! assert_eq!(summary.values(rate)?, [120.0]);
//! assert_eq!(summary.dates(), ["2000-02-01 12:00"]);
//! # Ok(())
//! # }
//! ```

mod extended;
mod vector;

use std::path::Path;

use crate::bytes::FileBytes;
use crate::calendar;
use crate::case::SummarySource;
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::records::{Entry, RecordFile};
use crate::units::UnitSystem;

pub use vector::{Subject, Vector};

/// A day as which the year of the vector YEARS counts.
const DAYS_PER_YEAR: f64 = 365.25;

/// The vectors of a case, and their times.
#[derive(Debug)]
pub struct Summary {
    /// The vectors, in the order of the file; places without a keyword are left out.
    pub vectors: Vec<Vector>,
    /// Time steps, rising.
    pub steps: Vec<TimeStep>,
    /// Start of the simulation, in days since 1970, where it is known.
    pub start: Option<f64>,
    /// Cells of the grid along i, j and k; zero where they are not known.
    pub dims: [i32; 3],
    /// Unit system, where it is known.
    pub units: Option<UnitSystem>,
    /// RESTART: the run that this one goes on from, as a path without an ending; `None` of one from the start.
    pub restart: Option<String>,
    values: Values,
}

/// A time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeStep {
    /// Days since the start.
    pub days: f64,
    /// Number of the time step.
    pub number: i32,
    /// Number of the report that it is on the way to.
    pub report: u32,
    /// True for the last one of a report.
    pub is_report: bool,
}

/// Where the values are.
#[derive(Debug)]
enum Values {
    /// All of a time step beside each other: in which of the files, and its PARAMS.
    ByStep(Vec<RecordFile>, Vec<(usize, Entry)>),
    /// All of a vector beside each other.
    ByVector(RecordFile, Vec<Entry>),
}

impl Summary {
    /// Opens the files that [`crate::case::find_summary`] finds.
    ///
    /// A file that ends within an array is read up to there, with a warning.
    ///
    /// # Errors
    /// When a file is damaged, or there are no keywords, no times, or no values.
    pub fn open(source: &SummarySource, warnings: &mut Warnings) -> Result<Self, ParseError> {
        match source {
            SummarySource::Unified { spec, data } => {
                let data = RecordFile::open_lenient(data, warnings)?;
                Self::by_step(&RecordFile::open(spec)?, vec![(None, data)], warnings)
            }
            SummarySource::Separate { spec, data } => {
                let mut files = Vec::with_capacity(data.len());
                for (report, path) in data {
                    let file = RecordFile::open_one_of(path, data.len(), warnings)?;
                    files.push((Some(*report), file));
                }
                Self::by_step(&RecordFile::open(spec)?, files, warnings)
            }
            SummarySource::Extended(path) => {
                extended::read(RecordFile::open_lenient(path, warnings)?, warnings)
            }
        }
    }

    /// As [`Self::open`], for SMSPEC and UNSMRY in memory.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn from_bytes(
        spec: impl Into<FileBytes>,
        data: impl Into<FileBytes>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let data = RecordFile::from_bytes_lenient(data, warnings)?;
        let spec = RecordFile::from_bytes(spec)?;
        Self::by_step(&spec, vec![(None, data)], warnings)
    }

    /// As [`Self::open`], for SMSPEC and one file per report, with its number, in memory.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn separate_from_bytes(
        spec: impl Into<FileBytes>,
        data: Vec<(u32, FileBytes)>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let mut files = Vec::with_capacity(data.len());
        for (report, file) in data {
            let file = RecordFile::from_bytes_lenient(file, warnings)?;
            files.push((Some(report), file));
        }
        Self::by_step(&RecordFile::from_bytes(spec)?, files, warnings)
    }

    /// As [`Self::open`], for an ESMRY in memory.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn extended_from_bytes(
        file: impl Into<FileBytes>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        extended::read(RecordFile::from_bytes_lenient(file, warnings)?, warnings)
    }

    fn by_step(
        spec: &RecordFile,
        files: Vec<(Option<u32>, RecordFile)>,
        warnings: &mut Warnings,
    ) -> Result<Self, ParseError> {
        let names = vector::Names::read(spec)?;
        let (params, mut steps) = params(&files, names.count(), warnings)?;
        let mut summary = Self {
            vectors: names.vectors(),
            steps: Vec::new(),
            start: start(spec, "STARTDAT", |[minute, micros]| {
                60.0 * minute + micros / 1e6
            })?,
            dims: names.dims,
            units: names.units_of_case,
            restart: restart(spec)?,
            values: Values::ByStep(files.into_iter().map(|(_, file)| file).collect(), params),
        };
        let days = summary.days(spec.path())?;
        for (step, days) in steps.iter_mut().zip(days) {
            step.days = days;
        }
        summary.steps = steps;
        Ok(summary)
    }

    /// Days of all time steps, from TIME, or else from YEARS.
    fn days(&self, path: &Path) -> Result<Vec<f64>, ParseError> {
        let (vector, factor) = match (self.find("TIME"), self.find("YEARS")) {
            // Laboratory cases count hours.
            (Some(time), _) if time.unit == "HOURS" => (time, 1.0 / 24.0),
            (Some(time), _) => (time, 1.0),
            (None, Some(years)) => (years, DAYS_PER_YEAR),
            (None, None) => {
                let message = "is missing, and so is YEARS: the vectors have no times";
                let kind = ErrorKind::MissingKeyword;
                return Err(ParseError::of(kind, path, At::File, "TIME", message));
            }
        };
        let values = self.values(vector)?;
        Ok(values.into_iter().map(|v| f64::from(v) * factor).collect())
    }

    /// The vector that is called so: a keyword, and behind colons what it is of, as [`Vector`] is shown.
    pub fn find(&self, key: &str) -> Option<&Vector> {
        self.vectors.iter().find(|v| v.to_string() == key)
    }

    /// The values of a vector, one for each time step.
    ///
    /// # Errors
    /// When they are damaged.
    pub fn values(&self, vector: &Vector) -> Result<Vec<f32>, ParseError> {
        match &self.values {
            Values::ByStep(files, params) => {
                let value =
                    |(file, entry): &(usize, Entry)| files[*file].f32_at(entry, vector.place);
                params.iter().map(value).collect()
            }
            Values::ByVector(file, entries) => match entries.get(vector.place) {
                Some(entry) => file.f32s(entry),
                None => Ok(Vec::new()),
            },
        }
    }

    /// Date of each time step, with the time of day where it is not midnight; empty where the start is not known.
    pub fn dates(&self) -> Vec<String> {
        let start = self.start;
        let date = |step: &TimeStep| start.map(|start| calendar::text(start + step.days));
        self.steps.iter().filter_map(date).collect()
    }
}

/// The PARAMS of all files and their steps, without times yet.
type Params = (Vec<(usize, Entry)>, Vec<TimeStep>);

fn params(
    files: &[(Option<u32>, RecordFile)],
    count: usize,
    warnings: &mut Warnings,
) -> Result<Params, ParseError> {
    let mut params = Vec::new();
    let mut steps: Vec<TimeStep> = Vec::new();
    let (mut report, mut number) = (0, 0);
    for (n, (named, file)) in files.iter().enumerate() {
        let mut misfits = 0;
        for entry in file.entries() {
            match entry.name() {
                "SEQHDR" => {
                    report = named.unwrap_or(report + 1);
                    steps
                        .iter_mut()
                        .last()
                        .into_iter()
                        .for_each(|s| s.is_report = true);
                }
                "MINISTEP" => number = file.i32s(entry)?.first().copied().unwrap_or(number + 1),
                "PARAMS" if entry.count == count as u64 && entry.is_numeric() => {
                    params.push((n, *entry));
                    steps.push(TimeStep {
                        days: 0.0,
                        number,
                        report,
                        is_report: false,
                    });
                }
                "PARAMS" => misfits += 1,
                _ => {}
            }
        }
        if misfits > 0 {
            let message = format!(
                "{misfits} time steps were left out: their PARAMS have another number of values than the {count} that KEYWORDS names"
            );
            warnings.push(file.path(), At::File, message);
        }
    }
    match (steps.last_mut(), files.first()) {
        (None, Some((_, file))) => {
            let kind = ErrorKind::MissingKeyword;
            let message = "is missing: there is no time step";
            Err(ParseError::of(
                kind,
                file.path(),
                At::File,
                "PARAMS",
                message,
            ))
        }
        (last, _) => {
            last.into_iter().for_each(|step| step.is_report = true);
            Ok((params, steps))
        }
    }
}

/// The run that another one goes on from; its path stands in strings of eight letters each.
fn restart(file: &RecordFile) -> Result<Option<String>, ParseError> {
    let Some(entry) = file.find("RESTART") else {
        return Ok(None);
    };
    let parts = file.strings(entry)?;
    // Blanks at the end of a part are in the path where another one follows.
    let whole: String = parts.iter().map(|part| format!("{part:<8}")).collect();
    Ok(Some(whole.trim().to_owned()).filter(|path| !path.is_empty()))
}

/// Days since 1970 of an array of day, month, year, hour, and what `seconds` makes seconds of: the next two items.
fn start(
    file: &RecordFile,
    name: &str,
    seconds: impl Fn([f64; 2]) -> f64,
) -> Result<Option<f64>, ParseError> {
    let Some(entry) = file.find(name) else {
        return Ok(None);
    };
    let items = file.i32s(entry)?;
    let item = |n: usize| items.get(n).copied().unwrap_or(0);
    let date = calendar::moment(&format!("{:04}-{:02}-{:02}", item(2), item(1), item(0)));
    let clock = 3600.0 * f64::from(item(3)) + seconds([item(4), item(5)].map(f64::from));
    Ok(date.map(|date| date + clock / 86_400.0))
}
