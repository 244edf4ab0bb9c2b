//! `strataray render`: one picture of a case, without a window.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context;
use serde_json::json;
use strataray::case::Case;
use strataray::image::Image;
use strataray::picture::{self, Shot};
use strataray::reference;
use strataray::render::{Executor, ExecutorInfo, Frame, LightTimes, RenderError, SetupTimes};

use super::Verbosity;
use super::process::cpu_time;
use super::progress::Reporter;
use super::scene_options::SceneOptions;

#[derive(clap::Args)]
#[command(after_help = "Examples:
  strataray render REEK.EGRID -o reek.png
  strataray render REEK.EGRID --property SWAT --step 2001-06-30 --camera 220,40 --size 1600x900 -o swat.png
  strataray render REEK.EGRID --scene scene.json -o picture.exr --stats stats.json
  strataray render REEK.EGRID --minus other/REEK.EGRID --property PRESSURE --step 2001-06-30 -o difference.png
  strataray render real-0/REEK --ensemble real-1/REEK real-2/REEK --property SWAT.STD -o spread.png")]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    #[command(flatten)]
    options: SceneOptions,
    /// Image to write: .png, or .exr for linear values.
    #[arg(short, long)]
    output: PathBuf,
    /// Write statistics (JSON).
    #[arg(long)]
    stats: Option<PathBuf>,
    /// Frames to time, after one that is not timed.
    #[arg(long, default_value_t = 1)]
    frames: usize,
    /// The model alone: no title, legend, info line or axes.
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
    setup: SetupTimes,
    first_frame: Duration,
    light: LightTimes,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let format = picture::Format::from_path(&arguments.output)?;
    arguments.options.set_threads()?;
    let mut stages = Stages::default();
    let start = Instant::now();
    let case = arguments.options.open_case(&arguments.case, &reporter)?;
    stages.open = start.elapsed();
    let start = Instant::now();
    let (scene, case) = arguments.options.scene_in_space(case, &reporter)?;
    let plain = arguments.plain || format == picture::Format::Exr;
    let shot = Shot::of(&scene, &case, plain)?;
    stages.read = start.elapsed();
    let image = if arguments.reference {
        reporter
            .bar("reference", |progress| {
                reference::render(&case.grid, &shot.view, progress)
            })
            .context("the reference was canceled")?
    } else {
        let executor = arguments.options.open_executor(&reporter)?;
        executed(arguments, &case, &shot, &*executor, stages, &reporter)?
    };
    match format {
        picture::Format::Exr => picture::write_exr(&arguments.output, &image)?,
        picture::Format::Png => {
            let picture = shot.finished(&image, &case);
            picture::write_png(&arguments.output, picture.size, &picture.pixels)?;
        }
    }
    Ok(())
}

fn executed(
    arguments: &Arguments,
    case: &Case,
    shot: &Shot,
    executor: &dyn Executor,
    mut stages: Stages,
    reporter: &Reporter,
) -> anyhow::Result<Image> {
    let view = &shot.view;
    let mut renderer = executor.renderer(&case.grid)?;
    stages.setup = renderer.setup_times();
    let info = executor.info();
    let mut frame = || {
        let made = reporter.bar("rendering", |progress| renderer.render(view, progress));
        match made {
            Err(RenderError::Canceled) => anyhow::bail!("the image was canceled"),
            made => Ok(made?),
        }
    };
    let start = Instant::now();
    let first = frame()?;
    stages.first_frame = start.elapsed();
    stages.light = first.light;
    reporter.detail(&format!(
        "{}: {:.1} ms for the rays, {:.1} ms to prepare, on {}",
        view.sampling.strategy.name(),
        1e3 * first.stats.frame.as_secs_f64(),
        1e3 * first.prepare.as_secs_f64(),
        info.adapter
    ));
    let Some(path) = &arguments.stats else {
        return Ok(first.image);
    };
    let prepare = first.prepare;
    let mut timed = Vec::new();
    for _ in 0..arguments.frames.max(1) {
        let cpu = cpu_time();
        let mut again = frame()?;
        again.stats.cpu = cpu_time().saturating_sub(cpu);
        again.prepare = prepare;
        timed.push(again);
    }
    let median = Frame::median(timed).context("no frame was timed")?;
    let stats = statistics(case, shot, &info, &median, &stages);
    write_json(path, &stats)?;
    Ok(median.image)
}

fn write_json(path: &Path, value: &serde_json::Value) -> anyhow::Result<()> {
    std::fs::write(path, serde_json::to_string_pretty(value)?)
        .with_context(|| format!("cannot write {}", path.display()))
}

fn statistics(
    case: &Case,
    shot: &Shot,
    info: &ExecutorInfo,
    frame: &Frame,
    stages: &Stages,
) -> serde_json::Value {
    let ms = |d: Duration| 1e3 * d.as_secs_f64();
    let load = case.about.load_times;
    let stats = &frame.stats;
    json!({
        "strategy": shot.view.sampling.strategy.name(),
        "executor": info.executor,
        "adapter": info.adapter,
        "budget_mb": {"extinction": shot.view.style.lighting.budget_mb(), "srg": shot.view.sampling.srg.budget_bytes() >> 20},
        "size": shot.layout.size.to_array().map(|n| n as u32),
        "volume_size": shot.view.size,
        "frame_ms": ms(stats.frame),
        "frame_wall_ms": ms(stats.wall),
        "frame_cpu_ms": ms(stats.cpu),
        "prepare_ms": ms(frame.prepare),
        "longest_submission_ms": ms(stats.longest_submission),
        "submissions": stats.submissions,
        "samples": stats.samples,
        "volume_samples": stats.cube_samples,
        "newton_iterations": stats.newton_iterations,
        "topological_steps": stats.topological_steps,
        "grid_fallbacks": stats.grid_fallbacks,
        "peels": stats.peels,
        "recovered_rays": stats.recovered_rays,
        "lost_rays": stats.lost_rays,
        "covered_pixels": stats.covered_pixels,
        "entries": stats.entries,
        "point_locations": stats.point_locations,
        "cell_crossings": stats.cell_crossings,
        "lost_samples": stats.lost_samples,
        "cells": {"total": cells(case), "active": case.grid.active_cells().len()},
        "gpu_bytes": frame.bytes,
        "storage_error": frame.storage_error,
        "stages_ms": {
            "open": ms(stages.open.saturating_sub(load.model)),
            "read": ms(stages.read),
            "model": ms(load.model),
            "upload": ms(stages.setup.upload),
            "acceleration": ms(stages.setup.acceleration),
            "light_field": ms(stages.light.field),
            "light_extinction": ms(stages.light.extinction),
            "light_volumes": ms(stages.light.volumes),
            "first_frame": ms(stages.first_frame),
        },
    })
}

/// Cells of all grids.
fn cells(case: &Case) -> usize {
    let patches = case.grid.patches().iter();
    patches.map(|patch| patch.file_dims().cells()).sum()
}
