//! Summary vectors: found beside a case or added to it, told by the command.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};
use strataray_parsers::records::RecordWriter;

use crate::common::{self, tiny};
use strataray::case::{VectorKind, Vectors, load};

fn told(arguments: &[&Path]) -> Value {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(["info", "--json", "--summary", "--quiet"])
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success());
    serde_json::from_slice::<Value>(&output.stdout).unwrap()["summary"].clone()
}

#[test]
fn vectors_are_found_beside_a_case_and_by_with() {
    let Some(reek) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let names = told(&[&reek]);
    let names = names.as_array().unwrap();
    // As resdata counts them, TIME beside its own, and without second names for cells by number.
    assert_eq!(names.len(), 434);
    for name in ["FOPR", "WOPR:OP_1", "BPR:15,28,10", "RPR:3"] {
        assert!(names.contains(&json!(name)), "{name}");
    }
    // A case without a summary takes that of another name.
    let brugge = common::data("brugge/BRUGGE_0000.EGRID").unwrap();
    assert_eq!(told(&[&brugge]), json!([]));
    let other = reek.with_extension("UNSMRY");
    let added = told(&[&brugge, Path::new("--with"), &other]);
    assert_eq!(added.as_array().unwrap(), names);
}

#[test]
fn vectors_have_values_and_say_what_they_are_of() {
    let Some(reek) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let vectors = load::open(&reek).unwrap().vectors().unwrap().unwrap();
    let values = |name: &str| {
        let place = vectors.find(name).unwrap();
        (&vectors.list[place], vectors.values(place).unwrap())
    };
    // Read by resdata.
    let (total, volumes) = values("FOPT");
    assert_eq!(volumes.last(), Some(&7_255_056.0));
    assert_eq!(
        (total.kind, total.unit.as_str()),
        (VectorKind::Field, "SM3")
    );
    assert_eq!((vectors.days.len(), vectors.days[44]), (45, 1097.0));
    let (rate, _) = values("wopr:op_1");
    assert_eq!(rate.well.as_deref(), Some("OP_1"));
    assert!(!rate.is_history && values("WOPRH:OP_1").0.is_history);
    assert!(vectors.find("WOPR:NONE").is_none());
}

#[test]
fn places_kept_free_for_wells_are_no_vectors() {
    let Some(file) = common::data("lgr_nnc/SIMPLE_SUMMARY2.EGRID") else {
        return;
    };
    let vectors = load::open(&file).unwrap().vectors().unwrap().unwrap();
    assert!(vectors.find("WOPR:P1").is_some() && vectors.find("WOPR").is_none());
    // Those that are left have the values of their own places.
    let place = vectors.find("FOPT").unwrap();
    let values = vectors.values(place).unwrap();
    assert!(values.is_sorted() && values.last() > Some(&0.0));
}

/// Writes SMSPEC and UNSMRY with the times of a run, FOPR and perhaps FWPR, whose values are those times.
fn run(folder: &Path, name: &str, restart: &str, keywords: &[&str], days: &[f32]) -> PathBuf {
    let mut spec = RecordWriter::new(Vec::new());
    // Paths stand in parts of eight letters.
    let parts = restart.as_bytes().chunks(8);
    let parts = parts.map(|part| String::from_utf8(part.to_vec()).unwrap());
    let parts: Vec<String> = parts.collect();
    spec.chars("RESTART", &parts).unwrap();
    spec.inte("DIMENS", &[3, 6, 5, 4, 0, -1]).unwrap();
    let all: Vec<&str> = ["TIME"]
        .into_iter()
        .chain(keywords.iter().copied())
        .collect();
    spec.chars("KEYWORDS", &all).unwrap();
    spec.chars("WGNAMES", &vec![":+:+:+:+"; all.len()]).unwrap();
    spec.inte("NUMS", &vec![0; all.len()]).unwrap();
    let units: Vec<&str> = all
        .iter()
        .map(|k| if *k == "TIME" { "DAYS" } else { "SM3/DAY" })
        .collect();
    spec.chars("UNITS", &units).unwrap();
    spec.inte("STARTDAT", &[1, 1, 2030]).unwrap();
    let mut data = RecordWriter::new(Vec::new());
    for (n, days) in days.iter().enumerate() {
        data.inte("SEQHDR", &[n as i32 + 1]).unwrap();
        data.inte("MINISTEP", &[n as i32]).unwrap();
        data.real("PARAMS", &vec![*days; all.len()]).unwrap();
    }
    std::fs::create_dir_all(folder).unwrap();
    tiny::write(folder, &format!("{name}.UNSMRY"), data.finish().unwrap());
    tiny::write(folder, &format!("{name}.SMSPEC"), spec.finish().unwrap())
}

