//! Units that files give in other words than GRIDUNIT, and maps in another unit than their grid.

use strataray::case::Case;
use strataray::model::Spaces;
use strataray_parsers::egrid::{Egrid, GridUnit};

use super::{info, inputs, near, open, run};
use crate::common::tiny;

fn deck(units: &str, grid_unit: &str) -> String {
    format!(
        "RUNSPEC\nDIMENS\n 6 5 4 /\n{units}\nOIL\nWATER\nGRID\n{grid_unit}{}PORV\n120*7 /\nPROPS\nSOLUTION\nPRESSURE\n \
         60*3500 60*3600 /\n",
        tiny::grid_text()
    )
}

fn units(case: &Case) -> [&str; 5] {
    let of = |name| case.unit(name);
    [
        &case.about.length_unit,
        of("PRESSURE"),
        of("CELL_VOLUME"),
        of("DEPTH"),
        of("PORV"),
    ]
}

#[test]
fn f03_a_deck_names_its_unit_system() {
    let folder = tempfile::tempdir().unwrap();
    let field = ["FEET", "PSIA", "FT3", "FT"];
    for (system, expected) in [
        ("FIELD", ["FEET", "PSIA", "FT3", "FT", "RB"]),
        ("LAB", ["CM", "ATMA", "CM3", "CM", "RCC"]),
        ("METRIC", ["METRES", "BARSA", "M3", "M", "RM3"]),
        ("PVT-M", ["METRES", "ATMA", "M3", "M", "RM3"]),
    ] {
        let path = tiny::write(folder.path(), "A.DATA", deck(system, ""));
        assert_eq!(units(&open(&path)), expected, "{system}");
    }
    // GRIDUNIT is of the grid alone.
    let path = tiny::write(
        folder.path(),
        "A.DATA",
        deck("FIELD", "GRIDUNIT\n METRES /\n"),
    );
    assert_eq!(units(&open(&path)), ["METRES", "PSIA", "M3", "M", "RB"]);
    let built = tiny::write(folder.path(), "F.DATA", deck("FIELD", ""));
    for path in inputs("F03_FIELD.DATA", built) {
        assert_eq!(units(&open(&path))[..4], field);
        assert_eq!(info([&path])["units"], "FEET");
    }
}

#[test]
fn f03_results_name_the_unit_system_of_a_grid_without_one() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Egrid {
        grid_unit: None,
        ..tiny::egrid()
    };
    let path = tiny::write_egrid(folder.path(), "A", &grid);
    assert_eq!(open(&path).about.length_unit, "METRES");
    let mut head = tiny::head(tiny::CELLS, 3, "2020-01-01");
    head.units = strataray_parsers::units::UnitSystem::from_code(2);
    let init = tiny::init(&head, &[("PORV", vec![7.0; 120])]);
    tiny::write(folder.path(), "A.INIT", init);
    let case = open(&path);
    assert_eq!(units_of_grid(&case), ["FEET", "FT3", "FT", "RB"]);
}

fn units_of_grid(case: &Case) -> [&str; 4] {
    let of = |name| case.unit(name);
    [
        &case.about.length_unit,
        of("CELL_VOLUME"),
        of("DEPTH"),
        of("PORV"),
    ]
}

/// A grid at easting 500000 and northing 100000 of a map.
fn in_map(map: Option<&str>, grid: &str, is_map: bool) -> Egrid {
    Egrid {
        map_units: map.map(str::to_owned),
        map_axes: Some([5e5, 100_100.0, 5e5, 1e5, 500_100.0, 1e5]),
        grid_unit: Some(GridUnit {
            length: grid.into(),
            is_map,
        }),
        ..tiny::egrid()
    }
}

#[test]
fn f10_maps_in_another_unit_than_the_grid() {
    let folder = tempfile::tempdir().unwrap();
    for (map, grid, scale) in [
        (Some("METRES"), "FEET", 0.3048),
        (Some("FEET"), "METRES", 1.0 / 0.3048),
        (Some("METRES"), "CM", 0.01),
        (Some("CM"), "FEET", 30.48),
        (Some("METRES"), "METRES", 1.0),
        // Without MAPUNITS all is in one unit.
        (None, "FEET", 1.0),
    ] {
        let path = tiny::write_egrid(folder.path(), "A", &in_map(map, grid, false));
        let facts = info([&path]);
        let bounds = &facts["map_bounds"];
        let x = [&bounds["min"][0], &bounds["max"][0]].map(|v| v.as_f64().unwrap());
        near(&x, &[5e5, 5e5 + 600.0 * scale]);
        assert_eq!(facts["map_units"], map.unwrap_or(grid));
    }
    // Where coordinates are those of the map already, nothing is applied.
    let path = tiny::write_egrid(folder.path(), "A", &in_map(Some("METRES"), "FEET", true));
    let case = open(&path);
    assert_eq!(
        (case.grid.map_axes(), case.about.map_unit.as_str()),
        (None, "FEET")
    );
    let built = tiny::write_egrid(folder.path(), "B", &in_map(Some("METRES"), "FEET", false));
    for path in inputs("F10_MAPUNITS.EGRID", built) {
        let facts = info([&path]);
        let bounds = &facts["map_bounds"];
        let of = |end: &str, n: usize| bounds[end][n].as_f64().unwrap();
        near(&[of("min", 0), of("max", 0)], &[500_000.0, 500_182.88]);
        near(&[of("min", 1), of("max", 1)], &[100_000.0, 100_121.92]);
        assert_eq!(
            (&facts["map_units"], &facts["units"]),
            (&"METRES".into(), &"FEET".into())
        );
        // In a picture a foot is as long along all axes.
        let case = open(&path);
        let spaces = Spaces::new(case.grid.map_axes(), 1.0);
        let edge = spaces.world_from_grid.transform_vector3(glam::DVec3::X);
        near(&[edge.length()], &[1.0]);
    }
}

#[test]
fn f10_points_are_given_in_the_units_of_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = tiny::write_egrid(folder.path(), "A", &in_map(Some("METRES"), "FEET", false));
    // The middle of column 3, row 2 in feet: 250, 120; on its second layer.
    let [x, y] = [500_000.0 + 250.0 * 0.3048, 100_000.0 + 120.0 * 0.3048];
    let points = tiny::write(folder.path(), "points.csv", format!("{x},{y},2019\n"));
    let mut arguments: Vec<std::ffi::OsString> = vec!["probe".into(), path.into()];
    arguments.extend(["--property", "DEPTH", "--on", "cpu", "--points"].map(Into::into));
    arguments.push(points.into());
    let output = run(arguments);
    let answer = String::from_utf8(output.stdout).unwrap();
    let cells: Vec<&str> = answer.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(cells[3..6], ["3", "2", "2"], "{answer}");
}
