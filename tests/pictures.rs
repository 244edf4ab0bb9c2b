//! Each strategy's pictures against the f64 reference.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;

use strataray::gpu::{FrameRenderer, Gpu, GpuGrid};
use strataray::metrics::{fraction_within, psnr_8bit};
use strataray::picture::Image;
use strataray::scene::{self, CameraSpec, FramingCamera, Interpolation, Scene, View};
use strataray::strategies::StrategyKind;
use strataray::{case::Case, load, reference};

fn scene(azimuth: f64, elevation: f64, interpolation: Interpolation) -> Scene {
    Scene {
        size: [120, 90],
        camera: CameraSpec::Framing(FramingCamera {
            azimuth_degrees: azimuth,
            elevation_degrees: elevation,
            zoom: 1.2,
        }),
        interpolation,
        ..Scene::default()
    }
}

fn on_gpu(gpu: &Gpu, case: &Case, view: &View, strategy: StrategyKind) -> Image {
    let mut grid = GpuGrid::new(gpu, &case.grid).unwrap();
    grid.show(
        gpu,
        &case.grid,
        &view.field,
        &view.drawn,
        view.interpolation,
    )
    .unwrap();
    let strategy = strategy.create(gpu).unwrap();
    let (image, stats) = FrameRenderer::default()
        .render(gpu, &grid, &*strategy, view, &|_| true)
        .unwrap()
        .unwrap();
    let per_sample = stats.newton_iterations as f64 / stats.samples as f64;
    println!(
        "  {} samples, {per_sample:.2} Newton iterations a sample, {} steps, {} fallbacks, longest submission {:?}",
        stats.samples, stats.topological_steps, stats.grid_fallbacks, stats.longest_submission
    );
    image
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

#[test]
fn strategies_agree_with_the_reference() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        for (azimuth, elevation, interpolation) in [
            (205.0, 35.0, Interpolation::Vertex),
            (80.0, 12.0, Interpolation::Cell),
        ] {
            let view = scene::resolve(&scene(azimuth, elevation, interpolation), &case).unwrap();
            let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
            assert!(
                truth.pixels.iter().any(|p| p[3] > 0.3),
                "{}: nothing to see",
                case.about.name
            );
            for strategy in StrategyKind::ALL {
                let image = on_gpu(&gpu, &case, &view, strategy);
                assert!(image.pixels.iter().flatten().all(|v| v.is_finite()));
                let (db, within) = (
                    psnr(&image, &truth, &view),
                    fraction_within(&image.pixels, &truth.pixels, 2e-3),
                );
                println!(
                    "{} {} {azimuth} {interpolation:?}: {db:.1} dB, {:.3} % within 2e-3",
                    case.about.name,
                    strategy.name(),
                    100.0 * within
                );
                assert!(
                    db >= 45.0 && within >= 0.999,
                    "{} {}: {db} dB, {within}",
                    case.about.name,
                    strategy.name()
                );
            }
        }
    }
}

#[test]
fn a_shifted_camera_is_noticed() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let view = scene::resolve(&scene(205.0, 35.0, Interpolation::Vertex), &case).unwrap();
    let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
    let mut shifted = view.clone();
    // About one pixel to the side.
    shifted.camera.eye += shifted.camera.right * 2.0 * shifted.camera.tan_half_fovy / 90.0
        * (shifted
            .camera
            .eye
            .distance(0.5 * (shifted.world_bounds[0] + shifted.world_bounds[1])));
    let image = on_gpu(&gpu, &case, &shifted, StrategyKind::Plts);
    let (db, within) = (
        psnr(&image, &truth, &view),
        fraction_within(&image.pixels, &truth.pixels, 2e-3),
    );
    assert!(db < 40.0 && within < 0.9, "{db} dB, {within}");
}

#[test]
fn filters_and_cancel_work() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut scene = scene(205.0, 35.0, Interpolation::Cell);
    scene.filter.k = Some([2, 3]);
    let view = scene::resolve(&scene, &case).unwrap();
    let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
    let image = on_gpu(&gpu, &case, &view, StrategyKind::Plts);
    assert!(psnr(&image, &truth, &view) >= 45.0);
    scene.filter.k = None;
    let whole = scene::resolve(&scene, &case).unwrap();
    assert!(
        psnr(
            &on_gpu(&gpu, &case, &whole, StrategyKind::Plts),
            &truth,
            &view
        ) < 40.0
    );
    assert!(reference::render(&case.grid, &view, &|_| false).is_none());
}
