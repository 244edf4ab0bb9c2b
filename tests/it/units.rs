//! One switch for units: what people read and type is converted, and nothing else changes.

use std::path::Path;

use glam::DVec3;
use serde_json::Value;
use strataray::case::{Units, load};
use strataray::image::Image;
use strataray::model::Spaces;
use strataray::picture::{Annotations, Lengths, Shot};
use strataray::render;
use strataray::scene::{self, LightingSpec, RangeSpec, Scene};
use strataray_parsers::egrid::{Egrid, GridUnit};

use crate::common::tiny;

const PSI: f64 = 0.068_947_572_931_683_6;

/// A case in feet and psi.
fn field_case(folder: &Path) -> std::path::PathBuf {
    let text = format!(
        "RUNSPEC\nDIMENS\n 6 5 4 /\nFIELD\nOIL\nWATER\nGRID\n{}PROPS\nSOLUTION\nPRESSURE\n 60*3500 60*3600 /\n",
        tiny::grid_text()
    );
    tiny::write(folder, "A.DATA", text)
}

fn strataray<'a>(arguments: impl IntoIterator<Item = &'a str>) -> std::process::Output {
    std::process::Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(arguments)
        .arg("--quiet")
        .output()
        .unwrap()
}

fn text<'a>(arguments: impl IntoIterator<Item = &'a str>) -> String {
    let output = strataray(arguments);
    let why = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{why}");
    String::from_utf8(output.stdout).unwrap()
}

#[track_caller]
fn near(found: f64, expected: f64) {
    let scale = expected.abs().max(1e-30);
    assert!(
        (found - expected).abs() <= 1e-6 * scale,
        "{found} {expected}"
    );
}

#[test]
fn facts_are_told_in_the_units_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = field_case(folder.path());
    let path = path.to_str().unwrap();
    let facts = |units: &[&str]| -> Value {
        let arguments = ["info", path, "--json", "--stats", "PRESSURE"];
        let arguments = arguments.into_iter().chain(units.iter().copied());
        serde_json::from_str(&text(arguments)).unwrap()
    };
    let [own, same, metric] = [&[][..], &["--units", "file"], &["--units", "metric"]].map(facts);
    assert_eq!(own, same);
    assert_eq!(
        (&own["units"], own.get("unit_system")),
        (&"FEET".into(), None)
    );
    assert_eq!(metric["units"], "METRES");
    assert_eq!(metric["unit_system"], "metric");
    let number = |facts: &Value, at: &str| facts.pointer(at).unwrap().as_f64().unwrap();
    for (at, factor) in [
        ("/bounds/min/0", 0.3048),
        ("/bounds/max/0", 0.3048),
        ("/bounds/max/2", 0.3048),
        ("/bulk_volume", 0.3048 * 0.3048 * 0.3048),
        ("/stats/PRESSURE/min", PSI),
        ("/stats/PRESSURE/mean", PSI),
    ] {
        let (own, metric) = (number(&own, at), number(&metric, at));
        near(metric, own * factor);
        assert!(own == 0.0 || (metric - own).abs() > 0.1, "{at}");
    }
    let unit = |facts: &Value, name: &str| {
        let all = facts["properties"].as_array().unwrap();
        let found = all.iter().find(|p| p["name"] == name).unwrap();
        found["unit"].as_str().unwrap().to_owned()
    };
    assert_eq!(unit(&own, "PRESSURE"), "PSIA");
    for (name, expected) in [("PRESSURE", "BARSA"), ("CELL_VOLUME", "M3"), ("PORO", "")] {
        assert_eq!(unit(&metric, name), expected);
    }
}

#[test]
fn points_are_typed_and_values_told_in_the_units_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = field_case(folder.path());
    let probe = |name: &str, point: [f64; 3], units: &str| -> Vec<String> {
        let [x, y, z] = point;
        let points = tiny::write(folder.path(), name, format!("{x},{y},{z}\n"));
        let arguments = [
            "probe",
            path.to_str().unwrap(),
            "--property",
            "PRESSURE",
            "--on",
            "cpu",
            "--units",
            units,
            "--points",
            points.to_str().unwrap(),
        ];
        let answer = text(arguments);
        let row = answer.lines().nth(1).unwrap();
        row.split(',').map(str::to_owned).collect()
    };
    let feet = [250.0, 120.0, 2019.0];
    let own = probe("feet.csv", feet, "file");
    let metric = probe("metres.csv", feet.map(|v| 0.3048 * v), "metric");
    assert_eq!(own[3..6], ["3", "2", "2"]);
    assert_eq!(metric[3..6], own[3..6]);
    near(own[9].parse().unwrap(), 3500.0);
    near(metric[9].parse().unwrap(), 3500.0 * PSI);
    // Feet taken for meters lie in no cell.
    assert_eq!(probe("wrong.csv", feet, "metric")[3], "");
}

