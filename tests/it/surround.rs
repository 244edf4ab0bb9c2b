//! Occlusion from all sides: against many rays over the sphere, on each executor, and that turning the camera makes
//! nothing anew.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use crate::common;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::image::metrics::{Comparison, psnr_8bit};
use strataray::image::{Image, Rgb8};
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::{GpuExecutor, GpuRenderer};
use strataray::render::{Executor, Renderer};
use strataray::scene::Scene;
use strataray::scene::lighting::LightMethod;
use strataray::view::View;
use strataray::{reference, view};

/// An opaque shell, a medium, and a large even haze around something opaque.
fn opacities() -> [(&'static str, Value); 3] {
    [
        ("shell", json!([[0, 0], [0.4, 0], [0.5, 0.95], [1, 0.95]])),
        (
            "medium",
            json!([[0, 0.0], [0.3, 0.1], [0.6, 0.3], [1, 0.9]]),
        ),
        (
            "haze",
            json!([[0, 0.25], [0.75, 0.25], [0.85, 0.9], [1, 0.9]]),
        ),
    ]
}

/// A view of porosity with an opacity curve and occlusion.
fn view_of(case: &Case, size: [u32; 2], azimuth: f64, opacity: &Value, occlusion: &Value) -> View {
    let scene: Scene = serde_json::from_value(json!({
        "size": size, "property": "PORO", "transfer": {"opacity": opacity},
        "vertical_exaggeration": 8.0,
        "camera": {"azimuth_degrees": azimuth, "elevation_degrees": 30, "zoom": 1.4},
        "lighting": {"occlusion": occlusion, "volume": {"budget_mb": 4}, "rays": 64},
    }))
    .unwrap();
    view::resolve(&scene, case).unwrap()
}

fn image(renderer: &mut dyn Renderer, view: &View) -> Image {
    renderer.render(view, &|_| true).unwrap().image
}

fn picture(image: &Image) -> Rgb8 {
    Rgb8 {
        size: image.size,
        pixels: image.over_background_8bit([1.0; 3]),
    }
}

fn apart(a: &Image, b: &Image) -> Comparison {
    Comparison::of(&picture(a), &picture(b)).unwrap()
}

/// Mean of how much brighter an image is than another over the pixels that it covers, of 255.
fn brighter(image: &Image, truth: &Image) -> f64 {
    let [a, b] = [image, truth].map(|i| picture(i).pixels);
    let covered: Vec<usize> = (0..a.len())
        .filter(|n| truth.pixels[*n][3] > 0.05)
        .collect();
    let light = |p: [u8; 3]| p.iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0;
    covered
        .iter()
        .map(|n| light(a[*n]) - light(b[*n]))
        .sum::<f64>()
        / covered.len() as f64
}

#[test]
fn light_from_all_sides_is_close_to_many_rays_on_every_executor() {
    let case = load::open(&common::sample()).unwrap();
    let gpu = common::gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    let mut renderers = Vec::new();
    for executor in [cpu].into_iter().chain(gpu) {
        renderers.push(executor.renderer(&case.grid).unwrap());
    }
    // Bounds of the mean CIEDE2000 to rays, surround and shells.
    for ((name, opacity), [cones, shells]) in
        opacities()
            .iter()
            .zip([[8.0, 10.0], [3.0, 11.0], [3.0, 10.0]])
    {
        let of = |method: &str, mode: &str| {
            let occlusion = json!({"method": method, "mode": mode});
            view_of(&case, [64, 48], 205.0, opacity, &occlusion)
        };
        let truth = image(&mut *renderers[0], &of("surround", "monte_carlo"));
        let none = image(&mut *renderers[0], &of("surround", "off"));
        let without = apart(&none, &truth).ciede2000_mean;
        for (method, most) in [("surround", cones), ("spao_mipmap", shells)] {
            let view = of(method, "preilluminated");
            let images: Vec<Image> = renderers
                .iter_mut()
                .map(|r| image(&mut **r, &view))
                .collect();
            let error = apart(&images[0], &truth).ciede2000_mean;
            eprintln!("{name} {method}: {error:.2}, none {without:.2}");
            assert!(error < most, "{name} {method}: {error}");
            if method == "surround" {
                assert!(error < 0.6 * without, "{name}: {error} {without}");
            }
            if let [cpu, gpu] = images.as_slice() {
                let same = psnr_8bit(
                    picture(cpu).pixels.as_flattened(),
                    picture(gpu).pixels.as_flattened(),
                );
                assert!(same > 45.0, "{name} {method}: {same}");
            }
        }
    }
}

#[test]
fn reference_and_executors_cast_the_same_rays_to_all_sides() {
    let case = load::open(&common::sample()).unwrap();
    let [_, (_, opacity), _] = opacities();
    let of = |mode: &str| {
        let occlusion = json!({"method": "surround", "mode": mode});
        view_of(&case, [24, 18], 205.0, &opacity, &occlusion)
    };
    let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
    let rays = image(&mut *renderer, &of("monte_carlo"));
    let truth = reference::render(&case.grid, &of("monte_carlo"), &|_| true).unwrap();
    let none = image(&mut *renderer, &of("off"));
    let [same, twin] = [&rays, &none].map(|image| apart(image, &truth).ciede2000_mean);
    eprintln!("{same:.2}, without occlusion {twin:.2}");
    assert!(same < 1.5 && twin > 2.5 * same, "{same} {twin}");
}

#[test]
fn turning_the_camera_makes_no_light_from_all_sides_anew() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let [_, (_, opacity), _] = opacities();
    for method in LightMethod::ALL {
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let occlusion = json!({"method": method});
        let mut made = |azimuth| {
            let view = view_of(&case, [16, 12], azimuth, &opacity, &occlusion);
            image(&mut renderer, &view);
            renderer.light().made.light_volumes
        };
        let (first, second) = (made(205.0), made(140.0));
        assert_eq!(first, 1);
        assert_eq!(second - first, u64::from(!method.is_around()), "{method:?}");
    }
}

