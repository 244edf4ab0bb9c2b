//! Named faults without throw.

use std::path::PathBuf;

use strataray::scene::{Scene, Show};
use strataray::view;

use super::{info, inputs, open, run};
use crate::common::{self, tiny};

fn deck(folder: &std::path::Path) -> PathBuf {
    let text = format!(
        "SPECGRID\n 6 5 4 1 F /\n{}{}FAULTS\n 'SEAL' 3 3 1 5 1 4 X /\n/\nMULTFLT\n 'SEAL' 0.0 /\n/\n",
        tiny::geometry(0.0),
        tiny::porosity_text()
    );
    tiny::write(folder, "A.GRDECL", text)
}

#[test]
fn f11_faces_of_named_faults_are_found_whatever_their_throw() {
    let folder = tempfile::tempdir().unwrap();
    for path in inputs("F11_FAULT_NO_THROW.GRDECL", deck(folder.path())) {
        let case = open(&path);
        assert_eq!(case.grid.fault_faces(), [0, 0]);
        let scene = Scene {
            show: Show {
                faults: true.into(),
                ..Show::default()
            },
            ..Scene::default()
        };
        let view = view::resolve(&scene, &case).unwrap();
        let faces = view.fault_faces(&case.grid);
        // Each of the 20 is there once for the cell on either side.
        assert_eq!(faces.len(), 40);
        assert!(faces.iter().all(|(_, _, fault)| *fault == Some(0)));
        let facts = info([&path]);
        let named = serde_json::json!([{"name": "SEAL", "faces": 20, "multiplier": 0.0}]);
        assert_eq!(facts["fault_faces"]["named"], named);
    }
}

/// Share of the pixels of a picture that are of the first color of faults rather than of the sand around it.
fn sheet(folder: &std::path::Path, path: &std::path::Path, faults: bool, by: &str) -> f64 {
    let scene = serde_json::json!({
        "size": [160, 120], "property": "PORO", "mode": "volume", "vertical_exaggeration": 5.0,
        "camera": {"azimuth_degrees": 250.0, "elevation_degrees": 25.0},
        "transfer": {"color": [[0.0, "#ffffff"], [1.0, "#ffffff"]], "opacity": [[0.0, 0.0], [1.0, 0.0]]},
        "show": {"faults": faults, "legend": false, "box": false},
    });
    let scene = tiny::write(folder, "scene.json", scene.to_string());
    let picture = folder.join("picture.png");
    let mut arguments: Vec<std::ffi::OsString> = vec!["render".into(), path.into()];
    arguments.extend([
        "--scene".into(),
        scene.into(),
        "-o".into(),
        picture.clone().into(),
    ]);
    arguments.extend([by.into(), "--quiet".into()]);
    let output = run(arguments);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let picture = image::open(picture).unwrap().into_rgb8();
    let colored = |p: &&image::Rgb<u8>| p.0.iter().max().unwrap() - p.0.iter().min().unwrap() > 20;
    picture.pixels().filter(colored).count() as f64 / f64::from(picture.width() * picture.height())
}

#[test]
fn f11_the_sheet_is_drawn() {
    let Some(_) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    for path in inputs("F11_FAULT_NO_THROW.GRDECL", deck(folder.path())) {
        let of = |faults: bool, by: &str| sheet(folder.path(), &path, faults, by);
        let drawn = of(true, "--strategy=plts");
        assert!(drawn > 0.02, "{drawn}");
        assert!((of(true, "--reference") - drawn).abs() < 0.005);
        assert!(of(false, "--strategy=plts") < 0.001);
    }
}
