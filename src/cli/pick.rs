//! `strataray pick`: what a click at a pixel of the picture selects, for people or as JSON.

use std::path::PathBuf;

use anyhow::Context;
use glam::DVec2;
use serde_json::{Value, json};
use strataray::case::{Case, Measure};
use strataray::model::{GridCell, Ijk};
use strataray::picking::{self, CellOnRay, Fault, Hit, Part, Pick};
use strataray::picture::{Lengths, Shot};

use super::Verbosity;
use super::progress::Reporter;
use super::scene_options::SceneOptions;

#[derive(clap::Args)]
#[command(after_help = "Examples:
  strataray pick REEK.EGRID --scene scene.json --at 512,300
  strataray pick REEK.EGRID --property SWAT --step last --size 1600x900 --at 800,450 --json")]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    #[command(flatten)]
    options: SceneOptions,
    /// Pixel of the image that `render` writes: X to the right and Y down, both from 0.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    at: String,
    /// The image has no legend, title or axes, as with `render --plain`.
    #[arg(long)]
    plain: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    verbosity: Verbosity,
}

/// Cells listed before the selected one and behind it, at most.
const LISTED: usize = 6;

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let pixel = pixel(&arguments.at)?;
    arguments.options.set_threads()?;
    let case = arguments.options.open_case(&arguments.case, &reporter)?;
    let (scene, case) = arguments.options.scene_in_space(case, &reporter)?;
    let shot = Shot::of(&scene, &case, arguments.plain)?;
    let at = place(&shot, scene.size, pixel)?;
    let executor = arguments.options.open_executor(&reporter)?;
    let mut renderer = executor.renderer(&case.grid)?;
    let pick = picking::pick(&mut *renderer, &case, &shot.view, at)?;
    let units = shot.view.notes.units;
    let told = Told {
        case: &case,
        pick: &pick,
        measure: case.measure(&pick.property, units),
        lengths: Lengths::of(&case, units),
        along: match case.grid.space().is_map() {
            true => case.length(units),
            // Between numbers of cells.
            false => Measure::default(),
        },
    };
    match arguments.json {
        true => say_line!("{}", serde_json::to_string_pretty(&told.facts(pixel))?),
        false => say!("{}", told.text(pixel)),
    }
    Ok(())
}

fn pixel(text: &str) -> anyhow::Result<[i64; 2]> {
    let parsed = text
        .split_once(',')
        .and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    parsed.with_context(|| {
        format!("--at {text}: give the pixel as X,Y like 512,300, both whole numbers from 0")
    })
}

/// The place in the volume (0 to 1, right and down) in the middle of a pixel of the written picture.
fn place(shot: &Shot, size: [u32; 2], [x, y]: [i64; 2]) -> anyhow::Result<DVec2> {
    let [width, height] = size.map(i64::from);
    anyhow::ensure!(
        (0..width).contains(&x) && (0..height).contains(&y),
        "--at {x},{y}: the image has {width} x {height} pixels, so X goes from 0 to {} and Y from 0 to {}",
        width - 1,
        height - 1
    );
    let middle = [x, y].map(|n| n as f64 + 0.5);
    let place = shot.layout.volume_place(middle);
    place.with_context(|| {
        format!("--at {x},{y} is outside the model view, on the title, the legend or the info line")
    })
}

/// Cells before and behind the one that is taken; none where none is.
fn around(pick: &Pick) -> [usize; 2] {
    let hit = pick.hit.as_ref();
    hit.and_then(|h| pick.around(h.ijk)).unwrap_or_default()
}

/// What is told, and how numbers are shown.
struct Told<'a> {
    case: &'a Case,
    pick: &'a Pick,
    measure: Measure,
    lengths: Lengths,
    /// Of distances along the ray.
    along: Measure,
}

