//! Reads files that are nowhere on disk: a deck with an INCLUDE, and the same grid as a binary file.
//!
//! `cargo run --example from_bytes`; it needs no file.

use std::path::Path;

use strataray_parsers::deck::{Grdecl, MemoryFiles};
use strataray_parsers::egrid::Egrid;
use strataray_parsers::records::RecordWriter;
use strataray_parsers::{ErrorKind, Warnings};

const DECK: &str = "
SPECGRID
  1 1 1 1 F /
INCLUDE
  'corners.inc' /
PORO
  0.25 /
";

const CORNERS: &str = "
COORD
  0 0 0  0 0 1
  1 0 0  1 0 1
  0 1 0  0 1 1
  1 1 0  1 1 1 /
ZCORN
  4*0 4*1 /
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut warnings = Warnings::default();
    let files: MemoryFiles = [("CASE.DATA", DECK), ("corners.inc", CORNERS)]
        .into_iter()
        .collect();
    let deck = Grdecl::read_from(&files, Path::new("CASE.DATA"), &[], &mut warnings)?;
    println!(
        "{:?} cells, {}: {:?}",
        deck.dims, deck.properties[0].name, deck.properties[0].values
    );

    let single = |values: &[f64]| values.iter().map(|v| *v as f32).collect::<Vec<_>>();
    let mut writer = RecordWriter::new(Vec::new());
    writer.inte("GRIDHEAD", &[1, 1, 1, 1])?;
    writer.real("COORD", &single(&deck.coord))?;
    writer.real("ZCORN", &single(&deck.zcorn))?;
    let bytes = writer.finish()?;
    let grid = Egrid::from_bytes(("CASE.EGRID", bytes.clone()), &mut warnings)?;
    println!("{:?} cells, depths {:?}", grid.dims, grid.zcorn);

    // A file that is cut off ends in an error of a kind that programs can tell.
    let cut = bytes[..bytes.len() - 1].to_vec();
    match Egrid::from_bytes(("CASE.EGRID", cut), &mut warnings) {
        Err(error) if error.kind == ErrorKind::Truncated => println!("{error}"),
        other => println!("not expected: {other:?}"),
    }
    Ok(())
}
