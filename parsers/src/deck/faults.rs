//! FAULTS: named lists of cell faces.

use super::FaultFaces;
use super::header::{positive, real};
use super::lexer::{Cursor, Item, Mistake, shown};
use super::skip::ends_records;
use crate::error::ErrorKind;

/// Reads records up to the empty one.
pub(super) fn faults(cursor: &mut Cursor) -> Result<Vec<(usize, FaultFaces)>, Mistake> {
    let mut faults = Vec::new();
    loop {
        let items = cursor.record()?;
        let Some(first) = items.first() else {
            return Ok(faults);
        };
        faults.push((first.at, fault(&items, first.at)?));
    }
}

/// MULTFLT: names, which may end with `*`, and transmissibility multipliers, up to the empty record.
pub(super) fn multipliers(cursor: &mut Cursor) -> Result<Vec<(String, f64)>, Mistake> {
    let mut multipliers = Vec::new();
    while cursor.skip_blank() && !ends_records(cursor) {
        let items = cursor.record()?;
        let [name, rest @ ..] = items.as_slice() else {
            break;
        };
        let name = String::from_utf8_lossy(name.text.unwrap_or_default()).into_owned();
        let given = rest.first().filter(|item| item.text.is_some());
        multipliers.push((name, given.map_or(Ok(1.0), real)?));
    }
    Ok(multipliers)
}

/// The last multiplier that is given for a fault.
pub(super) fn multiplier_of(fault: &str, multipliers: &[(String, f64)]) -> Option<f64> {
    let is_meant = |name: &str| match name.strip_suffix('*') {
        Some(start) => fault.starts_with(start),
        None => fault == name,
    };
    let meant = multipliers.iter().rev().find(|(name, _)| is_meant(name));
    meant.map(|(_, multiplier)| *multiplier)
}

fn fault(items: &[Item], at: usize) -> Result<FaultFaces, Mistake> {
    let [name, i1, i2, j1, j2, k1, k2, face] = items else {
        let message = format!(
            "expected 8 items (name, I1 I2, J1 J2, K1 K2, face), found {}",
            items.len()
        );
        return Err(Mistake::new(ErrorKind::WrongCount, at, message));
    };
    Ok(FaultFaces {
        name: String::from_utf8_lossy(name.text.unwrap_or_default()).into_owned(),
        i: range(i1, i2)?,
        j: range(j1, j2)?,
        k: range(k1, k2)?,
        face: face_name(face)?,
        multiplier: None,
    })
}

fn range(first: &Item, last: &Item) -> Result<[usize; 2], Mistake> {
    let range = [positive(first)?, positive(last)?];
    if range[0] > range[1] {
        let message = format!("the range {} to {} runs backward", range[0], range[1]);
        return Err(Mistake::new(ErrorKind::BadValue, first.at, message));
    }
    Ok(range)
}

fn face_name(item: &Item) -> Result<String, Mistake> {
    let name = shown(item.text.unwrap_or(b"*")).to_ascii_uppercase();
    let (axis, side) = name.split_at_checked(1).unwrap_or_default();
    if "XYZIJK".contains(axis) && !axis.is_empty() && matches!(side, "" | "+" | "-") {
        return Ok(name);
    }
    let message =
        format!("'{name}' is not a face; expected X, Y, Z, I, J or K, with + or - after it");
    Err(Mistake::new(ErrorKind::BadValue, item.at, message))
}

/// What of `fault` lies outside a grid of `dims` cells, in words.
pub(super) fn outside(fault: &FaultFaces, dims: [usize; 3]) -> Option<String> {
    let ranges = [("I", fault.i), ("J", fault.j), ("K", fault.k)];
    ranges.iter().zip(dims).find_map(|((axis, range), dim)| {
        (range[1] > dim).then(|| format!("{axis} {} of {dim}", range[1]))
    })
}
