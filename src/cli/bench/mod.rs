//! `strataray bench`: load times, frame times and memory on this machine.

mod measure;
mod table;
mod turning;

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;
use strataray::case::save;
use strataray::model::synthetic::Recipe;
use strataray::scene::{Scene, StrategyKind};

use super::Verbosity;
use super::progress::Reporter;
use super::scene_options::SceneOptions;
use measure::CaseTimes;
use turning::Turning;

/// Cases where none is named.
const DEFAULT: [&str; 3] = ["r1", "r2", "r3"];
/// Picture sizes where none is given: with a GPU, and with software that plays one.
const GPU_SIZE: [u32; 2] = [1000, 1000];
const SOFTWARE_SIZE: [u32; 2] = [500, 500];

#[derive(clap::Args)]
#[command(
    after_help = "Each case is opened, uploaded and rendered by each strategy: one frame to warm up, then the timed ones.
Times are in milliseconds; files are timed as the system's cache holds them.
Examples:
  strataray bench
  strataray bench R4 REEK.EGRID --frames 5 --json bench.json
  strataray bench BRUGGE.EGRID --turn 30
  strataray bench R5 --size 1000x1000 --property SWAT --strategy plts"
)]
pub struct Arguments {
    /// Cases by path, or synthetic models by name (r1 to r5, faulted, box); r1 to r3 by default.
    cases: Vec<PathBuf>,
    #[command(flatten)]
    options: SceneOptions,
    /// Frames to time, after one that is not timed.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Also turn each model by N moves of the pointer, as in the window, and time the drafts.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    turn: Option<u32>,
    /// Write the figures (JSON).
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
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
    /// Drafts of each case; empty where they were not asked for.
    turning: Vec<Turning>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let options = &arguments.options;
    options.set_threads()?;
    let mut scene = options.plain_scene()?;
    let executor = options.open_executor(&reporter)?;
    let info = executor.info();
    if options.size.is_none() && options.scene.is_none() {
        scene.size = match info.is_software {
            true => SOFTWARE_SIZE,
            false => GPU_SIZE,
        };
    }
    let mut bench = Bench {
        version: env!("CARGO_PKG_VERSION"),
        adapter: info.adapter,
        threads: rayon::current_num_threads(),
        size: scene.size,
        frames: arguments.frames,
        cases: Vec::new(),
        turning: Vec::new(),
    };
    let scenes = scenes(&scene, options.strategy.is_some());
    let defaults: Vec<PathBuf> = DEFAULT.iter().map(PathBuf::from).collect();
    let cases = match arguments.cases.as_slice() {
        [] => defaults.as_slice(),
        cases => cases,
    };
    for case in cases {
        let files = Files::new(case, &reporter)?;
        let times = measure::case(
            &files.path,
            &scenes,
            &*executor,
            arguments.frames,
            &reporter,
        )?;
        bench.cases.push(times);
        if let Some(moves) = arguments.turn {
            let turning = turning::case(&files.path, moves as usize, &reporter)?;
            bench.turning.extend(turning);
        }
    }
    print!("{}", table::text(&bench));
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&bench)?)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

/// The scene once for each strategy, or only for the one that it names.
fn scenes(scene: &Scene, as_named: bool) -> Vec<Scene> {
    if as_named {
        return vec![scene.clone()];
    }
    let with = |strategy: StrategyKind| Scene {
        strategy,
        ..scene.clone()
    };
    StrategyKind::ALL.into_iter().map(with).collect()
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
        let target = save::Target {
            folder: folder.path(),
            name: &name,
            text: false,
        };
        reporter.bar("writing", |progress| {
            let model = recipe.build(recipe.dims, SEED, STEPS)?;
            anyhow::Ok(save::synthetic(model, &target, progress)?)
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
