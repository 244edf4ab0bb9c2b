//! The second step: with the dimensions known, turns the arrays into numbers and checks their lengths.

use std::collections::HashMap;
use std::path::Path;

use rayon::prelude::*;

use super::array::{Rule, Runs, runs};
use super::lexer::{Mistake, keyword};
use super::scan::{Block, Found, product_text};
use super::skip::{is_common_property, is_read};
use super::{DeckProperty, FaultFaces, Grdecl, faults};
use crate::error::{At, ParseError, Warnings};

/// Every value must be there and be a finite number.
const GEOMETRY: Rule = Rule {
    default: None,
    undefined: None,
};
/// Left out or undefined values become NaN.
const PROPERTY: Rule = Rule {
    default: Some(f64::NAN),
    undefined: Some(f64::NAN),
};
/// A cell is active where nothing else is said.
const ACTIVITY: Rule = Rule {
    default: Some(1.0),
    undefined: None,
};

/// Most cells for each byte of text; a deck needs some text for each column and each layer.
const MOST_CELLS_A_BYTE: usize = 1000;
/// A one-record keyword with more values than this and half a value a cell is taken for a property gone wrong.
const PROPERTY_LIKE: usize = 1000;

/// Builds the grid of what the scan found in the deck at `path`.
pub(super) fn assemble(
    path: &Path,
    mut found: Found,
    warnings: &mut Warnings,
) -> Result<Grdecl, ParseError> {
    let (Some(dims), Some(coord), Some(zcorn)) = (found.dims, &found.coord, &found.zcorn) else {
        return Err(swallowed(&found).unwrap_or_else(|| missing(path, &found)));
    };
    let [ni, nj, nk] = dims;
    let cells = ni * nj * nk;
    if cells / MOST_CELLS_A_BYTE > found.bytes {
        let message = format!(
            "{} cells cannot be described by {} bytes of text",
            product_text(dims),
            found.bytes
        );
        return Err(ParseError::new(path, At::File, "SPECGRID", message));
    }
    let pillars = (ni + 1).saturating_mul(nj + 1);
    let coord = array(coord, GEOMETRY, pillars.saturating_mul(6))?;
    let zcorn = array(zcorn, GEOMETRY, cells.saturating_mul(8))?;
    let actnum = found
        .actnum
        .take()
        .map(|block| activity(&block, cells))
        .transpose()?;
    let properties = properties(std::mem::take(&mut found.candidates), cells, warnings)?;
    let faults = inside(std::mem::take(&mut found.faults), dims, warnings);
    Ok(Grdecl {
        dims,
        coord,
        zcorn,
        actnum,
        map_axes: found.map_axes,
        map_units: found.map_units,
        grid_unit: found.grid_unit,
        gdorient: found.gdorient,
        unit_system: found.unit_system,
        properties,
        faults,
        files: found.files,
    })
}

/// The sentence that names what a grid needs and the deck does not give.
fn missing(path: &Path, found: &Found) -> ParseError {
    let parts = [
        ("SPECGRID (or DIMENS)", found.dims.is_none()),
        ("COORD", found.coord.is_none()),
        ("ZCORN", found.zcorn.is_none()),
    ];
    let absent: Vec<_> = parts
        .iter()
        .filter(|part| part.1)
        .map(|part| part.0)
        .collect();
    let message = if found.block_centered && found.zcorn.is_none() {
        "the grid is given by DX, DY, DZ and TOPS; only corner-point grids (COORD, ZCORN) \
         are read from text; run the simulator and open the EGRID"
            .to_owned()
    } else {
        format!("no corner-point grid: {} missing", absent.join(" and "))
    };
    ParseError::new(path, At::File, "", message)
}

/// The array without a closing `/` that took a missing keyword for its own data, if there is one.
fn swallowed(found: &Found) -> Option<ParseError> {
    let arrays = [&found.coord, &found.zcorn, &found.actnum];
    let blocks = arrays.into_iter().flatten().chain(&found.candidates);
    blocks.into_iter().find_map(|block| {
        let mistake = numbers(block, PROPERTY).err()?;
        is_swallowed_keyword(block, &mistake).then(|| error(block, mistake))
    })
}

/// Reads an array that must have `expected` values.
fn array(block: &Block, rule: Rule, expected: usize) -> Result<Vec<f64>, ParseError> {
    let runs = numbers(block, rule).map_err(|mistake| error(block, mistake))?;
    expand(block, runs, expected)
}

