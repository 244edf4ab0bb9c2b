//! Block-centered grids: sizes and tops of cells (DX, DY, DZ, TOPS) as a corner-point grid.

use std::path::Path;

use super::assemble::{GEOMETRY, array};
use super::cells::CellArrays;
use super::edit::cells_of;
use super::scan::Block;
use crate::error::{At, ErrorKind, ParseError, Warnings};

/// An axis with the array that gives the sizes along it cell by cell, and the vector that gives them once.
const SIZES: [[&str; 2]; 3] = [["DX", "DXV"], ["DY", "DYV"], ["DZ", "DZV"]];

/// True where sizes along all axes and tops are there.
pub(super) fn are_given(arrays: &CellArrays, vectors: &[Block]) -> bool {
    let is_given = |name: &str| arrays.values(name).is_some();
    let has_sizes = |[cells, vector]: &[&str; 2]| {
        is_given(cells) || vectors.iter().any(|block| block.name == *vector)
    };
    SIZES.iter().all(has_sizes) && is_given("TOPS")
}

/// COORD and ZCORN: vertical pillars by the sizes of the first layer, each cell's top below that of the one above
/// unless TOPS says more.
///
/// # Errors
/// When a size or a top of the first layer is missing.
pub(super) fn corner_points(
    path: &Path,
    dims: [usize; 3],
    arrays: &mut CellArrays,
    vectors: &[Block],
    warnings: &mut Warnings,
) -> Result<[Vec<f64>; 2], ParseError> {
    let [ni, nj, nk] = dims;
    let mut sizes = Vec::with_capacity(3);
    for (axis, names) in SIZES.into_iter().enumerate() {
        sizes.push(sizes_along(path, axis, names, dims, arrays, vectors)?);
    }
    let tops = arrays.take("TOPS").map(|array| array.values);
    let tops = tops.unwrap_or_default();
    let layer = ni * nj;
    if let Some(column) = (0..layer).find(|&column| tops[column].is_nan()) {
        let message = format!("has no value for cell {} of the first layer", column + 1);
        return Err(ParseError::of(
            ErrorKind::BadValue,
            path,
            At::File,
            "TOPS",
            message,
        ));
    }
    for (size, [name, _]) in sizes.iter().zip(SIZES).take(2) {
        if (layer..size.len()).any(|cell| size[cell] != size[cell % layer]) {
            let message = format!(
                "{name} differs from layer to layer: all layers are drawn with that of the first"
            );
            warnings.push(path, At::File, message);
        }
    }
    let [dx, dy, dz] = &sizes[..] else {
        return Err(missing(path, "DZ"));
    };
    let mut depths = vec![[0.0; 2]; layer * nk];
    for cell in 0..layer * nk {
        let top = match tops[cell] {
            top if top.is_nan() => depths[cell - layer][1],
            top => top,
        };
        depths[cell] = [top, top + dz[cell]];
    }
    let ends = depths
        .iter()
        .fold([f64::MAX, f64::MIN], |[a, b], [top, bottom]| {
            [a.min(*top), b.max(*bottom)]
        });
    let mut coord = Vec::with_capacity(6 * (ni + 1) * (nj + 1));
    for j in 0..=nj {
        for i in 0..=ni {
            let (row, column) = (ni * j.min(nj - 1), i.min(ni - 1));
            let x = dx[row..row + i].iter().fold(0.0, |x, size| x + size);
            let y = (0..j).fold(0.0, |y, j| y + dy[column + ni * j]);
            coord.extend([x, y, ends[0], x, y, ends[1]]);
        }
    }
    let mut zcorn = Vec::with_capacity(8 * layer * nk);
    let corners = cells_of([0..2 * ni, 0..2 * nj, 0..2 * nk], dims.map(|n| 2 * n));
    zcorn.extend(corners.map(|corner| {
        let (i, j, k) = (
            corner % (2 * ni),
            corner / (2 * ni) % (2 * nj),
            corner / (4 * layer),
        );
        depths[i / 2 + ni * (j / 2) + layer * (k / 2)][k % 2]
    }));
    Ok([coord, zcorn])
}

/// Sizes of all cells along an axis, all defined.
fn sizes_along(
    path: &Path,
    axis: usize,
    [name, vector]: [&str; 2],
    dims: [usize; 3],
    arrays: &CellArrays,
    vectors: &[Block],
) -> Result<Vec<f64>, ParseError> {
    if let Some(sizes) = arrays.values(name) {
        // Below the first layer only thicknesses matter.
        let needed = if axis == 2 {
            sizes.len()
        } else {
            dims[0] * dims[1]
        };
        return match sizes[..needed].iter().position(|size| size.is_nan()) {
            None => Ok(sizes.to_vec()),
            Some(cell) => {
                let message = format!("has no value for cell {}", cell + 1);
                Err(ParseError::of(
                    ErrorKind::BadValue,
                    path,
                    At::File,
                    name,
                    message,
                ))
            }
        };
    }
    let block = vectors.iter().rev().find(|block| block.name == vector);
    let block = block.ok_or_else(|| missing(path, name))?;
    let sizes = array(block, GEOMETRY, dims[axis])?;
    let [ni, nj, nk] = dims;
    let at = |cell: usize| [cell % ni, cell / ni % nj, cell / (ni * nj)][axis];
    Ok((0..ni * nj * nk).map(|cell| sizes[at(cell)]).collect())
}

fn missing(path: &Path, keyword: &str) -> ParseError {
    ParseError::of(
        ErrorKind::MissingKeyword,
        path,
        At::File,
        keyword,
        "is missing",
    )
}
