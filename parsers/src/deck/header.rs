//! The short keywords of a grid: dimensions, map axes, units, orientation.

use super::GridUnit;
use super::edit::CellBox;
use super::lexer::{Item, Mistake, shown};
use super::numbers::number;
use crate::error::ErrorKind;
use crate::geometry::MOST_CELLS;

/// SPECGRID or DIMENS: three counts, for SPECGRID also coordinate systems and `T` for a radial grid, which is the second
/// that is given.
pub(super) fn dims(items: &[Item], at: usize) -> Result<([usize; 3], bool), Mistake> {
    let mut dims = [0; 3];
    for (axis, dim) in dims.iter_mut().enumerate() {
        let item = items.get(axis).ok_or_else(|| {
            Mistake::new(ErrorKind::WrongCount, at, "expected three numbers of cells")
        })?;
        *dim = positive(item)?;
    }
    let mut is_radial = false;
    // The number of coordinate systems, which some writers leave out, and the letter behind it.
    for item in items.iter().skip(3).take(2) {
        match item.text.and_then(|text| text.first()) {
            None => {}
            Some(b'T' | b't') => is_radial = true,
            Some(b'F' | b'f') => break,
            Some(_) if positive(item)? != 1 => {
                return Err(Mistake::new(ErrorKind::Unsupported, item.at, SYSTEMS));
            }
            Some(_) => {}
        }
    }
    let cells = dims
        .iter()
        .try_fold(1_usize, |cells, &dim| cells.checked_mul(dim));
    if cells.is_none_or(|cells| cells > MOST_CELLS) {
        let [ni, nj, nk] = dims;
        return Err(Mistake::new(
            ErrorKind::TooLarge,
            at,
            format!("{ni} x {nj} x {nk} cells are more than a grid can have (2^31)"),
        ));
    }
    Ok((dims, is_radial))
}

const SYSTEMS: &str = "grids with more than one coordinate system (NUMRES) are not read from text: run the simulator and open the EGRID";

/// A whole number of at least 1.
pub(super) fn positive(item: &Item) -> Result<usize, Mistake> {
    let text = item.text.unwrap_or(b"*");
    std::str::from_utf8(text)
        .ok()
        .and_then(|text| text.parse::<usize>().ok())
        .filter(|&number| number > 0)
        .ok_or_else(|| {
            Mistake::new(
                ErrorKind::BadValue,
                item.at,
                format!(
                    "expected a whole number of at least 1, found '{}'",
                    shown(text)
                ),
            )
        })
}

/// A whole number, as of a region.
pub(super) fn whole(item: &Item) -> Result<i32, Mistake> {
    let text = item.text.unwrap_or(b"*");
    let number = std::str::from_utf8(text).ok().and_then(|t| t.parse().ok());
    number.ok_or_else(|| {
        let message = format!("expected a whole number, found '{}'", shown(text));
        Mistake::new(ErrorKind::BadValue, item.at, message)
    })
}

/// MAPAXES: six finite numbers.
pub(super) fn map_axes(items: &[Item], at: usize) -> Result<[f64; 6], Mistake> {
    if items.len() != 6 {
        return Err(Mistake::new(
            ErrorKind::WrongCount,
            at,
            format!("expected 6 values, found {}", items.len()),
        ));
    }
    let mut axes = [0.0; 6];
    for (axis, item) in axes.iter_mut().zip(items) {
        *axis = real(item)?;
    }
    Ok(axes)
}

/// A finite number.
pub(super) fn real(item: &Item) -> Result<f64, Mistake> {
    let text = item.text.unwrap_or(b"*");
    let value = number(text).filter(|value| value.is_finite());
    value.ok_or_else(|| {
        Mistake::new(
            ErrorKind::BadValue,
            item.at,
            format!("'{}' is not a number", shown(text)),
        )
    })
}

/// ADDZCORN: what is added, and to which cells where a box is given; `None` where more is asked for.
pub(super) fn depth_shift(items: &[Item]) -> Result<Option<(f64, Option<CellBox>)>, Mistake> {
    let [value, rest @ ..] = items else {
        return Ok(None);
    };
    let more = rest.get(6..).unwrap_or_default();
    let is_all = |item: &Item| {
        item.text
            .is_none_or(|text| text.eq_ignore_ascii_case(b"ALL"))
    };
    match more.iter().all(is_all) {
        true => Ok(Some((real(value)?, CellBox::read(rest)?))),
        false => Ok(None),
    }
}

/// The first item in upper case, if it is not left to its default.
pub(super) fn name(items: &[Item], index: usize) -> Option<String> {
    let text = items.get(index)?.text?;
    Some(shown(text).to_ascii_uppercase()).filter(|name| !name.is_empty())
}

/// GRIDUNIT: the unit, and `MAP` where coordinates are map coordinates; METRES where defaulted.
pub(super) fn grid_unit(items: &[Item]) -> GridUnit {
    GridUnit {
        name: name(items, 0).unwrap_or_else(|| "METRES".to_owned()),
        is_map: name(items, 1).is_some_and(|system| system == "MAP"),
    }
}

/// GDORIENT: five words with their defaults.
pub(super) fn gdorient(items: &[Item]) -> [String; 5] {
    let defaults = ["INC", "INC", "INC", "DOWN", "RIGHT"];
    std::array::from_fn(|index| name(items, index).unwrap_or_else(|| defaults[index].to_owned()))
}
