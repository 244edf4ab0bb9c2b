//! Block-centered grids as corner-point grids: sizes and tops of cells, along x and y (DX, DY, DZ, TOPS) or along radius
//! and angle (DR, DTHETA, DZ, TOPS, INRAD).

use std::path::Path;

use super::assemble::{GEOMETRY, array};
use super::cells::CellArrays;
use super::edit::{Place, cells_of};
use super::scan::Block;
use crate::error::{At, ErrorKind, ParseError, Warnings};
use crate::radial;

/// An axis with the array that gives the sizes along it cell by cell, and the vector that gives them once.
type Axes = [[&'static str; 2]; 3];

const CARTESIAN: Axes = [["DX", "DXV"], ["DY", "DYV"], ["DZ", "DZV"]];
const RADIAL: Axes = [["DR", "DRV"], ["DTHETA", "DTHETAV"], ["DZ", "DZV"]];

fn axes(is_radial: bool) -> Axes {
    if is_radial { RADIAL } else { CARTESIAN }
}

/// True where sizes along all axes and tops are there.
pub(super) fn are_given(arrays: &CellArrays, vectors: &[Block], is_radial: bool) -> bool {
    let is_given = |name: &str| arrays.values(name).is_some();
    let is_vector = |name: &str| vectors.iter().any(|block| block.name == name);
    let has_sizes = |[cells, vector]: [&str; 2]| {
        is_given(cells) || is_vector(vector) || cells == "DR" && is_vector("OUTRAD")
    };
    let has_radius = !is_radial || is_vector("INRAD");
    axes(is_radial).into_iter().all(has_sizes) && is_given("TOPS") && has_radius
}

/// What a block-centered grid is made of, beside arrays of cells.
pub(super) struct Blocks<'a> {
    pub(super) path: &'a Path,
    pub(super) dims: [usize; 3],
    /// Layers of the deck: with dual porosity those of the fractures too.
    pub(super) layers: usize,
    pub(super) is_radial: bool,
    pub(super) vectors: &'a [Block],
}

impl Blocks<'_> {
    /// COORD and ZCORN: vertical pillars by the sizes of the first layer, each cell's top below that of the one above
    /// unless TOPS says more.
    ///
    /// # Errors
    /// When a size or a top of the first layer is missing.
    pub(super) fn corner_points(
        &self,
        arrays: &mut CellArrays,
        warnings: &mut Warnings,
    ) -> Result<[Vec<f64>; 2], ParseError> {
        let layer = self.dims[0] * self.dims[1];
        let [along_i, along_j, along_k] = axes(self.is_radial);
        let dx = self.sizes_along(0, along_i, arrays)?;
        let dy = self.sizes_along(1, along_j, arrays)?;
        let dz = self.sizes_along(2, along_k, arrays)?;
        for (sizes, [name, _]) in [(&dx, along_i), (&dy, along_j)] {
            if (layer..sizes.len()).any(|cell| sizes[cell] != sizes[cell % layer]) {
                let message = format!(
                    "{name} differs from layer to layer: all layers are drawn with that of the first"
                );
                warnings.push(self.path, At::File, message);
            }
        }
        let depths = self.depths(arrays, &dz)?;
        let mut coord = self.pillars(&dx, &dy, &depths)?;
        if self.is_radial {
            let note = radial::straighten(&mut coord, self.dims[0]);
            warnings.push(self.path, At::File, note);
        }
        Ok([coord, self.zcorn(&depths)])
    }

    /// Upper and lower depth of each cell.
    fn depths(&self, arrays: &mut CellArrays, dz: &[f64]) -> Result<Vec<[f64; 2]>, ParseError> {
        let layer = self.dims[0] * self.dims[1];
        let place = arrays.place("TOPS").cloned();
        let tops = arrays.take("TOPS").map(|array| array.values);
        let tops = tops.unwrap_or_default();
        if let Some(column) = (0..layer).find(|&column| tops[column].is_nan()) {
            let message = format!("has no value for cell {} of the first layer", column + 1);
            return Err(self.undefined(place.as_ref(), "TOPS", message));
        }
        let mut depths = vec![[0.0; 2]; dz.len()];
        for cell in 0..dz.len() {
            let top = match tops[cell] {
                top if top.is_nan() => depths[cell - layer][1],
                top => top,
            };
            depths[cell] = [top, top + dz[cell]];
        }
        Ok(depths)
    }

    /// COORD by the sizes of the first layer; radii and angles in place of x and y where the grid is radial.
    fn pillars(&self, dx: &[f64], dy: &[f64], depths: &[[f64; 2]]) -> Result<Vec<f64>, ParseError> {
        let [ni, nj, _] = self.dims;
        let ends = depths
            .iter()
            .fold([f64::MAX, f64::MIN], |[a, b], [top, bottom]| {
                [a.min(*top), b.max(*bottom)]
            });
        let start = match self.is_radial {
            true => self.number("INRAD")?,
            false => 0.0,
        };
        let mut coord = Vec::with_capacity(6 * (ni + 1) * (nj + 1));
        for j in 0..=nj {
            for i in 0..=ni {
                let (row, column) = (ni * j.min(nj - 1), i.min(ni - 1));
                let x = dx[row..row + i].iter().fold(start, |x, size| x + size);
                let y = (0..j).fold(0.0, |y, j| y + dy[column + ni * j]);
                coord.extend([x, y, ends[0], x, y, ends[1]]);
            }
        }
        Ok(coord)
    }

    fn zcorn(&self, depths: &[[f64; 2]]) -> Vec<f64> {
        let [ni, nj, nk] = self.dims;
        let corners = cells_of([0..2 * ni, 0..2 * nj, 0..2 * nk], self.dims.map(|n| 2 * n));
        let depth = |corner: usize| {
            let (i, j) = (corner % (2 * ni), corner / (2 * ni) % (2 * nj));
            let k = corner / (4 * ni * nj);
            depths[i / 2 + ni * (j / 2) + ni * nj * (k / 2)][k % 2]
        };
        corners.map(depth).collect()
    }

    /// Sizes of all cells along an axis, all defined.
    fn sizes_along(
        &self,
        axis: usize,
        [name, vector]: [&str; 2],
        arrays: &CellArrays,
    ) -> Result<Vec<f64>, ParseError> {
        let [ni, nj, nk] = self.dims;
        if let Some(sizes) = arrays.values(name) {
            // Below the first layer only thicknesses matter.
            let needed = if axis == 2 { sizes.len() } else { ni * nj };
            return match sizes[..needed].iter().position(|size| size.is_nan()) {
                None => Ok(sizes.to_vec()),
                Some(cell) => {
                    let message = format!("has no value for cell {}", cell + 1);
                    Err(self.undefined(arrays.place(name), name, message))
                }
            };
        }
        let sizes = match self.vector(vector) {
            Some(block) if axis == 2 => array(block, GEOMETRY, &[self.layers, nk])?,
            Some(block) => array(block, GEOMETRY, &[self.dims[axis]])?,
            None if name == "DR" => self.growing_radii()?,
            None => return Err(self.missing(name)),
        };
        let at = |cell: usize| [cell % ni, cell / ni % nj, cell / (ni * nj)][axis];
        Ok((0..ni * nj * nk).map(|cell| sizes[at(cell)]).collect())
    }

    /// Sizes along the radius where only the innermost and the outermost one are given: each radius is the one before
    /// times the same factor.
    fn growing_radii(&self) -> Result<Vec<f64>, ParseError> {
        let ends = [self.number("INRAD")?, self.number("OUTRAD")?];
        if !(ends[0] > 0.0 && ends[1] > ends[0]) {
            let message = format!(
                "the outer radius {} and the inner one {} leave no room: give DR or DRV",
                ends[1], ends[0]
            );
            return Err(self.error(ErrorKind::BadValue, "OUTRAD", message));
        }
        #[allow(clippy::cast_precision_loss, reason = "columns are few")]
        let radius = |i: usize| ends[0] * (ends[1] / ends[0]).powf(i as f64 / self.dims[0] as f64);
        let sizes = (0..self.dims[0]).map(|i| radius(i + 1) - radius(i));
        Ok(sizes.collect())
    }

    fn vector(&self, name: &str) -> Option<&Block> {
        self.vectors.iter().rev().find(|block| block.name == name)
    }

    /// The number behind a keyword that has one.
    fn number(&self, name: &str) -> Result<f64, ParseError> {
        let block = self.vector(name).ok_or_else(|| self.missing(name))?;
        let values = array(block, GEOMETRY, &[1])?;
        Ok(values.first().copied().unwrap_or_default())
    }

    fn missing(&self, keyword: &str) -> ParseError {
        self.error(ErrorKind::MissingKeyword, keyword, "is missing")
    }

    /// The error about a value of an array that is not there, at the place of the array.
    fn undefined(&self, place: Option<&Place>, name: &str, message: String) -> ParseError {
        let kind = ErrorKind::BadValue;
        match place {
            Some(place) => place.source.error(kind, place.at, name, message),
            None => self.error(kind, name, message),
        }
    }

    fn error(&self, kind: ErrorKind, keyword: &str, message: impl Into<String>) -> ParseError {
        ParseError::of(kind, self.path, At::File, keyword, message)
    }
}
