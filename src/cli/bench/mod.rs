//! `strataray bench`: load times, frame times and memory on this machine.

mod against;
mod measure;
mod table;
mod turning;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use serde::Serialize;
use strataray::export::synthetic;
use strataray::model::synthetic::Recipe;
use strataray::render::{Executor, ExecutorInfo};
use strataray::scene::{Scene, StrategyKind};

use super::Verbosity;
use super::progress::Reporter;
use super::scene_options::{SceneOptions, lighting_preset, open_executor};
use measure::CaseTimes;
use turning::Turning;

/// Cases where none is named.
const DEFAULT: [&str; 3] = ["r1", "r2", "r3"];
/// Picture sizes where none is given: with a GPU, and with software that plays one.
const GPU_SIZE: [u32; 2] = [1000, 1000];
const SOFTWARE_SIZE: [u32; 2] = [500, 500];

#[derive(clap::Args)]
#[command(
    after_help = "Each case is opened, and rendered by each adapter, strategy and lighting: one frame to warm up, then the
timed ones. Times are in milliseconds; files are timed as the system's cache holds them. What fails is told at the
end, after all else.
Examples:
  strataray bench
  strataray bench R4 REEK.EGRID --frames 5 --json bench.json
  strataray bench REEK.EGRID --adapters cpu,llvmpipe --lightings off,soft
  strataray bench REEK.EGRID --against bench.json
  strataray bench BRUGGE.EGRID --turn 30
  strataray bench R5 --size 1000x1000 --property SWAT --strategy plts"
)]
pub struct Arguments {
    /// Cases by path, or synthetic models by name (r1 to r6, faulted, box); r1 to r3 by default.
    cases: Vec<PathBuf>,
    #[command(flatten)]
    options: SceneOptions,
    /// Frames to time, after one that is not timed.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Also turn each model by N moves of the pointer, as in the window, and time the drafts.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    turn: Option<u32>,
    /// Adapters to time in turn by parts of their names, such as cpu,llvmpipe; by default the one that `render` takes.
    #[arg(
        long,
        value_name = "NAME",
        value_delimiter = ',',
        conflicts_with = "adapter"
    )]
    adapters: Vec<String>,
    /// Presets of light to time in turn, such as off,soft; by default what the scene has.
    #[arg(long, value_name = "NAME", value_delimiter = ',', conflicts_with_all = ["lighting", "occlusion"])]
    lightings: Vec<String>,
    /// Write the figures (JSON).
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Figures of an earlier run (JSON): each is told as a ratio of the new one to the old one.
    #[arg(long, value_name = "JSON")]
    against: Option<PathBuf>,
    #[command(flatten)]
    verbosity: Verbosity,
}

/// All figures of a run.
#[derive(Serialize)]
struct Bench {
    version: &'static str,
    adapter: String,
    threads: usize,
    size: [u32; 2],
    frames: u32,
    cases: Vec<CaseTimes>,
    /// What could not be timed.
    failures: Vec<Failure>,
    /// Drafts of each case; empty where they were not asked for.
    turning: Vec<Turning>,
}

/// What could not be timed, and why.
#[derive(Serialize)]
pub struct Failure {
    pub case: String,
    /// Adapter, strategy and lighting; empty where the case itself failed.
    pub what: String,
    pub error: String,
}

/// A scene to time, and the name of its light.
pub struct Run {
    pub scene: Scene,
    pub lighting: String,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let options = &arguments.options;
    options.set_threads()?;
    let before = arguments.against.as_deref().map(against::read);
    let before = before.transpose()?;
    let mut scene = options.plain_scene()?;
    let executors: Vec<Arc<dyn Executor>> = match arguments.adapters.as_slice() {
        [] => vec![options.open_executor(&reporter)?],
        names => {
            let open = |name: &String| open_executor(Some(name), &reporter);
            names.iter().map(open).collect::<anyhow::Result<_>>()?
        }
    };
    let infos: Vec<ExecutorInfo> = executors.iter().map(|e| e.info()).collect();
    if options.size.is_none() && options.scene.is_none() {
        scene.size = match infos.iter().any(|info| info.is_software) {
            true => SOFTWARE_SIZE,
            false => GPU_SIZE,
        };
    }
    let runs = runs(&scene, options.strategy.is_some(), &arguments.lightings)?;
    let adapters: Vec<&str> = infos.iter().map(|info| info.adapter.as_str()).collect();
    let mut bench = Bench {
        version: env!("CARGO_PKG_VERSION"),
        adapter: adapters.join("; "),
        threads: rayon::current_num_threads(),
        size: scene.size,
        frames: arguments.frames,
        cases: Vec::new(),
        failures: Vec::new(),
        turning: Vec::new(),
    };
    let defaults: Vec<PathBuf> = DEFAULT.iter().map(PathBuf::from).collect();
    let cases = match arguments.cases.as_slice() {
        [] => defaults.as_slice(),
        cases => cases,
    };
    for case in cases {
        let timed = bench.time(case, &runs, &executors, arguments, &reporter);
        if let Err(error) = timed {
            bench.failures.push(Failure {
                case: case.display().to_string(),
                what: String::new(),
                error: format!("{error:#}"),
            });
        }
    }
    if !bench.cases.is_empty() {
        say!("{}", table::text(&bench));
    }
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&bench)?)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    if let Some(before) = before {
        say!(
            "{}",
            against::text(&before, &serde_json::to_value(&bench)?)?
        );
    }
    bench.failed()
}

