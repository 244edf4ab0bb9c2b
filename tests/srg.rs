//! The strategy SRG: what its volume holds, when it is filled, and what each switch costs and gains.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;
#[allow(dead_code, reason = "only the time is of use here")]
#[path = "../src/cli/process.rs"]
mod process;

use std::sync::Arc;
use std::time::Duration;

use strataray::case::Case;
use strataray::gpu::Gpu;
use strataray::metrics::Comparison;
use strataray::picture::{Image, Rgb8};
use strataray::renderer::{Frame, Renderer};
use strataray::scene::{self, CameraSpec, FramingCamera, Interpolation, Scene, SrgSettings, View};
use strataray::strategies::StrategyKind;
use strataray::{load, reference};

/// No switch is on.
const PLAIN: SrgSettings = SrgSettings {
    budget_mb: None,
    factor: None,
    weighted: false,
    skip_empty: false,
    even: 0.0,
    thin: 0.0,
    roulette: 0.0,
};

fn scene(size: [u32; 2], azimuth: f64, elevation: f64, srg: SrgSettings) -> Scene {
    Scene {
        size,
        camera: CameraSpec::Framing(FramingCamera {
            azimuth_degrees: azimuth,
            elevation_degrees: elevation,
            zoom: 1.2,
        }),
        strategy: StrategyKind::Srg.name().into(),
        srg,
        ..Scene::default()
    }
}

fn render(renderer: &mut Renderer, case: &Case, view: &View) -> Frame {
    let frame = renderer.render(&case.grid, view, &|_| true).unwrap();
    frame.unwrap()
}

fn rgb(image: &Image, view: &View) -> Rgb8 {
    Rgb8 {
        size: image.size,
        pixels: image.over_background_8bit(view.background),
    }
}

fn compare(a: &Image, b: &Image, view: &View) -> Comparison {
    Comparison::of(&rgb(a, view), &rgb(b, view)).unwrap()
}

fn ms(d: Duration) -> f64 {
    1e3 * d.as_secs_f64()
}

/// Median wall time and mean CPU time of frames, after one to warm up.
fn times(renderer: &mut Renderer, case: &Case, view: &View, frames: u32) -> [f64; 2] {
    render(renderer, case, view);
    let cpu = process::cpu_time();
    let mut walls: Vec<f64> = (0..frames)
        .map(|_| ms(render(renderer, case, view).stats.frame))
        .collect();
    let cpu = process::cpu_time().saturating_sub(cpu);
    walls.sort_by(f64::total_cmp);
    [walls[walls.len() / 2], ms(cpu) / f64::from(frames)]
}

#[test]
#[ignore = "prints the table of docs/performance.md"]
fn table_of_factors() {
    let Some(gpu) = common::gpu() else { return };
    println!(
        "| model | factor | voxels | MB | fill ms | frame ms | PSNR dB | SSIM | CIEDE2000 mean | 99 % |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = Renderer::new(gpu.clone(), &case.grid).unwrap();
        let settings = |factor| SrgSettings {
            factor,
            budget_mb: Some(2048),
            ..SrgSettings::default()
        };
        let view = |factor| {
            scene::resolve(&scene([240, 180], 205.0, 35.0, settings(factor)), &case).unwrap()
        };
        let truth = reference::render(&case.grid, &view(None), &|_| true).unwrap();
        for factor in [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0] {
            let view = view(Some(factor));
            if (factor * factor * factor) * case.grid.dims().cells() as f64 > 40e6 {
                continue;
            }
            let cpu = process::cpu_time();
            let first = render(&mut renderer, &case, &view);
            let cpu = process::cpu_time().saturating_sub(cpu);
            let [wall, each] = times(&mut renderer, &case, &view, 5);
            let c = compare(&first.image, &truth, &view);
            println!(
                "| {} | {factor} | {:.1} | {:.1} | {:.0} ({:.0}) | {wall:.0} ({each:.0}) | {:.1} | {:.4} | {:.2} | {:.2} |",
                case.about.name,
                first.bytes.resampled as f64 / 4e6,
                first.bytes.resampled as f64 / f64::from(1 << 20),
                ms(first.prepare),
                ms(cpu),
                c.psnr_db,
                c.ssim,
                c.ciede2000_mean,
                c.ciede2000_p99
            );
        }
    }
}

type Change = fn(&mut SrgSettings);

#[test]
#[ignore = "prints the table of docs/performance.md"]
fn table_of_switches() {
    let Some(gpu) = common::gpu() else { return };
    let switches: [(&str, Change); 11] = [
        ("none", |_| ()),
        ("weighted", |s| s.weighted = true),
        ("skip_empty", |s| s.skip_empty = true),
        ("even 0.01", |s| s.even = 0.01),
        ("even 0.03", |s| s.even = 0.03),
        ("even 0.1", |s| s.even = 0.1),
        ("thin 0.005", |s| s.thin = 0.005),
        ("thin 0.02", |s| s.thin = 0.02),
        ("roulette 0.05", |s| s.roulette = 0.05),
        ("roulette 0.2", |s| s.roulette = 0.2),
        ("defaults", |s| *s = SrgSettings::default()),
    ];
    println!(
        "| model | opacity | switch | frame ms | CPU ms | million steps | PSNR dB | SSIM | CIEDE2000 mean | 99 % | to the reference |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = Renderer::new(gpu.clone(), &case.grid).unwrap();
        for (opacity, curve) in [
            ("default", None),
            ("upper half", Some(vec![[0.0, 0.0], [0.5, 0.0], [1.0, 0.7]])),
        ] {
            let view = |change: Change| {
                let mut settings = PLAIN;
                change(&mut settings);
                let mut scene = scene([400, 300], 205.0, 35.0, settings);
                scene.transfer.opacity = curve.clone();
                scene::resolve(&scene, &case).unwrap()
            };
            let truth = reference::render(&case.grid, &view(|_| ()), &|_| true).unwrap();
            let plain = render(&mut renderer, &case, &view(|_| ())).image;
            for (name, change) in switches {
                let view = view(change);
                let frame = render(&mut renderer, &case, &view);
                let [wall, cpu] = times(&mut renderer, &case, &view, 7);
                let c = compare(&frame.image, &plain, &view);
                let t = compare(&frame.image, &truth, &view);
                println!(
                    "| {} | {opacity} | {name} | {wall:.0} | {cpu:.0} | {:.2} | {:.1} | {:.4} | {:.2} | {:.2} | {:.1} {:.4} {:.2} |",
                    case.about.name,
                    frame.stats.work as f64 / 1e6,
                    c.psnr_db,
                    c.ssim,
                    c.ciede2000_mean,
                    c.ciede2000_p99,
                    t.psnr_db,
                    t.ssim,
                    t.ciede2000_mean
                );
            }
        }
    }
}
