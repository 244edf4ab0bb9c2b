//! INIT: static properties of the global grid, and of local ones.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use crate::bytes::FileBytes;
use crate::cells::{CellArrays, Head, write_arrays, write_heads};
use crate::error::{ParseError, Warnings};
use crate::records::{RecordFile, RecordWriter};

/// Opens an INIT file; sections of local grids (LGR to LGRSGONE or ENDLGR) are [`CellArrays::local_grids`]. Of a file
/// that ends within an array, those before it are kept, with a warning.
///
/// # Errors
/// When the file holds no whole array.
pub fn open(path: &Path, warnings: &mut Warnings) -> Result<CellArrays, ParseError> {
    Ok(all_of(RecordFile::open_lenient(path, warnings)?))
}

/// As [`open`], for a file that is in memory.
///
/// # Errors
/// When it holds no whole array.
pub fn from_bytes(
    file: impl Into<FileBytes>,
    warnings: &mut Warnings,
) -> Result<CellArrays, ParseError> {
    Ok(all_of(RecordFile::from_bytes_lenient(file, warnings)?))
}

fn all_of(file: RecordFile) -> CellArrays {
    let all = 0..file.entries().len();
    CellArrays::new(&Arc::new(file), all)
}

/// Writes an INIT file; each of `arrays` has one value per active cell, or per cell as PORV has, and is made when its
/// turn comes.
///
/// # Errors
/// When writing fails, an array has another number of values, or a name or the date is none.
pub fn write<W: Write, N: AsRef<str>>(
    out: W,
    head: &Head,
    arrays: impl IntoIterator<Item = (N, Vec<f32>)>,
) -> io::Result<W> {
    let mut out = RecordWriter::new(out);
    write_to(&mut out, head, arrays)?;
    out.finish()
}

/// As [`write()`], into a file of any form.
///
/// # Errors
/// As [`write()`].
pub fn write_to<W: Write, N: AsRef<str>>(
    out: &mut RecordWriter<W>,
    head: &Head,
    arrays: impl IntoIterator<Item = (N, Vec<f32>)>,
) -> io::Result<()> {
    write_heads(out, head, 0.0)?;
    write_arrays(out, head, arrays)
}