#[test]
fn tables_have_the_units_asked_for_and_other_formats_those_of_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = field_case(folder.path());
    let out = folder.path().join("out.csv");
    let table = |units: &str| -> Vec<Vec<String>> {
        text([
            "export",
            path.to_str().unwrap(),
            "--property",
            "PRESSURE",
            "PORO",
            "--units",
            units,
            "-o",
            out.to_str().unwrap(),
        ]);
        let text = std::fs::read_to_string(&out).unwrap();
        let rows = text.lines().skip(1);
        rows.map(|row| row.split(',').map(str::to_owned).collect())
            .collect()
    };
    let [own, metric] = ["file", "metric"].map(table);
    assert_eq!(own.len(), 2 * tiny::CELLS);
    for (own, metric) in own.iter().zip(&metric) {
        assert_eq!(own[..8], metric[..8]);
        let [own_value, value] = [own, metric].map(|row| row[8].parse::<f64>().unwrap());
        let (factor, unit) = match own[7].as_str() {
            "PRESSURE" => (PSI, ["PSIA", "BARSA"]),
            _ => (1.0, ["", ""]),
        };
        near(value, factor * own_value);
        assert_eq!([own[9].as_str(), metric[9].as_str()], unit);
    }
    let out = folder.path().join("out.grdecl");
    let out = out.to_str().unwrap();
    let path = path.to_str().unwrap();
    let export = ["export", path, "--property", "PRESSURE", "-o", out];
    let refused = strataray(export.into_iter().chain(["--units", "metric"]));
    let why = String::from_utf8(refused.stderr).unwrap();
    assert!(
        !refused.status.success() && why.contains("--units"),
        "{why}"
    );
    assert!(strataray(export).status.success());
}

/// A small picture of a scene, and what stands around it.
fn pictured(case: &strataray::case::Case, scene: &Scene) -> (Image, Annotations) {
    let shot = Shot::of(scene, case, true).unwrap();
    let executor = render::executor(Some("cpu")).unwrap();
    let mut renderer = executor.renderer(&case.grid).unwrap();
    let image = renderer.render(&shot.view, &|_| true).unwrap().image;
    (image, Annotations::of(case, &shot.view))
}

#[test]
fn pictures_differ_in_their_texts_alone() {
    let folder = tempfile::tempdir().unwrap();
    let case = load::open(&field_case(folder.path())).unwrap();
    let own = Scene {
        size: [64, 48],
        property: Some("PRESSURE".into()),
        range: RangeSpec::Fixed([3400.0, 3650.0]),
        lighting: LightingSpec::default(),
        ..Scene::default()
    };
    let metric = Scene {
        units: scene::Units::Metric,
        ..own.clone()
    };
    let other = Scene {
        range: RangeSpec::Fixed([3400.0, 3700.0]),
        ..own.clone()
    };
    let [(a, own), (b, metric), (c, _)] = [&own, &metric, &other].map(|s| pictured(&case, s));
    assert!(a.pixels.iter().any(|p| p[3] > 0.0));
    assert_eq!(a.pixels, b.pixels);
    assert_ne!(a.pixels, c.pixels);
    assert_eq!([&own.measure.unit, &metric.measure.unit], ["PSIA", "BARSA"]);
    assert_eq!(
        [own.lengths.grid.unit, metric.lengths.grid.unit],
        ["ft", "m"]
    );
    let [own, metric] = [own.info, metric.info].map(|info| info.unwrap().whole());
    assert!(own.contains("3500 to 3600 PSIA"), "{own}");
    assert!(metric.contains("241.32 to 248.21 BARSA"), "{metric}");
}

#[test]
fn filters_stay_in_the_units_of_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let case = load::open(&field_case(folder.path())).unwrap();
    let facts = |units: &str| {
        let json = format!(
            r#"{{"property": "PRESSURE", "units": "{units}", "size": [64, 48],
                "filter": {{"properties": [{{"name": "PRESSURE", "min": 3550}}]}}}}"#
        );
        let scene: Scene = serde_json::from_str(&json).unwrap();
        let view = strataray::view::resolve(&scene, &case).unwrap();
        let facts = view.notes.facts.unwrap();
        (facts.drawn, facts.filter.clone())
    };
    let [own, metric] = ["file", "metric"].map(facts);
    assert_eq!((own.0, metric.0), (60, 60));
    assert_eq!(own.1, "PRESSURE from 3550");
    assert_eq!(metric.1, "PRESSURE from 244.764");
}

