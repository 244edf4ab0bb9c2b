//! The command line: one file per command.

#[macro_use]
mod output;

mod animate;
mod bench;
mod cancel;
mod choice;
mod compare;
mod doctor;
mod export;
mod info;
mod pick;
mod probe;
mod process;
mod progress;
mod render;
mod sample;
mod scene_options;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use strataray::case::load;

const EXAMPLES: &str = "Examples:
  strataray info samples/scissor/SCISSOR.EGRID
  strataray render samples/scissor/SCISSOR.EGRID --property SWAT --step last -o swat.png
  strataray animate samples/scissor/SCISSOR.EGRID --property SWAT --over steps -o flood.png
  strataray compare samples/scissor/SCISSOR.EGRID --views 6 -o compared
  strataray export samples/scissor/SCISSOR.EGRID --property PORO SWAT -o swat.vtu
  strataray sample faulted -o models
  strataray bench R1 samples/scissor/SCISSOR.EGRID
  strataray render new/REEK.EGRID --minus old/REEK.EGRID --property PRESSURE -o difference.png
  strataray render real-0/REEK.EGRID --ensemble real-1/REEK.EGRID real-2/REEK.EGRID --property SWAT.STD -o spread.png
  strataray pick samples/scissor/SCISSOR.EGRID --at 500,500
  strataray probe samples/scissor/SCISSOR.EGRID --property PORO --points points.csv
  strataray doctor";

/// Sees oil and gas reservoirs from the inside: volume ray casting of corner-point grids.
#[derive(Parser)]
#[command(version, about, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Cases to open in the viewer.
    cases: Vec<PathBuf>,
    /// Reload the cases when their files change, for example while a simulation runs.
    #[arg(long)]
    watch: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Tells what a case holds.
    Info(info::Arguments),
    /// Renders one image, without a window.
    Render(render::Arguments),
    /// Renders an animation over time steps or around the model, or its numbered images.
    Animate(animate::Arguments),
    /// Tells what a click at a pixel of the image selects.
    Pick(pick::Arguments),
    /// Finds the cell, its parameters and the value at given points.
    Probe(probe::Arguments),
    /// Compares strategies side by side: images, difference maps, figures.
    Compare(compare::Arguments),
    /// Writes cells, values and surfaces to files of other programs.
    Export(export::Arguments),
    /// Times loading and rendering on this machine.
    Bench(bench::Arguments),
    /// Writes a synthetic faulted model with time steps.
    Sample(sample::Arguments),
    /// Tells what this machine has to make images with, and what is missing.
    Doctor(doctor::Arguments),
}

/// How much to say on standard error.
#[derive(clap::Args, Clone, Copy)]
pub struct Verbosity {
    /// Print more, such as the time of each stage.
    #[arg(long, global = true)]
    verbose: bool,
    /// Print errors only.
    #[arg(long, global = true, conflicts_with = "verbose")]
    quiet: bool,
}

/// Opens the window, unless what is to be opened is not there: that is told where it was typed.
fn open_window(cases: Vec<PathBuf>, watches: bool) -> anyhow::Result<()> {
    if let Some(missing) = cases.iter().find(|path| !load::is_there(path)) {
        anyhow::bail!(
            "{}: there is no such file, case or command; `strataray --help` lists the commands",
            missing.display()
        );
    }
    show_window(cases, watches)
}

#[cfg(feature = "viewer")]
fn show_window(cases: Vec<PathBuf>, watches: bool) -> anyhow::Result<()> {
    Ok(strataray::viewer::run(cases, watches)?)
}

#[cfg(not(feature = "viewer"))]
fn show_window(_: Vec<PathBuf>, _: bool) -> anyhow::Result<()> {
    anyhow::bail!(
        "this build of strataray has no window; `strataray render CASE -o image.png` makes an image without one"
    )
}

/// Runs the command line and turns an error into one sentence and exit code 1.
pub fn run() -> ExitCode {
    process::give_runtime_folder();
    let arguments = Arguments::parse();
    let result = match arguments.command {
        Some(Command::Info(a)) => info::run(&a),
        Some(Command::Render(a)) => render::run(&a),
        Some(Command::Animate(a)) => animate::run(&a),
        Some(Command::Pick(a)) => pick::run(&a),
        Some(Command::Probe(a)) => probe::run(&a),
        Some(Command::Compare(a)) => compare::run(&a),
        Some(Command::Export(a)) => export::run(&a),
        Some(Command::Bench(a)) => bench::run(&a),
        Some(Command::Sample(a)) => sample::run(&a),
        Some(Command::Doctor(a)) => doctor::run(&a),
        None => open_window(arguments.cases, arguments.watch),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("strataray: {error:#}");
            ExitCode::FAILURE
        }
    }
}
