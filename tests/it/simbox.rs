//! Index space: flat layers and square columns by I, J and K, with the values of the true geometry, by every strategy.

use std::process::Command;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::model::derived::Derived;
use strataray::model::{CellIndex, Ijk, LocalGrid, Spaces};
use strataray::picking::{self, Fault, Pick};
use strataray::reference;
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::{Executor, Renderer};
use strataray::scene::{CameraSpec, ExplicitCamera, Projection, Scene, Space, StrategyKind};
use strataray::view::{self, View};

use crate::common;
use crate::common::shape::{boxes, parallelepipeds};
use crate::local_grids;

/// A case in map space, and in index space.
fn both(case: Case) -> [Arc<Case>; 2] {
    let case = Arc::new(case);
    let flat = case.in_space(Space::Ijk);
    [case, flat]
}

fn scene(case: &Case, more: &Value) -> Scene {
    let mut written = json!({
        "size": [120, 90], "mode": "volume", "lighting": {}, "space": if case.grid.space().is_map() { "map" } else { "ijk" },
        "show": {"hull": "hidden", "wells": false}, "camera": {"azimuth_degrees": 215, "elevation_degrees": 35},
    });
    let keys = written.as_object_mut().unwrap();
    keys.extend(more.as_object().unwrap().clone());
    view::look::opening(case, &written).unwrap()
}

fn view(case: &Case, more: &Value) -> View {
    view::resolve(&scene(case, more), case).unwrap()
}

fn executors() -> Vec<Arc<dyn Executor>> {
    let gpu = common::gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    gpu.into_iter().chain([cpu]).collect()
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

/// The sample, a model with grids in grids, and models with faults, wells, local grids and inactive cells.
fn models() -> Vec<Case> {
    let files = [
        "reek/REEK.EGRID",
        "lgr_nnc/LGR_TESTMOD.EGRID",
        "lgr_nnc/SIMPLE_SUMMARY2.EGRID",
    ];
    let files = files.iter().filter_map(|file| common::data(file));
    let files = [common::sample()].into_iter().chain(files);
    let mut cases: Vec<Case> = files.map(|file| load::open(&file).unwrap()).collect();
    cases.push(local_grids::case(0.7));
    cases
}

#[test]
fn values_are_those_of_the_true_geometry() {
    // Twice, because a case and its flat twin keep values together.
    for (case, other) in models().into_iter().zip(models()) {
        let name = case.about.name.clone();
        let [_, flat] = both(other);
        assert_eq!(
            [case.grid.space().is_map(), flat.grid.space().is_map()],
            [true, false]
        );
        let last = case.steps.len().saturating_sub(1);
        let mut names: Vec<&str> = case.properties.iter().map(|p| p.name.as_str()).collect();
        names.extend(["DEPTH", "THICKNESS", "CELL_VOLUME"]);
        for property in names {
            let Ok(field) = case.field(property, last) else {
                continue;
            };
            // Bits, because values that are not there are not equal.
            let bits = |v: &[f32]| v.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let same = flat.field(property, last).unwrap();
            assert_eq!(
                bits(field.values()),
                bits(same.values()),
                "{name} {property}"
            );
        }
        assert_eq!(case.weights().values, flat.weights().values, "{name}");
        assert_eq!(case.largest_throws(), flat.largest_throws(), "{name}");
        assert_eq!(case.grid.active_cells(), flat.grid.active_cells());
        // The twin: by the flat geometry volumes would be others.
        let volumes = [&case.grid, &flat.grid].map(|grid| Derived::Volume.field(grid));
        assert_ne!(volumes[0].values(), volumes[1].values(), "{name}");
    }
}

#[test]
fn cells_are_boxes_at_their_numbers_and_local_ones_divide_their_hosts() {
    for case in models() {
        let [case, flat] = both(case);
        let grid = &flat.grid;
        for (_, at) in grid.active_in(0) {
            let low = DVec3::from_array(at.one_based().map(|n| n as f64 - 0.5));
            let expected = [0usize, 1, 2, 3, 4, 5, 6, 7]
                .map(|n| low + DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64));
            assert_eq!(grid.hexahedron(at).0, expected);
        }
        let has_place = |patch: &usize| !grid.leaves_out(*patch);
        for patch in (1..grid.patches().len()).filter(has_place) {
            let mut inside = std::collections::HashMap::new();
            for (own, host) in grid.hosts_of(patch) {
                let [cell, host_cell] = [own, host].map(|at| grid.hexahedron(at));
                let [[a, b], [low, high]] = [cell.bounds(), host_cell.bounds()];
                assert!(a.cmpge(low).all() && b.cmple(high).all());
                *inside.entry(host).or_insert(0.0) +=
                    cell.signed_volume() / host_cell.signed_volume();
            }
            assert!(inside.values().all(|part: &f64| (part - 1.0).abs() < 1e-5));
        }
        // A mirror image would show wells on the wrong side.
        let handedness = |case: &Case| {
            let spaces = Spaces::new(case.grid.map_axes(), 1.0);
            let turn = spaces.world_from_grid.matrix3.determinant();
            (case.grid.signed_bulk_volume() * turn).signum()
        };
        assert_eq!(handedness(&case), handedness(&flat));
        let thick = grid.active_cells().iter().zip(grid.thick());
        for (cell, thick) in thick {
            let patch = grid.patch_of(grid.dims().ijk(*cell)).unwrap();
            assert_eq!(*thick, has_place(&patch));
        }
    }
}