fn numbers(block: &Block, rule: Rule) -> Result<Runs, Mistake> {
    let start = block.data.start;
    runs(&block.source.text()[block.data.clone()], rule).map_err(|mistake| mistake.moved(start))
}

fn expand(block: &Block, runs: Runs, expected: usize) -> Result<Vec<f64>, ParseError> {
    let failed = |message| block.source.error(block.data.end, &block.name, message);
    if runs.count != expected {
        return Err(failed(format!(
            "expected {expected} values, found {}",
            runs.count
        )));
    }
    runs.expand()
        .ok_or_else(|| failed(format!("not enough memory for {expected} values")))
}

/// Names the place of `mistake`, and the missing slash where a keyword stands there.
fn error(block: &Block, mut mistake: Mistake) -> ParseError {
    if is_swallowed_keyword(block, &mistake) {
        mistake.message = format!(
            "{}; is the closing / of {} missing?",
            mistake.message, block.name
        );
    }
    block.source.mistake(&block.name, mistake)
}

fn is_swallowed_keyword(block: &Block, mistake: &Mistake) -> bool {
    keyword(block.source.text(), mistake.at)
        .is_some_and(|found| found.alone || is_read(&found.name))
}

fn activity(block: &Block, cells: usize) -> Result<Vec<i32>, ParseError> {
    let values = array(block, ACTIVITY, cells)?;
    let whole = |&value: &f64| value.fract() == 0.0 && (0.0..=255.0).contains(&value);
    if let Some(cell) = values.par_iter().position_first(|value| !whole(value)) {
        let message = format!(
            "the value {} of cell {} is not 0 or another small whole number",
            values[cell],
            cell + 1
        );
        return Err(block.source.error(block.at, &block.name, message));
    }
    #[allow(
        clippy::cast_possible_truncation,
        reason = "all values are whole and at most 255"
    )]
    Ok(values.par_iter().map(|&value| value as i32).collect())
}

/// Those candidates that have one value a cell; the last one where a name comes twice.
fn properties(
    candidates: Vec<Block>,
    cells: usize,
    warnings: &mut Warnings,
) -> Result<Vec<DeckProperty>, ParseError> {
    let mut properties: Vec<Option<DeckProperty>> = Vec::new();
    let mut places: HashMap<String, usize> = HashMap::new();
    for block in candidates {
        let Some(values) = property(&block, cells, warnings)? else {
            continue;
        };
        let name = block.name.clone();
        if let Some(earlier) = places.insert(name.clone(), properties.len()) {
            properties[earlier] = None;
            let message = format!("{name} is given again; the last one is used");
            warnings.push(block.source.path(), block.source.at(block.at), message);
        }
        properties.push(Some(DeckProperty { name, values }));
    }
    Ok(properties.into_iter().flatten().collect())
}

/// The values of a property; `None` for a keyword that is none.
fn property(
    block: &Block,
    cells: usize,
    warnings: &mut Warnings,
) -> Result<Option<Vec<f64>>, ParseError> {
    let common = is_common_property(&block.name);
    let runs = match numbers(block, PROPERTY) {
        Ok(runs) => runs,
        Err(mistake) if common || is_swallowed_keyword(block, &mistake) => {
            return Err(error(block, mistake));
        }
        // Numbers and words in one record: no array.
        Err(_) => return Ok(None),
    };
    if runs.count == cells {
        return expand(block, runs, cells).map(Some);
    }
    if common || (runs.count > PROPERTY_LIKE && runs.count >= cells / 2) {
        let message = format!(
            "{} has {} values where the grid has {cells} cells; it is left out",
            block.name, runs.count
        );
        warnings.push(
            block.source.path(),
            block.source.at(block.data.end),
            message,
        );
    }
    Ok(None)
}

/// The fault faces that lie inside the grid.
pub(super) fn inside(
    faults: Vec<(std::rc::Rc<super::source::Source>, usize, FaultFaces)>,
    dims: [usize; 3],
    warnings: &mut Warnings,
) -> Vec<FaultFaces> {
    let mut kept = Vec::with_capacity(faults.len());
    for (source, at, fault) in faults {
        if let Some(place) = faults::outside(&fault, dims) {
            let message = format!(
                "a face of fault {} lies outside the grid ({place}); it is left out",
                fault.name
            );
            warnings.push(source.path(), source.at(at), message);
        } else {
            kept.push(fault);
        }
    }
    kept
}