impl Bench {
    /// Times a case; what fails of it is kept, and the rest goes on.
    fn time(
        &mut self,
        case: &Path,
        runs: &[Run],
        executors: &[Arc<dyn Executor>],
        arguments: &Arguments,
        reporter: &Reporter,
    ) -> anyhow::Result<()> {
        let files = Files::new(case, reporter)?;
        let timer = measure::Timer {
            runs,
            executors,
            frames: arguments.frames,
            reporter,
        };
        let (times, failures) = timer.case(&files.path)?;
        self.cases.push(times);
        self.failures.extend(failures);
        if let Some(moves) = arguments.turn {
            let turning = turning::case(&files.path, moves as usize, reporter)?;
            self.turning.extend(turning);
        }
        Ok(())
    }

    /// An error that tells all failures, where there are some.
    fn failed(&self) -> anyhow::Result<()> {
        let tell = |failure: &Failure| match failure.what.as_str() {
            "" => failure.error.clone(),
            what => format!("{} by {what}: {}", failure.case, failure.error),
        };
        let told: Vec<String> = self.failures.iter().map(tell).collect();
        anyhow::ensure!(told.is_empty(), "{}", told.join("\nstrataray: "));
        Ok(())
    }
}

/// The scene for each lighting and strategy, or only for the strategy that it names.
fn runs(scene: &Scene, as_named: bool, lightings: &[String]) -> anyhow::Result<Vec<Run>> {
    let lit = match lightings {
        [] => vec![Run {
            scene: scene.clone(),
            lighting: String::new(),
        }],
        names => {
            let lit = |name: &String| {
                let preset = lighting_preset(name);
                let lighting = preset.map_err(|e| anyhow::anyhow!("--lightings {name}: {e}"))?;
                let mut scene = scene.clone();
                scene.lighting = lighting;
                anyhow::Ok(Run {
                    scene,
                    lighting: name.clone(),
                })
            };
            names.iter().map(lit).collect::<anyhow::Result<_>>()?
        }
    };
    let strategies = match as_named {
        true => &[scene.strategy][..],
        false => &StrategyKind::ALL,
    };
    let by = |run: &Run, strategy: StrategyKind| {
        let mut scene = run.scene.clone();
        scene.strategy = strategy;
        Run {
            scene,
            lighting: run.lighting.clone(),
        }
    };
    let all = lit
        .iter()
        .flat_map(|run| strategies.iter().map(|s| by(run, *s)));
    Ok(all.collect())
}

/// A case on disk: the user's, or a synthetic one for as long as this lives.
struct Files {
    path: PathBuf,
    _folder: Option<tempfile::TempDir>,
}

impl Files {
    fn new(case: &Path, reporter: &Reporter) -> anyhow::Result<Self> {
        let recipe = case.to_str().and_then(Recipe::named);
        // A file that is called like a model is meant itself.
        let Some(recipe) = recipe.filter(|_| !case.is_file()) else {
            return Ok(Self {
                path: case.to_owned(),
                _folder: None,
            });
        };
        let folder = tempfile::tempdir().context("cannot make a temporary folder")?;
        let name = recipe.name.to_ascii_uppercase();
        let target = synthetic::Target {
            folder: folder.path(),
            name: &name,
            text: false,
        };
        reporter.bar("writing", |progress| {
            let model = recipe.build(recipe.dims, SEED, STEPS)?;
            anyhow::Ok(synthetic::write(model, &target, progress)?)
        })?;
        Ok(Self {
            path: folder.path().join(name),
            _folder: Some(folder),
        })
    }
}

/// What makes a synthetic model's figures comparable from run to run.
const SEED: u64 = 1;
const STEPS: usize = 10;
