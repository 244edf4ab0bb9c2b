//! `strataray bench` times each case by every strategy.

use std::path::Path;
use std::process::{Command, Output};

use crate::common;
use serde_json::Value;
use strataray::scene::StrategyKind;

fn bench(arguments: &[&str], folder: &Path) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .arg("bench")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{said}");
    output
}

#[test]
fn every_case_has_figures_for_every_strategy() {
    if common::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let sample = common::sample();
    let sample = sample.to_str().unwrap();
    let size = ["--size", "40x30", "--frames", "2", "--json", "b.json"];
    let output = bench(&[&["box", sample], &size[..]].concat(), folder.path());
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{table}");
    let text = std::fs::read_to_string(folder.path().join("b.json")).unwrap();
    let figures: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (&figures["size"], &figures["frames"]),
        (&[40, 30].into(), &2.into())
    );
    let cases = figures["cases"].as_array().unwrap();
    let active: Vec<_> = cases.iter().map(|c| c["active"].as_u64()).collect();
    assert_eq!(active, [Some(500), Some(9501)]);
    for case in cases {
        let positive =
            |of: &Value, name: &str| assert!(of[name].as_f64() > Some(0.0), "{name}: {of}");
        for name in ["model_ms", "topology_ms", "upload_ms", "acceleration_ms"] {
            positive(case, name);
        }
        let strategies = case["strategies"].as_array().unwrap();
        let names: Vec<_> = strategies.iter().map(|s| s["strategy"].as_str()).collect();
        let all: Vec<_> = StrategyKind::ALL.iter().map(|s| Some(s.name())).collect();
        assert_eq!(names, all);
        for strategy in strategies {
            for name in [
                "first_frame_ms",
                "frame_ms",
                "samples",
                "samples_per_second",
                "longest_submission_ms",
            ] {
                positive(strategy, name);
            }
            positive(&strategy["gpu_bytes"], "geometry");
        }
        assert!(table.contains(case["case"].as_str().unwrap()), "{table}");
    }
    assert!(
        !folder.path().join("BOX.EGRID").exists(),
        "made elsewhere and gone"
    );
}

#[test]
fn executors_and_lights_are_timed_in_turn_and_compared() {
    if common::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| {
        let common = [
            "r7",
            "box",
            "--size",
            "40x30",
            "--frames",
            "2",
            "--strategy",
            "plts",
        ];
        let output = bench(&[&common[..], more].concat(), folder.path());
        // A case that is not there fails, and the rest goes on.
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            !output.status.success() && said.contains("there is no such case"),
            "{said}"
        );
        String::from_utf8(output.stdout).unwrap()
    };
    let what = ["--adapters", "cpu,llvmpipe", "--lightings", "off"];
    run(&[&what[..], &["--json", "a.json"]].concat());
    let text = std::fs::read_to_string(folder.path().join("a.json")).unwrap();
    let figures: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(figures["failures"].as_array().unwrap().len(), 1, "{text}");
    let strategies = figures["cases"][0]["strategies"].as_array().unwrap();
    let word = |of: &Value, name: &str| of[name].as_str().unwrap().to_owned();
    let kinds = strategies
        .iter()
        .map(|s| ["executor", "lighting"].map(|name| word(s, name)));
    let expected = [["cpu", "off"], ["gpu", "off"]];
    assert_eq!(kinds.collect::<Vec<_>>(), expected);
    // Both find as much in the cells.
    let samples: Vec<_> = strategies
        .iter()
        .map(|s| s["samples"].as_u64().unwrap())
        .collect();
    assert!(
        samples
            .iter()
            .all(|n| *n > 0 && n.abs_diff(samples[0]) <= samples[0] / 500),
        "{samples:?}"
    );
    let table = run(&[
        "--adapters",
        "cpu",
        "--lightings",
        "off",
        "--against",
        "a.json",
    ]);
    assert!(
        table.contains("multiples of the old ones") && table.contains("1.00"),
        "{table}"
    );
}

#[test]
fn err_a_case_that_is_not_there() {
    if common::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let output = bench(&["r7"], folder.path());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && output.stdout.is_empty(),
        "{said}"
    );
    assert!(said.contains("there is no such case"), "{said}");
}
