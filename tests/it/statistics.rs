//! What a frame counts, against the same counts by the reference.

use crate::common;
use crate::common::shape::Shape;
use strataray::case::{Case, load};
use strataray::reference::{Locator, Ray};
use strataray::render::gpu::GpuRenderer;
use strataray::render::{FrameStats, Renderer};
use strataray::scene::{CameraSpec, FramingCamera, OpacitySpec, Projection, Scene, StrategyKind};
use strataray::view::{self, View};

fn view_of(case: &Case) -> View {
    let mut scene = Scene {
        size: [48, 36],
        camera: CameraSpec::Framing(FramingCamera {
            azimuth_degrees: 215.0,
            elevation_degrees: 25.0,
            zoom: 1.1,
            projection: Projection::Perspective,
        }),
        early_termination: 0.0,
        ..Scene::default()
    };
    scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.1], [1.0, 0.1]]));
    view::resolve(&scene, case).unwrap()
}

/// What rays meet by f64.
#[derive(Debug, Default)]
struct Counts {
    covered: u64,
    entries: u64,
    crossings: u64,
    samples: u64,
}

fn by_reference(case: &Case, view: &View) -> Counts {
    let locator = Locator::of_drawn(&case.grid, &view.shown.cells.drawn);
    let to_corners = view.world.corners.iter();
    let to_corners = to_corners.map(|corner| corner.distance(view.camera.eye));
    let steps = (to_corners.fold(0.0, f64::max) / view.sampling.step).ceil() as u32;
    let mut counts = Counts::default();
    for y in 0..view.size[1] {
        for x in 0..view.size[0] {
            let ray = Ray::through_pixel(view, x, y);
            let before = counts.samples;
            let mut last = None;
            for n in 0..steps {
                let at = ray.origin + (f64::from(n) + 0.5) * view.sampling.step * ray.direction;
                let found = locator.locate(view.world.spaces.grid_from_world.transform_point3(at));
                let cell = found.map(|f| f.ijk);
                counts.samples += u64::from(cell.is_some());
                counts.entries += u64::from(cell.is_some() && last.is_none());
                counts.crossings += u64::from(cell.is_some() && cell != last);
                last = cell;
            }
            counts.covered += u64::from(counts.samples > before);
        }
    }
    counts
}

fn stats(renderer: &mut GpuRenderer, view: &View, strategy: StrategyKind) -> FrameStats {
    let view = view.by(strategy);
    let frame = renderer.render(&view, &|_| true).unwrap();
    frame.stats
}

/// Columns whose pillars stand anywhere near their places, so that some cells are concave and some fold over.
fn folded() -> Case {
    Shape {
        dims: [6, 5, 4],
        pillar: &|i, j| {
            let number = (i + 7 * j) as f64;
            let x = 100.0 * i as f64 + 75.0 * (12.9 * number).sin();
            let y = 100.0 * j as f64 + 75.0 * (78.2 * number).cos();
            [[x, y, 900.0], [x + 20.0, y - 30.0, 1100.0]]
        },
        depth: &|[i, j, k], [di, dj, dk]| {
            1000.0 + 20.0 * (k + dk) as f64 + 4.0 * (i + di) as f64 - 3.0 * (j + dj) as f64
        },
        ..Shape::default()
    }
    .case()
}

#[test]
fn frames_count_what_the_reference_counts() {
    let Some(gpu) = common::gpu() else { return };
    for (name, case) in [
        ("sample", load::open(&common::sample()).unwrap()),
        ("folded", folded()),
    ] {
        let view = view_of(&case);
        let truth = by_reference(&case, &view);
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let [libc, plts, srg] = StrategyKind::ALL.map(|s| stats(&mut renderer, &view, s));
        println!("{name}: {truth:?}");
        for (strategy, s) in [("libc", libc), ("plts", plts), ("srg", srg)] {
            println!(
                "  {strategy}: {} covered, {} entries, {} crossings, {} samples, {} located, {} lost",
                s.covered_pixels,
                s.entries,
                s.cell_crossings,
                s.samples,
                s.point_locations,
                s.lost_samples
            );
            assert_eq!((s.lost_samples, s.lost_rays), (0, 0), "{name} {strategy}");
        }
        let is_close = |a: u64, b: u64, part: f64| (a as f64 - b as f64).abs() <= part * b as f64;
        assert!(is_close(plts.samples, truth.samples, 1e-3), "{name}");
        assert!(is_close(plts.entries, truth.entries, 0.01), "{name}");
        assert!(is_close(plts.covered_pixels, truth.covered, 2e-3), "{name}");
        // Where rays leave the cells, they are searched once; all along where cells fold over.
        let searches = plts.point_locations as f64 / plts.entries as f64;
        assert!(searches < 2.0 || name == "folded", "{name}: {searches}");
        assert_eq!((srg.cell_crossings, srg.point_locations), (0, 0));
        assert!(is_close(srg.entries, truth.covered, 0.05), "{name}");
        if name == "sample" {
            // Where cells overlap there is more than one right answer, and more than one way through.
            assert!(is_close(plts.cell_crossings, truth.crossings, 0.01));
            assert!(is_close(libc.samples, truth.samples, 0.01));
            assert!(is_close(libc.entries, truth.entries, 0.1));
            assert!(libc.cell_crossings > plts.cell_crossings);
        }
        // The twin: another sampling step has other samples.
        let coarse = {
            let mut changed = view.clone();
            changed.sampling.step = 1.1 * view.sampling.step;
            changed
        };
        let coarse = stats(&mut renderer, &coarse, StrategyKind::Plts);
        assert!(!is_close(coarse.samples, truth.samples, 0.05), "{name}");
    }
}
