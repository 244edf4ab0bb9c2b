//! Pictures with directional occlusion against many rays over every cone.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common;
use crate::common::light::{lighting, render, scene};
use crate::common::shape::boxes;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::ciede2000_map;
use strataray::render::Renderer;
use strataray::render::gpu::{Gpu, GpuRenderer};
use strataray::scene::lighting::OcclusionSpec;
use strataray::scene::{CameraSpec, ColorSpec, ExplicitCamera, Projection, Scene};
use strataray::{reference, view};

/// Of the tables in the documents, and of the test, which needs no more.
const SIZE: [u32; 2] = [48, 36];
const SMALL: [u32; 2] = [32, 24];
/// Factors on the extinction, one for all models and transfer functions.
const ATTENUATIONS: [f64; 4] = [0.4, 0.7, 1.0, 1.3];
/// Where the rays of the truth start, in voxels: as in the paper, and where cones do.
const GAPS: [f64; 2] = [1.0, 3.0];

/// An opaque shell, a medium, and a large even haze around something opaque, each with the mean CIEDE2000 over
/// covered pixels within which cones at the default attenuation are.
fn opacities() -> [(&'static str, Value, f64); 3] {
    [
        (
            "shell",
            json!([[0, 0], [0.4, 0], [0.5, 0.95], [1, 0.95]]),
            8.0,
        ),
        (
            "medium",
            json!([[0, 0.0], [0.3, 0.1], [0.6, 0.3], [1, 0.9]]),
            6.0,
        ),
        (
            "haze",
            json!([[0, 0.25], [0.75, 0.25], [0.85, 0.9], [1, 0.9]]),
            6.0,
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
    renderer: GpuRenderer,
    camera: [f64; 4],
    size: [u32; 2],
}

impl Subject {
    fn new(gpu: &Arc<Gpu>, path: &Path, camera: [f64; 4], size: [u32; 2]) -> Self {
        let case = load::open(path).unwrap();
        Self {
            name: case.about.name.clone(),
            renderer: GpuRenderer::new(gpu.clone(), &case.grid).unwrap(),
            case,
            camera,
            size,
        }
    }

    fn picture(&mut self, opacity: &Value, occlusion: &Value, rays_gap: f64) -> Image {
        let [azimuth, elevation, zoom, exaggeration] = self.camera;
        let scene: Scene = serde_json::from_value(json!({
            "size": self.size, "property": "PORO", "strategy": "libc",
            "vertical_exaggeration": exaggeration, "transfer": {"opacity": opacity},
            "camera": {"azimuth_degrees": azimuth, "elevation_degrees": elevation, "zoom": zoom},
            "lighting": {
                "occlusion": occlusion, "volume": {"budget_mb": 4}, "rays": 16, "rays_gap": rays_gap,
            },
        }))
        .unwrap();
        let view = view::resolve(&scene, &self.case).unwrap();
        let frame = self.renderer.render(&view, &|_| true);
        frame.unwrap().image
    }
}

/// How far a picture is from another, over the pixels that the model covers.
#[derive(Clone, Copy)]
struct Apart {
    /// Mean CIEDE2000.
    color: f64,
    /// Mean of how much brighter it is, of 255.
    brighter: f64,
}

fn apart(picture: &Image, truth: &Image) -> Apart {
    let [a, b] = [picture, truth].map(|image| image.over_background_8bit([1.0; 3]));
    let colors = ciede2000_map(&a, &b).unwrap();
    let brightness = |p: &[u8; 3]| p.iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0;
    let covered: Vec<usize> = (0..a.len())
        .filter(|n| truth.pixels[*n][3] > 0.05)
        .collect();
    let mean = |of: &dyn Fn(usize) -> f64| {
        covered.iter().map(|n| of(*n)).sum::<f64>() / covered.len() as f64
    };
    Apart {
        color: mean(&|n| colors[n]),
        brighter: mean(&|n| brightness(&a[n]) - brightness(&b[n])),
    }
}

/// How far a picture is from the truths by rays from each of [`GAPS`].
type FromTruths = [Apart; 2];

/// What is measured: cones of 7 parts by attenuation; at the default one cones of 3 parts and of 1, and those of
/// a light volume; and no occlusion.
const WHAT: [&str; 8] = [
    "0.4",
    "0.7",
    "1.0",
    "1.3",
    "3 parts",
    "1 part",
    "light volume",
    "none",
];
const DEFAULT: usize = 2;
const THREE: usize = 4;
const ONE: usize = 5;
const NONE: usize = 7;

/// One of each.
type Row = [FromTruths; WHAT.len()];

/// Pictures of one transfer function and angle of one model, in the order of [`WHAT`], and the light volume
/// against cones at every sample.
fn measured(subject: &mut Subject, opacity: &Value, angle: f64) -> (Row, f64) {
    let usual = OcclusionSpec::default().attenuation;
    assert_eq!(usual, ATTENUATIONS[DEFAULT]);
    let mut picture = |mode: &str, splits: u32, attenuation: f64, rays_gap: f64| {
        let occlusion = json!({
            "mode": mode, "half_angle_degrees": angle, "splits": splits, "attenuation": attenuation,
        });
        subject.picture(opacity, &occlusion, rays_gap)
    };
    let truths = GAPS.map(|gap| picture("monte_carlo", 7, usual, gap));
    let mut cones = |mode, splits, attenuation| picture(mode, splits, attenuation, GAPS[0]);
    let [a, b, c, d] = ATTENUATIONS.map(|attenuation| cones("image", 7, attenuation));
    let [three, one] = [3, 1].map(|splits| cones("image", splits, usual));
    let volume = cones("preilluminated", 7, usual);
    let none = cones("off", 7, usual);
    let to_cones = apart(&volume, &c).color;
    let all = [a, b, c, d, three, one, volume, none];
    let from = |picture: &Image| [0, 1].map(|n: usize| apart(picture, &truths[n]));
    (all.each_ref().map(from), to_cones)
}

/// Measures all models and opacities at an angle, and prints all and gives means over the models by opacity.
fn table(gpu: &Arc<Gpu>, angle: f64, size: [u32; 2]) -> Vec<Row> {
    let models = models();
    let subject = |(path, camera): &(PathBuf, _)| Subject::new(gpu, path, *camera, size);
    let mut subjects: Vec<_> = models.iter().map(subject).collect();
    let mut means = Vec::new();
    for (name, opacity, most) in opacities() {
        let mut rows = Vec::new();
        for subject in &mut subjects {
            let (row, volume) = measured(subject, &opacity, angle);
            let of = format!("{} | {name}", subject.name);
            print_rows(&of, angle, &row);
            println!("| {of} | {angle} | light volume against cones | {volume:.2} | |");
            assert!(row[DEFAULT][0].color < most, "{}", row[DEFAULT][0].color);
            assert!(volume < 3.5, "{volume}");
            rows.push(row);
        }
        let mean = mean_of(&rows);
        print_rows(&format!("mean | {name}"), angle, &mean);
        means.push(mean);
    }
    print_rows("mean | all", angle, &mean_of(&means));
    means
}

fn print_rows(of: &str, angle: f64, row: &Row) {
    for (what, [near, far]) in WHAT.iter().zip(row) {
        let told = |a: &Apart| format!("{:.2} ({:+.1})", a.color, a.brighter);
        println!(
            "| {of} | {angle} | {what} | {} | {} |",
            told(near),
            told(far)
        );
    }
}

fn mean_of(rows: &[Row]) -> Row {
    let mean = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
    std::array::from_fn(|what| {
        std::array::from_fn(|truth| Apart {
            color: mean(&|r| r[what][truth].color),
            brighter: mean(&|r| r[what][truth].brighter),
        })
    })
}

/// Mean CIEDE2000 over covered pixels, and in brackets how much brighter cones are than rays, of 255.
const HEAD: &str =
    "| model | opacity | angle | cones | against rays from 1 voxel | from 3 voxels |";

#[test]
fn cones_are_close_to_many_rays() {
    let Some(gpu) = common::gpu() else { return };
    println!("{HEAD}");
    let by_opacity = table(&gpu, 20.0, SMALL);
    let mean = mean_of(&by_opacity);
    let near = |what: usize| mean[what][0].color;
    // The default attenuation is the one of those tried whose worst opacity is best.
    let worst = |what: usize| {
        by_opacity
            .iter()
            .map(|m| m[what][0].color)
            .fold(0.0, f64::max)
    };
    let mut others = (0..ATTENUATIONS.len()).filter(|n| *n != DEFAULT);
    assert!(others.all(|n| worst(n) > worst(DEFAULT)));
    // More parts are better, and the twin, no occlusion at all, is far worse.
    assert!(near(DEFAULT) < near(THREE) && near(THREE) < near(ONE));
    assert!(near(NONE) > 3.0 * near(DEFAULT));
    // Rays from 1 voxel find more in their way than those from 3.
    let is_darker = |[near, far]: &FromTruths| near.brighter > far.brighter + 5.0;
    assert!(mean.iter().all(is_darker));
}

#[test]
#[ignore = "minutes; prints the tables of docs/occlusion.md"]
fn table_of_angles() {
    let Some(gpu) = common::gpu() else { return };
    println!("{HEAD}");
    for angle in [10.0, 20.0, 30.0] {
        table(&gpu, angle, SIZE);
    }
}

/// Brightness of the middle of an even white medium that a ray crosses, where occlusion counts what lies farther
/// than `gap` before each sample.
fn brightness_of_even_medium(extinction: f64, depth: f64, gap: f64) -> f64 {
    let step = 0.01;
    let at = |n: u32| (f64::from(n) + 0.5) * step;
    let before = |s: f64| (-extinction * (s + (s - gap).max(0.0))).exp();
    let samples = (0..(depth / step).round() as u32).map(|n| before(at(n)));
    extinction * step * samples.sum::<f64>()
}

#[test]
fn rays_start_at_their_gap() {
    let Some(gpu) = common::gpu() else { return };
    let edge = [0.0, 40.0];
    let case = boxes(&edge, &edge, &edge, &|_| 0.5);
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let opacity: f64 = 0.05;
    let gaps = [0.0, 1.0, 3.0];
    let expected = gaps.map(|gap| brightness_of_even_medium(-(1.0 - opacity).ln(), 40.0, gap));
    for (n, gap) in gaps.into_iter().enumerate() {
        // The cones' own gap is none of the rays'.
        let mut scene = scene(
            &[[0.0, opacity], [1.0, opacity]],
            1.0,
            lighting(json!({
                "occlusion": {"mode": "monte_carlo", "half_angle_degrees": 1, "length": 1, "gap": 7},
                "volume": {"size": [40, 40, 40]}, "rays": 48, "rays_gap": gap,
            })),
        );
        scene.size = [3, 3];
        scene.sampling_step = Some(0.25);
        scene.early_termination = 0.0;
        scene.transfer.color = ColorSpec::Points(vec![(0.0, "#ffffff".into())]);
        scene.camera = CameraSpec::Explicit(ExplicitCamera {
            eye: [-100.0, 20.0, -20.0],
            target: [20.0, 20.0, -20.0],
            up: [0.0, 0.0, 1.0],
            fovy_degrees: 5.0,
            projection: Projection::Parallel,
        });
        let (view, frame) = render(&mut renderer, &case, &scene);
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        for (name, image) in [("device", &frame.image), ("reference", &truth)] {
            let found = f64::from(image.pixels[4][1]);
            let apart = expected.map(|e| (found - e).abs());
            println!("{name}, rays from {gap}: {found:.4}, off by {apart:.4?}");
            assert!(apart[n] < 3e-3, "{found}");
            // The twins: other gaps.
            assert!(
                (0..3).all(|other| other == n || apart[other] > 0.02),
                "{apart:?}"
            );
        }
    }
}
