//! ESMRY: an array for each vector, as OPM Flow writes it (`opm/io/eclipse/ExtSmryOutput.cpp`): START, KEYCHECK with a
//! key for each vector, UNITS, RSTEP (numbers of reports, 0 between them), TSTEP, then V0, V1 and so on.

use super::vector::from_key;
use super::{Summary, TimeStep, Values, restart, start};
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::records::{Entry, RecordFile};

pub(super) fn read(file: RecordFile, warnings: &mut Warnings) -> Result<Summary, ParseError> {
    let Some(keys) = file.find("KEYCHECK") else {
        let message = "is missing; this is no ESMRY file";
        let kind = ErrorKind::MissingKeyword;
        return Err(ParseError::of(
            kind,
            file.path(),
            At::File,
            "KEYCHECK",
            message,
        ));
    };
    let keys = file.strings(keys)?;
    let units = match file.find("UNITS") {
        Some(entry) => file.strings(entry)?,
        None => Vec::new(),
    };
    let integers = |name: &str| match file.find(name) {
        Some(entry) => file.i32s(entry),
        None => Ok(Vec::new()),
    };
    let (reports, numbers) = (integers("RSTEP")?, integers("TSTEP")?);
    let is_value = |e: &&Entry| number(e).is_some() && e.is_numeric();
    let found: Vec<Entry> = file.entries().iter().filter(is_value).copied().collect();
    let count = found.first().map_or(0, |e| e.count);
    // They stand in order; what is missing or has another length ends the list.
    let whole = found.iter().enumerate();
    let fits = whole.take_while(|(n, e)| number(e) == Some(*n) && e.count == count);
    let entries: Vec<Entry> = fits.map(|(_, e)| *e).take(keys.len()).collect();
    if entries.len() < keys.len() {
        let message = format!(
            "{} of {} vectors were left out: their values are not whole",
            keys.len() - entries.len(),
            keys.len()
        );
        warnings.push(file.path(), At::File, message);
    }
    let unit = |n: usize| units.get(n).map_or("", String::as_str);
    let vectors = keys.iter().take(entries.len()).enumerate();
    let mut summary = Summary {
        vectors: vectors.map(|(n, key)| from_key(key, unit(n), n)).collect(),
        steps: Vec::new(),
        start: start(&file, "START", |[minute, second]| 60.0 * minute + second)?,
        dims: [0; 3],
        units: None,
        restart: restart(&file)?,
        values: Values::ByVector(file, entries),
    };
    let path = match &summary.values {
        Values::ByVector(file, _) => file.path().to_owned(),
        Values::ByStep(..) => Default::default(),
    };
    let days = summary.days(&path)?;
    summary.steps = steps(&days, &reports, &numbers);
    Ok(summary)
}

/// The number of a vector's array: V12 is 12.
fn number(entry: &Entry) -> Option<usize> {
    entry.name().strip_prefix('V')?.parse().ok()
}

fn steps(days: &[f64], reports: &[i32], numbers: &[i32]) -> Vec<TimeStep> {
    let mut steps = Vec::with_capacity(days.len());
    // A step between reports is on the way to the next one.
    let mut next = 0;
    for (n, &days) in days.iter().enumerate().rev() {
        let report = reports.get(n).and_then(|r| u32::try_from(*r).ok());
        let report = report.unwrap_or(0);
        next = if report > 0 { report } else { next };
        steps.push(TimeStep {
            days,
            number: numbers.get(n).copied().unwrap_or(0),
            report: next,
            is_report: report > 0,
        });
    }
    steps.reverse();
    steps
}