fn vectors(grid: &Path) -> Arc<Vectors> {
    load::open(grid).unwrap().vectors().unwrap().unwrap()
}

fn values(vectors: &Vectors, name: &str) -> Vec<f32> {
    vectors.values(vectors.find(name).unwrap()).unwrap()
}

fn is_told(vectors: &Vectors, words: &[&str]) -> bool {
    let has = |note: &String| words.iter().all(|word| note.contains(word));
    vectors.notes.iter().any(has)
}

#[test]
fn a_run_that_goes_on_from_another_has_its_curves_too() {
    let folder = tempfile::tempdir().unwrap();
    let base = folder.path().join("base case");
    run(&base, "BASE", "", &["FOPR"], &[10.0, 20.0, 30.0, 40.0]);
    let grid = tiny::write_egrid(folder.path(), "NEXT", &tiny::egrid());
    run(
        folder.path(),
        "NEXT",
        "base case/BASE",
        &["FOPR", "FWPR"],
        &[30.0, 50.0],
    );
    let both = vectors(&grid);
    // What the run before went on with is not of this one.
    assert_eq!(both.days, [10.0, 20.0, 30.0, 50.0]);
    assert_eq!(values(&both, "FOPR"), [10.0, 20.0, 30.0, 50.0]);
    let water = values(&both, "FWPR");
    assert!(water[..2].iter().all(|v| v.is_nan()) && water[2..] == [30.0, 50.0]);
    assert!(
        is_told(&both, &["2030-01-31", "BASE.SMSPEC"]),
        "{:?}",
        both.notes
    );
    // A name that leads nowhere is said, and so is one that leads back.
    run(folder.path(), "NEXT", "gone/BASE", &["FOPR"], &[30.0, 50.0]);
    let alone = vectors(&grid);
    assert_eq!(alone.days, [30.0, 50.0]);
    assert!(
        is_told(&alone, &["gone/BASE", "no summary"]),
        "{:?}",
        alone.notes
    );
    run(
        folder.path(),
        "NEXT",
        "base case/BASE",
        &["FOPR"],
        &[30.0, 50.0],
    );
    run(&base, "BASE", "../NEXT", &["FOPR"], &[10.0]);
    let circle = vectors(&grid);
    assert_eq!(circle.days, [10.0, 30.0, 50.0]);
    assert!(
        is_told(&circle, &["../NEXT", "this run itself"]),
        "{:?}",
        circle.notes
    );
}

#[test]
fn a_summary_that_grows_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let grid = tiny::write_egrid(folder.path(), "RUN", &tiny::egrid());
    run(folder.path(), "RUN", "", &["FOPR"], &[10.0]);
    let case = load::open(&grid).unwrap();
    let read = || case.vectors().unwrap().unwrap();
    assert_eq!(read().days, [10.0]);
    assert!(Arc::ptr_eq(&read(), &read()));
    run(folder.path(), "RUN", "", &["FOPR"], &[10.0, 20.0]);
    assert_eq!(values(&read(), "FOPR"), [10.0, 20.0]);
}

#[test]
fn a_summary_of_another_grid_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let grid = tiny::write_egrid(folder.path(), "RUN", &tiny::egrid());
    run(folder.path(), "RUN", "", &["FOPR"], &[10.0]);
    let words = ["DIMENS", "another grid"];
    assert!(!is_told(&vectors(&grid), &words));
    let other = common::copy_of_sample(folder.path());
    for ending in ["SMSPEC", "UNSMRY"] {
        let own = grid.with_extension(ending);
        std::fs::copy(own, other.with_extension(ending)).unwrap();
    }
    let told = vectors(&other);
    assert!(is_told(&told, &words) && is_told(&told, &["6 x 5 x 4", "40 x 30 x 10"]));
}
