//! What every executor must do alike: images against the f64 reference, looks against each other.

use std::sync::Arc;
use std::time::Instant;

use crate::common;
use crate::common::shape::{Shape, crossing};
use glam::DVec3;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::model::Ijk;
use strataray::reference::{self, Locator};
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::{Executor, FrameStats, RenderError, Renderer};
use strataray::scene::{Integration, StrategyKind};
use strataray::view::{self, View};

/// Strategies that every executor has.
const STRATEGIES: [StrategyKind; 2] = [StrategyKind::Plts, StrategyKind::Libc];

fn cpu() -> Arc<dyn Executor> {
    Arc::new(CpuExecutor::default())
}

/// All that there are.
fn executors() -> Vec<Arc<dyn Executor>> {
    let gpu = common::gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    gpu.into_iter().chain([cpu()]).collect()
}

fn opened(case: &Case, written: &Value) -> View {
    let scene = view::look::opening(case, written).unwrap();
    view::resolve(&scene, case).unwrap()
}

/// A view of the volume alone, `more` laid over it.
fn volume(case: &Case, more: &Value) -> View {
    let mut written = json!({
        "size": [120, 90], "mode": "volume", "lighting": {}, "show": {"hull": "hidden"},
    });
    let written_keys = written.as_object_mut().unwrap();
    written_keys.extend(more.as_object().unwrap().clone());
    opened(case, &written)
}

/// The image and what it took; no ray and no sample is lost.
fn render(renderer: &mut dyn Renderer, view: &View) -> (Image, FrameStats) {
    let frame = renderer.render(view, &|_| true).unwrap();
    assert!(frame.image.pixels.iter().flatten().all(|v| v.is_finite()));
    let stats = frame.stats;
    assert_eq!((stats.lost_rays, stats.lost_samples), (0, 0), "{stats:?}");
    (frame.image, stats)
}

fn truth(case: &Case, view: &View) -> Image {
    reference::render(&case.grid, view, &|_| true).unwrap()
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

/// What a strategy must reach against the reference, PSNR in dB.
fn least(strategy: StrategyKind) -> f64 {
    match strategy {
        StrategyKind::Plts => 74.0,
        // Linear parameters in a cell and faces of triangles are not the trilinear map.
        _ => 51.0,
    }
}

#[test]
fn executors_agree_with_the_reference() {
    for model in common::models() {
        let case = load::open(&model).unwrap();
        for interpolation in ["vertex", "cell"] {
            let view = volume(&case, &json!({ "interpolation": interpolation }));
            let truth = truth(&case, &view);
            for executor in executors() {
                let mut renderer = executor.renderer(&case.grid).unwrap();
                for strategy in STRATEGIES {
                    let (image, stats) = render(&mut *renderer, &view.by(strategy));
                    let db = psnr(&image, &truth, &view);
                    let place = format!(
                        "{} {} {} {interpolation}: {db:.1} dB",
                        executor.info().executor,
                        case.about.name,
                        strategy.name()
                    );
                    println!("{place}");
                    assert!(db >= least(strategy), "{place}");
                    assert!(stats.samples > 20_000, "{place}: {}", stats.samples);
                }
            }
        }
    }
}

/// The twin.
#[test]
fn a_shifted_camera_is_noticed() {
    let case = load::open(&common::sample()).unwrap();
    let view = volume(&case, &json!({}));
    let truth = truth(&case, &view);
    let mut shifted = view.clone();
    let [low, high] = view.world.bounds;
    let distance = view.camera.eye.distance(0.5 * (low + high));
    let pixel = view.camera.half_height(distance) * 2.0 / f64::from(view.size[1]);
    shifted.camera.eye += pixel * view.camera.right;
    let mut renderer = cpu().renderer(&case.grid).unwrap();
    for strategy in STRATEGIES {
        let (image, _) = render(&mut *renderer, &shifted.by(strategy));
        let db = psnr(&image, &truth, &view);
        assert!(db < 40.0, "{}: {db}", strategy.name());
    }
}

/// Rays ask no cells that they do not pass: a location for each entry at most. On the CPU they make two or three Newton
/// iterations a cell, on the GPU one a sample.
#[test]
fn rays_search_only_where_cells_are() {
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let view = volume(&case, &json!({"strategy": "plts"}));
        for executor in executors() {
            let mut renderer = executor.renderer(&case.grid).unwrap();
            let (_, stats) = render(&mut *renderer, &view);
            let covered = stats.covered_pixels as f64;
            let locations = stats.point_locations as f64 / covered;
            let iterations = stats.newton_iterations as f64 / stats.cell_crossings as f64;
            let cells = stats.cell_crossings as f64 / covered;
            let bytes = stats.bytes_read(&view) as f64 / covered;
            let name = executor.info().executor;
            println!(
                "{} {name}: {locations:.2} {iterations:.2} {bytes:.0} B",
                case.about.name
            );
            // A cell takes 160 bytes by values at its vertices.
            assert!((bytes / (160.0 * (cells + locations)) - 1.0).abs() < 1e-6);
            assert!(bytes < 5000.0, "{name} {bytes}");
            assert!(
                locations < 3.0 && stats.lost_samples == 0,
                "{name} {stats:?}"
            );
            assert!(
                name == "gpu" || (locations < 1.5 && iterations < 4.0),
                "{stats:?}"
            );
        }
    }
}

