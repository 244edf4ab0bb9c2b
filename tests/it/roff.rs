//! ROFF files as cases.

use std::path::{Path, PathBuf};

use strataray::case::{Case, load};
use strataray_parsers::Warnings;
use strataray_parsers::egrid::Egrid;
use strataray_parsers::roff::{Pillars, RoffGrid, RoffWriter};

use crate::common;

fn grid() -> Pillars {
    let path = common::sample();
    let egrid = Egrid::read(&path, &mut Warnings::default()).unwrap();
    Pillars {
        dims: egrid.dims,
        coord: egrid.coord.iter().map(|v| f64::from(*v)).collect(),
        zcorn: egrid.zcorn.iter().map(|v| f64::from(*v)).collect(),
        actnum: egrid.actnum,
    }
}

fn write(path: &Path, pillars: &Pillars, properties: &[(&str, f32)]) {
    let file = std::fs::File::create(path).unwrap();
    let mut writer = RoffWriter::new(file, &RoffGrid::of(pillars, [0.0; 2])).unwrap();
    let cells = pillars.zcorn.len() / 8;
    for (name, off) in properties {
        let values: Vec<f32> = (0..cells).map(|n| off + n as f32).collect();
        writer.real(name, &values).unwrap();
    }
    writer.finish().unwrap();
}

fn names(case: &Case) -> Vec<&str> {
    let stored = case.properties.iter();
    let stored = stored.filter(|p| p.kind == strataray::case::Kind::Static);
    stored.map(|p| p.name.as_str()).collect()
}

#[test]
fn a_grid_opens_with_the_properties_in_it_beside_it_and_added_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| -> PathBuf { folder.path().join(name) };
    let pillars = grid();
    write(&at("geo.roff"), &pillars, &[("Poro", 0.5)]);
    write(&at("geo--ntg.roff"), &pillars, &[("NTG", 1.0)]);
    write(
        &at("other.roff"),
        &pillars,
        &[("Facies", 2.0), ("Poro", 7.0)],
    );
    let case = load::open(&at("geo.roff")).unwrap();
    assert_eq!(names(&case), ["Poro", "NTG"]);
    // Cell by cell what the same grid has as EGRID.
    let same = load::open(&common::sample()).unwrap();
    assert_eq!(case.grid.active_cells(), same.grid.active_cells());
    let [a, b] = [&case, &same].map(|case| case.grid.signed_bulk_volume());
    assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
    let poro = case.field("PORO", 0).unwrap();
    let cells = case.grid.active_cells().iter().zip(poro.values());
    assert!(cells.clone().all(|(cell, v)| *v == 0.5 + cell.0 as f32));
    // What is added counts over what is there.
    let more = load::open_with(&at("geo.roff"), &[at("other.roff")]).unwrap();
    assert_eq!(names(&more), ["NTG", "Facies", "Poro"]);
    assert_ne!(*more.field("Poro", 0).unwrap(), *poro);
    // By its content, whatever its name.
    std::fs::copy(at("geo.roff"), at("grid.bin")).unwrap();
    assert_eq!(names(&load::open(&at("grid.bin")).unwrap()), ["Poro"]);
}

#[test]
fn what_does_not_fit_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| -> PathBuf { folder.path().join(name) };
    let pillars = grid();
    write(&at("geo.roff"), &pillars, &[]);
    let small = Pillars {
        dims: [1, 1, 1],
        coord: [0.0, 1.0]
            .iter()
            .flat_map(|y| [0.0, 1.0].map(|x| [x, *y, 0.0, x, *y, 9.0]))
            .flatten()
            .collect(),
        zcorn: [[1.0; 4], [2.0; 4]].concat(),
        actnum: None,
    };
    write(&at("small.roff"), &small, &[("A", 0.0)]);
    let said = |path: &str, with: &[PathBuf]| match load::open_with(&at(path), with) {
        Ok(_) => panic!("{path} was opened"),
        Err(error) => error.to_string(),
    };
    let told = said("geo.roff", &[at("small.roff")]);
    assert!(
        told.contains("1 x 1 x 1") && told.contains("40 x 30 x 10"),
        "{told}"
    );
    // Properties alone.
    std::fs::write(
        at("alone.roff"),
        "roff-asc\n#ROFF file#\ntag filedata\nchar filetype \"parameter\"\nendtag\ntag dimensions\nint nX 1\nint nY 1\n\
         int nZ 1\nendtag\ntag parameter\nchar name \"A\"\narray float data 1\n0.25\nendtag\ntag eof\nendtag\n",
    )
    .unwrap();
    let told = said("alone.roff", &[]);
    assert!(
        told.contains("no grid") && told.contains("--with"),
        "{told}"
    );
    let with = load::open_with(&at("small.roff"), &[at("alone.roff")]).unwrap();
    assert_eq!(with.field("A", 0).unwrap().values(), [0.25]);
}
