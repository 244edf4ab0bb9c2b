//! What the first picture of a case shows: the picture that opens without a scene, in the window and from the
//! command line alike.

use crate::common::{data, gpu, sample};
use serde_json::json;
use strataray::case::{Case, load};
use strataray::image::metrics::ciede2000_map;
use strataray::model::derived::Derived;
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::Scene;
use strataray::view::{self, View, look};

const FIELDS: [&str; 3] = [
    "reek/REEK.EGRID",
    "brugge/BRUGGE_0000.EGRID",
    "spe9/SPE9_CP.EGRID",
];

fn opened(case: &Case, written: &serde_json::Value) -> (Scene, View) {
    let scene = look::opening(case, written).unwrap();
    let view = view::resolve(&scene, case).unwrap();
    (scene, view)
}

/// The part of the oil's pore volume in cells whose opacity, alone on a ray through their own thickness, is 0.1
/// or more.
fn oil_that_shows(case: &Case, view: &View) -> f64 {
    let weights = case.weights();
    let thickness = Derived::Thickness.field(&case.grid);
    let (mut shown, mut all) = (0.0, 0.0);
    let cells = view
        .shown
        .cells
        .field
        .values()
        .iter()
        .zip(weights.values.iter());
    for ((soil, volume), thickness) in cells.zip(thickness.values()) {
        let oil = f64::from(*soil).max(0.0) * f64::from(*volume);
        let extinction = view
            .style
            .transfer
            .extinction(view.style.transfer.position(f64::from(*soil)));
        let crossed = view.world.vertical_exaggeration * f64::from(*thickness);
        let opacity = 1.0 - (-extinction * crossed).exp();
        all += oil;
        shown += if opacity >= 0.1 { oil } else { 0.0 };
    }
    shown / all
}

#[test]
fn the_oil_shows() {
    let mut cases = vec![load::open(&sample()).unwrap()];
    cases.extend(
        FIELDS
            .iter()
            .filter_map(|f| data(f))
            .map(|p| load::open(&p).unwrap()),
    );
    let mut hidden = 0;
    for case in &cases {
        let (scene, view) = opened(case, &json!({"property": "SOIL", "mode": "volume"}));
        let share = oil_that_shows(case, &view);
        eprintln!(
            "{}: {:.1} % of the oil shows",
            case.about.name,
            100.0 * share
        );
        assert!(share >= 0.95, "{}: {share}", case.about.name);
        // The plain ramp over the mean cell edge hides it.
        let ramp = Scene {
            transfer: Scene::default().transfer,
            ..scene
        };
        let view = view::resolve(&ramp, case).unwrap();
        hidden += usize::from(oil_that_shows(case, &view) < 0.95);
    }
    assert_eq!(hidden, cases.len());
}

/// Pixels that a model covers from side to side: those of its opaque cells, less a rim of one pixel.
fn silhouette(renderer: &mut GpuRenderer, case: &Case, written: &serde_json::Value) -> Vec<bool> {
    let mut cells = written.clone();
    cells["mode"] = "cells".into();
    let (_, view) = opened(case, &cells);
    let image = renderer.render(&view, &|_| true).unwrap().image;
    let [width, height] = view.size.map(|n| n as usize);
    let covered = |x: usize, y: usize| image.pixels[y * width + x][3] > 0.99;
    let inside = |n: usize| {
        let (x, y) = (n % width, n / width);
        let is_rim = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        !is_rim && (y - 1..=y + 1).all(|y| (x - 1..=x + 1).all(|x| covered(x, y)))
    };
    (0..width * height).map(inside).collect()
}

#[test]
fn nothing_inside_the_outline_is_taken_for_the_background() {
    let Some(gpu) = gpu() else { return };
    let mut paths = vec![sample()];
    paths.extend(FIELDS.iter().filter_map(|f| data(f)));
    let mut without = 0;
    for path in paths {
        let case = load::open(&path).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let written = json!({"size": [240, 170]});
        let is_inside = silhouette(&mut renderer, &case, &written);
        let mut volume = written.clone();
        volume["mode"] = "volume".into();
        let confused = |renderer: &mut GpuRenderer, view: &View| {
            let image = renderer.render(view, &|_| true).unwrap().image;
            let rgb = image.over_background_8bit(view.style.background);
            let ground = view.style.background.map(|v| (255.0 * v).round() as u8);
            let apart = ciede2000_map(&rgb, &vec![ground; rgb.len()]).unwrap();
            let inside = apart.iter().zip(&is_inside).filter(|p| *p.1);
            inside.filter(|p| *p.0 < 10.0).count()
        };
        let (_, view) = opened(&case, &volume);
        let inside = is_inside.iter().filter(|i| **i).count();
        let found = confused(&mut renderer, &view);
        eprintln!("{}: {found} of {inside} pixels", case.about.name);
        assert!(inside > 1000);
        assert_eq!(found, 0, "{}", case.about.name);
        // Without the faint hull there are some.
        volume["show"] = json!({"hull": "hidden"});
        let (_, bare) = opened(&case, &volume);
        without += confused(&mut renderer, &bare);
    }
    assert!(without > 0);
}

