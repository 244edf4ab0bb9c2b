//! `strataray sample`: writes a synthetic model with time steps, or a regular volume.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use clap::builder::PossibleValue;
use strataray::export::synthetic;
use strataray::export::volume::{self, VolumeFormat};
use strataray::model::Dims;
use strataray::model::synthetic::{RECIPES, Recipe, VOLUMES, VolumeRecipe};

use super::Verbosity;
use super::progress::Reporter;

/// Report steps of a model where no other number is asked for.
const STEPS: u16 = 10;

#[derive(clap::Args)]
#[command(
    after_help = "r1 to r5 have the dimensions and active cells of published test models, r6 has 50 million cells, \
`faulted` is a field of any size, `box` a plain box with linear properties. The others are regular volumes.
Examples:
  strataray sample faulted -o models
  strataray sample faulted --dims 220,100,50 --seed 7 -o models
  strataray sample r3 -o models && strataray render models/R3.EGRID --property SWAT -o r3.png
  strataray sample shells --dims 64,64,64 -o volumes && strataray render volumes/SHELLS.nrrd -o shells.png"
)]
pub struct Arguments {
    /// Which model or volume, in any letter case.
    #[arg(value_parser = names(), ignore_case = true)]
    name: String,
    /// Cells, or samples, along i, j and k, such as 220,100,50.
    #[arg(long, value_name = "NI,NJ,NK", value_parser = dims)]
    dims: Option<Dims>,
    /// Another seed gives another field.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of report steps of a model; without it 10.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=9999))]
    steps: Option<u16>,
    /// Format of a volume; without it nrrd.
    #[arg(long, value_parser = VolumeFormat::ALL.map(|(_, ending)| ending))]
    format: Option<String>,
    /// Folder to write to; made where it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    verbosity: Verbosity,
}

fn names() -> clap::builder::PossibleValuesParser {
    let models = RECIPES.iter().map(|r| PossibleValue::new(r.name));
    let volume = |v: &'static VolumeRecipe| PossibleValue::new(v.name).help(v.describe);
    models
        .chain(VOLUMES.iter().map(volume))
        .collect::<Vec<_>>()
        .into()
}

fn dims(text: &str) -> Result<Dims, String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[ni, nj, nk]) => Ok(Dims { ni, nj, nk }),
        _ => Err("give three numbers of cells like 220,100,50".into()),
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    if let Some(recipe) = VolumeRecipe::named(&arguments.name) {
        return write_volume(arguments, recipe, &reporter);
    }
    let recipe = Recipe::named(&arguments.name);
    let recipe = recipe.with_context(|| format!("there is no model {}", arguments.name))?;
    ensure!(
        arguments.format.is_none(),
        "--format is for volumes, and {} is a model",
        recipe.name
    );
    let dims = arguments.dims.unwrap_or(recipe.dims);
    let name = recipe.name.to_ascii_uppercase();
    let steps = arguments.steps.unwrap_or(STEPS);
    let files = reporter.bar("writing", |progress| {
        let model = recipe.build(dims, arguments.seed, steps.into())?;
        let target = synthetic::Target {
            folder: &arguments.output,
            name: &name,
            text: true,
        };
        anyhow::Ok(synthetic::write(model, &target, progress)?)
    })?;
    for file in &files {
        say_line!("{}", file.display());
    }
    if let Some(grid) = files.first() {
        let grid = grid.display();
        reporter.note(&format!(
            "see it with `strataray render {grid} --property SWAT --step last -o {name}.png`, \
             what it holds with `strataray info {grid}`"
        ));
    }
    Ok(())
}

fn write_volume(
    arguments: &Arguments,
    recipe: &VolumeRecipe,
    reporter: &Reporter,
) -> anyhow::Result<()> {
    ensure!(
        arguments.steps.is_none(),
        "--steps is for models, and {} is a volume",
        recipe.name
    );
    let given = arguments.format.as_deref();
    let format = VolumeFormat::ALL.iter().find(|f| Some(f.1) == given);
    let format = format.map_or(VolumeFormat::Nrrd, |f| f.0);
    let name = recipe.name.to_ascii_uppercase();
    let dims = arguments.dims.unwrap_or(recipe.dims);
    let file = reporter.bar("writing", |progress| {
        let volume = recipe.build(dims, arguments.seed);
        let target = [&arguments.output, Path::new(&name)];
        volume::write(&volume, target, format, progress)
    })?;
    let file = file.display();
    say_line!("{file}");
    reporter.note(&format!(
        "see it with `strataray render {file} -o {name}.png`, what it holds with `strataray info {file}`"
    ));
    Ok(())
}
