//! Cells that overlap: each point belongs to the first one that is drawn, whatever a filter hides.

use crate::common;
use crate::common::shape::crossing;
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::reference;
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::{
    CameraSpec, FramingCamera, Interpolation, OpacitySpec, Projection, RangeSpec, Scene,
    StrategyKind,
};
use strataray::view::{self, View};

/// Layers `k`, evenly opaque, seen from aside.
fn view_of(case: &Case, k: [usize; 2]) -> View {
    let mut scene = Scene {
        size: [80, 60],
        property: Some("VALUE".into()),
        range: RangeSpec::Fixed([0.0, 0.4]),
        interpolation: Interpolation::Cell,
        vertical_exaggeration: Some(5.0),
        camera: CameraSpec::Framing(FramingCamera {
            azimuth_degrees: 205.0,
            elevation_degrees: 10.0,
            zoom: 1.0,
            projection: Projection::Perspective,
        }),
        ..Scene::default()
    };
    scene.filter = serde_json::from_value(serde_json::json!({ "k": k })).unwrap();
    scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.3], [1.0, 0.3]]));
    scene.transfer.reference_length = Some(100.0);
    view::resolve(&scene, case).unwrap()
}

fn mean_alpha(image: &Image) -> f64 {
    let alphas = image.pixels.iter().map(|p| f64::from(p[3]));
    alphas.sum::<f64>() / image.pixels.len() as f64
}

/// Mean alpha by the reference and by each strategy.
fn mean_alphas(renderer: &mut GpuRenderer, case: &Case, view: &View) -> (f64, Vec<f64>) {
    let truth = reference::render(&case.grid, view, &|_| true).unwrap();
    let by = |strategy| {
        let view = view.by(strategy);
        let frame = renderer.render(&view, &|_| true).unwrap();
        mean_alpha(&frame.image)
    };
    let all = StrategyKind::ALL.into_iter().map(by).collect();
    (mean_alpha(&truth), all)
}

#[test]
fn a_hidden_cell_takes_no_point_from_one_that_is_drawn() {
    let Some(gpu) = common::gpu() else { return };
    let case = crossing();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let mut means = Vec::new();
    for k in [[1, 2], [1, 1], [2, 2]] {
        let view = view_of(&case, k);
        let (truth, all) = mean_alphas(&mut renderer, &case, &view);
        println!("layers {k:?}: reference {truth:.4}, strategies {all:.4?}");
        assert!(
            all.iter().all(|a| (a - truth).abs() < 1.5e-2 * truth),
            "{k:?}"
        );
        means.push(truth);
    }
    // Each layer alone is as thick as the other, and both together are less than twice that.
    let [both, upper, lower] = means[..] else {
        unreachable!()
    };
    assert!((upper - lower).abs() < 0.05 * lower, "{upper} {lower}");
    assert!(both > 1.3 * lower && both < 1.7 * lower, "{both} {lower}");
}

#[test]
fn the_reported_grid_has_the_right_mean() {
    let Some(gpu) = common::gpu() else { return };
    let [model, scene] = ["F25_OVERLAP.GRDECL", "F25_OVERLAP.json"]
        .map(|file| common::bundled("reported").join(file));
    let case = load::open(&model).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let text = std::fs::read_to_string(scene).unwrap();
    let scene: Scene = serde_json::from_str(&text).unwrap();
    let view = view::resolve(&scene, &case).unwrap();
    let (truth, all) = mean_alphas(&mut renderer, &case, &view);
    println!("reference {truth:.4}, strategies {all:.4?}");
    // What the other layer hides of this one would be nearly half.
    assert!(all.iter().all(|a| (a - truth).abs() < 1.5e-2 * truth));
    assert!(truth > 0.12, "{truth}");
}
