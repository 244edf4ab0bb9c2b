//! Filters, differences and chosen faults as scenes have them, against the values themselves.

use crate::common;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::scene::Scene;
use strataray::view::{self, View};

fn scene(fields: Value) -> Scene {
    serde_json::from_value(fields).unwrap()
}

fn view(case: &Case, fields: Value) -> View {
    view::resolve(&scene(fields), case).unwrap()
}

fn refusal(case: &Case, fields: Value) -> String {
    view::resolve(&scene(fields), case).unwrap_err().to_string()
}

fn sample() -> Case {
    load::open(&common::sample()).unwrap()
}

/// I, J and K from 1 of the drawn cells.
fn drawn(case: &Case, view: &View) -> Vec<[usize; 3]> {
    let cells = case
        .grid
        .active_cells()
        .iter()
        .zip(view.shown.cells.drawn.iter());
    let drawn = cells.filter(|(_, drawn)| **drawn);
    drawn
        .map(|(cell, _)| {
            let ijk = case.grid.dims().ijk(*cell);
            [ijk.i + 1, ijk.j + 1, ijk.k + 1]
        })
        .collect()
}

#[test]
fn lists_and_ranges_keep_their_rows_columns_and_layers() {
    let case = sample();
    let all = drawn(&case, &view(&case, json!({})));
    let filter = json!({"i": [3, 9], "j": "2,4-6,10-30:2", "k": "7"});
    let kept = drawn(&case, &view(&case, json!({ "filter": filter })));
    let j = [2, 4, 5, 6, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30];
    let right = |c: &&[usize; 3]| (3..=9).contains(&c[0]) && j.contains(&c[1]) && c[2] == 7;
    let expected: Vec<_> = all.iter().filter(right).copied().collect();
    assert!(!expected.is_empty() && expected.len() < all.len());
    assert_eq!(kept, expected);
    for (filter, words) in [
        (json!({"k": "8-20"}), ["filter.k", "1 to 10"]),
        (json!({"i": [0, 4]}), ["filter.i", "1 to 40"]),
        (json!({"j": [9, 4]}), ["filter.j", "4-9"]),
        (json!({"j": "4..9"}), ["filter.j", "2,4-6,10-30:2"]),
    ] {
        let said = refusal(&case, json!({ "filter": filter }));
        assert!(words.iter().all(|w| said.contains(w)), "{said}");
    }
}

#[test]
fn bounds_may_be_open_and_filters_turned_around() {
    let case = sample();
    let last = case.steps.len() - 1;
    let soil = case.field("SOIL", last).unwrap();
    let values = soil.values();
    let count = |filter: Value| {
        let view = view(&case, json!({"filter": {"properties": [filter]}}));
        view.shown.cells.drawn.iter().filter(|d| **d).count()
    };
    let all = count(json!({"name": "SOIL"}));
    let least = count(json!({"name": "SOIL", "min": 0.5}));
    let right = values.iter().filter(|v| **v >= 0.5).count();
    assert!(
        least <= right && right - least < 100,
        "cells without thickness"
    );
    assert!(least > 0 && least < all);
    assert_eq!(
        count(json!({"name": "SOIL", "min": 0.5, "invert": true})),
        all - least
    );
    assert_eq!(
        count(json!({"name": "SOIL", "min": 0.5, "enabled": false})),
        all
    );
    assert_eq!(count(json!({"name": "SOIL", "max": 2.0})), all);
    let blocks =
        [json!([1, 3]), json!([2, 4])].map(|v| count(json!({"name": "FIPNUM", "values": v})));
    assert!(blocks[0] > 0 && blocks[1] > 0 && blocks[0] + blocks[1] == all);
    for (filter, words) in [
        (
            json!({"name": "SOIL", "min": 0.9, "max": 0.1}),
            ["SOIL", "swap them"],
        ),
        (
            json!({"name": "SOIL", "min": 0.1, "values": [1]}),
            ["SOIL", "not both"],
        ),
        (
            json!({"name": "OIL"}),
            ["filter.properties", "no property OIL"],
        ),
    ] {
        let filter = json!({"filter": {"properties": [filter, {"name": "OIL", "min": 0}]}});
        let said = refusal(&case, filter);
        assert!(words.iter().all(|w| said.contains(w)), "{said}");
    }
}

