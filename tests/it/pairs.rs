//! Several cases on one grid: pairs with other steps or active cells, statistics over realizations; and results of other
//! names, folders and forms.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use serde_json::Value;
use strataray::case::load::{self, CasePaths};
use strataray::case::{Case, CaseError, GridPool, Minus, Statistic, ensemble, minus};

use crate::common::{self, tiny};

/// Cells of the small grid.
const CELLS: usize = 120;

/// A case in a folder of its own, whose SWAT is `swat` at each of some dates.
fn written(folder: &Path, dates: &[&str], actnum: Option<Vec<i32>>, swat: f32) -> PathBuf {
    std::fs::create_dir_all(folder).unwrap();
    let mut grid = tiny::egrid();
    let active = actnum
        .as_ref()
        .map_or(CELLS, |a| a.iter().filter(|flag| **flag != 0).count());
    grid.actnum = actnum;
    restart(folder, "RUN.UNRST", dates, active, swat);
    tiny::write_egrid(folder, "RUN", &grid)
}

fn restart(folder: &Path, name: &str, dates: &[&str], active: usize, swat: f32) -> PathBuf {
    let step = |date: &&str| {
        (
            tiny::head(active, 3, date),
            vec![("SWAT", vec![swat; active])],
        )
    };
    let steps: Vec<_> = dates.iter().map(step).collect();
    tiny::write(folder, name, tiny::restart(&steps))
}

fn open(path: &Path) -> Arc<Case> {
    Arc::new(load::open(path).unwrap())
}

fn of_swat() -> Minus {
    Minus {
        name: "SWAT-SWAT@B".into(),
        now: "SWAT".into(),
        base: "SWAT".into(),
    }
}

#[track_caller]
fn told(notes: &[String], words: &[&str]) {
    let has = |note: &String| words.iter().all(|word| note.contains(word));
    assert!(notes.iter().any(has), "{words:?} in {notes:#?}");
}

/// What the program says of a case.
fn info(arguments: &[&str], paths: &[&Path]) -> (bool, Value, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(["info", "--json"])
        .args(paths)
        .args(arguments)
        .output()
        .unwrap();
    let facts = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let said = String::from_utf8(output.stderr).unwrap();
    (output.status.success(), facts, said)
}

#[test]
fn steps_of_two_cases_are_matched_by_date_alone() {
    let folder = tempfile::tempdir().unwrap();
    let a = written(
        &folder.path().join("a"),
        &["2030-01-01", "2030-02-01", "2030-03-01"],
        None,
        0.75,
    );
    let b = written(
        &folder.path().join("b"),
        &["2030-01-01", "2030-03-01", "2030-03-02"],
        None,
        0.25,
    );
    let case = minus(&open(&a), &open(&b), &[of_swat()], None).unwrap();
    for step in [0, 2] {
        let field = case.field("SWAT-SWAT@B", step).unwrap();
        assert!(field.values().iter().all(|v| *v == 0.5), "{step}");
    }
    let missing = case.field("SWAT-SWAT@B", 1).unwrap_err();
    assert!(missing.is_gap() && missing.to_string().contains("2030-02-01"));
    told(&case.about.notes, &["1 of 3 steps", "a/RUN", "2030-02-01"]);
    // The command does the same, and tells cases of one name by their folders.
    let (is_done, facts, said) = info(
        &["--minus", b.to_str().unwrap(), "--stats", "SWAT-SWAT@b/RUN"],
        &[&a],
    );
    assert!(is_done, "{said}");
    assert_eq!(facts["case"], "a/RUN minus b/RUN");
    assert_eq!(facts["stats"]["SWAT-SWAT@b/RUN"]["mean"], 0.5);
    assert!(said.contains("2030-02-01"), "{said}");
}

#[test]
fn cells_of_one_case_alone_have_no_difference_and_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let dates = ["2030-01-01"];
    let off = |first: usize| {
        (0..CELLS)
            .map(|n| i32::from(n < first || n >= first + 3))
            .collect()
    };
    let a = open(&written(
        &folder.path().join("a"),
        &dates,
        Some(off(0)),
        0.75,
    ));
    let b = open(&written(
        &folder.path().join("b"),
        &dates,
        Some(off(1)),
        0.25,
    ));
    let case = minus(&a, &b, &[of_swat()], None).unwrap();
    let field = case.field("SWAT-SWAT@B", 0).unwrap();
    // Cell 3, the first that is active in a, is not active in b.
    assert!(field.values()[0].is_nan());
    assert!(field.values()[1..].iter().all(|v| *v == 0.5));
    told(
        &case.about.notes,
        &["1 cells are active in a/RUN and not in b/RUN"],
    );
    told(
        &case.about.notes,
        &["1 cells are active in b/RUN and not in a/RUN"],
    );
    let same = minus(&a, &a, &[of_swat()], None).unwrap();
    assert!(same.about.notes.is_empty(), "{:?}", same.about.notes);
}

