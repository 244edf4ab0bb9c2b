//! Pictures with directional occlusion against many rays over every cone.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

mod common;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};
use strataray::case::Case;
use strataray::gpu::Gpu;
use strataray::load;
use strataray::metrics::{Comparison, ciede2000_map};
use strataray::picture::{Image, Rgb8};
use strataray::renderer::Renderer;
use strataray::scene::{self, Scene};

const SIZE: [u32; 2] = [64, 48];
const ANGLES: [f64; 3] = [10.0, 20.0, 30.0];
/// One for all models, transfer functions and angles.
const ATTENUATION: f64 = 0.7;

/// An opaque shell, a medium, and a large even haze around something opaque, each with the mean CIEDE2000 over
/// covered pixels that cones stay within.
fn opacities() -> [(&'static str, Value, f64); 3] {
    [
        (
            "shell",
            json!([[0, 0], [0.4, 0], [0.5, 0.95], [1, 0.95]]),
            12.0,
        ),
        (
            "medium",
            json!([[0, 0.0], [0.3, 0.1], [0.6, 0.3], [1, 0.9]]),
            4.5,
        ),
        (
            "haze",
            json!([[0, 0.25], [0.75, 0.25], [0.85, 0.9], [1, 0.9]]),
            4.5,
        ),
    ]
}

/// Models with azimuth, elevation, zoom and vertical exaggeration that fill the picture.
fn models() -> Vec<(PathBuf, [f64; 4])> {
    let mut models = vec![(common::sample(), [205.0, 30.0, 1.35, 5.0])];
    let real = [
        ("reek/REEK.EGRID", [115.0, 30.0, 1.6, 10.0]),
        ("brugge/BRUGGE_0000.EGRID", [25.0, 25.0, 1.5, 15.0]),
    ];
    models.extend(
        real.iter()
            .filter_map(|(f, c)| Some((common::data(f)?, *c))),
    );
    models
}

/// A model with its pictures' scene.
struct Subject {
    name: String,
    case: Case,
    renderer: Renderer,
    camera: [f64; 4],
}

impl Subject {
    fn new(gpu: &Arc<Gpu>, path: &Path, camera: [f64; 4]) -> Self {
        let case = load::open(path).unwrap();
        Self {
            name: case.about.name.clone(),
            renderer: Renderer::new(gpu.clone(), &case.grid).unwrap(),
            case,
            camera,
        }
    }

    fn picture(&mut self, opacity: &Value, occlusion: &Value) -> Image {
        let [azimuth, elevation, zoom, exaggeration] = self.camera;
        let scene: Scene = serde_json::from_value(json!({
            "size": SIZE, "property": "PORO", "strategy": "libc",
            "vertical_exaggeration": exaggeration, "transfer": {"opacity": opacity},
            "camera": {"azimuth_degrees": azimuth, "elevation_degrees": elevation, "zoom": zoom},
            "lighting": {"occlusion": occlusion, "volume": {"budget_mb": 4}, "rays": 16},
        }))
        .unwrap();
        let view = scene::resolve(&scene, &self.case).unwrap();
        let frame = self.renderer.render(&self.case.grid, &view, &|_| true);
        frame.unwrap().unwrap().image
    }
}

fn rgb(image: &Image) -> Rgb8 {
    Rgb8 {
        size: image.size,
        pixels: image.over_background_8bit([1.0; 3]),
    }
}

/// How far a picture is from the truth: over all pixels, and CIEDE2000 over those that the model covers.
#[derive(Clone, Copy)]
struct Apart {
    all: Comparison,
    covered: f64,
}

fn apart(picture: &Image, truth: &Image) -> Apart {
    let (a, b) = (rgb(picture), rgb(truth));
    let map = ciede2000_map(&a.pixels, &b.pixels).unwrap();
    let covered: Vec<f64> = map
        .iter()
        .zip(&truth.pixels)
        .filter_map(|(d, p)| (p[3] > 0.05).then_some(*d))
        .collect();
    Apart {
        all: Comparison::of(&a, &b).unwrap(),
        covered: covered.iter().sum::<f64>() / covered.len() as f64,
    }
}

fn occlusion(mode: &str, angle: f64, splits: u32) -> Value {
    json!({"mode": mode, "half_angle_degrees": angle, "splits": splits, "attenuation": ATTENUATION})
}

/// One transfer function and angle of one model: cones of 7, 3 and 1 parts, cones from the light volume, and
/// no occlusion, each against the truth; and the light volume against cones at every sample.
struct Row {
    cones: [Apart; 3],
    none: Apart,
    volume: f64,
}

fn row(subject: &mut Subject, opacity: &Value, angle: f64) -> Row {
    let truth = subject.picture(opacity, &occlusion("monte_carlo", angle, 7));
    let mut picture = |mode, splits| subject.picture(opacity, &occlusion(mode, angle, splits));
    let [seven, three, one] = [7, 3, 1].map(|splits| picture("image", splits));
    let volume = picture("preilluminated", 7);
    let none = picture("off", 7);
    Row {
        cones: [&seven, &three, &one].map(|p| apart(p, &truth)),
        none: apart(&none, &truth),
        volume: apart(&volume, &seven).all.ciede2000_mean,
    }
}

#[test]
fn cones_are_close_to_many_rays() {
    let Some(gpu) = common::gpu() else { return };
    println!(
        "| model | opacity | angle | 7: CIEDE2000 | covered | SSIM | 3 covered | 1 covered | none covered | volume to 7 |"
    );
    let mut rows = Vec::new();
    for (path, camera) in models() {
        let mut subject = Subject::new(&gpu, &path, camera);
        for (name, opacity, most) in opacities() {
            for angle in ANGLES {
                let row = row(&mut subject, &opacity, angle);
                let [seven, three, one] = row.cones;
                println!(
                    "| {} | {name} | {angle} | {:.2} | {:.2} | {:.3} | {:.2} | {:.2} | {:.2} | {:.2} |",
                    subject.name,
                    seven.all.ciede2000_mean,
                    seven.covered,
                    seven.all.ssim,
                    three.covered,
                    one.covered,
                    row.none.covered,
                    row.volume
                );
                // Over all pixels the mean would fall with the background that the framing leaves.
                assert!(seven.covered < most, "{}", seven.covered);
                assert!(row.volume < 2.0);
                rows.push(row);
            }
        }
    }
    let mean = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
    let by_parts = [0, 1, 2].map(|n| mean(&|r| r.cones[n].covered));
    let none = mean(&|r| r.none.covered);
    println!("mean over covered pixels: 7, 3, 1 parts {by_parts:.2?}, none {none:.2}");
    // More parts are better, and the twin, no occlusion at all, is far worse.
    assert!(by_parts.is_sorted());
    assert!(none > 2.0 * by_parts[0]);
}
