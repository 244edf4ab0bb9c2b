//! Situations that people reported: each with a small input built here and, where the folder of real models is there,
//! with the one that was made from the report. The right values stand beside those.

mod decks;
mod faults;
mod restarts;
mod saturations;
mod together;
mod units;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common;
use strataray::case::{Case, load};

/// The input built in a folder, and the reported one where it is at hand.
fn inputs(reported: &str, built: PathBuf) -> Vec<PathBuf> {
    let reported = common::data(&format!("reported/{reported}"));
    std::iter::once(built).chain(reported).collect()
}

#[track_caller]
fn open(path: &Path) -> Case {
    load::open(path).unwrap_or_else(|error| panic!("{error}"))
}

/// Minimum, maximum and mean of a property at a step.
#[track_caller]
fn stats(case: &Case, name: &str, step: usize) -> [f64; 3] {
    let field = case.field(name, step);
    let field = field.unwrap_or_else(|error| panic!("{name}: {error}"));
    let found = field.statistics().unwrap();
    assert_eq!(found.undefined, 0, "{name}");
    [found.min, found.max, found.mean]
}

#[track_caller]
fn near(found: &[f64], expected: &[f64]) {
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
    assert!(
        found.len() == expected.len() && found.iter().zip(expected).all(close),
        "{found:?}, not {expected:?}"
    );
}

fn names(case: &Case) -> Vec<&str> {
    case.properties.iter().map(|p| p.name.as_str()).collect()
}

#[track_caller]
fn told(case: &Case, words: &[&str]) {
    let notes = &case.about.notes;
    let has = |note: &String| words.iter().all(|word| note.contains(word));
    assert!(notes.iter().any(has), "{words:?} in {notes:#?}");
}

/// Runs the program.
fn run<I: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = I>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_strataray"));
    command.args(arguments).output().unwrap()
}

/// What `info --json` says.
fn info<I: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = I>) -> serde_json::Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_strataray"));
    let output = command
        .args(["info", "--json", "--quiet"])
        .args(arguments)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    serde_json::from_slice(&output.stdout).unwrap()
}
