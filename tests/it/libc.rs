//! The cell-to-cell walk: its options against each other and against the limit of fine steps.

use crate::common;
use glam::DVec3;
use strataray::case::load;
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::reference;
use strataray::render::gpu::GpuRenderer;
use strataray::render::{FrameStats, Renderer};
use strataray::scene::{
    CameraSpec, ExplicitCamera, FramingCamera, Integration, Interpolation, LibcSettings,
    Projection, Scene, StrategyKind,
};
use strataray::view::{self, View};

fn scene(azimuth: f64, elevation: f64) -> Scene {
    Scene {
        size: [120, 90],
        strategy: StrategyKind::Libc,
        camera: CameraSpec::Framing(FramingCamera {
            azimuth_degrees: azimuth,
            elevation_degrees: elevation,
            zoom: 1.2,
            projection: Projection::Perspective,
        }),
        ..Scene::default()
    }
}

fn with(view: &View, libc: LibcSettings) -> View {
    let mut changed = view.clone();
    changed.sampling.libc = libc;
    changed
}

fn render(renderer: &mut GpuRenderer, view: &View) -> (Image, FrameStats) {
    let frame = renderer.render(view, &|_| true).unwrap();
    assert_eq!(frame.stats.lost_rays, 0);
    assert!(frame.image.pixels.iter().flatten().all(|v| v.is_finite()));
    (frame.image, frame.stats)
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

#[test]
fn walking_across_faults_changes_the_cost_and_not_the_picture() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        for (azimuth, elevation) in [(205.0, 35.0), (80.0, 12.0), (0.0, 90.0)] {
            let view = view::resolve(&scene(azimuth, elevation), &case).unwrap();
            let (across, walked) = render(&mut renderer, &view);
            let plain = LibcSettings {
                cross_faults: false,
                ..view.sampling.libc
            };
            let (plain, peeled) = render(&mut renderer, &with(&view, plain));
            let db = psnr(&across, &plain, &view);
            println!(
                "{} {azimuth}: {db:.1} dB, peels {} across and {} plain, recovered {} and {}, steps {}",
                case.about.name,
                walked.peels,
                peeled.peels,
                walked.recovered_rays,
                peeled.recovered_rays,
                walked.topological_steps
            );
            assert!(db >= 50.0, "{} {azimuth}: {db}", case.about.name);
            assert!(walked.peels <= peeled.peels);
            assert!(walked.recovered_rays * 1000 <= walked.topological_steps);
        }
    }
}

#[test]
fn segments_are_the_limit_of_fine_steps() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        for (azimuth, interpolation) in
            [(205.0, Interpolation::Vertex), (80.0, Interpolation::Cell)]
        {
            let mut scene = scene(azimuth, 30.0);
            scene.size = [80, 60];
            scene.early_termination = 0.0;
            scene.interpolation = interpolation;
            let view = view::resolve(&scene, &case).unwrap();
            let fine = {
                let mut changed = view.clone();
                changed.sampling.step = 0.25 * view.sampling.step;
                changed
            };
            let truth = reference::render(&case.grid, &fine, &|_| true).unwrap();
            let segments = LibcSettings {
                integration: Integration::Segments,
                ..view.sampling.libc
            };
            let (by_segment, segments) = render(&mut renderer, &with(&view, segments));
            // Samples so coarse that they are a sixteenth of as many as by default.
            let coarse = {
                let mut changed = view.clone();
                changed.sampling.step = 16.0 * view.sampling.step;
                changed
            };
            let (by_coarse, coarse) = render(&mut renderer, &coarse);
            let (limit, _) = render(&mut renderer, &fine);
            let against_reference = psnr(&by_segment, &truth, &view);
            let found = [&by_segment, &by_coarse].map(|i| psnr(i, &limit, &view));
            println!(
                "{} {interpolation:?}: {} pieces, {against_reference:.1} dB to the reference, {:.1} dB to fine samples; {} coarse samples {:.1} dB",
                case.about.name, segments.samples, found[0], coarse.samples, found[1]
            );
            assert!(against_reference >= 45.0 && found[0] >= 50.0);
            // The twin: coarse samples are not the limit.
            assert!(found[1] + 6.0 < found[0]);
        }
    }
}

#[test]
fn an_eye_inside_the_model_sees_what_is_ahead() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let outside = view::resolve(&scene(205.0, 35.0), &case).unwrap();
        // In the middle of the active cell halfway through the list.
        let cells = case.grid.active_cells();
        let cell = case.grid.dims().ijk(cells[cells.len() / 2]);
        let eye = outside
            .world
            .spaces
            .world_from_grid
            .transform_point3(case.grid.hexahedron(cell).center());
        let mut scene = scene(205.0, 35.0);
        scene.camera = CameraSpec::Explicit(ExplicitCamera {
            eye: eye.to_array(),
            target: (eye + DVec3::new(1.0, 2.0, -0.1)).to_array(),
            up: [0.0, 0.0, 1.0],
            fovy_degrees: 70.0,
            projection: Projection::Perspective,
        });
        let view = view::resolve(&scene, &case).unwrap();
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        let (image, _) = render(&mut renderer, &view);
        let db = psnr(&image, &truth, &view);
        let elsewhere = psnr(&render(&mut renderer, &outside).0, &truth, &view);
        println!(
            "{}: {db:.1} dB, from elsewhere {elsewhere:.1} dB",
            case.about.name
        );
        assert!(db >= 38.0 && elsewhere < 30.0, "{}", case.about.name);
    }
}
