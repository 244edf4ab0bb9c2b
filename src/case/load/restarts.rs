//! The time steps of a case, of one restart or of several that one run was continued in.

use std::cmp::Ordering;
use std::path::Path;

use strataray_parsers::Warnings;
use strataray_parsers::calendar;
use strataray_parsers::case::RestartSource;
use strataray_parsers::restart::{self, Step};

/// Days within which two steps are one.
const ONE_MOMENT: f64 = 1.0 / 1440.0;
/// Days by which counts of days differ that are not counted from one start.
const ONE_START: f64 = 0.01;

/// Reads the restarts of a case, each by itself; what cannot be read becomes a note.
pub fn open(
    source: &RestartSource,
    notes: &mut Vec<String>,
    warnings: &mut Warnings,
) -> Vec<Vec<Step>> {
    let steps = match source {
        RestartSource::None => return Vec::new(),
        RestartSource::Unified(path) => restart::open_unified(path, warnings),
        RestartSource::Separate(files) => restart::open_separate(files, warnings),
        RestartSource::Several(sources) => {
            let runs = sources.iter();
            return runs.flat_map(|s| open(s, notes, warnings)).collect();
        }
    };
    match steps {
        Ok(steps) => vec![steps],
        Err(error) => {
            notes.push(format!("time steps were not loaded: {error}"));
            Vec::new()
        }
    }
}

/// The steps of several runs by date. A step that two runs have is that of the one that begins later, or else of the one
/// that was named later; notes say so.
pub fn merged(mut runs: Vec<Vec<Step>>, notes: &mut Vec<String>) -> Vec<Step> {
    if runs.len() < 2 {
        return runs.pop().unwrap_or_default();
    }
    let first = |run: &Vec<Step>| run.first().cloned();
    runs.sort_by(|a, b| match (first(a), first(b)) {
        (Some(a), Some(b)) => order(&a, &b),
        _ => Ordering::Equal,
    });
    let mut steps: Vec<Step> = Vec::new();
    for run in runs {
        note_overlap(&steps, &run, notes);
        steps.retain(|step| !run.iter().any(|later| is_same(step, later)));
        steps.extend(run);
    }
    steps.sort_by(order);
    count_from_first(&mut steps);
    steps
}

/// Says which steps of earlier runs a later one replaces, and which of them lie between its own.
fn note_overlap(steps: &[Step], run: &[Step], notes: &mut Vec<String>) {
    let (Some(begin), Some(last)) = (run.first(), steps.last()) else {
        return;
    };
    let [earlier, later] = [last, begin].map(|s| name(s.arrays.file().path()));
    let is_repeated = |step: &&Step| run.iter().any(|other| is_same(step, other));
    let repeated: Vec<&Step> = steps.iter().filter(is_repeated).collect();
    if let [one, rest @ ..] = &repeated[..] {
        let more = match rest.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        notes.push(format!(
            "{earlier} and {later} both have the step {}{more}: that of {later} is shown",
            when(one)
        ));
    }
    let is_after = |step: &&Step| order(step, begin) == Ordering::Greater && !is_repeated(step);
    let after = steps.iter().filter(is_after).count();
    if after > 0 {
        notes.push(format!(
            "{after} steps of {earlier} lie after {later} begins ({}): they are shown too",
            when(begin)
        ));
    }
}

/// Counts days from the start of the first run where a later one counts from another.
fn count_from_first(steps: &mut [Step]) {
    let Some(start) = steps.first().and_then(|s| Some(moment(s)? - s.days)) else {
        return;
    };
    for step in steps {
        if let Some(days) = moment(step).map(|now| now - start)
            && (days - step.days).abs() > ONE_START
        {
            step.days = days;
        }
    }
}

fn moment(step: &Step) -> Option<f64> {
    calendar::moment(&step.head.time())
}

fn when(step: &Step) -> String {
    match step.head.time() {
        date if date.is_empty() => format!("report {}", step.report),
        date => date,
    }
}

/// By date, and by report where dates are missing.
fn order(a: &Step, b: &Step) -> Ordering {
    match (moment(a), moment(b)) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        _ => a.report.cmp(&b.report),
    }
}

fn is_same(a: &Step, b: &Step) -> bool {
    match (moment(a), moment(b)) {
        (Some(a), Some(b)) => (a - b).abs() < ONE_MOMENT,
        _ => a.report == b.report,
    }
}

fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