#[test]
fn other_grids_are_refused_with_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let dates = ["2030-01-01"];
    let a = open(&written(&folder.path().join("a"), &dates, None, 0.75));
    let mut grid = tiny::egrid();
    let last = grid.zcorn.len() - 1;
    grid.zcorn[last] += 2.5;
    let moved = folder.path().join("moved");
    std::fs::create_dir_all(&moved).unwrap();
    restart(&moved, "RUN.UNRST", &dates, CELLS, 0.25);
    let moved = open(&tiny::write_egrid(&moved, "RUN", &grid));
    let why = |b: &Arc<Case>| minus(&a, b, &[of_swat()], None).err().unwrap();
    let refused = why(&moved);
    assert!(
        refused.contains("I 6  J 5  K 4") && refused.contains("2.500"),
        "{refused}"
    );
    let sample = open(&common::sample());
    let refused = why(&sample);
    assert!(
        refused.contains("6 x 5 x 4") && refused.contains("40 x 30 x 10"),
        "{refused}"
    );
    assert!(ensemble(&[a.clone(), moved]).is_err());
    assert!(ensemble(&[a]).err().unwrap().contains("two"));
}

#[test]
fn statistics_are_over_the_cases_of_a_date() {
    let folder = tempfile::tempdir().unwrap();
    let both = ["2030-01-01", "2030-02-01"];
    let at = |name: &str| folder.path().join(name).join("RUN.EGRID");
    for (name, dates, swat) in [
        ("a", &both[..], 0.1_f32),
        ("b", &both[..], 0.2),
        ("c", &both[..1], 0.6),
    ] {
        written(&folder.path().join(name), dates, None, swat);
    }
    let paths = CasePaths {
        others: ["b", "c"].map(|name| CasePaths::of(at(name))).into(),
        ..CasePaths::of(at("a"))
    };
    let pool = GridPool::default();
    let case = load::open_paths(&paths, &pool, &|_| true).unwrap().unwrap();
    let value = |name: &str, step: usize| case.field(name, step).unwrap().values()[7];
    let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a}, not {b}");
    near(value("SWAT.MEAN", 0), 0.3);
    near(value("SWAT.STD", 0), 0.07_f32.sqrt());
    near(value("SWAT.P50", 0), 0.2);
    near(value("SWAT.P10", 0), 0.12);
    near(value("SWAT.MAX", 0), 0.6);
    // Where a case has no step of the date, it is of the others, and that is said.
    near(value("SWAT.MEAN", 1), 0.15);
    told(
        &case.about.notes,
        &["1 of 2 steps of a/RUN", "c/RUN", "2030-02-01"],
    );
    // What follows from others has statistics, what follows from the grid has none.
    near(value("SOIL.MEAN", 0), 0.7);
    assert!(matches!(
        case.field("DEPTH.MEAN", 0),
        Err(CaseError::UnknownProperty { .. })
    ));
    near(value("SWAT", 0), 0.1);
    assert_eq!(case.statistic("SWAT.P90"), Some(("SWAT", Statistic::P90)));
    assert_eq!(case.title_of("SWAT.MEAN"), "SWAT, mean of up to 3 cases");
    // It can be subtracted as any property is.
    near(value("SWAT.MEAN-SWAT.MEAN@1", 0), 0.15);
    let (is_done, facts, said) = info(
        &[
            "--stats",
            "SWAT.MEAN@2030-02-01",
            "--ensemble",
            at("b").to_str().unwrap(),
            at("c").to_str().unwrap(),
        ],
        &[&at("a")],
    );
    assert!(is_done, "{said}");
    let mean = facts["stats"]["SWAT.MEAN@2030-02-01"]["mean"]
        .as_f64()
        .unwrap();
    assert!((mean - 0.15).abs() < 1e-6, "{mean}");
}

