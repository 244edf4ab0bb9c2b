//! `strataray compare`: strategies or light methods side by side, in pictures and figures.

use std::path::PathBuf;

use anyhow::ensure;
use strataray::case::Case;
use strataray::compare::{Comparer, LightRow, Plan, Reference, Report, Setting, Sweep, summary};
use strataray::scene::{Scene, StrategyKind};
use strataray::view::{self, NamedView, TurnAxis, half_turns};

use super::Verbosity;
use super::choice::{LIGHT_ROWS, STRATEGIES, TURN_AXES, one_of};
use super::progress::Reporter;
use super::scene_options::SceneOptions;

#[derive(clap::Args)]
#[command(after_help = "\
Writes into DIR, replacing what is there:
  compare.md     who is right and who is fast: tables with links to all else
  compare.json   a row of figures for each strategy, or light method, and view
  sheet.png      all images side by side with their difference maps
  time.png, psnr.png, ssim.png, ciede2000.png   figures over the views
  view_N_STRATEGY.png, view_N_STRATEGY_difference.png   images and CIEDE2000 difference maps

Without --reference the accurate strategy is what strategies are measured against, and many rays by the same
strategy are for light methods: rays over the cone, or to all sides where the method looks there. How far two runs of
these rays are apart is told as the noise floor; more rays in the scene (lighting.rays) lower it. Each value of a
sweep is measured against its own scene, by many rays and the accurate strategy, or with --reference by the f64 one.

Examples:
  strataray compare REEK.EGRID -o reek
  strataray compare REEK.EGRID --scene scene.json --reference --size 500x400 -o reek
  strataray compare REEK.EGRID --views 18 -o turns
  strataray compare REEK.EGRID --views 7 --turn z --frames 5 -o turn
  strataray compare REEK.EGRID --light cones,surround,rays --size 160x120 -o light
  strataray compare REEK.EGRID --sweep lighting.occlusion.splits=1,3,7 --size 160x120 -o splits")]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    #[command(flatten)]
    options: SceneOptions,
    /// Strategies by name, with commas between; all by default.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = one_of(&STRATEGIES),
        hide_possible_values = true,
        conflicts_with = "strategy"
    )]
    strategies: Vec<StrategyKind>,
    /// Compare light methods by one strategy instead, by name, with commas between.
    #[arg(
        long,
        value_name = "METHODS",
        value_delimiter = ',',
        value_parser = one_of(&LIGHT_ROWS),
        conflicts_with = "strategies"
    )]
    light: Vec<LightRow>,
    /// Compare values of a key of the scene instead, such as lighting.occlusion.half_angle_degrees=10,20,30: one row
    /// each, measured against the same scene by many rays and the accurate strategy.
    #[arg(
        long,
        value_name = "KEY=V1,V2,...",
        conflicts_with_all = ["strategies", "light"]
    )]
    sweep: Option<String>,
    /// Measure against the f64 reference on the CPU, which is slow.
    #[arg(long)]
    reference: bool,
    /// Compare in N views, half a rotation of the camera about each of x, y and z in turn; one view by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    views: Option<u32>,
    /// Axis of the rotation: x east, y north, z up, or all three one after another [default: all].
    #[arg(long, value_parser = one_of(&TURN_AXES), requires = "views", hide_possible_values = true)]
    turn: Option<TurnAxis>,
    /// Frames to time for each image, after one that is not timed.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// CIEDE2000 difference at which the colors of difference maps end.
    #[arg(long, value_name = "DIFFERENCE", default_value_t = 5.0)]
    difference_scale: f64,
    /// Folder to write into.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    ensure!(
        arguments.difference_scale.is_finite() && arguments.difference_scale > 0.0,
        "--difference-scale must be above 0"
    );
    arguments.options.set_threads()?;
    let case = arguments.options.open_case(&arguments.case, &reporter)?;
    let (scene, case) = arguments.options.scene_in_space(case, &reporter)?;
    let executor = arguments.options.open_executor(&reporter)?;
    let plan = plan(arguments, &scene, &case)?;
    let setting = Setting {
        case: &case,
        plan: &plan,
        adapter: executor.info().adapter,
        difference_scale: arguments.difference_scale,
    };
    let mut report = Report::begin(&arguments.output, setting)?;
    let mut comparer = Comparer::new(&*executor, &case.grid, &plan)?;
    let all = plan.views.len();
    let done = reporter.bar("comparing", |progress| {
        for n in 0..all {
            let done = |f: f64| progress((n as f64 + f) / all as f64);
            let Some(compared) = comparer.view(n, &done) else {
                return Ok(n);
            };
            report.add(compared)?;
        }
        anyhow::Ok(all)
    })?;
    ensure!(
        done > 0,
        "the comparison was canceled before a view was done"
    );
    let rows = report.finish()?;
    say!("{}", summary(&rows));
    let folder = arguments.output.display();
    ensure!(
        done == all,
        "the comparison was canceled; {folder} holds {done} of {all} views"
    );
    Ok(())
}

fn plan(arguments: &Arguments, scene: &Scene, case: &Case) -> anyhow::Result<Plan> {
    let frames = arguments.frames as usize;
    let views = |scene: &Scene| views(arguments, scene, case);
    if !arguments.light.is_empty() {
        let rows = distinct(&arguments.light);
        return Plan::of_light(&rows, scene, arguments.reference, frames, views);
    }
    if let Some(sweep) = &arguments.sweep {
        let sweep = Sweep::parse(sweep)?;
        let views = |scene: &Scene| views(scene).map_err(|e| format!("{e:#}"));
        return Ok(Plan::of_sweep(
            &sweep,
            scene,
            arguments.reference,
            frames,
            views,
        )?);
    }
    let reference = match arguments.reference {
        true => Reference::Cpu,
        false => Reference::Strategy(StrategyKind::accurate()),
    };
    let strategies = strategies(arguments);
    Ok(Plan::of_strategies(
        &strategies,
        reference,
        views(scene)?,
        frames,
    ))
}

/// The strategies asked for, each once; all where none is.
fn strategies(arguments: &Arguments) -> Vec<StrategyKind> {
    let asked = arguments
        .strategies
        .iter()
        .chain(&arguments.options.strategy);
    let found = distinct(asked);
    match found.is_empty() {
        true => StrategyKind::ALL.to_vec(),
        false => found,
    }
}

/// Each once, in the order in which they come first.
fn distinct<'a, T: Copy + PartialEq + 'a>(all: impl IntoIterator<Item = &'a T>) -> Vec<T> {
    let mut found = Vec::new();
    for one in all {
        if !found.contains(one) {
            found.push(*one);
        }
    }
    found
}

fn views(arguments: &Arguments, scene: &Scene, case: &Case) -> anyhow::Result<Vec<NamedView>> {
    let view = view::resolve(scene, case)?;
    Ok(match arguments.views {
        Some(count) => {
            let about = arguments.turn.unwrap_or(TurnAxis::All);
            half_turns(scene, &view, about, count as usize)
        }
        None => vec![NamedView {
            name: "the scene's".into(),
            view,
        }],
    })
}
