//! Grids and properties of ROFF files.

use std::path::{Path, PathBuf};

use strataray_parsers::deck::DeckProperty;
use strataray_parsers::roff::{Pillars, RoffFile};
use strataray_parsers::{At, ErrorKind, ParseError};

/// What is in a file with a grid.
pub struct Contents {
    pub pillars: Pillars,
    pub properties: Vec<DeckProperty>,
}

/// True where a file has a grid; also of a damaged one, which is told where it is read.
pub fn is_grid(path: &Path) -> bool {
    RoffFile::open(path).map_or(true, |file| file.find("cornerLines").is_some())
}

/// Reads a grid and the properties beside it in the file.
pub fn read(path: &Path) -> Result<Contents, ParseError> {
    let file = RoffFile::open(path)?;
    match file.grid()? {
        Some(grid) => Ok(Contents {
            pillars: grid.pillars(),
            properties: properties(&file)?,
        }),
        None => {
            let message =
                "has properties and no grid; open a grid and add this file to it (--with)";
            let kind = ErrorKind::MissingKeyword;
            Err(ParseError::of(kind, path, At::File, "cornerLines", message))
        }
    }
}

/// Adds the properties of files to others; one that is there already takes the newer values.
///
/// # Errors
/// When a file is damaged, or is of a grid of other dimensions.
pub fn add(
    known: &mut Vec<DeckProperty>,
    dims: [usize; 3],
    files: &[PathBuf],
) -> Result<(), ParseError> {
    for path in files {
        let file = RoffFile::open(path)?;
        let [ni, nj, nk] = file.dims()?;
        if [ni, nj, nk] != dims {
            let [a, b, c] = dims;
            let message = format!("has {ni} x {nj} x {nk} cells and the grid {a} x {b} x {c}");
            let kind = ErrorKind::Mismatch;
            return Err(ParseError::of(kind, path, At::File, "dimensions", message));
        }
        for property in properties(&file)? {
            known.retain(|known| known.name != property.name);
            known.push(property);
        }
    }
    Ok(())
}

fn properties(file: &RoffFile) -> Result<Vec<DeckProperty>, ParseError> {
    let parameters = file.parameters()?;
    let properties = parameters.iter().map(|parameter| {
        Ok(DeckProperty {
            name: parameter.name.clone(),
            values: file.values(parameter)?,
            doubt: None,
        })
    });
    properties.collect()
}
