//! `strataray probe`: point location as a tool.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use glam::DVec3;
use strataray::case::{Case, Measure};
use strataray::model::{Grid, Ijk, Spaces};
use strataray::reference::{self, Located};
use strataray::scene::{Interpolation, Scene, StepSpec, Units};
use strataray::{render, view};

use super::Verbosity;
use super::choice::{INTERPOLATIONS, UNITS, one_of};
use super::progress::Reporter;
use super::scene_options::AddedFiles;

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum On {
    Gpu,
    Cpu,
}

#[derive(clap::Args)]
#[command(
    after_help = "Points are lines of x,y,depth (a first line of names is allowed).
Example:
  strataray probe REEK.EGRID --property PORO --points wells.csv --on cpu -o values.csv"
)]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    /// Property whose value to give.
    #[arg(long)]
    property: String,
    /// Time step: number from 0, date, first or last.
    #[arg(long, default_value = "last")]
    step: String,
    /// CSV of easting, northing (in MAPUNITS) and depth (positive down, in the grid's unit); in those of --units where
    /// given.
    #[arg(long)]
    points: PathBuf,
    /// The points are raw grid coordinates, MAPAXES and MAPUNITS not applied.
    #[arg(long)]
    grid_coordinates: bool,
    /// Units of points and values.
    #[arg(long, value_parser = one_of(&UNITS), default_value = "file")]
    units: Units,
    /// Values within a cell.
    #[arg(long, value_parser = one_of(&INTERPOLATIONS), default_value = "cell")]
    interpolation: Interpolation,
    /// Where to compute.
    #[arg(long, value_enum, default_value = "gpu")]
    on: On,
    /// Part of the name of the GPU adapter to use.
    #[arg(long)]
    adapter: Option<String>,
    #[command(flatten)]
    added: AddedFiles,
    /// Where to write; standard output by default.
    #[arg(short, long)]
    output: Option<PathBuf>,
    #[command(flatten)]
    verbosity: Verbosity,
}

/// A found point: cell, (s, t, r), value.
type Probed = Option<(Ijk, DVec3, f64)>;

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let case = arguments.added.open_case(&arguments.case, &reporter)?;
    let step = case.step(&arguments.step)?;
    let field = case.field(&arguments.property, step)?;
    let given = read_points(arguments)?;
    let units = arguments.units.into();
    let (grid, map) = (case.length(units), case.map_length(units));
    let across = if arguments.grid_coordinates {
        &grid
    } else {
        &map
    };
    let axes = case.grid.map_axes().filter(|_| !arguments.grid_coordinates);
    let spaces = Spaces::new(axes, 1.0);
    let in_grid: Vec<DVec3> = given
        .iter()
        .map(|p| {
            let kept = DVec3::new(across.read(p.x), across.read(p.y), grid.read(p.z));
            spaces
                .grid_from_world
                .transform_point3(spaces.world_from_map(kept))
        })
        .collect();
    let answers = match arguments.on {
        On::Cpu => {
            let found = reference::values_at(&case.grid, &field, arguments.interpolation, &in_grid);
            let answer = |(located, value): (Located, f64)| (located.ijk, located.str, value);
            found.into_iter().map(|f| f.map(answer)).collect()
        }
        On::Gpu => on_gpu(arguments, &case, step, &in_grid)?,
    };
    let answers = in_units(answers, &case.measure(&arguments.property, units));
    match &arguments.output {
        Some(path) => {
            let file = std::fs::File::create(path)
                .with_context(|| format!("cannot write {}", path.display()))?;
            write_answers(std::io::BufWriter::new(file), &case.grid, &given, &answers)
        }
        None => write_answers(std::io::stdout().lock(), &case.grid, &given, &answers),
    }
}

/// The answers with their values as they are shown.
fn in_units(answers: Vec<Probed>, measure: &Measure) -> Vec<Probed> {
    let shown =
        |(ijk, parameters, value): (Ijk, DVec3, f64)| (ijk, parameters, measure.show(value));
    answers.into_iter().map(|a| a.map(shown)).collect()
}

fn on_gpu(
    arguments: &Arguments,
    case: &Case,
    step: usize,
    points: &[DVec3],
) -> anyhow::Result<Vec<Probed>> {
    let scene = Scene {
        property: Some(arguments.property.clone()),
        step: StepSpec::Index(step),
        interpolation: arguments.interpolation,
        vertical_exaggeration: Some(1.0),
        ..Scene::default()
    };
    let view = view::resolve(&scene, case)?;
    let to_world = |p: &DVec3| view.world.spaces.world_from_grid.transform_point3(*p);
    let in_world: Vec<DVec3> = points.iter().map(to_world).collect();
    let executor = render::executor(arguments.adapter.as_deref())?;
    let located = executor.renderer(&case.grid)?.locate(&view, &in_world)?;
    Ok(located
        .into_iter()
        .map(|l| l.map(|l| (l.ijk, l.parameters, l.value)))
        .collect())
}

fn read_points(arguments: &Arguments) -> anyhow::Result<Vec<DVec3>> {
    let path = &arguments.points;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_path(path)
        .with_context(|| format!("cannot read {}", path.display()))?;
    let mut points = Vec::new();
    for (row, record) in reader.records().enumerate() {
        let record = record.with_context(|| format!("cannot read {}", path.display()))?;
        let numbers: Option<Vec<f64>> = record.iter().take(3).map(|f| f.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[x, y, z]) if x.is_finite() && y.is_finite() && z.is_finite() => {
                points.push(DVec3::new(x, y, z));
            }
            _ if row == 0 && record.iter().all(|f| f.parse::<f64>().is_err()) => {}
            _ => anyhow::bail!(
                "{}:{}: expected x,y,depth, found {}",
                path.display(),
                record.position().map_or(0, csv::Position::line),
                record.iter().collect::<Vec<_>>().join(",")
            ),
        }
    }
    anyhow::ensure!(
        !points.is_empty(),
        "{}: there are no points; write one x,y,depth per line",
        path.display()
    );
    Ok(points)
}

/// A row for each point; a last column names the local grid, where the case has some.
fn write_answers(
    mut out: impl Write,
    grid: &Grid,
    points: &[DVec3],
    answers: &[Probed],
) -> anyhow::Result<()> {
    let has_local = grid.patches().len() > 1;
    let last = if has_local { ",grid" } else { "" };
    writeln!(out, "x,y,depth,i,j,k,s,t,r,value{last}")?;
    for (p, answer) in points.iter().zip(answers) {
        let point = format!("{},{},{}", p.x, p.y, p.z);
        match answer {
            Some((cell, parameters, value)) => {
                let cell = grid.cell_name(*cell);
                let [i, j, k] = cell.ijk;
                let [s, t, r] = parameters.to_array();
                write!(out, "{point},{i},{j},{k},{s},{t},{r},{value}")?;
                if has_local {
                    write!(out, ",{}", cell.grid)?;
                }
                writeln!(out)?;
            }
            None => writeln!(out, "{point},,,,,,,{}", if has_local { "," } else { "" })?,
        }
    }
    Ok(out.flush()?)
}
