//! `strataray sample`: writes a synthetic model with time steps.

use std::path::PathBuf;

use anyhow::Context;
use strataray::export::synthetic;
use strataray::model::Dims;
use strataray::model::synthetic::{RECIPES, Recipe};

use super::Verbosity;
use super::progress::Reporter;

#[derive(clap::Args)]
#[command(
    after_help = "r1 to r5 have the dimensions and active cells of published test models, r6 has 50 million cells, \
`faulted` is a field of any size, `box` a plain box with linear properties.
Examples:
  strataray sample faulted -o models
  strataray sample faulted --dims 220,100,50 --seed 7 -o models
  strataray sample r3 -o models && strataray render models/R3.EGRID --property SWAT -o r3.png"
)]
pub struct Arguments {
    /// Which model, in any letter case.
    #[arg(value_parser = names(), ignore_case = true)]
    name: String,
    /// Cells along i, j and k, such as 220,100,50.
    #[arg(long, value_name = "NI,NJ,NK", value_parser = dims)]
    dims: Option<Dims>,
    /// Another seed gives another field.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of report steps.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=9999))]
    steps: u16,
    /// Folder to write to; made where it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    verbosity: Verbosity,
}

fn names() -> clap::builder::PossibleValuesParser {
    RECIPES.iter().map(|r| r.name).into()
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
    let recipe = Recipe::named(&arguments.name);
    let recipe = recipe.with_context(|| format!("there is no model {}", arguments.name))?;
    let dims = arguments.dims.unwrap_or(recipe.dims);
    let name = recipe.name.to_ascii_uppercase();
    let files = reporter.bar("writing", |progress| {
        let model = recipe.build(dims, arguments.seed, arguments.steps.into())?;
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
