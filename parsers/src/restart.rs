//! Restarts: dynamic properties by report step, unified (UNRST) or one file a step (X0000, ...).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::cells::{CellArrays, Head};
use crate::error::{ParseError, Warnings};
use crate::records::RecordFile;

/// One report step of the global grid.
#[derive(Debug, Clone)]
pub struct Step {
    /// Report number: SEQNUM, or the number in the file's extension.
    pub report: u32,
    /// Days since the start, from DOUBHEAD.
    pub days: f64,
    /// What INTEHEAD says.
    pub head: Head,
    /// The step's arrays.
    pub arrays: CellArrays,
}

/// Opens a unified restart; every SEQNUM starts a step.
///
/// # Errors
/// When the file is damaged before its first complete array. A file that ends within an array is
/// read up to there, with a warning.
pub fn open_unified(path: &Path, warnings: &mut Warnings) -> Result<Vec<Step>, ParseError> {
    let file = Arc::new(RecordFile::open_lenient(path, warnings)?);
    let entries = file.entries();
    let starts: Vec<usize> = (0..entries.len())
        .filter(|&n| entries[n].name() == "SEQNUM")
        .collect();
    let mut steps = Vec::with_capacity(starts.len());
    for (n, &start) in starts.iter().enumerate() {
        let end = starts.get(n + 1).copied().unwrap_or(entries.len());
        let report = file.i32s(&entries[start])?.first().copied().unwrap_or(0);
        steps.push(step(&file, start..end, u32::try_from(report).unwrap_or(0))?);
    }
    Ok(steps)
}

/// Opens separate restart files, with their report numbers, in rising order.
///
/// # Errors
/// When a file is damaged before its first complete array.
pub fn open_separate(
    files: &[(u32, PathBuf)],
    warnings: &mut Warnings,
) -> Result<Vec<Step>, ParseError> {
    let open = |(report, path): &(u32, PathBuf)| {
        let file = Arc::new(RecordFile::open_lenient(path, warnings)?);
        let all = 0..file.entries().len();
        step(&file, all, *report)
    };
    files.iter().map(open).collect()
}

fn step(
    file: &Arc<RecordFile>,
    range: std::ops::Range<usize>,
    report: u32,
) -> Result<Step, ParseError> {
    let arrays = CellArrays::new(file, range, &["ENDLGR", "LGRSGONE"]);
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
        let each = usize::try_from(self.head.strings_a_well)
            .unwrap_or(0)
            .max(1);
        let wells = usize::try_from(self.head.wells).unwrap_or(0);
        let names = strings.chunks(each).take(wells).filter_map(|s| s.first());
        Ok(names.filter(|n| !n.is_empty()).cloned().collect())
    }
}
