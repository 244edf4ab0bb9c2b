//! The second step: with the dimensions known, turns the arrays into numbers and checks their lengths.

use std::path::Path;

use super::array::{Rule, Runs, runs};
use super::cells::{CellArray, CellArrays};
use super::edit::{Edit, Place, cells_of};
use super::lexer::{Mistake, keyword};
use super::refine::{self, Corners};
use super::scan::{Block, Data, DepthShift, Found, product_text};
use super::skip::is_read;
use super::{DeckCells, FaultFaces, Grdecl, GridUnit, blocks, faults};
use crate::arrays::is_table;
use crate::egrid::{Egrid, PorosityModel};
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::geometry::{Lengths, first_not, unaddressable};
use crate::radial;

/// Every value must be there and be a finite number.
pub(super) const GEOMETRY: Rule = Rule {
    default: None,
    undefined: None,
};
/// Left out or undefined values become NaN.
pub(super) const PROPERTY: Rule = Rule {
    default: Some(f64::NAN),
    undefined: Some(f64::NAN),
};
/// A cell is active where nothing else is said.
pub(super) const ACTIVITY: Rule = Rule {
    default: Some(1.0),
    undefined: None,
};

/// Most cells for each byte of text; a deck needs some text for each column and each layer.
pub(super) const MOST_CELLS_PER_BYTE: usize = 1000;

/// Builds the grid of what the scan found in the deck at `path`.
pub(super) fn assemble(
    path: &Path,
    mut found: Found,
    warnings: &mut Warnings,
) -> Result<Grdecl, ParseError> {
    let file = named_grid(&mut found, warnings)?;
    let Some(all) = found.dims else {
        return Err(swallowed(&found).unwrap_or_else(|| missing(path, &found)));
    };
    let dims = shown_dims(path, all, found.porosity_model)?;
    let lengths = checked_lengths(path, all)?;
    if file.is_none() {
        check_text(path, all, found.bytes)?;
    }
    let depths = 8 * dims.iter().product::<usize>();
    let corners = match given_corners(path, &found, lengths, dims, warnings)? {
        None => file,
        given => given,
    };
    let absent = missing(path, &found);
    let vectors = std::mem::take(&mut found.vectors);
    let refinements = std::mem::take(&mut found.refinements);
    let mut arrays = CellArrays::of_main(&mut found, all, warnings)?;
    let local_grids = refine::refined(refinements, &arrays, found.bytes, warnings)?;
    arrays.join_factors();
    let actnum = arrays.take("ACTNUM");
    let actnum = actnum.map(|array| activity(&array)).transpose()?;
    arrays.show(dims);
    let [coord, mut zcorn] = match corners {
        Some(corners) => corners,
        None if !blocks::are_given(&arrays, &vectors, found.radial) => {
            return Err(swallowed(&found).unwrap_or(absent));
        }
        None => {
            let blocks = blocks::Blocks {
                path,
                dims,
                layers: all[2],
                is_radial: found.radial,
                vectors: &vectors,
            };
            blocks.corner_points(&mut arrays, warnings)?
        }
    };
    zcorn.truncate(depths);
    for shift in &found.depth_shifts {
        shift_depths(&mut zcorn, dims, shift, warnings);
    }
    check_finite(path, [("COORD", &coord), ("ZCORN", &zcorn)])?;
    let corners = Corners {
        dims,
        coord: &coord,
        zcorn: &zcorn,
    };
    let local_grids = refine::grids(local_grids, &corners, warnings);
    Ok(Grdecl {
        local_grids,
        dims,
        coord,
        zcorn,
        actnum: match found.porosity_model {
            PorosityModel::Single => actnum,
            _ => Some(matrix_and_fractures(actnum, depths / 8)),
        },
        porosity_model: found.porosity_model,
        has_effective_fractures: found.has_effective_fractures,
        map_axes: found.map_axes,
        map_units: found.map_units.take(),
        grid_unit: found.grid_unit.take(),
        gdorient: found.gdorient.take(),
        unit_system: found.unit_system,
        phases: found.phases,
        min_pore_volume: found.min_pore_volume,
        properties: arrays.into_properties(),
        faults: inside(&mut found, all, dims, warnings),
        files: found.files,
    })
}