#[test]
fn a_filter_goes_by_the_step_shown_whatever_property_is() {
    let case = sample();
    let drawn_at = |property: &str, step: &str| {
        let filter = json!({"properties": [{"name": "SOIL", "min": 0.6}]});
        let fields = json!({"property": property, "step": step, "filter": filter});
        drawn(&case, &view(&case, fields))
    };
    // PORO does not change with time, and the oil does.
    for step in ["first", "last"] {
        assert_eq!(drawn_at("PORO", step), drawn_at("SWAT", step), "{step}");
    }
    assert_ne!(drawn_at("PORO", "first"), drawn_at("PORO", "last"));
}

/// Opacity of a value seen through a length of world space.
fn opacity(view: &View, position: f64, length: f64) -> f64 {
    let transfer = &view.style.transfer;
    1.0 - (1.0 - transfer.opacity(position)).powf(length / transfer.reference_length)
}

#[test]
fn what_passes_a_filter_is_solid_unless_its_opacity_is_chosen() {
    let case = sample();
    let soil = json!({"properties": [{"name": "SOIL", "min": 0.6}]});
    // A cell of the sample is 5 to 9 m high, five times exaggerated at least.
    let cell = 5.0 * 5.0;
    for opacity_spec in [Value::Null, json!("boundaries")] {
        let fields = |filter: &Value| {
            json!({"property": "SOIL", "filter": filter, "vertical_exaggeration": 5.0,
                "transfer": {"opacity": opacity_spec}})
        };
        let plain = view(&case, fields(&json!({})));
        let filtered = view(&case, fields(&soil));
        let slice = view(&case, fields(&json!({"j": [12, 12]})));
        let crop = view(&case, fields(&json!({"i": [1, 39]})));
        let wide = 3000.0 / 30.0;
        let mut faint = 0;
        for n in 0..=20 {
            let at = f64::from(n) / 20.0;
            faint += u32::from(opacity(&plain, at, cell) < 0.2);
            assert!(opacity(&filtered, at, 1.6 * cell) >= 0.9, "{at}");
            assert!(opacity(&slice, at, 1.1 * wide) >= 0.9, "{at}");
            assert!(
                (opacity(&crop, at, cell) - opacity(&plain, at, cell)).abs() < 0.02,
                "{at}"
            );
        }
        // What was faint before, most of the range.
        assert!(faint > 5, "{faint}");
    }
    let chosen = json!({"property": "SOIL", "filter": soil, "transfer": {"opacity": [[0, 0.01], [1, 0.02]]}});
    assert_eq!(
        view(&case, chosen).style.transfer.opacity,
        [(0.0, 0.01), (1.0, 0.02)]
    );
}

/// A block of 2 x 2 x 1 cells whose columns are displaced along I by 3 m and along J by 5 m.
fn faulted(folder: &std::path::Path) -> Case {
    let mut coord = String::new();
    for j in 0..3 {
        for i in 0..3 {
            let (x, y) = (10 * i, 10 * j);
            coord += &format!("{x} {y} 0 {x} {y} 100\n");
        }
    }
    let mut zcorn = String::new();
    for below in [0, 10] {
        for j in 0..4 {
            for i in 0..4 {
                zcorn += &format!("{} ", 50 + below + 3 * (i / 2) + 5 * (j / 2));
            }
        }
    }
    let text = format!(
        "SPECGRID\n2 2 1 1 F /\nCOORD\n{coord}/\nZCORN\n{zcorn}/\nPORO\n4*0.2 /\n\
         FAULTS\nF1 1 1 1 1 1 1 I /\nF2 1 2 1 1 1 1 J /\n/\n"
    );
    let file = folder.join("FAULTED.GRDECL");
    std::fs::write(&file, text).unwrap();
    load::open(&file).unwrap()
}

#[test]
fn only_the_faults_chosen_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let case = faulted(folder.path());
    let faults = |shown: Value| {
        let view = view(&case, json!({"show": {"faults": shown}}));
        let faces = view.fault_faces(&case.grid);
        let mut numbers: Vec<_> = faces.iter().map(|f| f.2).collect();
        numbers.sort_unstable();
        (view.style.surfaces.faults, numbers)
    };
    // Two sides of each face: one of F1, two of F2, one more along I at J 2.
    let all = [
        None,
        None,
        Some(0),
        Some(0),
        Some(1),
        Some(1),
        Some(1),
        Some(1),
    ];
    assert_eq!(faults(json!(true)), (true, all.to_vec()));
    assert_eq!(faults(json!(["F1"])), (true, all[2..4].to_vec()));
    assert_eq!(faults(json!(["F2", "F1"])), (true, all[2..].to_vec()));
    assert!(!faults(json!(false)).0 && !faults(json!([])).0);
    let throws = case.largest_throws();
    assert_eq!(*throws, [Some(3.0), Some(5.0)]);
    let said = refusal(&case, json!({"show": {"faults": ["F9"]}}));
    assert!(
        said.contains("show.faults") && said.contains("F1, F2"),
        "{said}"
    );
    let said = serde_json::from_value::<Scene>(json!({"show": {"faults": "F1"}})).unwrap_err();
    assert!(said.to_string().contains("[\"F1\", \"F2\"]"), "{said}");
}

