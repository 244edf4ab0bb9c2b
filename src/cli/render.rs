//! `strataray render`: one picture of a case, without a window.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context;
use serde_json::json;
use strataray::case::Case;
use strataray::gpu::{FrameRenderer, FrameStats, Gpu, GpuBytes, GpuGrid};
use strataray::picture::{self, Annotations, Image};
use strataray::scene::{self, CameraSpec, Interpolation, Scene, StepSpec, View};
use strataray::strategies::StrategyKind;
use strataray::{load, reference};

use super::Verbosity;
use super::progress::Reporter;

#[derive(clap::Args)]
#[command(after_help = "Examples:
  strataray render REEK.EGRID -o reek.png
  strataray render REEK.EGRID --property SWAT --step 2001-06-30 --camera 220,40 --size 1600x900 -o swat.png
  strataray render REEK.EGRID --scene scene.json -o picture.exr --stats stats.json")]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    /// Scene file (JSON); the options below override it.
    #[arg(long)]
    scene: Option<PathBuf>,
    /// Picture to write: .png, or .exr for linear values.
    #[arg(short, long)]
    output: PathBuf,
    /// Property, or a difference such as PRESSURE-PRESSURE@0.
    #[arg(long)]
    property: Option<String>,
    /// Time step: number from 0, date, first or last.
    #[arg(long)]
    step: Option<String>,
    /// Ray-casting strategy.
    #[arg(long)]
    strategy: Option<String>,
    /// Values within a cell.
    #[arg(long)]
    interpolation: Option<Interpolation>,
    /// Picture size, such as 1000x1000.
    #[arg(long, value_name = "WxH")]
    size: Option<String>,
    /// Occlusion: only off in this version.
    #[arg(long)]
    occlusion: Option<String>,
    /// Direction to look from, and zoom.
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION[,ZOOM]",
        allow_hyphen_values = true
    )]
    camera: Option<String>,
    /// Vertical exaggeration.
    #[arg(long)]
    exaggeration: Option<f64>,
    /// Threads of the CPU work.
    #[arg(long)]
    threads: Option<usize>,
    /// Part of the name of the GPU adapter to use.
    #[arg(long)]
    adapter: Option<String>,
    /// Write statistics (JSON).
    #[arg(long)]
    stats: Option<PathBuf>,
    /// Frames to time, after one that is not timed.
    #[arg(long, default_value_t = 1)]
    frames: usize,
    /// No legend, title or axes.
    #[arg(long)]
    plain: bool,
    /// Render with the f64 reference on the CPU instead of the GPU.
    #[arg(long)]
    reference: bool,
    #[command(flatten)]
    verbosity: Verbosity,
}

/// Wall times of the stages up to the first frame.
#[derive(Default)]
struct Stages {
    open: Duration,
    read: Duration,
    upload: Duration,
    first_frame: Duration,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let format = picture::Format::from_path(&arguments.output)?;
    if let Some(threads) = arguments.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()?;
    }
    let scene = scene_of(arguments)?;
    let mut stages = Stages::default();
    let start = Instant::now();
    let case = load::open(&arguments.case)?;
    stages.open = start.elapsed();
    for note in &case.about.notes {
        reporter.note(note);
    }
    let start = Instant::now();
    let view = scene::resolve(&scene, &case)?;
    stages.read = start.elapsed();
    let image = if arguments.reference {
        reporter
            .bar("reference", |progress| {
                reference::render(&case.grid, &view, progress)
            })
            .context("the reference was cancelled")?
    } else {
        on_gpu(arguments, &case, &view, stages, &reporter)?
    };
    match format {
        picture::Format::Exr => picture::write_exr(&arguments.output, &image)?,
        picture::Format::Png => {
            write_png(&arguments.output, &image, &case, &view, arguments.plain)?;
        }
    }
    Ok(())
}

