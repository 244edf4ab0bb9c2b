//! Light and the resampled grid on the CPU: the same images as on the GPU, the reference as near, and nothing stale.

use std::cell::Cell;

use crate::common;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::reference;
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::{Executor, RenderError, Renderer};
use strataray::view::{self, View};

/// A view of the volume alone, parts of scenes laid over it.
fn viewed(case: &Case, parts: &[&Value]) -> View {
    let mut written = json!({
        "size": [96, 72], "mode": "volume", "strategy": "plts", "show": {"hull": "hidden"},
    });
    for part in parts {
        let fields = part.as_object().unwrap().clone();
        written.as_object_mut().unwrap().extend(fields);
    }
    let scene = view::look::opening(case, &written).unwrap();
    view::resolve(&scene, case).unwrap()
}

fn on_cpu(case: &Case) -> Box<dyn Renderer> {
    CpuExecutor::default().renderer(&case.grid).unwrap()
}

fn image(renderer: &mut dyn Renderer, view: &View) -> Image {
    let image = renderer.render(view, &|_| true).unwrap().image;
    assert!(image.pixels.iter().flatten().all(|v| v.is_finite()));
    image
}

/// PSNR in dB of all pixels but the few at outlines, where one executor's ray may meet a face that the other's just
/// misses; infinite where they are the same. Those that are left out are fewer than one of two hundred, or the images
/// do not agree at all.
fn agreement(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    let is_near = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).all(|c| a[c].abs_diff(b[c]) <= 8);
    let (of_a, of_b): (Vec<[u8; 3]>, Vec<[u8; 3]>) = a.iter().zip(&b).filter(is_near).unzip();
    match 200 * (a.len() - of_a.len()) <= a.len() {
        true => psnr_8bit(of_a.as_flattened(), of_b.as_flattened()),
        false => 0.0,
    }
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

/// Lighting and what is looked at by it; other lighting that must be told from it; and the least PSNR in dB.
fn lights() -> Vec<(Value, Value, Value, f64)> {
    let volume = json!({"budget_mb": 2});
    let occlusion = |mode: &str| json!({"occlusion": {"mode": mode}, "volume": volume});
    let off = json!({"volume": volume});
    let from = |light: Value, mode: &str| {
        json!({
            "lights": [light], "shadows": {"mode": mode}, "ambient": 0.2, "volume": volume,
        })
    };
    let sun = |x: f64| json!({"kind": "directional", "direction": [x, 0.4, -1.0]});
    let shiny = |x: f64| {
        let mut shiny = from(sun(x), "preilluminated");
        shiny["blinn_phong"] = json!(true);
        shiny
    };
    let exact = |mode: &str| {
        let mut exact = occlusion(mode);
        exact["exact_colors"] = json!(true);
        exact
    };
    let plain = json!({});
    let ghosts = json!({"show": {"hull": "hidden", "inactive": "ghost"}});
    let libc = json!({"strategy": "libc"});
    let segments = json!({"strategy": "libc", "libc": {"integration": "segments"}});
    let by_cell = json!({"interpolation": "cell"});
    let cells = json!({"mode": "cells", "show": {"hull": "opaque"}});
    vec![
        (
            occlusion("preilluminated"),
            plain.clone(),
            off.clone(),
            60.0,
        ),
        (occlusion("preilluminated"), libc.clone(), off.clone(), 60.0),
        (occlusion("preilluminated"), by_cell, off.clone(), 60.0),
        (occlusion("preilluminated"), cells, off.clone(), 55.0),
        (
            occlusion("preilluminated"),
            ghosts.clone(),
            off.clone(),
            55.0,
        ),
        (occlusion("image"), libc.clone(), off.clone(), 60.0),
        // Samples an f32 apart have other random numbers.
        (occlusion("monte_carlo"), plain.clone(), off, 35.0),
        (
            from(sun(0.6), "preilluminated"),
            plain.clone(),
            from(sun(-0.6), "preilluminated"),
            60.0,
        ),
        (
            from(sun(0.6), "image"),
            segments,
            from(sun(-0.6), "image"),
            60.0,
        ),
        (shiny(0.6), plain, shiny(-0.6), 55.0),
        (
            exact("preilluminated"),
            ghosts,
            occlusion("preilluminated"),
            55.0,
        ),
    ]
}

/// Lights with a place: above one side of the model, and above the other.
fn placed(case: &Case) -> Vec<(Value, Value)> {
    let view = viewed(case, &[]);
    let [low, high] = view.world.bounds;
    let [left, right] = [0.2, 0.8].map(|part| {
        let above = low + (high - low) * part;
        above
            .with_z(high.z + 0.3 * (high - low).length())
            .to_array()
    });
    let spot = |position: [f64; 3]| {
        json!({
            "kind": "spot", "position": position, "direction": [0, 0, -1], "opening_degrees": 25,
        })
    };
    let point = |position: [f64; 3]| json!({"kind": "point", "position": position});
    vec![(point(left), point(right)), (spot(left), spot(right))]
}

