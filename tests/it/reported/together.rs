//! Several files that are one case, and what the program says on the way.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use strataray::case::load::{self, CasePaths};

use super::{info, inputs, names, near, open, run, stats};
use crate::common::{self, tiny};

#[test]
fn f16_properties_beside_a_grid() {
    let folder = tempfile::tempdir().unwrap();
    let grid = format!("SPECGRID\n 6 5 4 1 F /\n{}", tiny::geometry(20.0));
    let grid = tiny::write(folder.path(), "GRID.GRDECL", grid);
    let poro = tiny::write(folder.path(), "PORO.GRDECL", tiny::porosity_text());
    let alone = load::open(&poro).err().unwrap().to_string();
    assert!(
        alone.contains("has PORO but no grid") && alone.contains("--with"),
        "{alone}"
    );
    let grids = inputs("F16_GRID.GRDECL", grid.clone());
    let properties = inputs("F16_PORO.GRDECL", poro.clone());
    for (grid, poro) in grids.into_iter().zip(properties) {
        assert!(!names(&open(&grid)).contains(&"PORO"));
        let case = load::open_with(&grid, std::slice::from_ref(&poro)).unwrap();
        near(&stats(&case, "PORO", 0), &[0.1, 0.219, 0.1595]);
        assert_eq!(case.about.files, [grid.clone(), poro.clone()]);
        let facts = info([&grid, &PathBuf::from("--with"), &poro]);
        let properties = facts["properties"].as_array().unwrap();
        assert!(properties.iter().any(|p| p["name"] == "PORO"));
        // Given together they are one case, in any order.
        let expected = [CasePaths {
            path: grid.clone(),
            with: vec![poro.clone()],
            others: Vec::new(),
        }];
        assert_eq!(load::group(&[grid.clone(), poro.clone()]), expected);
        assert_eq!(load::group(&[poro, grid]), expected);
    }
    // What stands in both, and what operations do, goes on where the grid's file ends.
    let more = "EQUALS\n PORO 0.5 1 1 1 1 1 1 /\n/\nFAULTS\n 'F' 3 3 1 5 1 4 X /\n/\n";
    let more = tiny::write(folder.path(), "more.inc", more);
    let case = load::open_with(&grid, &[poro, more]).unwrap();
    near(&stats(&case, "PORO", 0)[..2], &[0.101, 0.5]);
    assert_eq!(case.about.named_faults[0].faces, 20);
}

#[test]
fn f16_results_and_faults_of_another_name() {
    let folder = tempfile::tempdir().unwrap();
    let grid = tiny::write_egrid(folder.path(), "GRID", &tiny::egrid());
    let head = tiny::head(120, 7, "2030-01-01");
    let init = tiny::init(&head, &[("PORO", vec![0.3; 120]), ("NTG", vec![1.0; 120])]);
    let init = tiny::write(folder.path(), "RUN.INIT", init);
    let step = (head, vec![("SWAT", vec![0.4; 120])]);
    let steps = tiny::write(folder.path(), "RUN.UNRST", tiny::restart(&[step]));
    let text = format!(
        "{}SWAT\n120*0.9 /\nFAULTS\n 'F' 3 3 1 5 1 4 X /\n/\n",
        tiny::porosity_text()
    );
    let text = tiny::write(folder.path(), "faults.txt", text);
    let with = vec![init.clone(), steps.clone(), text.clone()];
    assert_eq!(
        load::group(&[grid.clone(), init, steps, text]),
        [CasePaths {
            path: grid.clone(),
            with: with.clone(),
            others: Vec::new(),
        }]
    );
    let case = load::open_with(&grid, &with).unwrap();
    // Text that is added by hand goes before INIT, and results of steps before all.
    near(&stats(&case, "PORO", 0), &[0.1, 0.219, 0.1595]);
    near(
        &[stats(&case, "NTG", 0)[0], stats(&case, "SWAT", 0)[0]],
        &[1.0, 0.4],
    );
    super::told(&case, &["SWAT", "restart"]);
    assert_eq!(case.about.named_faults[0].name, "F");
    assert_eq!(
        case.fault_faces.fault_of(
            strataray::model::Ijk { i: 2, j: 0, k: 0 },
            strataray::model::topology::Face::IPlus
        ),
        Some(0)
    );
    assert_eq!(case.about.files.len(), 4, "{:?}", case.about.files);
}

#[test]
fn f16_what_cannot_be_added_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let grid = tiny::write_egrid(folder.path(), "GRID", &tiny::egrid());
    let other = tiny::write_egrid(folder.path(), "OTHER", &tiny::egrid());
    let refused = |added: &PathBuf| {
        let error = load::open_with(&grid, std::slice::from_ref(added)).err();
        error.unwrap().to_string()
    };
    assert!(refused(&other).contains("OTHER.EGRID: is a grid of its own"));
    assert!(refused(&folder.path().join("GONE.INC")).contains("GONE.INC: there is no such file"));
    let damaged = tiny::write(folder.path(), "bad.inc", "PORO\n119*0.2 x /\n");
    assert!(refused(&damaged).contains("bad.inc:2:9: PORO: 'x' is not a number"));
    // Two grids are two cases, files of one case are one.
    let cases = load::group(&[grid.clone(), other.clone(), grid.with_extension("")]);
    assert_eq!(
        cases.iter().map(|c| &c.path).collect::<Vec<_>>(),
        [&grid, &other]
    );
    let unknown = [
        folder.path().join("a.GRDECL"),
        folder.path().join("b.GRDECL"),
    ];
    assert_eq!(load::group(&unknown).len(), 2, "each says what is wrong");
}

#[test]
fn scenes_that_ask_for_wells_are_told_that_there_are_none() {
    let Some(_) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = tiny::write(folder.path(), "A.GRDECL", tiny::grid_text());
    let said = |show: &str| {
        let text = format!("{{\"size\": [16, 16], \"show\": {show}}}");
        let scene = tiny::write(folder.path(), "scene.json", text);
        let mut arguments: Vec<OsString> = vec!["render".into(), path.clone().into()];
        arguments.extend(["--scene".into(), scene.into()]);
        arguments.extend(["-o".into(), folder.path().join("a.png").into()]);
        String::from_utf8(run(arguments).stderr).unwrap()
    };
    assert!(said("{\"wells\": true}").contains("wells"));
    for nothing in ["{}", "{\"wells\": false}"] {
        assert!(!said(nothing).contains("wells"), "{nothing}");
    }
}

/// Graphics drivers print on the program's error stream where a variable is missing.
#[test]
fn drivers_do_not_speak_on_the_error_stream() {
    let Some(_) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = tiny::write(folder.path(), "A.GRDECL", tiny::grid_text());
    for missing in [None, Some("/no such folder")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_strataray"));
        command
            .arg("render")
            .arg(&path)
            .args(["--size", "16x16", "--quiet", "-o"]);
        command
            .arg(folder.path().join("a.png"))
            .env_remove("XDG_RUNTIME_DIR");
        command.envs(missing.map(|folder| ("XDG_RUNTIME_DIR", folder)));
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && said.is_empty(), "{said}");
    }
}
