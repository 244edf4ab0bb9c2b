//! `strataray export`: cells, values and surfaces as files of other programs.

use std::path::PathBuf;

use strataray::case::Case;
use strataray::export::{self, Contents, Format};
use strataray::scene::{Space, Units};
use strataray::view::{View, look, resolve, step};

use super::Verbosity;
use super::choice::{UNITS, one_of};
use super::progress::Reporter;
use super::scene_options::{AddedFiles, read_keys};

#[derive(clap::Args)]
#[command(after_help = help())]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    /// Properties, or differences such as PRESSURE-PRESSURE@0. For .glb the one that gives the colors.
    #[arg(long, value_name = "NAME", num_args = 1..)]
    property: Vec<String>,
    /// Steps of properties that change with time: all, or numbers, dates, first, last and ranges like 0..10, with commas
    /// between them. By default all, and for .glb that of the scene.
    #[arg(long, value_name = "all|N,M")]
    steps: Option<String>,
    /// Scene file (JSON), or - for standard input, that says which cells are drawn: those its filter and clip planes
    /// leave at its step. Without it all active cells are written.
    #[arg(long)]
    scene: Option<PathBuf>,
    /// Units of the values in .csv and .parquet; by default those of the scene. Other formats have those of the files.
    #[arg(long, value_parser = one_of(&UNITS))]
    units: Option<Units>,
    /// File to write, with others beside it where the format has several; its ending says the format.
    #[arg(short, long)]
    output: PathBuf,
    #[command(flatten)]
    added: AddedFiles,
    #[command(flatten)]
    verbosity: Verbosity,
}

fn help() -> String {
    let formats = Format::ALL.map(|(_, ending, what)| format!("  .{ending:<8} {what}\n"));
    format!(
        "Formats:
{}
Examples:
  strataray export REEK.EGRID --property PORO SWAT -o copy/REEK.EGRID
  strataray export REEK.EGRID --property SWAT --steps last -o swat.roff
  strataray export REEK.EGRID --property SWAT PRESSURE --steps all -o reek.vtu
  strataray export REEK.EGRID --property SOIL --scene oil.json --steps 2000-01-01,last -o oil.csv
  strataray export REEK.EGRID --property SOIL --scene oil.json -o oil.glb",
        formats.concat()
    )
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let format = Format::from_path(&arguments.output)?;
    let case = arguments.added.open_case(&arguments.case, &reporter)?;
    let steps = steps(arguments, &case)?;
    let view = view(arguments, format, &case, steps.as_deref())?;
    let steps = match steps {
        Some(steps) => steps,
        None => (0..case.steps.len()).collect(),
    };
    let mut contents = Contents::new(&case, view.as_ref(), &arguments.property, &steps)?;
    if let Some(units) = arguments.units {
        anyhow::ensure!(
            matches!(format, Format::Csv | Format::Parquet),
            "--units is for tables (.csv, .parquet); other formats have the units of the files"
        );
        contents.units = units.into();
    }
    let written = reporter.bar("writing", |progress| {
        export::write(&contents, &arguments.output, progress)
    })?;
    for note in &written.notes {
        reporter.note(note);
    }
    for file in &written.files {
        say_line!("{}", file.display());
    }
    Ok(())
}

/// The steps that were asked for, in the order of the case; `None` where nothing was said.
fn steps(arguments: &Arguments, case: &Case) -> anyhow::Result<Option<Vec<usize>>> {
    let Some(text) = &arguments.steps else {
        return Ok(None);
    };
    let mut steps = Vec::new();
    for part in text.split(',') {
        match part.trim() {
            "all" => steps.extend(0..case.steps.len()),
            range if range.contains("..") => steps.extend(step::steps(case, Some(range), 1)?),
            one => steps.push(case.step(one)?),
        }
    }
    steps.sort_unstable();
    steps.dedup();
    Ok(Some(steps))
}

/// What is seen by the scene; `None` without one, where the format does not need a view.
fn view(
    arguments: &Arguments,
    format: Format,
    case: &Case,
    steps: Option<&[usize]>,
) -> anyhow::Result<Option<View>> {
    let is_surface = format == Format::Gltf;
    let mut keys = match &arguments.scene {
        Some(path) => read_keys(path)?,
        None if is_surface => Default::default(),
        None => return Ok(None),
    };
    if is_surface {
        if let Some(property) = arguments.property.first() {
            keys.insert("property".into(), property.clone().into());
        }
        if let Some([step, rest @ ..]) = steps {
            anyhow::ensure!(
                rest.is_empty(),
                "surfaces are of one step: name one with --steps"
            );
            keys.insert("step".into(), (*step).into());
        }
    }
    // What is written lies on the map, whatever space the scene has.
    let scene = look::opening(case, &keys.into())?.in_space(Space::Map);
    Ok(Some(resolve(&scene, case)?))
}
