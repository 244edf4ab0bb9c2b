//! Wells and sheets of faults in the way of light: executors against the reference, which has rays meet them exactly.

use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value, json};

use crate::common;
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::{ciede2000_map, mean, psnr_8bit};
use strataray::reference;
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::{Executor, Renderer};
use strataray::view::wells::{Capsule, Wells};
use strataray::view::{self, View};

/// A thin medium with light from above and occlusion toward the viewer.
fn view_of(case: &Case, mode: &str, geometry: bool, more: &Value) -> View {
    let mut written = json!({
        "size": [56, 42], "mode": "volume", "property": "PORO",
        "transfer": {"opacity": [[0, 0.03], [1, 0.03]]}, "vertical_exaggeration": 8,
        "camera": {"azimuth_degrees": 30, "elevation_degrees": 35},
        "show": {"hull": "hidden"},
        "lighting": {
            "geometry": geometry, "occlusion": {"mode": mode, "half_angle_degrees": 8, "splits": 3},
            "shadows": {"mode": mode, "splits": 3}, "rays": 16, "ambient": 0.5,
            "lights": [{"kind": "directional", "direction": [0.3, 0.2, -1], "half_angle_degrees": 8}],
            "volume": {"size": [96, 96, 48]},
        },
    });
    for (key, value) in more.as_object().unwrap() {
        written[key] = value.clone();
    }
    let scene = view::look::opening(case, &written).unwrap();
    view::resolve(&scene, case).unwrap()
}

/// The view with wells across the model and down through it, of a radius in parts of the diagonal.
fn with_tubes(mut view: View, radius: f64) -> View {
    let [low, high] = view.world.bounds;
    let at = |x: f64, y: f64, z: f64| low + DVec3::new(x, y, z) * (high - low);
    let lines = [
        [at(-0.1, 0.5, 0.9), at(1.1, 0.5, 0.9)],
        [at(0.3, 0.2, 1.2), at(0.3, 0.2, 0.1)],
    ];
    let capsule = |ends| Capsule {
        ends,
        radius: radius * low.distance(high),
        color: [0.9, 0.1, 0.1],
        well: 0,
    };
    view.shown.wells = Arc::new(Wells {
        capsules: lines.map(capsule).to_vec(),
        heads: Vec::new(),
    });
    view.style.surfaces.wells = true;
    view
}

fn image(renderer: &mut dyn Renderer, view: &View) -> Image {
    renderer.render(view, &|_| true).unwrap().image
}

fn bytes(image: &Image) -> Vec<[u8; 3]> {
    image.over_background_8bit([1.0; 3])
}

/// Mean color difference.
fn apart(a: &Image, b: &Image) -> f64 {
    mean(&ciede2000_map(&bytes(a), &bytes(b)).unwrap())
}

/// How much darker one image is than another over all pixels, of 255.
fn darker(a: &Image, than: &Image) -> f64 {
    let light = |image: &Image| {
        let all = bytes(image);
        let sum: f64 = all.iter().flatten().map(|c| f64::from(*c)).sum();
        sum / (3 * all.len()) as f64
    };
    light(than) - light(a)
}

#[test]
fn wells_and_sheets_darken_what_lies_behind_them_as_rays_say() {
    let case = load::open(&common::sample()).unwrap();
    let gpu = common::gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    let sheets = json!({"show": {"hull": "hidden", "faults": true}});
    for (what, more, radius) in [
        ("thick wells", json!({}), Some(0.008)),
        ("thin wells", json!({}), Some(0.003)),
        ("sheets", sheets, None),
    ] {
        let shown = |mode: &str, geometry: bool| {
            let view = view_of(&case, mode, geometry, &more);
            radius.map_or(view.clone(), |radius| with_tubes(view, radius))
        };
        let truth = |geometry| {
            let view = shown("monte_carlo", geometry);
            reference::render(&case.grid, &view, &|_| true).unwrap()
        };
        let [with, without] = [true, false].map(truth);
        let darkens = darker(&with, &without);
        assert!(darkens > 0.05, "{what}: {darkens}");
        for executor in gpu.iter().chain([&cpu]) {
            let mut renderer = executor.renderer(&case.grid).unwrap();
            for mode in ["preilluminated", "monte_carlo"] {
                let [own, twin] = [true, false].map(|g| image(&mut *renderer, &shown(mode, g)));
                let [error, of_twin] = [&own, &twin].map(|made| apart(made, &with));
                let own_darkens = darker(&own, &twin);
                let place = format!(
                    "{what} {mode} {}: {error:.2} apart, twin {of_twin:.2}; darker by {own_darkens:.2}, rays {darkens:.2}",
                    executor.info().executor
                );
                println!("{place}");
                assert!(error < of_twin, "{place}");
                // Voxels do not know which way a sheet is turned: the light is almost along these.
                let most = if what == "sheets" { 2.0 } else { 1.6 };
                assert!((0.6..most).contains(&(own_darkens / darkens)), "{place}");
            }
        }
    }
}

#[test]
fn light_follows_wells_and_executors_agree() {
    let Some(gpu) = common::gpu() else {
        return;
    };
    let case = load::open(&common::sample()).unwrap();
    let view = |radius| with_tubes(view_of(&case, "preilluminated", true, &json!({})), radius);
    let gpu: Arc<dyn Executor> = Arc::new(GpuExecutor::from(gpu));
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    let mut made = [gpu, cpu].map(|executor| executor.renderer(&case.grid).unwrap());
    // The second view of a renderer has light of the wells that it shows, not of those before.
    let mut first = Vec::new();
    for radius in [0.004, 0.012] {
        let [gpu, cpu] = made.each_mut().map(|r| image(&mut **r, &view(radius)));
        let db = |a: &Image, b: &Image| {
            let [a, b] = [a, b].map(bytes);
            psnr_8bit(a.as_flattened(), b.as_flattened())
        };
        let (agree, fresh) = (db(&gpu, &cpu), {
            let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
            db(&cpu, &image(&mut *renderer, &view(radius)))
        });
        println!("{radius}: executors {agree:.1} dB, made anew {fresh:.1} dB");
        assert!(agree > 45.0 && fresh > 90.0, "{radius} {agree} {fresh}");
        first.push(cpu);
    }
    assert!(apart(&first[0], &first[1]) > 0.2);
}