/// PLTS over whole cells is what samples come to where they are dense, by two Newton iterations a cell.
#[test]
fn whole_cells_are_dense_samples() {
    for model in common::models() {
        let case = load::open(&model).unwrap();
        for interpolation in ["vertex", "cell"] {
            let look = json!({"interpolation": interpolation, "plts": {"integration": "segments"}});
            let view = volume(&case, &look).by(StrategyKind::Plts);
            let mut dense = view.clone();
            dense.sampling.step *= 0.125;
            let truth = truth(&case, &dense);
            let mut images = Vec::new();
            for executor in executors() {
                let mut renderer = executor.renderer(&case.grid).unwrap();
                let (image, stats) = render(&mut *renderer, &view);
                let db = psnr(&image, &truth, &view);
                let mut by_samples = view.clone();
                by_samples.sampling.plts.integration = Integration::Samples;
                let (of_samples, by_samples) = render(&mut *renderer, &by_samples);
                let of_samples = psnr(&of_samples, &truth, &view);
                let iterations = stats.newton_iterations as f64 / stats.cell_crossings as f64;
                let [who, name] = [executor.info().executor, &case.about.name];
                println!(
                    "{who} {name} {interpolation}: {db:.1} dB, {of_samples:.1} by samples, {iterations:.2}"
                );
                assert!(db >= 60.0, "{who} {name} {interpolation} {db}");
                assert!(iterations < 3.0, "{who} {stats:?}");
                assert!(stats.newton_iterations < by_samples.newton_iterations);
                images.push(image);
            }
            if let [a, b] = &images[..] {
                let db = psnr(a, b, &view);
                println!("{interpolation}: {db:.1} dB apart");
                assert!(db > 66.0, "{interpolation} {db}");
            }
        }
    }
}

/// Cells in which the transfer function shows nothing are passed without a step, and the image is that of a walk
/// through them; a curve that shows them again brings them back.
#[test]
fn invisible_cells_are_passed() {
    let faint = json!([[0.0, 0.1], [1.0, 0.4]]);
    let upper = json!([[0.0, 0.0], [0.55, 0.0], [0.6, 0.2], [1.0, 0.5]]);
    let looks = [
        json!({}),
        json!({"interpolation": "cell"}),
        json!({"show": {"hull": "hidden", "inactive": "ghost"}}),
        json!({"show": {"hull": "faint", "faults": true}}),
    ];
    for (model, executors) in common::models().iter().zip(
        // Software shaders take long.
        [executors(), executors(), vec![cpu()], vec![cpu()]],
    ) {
        let case = load::open(model).unwrap();
        for (executor, (n, look)) in executors
            .iter()
            .flat_map(|executor| std::iter::repeat(executor).zip(looks.iter().enumerate()))
        {
            let strategy = STRATEGIES[n % 2];
            let with = |opacity: &Value| {
                let mut look = look.clone();
                look["transfer"] = json!({ "opacity": opacity });
                volume(&case, &look).by(strategy)
            };
            let view = with(&upper);
            let mut renderer = executor.renderer(&case.grid).unwrap();
            let (image, passing) = render(&mut *renderer, &view);
            let (pixels, db) = apart(&image, &truth(&case, &view), &view);
            let [who, name] = [executor.info().executor, strategy.name()];
            let model = &case.about.name;
            let place = format!("{who} {model} {name} {look}: {pixels} pixels, {db:.1} dB");
            println!("{place}");
            assert!(pixels <= 6 && db >= least(strategy), "{place}");
            let all = with(&faint);
            let (shown, walking) = render(&mut *renderer, &all);
            let crossings = [passing, walking].map(|stats| stats.cell_crossings);
            assert!(
                10 * crossings[0] < 9 * crossings[1],
                "{place} {crossings:?}"
            );
            let mut fresh = executor.renderer(&case.grid).unwrap();
            let back = psnr(&render(&mut *fresh, &all).0, &shown, &all);
            assert!(back > 90.0, "{place} {back}");
        }
    }
}

