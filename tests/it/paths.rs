//! Paths of wells beside a case, and wells of decks without results.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::{Value, json};

use crate::common;
use strataray::case::load::{self, CasePaths};
use strataray::case::{Case, Well, WellKind};
use strataray::model::{Ijk, Spaces};
use strataray::reference::Locator;
use strataray::view::wells::Capsule;
use strataray::view::{self, View};

fn opened(case: &Case, written: &Value) -> View {
    let scene = view::look::opening(case, written).unwrap();
    view::resolve(&scene, case).unwrap()
}

/// A point of a grid by its parts of the bounds' box, on the map.
fn on_map(case: &Case, parts: [f64; 3]) -> DVec3 {
    let [low, high] = case.grid.bounds().unwrap();
    let spaces = Spaces::new(case.grid.map_axes(), 1.0);
    let point = low + DVec3::from_array(parts) * (high - low);
    spaces.map_from_world(spaces.world_from_grid.transform_point3(point))
}

/// Writes wells of some points as a list.
fn written(folder: &Path, wells: &[(&str, Vec<DVec3>)]) -> PathBuf {
    let mut text = String::from("X Y TVD MD\n");
    for (name, points) in wells {
        text += &format!("WELLNAME: {name}\n");
        for (n, p) in points.iter().enumerate() {
            text += &format!("{} {} {} {}\n", p.x, p.y, p.z, 100 * n);
        }
        text += "-999\n";
    }
    let path = folder.join("wells.dev");
    std::fs::write(&path, text).unwrap();
    path
}

fn sample_with(wells: &[(&str, Vec<[f64; 3]>)]) -> Case {
    let bare = load::open(&common::sample()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let wells: Vec<(&str, Vec<DVec3>)> = wells
        .iter()
        .map(|(name, parts)| (*name, parts.iter().map(|p| on_map(&bare, *p)).collect()))
        .collect();
    let file = written(folder.path(), &wells);
    load::open_with(&common::sample(), &[file]).unwrap()
}

fn named<'a>(wells: &'a [Well], name: &str) -> &'a Well {
    wells.iter().find(|well| well.name == name).unwrap()
}

/// Distance of a point from the nearest tube of a view.
fn away(view: &View, world: DVec3) -> f64 {
    let from = |capsule: &Capsule| {
        let [a, b] = capsule.ends;
        let axis = b - a;
        let part = (world - a).dot(axis) / axis.length_squared().max(1e-30);
        a.lerp(b, part.clamp(0.0, 1.0)).distance(world) - capsule.radius
    };
    let capsules = view.shown.wells.capsules.iter();
    capsules.map(from).fold(f64::MAX, f64::min)
}

/// Down into the model from far above, and through it.
fn deviated() -> Vec<[f64; 3]> {
    vec![
        [0.2, 0.3, -40.0],
        [0.2, 0.3, -0.5],
        [0.25, 0.35, 0.4],
        [0.8, 0.6, 0.55],
    ]
}

#[test]
fn a_path_goes_through_the_cells_in_which_its_points_lie() {
    let case = sample_with(&[("A-1", deviated())]);
    let well = named(&case.wells(0).unwrap(), "A-1").clone();
    assert_eq!((well.kind, well.connections.len()), (WellKind::Path, 0));
    let path = well.path.unwrap();
    assert_eq!(path.measured.as_ref().unwrap(), &[0.0, 100.0, 200.0, 300.0]);
    let locator = Locator::new(&case.grid);
    // Faces are curved, and for a line two triangles each: beside them one of both cells is as good.
    let beside = 0.03;
    let (mut inside, mut same) = (0, 0);
    for n in 0..3000 {
        let place = 1.0 + 2.0 * f64::from(n) / 3000.0;
        let point = strataray::model::crossings::point_at(&path.points, place);
        let located = locator.locate(point).map(|found| found.ijk);
        let crossed = |slack: f64| -> Vec<Ijk> {
            let over = |c: &&strataray::model::Crossing| {
                c.part[0] - slack <= place && place <= c.part[1] + slack
            };
            path.crossings.iter().filter(over).map(|c| c.cell).collect()
        };
        same += usize::from(crossed(0.0).first().copied() == located);
        match located {
            Some(cell) => assert!(crossed(beside).contains(&cell), "{place}: {cell:?}"),
            None => assert!(crossed(-beside).is_empty(), "{place}"),
        }
        inside += usize::from(located.is_some());
    }
    assert!(inside > 500 && same > 2950, "{inside} {same}");
    // What is filtered by the well is what is on its path.
    let mut cells: Vec<Ijk> = path.crossings.iter().map(|c| c.cell).collect();
    cells.sort_unstable_by_key(|cell| case.grid.dims().cell(*cell));
    cells.dedup();
    let view = opened(
        &case,
        &json!({"size": [64, 64], "filter": {"wells": ["A-?"]}}),
    );
    let drawn: Vec<Ijk> = case
        .grid
        .active_cells()
        .iter()
        .filter(|cell| {
            let active = case.grid.active_index(**cell).unwrap();
            view.shown.cells.drawn[active.0 as usize]
        })
        .map(|cell| case.grid.dims().ijk(*cell))
        .collect();
    assert_eq!(drawn, cells);
    assert!(cells.len() > 10, "{}", cells.len());
}

