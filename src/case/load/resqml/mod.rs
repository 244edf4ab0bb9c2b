//! RESQML packages: a grid as pillars and depths on the map, its properties, and steps of a time series.

mod nodes;
mod place;
mod values;

use std::path::Path;

use strataray_parsers::resqml::{GridPart, Package};
use strataray_parsers::roff::Pillars;
use strataray_parsers::units::LengthUnit;
use strataray_parsers::{At, ErrorKind, ParseError};

use nodes::Nodes;
use place::Place;
use values::turned;

pub use values::PackageValues;

/// What is in a package.
pub struct Contents {
    pub pillars: Pillars,
    /// Unit of all lengths.
    pub unit: LengthUnit,
    pub values: PackageValues,
}

/// Reads the first grid of a package that has a geometry and refines no other; what is not read goes into `notes`.
pub fn read(path: &Path, notes: &mut Vec<String>) -> Result<Contents, ParseError> {
    let package = Package::open(path)?;
    let grid = chosen(&package)?;
    notes.extend(other_grids(&package, grid));
    notes.extend(package.not_read().iter().cloned());
    let place = Place::of(&package, package.crs(grid)?)?;
    let geometry = package.geometry(grid)?;
    let dims = geometry.dims;
    if geometry.is_upward {
        notes.push(
            "layers of the package count from the bottom: here layer 1 is the uppermost".into(),
        );
    }
    let uuid = grid.uuid.clone();
    let values = PackageValues::of(package, &uuid, &geometry, notes);
    let nodes = Nodes::of(&geometry, &place);
    let (lines, bent) = nodes.pillars();
    notes.extend(bent.map(|bent| bent.sentence(place.unit)));
    let (zcorn, is_whole) = nodes.depths(&lines);
    let active = values.active(dims, notes);
    let mut actnum: Vec<i32> = is_whole.iter().map(|whole| i32::from(*whole)).collect();
    if let Some(has_cells) = &geometry.has_cells {
        keep(&mut actnum, &turned(dims, geometry.is_upward, has_cells));
    }
    let without = actnum.iter().filter(|a| **a == 0).count();
    if without > 0 {
        notes.push(format!(
            "{without} cells have no geometry: they are inactive"
        ));
    }
    active.iter().for_each(|active| keep(&mut actnum, active));
    Ok(Contents {
        pillars: Pillars {
            dims,
            coord: lines.concat(),
            zcorn,
            actnum: Some(actnum),
        },
        unit: place.unit,
        values,
    })
}

fn keep(actnum: &mut [i32], is_active: &[bool]) {
    let gone = actnum.iter_mut().zip(is_active).filter(|(_, is)| !**is);
    gone.for_each(|(a, _)| *a = 0);
}

/// The grid that is shown.
fn chosen(package: &Package) -> Result<&GridPart, ParseError> {
    let grids = package.grids();
    let main = || grids.iter().filter(|grid| grid.parent().is_none());
    let whole = main().find(|grid| grid.has_geometry());
    // What the others lack is told where they are read.
    whole.or(main().next()).or(grids.first()).ok_or_else(|| {
        let others = match package.not_read() {
            [] => String::new(),
            others => format!(": {}", others.join("; ")),
        };
        let message =
            format!("has no grid of rows, columns and layers (IjkGridRepresentation){others}");
        let kind = ErrorKind::MissingKeyword;
        ParseError::of(kind, package.path(), At::File, "", message)
    })
}

/// One sentence about the grids that are not shown.
fn other_grids(package: &Package, shown: &GridPart) -> Option<String> {
    let others = package.grids().iter().filter(|g| g.uuid != shown.uuid);
    let others = others.map(|grid| {
        let [ni, nj, nk] = grid.dims();
        let what = match (grid.parent(), grid.has_geometry()) {
            (Some(parent), _) => format!(", in a window of {parent}"),
            (None, false) => ", without geometry".into(),
            (None, true) => String::new(),
        };
        format!("{} ({ni} x {nj} x {nk}{what})", grid.title)
    });
    let others: Vec<String> = others.collect();
    (!others.is_empty()).then(|| {
        let shown = &shown.title;
        format!(
            "the package has several grids: {shown} is shown, and not {}",
            others.join(", ")
        )
    })
}
