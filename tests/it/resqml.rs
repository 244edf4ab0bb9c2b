//! RESQML packages as cases: what resqpy wrote, and what it reads there.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use strataray::case::{Case, Kind, load};
use strataray::model::CellIndex;

/// The package that comes with the tests.
fn small() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/resqml/small.epc")
}

/// What resqpy reads in a package.
fn facts(package: &Path) -> Value {
    let text = std::fs::read_to_string(package.with_extension("json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Largest distance of a corner of an active cell from where the facts have it.
fn farthest(case: &Case, facts: &Value) -> f64 {
    let corners = facts["corners"].as_array().unwrap();
    let mut most = 0.0_f64;
    for cell in case.grid.active_cells() {
        let hexahedron = case.grid.hexahedron(case.grid.dims().ijk(*cell));
        for (corner, found) in hexahedron.0.iter().enumerate() {
            let at = 3 * (8 * cell.0 as usize + corner);
            for (axis, found) in found.to_array().iter().enumerate() {
                let off = (found - number(&corners[at + axis])).abs();
                most = if off.is_nan() {
                    f64::INFINITY
                } else {
                    most.max(off)
                };
            }
        }
    }
    most
}

/// What differs from the facts beside corners: cells, units, steps, values.
fn differences(case: &Case, facts: &Value) -> Vec<String> {
    let mut found = Vec::new();
    let mut note = |is_equal: bool, what: String| found.extend((!is_equal).then_some(what));
    let dims = case.grid.dims();
    note(
        facts["dims"] == serde_json::json!([dims.ni, dims.nj, dims.nk]),
        "dims".into(),
    );
    note(
        facts["unit"] == case.about.length_unit.as_str(),
        "unit".into(),
    );
    let active = facts["active"].as_array().unwrap();
    let is_active = |n: usize| case.grid.active_index(CellIndex(n as u32)).is_some();
    note(
        (0..active.len()).all(|n| active[n] == is_active(n)),
        "active cells".into(),
    );
    note(
        facts["times"].as_array().unwrap().len() == case.steps.len(),
        "steps".into(),
    );
    let mut count = 0;
    for (name, steps) in facts["properties"].as_object().unwrap() {
        if name == "ACTIVE" {
            continue;
        }
        count += 1;
        for (step, values) in steps.as_object().unwrap() {
            let field = case.field(name, step.parse().unwrap_or(0));
            let cells = case.grid.active_cells().iter();
            let expected = cells.map(|cell| number(&values[cell.0 as usize]) as f32);
            let is_equal = field.is_ok_and(|field| {
                let pairs = field.values().iter().zip(expected);
                pairs
                    .into_iter()
                    .all(|(a, b)| *a == b || a.is_nan() && b.is_nan())
            });
            note(is_equal, format!("{name} at {step}"));
        }
    }
    let stored = case.properties.iter().filter(|p| p.kind != Kind::Derived);
    note(stored.count() == count, "properties".into());
    found
}

/// Compares a case with the facts, and with others that it must not agree with.
fn agrees(package: &Path) {
    let case = load::open(package).unwrap();
    let facts = facts(package);
    let name = package.display();
    assert_eq!(differences(&case, &facts), [""; 0], "{name}");
    let off = farthest(&case, &facts);
    assert!(off < 1e-6, "{name}: {off} {:?}", case.about.notes);
    let mut twin = facts.clone();
    let last = twin["corners"].as_array_mut().unwrap().last_mut().unwrap();
    *last = (number(last) + 1e-4).into();
    assert!(farthest(&case, &twin) > 1e-5, "{name}");
    for steps in twin["properties"].as_object_mut().unwrap().values_mut() {
        for values in steps.as_object_mut().unwrap().values_mut() {
            let last = values.as_array_mut().unwrap().last_mut().unwrap();
            *last = (number(last) + 1.0).into();
        }
    }
    let last = twin["active"].as_array_mut().unwrap().last_mut().unwrap();
    *last = (!last.as_bool().unwrap()).into();
    let differs = differences(&case, &twin);
    assert!(differs[0] == "active cells", "{differs:?}");
}

#[test]
fn ok_a_package_agrees_with_what_resqpy_reads() {
    agrees(&small());
    let case = load::open(&small()).unwrap();
    assert_eq!(case.about.files.len(), 2);
    assert_eq!(case.unit("PRESSURE"), "bar");
    assert_eq!(case.unit("PORO"), "");
    let dates: Vec<&str> = case.steps.iter().map(|s| s.date.as_str()).collect();
    assert_eq!(dates, ["2020-01-01", "2020-02-01"]);
    assert_eq!(case.steps[1].days, 31.0);
    assert_eq!(case.about.notes, [""; 0]);
}

#[test]
fn a_package_is_known_by_its_content_and_finds_its_arrays() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::copy(small(), at("model.bin")).unwrap();
    let said = |path: &Path| match load::open(path) {
        Ok(_) => panic!("{} was opened", path.display()),
        Err(error) => error.to_string(),
    };
    let told = said(&at("model.bin"));
    assert!(
        told.contains("small.h5") && told.contains("arrays"),
        "{told}"
    );
    // Under the name that the package has for them, or under its own.
    for name in ["small.h5", "model.h5"] {
        std::fs::copy(small().with_extension("h5"), at(name)).unwrap();
        assert_eq!(
            load::open(&at("model.bin")).unwrap().properties[0].name,
            "PORO"
        );
        std::fs::remove_file(at(name)).unwrap();
    }
    std::fs::write(at("small.h5"), "no arrays").unwrap();
    let told = said(&at("model.bin"));
    assert!(
        told.contains("small.h5") && told.contains("no HDF5 file"),
        "{told}"
    );
    // No package at all.
    std::fs::write(at("text.epc"), "no package").unwrap();
    let told = said(&at("text.epc"));
    assert!(
        told.contains("text.epc") && told.contains("package"),
        "{told}"
    );
}

/// Packages of all kinds by resqpy; `None` where there is no Python with it, which the variable STRATARAY_PYTHON names.
fn written_by_resqpy(folder: &Path) -> Option<()> {
    let python = std::env::var_os("STRATARAY_PYTHON").unwrap_or_else(|| "python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/resqml.py");
    let Ok(made) = Command::new(&python).arg(script).arg(folder).output() else {
        eprintln!("SKIPPED: there is no {}", python.display());
        return None;
    };
    if made.status.code() == Some(77) {
        eprintln!("SKIPPED: {}", String::from_utf8_lossy(&made.stdout));
        return None;
    }
    let said = String::from_utf8_lossy(&made.stderr);
    assert!(made.status.success(), "{said}");
    Some(())
}

#[test]
fn ok_packages_agree_with_what_resqpy_reads() {
    let folder = tempfile::tempdir().unwrap();
    if written_by_resqpy(folder.path()).is_none() {
        return;
    }
    let at = |name: &str| folder.path().join(format!("{name}.epc"));
    for name in [
        "plain",
        "faulted",
        "lines",
        "gaps",
        "upward",
        "mixed",
        "feet",
        "undefined",
        "small",
    ] {
        agrees(&at(name));
    }
    let notes = |name: &str| load::open(&at(name)).unwrap().about.notes.join("; ");
    assert_eq!(notes("faulted"), "");
    assert!(
        notes("upward").contains("layer 1 is the uppermost"),
        "{}",
        notes("upward")
    );
    assert!(
        notes("undefined").contains("3 cells have no geometry"),
        "{}",
        notes("undefined")
    );
    // Pillars that are not straight: corners are off by no more than is told.
    let bent = load::open(&at("bent")).unwrap();
    let off = farthest(&bent, &facts(&at("bent")));
    let told = bent.about.notes.join("; ");
    assert!(
        told.contains("pillars are not straight") && off > 0.1,
        "{off} {told}"
    );
    let most = told
        .split("up to ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next())
        .unwrap();
    assert!(
        (most.parse::<f64>().unwrap() - off).abs() < 2e-3,
        "{off} {told}"
    );
    assert_eq!(differences(&bent, &facts(&at("bent"))), [""; 0]);
}