#[test]
fn tubes_follow_paths_and_end_a_little_beyond_the_model() {
    let case = sample_with(&[("A-1", deviated())]);
    let plain = json!({"size": [64, 64]});
    let view = opened(&case, &plain);
    let spaces = &view.world.spaces;
    let path = named(&case.wells(0).unwrap(), "A-1").path.clone().unwrap();
    for n in 0..100 {
        let place = 1.6 + 1.4 * f64::from(n) / 100.0;
        let point = strataray::model::crossings::point_at(&path.points, place);
        let world = spaces.world_from_grid.transform_point3(point);
        assert!(away(&view, world) < 0.0, "{place}");
        let [low, high] = view.world.bounds;
        let beside = world + DVec3::new(0.1, 0.0, 0.0) * (high - low);
        assert!(away(&view, beside) > 0.0, "{place}");
    }
    // Far above the model there is nothing, and what the camera frames is as without wells.
    let [low, high] = view.world.bounds;
    let reach = 0.1 * low.distance(high);
    let ends = view.shown.wells.capsules.iter().flat_map(|c| c.ends);
    assert!(
        ends.clone()
            .all(|p| p.z < high.z + reach && p.z > low.z - reach)
    );
    let without = opened(&load::open(&common::sample()).unwrap(), &plain);
    assert_eq!(view.camera, without.camera);
    assert_eq!(
        view.shown.wells.heads.len(),
        1 + without.shown.wells.heads.len()
    );
    assert!(view.style.surfaces.wells);
}

#[test]
fn by_i_j_and_k_a_path_goes_through_the_same_cells() {
    let case = std::sync::Arc::new(sample_with(&[("A-1", deviated())]));
    let flat = case.in_space(strataray::model::Space::Ijk);
    let view = opened(&flat, &json!({"size": [64, 64], "space": "ijk"}));
    let path = named(&case.wells(0).unwrap(), "A-1").path.clone().unwrap();
    for crossing in &path.crossings {
        let cell = flat.grid.hexahedron(crossing.cell);
        let center = view
            .world
            .spaces
            .world_from_grid
            .transform_point3(cell.center());
        // Somewhere in the cell, which is a cube.
        assert!(away(&view, center) < 0.9, "{:?}", crossing.cell);
    }
    let corner = flat.grid.hexahedron(Ijk { i: 0, j: 0, k: 0 }).center();
    let corner = view.world.spaces.world_from_grid.transform_point3(corner);
    assert!(away(&view, corner) > 2.0);
}

#[test]
fn a_path_that_is_elsewhere_is_told_and_not_drawn() {
    let bare = load::open(&common::sample()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let far = DVec3::new(450_000.0, 0.0, 0.0);
    let at = |part: f64| on_map(&bare, [0.5, 0.5, part]) + far;
    let file = written(folder.path(), &[("FAR", vec![at(-1.0), at(1.0)])]);
    let case = load::open_with(&common::sample(), &[file]).unwrap();
    let note = case.about.notes.iter().find(|note| note.contains("FAR"));
    let note = note.unwrap();
    assert!(
        note.contains("km from the model") && note.contains("coordinate"),
        "{note}"
    );
    let view = opened(&case, &json!({"size": [64, 64]}));
    assert!(view.shown.wells.heads.iter().all(|head| head.name != "FAR"));
    // One that passes beside the model by less than its size goes through no cell.
    let near = sample_with(&[("NEAR", vec![[1.2, 0.5, -0.5], [1.2, 0.5, 1.0]])]);
    let told = |note: &&String| note.contains("NEAR go through no active cell");
    assert_eq!(
        near.about.notes.iter().filter(told).count(),
        1,
        "{:?}",
        near.about.notes
    );
}

#[test]
fn a_path_of_a_simulated_well_is_drawn_in_its_place() {
    let Some(file) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let bare = load::open(&file).unwrap();
    let last = bare.steps.len() - 1;
    let before = named(&bare.wells(last).unwrap(), "OP_1").clone();
    let spaces = Spaces::new(bare.grid.map_axes(), 1.0);
    // Through the cells that the well is connected to, beside their middles.
    let points: Vec<DVec3> = before
        .cells(&bare.grid)
        .map(|cell| {
            let cell = bare.grid.hexahedron(cell);
            let point = cell.at(DVec3::new(0.95, 0.9, 0.0));
            spaces.map_from_world(spaces.world_from_grid.transform_point3(point))
        })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), &[("op-1", points.clone())]);
    let case = load::open_with(&file, &[path]).unwrap();
    assert_eq!(case.about.wells, bare.about.wells);
    let well = named(&case.wells(last).unwrap(), "OP_1").clone();
    assert_eq!((well.kind, well.is_open), (before.kind, before.is_open));
    assert_eq!(well.connections, before.connections);
    let plain = json!({"size": [64, 64]});
    let views = [opened(&case, &plain), opened(&bare, &plain)];
    let heads = views.each_ref().map(|view| view.shown.wells.heads.len());
    assert_eq!(heads[0], heads[1]);
    let mut beside = 0;
    for point in &points {
        let distances = views
            .each_ref()
            .map(|view| away(view, view.world.spaces.world_from_map(*point)));
        assert!(distances[0] < 0.0, "{distances:?}");
        beside += usize::from(distances[1] > 0.0);
    }
    assert!(beside > points.len() / 2, "{beside}");
    // Before the well is drilled there is no path either.
    let early = case.wells(0).unwrap();
    let had = bare
        .wells(0)
        .unwrap()
        .iter()
        .any(|well| well.name == "OP_1");
    assert_eq!(early.iter().any(|well| well.path.is_some()), had);
}

