//! Grids with several coordinate systems (NUMRES above 1): all layers are there, each on its own pillars.

use std::path::Path;

use serde_json::Value;
use strataray::case::{Case, load};
use strataray::model::Ijk;
use strataray::scene::{Grids, Scene};
use strataray::view::resolve;
use strataray_parsers::egrid::{Egrid, Reservoir};

use crate::common::tiny;

/// How far east the pillars of the second reservoir are of those of the first.
const SHIFT: f32 = 1000.0;

/// The layers 3 and 4 lie on pillars of their own.
fn grid() -> Egrid {
    let mut coord = tiny::coord();
    for pillar in coord.chunks_mut(6) {
        pillar[0] += SHIFT;
        pillar[3] += SHIFT;
    }
    Egrid {
        reservoirs: vec![Reservoir {
            layers: 2..4,
            coord,
        }],
        ..tiny::egrid()
    }
}

fn write(folder: &Path) -> std::path::PathBuf {
    let path = tiny::write_egrid(folder, "A", &grid());
    let head = tiny::head(tiny::CELLS, 3, "2020-01-01");
    let porv: Vec<f32> = (0..120).map(|n| n as f32).collect();
    let init = tiny::init(&head, &[("PORO", tiny::porosity()), ("PORV", porv)]);
    tiny::write(folder, "A.INIT", init);
    path
}

/// The cell of the lattice that a cell of the file is.
fn place(case: &Case, [i, j, k]: [usize; 3]) -> Ijk {
    case.grid.in_lattice(0, Ijk { i, j, k }).unwrap()
}

#[test]
fn each_layer_lies_on_the_pillars_of_its_reservoir() {
    let folder = tempfile::tempdir().unwrap();
    let case = load::open(&write(folder.path())).unwrap();
    let single = tiny::write_egrid(folder.path(), "B", &tiny::egrid());
    let single = load::open(&single).unwrap();
    let poro = case.field("PORO", 0).unwrap();
    assert_eq!(case.grid.active_cells().len(), tiny::CELLS);
    for n in 0..tiny::CELLS {
        let at = [n % 6, n / 6 % 5, n / 30];
        let cell = place(&case, at);
        let name = case.grid.cell_name(cell);
        let is_second = at[2] >= 2;
        assert_eq!(name.ijk, at.map(|v| v + 1));
        assert_eq!(name.grid, if is_second { "RES2" } else { "" });
        let [i, j, k] = at;
        let expected = single.grid.hexahedron(Ijk { i, j, k });
        let found = case.grid.hexahedron(cell);
        for (found, expected) in found.0.iter().zip(expected.0) {
            let shift = if is_second { f64::from(SHIFT) } else { 0.0 };
            assert_eq!(found.x, expected.x + shift);
            assert_eq!([found.y, found.z], [expected.y, expected.z]);
        }
        let value = poro.value(&case.grid, case.grid.dims().cell(cell));
        assert_eq!(value, Some(tiny::porosity()[n]));
    }
    // Neighboring layers of two reservoirs are apart.
    assert!(case.about.notes.iter().any(|n| n.contains("layers 3 to 4")));
    assert!(!single.about.notes.iter().any(|n| n.contains("NUMRES")));
}

#[test]
fn layers_and_reservoirs_can_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let case = load::open(&write(folder.path())).unwrap();
    let drawn = |scene: &Scene| {
        let view = resolve(scene, &case).unwrap();
        let [low, high] = view.drawn_bounds(&case.grid).unwrap();
        let facts = view.notes.facts.unwrap();
        (facts.drawn, [low.x, high.x])
    };
    let all = Scene {
        property: Some("PORO".into()),
        ..Scene::default()
    };
    assert_eq!(drawn(&all), (120, [0.0, 1600.0]));
    let layer: Scene =
        serde_json::from_str(r#"{"property": "PORO", "filter": {"k": [3, 3]}}"#).unwrap();
    assert_eq!(drawn(&layer), (30, [1000.0, 1600.0]));
    let first = Scene {
        grids: Grids {
            hidden: vec!["RES2".into()],
        },
        ..all
    };
    assert_eq!(drawn(&first), (60, [0.0, 600.0]));
}

#[test]
fn the_command_takes_reservoirs_for_parts_of_the_main_grid() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path());
    let path = path.to_str().unwrap();
    let run = |arguments: &[&str]| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_strataray"))
            .args(arguments)
            .arg("--quiet")
            .output()
            .unwrap();
        let why = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{why}");
        String::from_utf8(output.stdout).unwrap()
    };
    let text = run(&["info", path, "--json", "--stats", "PORV"]);
    let facts: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (&facts["active"], &facts["cells"]),
        (&120.into(), &120.into())
    );
    assert_eq!(facts["lgr"], serde_json::json!([]));
    assert_eq!(facts["bounds"]["max"][0], 1600.0);
    assert_eq!(facts["stats"]["PORV"]["max"], 119.0);
    let volume = facts["bulk_volume"].as_f64().unwrap();
    assert!((volume - 120.0 * 80_000.0).abs() < 1.0, "{volume}");
    // The third layer is 1000 farther east, and not where the pillars of the first reservoir are.
    let points = tiny::write(folder.path(), "p.csv", "1250,120,2029\n250,120,2029\n");
    let points = points.to_str().unwrap();
    let answer = run(&[
        "probe",
        path,
        "--property",
        "PORO",
        "--on",
        "cpu",
        "--points",
        points,
    ]);
    let rows: Vec<&str> = answer.lines().skip(1).collect();
    let cells: Vec<&str> = rows[0].split(',').collect();
    assert_eq!(cells[3..6], ["3", "2", "3"], "{answer}");
    let expected = tiny::porosity()[2 + 6 + 60];
    assert!((cells[9].parse::<f32>().unwrap() - expected).abs() < 1e-6);
    assert!(rows[1].starts_with("250,120,2029,,"), "{answer}");
}
