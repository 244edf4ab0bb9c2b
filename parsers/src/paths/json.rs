//! Well paths in JSON.

use std::path::Path;

use serde_json::Value;

use super::{Vertical, WellPath, settle, wrong};
use crate::error::{At, ErrorKind, ParseError};

/// True where a text begins as JSON does.
pub(super) fn is_json(text: &str) -> bool {
    text.trim_start().starts_with(['{', '['])
}

/// Reads one well, or a list of wells.
pub(super) fn read(path: &Path, text: &str, stem: &str) -> Result<Vec<WellPath>, ParseError> {
    let value: Value = serde_json::from_str(text).map_err(|error| {
        let at = At::Line {
            line: error.line().max(1),
            column: error.column().max(1),
        };
        let kind = match error.is_eof() {
            true => ErrorKind::Truncated,
            false => ErrorKind::Malformed,
        };
        ParseError::of(kind, path, at, "", format!("is no JSON: {error}"))
    })?;
    let wells = match value {
        Value::Array(wells) => wells,
        well => vec![well],
    };
    let mut paths = Vec::new();
    for well in &wells {
        paths.push(well_path(path, well, stem)?);
    }
    // ResInsight writes depths.
    settle(&mut paths, Some(Vertical::Depth));
    Ok(paths)
}

fn well_path(path: &Path, well: &Value, stem: &str) -> Result<WellPath, ParseError> {
    let name = well["name"].as_str().filter(|name| !name.is_empty());
    let name = name.unwrap_or(stem).to_owned();
    let missing = |what: &str| {
        let message = format!("{name}: {what}");
        wrong(ErrorKind::MissingKeyword, path, None, message)
    };
    let Some(list) = well["path"].as_array() else {
        return Err(missing("\"path\" is missing, the list of points"));
    };
    let mut points = Vec::new();
    let mut measured = Some(Vec::new());
    for (n, point) in list.iter().enumerate() {
        let [x, y, z] = ["x", "y", "z"].map(|key| point[key].as_f64());
        let (Some(x), Some(y), Some(z)) = (x, y, z) else {
            let message = format!(
                "point {} of \"path\" has not x, y and z, all numbers",
                n + 1
            );
            return Err(missing(&message));
        };
        points.push([x, y, z]);
        match (&mut measured, point["md"].as_f64()) {
            (Some(measured), Some(depth)) => measured.push(depth),
            _ => measured = None,
        }
    }
    Ok(WellPath {
        measured: measured.filter(|m| !m.is_empty()),
        name,
        points,
        unit: None,
        vertical: Vertical::Depth,
    })
}