#[test]
fn executors_see_index_space_as_the_reference_does() {
    for case in models() {
        let [_, flat] = both(case);
        let name = &flat.about.name;
        for interpolation in ["vertex", "cell"] {
            let with = |more: Value| {
                let mut keys = json!({"interpolation": interpolation});
                let more = more.as_object().unwrap().clone();
                keys.as_object_mut().unwrap().extend(more);
                view(&flat, &keys)
            };
            let view = with(json!({}));
            let truth = reference::render(&flat.grid, &view, &|_| true).unwrap();
            // The twin: layers half as thick again.
            let factor = 1.5 * view.world.vertical_exaggeration;
            let thicker = with(json!({ "vertical_exaggeration": factor }));
            for executor in executors() {
                let mut renderer = executor.renderer(&flat.grid).unwrap();
                for (strategy, least) in [
                    (StrategyKind::Plts, 60.0),
                    (StrategyKind::Libc, 45.0),
                    (StrategyKind::Srg, 20.0),
                ] {
                    let mut against = |view: &View| {
                        let frame = renderer.render(&view.by(strategy), &|_| true).unwrap();
                        assert_eq!((frame.stats.lost_rays, frame.stats.lost_samples), (0, 0));
                        psnr(&frame.image, &truth, view)
                    };
                    let db = against(&view);
                    // One is enough of what takes long in software.
                    let other = match strategy {
                        StrategyKind::Plts => against(&thicker),
                        _ => 0.0,
                    };
                    let place = format!(
                        "{} {name} {} {interpolation}: {db:.1} dB, thicker {other:.1}",
                        executor.info().executor,
                        strategy.name()
                    );
                    println!("{place}");
                    assert!(db >= least && other < db, "{place}");
                    assert!(other < 40.0, "{place}");
                }
            }
        }
    }
}

/// A box of 6 x 5 x 4 cells whose J runs to the north, or to the south.
fn block(north: bool) -> Case {
    let y: Vec<f64> = (0..6)
        .map(|n| if north { 80.0 } else { -80.0 } * f64::from(n))
        .collect();
    let x = [0.0, 10.0, 400.0, 500.0, 510.0, 900.0, 1000.0];
    let depth = [2000.0, 2001.0, 2050.0, 2060.0, 2200.0];
    boxes(&x, &y, &depth, &|[i, j, k]| (i + 2 * j + 3 * k) as f64)
}