#[test]
fn a_deck_without_results_has_the_wells_of_its_schedule() {
    let Some(run) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let deck = common::data("reek/deck/model/REEK.DATA").unwrap();
    let (run, deck) = (load::open(&run).unwrap(), load::open(&deck).unwrap());
    let wells = [
        run.wells(run.steps.len() - 1).unwrap(),
        deck.wells(0).unwrap(),
    ];
    assert_eq!(deck.about.wells, run.about.wells);
    for (a, b) in wells[0].iter().zip(wells[1].iter()) {
        assert_eq!((&a.name, a.kind, a.is_open), (&b.name, b.kind, b.is_open));
        let cells = |well: &Well| {
            let mut cells: Vec<_> = well
                .connections
                .iter()
                .map(|c| c.cell.one_based())
                .collect();
            cells.sort_unstable();
            cells
        };
        assert_eq!(cells(a), cells(b), "{}", a.name);
    }
    let told = |note: &&String| note.contains("at its end");
    assert_eq!(
        deck.about.notes.iter().filter(told).count(),
        1,
        "{:?}",
        deck.about.notes
    );
    assert_eq!(run.about.notes.iter().filter(told).count(), 0);
    let view = opened(&deck, &json!({"size": [64, 64]}));
    assert_eq!(view.shown.wells.heads.len(), 8);
    // The same schedule beside a grid alone.
    let folder = tempfile::tempdir().unwrap();
    let grid = folder.path().join("ALONE.EGRID");
    std::fs::copy(common::data("reek/REEK.EGRID").unwrap(), &grid).unwrap();
    let schedule = common::data("reek/deck/include/schedule/reek_history.sch").unwrap();
    assert!(load::open(&grid).unwrap().about.wells.is_empty());
    let with = load::open_with(&grid, &[schedule]).unwrap();
    assert_eq!(with.about.wells, run.about.wells);
    assert_eq!(with.wells(0).unwrap().len(), 8);
}

#[test]
fn files_with_paths_are_added_to_a_case_and_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), &[("A", vec![DVec3::ZERO, DVec3::Z])]);
    let case = common::copy_of_sample(folder.path());
    let grouped = load::group(&[path.clone(), case.clone()]);
    let expected = CasePaths {
        path: case.clone(),
        with: vec![path.clone()],
        others: Vec::new(),
    };
    assert_eq!(grouped, [expected]);
    let alone = load::open(&path).err().unwrap().to_string();
    assert!(alone.contains("paths of wells and no grid"), "{alone}");
    // What is named so and is something else is taken for what it is.
    let deck = folder.path().join("poro.dev");
    std::fs::write(&deck, "NEWPROP\n 1*0.5 /\n").unwrap();
    assert!(
        load::open_with(&case, &[deck])
            .unwrap()
            .about
            .paths
            .is_empty()
    );
    let damaged = folder.path().join("bad.dev");
    std::fs::write(&damaged, "WELLNAME: A\n1 2 3\n1 2x 3 4\n").unwrap();
    let error = load::open_with(&case, &[damaged])
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("bad.dev:3") && error.contains("2x"),
        "{error}"
    );
}

#[test]
fn the_command_lists_paths() {
    let bare = load::open(&common::sample()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let points = [-1.0, 0.5].map(|part| on_map(&bare, [0.5, 0.5, part]));
    let path = written(folder.path(), &[("A-1", points.to_vec())]);
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(["info", "--json", "--wells", "--quiet"])
        .arg(common::sample())
        .arg("--with")
        .arg(&path)
        .output()
        .unwrap();
    assert!(output.status.success());
    let facts: Value = serde_json::from_slice(&output.stdout).unwrap();
    let told = &facts["paths"][0];
    assert_eq!(told["name"], "A-1");
    assert_eq!(
        (&told["points"], &told["md"]),
        (&json!(2), &json!([0.0, 100.0]))
    );
    let cells = told["on_path"].as_array().unwrap();
    assert_eq!(told["cells"], json!(cells.len()));
    assert!(!cells.is_empty());
    let wells = facts["wells"].as_array().unwrap();
    let well = wells.iter().find(|well| well["name"] == "A-1").unwrap();
    assert_eq!(well["steps"][0]["type"], "path");
}