/// COORD and ZCORN of the deck, where it has both; ZCORN may be that of the `dims` cells alone that are shown.
fn given_corners(
    path: &Path,
    found: &Found,
    lengths: Lengths,
    dims: [usize; 3],
    warnings: &mut Warnings,
) -> Result<Option<[Vec<f64>; 2]>, ParseError> {
    let (Some(coord), Some(zcorn)) = (&found.coord, &found.zcorn) else {
        return Ok(None);
    };
    let mut coord = array(coord, GEOMETRY, &[lengths.coord])?;
    if found.radial_corners {
        let note = radial::straighten(&mut coord, dims[0]);
        warnings.push(path, At::File, note);
    }
    let depths = 8 * dims.iter().product::<usize>();
    let zcorn = array(zcorn, GEOMETRY, &[lengths.zcorn, depths])?;
    Ok(Some([coord, zcorn]))
}

/// Refuses values that a deck makes infinite.
fn check_finite(path: &Path, arrays: [(&str, &[f64]); 2]) -> Result<(), ParseError> {
    for (name, values) in arrays {
        if let Some(number) = first_not(values, |value| value.is_finite()) {
            let message = format!("value {number} becomes infinite by what the deck does to it");
            let kind = ErrorKind::BadValue;
            return Err(ParseError::of(kind, path, At::File, name, message));
        }
    }
    Ok(())
}

/// The part of a deck's cells that is shown: with dual porosity the upper half of the layers, which are the matrix.
fn shown_dims(
    path: &Path,
    [ni, nj, nk]: [usize; 3],
    model: PorosityModel,
) -> Result<[usize; 3], ParseError> {
    match model {
        PorosityModel::Single => Ok([ni, nj, nk]),
        _ if nk % 2 == 0 => Ok([ni, nj, nk / 2]),
        _ => {
            let message = format!(
                "{nk} layers of dual porosity: there must be an even number, half of them matrix and half fractures"
            );
            let kind = ErrorKind::BadValue;
            Err(ParseError::of(kind, path, At::File, "DIMENS", message))
        }
    }
}

/// Activity as grid files have it of dual porosity: 1 matrix, 2 fractures, 3 both.
pub(super) fn matrix_and_fractures(actnum: Option<Vec<i32>>, cells: usize) -> Vec<i32> {
    let Some(actnum) = actnum else {
        return vec![3; cells];
    };
    let is_active = |cell: usize| i32::from(actnum.get(cell).is_some_and(|active| *active != 0));
    let flags = (0..cells).map(|cell| is_active(cell) + 2 * is_active(cell + cells));
    flags.collect()
}

/// What the decks say of the cells of a grid that was read from elsewhere; `path` is the first of them.
pub(super) fn cells(
    path: &Path,
    mut found: Found,
    dims: [usize; 3],
    warnings: &mut Warnings,
) -> Result<DeckCells, ParseError> {
    let [ni, nj, nk] = dims;
    let all = match found.porosity_model {
        PorosityModel::Single => dims,
        _ => [ni, nj, 2 * nk],
    };
    checked_lengths(path, all)?;
    if let Some(refinement) = found.refinements.first() {
        let message = "values of local grids are not read from files that are added to a grid";
        refinement.place.warn(warnings, message);
    }
    let mut arrays = CellArrays::of_main(&mut found, all, warnings)?;
    arrays.join_factors();
    arrays.take("ACTNUM");
    arrays.show(dims);
    Ok(DeckCells {
        properties: arrays.into_properties(),
        faults: inside(&mut found, all, dims, warnings),
        unit_system: found.unit_system,
        phases: found.phases,
        files: found.files,
    })
}