#[test]
fn differences_are_properties_of_a_scene() {
    let case = sample();
    let last = case.steps.len() - 1;
    let [swat, soil] = ["SWAT", "SOIL"].map(|n| case.field(n, last).unwrap());
    let two = view(&case, json!({"property": "SWAT-SOIL@same", "step": "last"}));
    assert_eq!(two.shown.step, last);
    for (n, v) in two.shown.cells.field.values().iter().enumerate() {
        assert_eq!(*v, swat.values()[n] - soil.values()[n]);
    }
    // Water that came is oil that left.
    let of_step = |name: &str| {
        view(&case, json!({"property": name, "step": "last"}))
            .shown
            .cells
            .field
    };
    let [came, left] = ["SWAT-SWAT@first", "SOIL-SOIL@2005-01-01"].map(of_step);
    for (a, b) in came.values().iter().zip(left.values()) {
        assert!((a + b).abs() < 1e-5);
    }
    let said = refusal(&case, json!({"property": "SWAT-OIL@same"}));
    assert!(said.contains("no property OIL"), "{said}");
    let said = refusal(&case, json!({"property": "SWAT-SWAT@2099-01-01"}));
    assert!(said.contains("no step 2099-01-01"), "{said}");
}

#[test]
fn cells_of_wells_are_drawn_alone() {
    let Some(file) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let case = load::open(&file).unwrap();
    let of = |filter: Value| view(&case, json!({"filter": filter}));
    // As ICON of the restart file has it: straight down.
    let view_of_one = of(json!({"wells": ["op_5"]}));
    let cells = drawn(&case, &view_of_one);
    let column = (1..=14).map(|k| [25, 35, k]);
    let is_active = |c: &[usize; 3]| {
        let cell = case.grid.dims().one_based(*c).unwrap();
        case.grid.is_active(cell)
    };
    assert_eq!(cells, column.filter(is_active).collect::<Vec<_>>());
    assert!(cells.len() > 10);
    // Patterns add up, and other filters count too.
    let producers = drawn(&case, &of(json!({"wells": ["OP_?", "OP_5"]})));
    let all = drawn(&case, &of(json!({"wells": ["*"]})));
    assert!(cells.len() < producers.len() && producers.len() < all.len());
    let layer = drawn(&case, &of(json!({"wells": ["*"], "k": [3, 3]})));
    let expected: Vec<_> = all.iter().filter(|c| c[2] == 3).copied().collect();
    assert_eq!(layer, expected);
    assert!(!layer.is_empty());
    // What frames the picture stands still over time.
    assert_eq!(
        view_of_one.world.subject,
        view(&case, json!({})).world.subject
    );
    // What no well matches is said, and nothing is drawn.
    let none = of(json!({"wells": ["X*"]}));
    assert!(drawn(&case, &none).is_empty());
    let [warning] = none.notes.warnings.as_slice() else {
        panic!("{:?}", none.notes.warnings);
    };
    assert!(
        warning.contains("filter.wells") && warning.contains("X*") && warning.contains("OP_1"),
        "{warning}"
    );
    assert!(view_of_one.notes.warnings.is_empty());
}

#[test]
fn wells_are_shown_by_their_names() {
    let Some(file) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let case = load::open(&file).unwrap();
    let heads = |wells: Value| {
        let view = view(&case, json!({"show": {"wells": wells}}));
        let heads = &view.shown.wells.heads;
        let names: Vec<_> = heads.iter().map(|head| head.name.clone()).collect();
        (names, view.notes.warnings.len())
    };
    assert_eq!(heads(json!(true)).0.len(), 8);
    assert_eq!(heads(json!(["WI*"])).0, ["WI_1", "WI_2", "WI_3"]);
    assert_eq!(heads(json!(["op_2", "A"])), (vec!["OP_2".to_owned()], 1));
    assert_eq!(heads(json!([])), (Vec::new(), 0));
    let said = serde_json::from_value::<Scene>(json!({"show": {"wells": "P*"}})).unwrap_err();
    assert!(said.to_string().contains("[\"P*\"]"), "{said}");
}
