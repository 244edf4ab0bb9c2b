//! Saturations that files leave out.

use std::path::{Path, PathBuf};

use super::{info, inputs, names, near, open, stats};
use crate::common::tiny;

fn case(folder: &Path, phases: i32, arrays: tiny::Arrays<'_>) -> PathBuf {
    let path = tiny::write_egrid(folder, "A", &tiny::egrid());
    let head = tiny::head(tiny::CELLS, phases, "2030-01-01");
    tiny::write(folder, "A.UNRST", tiny::restart(&[(head, arrays)]));
    path
}

fn ramp(from: f32, to: f32) -> Vec<f32> {
    let at = |n: usize| from + (to - from) * n as f32 / 119.0;
    (0..tiny::CELLS).map(at).collect()
}

#[test]
fn f05_solvent_takes_its_part_of_the_pore_space() {
    let folder = tempfile::tempdir().unwrap();
    let arrays = vec![
        ("SWAT", vec![0.3; 120]),
        ("SGAS", vec![0.1; 120]),
        ("SSOLVENT", ramp(0.0, 0.4)),
    ];
    for path in inputs("F05_SOLVENT.EGRID", case(folder.path(), 7, arrays)) {
        let case = open(&path);
        near(&stats(&case, "SOIL", 0), &[0.2, 0.6, 0.4]);
        let facts = info([&path]);
        let properties = facts["properties"].as_array().unwrap();
        let soil = properties.iter().find(|p| p["name"] == "SOIL").unwrap();
        assert_eq!(soil["formula"], "1 - SWAT - SGAS - SSOLVENT");
    }
}

#[test]
fn f18_gas_and_water_alone() {
    let folder = tempfile::tempdir().unwrap();
    let built = case(folder.path(), 6, vec![("SWAT", ramp(0.2, 0.9))]);
    for path in inputs("F18_GASWAT.EGRID", built) {
        let case = open(&path);
        near(&stats(&case, "SGAS", 0), &[0.1, 0.8, 0.45]);
        assert!(!names(&case).contains(&"SOIL"), "{:?}", names(&case));
        let gas = case.property("SGAS").unwrap();
        assert_eq!(gas.formula().as_deref(), Some("1 - SWAT"));
        assert_eq!((gas.steps, &gas.doubt), (1, &None));
    }
}

#[test]
fn oil_is_doubted_where_its_gas_is_not_in_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = case(folder.path(), 7, vec![("SWAT", ramp(0.2, 0.9))]);
    let soil = open(&path);
    let soil = soil.property("SOIL").unwrap();
    let doubt = soil.doubt.clone().unwrap_or_default();
    assert!(doubt.contains("SGAS is not in the files"), "{doubt}");
    let path = case(folder.path(), 3, vec![("SWAT", ramp(0.2, 0.9))]);
    assert_eq!(open(&path).property("SOIL").unwrap().doubt, None);
}

#[test]
fn a_property_that_is_all_zero_is_known_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let arrays = vec![("SWAT", ramp(0.2, 0.9)), ("SGAS", vec![0.0; 120])];
    let case = open(&case(folder.path(), 7, arrays));
    assert!(case.is_all_zero("SGAS", 0).unwrap());
    assert!(!case.is_all_zero("SWAT", 0).unwrap());
    assert!(case.is_all_zero("SNONE", 0).is_err());
}
