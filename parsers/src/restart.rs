//! Restarts: dynamic properties by report step, unified (UNRST) or one file per step (X0000, ...).

use std::collections::HashSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::bytes::FileBytes;
use crate::calendar;
use crate::cells::{CellArrays, Head, write_arrays, write_heads};
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::records::{RecordFile, RecordWriter, refused};
use crate::wells::{self, Well};

/// One report step.
#[derive(Debug, Clone)]
pub struct Step {
    /// Report number, which need not start at 0 nor be without gaps: SEQNUM, or the number in the file's extension.
    pub report: u32,
    /// Days since the start, from DOUBHEAD; where that is missing from the dates.
    pub days: f64,
    /// What INTEHEAD says.
    pub head: Head,
    /// The step's arrays of the global grid, from which those of local grids are had.
    pub arrays: CellArrays,
}

/// Opens a unified restart; every SEQNUM starts a step, in a file without them every INTEHEAD.
///
/// Steps stay in file order, so that a report that a second run appended is there twice, with a
/// warning.
///
/// # Errors
/// When the file is damaged before its first complete array, or has no step. A file that ends
/// within an array is read up to there, with a warning.
pub fn open_unified(path: &Path, warnings: &mut Warnings) -> Result<Vec<Step>, ParseError> {
    unified(RecordFile::open_lenient(path, warnings)?, warnings)
}

/// As [`open_unified`], for a file that is in memory.
///
/// # Errors
/// As [`open_unified`].
pub fn unified_from_bytes(
    file: impl Into<FileBytes>,
    warnings: &mut Warnings,
) -> Result<Vec<Step>, ParseError> {
    unified(RecordFile::from_bytes_lenient(file, warnings)?, warnings)
}

fn unified(file: RecordFile, warnings: &mut Warnings) -> Result<Vec<Step>, ParseError> {
    let file = Arc::new(file);
    let path = file.path();
    let entries = file.entries();
    let mut starts = starts(&file, "SEQNUM");
    let is_numbered = !starts.is_empty();
    if !is_numbered {
        let message = "has no SEQNUM: steps are told apart by INTEHEAD and numbered from 0";
        warnings.push(path, At::File, message);
        starts = self::starts(&file, "INTEHEAD");
    }
    let mut steps: Vec<Step> = Vec::with_capacity(starts.len());
    let mut known = HashSet::new();
    for (n, &start) in starts.iter().enumerate() {
        let end = starts.get(n + 1).copied().unwrap_or(entries.len());
        let report = match is_numbered {
            true => file.i32s(&entries[start])?.first().copied().unwrap_or(0),
            false => i32::try_from(n).unwrap_or(0),
        };
        let step = step(&file, start..end, u32::try_from(report).unwrap_or(0))?;
        let at = || file.place(entries[start].offset);
        if step.arrays.find("INTEHEAD").is_none() {
            let message = format!("report {report} has no INTEHEAD and was left out");
            warnings.push(path, at(), message);
            continue;
        }
        if !known.insert(step.report) {
            let message = format!("report {report} is there more than once; all are kept");
            warnings.push(path, at(), message);
        }
        steps.push(step);
    }
    if steps.is_empty() {
        return Err(no_restart(path));
    }
    count_days(&mut steps, warnings);
    Ok(steps)
}

/// Where arrays called `name` stand outside the sections of local grids.
fn starts(file: &RecordFile, name: &str) -> Vec<usize> {
    let mut starts = Vec::new();
    let mut is_local = false;
    for (n, entry) in file.entries().iter().enumerate() {
        match entry.name() {
            "LGR" => is_local = true,
            "ENDLGR" | "LGRSGONE" => is_local = false,
            found if found == name && !is_local => starts.push(n),
            _ => {}
        }
    }
    starts
}

/// Counts days from the dates in steps that have none (no DOUBHEAD): from a step that has them, else from the first.
fn count_days(steps: &mut [Step], warnings: &mut Warnings) {
    let lacks = |step: &Step| step.arrays.find("DOUBHEAD").is_none();
    let moment = |step: &Step| calendar::moment(&step.head.time());
    let counted = steps
        .iter()
        .find(|step| !lacks(step) && moment(step).is_some());
    let start = counted.map(|step| moment(step).map(|now| now - step.days));
    let Some(start) = start.unwrap_or_else(|| steps.first().and_then(moment)) else {
        return;
    };
    let mut count = 0;
    for step in steps.iter_mut().filter(|step| lacks(step)) {
        if let Some(now) = calendar::moment(&step.head.time()) {
            step.days = now - start;
            count += 1;
        }
    }
    if let (true, Some(first)) = (count > 0, steps.first()) {
        let path = first.arrays.file().path();
        let message = "DOUBHEAD is missing: days are counted from the dates of the steps";
        warnings.push(path, At::File, message);
    }
}

/// Opens separate restart files, with their report numbers, in the order given.
///
/// A file that cannot be read is left out with a warning, as long as another one can.
///
/// # Errors
/// When none of the files can be read.
pub fn open_separate(
    files: &[(u32, PathBuf)],
    warnings: &mut Warnings,
) -> Result<Vec<Step>, ParseError> {
    let reports = files.iter().map(|(report, path)| (*report, path));
    let open = |path: &PathBuf, warnings: &mut Warnings| {
        RecordFile::open_one_of(path, files.len(), warnings)
    };
    separate(reports, open, warnings)
}