#[test]
fn scenes_keep_their_units() {
    for units in scene::Units::ALL {
        let scene = Scene {
            units,
            ..Scene::default()
        };
        let written = serde_json::to_value(&scene).unwrap();
        let key = written.get("units").and_then(Value::as_str);
        let expected = (units != scene::Units::File).then_some(units.name());
        assert_eq!(key, expected);
        let read: Scene = serde_json::from_value(written).unwrap();
        assert_eq!(read, scene);
    }
    let wrong = serde_json::from_str::<Scene>(r#"{"units": "imperial"}"#);
    assert!(wrong.unwrap_err().to_string().contains("pvt-m"));
}

/// A grid on a map that is rotated by the angle of a triangle of sides 3, 4 and 5.
fn on_map(map: Option<&str>, grid: &str, is_map: bool) -> Egrid {
    let [x, y] = [5e5, 1e5];
    Egrid {
        map_units: map.map(str::to_owned),
        map_axes: Some([x - 60.0, y + 80.0, x, y, x + 80.0, y + 60.0]),
        grid_unit: Some(GridUnit {
            length: grid.into(),
            is_map,
        }),
        ..tiny::egrid()
    }
}

#[test]
fn maps_and_grids_have_their_units_in_every_combination() {
    let folder = tempfile::tempdir().unwrap();
    let all = [("METRES", 1.0), ("FEET", 0.3048), ("CM", 0.01)];
    for (map, map_length) in all {
        for (grid, grid_length) in all {
            let place = [600.0, 400.0, 2000.0];
            let file = on_map(Some(map), grid, false);
            let case = load::open(&tiny::write_egrid(folder.path(), "A", &file)).unwrap();
            assert_eq!(case.about.length_unit, grid);
            assert_eq!(case.about.map_unit, map);
            let spaces = Spaces::new(case.grid.map_axes(), 3.0);
            let world = spaces.world_from_grid.transform_point3(place.into());
            let found = spaces.map_from_world(world);
            // 600 along (0.8, 0.6) and 400 along (-0.6, 0.8).
            let scale = grid_length / map_length;
            let expected = [5e5 + scale * 240.0, 1e5 + scale * 680.0, 2000.0];
            assert!(
                found.distance(expected.into()) < 1e-5,
                "{map} {grid} {found}"
            );
            assert!(spaces.world_from_map(found).distance(world) < 1e-5);
            // Lengths are true in world space.
            let along = spaces.world_from_grid.transform_vector3(DVec3::X);
            near(along.length(), 1.0);
            // In one unit all of it is in that.
            let lengths = Lengths::of(&case, Units::FIELD);
            let [east, north, depth] = lengths.shown(found.to_array());
            near(east, expected[0] * map_length / 0.3048);
            near(north, expected[1] * map_length / 0.3048);
            near(depth, 2000.0 * grid_length / 0.3048);
            assert_eq!([&lengths.map.unit, &lengths.grid.unit], ["ft", "ft"]);
            // Coordinates of the map already: nothing is applied, and they have the unit of the grid.
            let file = on_map(Some(map), grid, true);
            let case = load::open(&tiny::write_egrid(folder.path(), "B", &file)).unwrap();
            let spaces = Spaces::new(case.grid.map_axes(), 3.0);
            let world = spaces.world_from_grid.transform_point3(place.into());
            assert_eq!(spaces.map_from_world(world).to_array(), place);
            assert_eq!(case.about.map_unit, grid);
        }
    }
}

#[test]
fn what_is_picked_is_told_in_the_unit_of_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = tiny::write_egrid(folder.path(), "A", &on_map(Some("METRES"), "FEET", false));
    let picked = |units: &str, space: &str| -> Value {
        let arguments = [
            "pick",
            path.to_str().unwrap(),
            "--property",
            "DEPTH",
            "--mode",
            "cells",
            "--size",
            "200x150",
            "--at",
            "100,75",
            "--adapter",
            "cpu",
            "--plain",
            "--json",
            "--units",
            units,
            "--space",
            space,
        ];
        serde_json::from_str(&text(arguments)).unwrap()
    };
    for space in ["map", "ijk"] {
        let own = picked("file", space);
        let map = |fact: &Value| -> [f64; 3] {
            serde_json::from_value(fact["hit"]["map"].clone()).unwrap()
        };
        // 600 by 400 feet beside the origin of the map in meters.
        let [east, north, depth] = map(&own);
        assert!((499_920.0..500_150.0).contains(&east), "{east}");
        assert!((100_000.0..100_210.0).contains(&north), "{north}");
        assert!((1970.0..2060.0).contains(&depth), "{depth}");
        let metric = picked("metric", space);
        let [e, n, d] = map(&metric);
        near(e, east);
        near(n, north);
        near(d, 0.3048 * depth);
        assert_eq!((&own["unit"], &metric["unit"]), (&"FT".into(), &"M".into()));
        let value = |fact: &Value| fact["hit"]["value"].as_f64().unwrap();
        near(value(&metric), 0.3048 * value(&own));
    }
}
