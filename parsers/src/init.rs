//! INIT: static properties of the global grid.

use std::path::Path;
use std::sync::Arc;

use crate::cells::CellArrays;
use crate::error::ParseError;
use crate::records::RecordFile;

/// Opens an INIT file; sections of local grids (LGR to LGRSGONE or ENDLGR) are left out.
///
/// # Errors
/// When the file is damaged.
pub fn open(path: &Path) -> Result<CellArrays, ParseError> {
    let file = Arc::new(RecordFile::open(path)?);
    let all = 0..file.entries().len();
    Ok(CellArrays::new(&file, all, &["LGRSGONE", "ENDLGR"]))
}