#[test]
fn cones_at_every_sample_look_toward_the_viewer_alone() {
    let case = load::open(&common::sample()).unwrap();
    let problem = |mode: &str| {
        let scene: Scene = serde_json::from_value(json!({
            "lighting": {"occlusion": {"method": "spao_mipmap", "mode": mode}},
        }))
        .unwrap();
        view::resolve(&scene, &case)
            .map_err(|e| e.to_string())
            .err()
    };
    let sentence = problem("image").unwrap();
    assert!(
        sentence.contains("lighting.occlusion.mode") && sentence.contains("spao_mipmap"),
        "{sentence}"
    );
    assert_eq!(problem("preilluminated"), None);
}

/// Figures for docs/methods.md.
#[test]
#[ignore = "a table"]
fn table_of_methods() {
    let mut models: Vec<PathBuf> = vec![common::sample()];
    let real = ["reek/REEK.EGRID", "brugge/BRUGGE_0000.EGRID"];
    models.extend(real.iter().filter_map(|f| common::data(f)));
    println!("| model | opacity | method | CIEDE2000 | brighter | SSIM | ms |");
    for path in models {
        let case = load::open(&path).unwrap();
        let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
        let name = case.about.name.clone();
        for (kind, opacity) in opacities() {
            let mut made = |occlusion: Value| {
                let view = view_of(&case, [80, 60], 205.0, &opacity, &occlusion);
                let start = Instant::now();
                let frame = renderer.render(&view, &|_| true).unwrap();
                let light = 1e3 * (frame.light.extinction + frame.light.volumes).as_secs_f64();
                let all = 1e3 * start.elapsed().as_secs_f64();
                (frame.image, light, all)
            };
            let rays = json!({"method": "surround", "mode": "monte_carlo"});
            let (truth, _, took) = made(rays);
            println!("| {name} | {kind} | rays | | | | {took:.0} |");
            let methods = [
                ("none", json!({"mode": "off"})),
                ("surround", json!({"method": "surround"})),
                ("spao_mipmap", json!({"method": "spao_mipmap"})),
                (
                    "by thickness",
                    json!({"method": "spao_mipmap", "per_shell": false}),
                ),
                ("cones", json!({"method": "cones"})),
            ];
            for (method, occlusion) in methods {
                let (image, ms, _) = made(occlusion);
                let figures = apart(&image, &truth);
                println!(
                    "| {name} | {kind} | {method} | {:.2} | {:+.1} | {:.3} | {ms:.0} |",
                    figures.ciede2000_mean,
                    brighter(&image, &truth),
                    figures.ssim,
                );
            }
        }
    }
}
