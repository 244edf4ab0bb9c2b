//! `strataray animate`: a film of a case, without a window.

use std::path::PathBuf;

use anyhow::{Context, bail, ensure};
use strataray::case::Case;
use strataray::picture::film::{Film, FilmFormat, FilmShape};
use strataray::picture::filming::{FilmingError, shoot};
use strataray::render::RenderError;
use strataray::scene::Scene;
use strataray::view::{Sequence, Turn, step};

use super::Verbosity;
use super::progress::Reporter;
use super::scene_options::SceneOptions;

#[derive(clap::Args)]
#[command(after_help = "\
The name of the output tells the format:
  .gif   256 colors per image; plays everywhere, also in slides
  .png   animated PNG: lossless, plays in browsers but not in slides
  .mp4   H.264, small; only in builds with `--features mp4`, which need a C++ compiler
         (H.264 is covered by patents: find out whether you need a license)
  DIR/   numbered images frame_0000.png, frame_0001.png, ...
Colors and opacity mean the same values in all images: the scene's range, or that of all steps shown.

Examples:
  strataray animate REEK.EGRID --over steps --property SWAT -o flood.png
  strataray animate REEK.EGRID --over steps --steps 2000-01-01..last --every 2 --fps 4 -o flood.gif
  strataray animate REEK.EGRID --over orbit --scene scene.json --frames 120 -o turn.png
  strataray animate REEK.EGRID --over orbit --degrees -90 -o images/")]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    #[command(flatten)]
    options: SceneOptions,
    /// What changes from image to image: the time step, or the camera's azimuth.
    #[arg(long, value_enum)]
    over: Over,
    /// With `--over steps`: first and last step, each a number, a date, first or last; all steps by default.
    #[arg(long, value_name = "A..B")]
    steps: Option<String>,
    /// With `--over steps`: take each Nth step only.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    every: Option<u32>,
    /// With `--over orbit`: number of images [default: 72].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: Option<u32>,
    /// With `--over orbit`: how far to turn; below 0 the other way around [default: 360].
    #[arg(long, allow_hyphen_values = true)]
    degrees: Option<f64>,
    /// Images per second, 0.2 to 60 [default: 10 over steps, 24 over orbit].
    #[arg(long)]
    fps: Option<f64>,
    /// Extra seconds for the last image, up to 60 [default: 1 over steps, 0 over orbit].
    #[arg(long, value_name = "SECONDS")]
    hold: Option<f64>,
    /// Animation to write: .gif, .png (animated), .mp4 (see below), or a folder DIR/.
    #[arg(short, long)]
    output: PathBuf,
    /// The model alone: no title, legend, info line or axes.
    #[arg(long)]
    plain: bool,
    #[command(flatten)]
    verbosity: Verbosity,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Over {
    /// The time steps of a property.
    Steps,
    /// A turn around the model.
    Orbit,
}

/// What a user who pressed Ctrl-C reads.
const CANCELED: &str = "the animation was canceled; nothing was written";

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    check(arguments)?;
    arguments.options.set_threads()?;
    let case = arguments.options.open_case(&arguments.case, &reporter)?;
    let (scene, case) = arguments.options.scene_in_space(case, &reporter)?;
    let sequence = sequence(arguments, &scene, &case, &reporter)?;
    for sentence in sequence.left_out() {
        reporter.note(sentence);
    }
    let pictures = u32::try_from(sequence.count())?;
    let [low, high] = sequence.range();
    reporter.detail(&format!("{pictures} images of values {low} to {high}"));
    let film = Film::create(&arguments.output, shape(arguments, scene.size, pictures))?;
    let executor = arguments.options.open_executor(&reporter)?;
    let mut renderer = executor.renderer(&case.grid)?;
    let plain = arguments.plain;
    let made = reporter.bar(format!("{pictures} pictures"), |progress| {
        shoot(&mut *renderer, &case, &sequence, film, plain, progress)
    });
    match made {
        Err(FilmingError::Render(RenderError::Canceled)) => bail!(CANCELED),
        made => Ok(made?),
    }
}

/// Refuses what cannot become a film before anything takes time.
fn check(arguments: &Arguments) -> anyhow::Result<()> {
    FilmFormat::from_path(&arguments.output)?;
    let (over_steps, over_orbit) = match arguments.over {
        Over::Steps => (true, false),
        Over::Orbit => (false, true),
    };
    for (option, given, fits) in [
        ("--steps", arguments.steps.is_some(), over_steps),
        ("--every", arguments.every.is_some(), over_steps),
        ("--frames", arguments.frames.is_some(), over_orbit),
        ("--degrees", arguments.degrees.is_some(), over_orbit),
    ] {
        let other = if over_steps { "orbit" } else { "steps" };
        ensure!(!given || fits, "{option} goes with --over {other}");
    }
    ensure!(
        !(over_steps && arguments.options.picks_step()),
        "--step is one step; choose those of an animation with --steps A..B"
    );
    let within = |option, value: Option<f64>, [low, high]: [f64; 2]| {
        let fits = value.is_none_or(|v| (low..=high).contains(&v));
        ensure!(fits, "{option} must be from {low} to {high}");
        Ok(())
    };
    within("--fps", arguments.fps, [0.2, 60.0])?;
    within("--hold", arguments.hold, [0.0, 60.0])
}

fn sequence(
    arguments: &Arguments,
    scene: &Scene,
    case: &Case,
    reporter: &Reporter,
) -> anyhow::Result<Sequence> {
    match arguments.over {
        Over::Steps => {
            let every = arguments.every.unwrap_or(1) as usize;
            let steps = step::steps(case, arguments.steps.as_deref(), every)?;
            let found = reporter.bar("range of the steps", |progress| {
                Sequence::over_steps(scene, case, &steps, &|f| progress(f))
            });
            found?.context(CANCELED)
        }
        Over::Orbit => {
            let turn = Turn {
                degrees: arguments.degrees.unwrap_or(360.0),
                views: arguments.frames.unwrap_or(72) as usize,
            };
            Ok(Sequence::around(scene, case, turn)?)
        }
    }
}

fn shape(arguments: &Arguments, size: [u32; 2], pictures: u32) -> FilmShape {
    let (fps, hold) = match arguments.over {
        Over::Steps => (10.0, 1.0),
        Over::Orbit => (24.0, 0.0),
    };
    FilmShape {
        size,
        pictures,
        fps: arguments.fps.unwrap_or(fps),
        hold: arguments.hold.unwrap_or(hold),
    }
}