fn pick(renderer: &mut dyn Renderer, case: &Case, view: &View, at: DVec2) -> Pick {
    picking::pick(renderer, case, view, at).unwrap()
}

/// The cell in which a ray enters the block, by its numbers from 1.
fn entered(view: &View, north: bool, at: DVec2) -> Option<[usize; 3]> {
    let (start, way) = view.camera.ray(at, view.aspect());
    let turn = if north { 1.0 } else { -1.0 };
    let factor = view.world.vertical_exaggeration;
    let index = |p: DVec3| DVec3::new(p.x, turn * p.y, -p.z / factor);
    let (start, way) = (index(start), index(way));
    let [low, high] = [DVec3::splat(0.5), DVec3::new(6.5, 5.5, 4.5)];
    let [a, b] = [(low - start) / way, (high - start) / way];
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    // A little inside. On an edge it may be of either cell.
    let point = start + (near + 1e-6) * way;
    let parts = (point - point.floor() - 0.5).abs().to_array();
    let is_clear = parts.iter().filter(|part| **part < 1e-3).count() == 1;
    let entry = point.round().to_array().map(|n| n as usize);
    (near < far && is_clear).then_some(entry)
}

#[test]
fn a_pick_gives_the_cell_at_its_numbers() {
    for north in [true, false] {
        let [map, flat] = both(block(north));
        for executor in executors() {
            let mut renderers = [&map, &flat].map(|case| executor.renderer(&case.grid).unwrap());
            let looks = json!({"mode": "cells", "property": "VALUE", "size": [160, 120]});
            let views = [&map, &flat].map(|case| view(case, &looks));
            let (mut hits, mut elsewhere) = (0, 0);
            for n in 0..300 {
                let at = DVec2::new(f64::from(n % 20) + 0.5, f64::from(n / 20) + 0.5)
                    / DVec2::new(20.0, 15.0);
                let found = pick(&mut *renderers[1], &flat, &views[1], at);
                let Some(expected) = entered(&views[1], north, at) else {
                    continue;
                };
                let hit = found.hit.unwrap();
                assert_eq!(hit.ijk.one_based(), expected, "{at}");
                let [i, j, k] = expected.map(|n| n - 1);
                assert_eq!(hit.value, (i + 2 * j + 3 * k) as f64);
                // Its middle on the map.
                let middle = map.grid.hexahedron(Ijk { i, j, k }).center();
                assert!(hit.map.distance(middle) < 1e-6, "{} {middle}", hit.map);
                hits += 1;
                // The twin: cells of true size lie elsewhere.
                let other = pick(&mut *renderers[0], &map, &views[0], at).hit;
                elsewhere += usize::from(other.is_none_or(|other| other.ijk != hit.ijk));
            }
            println!(
                "{} {north}: {hits} hits, {elsewhere} elsewhere",
                executor.info().executor
            );
            assert!(hits > 60 && 3 * elsewhere > hits, "{hits} {elsewhere}");
        }
    }
}

