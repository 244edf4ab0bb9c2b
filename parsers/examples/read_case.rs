//! Reads a case: the size of its grid, and the range of a property in INIT and at each step.
//!
//! `cargo run --example read_case -- CASE PRESSURE`, where `CASE` is any file of the case or its base name.

use std::path::Path;

use strataray_parsers::case::{self, GridSource, RestartSource};
use strataray_parsers::cells::CellArrays;
use strataray_parsers::deck::Grdecl;
use strataray_parsers::egrid::Egrid;
use strataray_parsers::resqml::{GridPart, Package};
use strataray_parsers::restart::{self, Step};
use strataray_parsers::roff::RoffFile;
use strataray_parsers::{ParseError, Warnings, init, volume};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "name a case and a property, such as CASE PRESSURE";
    let (path, property) = arguments.next().zip(arguments.next()).ok_or(usage)?;
    let mut warnings = Warnings::default();
    let files = case::find(Path::new(&path))?;

    let [ni, nj, nk] = match &files.grid {
        GridSource::Egrid(path) => Egrid::read(path, &mut warnings)?.dims,
        GridSource::Roff(path) => RoffFile::open(path)?.dims()?,
        GridSource::Resqml(path) => {
            let package = Package::open(path)?;
            package.grids().first().map_or([0; 3], GridPart::dims)
        }
        GridSource::Volume(path) => {
            volume::open(path, &volume::Options::default())?
                .lattice
                .dims
        }
        GridSource::Deck(path) => Grdecl::read(path, &mut warnings)?.dims,
    };
    println!("{}: {ni} x {nj} x {nk} cells", files.name);

    if let Some(path) = &files.init {
        print_range("INIT", &init::open(path, &mut warnings)?, &property)?;
    }
    let steps = steps(&files.restart, &mut warnings)?;
    println!("{} steps", steps.len());
    for step in &steps {
        print_range(&step.head.time(), &step.arrays, &property)?;
    }
    for warning in warnings.iter() {
        eprintln!("{warning}");
    }
    Ok(())
}

/// The steps of a restart, or of several one after the other.
fn steps(source: &RestartSource, warnings: &mut Warnings) -> Result<Vec<Step>, ParseError> {
    match source {
        RestartSource::None => Ok(Vec::new()),
        RestartSource::Unified(path) => restart::open_unified(path, warnings),
        RestartSource::Separate(files) => restart::open_separate(files, warnings),
        RestartSource::Several(sources) => {
            let mut all = Vec::new();
            for source in sources {
                all.append(&mut steps(source, warnings)?);
            }
            Ok(all)
        }
    }
}

/// Prints the least and the greatest value of the active cells, where the property is there.
fn print_range(place: &str, arrays: &CellArrays, property: &str) -> Result<(), ParseError> {
    if let Some(entry) = arrays.find(property) {
        let values = arrays.values(entry)?;
        let least = values.iter().copied().fold(f32::INFINITY, f32::min);
        let greatest = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        println!("{place}: {property} from {least} to {greatest}");
    }
    Ok(())
}