/// Pixels that differ by more than 8 of 255, and PSNR in dB of all others: at outlines one executor's ray may meet a
/// face that the other's just misses.
fn apart(a: &Image, b: &Image, view: &View) -> (usize, f64) {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    let is_near = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).all(|c| a[c].abs_diff(b[c]) <= 8);
    let near = a.iter().zip(&b).filter(is_near);
    let (of_a, of_b): (Vec<[u8; 3]>, Vec<[u8; 3]>) = near.unzip();
    let db = psnr_8bit(of_a.as_flattened(), of_b.as_flattened());
    (a.len() - of_a.len(), db)
}

/// Looks of a model, with a plane through its middle that is cut open.
fn looks(case: &Case) -> Vec<Value> {
    let plain = volume(case, &json!({}));
    let [low, high] = plain.world.bounds;
    let clip = |face: &str| {
        let away = plain.camera.forward.with_z(0.0) + DVec3::new(0.3, 0.1, 0.0);
        let middle = 0.5 * (low + high);
        json!([{"point": middle.to_array(), "normal": away.to_array(), "face": face}])
    };
    let parallel = |azimuth: f64, elevation: f64| {
        json!({
            "azimuth_degrees": azimuth, "elevation_degrees": elevation, "projection": "parallel",
        })
    };
    let hull = |hull: &str| json!({"hull": hull});
    vec![
        json!({"filter": {"k": [2, 3]}, "interpolation": "cell"}),
        json!({"filter": {"properties": [{"name": "PORO", "min": 0.15}]}}),
        json!({"clip": clip("open")}),
        json!({"clip": clip("opaque"), "show": {"hull": "hidden", "cell_edges": true}}),
        json!({"show": {"hull": "hidden", "inactive": "ghost"}}),
        json!({"show": {"hull": "opaque", "inactive": "ghost", "faults": true}}),
        json!({"show": hull("faint")}),
        json!({"show": {"hull": "faint", "faults": true, "cell_edges": true}}),
        json!({"show": hull("opaque"), "clip": clip("open")}),
        json!({"mode": "cells"}),
        json!({"mode": "cells", "clip": clip("open")}),
        json!({"mode": "cells", "show": {"inactive": "ghost"}}),
        json!({"camera": parallel(140.0, 25.0), "show": {"hull": "faint", "faults": true}}),
        json!({"camera": parallel(0.0, 90.0), "mode": "cells"}),
        json!({"libc": {"integration": "segments"}, "interpolation": "cell"}),
        json!({"libc": {"cross_faults": false}}),
        json!({"plts": {"integration": "segments"}, "show": {"hull": "faint", "faults": true, "inactive": "ghost"}}),
        json!({"filter": {"k": [2, 3]}, "libc": {"integration": "segments"}}),
        json!({"plts": {"integration": "segments"}, "clip": clip("open")}),
        json!({"lighting": {"exact_colors": true}, "show": {"hull": "opaque", "inactive": "ghost"}}),
        json!({"blending": "linear", "early_termination": 0.0}),
    ]
}