#[test]
fn sections_and_constant_properties_show_in_every_strategy() {
    let Some(gpu) = gpu() else { return };
    for file in ["reported/F01_SLICE.EGRID", "reported/F02_CONST.EGRID"] {
        let Some(path) = data(file) else { return };
        let case = load::open(&path).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        for mode in ["cells", "volume"] {
            for strategy in ["plts", "libc", "srg"] {
                let written = json!({"size": [240, 170], "mode": mode, "strategy": strategy});
                let (_, view) = opened(&case, &written);
                let image = renderer.render(&view, &|_| true).unwrap().image;
                let rgb = image.over_background_8bit(view.style.background);
                let ground = view.style.background.map(|v| (255.0 * v).round() as i32);
                let differs =
                    |p: &[u8; 3]| (0..3).any(|c| (i32::from(p[c]) - ground[c]).abs() >= 60);
                let covered = image.pixels.iter().filter(|p| p[3] > 0.02).count();
                let plain = rgb.iter().filter(|p| differs(p)).count();
                let place = format!("{file}, {mode}, {strategy}: {plain} of {covered}");
                assert!(covered > 500 && 2 * plain > covered, "{place}");
            }
        }
    }
}

#[test]
fn a_case_opens_in_the_mode_that_shows_it() {
    let mode = |path: &std::path::Path, written| {
        let case = load::open(path).unwrap();
        opened(&case, &written).0.mode
    };
    use strataray::scene::Mode;
    assert_eq!(mode(&sample(), json!({})), Mode::Volume);
    assert_eq!(mode(&sample(), json!({"property": "FIPNUM"})), Mode::Cells);
    assert_eq!(mode(&sample(), json!({"mode": "cells"})), Mode::Cells);
    for (file, opens) in [
        ("reek/REEK.EGRID", Mode::Volume),
        ("brugge/BRUGGE_0000.EGRID", Mode::Volume),
        ("spe1/SPE1CASE1.EGRID", Mode::Cells),
        ("grdecl/dome.grdecl", Mode::Cells),
        ("reported/F01_SLICE.EGRID", Mode::Cells),
        ("reported/F02_CONST.EGRID", Mode::Cells),
    ] {
        if let Some(path) = data(file) {
            assert_eq!(mode(&path, json!({})), opens, "{file}");
        }
    }
}

/// How far pictures with occlusion are from those without, where the volume covers most of a pixel.
#[test]
fn occlusion_is_seen() {
    let Some(gpu) = gpu() else { return };
    let mut paths = vec![sample()];
    let more = ["spe1/SPE1CASE1.EGRID", "editnnc/9_EDITNNC.EGRID"];
    paths.extend(FIELDS.iter().chain(&more).filter_map(|f| data(f)));
    for path in paths {
        let case = load::open(&path).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let mut picture = |light: &str| {
            let written = json!({
                "size": [240, 170], "mode": "volume", "show": {"hull": "hidden"},
                "lighting": strataray::scene::LightingSpec::preset(light).unwrap(),
            });
            let (_, view) = opened(&case, &written);
            let frame = renderer.render(&view, &|_| true);
            let image = frame.unwrap().image;
            let rgb = image.over_background_8bit(view.style.background);
            (rgb, image.pixels)
        };
        let (off, pixels) = picture("off");
        let mut apart = |light: &str| {
            let all = ciede2000_map(&off, &picture(light).0).unwrap();
            let covered = all.iter().zip(&pixels).filter(|(_, p)| p[3] > 0.5);
            let covered: Vec<f64> = covered.map(|(d, _)| *d).collect();
            covered.iter().sum::<f64>() / covered.len() as f64
        };
        let [none, soft, strong] = ["off", "soft", "strong"].map(&mut apart);
        eprintln!("{}: soft {soft:.2}, strong {strong:.2}", case.about.name);
        assert_eq!(none, 0.0);
        assert!(soft >= 3.0 && strong > 1.3 * soft, "{soft} {strong}");
    }
}