/// Pillars and depths of the binary file that GDFILE names; what else it says completes `found`.
fn named_grid(
    found: &mut Found,
    warnings: &mut Warnings,
) -> Result<Option<[Vec<f64>; 2]>, ParseError> {
    let Some((place, file)) = found.grid_file.take() else {
        return Ok(None);
    };
    if found.coord.is_some() && found.zcorn.is_some() {
        place.warn(warnings, "GDFILE is not read: the deck has COORD and ZCORN");
        return Ok(None);
    }
    let path = file
        .as_ref()
        .map(|file| file.path().to_owned())
        .unwrap_or_default();
    let read = file.and_then(|file| Egrid::from_bytes(file, warnings));
    let grid = read.map_err(|error| {
        let message = format!("its grid cannot be read: {error}");
        place.error(error.kind, message)
    })?;
    let is_dual = found.porosity_model != PorosityModel::Single;
    let [ni, nj, nk] = grid.dims;
    // Grid files of dual porosity have the layers of the matrix alone.
    let doubled = [ni, nj, 2 * nk];
    let is_half = is_dual && found.dims.is_none_or(|dims| dims == doubled);
    let fitting = if is_half { doubled } else { grid.dims };
    if let Some(dims) = found.dims.filter(|dims| *dims != fitting) {
        let message = format!(
            "the deck has {} cells and {} has {}",
            product_text(dims),
            path.display(),
            product_text(grid.dims)
        );
        return Err(place.error(ErrorKind::Mismatch, message));
    }
    found.dims = Some(fitting);
    let bits = |mask: i32| move |active: &i32| i32::from(active & mask != 0);
    let fractures = match grid.porosity_model {
        PorosityModel::Single => 1,
        _ => 2,
    };
    let actnum = grid.actnum.map(|actnum| match is_half {
        true => [1, fractures]
            .into_iter()
            .flat_map(|mask| actnum.iter().map(bits(mask)))
            .collect(),
        false => actnum,
    });
    found.file_actnum = actnum.map(|actnum| (place, actnum));
    found.map_axes = found.map_axes.or(grid.map_axes);
    found.map_units = found.map_units.take().or(grid.map_units);
    let unit = grid.grid_unit.map(|unit| GridUnit {
        name: unit.length,
        is_map: unit.is_map,
    });
    found.grid_unit = found.grid_unit.take().or(unit);
    found.files.push(path);
    let wide = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
    Ok(Some([wide(grid.coord), wide(grid.zcorn)]))
}

/// The lengths of the arrays, where they can be addressed.
fn checked_lengths(path: &Path, dims: [usize; 3]) -> Result<Lengths, ParseError> {
    Lengths::of(dims).ok_or_else(|| too_large(path, unaddressable(dims)))
}

/// Refuses more cells than `bytes` of text can describe.
fn check_text(path: &Path, dims: [usize; 3], bytes: usize) -> Result<(), ParseError> {
    let cells: usize = dims.iter().product();
    if cells / MOST_CELLS_PER_BYTE > bytes {
        let message = format!(
            "{} cells cannot be described by {bytes} bytes of text: are the dimensions right?",
            product_text(dims)
        );
        return Err(too_large(path, message));
    }
    Ok(())
}

fn too_large(path: &Path, message: String) -> ParseError {
    ParseError::of(ErrorKind::TooLarge, path, At::File, "SPECGRID", message)
}

/// Applies a record of ADDZCORN: all corners of the cells in its box.
fn shift_depths(zcorn: &mut [f64], dims: [usize; 3], shift: &DepthShift, warnings: &mut Warnings) {
    let Some(ranges) = shift.cells.ranges(dims) else {
        let message = "ADDZCORN is not applied: its box is outside the grid";
        return shift.place.warn(warnings, message);
    };
    let twice = |range: std::ops::Range<usize>| 2 * range.start..2 * range.end;
    for corner in cells_of(ranges.map(twice), dims.map(|n| 2 * n)) {
        zcorn[corner] += shift.value;
    }
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
    let names = found.edits.iter().filter_map(|edit| match edit {
        Edit::Given(block, _) => Some(block.name.as_str()).filter(|name| !is_table(name)),
        _ => None,
    });
    let faults = (!found.faults.is_empty()).then_some("FAULTS");
    let names: Vec<_> = names.take(3).chain(faults).collect();
    let message = if absent.len() == parts.len() && !names.is_empty() {
        format!(
            "has {} but no grid: open the grid's file and add this one (--with)",
            names.join(", ")
        )
    } else if found.radial {
        "no grid: a radial one needs DIMENS, INRAD, DR (or DRV, or OUTRAD), DTHETA (or DTHETAV), DZ (or DZV) and TOPS"
            .to_owned()
    } else if found.is_block_centered() {
        "no grid: a block-centered one needs DIMENS, DX (or DXV), DY (or DYV), DZ (or DZV) and TOPS"
            .to_owned()
    } else {
        let verb = if absent.len() == 1 { "is" } else { "are" };
        format!(
            "no grid: {} {verb} missing: open the file that has the grid",
            absent.join(", ")
        )
    };
    ParseError::of(ErrorKind::MissingKeyword, path, At::File, "", message)
}

