//! Faces of cells by number.

use rayon::prelude::*;

use crate::model::topology::Face;
use crate::model::{Dims, Grid, Ijk};
use crate::render::RenderError;

/// Numbers of faces as rays know them: `(column * nk + layer) * 6 + face`.
///
/// # Errors
/// When 32 bits do not number all faces of the grid.
pub fn face_numbers(model: &Grid, faces: &[(Ijk, Face)]) -> Result<Vec<u32>, RenderError> {
    let dims = model.dims();
    let needed = 6 * dims.cells() as u64;
    if needed >= u64::from(u32::MAX) {
        return Err(RenderError::TooLarge {
            what: "numbering the faces",
            needed,
            limit: u64::from(u32::MAX),
        });
    }
    let numbers = faces
        .par_iter()
        .map(|(cell, face)| number(dims, *cell, *face));
    Ok(numbers.collect())
}

fn number(dims: Dims, cell: Ijk, face: Face) -> u32 {
    let column = cell.i + dims.ni * cell.j;
    ((column * dims.nk + cell.k) * 6 + face as usize) as u32
}