#[test]
fn faults_are_where_the_true_geometry_has_them_and_tell_their_throw() {
    let [map, flat] = both(load::open(&common::sample()).unwrap());
    let looks =
        json!({"mode": "cells", "show": {"faults": true, "hull": "hidden"}, "size": [300, 200]});
    let [of_map, of_flat] = [&map, &flat].map(|case| view(case, &looks));
    let faces = of_flat.fault_faces(&flat.grid);
    assert_eq!(of_map.fault_faces(&map.grid), faces);
    assert!(faces.len() > 100);
    // Looked at from outside, the hull is whole: neighbors of equal numbers touch.
    let hulls =
        [(&of_map, &map), (&of_flat, &flat)].map(|(view, case)| view.hull_faces(&case.grid).len());
    assert!(hulls[1] < hulls[0], "{hulls:?}");
    let Some(executor) = executors().pop() else {
        return;
    };
    let mut renderer = executor.renderer(&flat.grid).unwrap();
    let looks = json!({"show": {"faults": true, "hull": "hidden"}, "size": [300, 200],
        "transfer": {"opacity": [[0.0, 0.0], [1.0, 0.0]]}});
    let view = view(&flat, &looks);
    let mut told = 0;
    for n in 0..600 {
        let at =
            DVec2::new(f64::from(n % 30) + 0.5, f64::from(n / 30) + 0.5) / DVec2::new(30.0, 20.0);
        let Some(Fault {
            near, far, throw, ..
        }) = pick(&mut *renderer, &flat, &view, at).fault
        else {
            continue;
        };
        let middle = |at: Ijk| map.grid.hexahedron(at).center().z;
        let face = strataray::model::topology::Face::ALL.into_iter();
        let mut face = face.filter(|face| map.grid.adjacent(near, *face) == Some(far));
        let expected = map.grid.throw(near, face.next().unwrap()).unwrap();
        assert!((throw - expected).abs() < 1e-9, "{throw} {expected}");
        assert!((middle(far) - middle(near) - throw).abs() < 60.0);
        told += usize::from(throw != 0.0);
    }
    assert!(told > 5, "{told}");
}

#[test]
fn a_local_grid_whose_rows_follow_no_rows_is_left_out() {
    let base = parallelepipeds::case(0.0);
    let dims = base.grid.dims();
    let of_host = |i, j| dims.cell(Ijk { i, j, k: 1 });
    let local = |name: &str, hosts: [CellIndex; 4]| LocalGrid {
        name: name.into(),
        parent: 0,
        grid: strataray::model::Grid::clone(&block_of_four().grid),
        layers: None,
        split: 1,
        is_reversed: false,
        hosts: hosts.to_vec(),
    };
    // A square, and a ring around the middle of four cells as of a radial grid.
    let square = [of_host(0, 0), of_host(1, 0), of_host(0, 1), of_host(1, 1)];
    let ring = [of_host(3, 3), of_host(4, 3), of_host(4, 4), of_host(3, 4)];
    let locals = [local("SQUARE", square), local("RING", ring)];
    let grid = strataray::model::Grid::clone(&base.grid)
        .with_local_grids(&locals)
        .unwrap();
    let values = vec![1.0; grid.active_cells().len()];
    let case = Case {
        grid: Arc::new(grid),
        source: Arc::new(local_grids::Values(
            [("VALUE".to_owned(), values)].into_iter().collect(),
        )),
        ..base
    };
    let [map, flat] = both(case);
    assert_eq!([1, 2].map(|n| flat.grid.leaves_out(n)), [false, true]);
    assert!(flat.about.notes.iter().any(|note| note.contains("RING")));
    // What is connected to its cells is so to their hosts.
    let first = |patch, case: &Case| case.grid.hosts_of(patch).next().unwrap();
    let [(in_square, _), (in_ring, host)] = [1, 2].map(|patch| first(patch, &flat));
    assert_eq!(flat.grid.placed(in_ring), host);
    assert_eq!(flat.grid.placed(in_square), in_square);
    assert_eq!(map.grid.placed(in_ring), in_ring);
    let drawn = |case: &Case| {
        let view = view(case, &json!({"property": "VALUE"}));
        [0, 1, 2].map(|patch| {
            let cells = case.grid.active_in(patch);
            cells
                .filter(|(active, _)| view.shown.cells.drawn[*active])
                .count()
        })
    };
    let all = dims.cells();
    assert_eq!(drawn(&map), [all - 8, 4, 4]);
    assert_eq!(drawn(&flat), [all - 4, 4, 0]);
}

/// Four cells of a layer.
fn block_of_four() -> Case {
    boxes(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0], &[0.0, 1.0], &|_| 0.0)
}