/// The array without a closing `/` that took a missing keyword for its own data, if there is one.
fn swallowed(found: &Found) -> Option<ParseError> {
    let given = found.edits.iter().filter_map(|edit| match edit {
        Edit::Given(block, _) => Some(block),
        _ => None,
    });
    let arrays = [&found.coord, &found.zcorn];
    let blocks = arrays.into_iter().flatten().chain(given);
    blocks.into_iter().find_map(|block| {
        let mistake = numbers(block, PROPERTY).err()?;
        is_swallowed_keyword(block, &mistake).then(|| error(block, mistake))
    })
}

/// Reads an array that must have one of `counts` of values, the first of which is told where it has not.
pub(super) fn array(block: &Block, rule: Rule, counts: &[usize]) -> Result<Vec<f64>, ParseError> {
    let runs = numbers(block, rule).map_err(|mistake| error(block, mistake))?;
    let is_known = counts.contains(&runs.count);
    let expected = if is_known { runs.count } else { counts[0] };
    expand(block, runs, expected)
}

pub(super) fn numbers(block: &Block, rule: Rule) -> Result<Runs, Mistake> {
    let text = block.source.text();
    match &block.data {
        Data::Text(range) => {
            runs(&text[range.clone()], rule).map_err(|mistake| mistake.moved(range.start))
        }
        Data::Imported(file, entry) => {
            let placed = |kind, message| Mistake::new(kind, block.at, message);
            let values = file.f64s(entry);
            let values = values.map_err(|error| placed(error.kind, error.to_string()))?;
            let in_file = |message| format!("{message} in {}", file.path().display());
            Runs::of(values, rule).map_err(|message| placed(ErrorKind::BadValue, in_file(message)))
        }
    }
}

pub(super) fn expand(block: &Block, runs: Runs, expected: usize) -> Result<Vec<f64>, ParseError> {
    let failed = |kind, message| {
        let at = block.end();
        block.source.error(kind, at, &block.name, message)
    };
    if runs.count != expected {
        let message = format!("expected {expected} values, found {}", runs.count);
        return Err(failed(ErrorKind::WrongCount, message));
    }
    let memory = || format!("not enough memory for {expected} values");
    runs.expand()
        .ok_or_else(|| failed(ErrorKind::TooLarge, memory()))
}

/// Names the place of `mistake`, and the missing slash where a keyword stands there.
pub(super) fn error(block: &Block, mut mistake: Mistake) -> ParseError {
    if is_swallowed_keyword(block, &mistake) {
        mistake.kind = ErrorKind::Malformed;
        mistake.message = format!(
            "{}; is the closing / of {} missing?",
            mistake.message, block.name
        );
    }
    block.source.mistake(&block.name, mistake)
}

pub(super) fn is_swallowed_keyword(block: &Block, mistake: &Mistake) -> bool {
    let is_text = matches!(block.data, Data::Text(_));
    is_text
        && keyword(block.source.text(), mistake.at)
            .is_some_and(|found| found.alone || is_read(&found.name))
}

fn activity(array: &CellArray) -> Result<Vec<i32>, ParseError> {
    let values = &array.values;
    let whole = |&value: &f64| value.fract() == 0.0 && (0.0..=255.0).contains(&value);
    if let Some(cell) = first_not(values, whole) {
        let message = format!(
            "the value {} of cell {cell} is not 0 or another small whole number",
            values[cell - 1]
        );
        let Place { source, at, .. } = &array.place;
        return Err(source.error(ErrorKind::BadValue, *at, &array.name, message));
    }
    #[allow(
        clippy::cast_possible_truncation,
        reason = "all values are whole and at most 255"
    )]
    Ok(values.iter().map(|&value| value as i32).collect())
}

/// The fault faces that lie inside the grid of `all` cells, with their multipliers; of those of dual porosity the part in
/// the matrix, which has `dims` cells.
pub(super) fn inside(
    found: &mut Found,
    all: [usize; 3],
    dims: [usize; 3],
    warnings: &mut Warnings,
) -> Vec<FaultFaces> {
    let mut kept = Vec::with_capacity(found.faults.len());
    for (place, mut fault) in std::mem::take(&mut found.faults) {
        if let Some(outside) = faults::outside(&fault, all) {
            let message = format!(
                "a face of fault {} lies outside the grid ({outside}); it is left out",
                fault.name
            );
            place.warn(warnings, message);
        } else if fault.k[0] <= dims[2] {
            fault.k[1] = fault.k[1].min(dims[2]);
            fault.multiplier = faults::multiplier_of(&fault.name, &found.fault_multipliers);
            kept.push(fault);
        }
    }
    kept
}