fn on_gpu(
    arguments: &Arguments,
    case: &Case,
    view: &View,
    mut stages: Stages,
    reporter: &Reporter,
) -> anyhow::Result<Image> {
    let gpu = Gpu::new(arguments.adapter.as_deref())?;
    if gpu.is_software() {
        reporter.note(&format!(
            "no GPU is used: {} computes on the CPU",
            gpu.describe()
        ));
    }
    let start = Instant::now();
    let mut grid = GpuGrid::new(&gpu, &case.grid)?;
    grid.show(
        &gpu,
        &case.grid,
        &view.field,
        &view.drawn,
        view.interpolation,
    )?;
    let strategy = view.strategy.create(&gpu)?;
    stages.upload = start.elapsed();
    let mut renderer = FrameRenderer::default();
    let mut frame = || {
        reporter
            .bar("rendering", |progress| {
                renderer.render(&gpu, &grid, &*strategy, view, &|f| progress(f))
            })?
            .context("the picture was cancelled")
    };
    let start = Instant::now();
    let (mut image, first) = frame()?;
    stages.first_frame = start.elapsed();
    let mut timed = vec![first];
    if arguments.stats.is_some() {
        timed.clear();
        for _ in 0..arguments.frames.max(1) {
            let cpu = cpu_time();
            let (again, mut stats) = frame()?;
            stats.cpu = cpu_time().saturating_sub(cpu);
            image = again;
            timed.push(stats);
        }
    }
    timed.sort_by_key(|s| s.frame);
    let median = timed[timed.len() / 2];
    reporter.detail(&format!(
        "{}: {:.1} ms a frame on {}",
        view.strategy.name(),
        1e3 * median.frame.as_secs_f64(),
        gpu.describe()
    ));
    if let Some(path) = &arguments.stats {
        let bytes = GpuBytes {
            targets: median.target_bytes,
            ..grid.bytes()
        };
        let stats = statistics(case, view, view.strategy, &gpu, &median, bytes, &stages);
        std::fs::write(path, serde_json::to_string_pretty(&stats)?)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(image)
}

fn statistics(
    case: &Case,
    view: &View,
    strategy: StrategyKind,
    gpu: &Gpu,
    frame: &FrameStats,
    bytes: GpuBytes,
    stages: &Stages,
) -> serde_json::Value {
    let ms = |d: Duration| 1e3 * d.as_secs_f64();
    let load = case.about.load_times;
    json!({
        "strategy": strategy.name(),
        "adapter": gpu.describe(),
        "size": view.size,
        "frame_ms": ms(frame.frame),
        "frame_wall_ms": ms(frame.wall),
        "frame_cpu_ms": ms(frame.cpu),
        "longest_submission_ms": ms(frame.longest_submission),
        "submissions": frame.submissions,
        "samples": frame.samples,
        "newton_iterations": frame.newton_iterations,
        "topological_steps": frame.topological_steps,
        "grid_fallbacks": frame.grid_fallbacks,
        "peels": 0,
        "recovered_rays": 0,
        "lost_rays": 0,
        "cells": {"total": case.grid.dims().cells(), "active": case.grid.active_cells().len()},
        "gpu_bytes": bytes,
        "stages_ms": {
            "open": ms(stages.open.saturating_sub(load.model)),
            "read": ms(stages.read),
            "model": ms(load.model),
            "upload": ms(stages.upload),
            "acceleration": 0.0,
            "first_frame": ms(stages.first_frame),
        },
    })
}

fn write_png(
    path: &Path,
    image: &Image,
    case: &Case,
    view: &View,
    plain: bool,
) -> anyhow::Result<()> {
    let mut rgb = image.over_background_8bit(view.background);
    if !plain {
        let mut title = format!("{}   {}", case.about.name, view.property);
        if case.is_dynamic(&view.property)
            && let Some(step) = case.steps.get(view.step)
        {
            title += &format!("   step {}   {}", view.step, step.date);
        }
        let annotations = Annotations {
            title,
            property: view.property.clone(),
            unit: case.unit(&view.property).to_owned(),
            show_legend: view.show_legend,
            show_box: view.show_box,
        };
        picture::annotate(&mut rgb, image, view, &annotations);
    }
    Ok(picture::write_png(path, image.size, &rgb)?)
}

fn scene_of(arguments: &Arguments) -> anyhow::Result<Scene> {
    let mut scene = match &arguments.scene {
        None => Scene::default(),
        Some(path) => {
            let text = std::fs::read_to_string(path)
                .with_context(|| format!("cannot read {}", path.display()))?;
            serde_json::from_str(&text).with_context(|| format!("{}", path.display()))?
        }
    };
    if let Some(property) = &arguments.property {
        scene.property = Some(property.clone());
    }
    if let Some(step) = &arguments.step {
        scene.step = StepSpec::Name(step.clone());
    }
    if let Some(strategy) = &arguments.strategy {
        scene.strategy.clone_from(strategy);
    }
    if let Some(interpolation) = arguments.interpolation {
        scene.interpolation = interpolation;
    }
    if let Some(occlusion) = arguments.occlusion.as_deref()
        && occlusion != "off"
    {
        anyhow::bail!("--occlusion {occlusion} is not supported yet; use off");
    }
    if let Some(size) = &arguments.size {
        let parsed = size
            .split_once(['x', 'X'])
            .and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
        scene.size = parsed
            .with_context(|| format!("--size {size}: give width and height like 1000x800"))?;
    }
    if let Some(camera) = &arguments.camera {
        scene.camera = CameraSpec::Framing(framing(camera)?);
    }
    if arguments.exaggeration.is_some() {
        scene.vertical_exaggeration = arguments.exaggeration;
    }
    Ok(scene)
}

fn framing(text: &str) -> anyhow::Result<scene::FramingCamera> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([azimuth, elevation, rest @ ..]) if rest.len() < 2 => Ok(scene::FramingCamera {
            azimuth_degrees: *azimuth,
            elevation_degrees: *elevation,
            zoom: rest.first().copied().unwrap_or(1.0),
        }),
        _ => anyhow::bail!(
            "--camera {text}: give azimuth and elevation in degrees and perhaps a zoom, like 220,35,1.2"
        ),
    }
}

/// CPU time of this process so far, where the system tells (Linux), else zero.
fn cpu_time() -> Duration {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Fields 14 and 15, user and system time in ticks of 10 ms, counted behind the command's name.
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    let ticks = |n: usize| {
        fields
            .get(n)
            .and_then(|f| f.parse::<u64>().ok())
            .unwrap_or(0)
    };
    Duration::from_millis(10 * (ticks(11) + ticks(12)))
}
