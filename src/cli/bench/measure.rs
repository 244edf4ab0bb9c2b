//! The figures of one case.

use std::cell::Cell;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Context;
use serde::Serialize;
use strataray::render::{DeviceBytes, Executor, Frame, LightTimes, Renderer};
use strataray::scene::Scene;
use strataray::view::{self, Shown, View};

use crate::cli::process::{cpu_time, forget_peak, peak_memory};
use crate::cli::progress::Reporter;
use crate::cli::scene_options::open_case;

/// What a case costs up to the first frame, and each strategy's frames.
#[derive(Serialize)]
pub struct CaseTimes {
    pub case: String,
    pub dims: [usize; 3],
    pub active: usize,
    pub property: String,
    /// Reading the files, without building the model.
    pub open_ms: f64,
    pub model_ms: f64,
    /// Finding all fault faces.
    pub topology_ms: f64,
    /// Reading the values of the property alone.
    pub property_ms: f64,
    /// Resolving the scene, which reads the property too.
    pub read_ms: f64,
    pub upload_ms: f64,
    pub acceleration_ms: f64,
    /// For the light, where the scene has some: values by point location, extinction pyramid, and light
    /// volumes, which the camera's motion makes anew.
    pub light_field_ms: f64,
    pub light_extinction_ms: f64,
    pub light_volumes_ms: f64,
    /// Most memory of the process; with `peak_of_all` over all cases so far.
    pub peak_memory_bytes: Option<u64>,
    pub peak_of_all: bool,
    pub strategies: Vec<StrategyTimes>,
}

/// What a strategy costs. Times without `first` and `prepare` are of the median frame.
#[derive(Serialize)]
pub struct StrategyTimes {
    pub strategy: &'static str,
    /// Wall time of the first frame with all that it compiles and prepares.
    pub first_frame_ms: f64,
    /// Of it, what the strategy makes beside the grid.
    pub prepare_ms: f64,
    /// Longest time of the first frame in which it told no progress, once it had begun to: how long the device
    /// works without a break, and a user waits to cancel.
    pub longest_wait_ms: f64,
    /// The rays by the adapter's clock, where it has one.
    pub frame_ms: f64,
    pub frame_wall_ms: f64,
    pub frame_cpu_ms: f64,
    pub longest_submission_ms: f64,
    pub samples: u64,
    pub samples_per_second: f64,
    pub newton_iterations_per_sample: f64,
    pub recovered_rays: u64,
    pub lost_rays: u64,
    pub covered_pixels: u64,
    pub entries: u64,
    pub point_locations: u64,
    pub cell_crossings: u64,
    pub lost_samples: u64,
    pub gpu_bytes: DeviceBytes,
}

/// Opens a case and renders it by each of the scenes.
pub fn case(
    path: &Path,
    scenes: &[Scene],
    executor: &dyn Executor,
    frames: u32,
    reporter: &Reporter,
) -> anyhow::Result<CaseTimes> {
    let peak_of_all = !forget_peak();
    let (case, open) = timed(|| open_case(path, reporter));
    let case = case?;
    let model = case.about.load_times.model;
    let (_, topology) = timed(|| case.grid.fault_faces());
    let first = scenes.first().context("there is no strategy to time")?;
    let (view, read) = timed(|| view::resolve(first, &case));
    let Shown { property, step, .. } = view?.shown;
    let (field, property_time) = timed(|| case.field(&property, step));
    field?;
    let mut renderer = executor.renderer(&case.grid)?;
    let setup = renderer.setup_times();
    let mut strategies = Vec::new();
    let mut light = None;
    for scene in scenes {
        let view = view::resolve(scene, &case)?;
        let times = strategy(&mut *renderer, &view, frames, reporter);
        let what = || format!("{} by {}", case.about.name, view.sampling.strategy.name());
        let (times, light_times) = times.with_context(what)?;
        strategies.push(times);
        // The strategies after the first one find it made.
        light.get_or_insert(light_times);
    }
    let light = light.unwrap_or_default();
    let dims = case.grid.dims();
    Ok(CaseTimes {
        case: case.about.name.clone(),
        dims: [dims.ni, dims.nj, dims.nk],
        active: case.grid.active_cells().len(),
        property,
        open_ms: ms(open.saturating_sub(model)),
        model_ms: ms(model),
        topology_ms: ms(topology),
        property_ms: ms(property_time),
        read_ms: ms(read),
        upload_ms: ms(setup.upload),
        acceleration_ms: ms(setup.acceleration),
        light_field_ms: ms(light.field),
        light_extinction_ms: ms(light.extinction),
        light_volumes_ms: ms(light.volumes),
        peak_memory_bytes: peak_memory(),
        peak_of_all,
        strategies,
    })
}

fn strategy(
    renderer: &mut dyn Renderer,
    view: &View,
    frames: u32,
    reporter: &Reporter,
) -> anyhow::Result<(StrategyTimes, LightTimes)> {
    let (last, longest_wait) = (Cell::new(None::<Instant>), Cell::new(Duration::ZERO));
    let mut render = || -> anyhow::Result<Frame> {
        let cpu = cpu_time();
        last.set(None);
        let frame = reporter.bar("rendering", |progress| {
            let told = |fraction| {
                let now = Instant::now();
                let wait = last.replace(Some(now)).map_or(Duration::ZERO, |l| now - l);
                longest_wait.set(longest_wait.get().max(wait));
                progress(fraction)
            };
            renderer.render(view, &told)
        });
        let mut frame = frame.context("there is no image to time")?;
        frame.stats.cpu = cpu_time().saturating_sub(cpu);
        Ok(frame)
    };
    let (warm_up, first_frame) = timed(&mut render);
    let warm_up = warm_up?;
    let longest_wait_ms = ms(longest_wait.get());
    let mut times = Vec::new();
    for _ in 0..frames {
        times.push(render()?);
    }
    let median = Frame::median(times).context("no frame was timed")?;
    let stats = &median.stats;
    let samples = stats.samples as f64;
    let times = StrategyTimes {
        strategy: view.sampling.strategy.name(),
        first_frame_ms: ms(first_frame),
        prepare_ms: ms(warm_up.prepare),
        longest_wait_ms,
        frame_ms: ms(stats.frame),
        frame_wall_ms: ms(stats.wall),
        frame_cpu_ms: ms(stats.cpu),
        longest_submission_ms: ms(stats.longest_submission),
        samples: stats.samples,
        samples_per_second: samples / stats.frame.as_secs_f64(),
        newton_iterations_per_sample: stats.newton_iterations as f64 / samples.max(1.0),
        recovered_rays: stats.recovered_rays,
        lost_rays: stats.lost_rays,
        covered_pixels: stats.covered_pixels,
        entries: stats.entries,
        point_locations: stats.point_locations,
        cell_crossings: stats.cell_crossings,
        lost_samples: stats.lost_samples,
        gpu_bytes: median.bytes,
    };
    Ok((times, warm_up.light))
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed())
}

/// Milliseconds, to the microsecond.
fn ms(duration: Duration) -> f64 {
    duration.as_micros() as f64 / 1e3
}