#[test]
fn a_scene_in_another_space_has_no_places_of_the_first() {
    let [map, flat] = both(parallelepipeds::case(0.0));
    let explicit = CameraSpec::Explicit(ExplicitCamera {
        eye: [0.0, -5000.0, 0.0],
        target: [0.0; 3],
        up: [0.0, 0.0, 1.0],
        fovy_degrees: 30.0,
        projection: Projection::Parallel,
    });
    let clip = json!({
        "clip": [{"point": [0.0, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]}], "vertical_exaggeration": 7.0,
        "sampling_step": 3.0, "property": "VALUE",
    });
    let scene = Scene {
        camera: explicit,
        ..scene(&map, &clip)
    };
    assert_eq!(scene.clone().in_space(Space::Map), scene);
    let there = scene.clone().in_space(Space::Ijk);
    assert_eq!(there.camera.projection(), Projection::Parallel);
    assert!(there.camera.framing_zoom().is_some() && there.clip.is_empty());
    assert_eq!(
        (there.vertical_exaggeration, there.sampling_step),
        (None, None)
    );
    assert_eq!(there.property, scene.property);
    assert!(view::resolve(&there, &flat).is_ok());
    // What is of one space is not shown in the other.
    let error = view::resolve(&there, &map).unwrap_err().to_string();
    assert!(error.contains("space"), "{error}");
    assert!(view::resolve(&scene, &flat).is_err());
    // Scene files of map space do not name it.
    let written = [&scene, &there].map(|scene| serde_json::to_value(scene).unwrap());
    assert_eq!(
        [&written[0]["space"], &written[1]["space"]],
        [&Value::Null, &json!("ijk")]
    );
}

#[test]
fn layers_are_seen_whatever_their_number() {
    let factor = |[i, j, k]: [usize; 3]| {
        let planes = |count: usize| (0..=count).map(|n| 10.0 * n as f64).collect::<Vec<f64>>();
        let case = boxes(&planes(i), &planes(j), &planes(k), &|_| 0.5);
        let [map, flat] = both(case);
        let of = |case: &Case| view(case, &json!({})).world.vertical_exaggeration;
        [of(&map), of(&flat)]
    };
    // A true shape is never squeezed.
    assert_eq!(factor([2, 3, 18]), [1.0, 0.1]);
    assert_eq!(factor([6, 5, 4]), [1.0, 1.0]);
    assert_eq!(factor([30, 2, 3]), [2.0, 2.0]);
}

#[test]
fn the_command_picks_in_index_space() {
    let picked = |at: &str, space: &str| -> Value {
        let run = Command::new(env!("CARGO_BIN_EXE_strataray"))
            .args(["pick", "--property", "DEPTH", "--mode", "cells", "--json"])
            .args([
                "--camera", "180,90", "--plain", "--at", at, "--space", space,
            ])
            .arg(common::sample())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{said}");
        let facts: Value = serde_json::from_slice(&run.stdout).unwrap();
        facts["hit"].clone()
    };
    let case = load::open(&common::sample()).unwrap();
    let cell = |hit: &Value| {
        let number = |key: &str| hit[key].as_u64().unwrap() as usize;
        let ijk = ["i", "j", "k"].map(number);
        case.grid.dims().one_based(ijk).unwrap()
    };
    let (left, right) = ("300,400", "700,400");
    let hits = [left, right].map(|at| picked(at, "ijk"));
    for hit in &hits {
        let depth = case.grid.hexahedron(cell(hit)).center().z;
        let told = [&hit["map"][2], &hit["value"]].map(|v| v.as_f64().unwrap());
        assert!(told.iter().all(|v| (v - depth).abs() < 0.01), "{hit}");
    }
    // From above a row of the image is a row of columns.
    let [a, b] = hits.each_ref().map(cell);
    assert!(a.j == b.j && b.i > a.i + 10, "{hits:?}");
    assert_ne!(picked(left, "map")["map"], hits[0]["map"]);
}