/// As [`open_separate`], for files that are in memory.
///
/// # Errors
/// As [`open_separate`].
pub fn separate_from_bytes(
    files: impl IntoIterator<Item = (u32, FileBytes)>,
    warnings: &mut Warnings,
) -> Result<Vec<Step>, ParseError> {
    separate(files, RecordFile::from_bytes_lenient, warnings)
}

fn separate<F>(
    files: impl IntoIterator<Item = (u32, F)>,
    open: impl Fn(F, &mut Warnings) -> Result<RecordFile, ParseError>,
    warnings: &mut Warnings,
) -> Result<Vec<Step>, ParseError> {
    let mut steps = Vec::new();
    let mut failed: Option<ParseError> = None;
    for (report, file) in files {
        match open(file, warnings).and_then(|file| single(report, file)) {
            Ok(step) => steps.push(step),
            Err(error) => {
                let keyword = Some(&error.keyword).filter(|k| !k.is_empty());
                let keyword = keyword.map_or(String::new(), |k| format!("{k}: "));
                let message = format!("{keyword}{}: report {report} was left out", error.message);
                warnings.push(&error.path, error.at, message);
                failed = failed.or(Some(error));
            }
        }
    }
    match failed {
        Some(error) if steps.is_empty() => Err(error),
        _ => {
            count_days(&mut steps, warnings);
            Ok(steps)
        }
    }
}

fn single(report: u32, file: RecordFile) -> Result<Step, ParseError> {
    let file = Arc::new(file);
    let all = 0..file.entries().len();
    let step = step(&file, all, report)?;
    match step.arrays.find("INTEHEAD") {
        Some(_) => Ok(step),
        None => Err(no_restart(file.path())),
    }
}

fn no_restart(path: &Path) -> ParseError {
    let message = "is missing; this is not a restart file";
    ParseError::of(
        ErrorKind::MissingKeyword,
        path,
        At::File,
        "INTEHEAD",
        message,
    )
}

fn step(
    file: &Arc<RecordFile>,
    range: std::ops::Range<usize>,
    report: u32,
) -> Result<Step, ParseError> {
    let arrays = CellArrays::new(file, range);
    let days = match arrays.find("DOUBHEAD") {
        Some(entry) => file.f64s(entry)?.first().copied().unwrap_or(0.0),
        None => 0.0,
    };
    Ok(Step {
        report,
        days,
        head: arrays.head()?,
        arrays,
    })
}

impl Step {
    /// Names of the wells, from ZWEL.
    ///
    /// # Errors
    /// When ZWEL is damaged.
    pub fn wells(&self) -> Result<Vec<String>, ParseError> {
        let Some(entry) = self.arrays.find("ZWEL") else {
            return Ok(Vec::new());
        };
        let strings = self.arrays.file().strings(entry)?;
        let each = usize::try_from(self.head.strings_per_well)
            .unwrap_or(0)
            .max(1);
        let wells = usize::try_from(self.head.wells).unwrap_or(0);
        let names = strings.chunks(each).take(wells).filter_map(|s| s.first());
        Ok(names.filter(|n| !n.is_empty()).cloned().collect())
    }
}

/// Writes a unified restart, step by step.
///
/// Call [`Self::finish`] at the end: it is what reports a failure to write the last bytes.
#[derive(Debug)]
pub struct RestartWriter<W: Write> {
    out: RecordWriter<W>,
}

impl<W: Write> RestartWriter<W> {
    /// A writer of a binary file to `out`, which needs no buffer of its own.
    pub fn new(out: W) -> Self {
        Self::to(RecordWriter::new(out))
    }

    /// A writer of a file of any form.
    pub fn to(out: RecordWriter<W>) -> Self {
        Self { out }
    }

    /// Writes a step: SEQNUM, the heads, the wells, and `arrays` between STARTSOL and ENDSOL.
    ///
    /// Each array has one value per active cell and is made when its turn comes; what `head` says of wells is not read
    /// but follows from `wells`. Of these, what is in local grids and their groups are not written.
    ///
    /// # Errors
    /// When writing fails, an array has not `head.active` values, a name is longer than 8 bytes, or
    /// the date is none.
    pub fn step<N: AsRef<str>>(
        &mut self,
        report: u32,
        days: f64,
        head: &Head,
        wells: &[Well],
        arrays: impl IntoIterator<Item = (N, Vec<f32>)>,
    ) -> io::Result<()> {
        let number = |n: usize| i32::try_from(n).map_err(|_| refused(format!("{n} wells")));
        let most = wells.iter().map(|well| well.completions.len()).max();
        let head = Head {
            wells: number(wells.len())?,
            connections_per_well: number(most.unwrap_or(0))?,
            strings_per_well: match wells.is_empty() {
                true => 0,
                false => number(wells::ITEMS.zwel)?,
            },
            ..head.clone()
        };
        let report = i32::try_from(report).map_err(|_| refused(format!("report {report}")))?;
        self.out.inte("SEQNUM", &[report])?;
        write_heads(&mut self.out, &head, days)?;
        wells::write(&mut self.out, wells)?;
        self.out.mess("STARTSOL")?;
        write_arrays(&mut self.out, &head, arrays)?;
        self.out.mess("ENDSOL")
    }

    /// Writes what is still in the buffer and hands back the underlying writer.
    ///
    /// # Errors
    /// When writing fails.
    pub fn finish(self) -> io::Result<W> {
        self.out.finish()
    }
}
