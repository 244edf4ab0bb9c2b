//! The figures of one case.

use std::cell::Cell;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Context;
use serde::Serialize;
use strataray::case::Case;
use strataray::render::{DeviceBytes, Executor, ExecutorInfo, Frame, LightTimes, Renderer};
use strataray::view::{self, Shown, View};

use super::{Failure, Run};
use crate::cli::process::{cpu_time, forget_peak, peak_memory};
use crate::cli::progress::Reporter;
use crate::cli::scene_options::{in_space, open_case};

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
    /// Kind of executor, and its adapter.
    pub executor: &'static str,
    pub adapter: String,
    /// Preset of light; empty where the scene's own is timed.
    pub lighting: String,
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
    /// Shortest and longest wall time of the timed frames, and CPU time.
    pub wall_range_ms: [f64; 2],
    pub cpu_range_ms: [f64; 2],
    pub longest_submission_ms: f64,
    pub samples: u64,
    pub samples_per_second: f64,
    pub newton_iterations_per_sample: f64,
    pub newton_iterations: u64,
    pub recovered_rays: u64,
    pub lost_rays: u64,
    pub covered_pixels: u64,
    pub entries: u64,
    pub point_locations: u64,
    pub cell_crossings: u64,
    /// Of geometry and values, at least.
    pub bytes_read: u64,
    pub lost_samples: u64,
    pub gpu_bytes: DeviceBytes,
}

/// What is timed, and how.
pub struct Timer<'a> {
    pub runs: &'a [Run],
    pub executors: &'a [Arc<dyn Executor>],
    pub frames: u32,
    pub reporter: &'a Reporter,
}

impl Timer<'_> {
    /// Opens a case and renders each run by each executor; what fails is in the second part, and the rest goes on.
    pub fn case(&self, path: &Path) -> anyhow::Result<(CaseTimes, Vec<Failure>)> {
        let peak_of_all = !forget_peak();
        let (case, open) = timed(|| open_case(path, self.reporter));
        let case = case?;
        let model = case.about.load_times.model;
        let (_, topology) = timed(|| case.grid.fault_faces());
        let first = &self.runs.first().context("there is nothing to time")?.scene;
        let case = in_space(case, first, self.reporter);
        let (view, read) = timed(|| view::resolve(first, &case));
        let Shown { property, step, .. } = view?.shown;
        let (field, property_time) = timed(|| case.field(&property, step));
        field?;
        let mut strategies = Vec::new();
        let mut failures = Vec::new();
        let (mut setup, mut light) = (None, LightTimes::default());
        for executor in self.executors {
            let mut renderer = executor.renderer(&case.grid)?;
            setup.get_or_insert(renderer.setup_times());
            for run in self.runs {
                match self.run(&case, run, &**executor, &mut *renderer) {
                    Ok((times, light_times)) => {
                        strategies.push(times);
                        // The runs after the first lit one find it made.
                        if light.field.is_zero() {
                            light = light_times;
                        }
                    }
                    Err(error) => failures.push(Failure {
                        case: case.about.name.clone(),
                        what: run.words(&executor.info()),
                        error: format!("{error:#}"),
                    }),
                }
            }
        }
        let setup = setup.unwrap_or_default();
        let dims = case.grid.main_dims();
        let times = CaseTimes {
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
        };
        Ok((times, failures))
    }

    fn run(
        &self,
        case: &Case,
        run: &Run,
        executor: &dyn Executor,
        renderer: &mut dyn Renderer,
    ) -> anyhow::Result<(StrategyTimes, LightTimes)> {
        let view = view::resolve(&run.scene, case)?;
        let (mut times, light) = strategy(renderer, &view, self.frames, self.reporter)?;
        let info = executor.info();
        times.executor = info.executor;
        times.adapter = info.adapter;
        times.lighting.clone_from(&run.lighting);
        Ok((times, light))
    }
}

impl Run {
    /// What it times, by an executor.
    fn words(&self, executor: &ExecutorInfo) -> String {
        let strategy = self.scene.strategy.name();
        match self.lighting.as_str() {
            "" => format!("{strategy} on {}", executor.adapter),
            lighting => format!("{strategy} with light {lighting} on {}", executor.adapter),
        }
    }
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
    let wall_range_ms = range(times.iter().map(|f| f.stats.wall));
    let cpu_range_ms = range(times.iter().map(|f| f.stats.cpu));
    let median = Frame::median(times).context("no frame was timed")?;
    let stats = &median.stats;
    let samples = stats.samples as f64;
    let times = StrategyTimes {
        strategy: view.sampling.strategy.name(),
        executor: "",
        adapter: String::new(),
        lighting: String::new(),
        first_frame_ms: ms(first_frame),
        prepare_ms: ms(warm_up.prepare),
        longest_wait_ms,
        frame_ms: ms(stats.frame),
        frame_wall_ms: ms(stats.wall),
        frame_cpu_ms: ms(stats.cpu),
        wall_range_ms,
        cpu_range_ms,
        longest_submission_ms: ms(stats.longest_submission),
        samples: stats.samples,
        samples_per_second: samples / stats.frame.as_secs_f64(),
        newton_iterations: stats.newton_iterations,
        newton_iterations_per_sample: stats.newton_iterations as f64 / samples.max(1.0),
        recovered_rays: stats.recovered_rays,
        lost_rays: stats.lost_rays,
        covered_pixels: stats.covered_pixels,
        entries: stats.entries,
        point_locations: stats.point_locations,
        cell_crossings: stats.cell_crossings,
        bytes_read: stats.bytes_read(view),
        lost_samples: stats.lost_samples,
        gpu_bytes: median.bytes,
    };
    Ok((times, warm_up.light))
}

/// The shortest and the longest of some times.
fn range(times: impl Iterator<Item = Duration> + Clone) -> [f64; 2] {
    [times.clone().min(), times.max()].map(|time| ms(time.unwrap_or_default()))
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