impl Told<'_> {
    /// A value with the digits of the files, which are those of an f32.
    fn value(&self, value: f64) -> f64 {
        let short = (self.measure.show(value) as f32).to_string();
        short.parse().unwrap_or(value)
    }

    fn facts(&self, pixel: [i64; 2]) -> Value {
        let Self { case, pick, .. } = self;
        let [before, behind] = around(pick);
        let is_dynamic = case.is_dynamic(&pick.property);
        json!({
            "pixel": pixel,
            "property": pick.property,
            "step": is_dynamic.then_some(pick.step),
            "unit": self.measure.unit,
            "length_unit": self.lengths.grid.unit,
            "map_unit": self.lengths.map.unit,
            "hit": pick.hit.as_ref().map(|hit| self.fact_of_hit(hit)),
            "well": pick.well.as_ref().map(|well| {
                json!({"name": well.name, "type": well.kind.name(), "open": well.is_open})
            }),
            "volume": pick.cube.as_ref().map(|cube| json!({
                "name": cube.name,
                "unit": cube.unit,
                "value": cube.value,
                "map": self.lengths.shown(cube.map.to_array()),
            })),
            "ray": pick.cells.iter().map(|cell| self.fact_of_cell(cell)).collect::<Vec<_>>(),
            "before": before,
            "behind": behind,
        })
    }

    fn fact_of_hit(&self, hit: &Hit) -> Value {
        let GridCell {
            grid,
            ijk: [i, j, k],
        } = self.case.grid.cell_name(hit.ijk);
        let (part, fault) = match &hit.part {
            Part::Inside => ("inside", None),
            Part::Section => ("section", None),
            Part::Face(_) => ("face", None),
            Part::Fault(fault) => ("fault", Some(self.fact_of_fault(fault))),
        };
        json!({
            "grid": grid,
            "i": i,
            "j": j,
            "k": k,
            "value": self.value(hit.value),
            "shown": self.value(hit.shown),
            "contribution": hit.contribution,
            "part": part,
            "fault": fault,
            "map": self.lengths.shown(hit.map.to_array()),
        })
    }

    fn fact_of_fault(&self, fault: &Fault) -> Value {
        let name = |cell: Ijk| self.case.grid.cell_name(cell).ijk;
        json!({
            "name": fault.name,
            "throw": self.lengths.grid.show(fault.throw),
            "near": name(fault.near),
            "far": name(fault.far),
        })
    }

    fn fact_of_cell(&self, cell: &CellOnRay) -> Value {
        let GridCell {
            grid,
            ijk: [i, j, k],
        } = self.case.grid.cell_name(cell.ijk);
        json!({
            "grid": grid,
            "i": i,
            "j": j,
            "k": k,
            "value": self.value(cell.value),
            "contribution": cell.contribution,
            "from": self.along.show(cell.from),
            "to": self.along.show(cell.to),
        })
    }

    fn text(&self, [x, y]: [i64; 2]) -> String {
        let pick = self.pick;
        if let Some(well) = &pick.well {
            return well.in_words() + "\n";
        }
        if let Some(cube) = &pick.cube {
            let value = format!("{} {} {}", cube.name, cube.value as f32, cube.unit);
            let place = self.lengths.place(cube.map.to_array());
            return format!("Volume   {}\n{place}\n", value.trim_end());
        }
        let Some(hit) = &pick.hit else {
            return match pick.cells.len() {
                0 => format!("No cell at pixel {x},{y}.\n"),
                n => {
                    format!(
                        "Nothing is seen at pixel {x},{y}: all {n} cells there are transparent.\n"
                    )
                }
            };
        };
        let unit = &self.measure.unit;
        let value = |value: f64| format!("{} {} {unit}", pick.property, self.value(value));
        let mut lines = vec![format!(
            "{}   {}",
            self.case.grid.cell_name(hit.ijk),
            value(hit.value).trim_end()
        )];
        if hit.is_between {
            let shown = value(hit.shown);
            lines.push(format!("{} at this point (interpolated)", shown.trim_end()));
        }
        lines.push(self.lengths.place(hit.map.to_array()));
        match &hit.part {
            Part::Inside => {}
            Part::Section => lines.push("On a clip plane".into()),
            Part::Face(_) => lines.push("Outer face".into()),
            Part::Fault(fault) => lines.push(fault.in_words(&self.lengths.grid)),
        }
        let [before, behind] = around(pick);
        lines.push(format!(
            "{before} in front, {behind} behind along the line of sight:"
        ));
        lines.push(String::new());
        lines.extend(self.table(before));
        lines.join("\n") + "\n"
    }

    /// The cells around the one that is taken, which has a mark.
    fn table(&self, taken: usize) -> Vec<String> {
        let pick = self.pick;
        let first = taken.saturating_sub(LISTED);
        let last = (taken + LISTED + 1).min(pick.cells.len());
        let heading = format!(
            "  {:>5} {:>5} {:>5} {:>14} {:>11}",
            "I", "J", "K", pick.property, "% of pixel"
        );
        let mut lines = vec![heading];
        let more = |n: usize| (n > 0).then(|| format!("  ... {n} more"));
        lines.extend(more(first));
        for (n, cell) in pick.cells.iter().enumerate().take(last).skip(first) {
            let GridCell {
                grid,
                ijk: [i, j, k],
            } = self.case.grid.cell_name(cell.ijk);
            let mark = if n == taken { '>' } else { ' ' };
            let line = format!(
                "{mark} {i:>5} {j:>5} {k:>5} {:>14} {:>11.1}  {grid}",
                self.value(cell.value),
                100.0 * cell.contribution
            );
            lines.push(line.trim_end().to_owned());
        }
        lines.extend(more(pick.cells.len() - last));
        lines
    }
}