#[test]
fn executors_make_the_same_of_every_look() {
    let Some(gpu) = common::gpu() else { return };
    let gpu = GpuExecutor::from(gpu);
    for (model, every) in common::models().iter().take(2).zip([1, 3]) {
        let case = load::open(model).unwrap();
        let mut on_gpu = gpu.renderer(&case.grid).unwrap();
        let mut on_cpu = cpu().renderer(&case.grid).unwrap();
        let looks = looks(&case);
        for (n, look) in looks.iter().enumerate().step_by(every) {
            let view = volume(&case, look).by(STRATEGIES[n % 2]);
            let frame = on_gpu.render(&view, &|_| true).unwrap();
            let (a, of_gpu) = (frame.image, frame.stats);
            let (b, of_cpu) = render(&mut *on_cpu, &view);
            let (pixels, db) = apart(&a, &b, &view);
            let place = format!("{} {look}: {pixels} pixels, {db:.1} dB", case.about.name);
            println!("{place}");
            assert!(pixels * 1000 <= a.pixels.len() && db > 60.0, "{place}");
            let covered = [of_gpu, of_cpu].map(|s| s.covered_pixels as f64);
            assert!((covered[0] / covered[1] - 1.0).abs() < 5e-3, "{covered:?}");
        }
    }
}

/// A grid whose cells lean, dip and pinch out, with a fault that scissors through it. One corner is drawn into its cell:
/// so far that this folds over where `drawn_in` is above 50.
fn odd(drawn_in: f64) -> Case {
    Shape {
        dims: [5, 4, 6],
        pillar: &|i, j| {
            let [x, y] = [100.0 * i as f64, 90.0 * j as f64];
            let lean = 30.0 * ((i * 7 + j * 5) % 4) as f64 - 45.0;
            let drawn_in = if (i, j) == (2, 2) { drawn_in } else { 0.0 };
            let top = [x - drawn_in, y - drawn_in, 1000.0];
            [
                top,
                [x + lean - drawn_in, y - 0.5 * lean - drawn_in, 1200.0],
            ]
        },
        depth: &|[i, j, k], [di, dj, dk]| {
            let [x, y] = [(i + di) as f64, (j + dj) as f64];
            let throw = if i > 2 { 14.0 * (y - 1.0) } else { 0.0 };
            // The third layer pinches out toward the north.
            let below = match k + dk {
                plane @ 0..=2 => 20.0 * plane as f64,
                plane => 60.0 - 5.0 * y + 22.0 * (plane - 3) as f64,
            };
            1000.0 + below + 3.0 * x * y + throw
        },
        value: &|[i, j, k]| ((3 * i + 5 * j + 7 * k) % 10) as f64 / 10.0,
        active: &|[i, j, k]| (i, j, k) != (1, 1, 4),
        ..Shape::default()
    }
    .case()
}

#[test]
fn samples_are_found_in_cells_of_odd_shapes() {
    // Cells that fold over lie in each other: there a sample has more than one right value.
    for (name, case, least, executors) in [
        ("odd", odd(40.0), 60.0, executors()),
        ("folding", odd(60.0), 50.0, executors()),
        ("crossing", crossing(), 60.0, vec![cpu()]),
    ] {
        for (azimuth, elevation) in [(205.0, 20.0), (80.0, 55.0), (300.0, -15.0), (0.0, 90.0)] {
            let view = volume(
                &case,
                &json!({
                    "property": "VALUE", "range": [0.0, 1.0], "interpolation": "cell",
                    "vertical_exaggeration": 2.0, "strategy": "plts",
                    "camera": {"azimuth_degrees": azimuth, "elevation_degrees": elevation},
                    "transfer": {"opacity": [[0.0, 0.3], [1.0, 0.3]], "reference_length": 100.0},
                }),
            );
            let truth = truth(&case, &view);
            for executor in &executors {
                let mut renderer = executor.renderer(&case.grid).unwrap();
                let (image, stats) = render(&mut *renderer, &view);
                let db = psnr(&image, &truth, &view);
                let place = format!("{} {name} {azimuth}: {db:.1} dB", executor.info().executor);
                println!("{place}, {stats:?}");
                assert!(db > least, "{place}");
            }
        }
    }
}

