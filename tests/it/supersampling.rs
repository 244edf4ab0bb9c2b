//! Several rays for a pixel: edges get smooth, lines keep their width, and every executor agrees.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use crate::common;
use serde_json::json;
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::{Comparison, psnr_8bit};
use strataray::image::resampling::{Kernel, reduced, resampled};
use strataray::reference;
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::{Executor, Job, Renderer};
use strataray::view::{self, View};

/// A view of the model alone with so many rays along each axis of a pixel.
fn view_of(case: &Case, mode: &str, size: [u32; 2], supersample: u32) -> View {
    let written = json!({
        "size": size, "mode": mode, "supersample": supersample, "lighting": {},
        "show": {"wells": true, "faults": true},
    });
    let scene = view::look::opening(case, &written).unwrap();
    view::resolve(&scene, case).unwrap()
}

/// One pixel for each ray.
fn rays(renderer: &mut dyn Renderer, view: &View) -> Image {
    let rays = view.of_rays();
    let job = Job::new(|progress| renderer.cast(&rays, progress));
    job.run(&|_| true).unwrap().image
}

/// Each pixel the mean of those that it covers.
fn mean(image: &Image, size: [u32; 2]) -> Image {
    let across = image.size[0] / size[0];
    let pixel = |n: u32| {
        let corner = [n % size[0], n / size[0]].map(|n| n * across);
        let mut sum = [0.0; 4];
        for ray in 0..across * across {
            let [x, y] = [corner[0] + ray % across, corner[1] + ray / across];
            let color = image.pixels[(x + y * image.size[0]) as usize];
            (0..4).for_each(|c| sum[c] += color[c] / (across * across) as f32);
        }
        sum
    };
    Image {
        size,
        blending: image.blending,
        pixels: (0..size[0] * size[1]).map(pixel).collect(),
    }
}

fn in_8_bits(image: &Image, view: &View) -> Vec<[u8; 3]> {
    image.over_background_8bit(view.style.background)
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|image| in_8_bits(image, view));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

fn executors() -> Vec<Arc<dyn Executor>> {
    let gpu = common::gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    [cpu].into_iter().chain(gpu).collect()
}

#[test]
fn more_rays_come_nearer_to_the_mean_over_a_pixel() {
    let case = load::open(&common::sample()).unwrap();
    let size = [120, 90];
    for executor in executors() {
        let mut renderer = executor.renderer(&case.grid).unwrap();
        let mut image = |n| {
            let view = view_of(&case, "cells", size, n);
            renderer.render(&view, &|_| true).unwrap().image
        };
        let [one, two, four] = [1, 2, 4].map(&mut image);
        let view = view_of(&case, "cells", size, 8);
        let truth = mean(&rays(&mut *renderer, &view), size);
        let [one, two, four] = [one, two, four].map(|image| {
            assert_eq!(image.size, size);
            psnr(&image, &truth, &view)
        });
        eprintln!("one ray {one:.1} dB, four {two:.1} dB, sixteen {four:.1} dB");
        assert!(two > one + 4.0 && four > two, "{one} {two} {four}");
    }
}

#[test]
fn lines_are_as_wide_with_more_rays() {
    let case = load::open(&common::sample()).unwrap();
    let brightness = |image: &Image, view: &View| {
        let pixels = in_8_bits(image, view);
        let sum: f64 = pixels.as_flattened().iter().map(|v| f64::from(*v)).sum();
        sum / (3 * pixels.len()) as f64
    };
    for executor in executors() {
        let mut renderer = executor.renderer(&case.grid).unwrap();
        let mut of = |supersample, lines_for| {
            let mut view = view_of(&case, "cells", [240, 180], supersample);
            let size = view.size;
            view = view.of_rays();
            view.sampling.supersample = lines_for;
            let job = Job::new(|progress| renderer.cast(&view, progress));
            brightness(&reduced(job.run(&|_| true).unwrap().image, size), &view)
        };
        let [one, three, thin] = [of(1, 1), of(3, 3), of(3, 1)];
        eprintln!("one ray {one:.2}, nine {three:.2}, nine with thin lines {thin:.2}");
        assert!((one - three).abs() < 0.4, "{one} {three}");
        assert!((one - thin).abs() > 1.0, "{one} {thin}");
    }
}

