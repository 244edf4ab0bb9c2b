//! Wells: tubes in images of all executors, and what files say of them.

use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value, json};

use crate::common;
use strataray::case::{Case, WellKind, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::picking::{self, Pick};
use strataray::reference;
use strataray::render::Executor;
use strataray::render::cpu::CpuExecutor;
use strataray::scene::StrategyKind;
use strataray::view::wells::{Capsule, Wells};
use strataray::view::{self, View};

fn opened(case: &Case, written: &Value) -> View {
    let scene = view::look::opening(case, written).unwrap();
    view::resolve(&scene, case).unwrap()
}

/// The view with tubes through the model's box and above it, of a radius of so much of its diagonal.
fn with_tubes(mut view: View, radius: f64) -> View {
    let [low, high] = view.world.bounds;
    let at = |x: f64, y: f64, z: f64| low + DVec3::new(x, y, z) * (high - low);
    let lines = [
        // Down through the model, from a head above it.
        [at(0.3, 0.4, 1.4), at(0.3, 0.4, 0.2)],
        [at(0.3, 0.4, 0.2), at(0.7, 0.6, 0.3)],
        // Before it and behind it, along a horizontal layer, and a ball.
        [at(-0.1, 0.5, 0.5), at(1.1, 0.5, 0.6)],
        [at(0.8, 0.2, 1.3), at(0.8, 0.2, 1.3)],
    ];
    let colors = [
        [0.9, 0.1, 0.1],
        [0.9, 0.1, 0.1],
        [0.1, 0.7, 0.2],
        [0.9, 0.8, 0.1],
    ];
    let capsule = |(ends, color)| Capsule {
        ends,
        radius: radius * low.distance(high),
        color,
        well: 0,
    };
    view.shown.wells = Arc::new(Wells {
        capsules: lines.into_iter().zip(colors).map(capsule).collect(),
        heads: Vec::new(),
    });
    view.style.surfaces.wells = true;
    view
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

/// What is shown beside wells, and the strategies by which.
fn looks(view: &View) -> Vec<(Value, Vec<StrategyKind>)> {
    let all = StrategyKind::ALL.to_vec();
    let exact = vec![StrategyKind::Plts, StrategyKind::Libc];
    let middle = 0.5 * (view.world.bounds[0] + view.world.bounds[1]);
    let plane =
        |face: &str| json!([{"point": middle.to_array(), "normal": [0.3, 1, 0], "face": face}]);
    vec![
        (json!({"show": {"hull": "hidden"}}), all),
        (
            json!({"show": {"hull": "faint", "faults": true}}),
            exact.clone(),
        ),
        (
            json!({"libc": {"integration": "samples"}, "clip": plane("open")}),
            exact.clone(),
        ),
        (json!({"show": {"hull": "opaque"}}), exact.clone()),
        (
            json!({"mode": "cells", "clip": plane("opaque")}),
            vec![StrategyKind::Plts],
        ),
        (
            json!({"lighting": {"occlusion": {"mode": "preilluminated"}}}),
            exact,
        ),
    ]
}

#[test]
fn tubes_are_where_the_reference_has_them() {
    let case = load::open(&common::sample()).unwrap();
    let plain = json!({"size": [120, 90], "mode": "volume", "lighting": {}});
    let whole = opened(&case, &plain);
    for (look, strategies) in looks(&whole) {
        let mut written = plain.clone();
        written
            .as_object_mut()
            .unwrap()
            .extend(look.as_object().unwrap().clone());
        let view = with_tubes(opened(&case, &written), 0.01);
        let thicker = with_tubes(view.clone(), 0.013);
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        for executor in common::executors() {
            let mut renderer = executor.renderer(&case.grid).unwrap();
            for strategy in &strategies {
                let image = |renderer: &mut dyn strataray::render::Renderer, view: &View| {
                    let frame = renderer.render(&view.by(*strategy), &|_| true).unwrap();
                    assert_eq!((frame.stats.lost_rays, frame.stats.lost_samples), (0, 0));
                    frame.image
                };
                let db = psnr(&image(&mut *renderer, &view), &truth, &view);
                let twin = psnr(&image(&mut *renderer, &thicker), &truth, &view);
                let place = format!(
                    "{} {} {look}: {db:.1} dB, twin {twin:.1} dB",
                    executor.info().executor,
                    strategy.name()
                );
                println!("{place}");
                // On the GPU single pixels differ at the rims of faces and planes, tubes or not.
                let surfaces = view.style.surfaces;
                let has_rims =
                    surfaces.faults || surfaces.has_hull() || !view.shown.clip.is_empty();
                let on_gpu = executor.info().executor == "gpu";
                let least = match strategy {
                    // The reference has light by many rays, executors by cones.
                    _ if !view.style.lighting.is_off() => 31.0,
                    StrategyKind::Srg => 38.0,
                    _ if on_gpu && has_rims => 45.0,
                    StrategyKind::Libc => 51.0,
                    StrategyKind::Plts => 60.0,
                };
                assert!(db > least && twin < 30.0, "{place}");
            }
        }
    }
}

#[test]
fn wells_of_restart_steps_are_shown_with_their_names() {
    let Some(file) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let case = load::open(&file).unwrap();
    let last = case.steps.len() - 1;
    let wells = case.wells(last).unwrap();
    let names: Vec<&str> = wells.iter().map(|w| w.name.as_str()).collect();
    assert_eq!(names, case.about.wells);
    let kinds = |kind: WellKind| wells.iter().filter(|w| w.kind == kind).count();
    assert_eq!(
        (kinds(WellKind::Producer), kinds(WellKind::WaterInjector)),
        (5, 3)
    );
    assert!(wells.iter().all(|w| w.is_open && !w.connections.is_empty()));
    let view = opened(&case, &json!({"size": [64, 64]}));
    assert_eq!(view.shown.wells.heads.len(), wells.len());
    assert!(view.style.surfaces.wells);
    // Tubes go through the cells that wells are connected to.
    let grid = &case.grid;
    for well in wells.iter() {
        for connection in &well.connections {
            let center = grid.hexahedron(connection.cell).center();
            let world = view.world.spaces.world_from_grid.transform_point3(center);
            let away = |capsule: &Capsule| {
                let [a, b] = capsule.ends;
                let axis = b - a;
                let part = (world - a).dot(axis) / axis.length_squared().max(1e-30);
                a.lerp(b, part.clamp(0.0, 1.0)).distance(world) - capsule.radius
            };
            let capsules = view.shown.wells.capsules.iter();
            let least = capsules.map(away).fold(f64::MAX, f64::min);
            assert!(least < 0.0, "{} {least}", well.name);
        }
    }
    // Hidden, they are not read.
    let hidden = opened(&case, &json!({"size": [64, 64], "show": {"wells": false}}));
    assert!(hidden.shown.wells.capsules.is_empty() && !hidden.style.surfaces.wells);
}

#[test]
fn the_command_tells_wells_at_each_step() {
    let Some(file) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(["info", "--json", "--wells", "--quiet"])
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success());
    let facts: Value = serde_json::from_slice(&output.stdout).unwrap();
    let wells = facts["wells"].as_array().unwrap();
    assert_eq!(wells.len(), 8);
    let case = load::open(&file).unwrap();
    let last = case.steps.len() - 1;
    for (well, told) in case.wells(last).unwrap().iter().zip(wells) {
        let step = told["steps"].as_array().unwrap().last().unwrap();
        assert_eq!(told["name"], json!(well.name));
        assert_eq!(step["index"], json!(last));
        assert_eq!(step["type"], json!(well.kind.name()));
        let first = &step["connections"][0];
        let cell = well.connections[0].cell;
        let at = ["i", "j", "k"].map(|axis| first[axis].as_u64().unwrap() as usize);
        assert_eq!(at, [cell.i + 1, cell.j + 1, cell.k + 1]);
    }
}

#[test]
fn a_click_on_a_well_takes_the_well_and_no_cell_behind_it() {
    let Some(file) = common::data("reek/REEK.EGRID") else {
        return;
    };
    let case = load::open(&file).unwrap();
    let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
    let seen = |shows: bool| {
        opened(
            &case,
            &json!({"size": [300, 240], "show": {"wells": shows}}),
        )
    };
    let (with, without) = (seen(true), seen(false));
    for head in &with.shown.wells.heads {
        // A place on the head that no other well covers.
        let at = with.camera.project(head.at, with.aspect()).unwrap();
        let name = |pick: &Pick| pick.well.as_ref().map(|well| well.name.clone());
        let pick = picking::pick(&mut *renderer, &case, &with, at).unwrap();
        assert_eq!(name(&pick).as_deref(), Some(head.name.as_str()));
        assert!(pick.hit.is_none(), "{:?}", pick.hit);
        let pick = picking::pick(&mut *renderer, &case, &without, at).unwrap();
        assert_eq!(name(&pick), None);
    }
    // Beside wells cells are taken as ever.
    let at = glam::DVec2::new(0.6, 0.62);
    let [a, b] = [&with, &without].map(|view| {
        picking::pick(&mut *renderer, &case, view, at)
            .unwrap()
            .hit
            .unwrap()
            .ijk
    });
    assert_eq!(a, b);
}