#[test]
fn whole_cells_are_crossed_whatever_their_shape() {
    for (name, case, least) in [("odd", odd(40.0), 52.0), ("folding", odd(60.0), 50.0)] {
        for (azimuth, elevation) in [(205.0, 20.0), (80.0, 55.0), (0.0, 90.0)] {
            let view = volume(
                &case,
                &json!({
                    "property": "VALUE", "range": [0.0, 1.0], "interpolation": "cell",
                    "vertical_exaggeration": 2.0, "strategy": "plts", "plts": {"integration": "segments"},
                    "camera": {"azimuth_degrees": azimuth, "elevation_degrees": elevation},
                    "transfer": {"opacity": [[0.0, 0.3], [1.0, 0.3]], "reference_length": 100.0},
                }),
            );
            let mut dense = view.clone();
            dense.sampling.step *= 0.125;
            let truth = truth(&case, &dense);
            for executor in executors() {
                let mut renderer = executor.renderer(&case.grid).unwrap();
                let (image, stats) = render(&mut *renderer, &view);
                let db = psnr(&image, &truth, &view);
                let place = format!("{} {name} {azimuth}: {db:.1} dB", executor.info().executor);
                println!("{place}, {stats:?}");
                assert!(db > least, "{place}");
            }
        }
    }
}

/// Rays that start among the cells.
#[test]
fn an_eye_within_the_model_sees_what_the_reference_sees() {
    let case = load::open(&common::sample()).unwrap();
    let plain = volume(&case, &json!({}));
    let [low, high] = plain.world.bounds;
    let eye = low + (high - low) * DVec3::new(0.4, 0.45, 0.5);
    let view = volume(
        &case,
        &json!({
            "camera": {
                "eye": eye.to_array(), "target": (eye + DVec3::new(1.0, 0.4, -0.1)).to_array(),
                "up": [0.0, 0.0, 1.0], "fovy_degrees": 60.0,
            },
        }),
    );
    let truth = truth(&case, &view);
    let mut renderer = cpu().renderer(&case.grid).unwrap();
    for strategy in STRATEGIES {
        let (image, _) = render(&mut *renderer, &view.by(strategy));
        let db = psnr(&image, &truth, &view);
        println!("{}: {db:.1} dB", strategy.name());
        assert!(db > least(strategy) - 10.0, "{}: {db}", strategy.name());
    }
}

#[test]
fn points_are_located_where_the_reference_has_them() {
    let mut random = fastrand::Rng::with_seed(8);
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let view = volume(&case, &json!({}));
        let [low, high] = view.world.bounds;
        let mut unit = || DVec3::new(random.f64(), random.f64(), random.f64());
        let points: Vec<DVec3> = (0..5000).map(|_| low + unit() * (high - low)).collect();
        let mut renderer = cpu().renderer(&case.grid).unwrap();
        let found = renderer.locate(&view, &points).unwrap();
        let locator = Locator::of_drawn(&case.grid, &view.shown.cells.drawn);
        let to_grid = |p: &DVec3| view.world.spaces.grid_from_world.transform_point3(*p);
        let expected = points.iter().map(|p| locator.locate(to_grid(p)));
        let mut inside = 0;
        let mut apart = 0;
        for (found, expected) in found.iter().zip(expected) {
            let cells: [Option<Ijk>; 2] = [found.map(|f| f.ijk), expected.map(|e| e.ijk)];
            inside += usize::from(cells[1].is_some());
            apart += usize::from(cells[0] != cells[1]);
        }
        println!("{}: {apart} of {inside}", case.about.name);
        assert!(inside > 200 && apart <= 5, "{apart} of {inside}");
    }
}

#[test]
fn an_image_is_made_in_pieces_and_can_be_left() {
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = cpu().renderer(&case.grid).unwrap();
    let view = volume(&case, &json!({"strategy": "plts", "size": [400, 300]}));
    let canceled = renderer.render(&view, &|_| false);
    assert!(matches!(canceled, Err(RenderError::Canceled)));
    let whole = renderer.render(&view, &|_| true).unwrap();
    assert!(whole.stats.submissions > 3);
    let mut job = renderer.start(&view);
    let mut pieces = 0;
    let pieced = loop {
        let before = job.done();
        match job.advance(Instant::now()).unwrap() {
            Some(frame) => break frame,
            None => assert!(job.done() > before && job.done() <= 1.0),
        }
        pieces += 1;
    };
    assert!(pieces > 3);
    assert_eq!(pieced.image, whole.image);
}
