//! Summary vectors: found beside a case or added to it, told by the command.

use std::path::Path;

use serde_json::{Value, json};

use crate::common;
use strataray::case::{VectorKind, load};

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
