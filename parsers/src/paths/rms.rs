//! Wells of RMS in text.

use std::path::Path;

use super::line::{Line, lines};
use super::{Vertical, WellPath, settle, wrong};
use crate::error::{ErrorKind, ParseError};

/// What RMS writes where a log has no value.
const UNDEFINED: f64 = -999.0;

/// Lines before those of the logs.
const HEAD: usize = 4;

/// True where the first lines are a version, some text, a name with two or three numbers, and a count.
pub(super) fn is_rms(text: &str) -> bool {
    let head: Vec<&str> = lines(text).take(HEAD).map(|(_, line)| line).collect();
    let [version, _, well, count] = head.as_slice() else {
        return false;
    };
    let is_version = matches!(Line::of(version), Line::Numbers(v) if v.len() == 1 && v[0] > 0.0);
    is_version && well_name(well).is_some() && count.trim().parse::<usize>().is_ok()
}

/// The name before the two or three numbers at the end of a line.
fn well_name(line: &str) -> Option<String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let numbers = words.iter().rev();
    let numbers = numbers.take_while(|w| w.parse::<f64>().is_ok()).count();
    let name = &words[..words.len() - numbers.min(3)];
    (numbers >= 2 && !name.is_empty()).then(|| name.join(" "))
}

/// Reads the well.
pub(super) fn read(path: &Path, text: &str) -> Result<Vec<WellPath>, ParseError> {
    let mut all = lines(text).skip(2);
    let mut next = || all.next().map(|(_, line)| line).unwrap_or_default();
    let name = well_name(next()).unwrap_or_default();
    let count: usize = next().trim().parse().unwrap_or(0);
    let mut measured_log = None;
    for log in 0..count {
        let Some((_, line)) = all.next() else {
            let message = format!("the file ends after {log} of {count} lines that name logs");
            return Err(wrong(ErrorKind::Truncated, path, None, message));
        };
        let log_name = line.split_whitespace().next().unwrap_or_default();
        let is_measured = matches!(
            log_name.to_ascii_uppercase().as_str(),
            "MD" | "MDEPTH" | "M_MDEPTH" | "Q_MDEPTH"
        );
        if is_measured && measured_log.is_none() {
            measured_log = Some(3 + log);
        }
    }
    let mut well = WellPath {
        name,
        points: Vec::new(),
        measured: measured_log.map(|_| Vec::new()),
        unit: None,
        vertical: Vertical::Depth,
    };
    for (number, line) in all {
        let row = match Line::of(line) {
            Line::Numbers(row) if row.len() >= 3 => row,
            Line::Blank => continue,
            _ => {
                let message = "expected x, y, z and the values of logs, all of them numbers";
                return Err(wrong(ErrorKind::BadValue, path, Some(number), message));
            }
        };
        well.points.push([row[0], row[1], row[2]]);
        let depth = measured_log.and_then(|column| row.get(column));
        match (&mut well.measured, depth) {
            (Some(measured), Some(depth)) if *depth != UNDEFINED => measured.push(*depth),
            _ => well.measured = None,
        }
    }
    let mut wells = vec![well];
    settle(&mut wells, Some(Vertical::Depth));
    Ok(wells)
}