#[test]
fn executors_and_reference_agree_on_supersampled_images() {
    let case = load::open(&common::sample()).unwrap();
    for mode in ["cells", "volume"] {
        let view = view_of(&case, mode, [96, 72], 2);
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        assert_eq!(truth.size, [96, 72]);
        let plain = view_of(&case, mode, [96, 72], 1);
        let plain = reference::render(&case.grid, &plain, &|_| true).unwrap();
        for executor in executors() {
            let mut renderer = executor.renderer(&case.grid).unwrap();
            let image = renderer.render(&view, &|_| true).unwrap().image;
            let (same, twin) = (psnr(&image, &truth, &view), psnr(&plain, &truth, &view));
            eprintln!("{mode}: {same:.1} dB, one ray {twin:.1} dB");
            assert!(same > 45.0 && twin < same - 8.0, "{mode} {same} {twin}");
        }
    }
}

#[test]
fn sizes_and_numbers_of_rays_are_limited() {
    let case = load::open(&common::sample()).unwrap();
    let problem = |size: [u32; 2], supersample: u32| {
        let written = json!({"size": size, "supersample": supersample});
        let scene = view::look::opening(&case, &written).unwrap();
        view::resolve(&scene, &case)
            .map_err(|e| e.to_string())
            .err()
    };
    assert_eq!(problem([16384, 1], 1), None);
    assert_eq!(problem([2048, 2048], 8), None);
    let sentence = problem([2049, 10], 8).unwrap();
    assert!(
        sentence.contains("2048") && sentence.contains("supersample"),
        "{sentence}"
    );
    for rays in [0, 9] {
        assert!(problem([10, 10], rays).unwrap().contains("1 to 8"));
    }
}

/// Figures for docs/methods.md.
#[test]
#[ignore = "a table"]
fn table_of_kernels() {
    let size = [600, 450];
    println!("| model | mode | from | kernel | PSNR | SSIM | CIEDE2000 | ms |");
    for path in common::models() {
        let case = load::open(&path).unwrap();
        let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
        for mode in ["cells", "volume"] {
            let view = view_of(&case, mode, size, 8);
            let truth = mean(&rays(&mut *renderer, &view), size);
            let row = |from: &str, kernel: &str, image: &Image, ms: f64| {
                row(&path, [mode, from, kernel], [image, &truth], &view, ms);
            };
            for n in [1, 2, 3, 4] {
                let fine = rays(&mut *renderer, &view_of(&case, mode, size, n));
                let rays = format!("{} rays", n * n);
                let kernels = if n > 1 { 4 } else { 1 };
                for kernel in Kernel::ALL.into_iter().take(kernels) {
                    let start = Instant::now();
                    let image = resampled(&fine, size, kernel);
                    row(
                        &rays,
                        kernel.name(),
                        &image,
                        1e3 * start.elapsed().as_secs_f64(),
                    );
                }
            }
            let full = rays(&mut *renderer, &view_of(&case, mode, size, 1));
            for part in [2, 3, 4] {
                let small = view_of(&case, mode, size.map(|n| n / part), 1);
                let small = rays(&mut *renderer, &small);
                for kernel in Kernel::ALL {
                    let start = Instant::now();
                    let image = resampled(&small, size, kernel);
                    let ms = 1e3 * start.elapsed().as_secs_f64();
                    let from = format!("1/{part} each way");
                    self::row(
                        &path,
                        [mode, &from, kernel.name()],
                        [&image, &full],
                        &view,
                        ms,
                    );
                }
            }
        }
    }
}

fn row(
    path: &Path,
    [mode, from, kernel]: [&str; 3],
    [image, truth]: [&Image; 2],
    view: &View,
    ms: f64,
) {
    let name = path.file_stem().unwrap().to_string_lossy();
    let [a, b] = [image, truth].map(|image| strataray::image::Rgb8 {
        size: image.size,
        pixels: in_8_bits(image, view),
    });
    let figures = Comparison::of(&a, &b).unwrap();
    println!(
        "| {name} | {mode} | {from} | {kernel} | {:.1} | {:.4} | {:.2} | {ms:.1} |",
        figures.psnr_db, figures.ssim, figures.ciede2000_mean,
    );
}