#[test]
fn light_is_that_of_the_gpu() {
    let Some(gpu) = common::gpu() else { return };
    let gpu = GpuExecutor::from(gpu);
    for (model, every) in common::models().iter().take(2).zip([1, 3]) {
        let case = load::open(model).unwrap();
        let mut gpu = gpu.renderer(&case.grid).unwrap();
        let mut cpu = on_cpu(&case);
        let by_place = placed(&case).into_iter().map(|(light, other)| {
            let lit = |light: Value| {
                json!({
                    "lights": [light], "shadows": {"mode": "preilluminated"},
                    "volume": {"budget_mb": 2},
                })
            };
            (lit(light), json!({}), lit(other), 60.0)
        });
        for (lighting, look, other, least) in lights().into_iter().chain(by_place).step_by(every) {
            let [view, twin] = [&lighting, &other]
                .map(|lighting| viewed(&case, &[&look, &json!({"lighting": lighting})]));
            let expected = image(&mut *gpu, &view);
            let db = agreement(&image(&mut *cpu, &view), &expected, &view);
            let twin = agreement(&image(&mut *cpu, &twin), &expected, &view);
            let place = format!("{} {lighting} {look}", case.about.name);
            println!("{db:.1} dB, twin {twin:.1} dB: {place}");
            assert!(db > least && twin < least - 5.0, "{db} {twin}: {place}");
        }
    }
}

/// Settings and looks of SRG, and the least PSNR in dB.
fn resampled() -> Vec<(Value, f64)> {
    let upper = json!({"opacity": [[0.0, 0.0], [0.5, 0.0], [1.0, 0.7]]});
    let plain = json!({"weighted": false, "skip_empty": false});
    let with = |switch: &str, value: Value| {
        let mut settings = plain.clone();
        settings[switch] = value;
        json!({"srg": settings, "transfer": upper})
    };
    let soft = json!({"occlusion": {"mode": "preilluminated"}, "volume": {"budget_mb": 2}});
    vec![
        (json!({}), 55.0),
        (json!({"interpolation": "cell"}), 55.0),
        (json!({"srg": plain}), 55.0),
        (json!({"lighting": soft}), 55.0),
        (
            json!({"show": {"hull": "hidden", "inactive": "ghost"}, "lighting": soft}),
            50.0,
        ),
        (json!({"show": {"hull": "faint", "faults": true}}), 50.0),
        (with("skip_empty", json!(true)), 55.0),
        (with("even", json!(0.01)), 50.0),
        (with("thin", json!(0.02)), 50.0),
        (with("roulette", json!(0.02)), 45.0),
    ]
}

#[test]
fn the_resampled_grid_is_that_of_the_gpu() {
    let Some(gpu) = common::gpu() else { return };
    let gpu = GpuExecutor::from(gpu);
    let srg = json!({"strategy": "srg", "lighting": {}});
    for (model, every) in common::models().iter().take(2).zip([1, 4]) {
        let case = load::open(model).unwrap();
        let mut gpu = gpu.renderer(&case.grid).unwrap();
        let mut cpu = on_cpu(&case);
        // The twin: a volume of a fourth of the voxels each way.
        let coarse = json!({"srg": {"factor": 0.5}});
        for (look, least) in resampled().into_iter().step_by(every) {
            let view = viewed(&case, &[&srg, &look]);
            let twin = viewed(&case, &[&srg, &look, &coarse]);
            let expected = image(&mut *gpu, &view);
            let db = agreement(&image(&mut *cpu, &view), &expected, &view);
            let twin = agreement(&image(&mut *cpu, &twin), &expected, &view);
            let place = format!("{} {look}", case.about.name);
            println!("{db:.1} dB, twin {twin:.1} dB: {place}");
            assert!(db > least && twin < least - 5.0, "{db} {twin}: {place}");
        }
    }
}

#[test]
fn the_resampled_grid_is_as_near_to_the_reference_as_on_the_gpu() {
    let Some(gpu) = common::gpu() else { return };
    let gpu = GpuExecutor::from(gpu);
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let view = viewed(&case, &[&json!({"strategy": "srg", "lighting": {}})]);
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        let mut gpu = gpu.renderer(&case.grid).unwrap();
        let [on_gpu, on_cpu] = [&mut gpu, &mut on_cpu(&case)]
            .map(|renderer| psnr(&image(&mut **renderer, &view), &truth, &view));
        println!("{}: {on_gpu:.1} dB, {on_cpu:.1} dB", case.about.name);
        assert!(on_cpu > on_gpu - 0.3 && on_cpu > 30.0);
    }
}

/// Occlusion, a directional light and a spot on the sample, in small volumes.
fn lit() -> Value {
    json!({
        "size": [16, 12], "property": "SWAT", "vertical_exaggeration": 8.0, "step": 0,
        "interpolation": "vertex", "filter": {}, "clip": [], "background": "#ffffff",
        "lighting": {
            "occlusion": {"strength": 0.8, "half_angle_degrees": 20},
            "lights": [
                {"kind": "directional", "direction": [1, -1, -2]},
                {"kind": "spot", "position": [4e5, 6e6, 4e3], "direction": [0.1, 0.1, -1]},
            ],
            "shadows": {"attenuation": 1.0}, "blinn_phong": true,
            "volume": {"size": [40, 30, 12], "light_size": [13, 10, 6]},
        },
    })
}