#[test]
fn restarts_of_one_run_are_put_together_by_date() {
    let folder = tempfile::tempdir().unwrap();
    let case = written(folder.path(), &["2029-01-01"], None, 0.9);
    let first = ["2030-01-01", "2030-02-01", "2030-03-01"];
    let base = restart(folder.path(), "BASE.UNRST", &first, CELLS, 0.1);
    let next = ["2030-03-01", "2030-04-01"];
    let next = restart(folder.path(), "NEXT.UNRST", &next, CELLS, 0.2);
    // In whatever order they are named, the run that begins later goes on from the other.
    for with in [[base.clone(), next.clone()], [next.clone(), base]] {
        let case = load::open_with(&case, &with).unwrap();
        let dates: Vec<_> = case.steps.iter().map(|s| s.date.as_str()).collect();
        assert_eq!(
            dates,
            ["2030-01-01", "2030-02-01", "2030-03-01", "2030-04-01"]
        );
        let swat = |step| case.field("SWAT", step).unwrap().values()[0];
        assert_eq!([0, 1, 2, 3].map(swat), [0.1, 0.1, 0.2, 0.2]);
        // Both count days from 0.
        assert!(
            case.steps.is_sorted_by(|a, b| a.days < b.days),
            "{:?}",
            case.steps
        );
        assert_eq!(case.steps[3].days, 90.0);
        told(
            &case.about.notes,
            &["2030-03-01", "that of NEXT.UNRST is shown"],
        );
        told(
            &case.about.notes,
            &["RUN.UNRST was not read", "add this file too"],
        );
    }
    // One alone takes the place of the case's own.
    let alone = load::open_with(&case, &[next]).unwrap();
    assert_eq!(alone.steps.len(), 2);
    assert_eq!(load::open(&case).unwrap().steps.len(), 1);
}

#[test]
fn results_of_another_size_are_refused_with_both_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let case = written(folder.path(), &["2030-01-01"], None, 0.5);
    let fewer = restart(
        folder.path(),
        "FEWER.UNRST",
        &["2030-02-01"],
        CELLS - 1,
        0.5,
    );
    let opened = load::open_with(&case, std::slice::from_ref(&fewer)).unwrap();
    assert!(opened.steps.is_empty());
    told(&opened.about.notes, &["119 active cells", "120"]);
    // As many cells in another shape are another grid too.
    let head = strataray_parsers::cells::Head {
        dims: [5, 6, 4],
        ..tiny::head(CELLS, 3, "2030-02-01")
    };
    let turned = tiny::restart(&[(head, vec![("SWAT", vec![0.5; CELLS])])]);
    let turned = tiny::write(folder.path(), "TURNED.UNRST", turned);
    let opened = load::open_with(&case, &[turned]).unwrap();
    assert!(opened.steps.is_empty());
    told(&opened.about.notes, &["5 x 6 x 4", "6 x 5 x 4"]);
    // Of several restarts those that fit are read.
    let own = case.with_extension("UNRST");
    let opened = load::open_with(&case, &[own, fewer]).unwrap();
    assert_eq!(opened.steps.len(), 1);
    told(&opened.about.notes, &["119 active cells", "120"]);
}

#[test]
fn grid_and_results_may_have_other_forms_names_and_folders() {
    let Some(grid) = common::data("formatted/SPE1CASE1.FEGRID") else {
        return;
    };
    let results = common::data("spe1/SPE1CASE1.UNRST").unwrap();
    let init = common::data("spe1/SPE1CASE1.INIT").unwrap();
    let summary = common::data("spe1/SPE1CASE1.SMSPEC");
    let folder = tempfile::tempdir().unwrap();
    let moved = folder.path().join("OTHER.FEGRID");
    std::fs::copy(&grid, &moved).unwrap();
    let with: Vec<_> = [results, init].into_iter().chain(summary).collect();
    let case = load::open_with(&moved, &with).unwrap();
    assert_eq!(case.steps.len(), load::open(&grid).unwrap().steps.len());
    assert!(case.property("PORO").is_ok() && case.property("PRESSURE").is_ok());
    // Separate files of steps from another folder, in any order.
    let brugge = common::data("brugge/BRUGGE_0000.EGRID").unwrap();
    let moved = folder.path().join("OTHER.EGRID");
    std::fs::copy(&brugge, &moved).unwrap();
    let with = ["X0004", "X0001"].map(|ending| brugge.with_extension(ending));
    let case = load::open_with(&moved, &with).unwrap();
    let reports: Vec<_> = case.steps.iter().map(|s| s.report).collect();
    assert_eq!(reports, [1, 4]);
    assert!(load::open(&moved).unwrap().steps.is_empty());
}

#[test]
fn it_is_said_which_file_shows_a_property_of_two() {
    let folder = tempfile::tempdir().unwrap();
    let case = written(folder.path(), &["2030-01-01"], None, 0.5);
    let head = tiny::head(CELLS, 3, "2030-01-01");
    let arrays = [("PORO", vec![0.3; CELLS]), ("SWAT", vec![0.1; CELLS])];
    tiny::write(folder.path(), "RUN.INIT", tiny::init(&head, &arrays));
    let text = tiny::write(folder.path(), "poro.inc", tiny::porosity_text());
    let both = load::open_with(&case, &[text]).unwrap();
    told(&both.about.notes, &["PORO of the INIT file", "text file"]);
    told(&both.about.notes, &["SWAT of the INIT file", "restart"]);
    let alone = load::open(&case).unwrap();
    assert!(!alone.about.notes.iter().any(|note| note.contains("PORO")));
    assert_eq!(alone.field("PORO", 0).unwrap().values()[0], 0.3);
}
