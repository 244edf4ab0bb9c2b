//! `info --json` against facts about the same files from independent programs.
#![allow(clippy::too_many_lines, clippy::cmp_owned, reason = "tests")]

use std::path::Path;
use std::process::Command;

use crate::common;
use serde_json::Value;

fn info(case: &Path, stats: &[String]) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_strataray"));
    command.arg("info").arg(case).args(["--json", "--quiet"]);
    for name in stats {
        command.args(["--stats", name]);
    }
    let output = command.output().unwrap();
    assert!(
        output.status.success(),
        "{}: {}",
        case.display(),
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

fn close(found: &Value, expected: &Value, relative: f64, absolute: f64, what: &str) {
    let (a, b) = (found.as_f64(), expected.as_f64());
    let (Some(a), Some(b)) = (a, b) else {
        panic!("{what}: found {found}, expected {expected}")
    };
    assert!(
        (a - b).abs() <= relative * b.abs() + absolute,
        "{what}: found {a}, expected {b}"
    );
}

/// Compares all that both sides state; gives the number of facts compared.
fn compare(case: &str, folder: &Path, facts: &Value) -> usize {
    let grid = &facts["grid"];
    let dual = facts["dual_porosity"] == true;
    let (stats, expected_stats) = statistics(facts, dual);
    let info = info(&folder.join(case), &stats);
    let mut compared = 8;
    assert_eq!(
        info["dims"],
        serde_json::json!([grid["ni"], grid["nj"], grid["nk"]]),
        "{case}"
    );
    assert_eq!(info["cells"], grid["cells_total"], "{case}");
    assert_eq!(info["active"], grid["active_cells"], "{case}");
    for (n, axis) in ["x", "y", "z"].iter().enumerate() {
        for (end, name) in [(0, "min"), (1, "max")] {
            close(
                &info["bounds"][name][n],
                &grid["bbox_active_raw"][axis][end],
                1e-7,
                1e-6,
                case,
            );
        }
    }
    close(
        &info["bulk_volume"],
        &grid["bulk_volume_active_trilinear"],
        1e-6,
        0.0,
        case,
    );
    let right = grid["handedness_signed_volume_positive"] == true;
    assert_eq!(
        info["handedness"],
        if right { "right" } else { "left" },
        "{case}"
    );
    assert_eq!(
        info["thin_cells"], grid["zero_thickness_active_cells"],
        "{case}"
    );
    let faults = &grid["fault_faces_active_pairs"]["tol_0.001"];
    assert_eq!(
        [&info["fault_faces"]["i"], &info["fault_faces"]["j"]],
        [&faults["I"], &faults["J"]],
        "{case}"
    );
    if let Some(nnc) = facts["nnc"].get("nnc_global_global") {
        assert_eq!(&info["nnc"], nnc, "{case}");
        compared += 1;
    }
    if let Some(count) = facts["lgr_count"].as_u64() {
        assert_eq!(
            info["lgr"].as_array().unwrap().len() as u64,
            count,
            "{case}"
        );
    }
    for (name, expected) in stats.iter().zip(&expected_stats) {
        for what in ["min", "max", "mean"] {
            close(
                &info["stats"][name][what],
                &expected[what],
                1e-6,
                1e-9,
                &format!("{case} {name} {what}"),
            );
            compared += 1;
        }
    }
    compared + compare_local(case, folder, facts) + compare_steps(case, &info, facts)
}

/// Compares local grids, with their values in INIT and at the last step.
fn compare_local(case: &str, folder: &Path, facts: &Value) -> usize {
    let grids = facts["lgrs"].as_array().cloned().unwrap_or_default();
    let mut compared = 0;
    for (n, grid) in grids.iter().enumerate() {
        let name = grid["name"].as_str().unwrap();
        let last = facts["restart"]["report_steps"]
            .as_array()
            .map_or(0, Vec::len);
        let tables = [
            (&facts["init"]["lgr_stats"][name], String::new()),
            (
                &facts["restart"]["lgr_detail_of_last_step"][name],
                format!("@{}", last.saturating_sub(1)),
            ),
        ];
        let of_main = |name: &str| {
            let known = info(&folder.join(case), &[]);
            let known = known["properties"].as_array().unwrap().clone();
            known.iter().any(|p| p["name"] == name)
        };
        let mut asked = Vec::new();
        for (table, step) in tables {
            for (name, expected) in table.as_object().into_iter().flatten() {
                if of_main(name) {
                    asked.push((format!("{name}{step}"), expected.clone()));
                }
            }
        }
        let names: Vec<String> = asked.iter().map(|(name, _)| name.clone()).collect();
        let info = info(&folder.join(case), &names);
        let found = &info["lgr"][n];
        let what = format!("{case} {name}");
        let shape = &grid["grid"];
        let dims = serde_json::json!([shape["ni"], shape["nj"], shape["nk"]]);
        assert_eq!(found["name"], name, "{what}");
        assert_eq!(found["parent"], grid["parent"], "{what}");
        assert_eq!(found["dims"], dims, "{what}");
        assert_eq!(found["active"], shape["active_cells"], "{what}");
        assert_eq!(
            found["cells_replaced"], grid["distinct_host_cells"],
            "{what}"
        );
        compared += 5;
        // Those of a radial one are of radii and angles.
        if grid["gridhead_ITEM27_NTHETA_0_if_cartesian"] == 0 {
            let volume = &shape["bulk_volume_active_trilinear"];
            close(&found["bulk_volume"], volume, 1e-6, 0.0, &what);
            compared += 1;
        }
        for (name, expected) in &asked {
            for key in ["min", "max", "mean"] {
                let what = format!("{what} {name} {key}");
                close(
                    &found["stats"][name][key],
                    &expected[key],
                    1e-6,
                    1e-9,
                    &what,
                );
                compared += 1;
            }
        }
    }
    compared
}

fn compare_steps(case: &str, info: &Value, facts: &Value) -> usize {
    let Some(steps) = facts["restart"]["report_steps"].as_array() else {
        return 0;
    };
    let found = info["steps"].as_array().unwrap();
    assert_eq!(found.len(), steps.len(), "{case}");
    for (a, b) in found.iter().zip(steps) {
        assert_eq!(a["report"], b["report"], "{case}");
        // The other programs give the day alone, which steps may share.
        let time = a["date"].as_str().unwrap();
        let day = time.split(' ').next().unwrap();
        assert_eq!(day, b["date"], "{case}");
        let same = found.iter().filter(|s| s["date"] == time).count();
        assert_eq!(same, 1, "{case}: {time}");
        close(&a["days"], &b["days"], 1e-6, 1e-9, case);
    }
    3 * steps.len()
}

/// Names to ask for, and what the other programs say of them.
fn statistics(facts: &Value, dual: bool) -> (Vec<String>, Vec<Value>) {
    // Of the matrix, or of all, and of the fractures.
    let kinds: &[(&str, &str)] = match dual {
        true => &[("", "_matrix"), (".FRACTURE", "_fracture")],
        false => &[("", "")],
    };
    let pick = |table: &Value, name: &str| {
        let found = kinds.iter().filter_map(|(ours, theirs)| {
            let expected = table.get(format!("{name}{theirs}"))?.clone();
            Some((format!("{name}{ours}"), expected))
        });
        found.collect::<Vec<_>>()
    };
    let mut asked = Vec::new();
    for name in ["PORO", "PERMX", "PERMZ", "NTG"] {
        asked.extend(pick(&facts["init"]["stats"], name));
    }
    let reports = facts["restart"]["report_steps"]
        .as_array()
        .cloned()
        .unwrap_or_default();
    if let Some(detail) = facts["restart"]["detail"].as_object() {
        for (report, table) in detail {
            let index = reports
                .iter()
                .position(|r| r["report"].to_string() == *report)
                .unwrap();
            for name in ["PRESSURE", "SWAT", "SGAS"] {
                let found = pick(table, name).into_iter();
                asked.extend(found.map(|(name, expected)| (format!("{name}@{index}"), expected)));
            }
        }
    }
    asked.into_iter().unzip()
}

/// What other programs say of the cases of a file.
fn cases(path: &Path) -> serde_json::Map<String, Value> {
    let read: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    read.as_object().unwrap().clone()
}

/// The facts that every clone has; their cases are named from the project's folder.
fn bundled() -> (&'static Path, serde_json::Map<String, Value>) {
    let cases = cases(&common::bundled("facts.json"));
    (Path::new(env!("CARGO_MANIFEST_DIR")), cases)
}

#[test]
fn info_agrees_with_a_plain_program() {
    let (folder, cases) = bundled();
    let compared = cases.iter().map(|(c, facts)| compare(c, folder, facts));
    let compared: Vec<usize> = compared.collect();
    println!("{compared:?} facts agree");
    assert_eq!(cases.len(), 3);
    assert!(compared.iter().sum::<usize>() > 100, "{compared:?}");
}

#[test]
fn info_agrees_with_other_programs_on_real_models() {
    let Some(path) = common::data("oracle.json") else {
        return;
    };
    let folder = path.parent().unwrap();
    let mut count = 0;
    for (case, facts) in cases(&path) {
        if case.starts_with('_') {
            continue;
        }
        let compared = compare(&case, folder, &facts);
        println!("{case}: {compared} facts agree");
        count += 1;
    }
    assert!(count >= 20, "only {count} cases were compared");
}

#[test]
fn a_wrong_fact_is_noticed() {
    let (folder, cases) = bundled();
    let case = "samples/scissor/SCISSOR.EGRID";
    for pointer in [
        "/grid/active_cells",
        "/grid/bulk_volume_active_trilinear",
        "/grid/fault_faces_active_pairs/tol_0.001/J",
        "/nnc/nnc_global_global",
        "/grid/bbox_active_raw/x/1",
        "/init/stats/PORO/mean",
        "/restart/detail/10/SWAT/max",
        "/restart/report_steps/20/days",
    ] {
        let mut facts = cases[case].clone();
        let fact = facts.pointer_mut(pointer).unwrap();
        *fact = if fact.is_u64() {
            (fact.as_u64().unwrap() + 1).into()
        } else {
            (fact.as_f64().unwrap() * 1.0001).into()
        };
        let noticed = std::panic::catch_unwind(move || compare(case, folder, &facts));
        assert!(noticed.is_err(), "{pointer}");
    }
}

#[test]
fn real_models_that_are_not_there_fail_where_they_are_required() {
    // This program runs the test above, without the folder.
    let passes = |required: &str| {
        let mut tests = Command::new(std::env::current_exe().unwrap());
        tests
            .args([
                "--exact",
                "oracle::info_agrees_with_other_programs_on_real_models",
            ])
            .env("REQUIRE_DATA", required)
            .env_remove("STRATARAY_DATA");
        let output = tests.output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains("running 1 test"), "{said}");
        output.status.success()
    };
    assert!(passes("0") && !passes("1"));
}
