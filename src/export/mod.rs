//! Cells, values and surfaces of a case as files of other programs: the counterpart of [`crate::case::load`].
//!
//! | file | lengths and axes | undefined values | several steps |
//! | --- | --- | --- | --- |
//! | EGRID, INIT, UNRST | as the case has them, with MAPAXES; rounded to 32 bits | 1e20 | steps of the UNRST |
//! | GRDECL | as the case has them, with MAPAXES | `1*` (default) | a file for each step |
//! | ROFF | map coordinates | -999 | `NAME_20010630` |
//! | VTU | map coordinates, z = -depth | NaN | a file for each step, and one that lists them (PVD) |
//! | CSV, Parquet | cells by I, J, K from 1 | no row | rows |
//! | glTF | meters, y up, z south, from an origin that its root node has | no face | one step |
//!
//! Files of one grid have the main grid alone; VTU and tables have the cells of local grids, too, and their names.
//!
//! Cells that are not written are inactive in files of whole grids, and have the value 0 there; VTU and tables leave
//! them out. Map coordinates are in the unit of the map, depths too. Which cells are written does not change with the
//! step: a scene's filter counts at the scene's step.

mod contents;
mod eclipse;
mod error;
mod gltf;
mod grdecl;
mod names;
mod output;
mod roff;
pub mod synthetic;
pub mod table;
pub mod volume;
mod vtu;
mod wells;

use std::path::{Path, PathBuf};

pub use contents::{Contents, Exported};
pub use error::ExportError;
use output::Output;
pub use output::Written;

/// Kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// EGRID with INIT and UNRST.
    Eclipse,
    /// Text.
    Grdecl,
    /// Binary ROFF.
    Roff,
    /// An unstructured grid of VTK.
    Vtu,
    /// Comma-separated values.
    Csv,
    /// The same table in columns.
    Parquet,
    /// Surfaces and wells.
    Gltf,
}

/// A format, the ending of its files, and what is in them.
type Known = (Format, &'static str, &'static str);

impl Format {
    /// All of them, with the ending of a file as it is written as a rule, and what is in it.
    pub const ALL: [Known; 7] = [
        (
            Self::Eclipse,
            "EGRID",
            "grid, with static properties in INIT and steps in UNRST beside it",
        ),
        (Self::Grdecl, "grdecl", "grid and properties as text"),
        (Self::Roff, "roff", "grid and properties for RMS and xtgeo"),
        (Self::Vtu, "vtu", "cells for ParaView and pyvista"),
        (Self::Csv, "csv", "a row for each cell, step and property"),
        (Self::Parquet, "parquet", "the same rows in columns"),
        (Self::Gltf, "glb", "hull, faults and wells in colors"),
    ];

    /// The format that a file's ending asks for.
    ///
    /// # Errors
    /// When it is none of these; the sentence lists them.
    pub fn from_path(path: &Path) -> Result<Self, ExportError> {
        let ending = path.extension().and_then(|e| e.to_str());
        let ending = ending.unwrap_or_default();
        let known = Self::ALL.iter();
        let mut found = known.filter(|(_, known, _)| known.eq_ignore_ascii_case(ending));
        match found.next() {
            Some((format, ..)) => Ok(*format),
            None => Err(ExportError::Format(path.to_owned())),
        }
    }
}

/// Writes `contents` to the file at `path`, and to those that belong to it; nothing is left of it where it fails.
///
/// `progress` gets the part done and returns false to cancel.
///
/// # Errors
/// When the format cannot hold what is to be written, values cannot be read, a file cannot be written or is one of the
/// case's own, or `progress` cancels.
pub fn write(
    contents: &Contents<'_>,
    path: &Path,
    progress: &dyn Fn(f64) -> bool,
) -> Result<Written, ExportError> {
    let format = Format::from_path(path)?;
    let mut output = Output::new(&contents.case.about.files, progress);
    let is_whole_grid = matches!(format, Format::Eclipse | Format::Grdecl | Format::Roff);
    let main;
    let contents = match is_whole_grid && contents.case.grid.patches().len() > 1 {
        true => {
            output.note("local grids are not written: the file holds one grid".into());
            main = contents.of_main_grid()?;
            &main
        }
        false => contents,
    };
    match format {
        Format::Eclipse => eclipse::write(contents, path, &mut output),
        Format::Grdecl => grdecl::write(contents, path, &mut output),
        Format::Roff => roff::write(contents, path, &mut output),
        Format::Vtu => vtu::write(contents, path, &mut output),
        Format::Csv => table::write_csv(contents, path, &mut output),
        Format::Parquet => table::write_parquet(contents, path, &mut output),
        Format::Gltf => gltf::write(contents, path, &mut output),
    }?;
    output.keep()
}

/// The file of a step beside the one at `path`: `swat.vtu` has `swat_0003.vtu`.
fn of_step(path: &Path, step: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}_{step:04}.{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_ending_and_those_that_are_none() {
        for (format, ending, _) in Format::ALL {
            for ending in [ending.to_lowercase(), ending.to_uppercase()] {
                let path = Path::new("a.b").with_extension(&ending);
                assert_eq!(Format::from_path(&path).unwrap(), format);
            }
        }
        for none in ["a", "a.obj", ".csv", ""] {
            let error = Format::from_path(Path::new(none)).unwrap_err().to_string();
            let lists = |(_, ending, _): &Known| error.contains(&format!(".{ending}"));
            assert!(Format::ALL.iter().all(lists), "{error}");
        }
        let path = of_step(Path::new("x/a.b.vtu"), 3);
        assert_eq!(path, Path::new("x/a.b_0003.vtu"));
    }
}