/// What changes, and where, one after the other.
fn changes() -> Vec<(&'static str, Value)> {
    let camera = json!({"azimuth_degrees": 100, "elevation_degrees": 30});
    let clip = json!([{"point": [0, 0, -15400], "normal": [0, 0, -1]}]);
    vec![
        ("/camera", camera),
        ("/lighting/lights/0/direction", json!([-1, 0.5, -1])),
        ("/lighting/lights/1/direction", json!([0.3, 0, -1])),
        ("/lighting/occlusion/strength", json!(0.5)),
        ("/lighting/occlusion/half_angle_degrees", json!(30)),
        ("/lighting/shadows/attenuation", json!(0.5)),
        ("/strategy", json!("srg")),
        ("/transfer", json!({"opacity": [[0, 0.6], [1, 0.1]]})),
        ("/range", json!([0.2, 0.7])),
        ("/vertical_exaggeration", json!(7)),
        ("/clip", clip),
        ("/filter", json!({"k": [2, 9]})),
        ("/step", json!(3)),
        ("/property", json!("SOIL")),
        ("/interpolation", json!("cell")),
        ("/show", json!({"inactive": "ghost"})),
        ("/lighting/volume/size", json!([36, 30, 12])),
        ("/lighting/volume/light_size", json!([10, 10, 6])),
        ("/srg", json!({"thin": 0.02, "factor": 2.0})),
        ("/lighting", json!({})),
        ("", lit()),
    ]
}

fn written(scene: &mut Value, place: &str, value: Value) {
    match scene.pointer_mut(place) {
        Some(field) => *field = value,
        None => scene[&place[1..]] = value,
    }
}

#[test]
fn what_is_kept_is_never_stale() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = lit();
    let mut kept = on_cpu(&case);
    let mut before = image(&mut *kept, &viewed(&case, &[&scene]));
    for (place, value) in changes() {
        written(&mut scene, place, value);
        let view = viewed(&case, &[&scene]);
        let now = image(&mut *kept, &view);
        assert!(now == image(&mut *on_cpu(&case), &view), "{place}");
        assert!(now != before, "{place}");
        before = now;
    }
}

#[test]
fn a_canceled_update_leaves_nothing_stale() {
    let case = load::open(&common::sample()).unwrap();
    for strategy in ["plts", "srg"] {
        // The same values, so that nothing but the cells tells one from the other.
        let of = |layers: [u32; 2]| {
            let filter = json!({"filter": {"k": layers}, "strategy": strategy});
            viewed(&case, &[&lit(), &filter])
        };
        let [first, second] = [of([1, 4]), of([4, 9])];
        let [was, expected] = [&first, &second].map(|view| image(&mut *on_cpu(&case), view));
        assert!(was != expected);
        let mut renderer = on_cpu(&case);
        let mut canceled = 0;
        for calls in (0u32..).step_by(7) {
            assert!(image(&mut *renderer, &first) == was, "after {calls} calls");
            let left = Cell::new(calls);
            let progress = |_| left.replace(left.get().saturating_sub(1)) > 0;
            match renderer.render(&second, &progress) {
                Ok(_) => break,
                Err(RenderError::Canceled) => canceled += 1,
                Err(error) => panic!("{error}"),
            }
            assert!(
                image(&mut *renderer, &second) == expected,
                "after {calls} calls"
            );
        }
        println!("{strategy}: canceled at {canceled} places");
        assert!(canceled > 5);
    }
}

#[test]
fn volumes_are_counted_and_freed() {
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = on_cpu(&case);
    let mut bytes = |more: Value| {
        let view = viewed(&case, &[&lit(), &more]);
        let frame = renderer.render(&view, &|_| true).unwrap();
        (frame.bytes.lighting, frame.bytes.resampled)
    };
    // Values in two bytes and the pyramid in four; three light volumes; gradients of four numbers; a byte that says
    // which voxels of light count.
    let (whole, light) = (40 * 30 * 12, 13 * 10 * 6);
    let levels = [[20, 15, 6], [10, 7, 3], [5, 3, 1], [2, 1, 1], [1, 1, 1]];
    let coarser: u64 = levels
        .iter()
        .map(|level| level.iter().product::<u64>())
        .sum();
    let expected = 2 * whole + 4 * (whole + coarser) + light * (3 * 4 + 16 + 1);
    assert_eq!(bytes(json!({})), (expected, 0));
    assert_eq!(bytes(json!({"lighting": {}})), (0, 0));
    let (_, resampled) = bytes(json!({"lighting": {}, "strategy": "srg", "srg": {"factor": 2.0}}));
    let cells = case.grid.dims().cells() as u64;
    assert!(
        resampled >= 4 * 8 * cells && resampled < 5 * 8 * cells,
        "{resampled}"
    );
    assert_eq!(bytes(json!({"lighting": {}})), (0, 0));
}
