//! `strataray info`: what a case holds, for people or as JSON.

use std::path::PathBuf;

use rayon::prelude::*;
use serde_json::{Map, Value, json};
use strataray::case::{
    Case, Connection, Kind, Measure, NamedFault, Property, Statistic, Vector, VectorKind, WellPath,
};
use strataray::model::{CellField, Crossing, Grid, Ijk, MapAxes, Spaces, Statistics};
use strataray::scene::Units;

use super::Verbosity;
use super::choice::{UNITS, one_of};
use super::progress::Reporter;
use super::scene_options::AddedFiles;

#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  strataray info REEK.EGRID --json --stats PORO --stats SWAT@last
  strataray info REEK.EGRID --wells --with wells.dev
  strataray info real-0/REEK --ensemble real-1/REEK real-2/REEK --stats SWAT.MEAN@2001-06-30"
)]
pub struct Arguments {
    /// Any file of the case, or its base name.
    case: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Statistics of a property, of dynamic ones at a step (default last).
    #[arg(long, value_name = "NAME[@STEP]")]
    stats: Vec<String>,
    /// Units of lengths, volumes and statistics.
    #[arg(long, value_parser = one_of(&UNITS), default_value = "file")]
    units: Units,
    /// Wells at each step: type, open or shut, connected cells; cells on paths.
    #[arg(long)]
    wells: bool,
    /// Summary vectors by name.
    #[arg(long)]
    summary: bool,
    #[command(flatten)]
    added: AddedFiles,
    #[command(flatten)]
    verbosity: Verbosity,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let reporter = Reporter::new(arguments.verbosity);
    let case = arguments.added.open_case(&arguments.case, &reporter)?;
    let shown = Shown::of(&case, arguments.units);
    let mut facts = facts(&shown, &arguments.stats)?;
    if arguments.wells {
        facts["wells"] = wells(&case)?;
        let paths = case.about.paths.iter();
        facts["paths"] = paths.map(|path| with_cells(path, &case.grid)).collect();
    }
    let vectors = match arguments.summary {
        true => Some(vectors(&case, &reporter)?),
        false => None,
    };
    if let Some(vectors) = &vectors {
        facts["summary"] = vectors.iter().map(|v| json!(v.name)).collect();
    }
    if arguments.json {
        say_line!("{}", serde_json::to_string_pretty(&facts)?);
    } else {
        print_text(&shown, &facts);
        if arguments.wells {
            print_wells(&case)?;
        }
        print_vectors(&vectors.unwrap_or_default());
    }
    Ok(())
}

/// The vectors of the case, none where it has no summary; says what was odd about them.
fn vectors(case: &Case, reporter: &Reporter) -> anyhow::Result<Vec<Vector>> {
    let Some(vectors) = case.vectors()? else {
        reporter.note("this case has no summary: there is no SMSPEC or ESMRY beside it");
        return Ok(Vec::new());
    };
    for note in &vectors.notes {
        reporter.note(note);
    }
    Ok(vectors.list.clone())
}

/// A line for each kind of vectors.
fn print_vectors(vectors: &[Vector]) {
    for kind in VectorKind::ALL {
        let of_kind = vectors.iter().filter(|v| v.kind == kind);
        let names: Vec<_> = of_kind.map(|v| v.name.as_str()).collect();
        if !names.is_empty() {
            say_line!("  {} vectors: {}", kind.name(), names.join(" "));
        }
    }
}

/// Each well with its steps; cells count from 1.
fn wells(case: &Case) -> anyhow::Result<Value> {
    let mut wells: Vec<(String, Vec<Value>)> = Vec::new();
    // A case without steps has wells too.
    for index in 0..case.steps.len().max(1) {
        for well in case.wells(index)?.iter() {
            let mut step = json!({
                "index": index,
                "type": well.kind.name(),
                "open": well.is_open,
                "connections": well.connections.iter().map(connection).collect::<Vec<_>>(),
            });
            if !well.targets.is_empty() {
                let targets = well.targets.iter();
                let targets = targets.map(|(name, value)| ((*name).to_owned(), json!(value)));
                step["targets"] = targets.collect::<Map<_, _>>().into();
            }
            match wells.iter_mut().find(|(name, _)| *name == well.name) {
                Some((_, steps)) => steps.push(step),
                None => wells.push((well.name.clone(), vec![step])),
            }
        }
    }
    let entries = wells.iter();
    Ok(entries
        .map(|(name, steps)| json!({"name": name, "steps": steps}))
        .collect())
}

fn connection(connection: &Connection) -> Value {
    let cell = connection.cell;
    json!({
        "grid": connection.grid.as_deref().unwrap_or_default(),
        "i": cell.i + 1,
        "j": cell.j + 1,
        "k": cell.k + 1,
        "open": connection.is_open,
    })
}

/// A path; measured depths are those of its ends.
fn path(path: &WellPath) -> Value {
    let measured = path.measured.as_deref().unwrap_or_default();
    json!({
        "name": path.name,
        "file": path.file.display().to_string(),
        "points": path.points.len(),
        "md": measured.first().zip(measured.last()).map(|(a, b)| [a, b]),
        "z": path.vertical,
        "cells": path.crossings.len(),
    })
}

/// A path with the cells that it goes through, in its order.
fn with_cells(of: &WellPath, grid: &Grid) -> Value {
    let mut told = path(of);
    let cell = |crossing: &Crossing| {
        let cell = grid.cell_name(crossing.cell);
        let [i, j, k] = cell.ijk;
        json!({"grid": cell.grid, "i": i, "j": j, "k": k})
    };
    told["on_path"] = of.crossings.iter().map(cell).collect();
    told
}

/// A line for each well of the last step.
fn print_wells(case: &Case) -> anyhow::Result<()> {
    for well in case.wells(case.steps.len().saturating_sub(1))?.iter() {
        let open = well.connections.iter().filter(|c| c.is_open).count();
        let state = match well.connections.len() {
            0 => well.in_words(),
            all => format!("{}, {open} of {all} connections open", well.in_words()),
        };
        say_line!("  well {}: {state}", well.name);
    }
    Ok(())
}

/// A case, and how its numbers are shown.
struct Shown<'a> {
    case: &'a Case,
    units: Units,
    length: Measure,
    map_length: Measure,
    volume: Measure,
}

impl<'a> Shown<'a> {
    fn of(case: &'a Case, units: Units) -> Self {
        Self {
            case,
            units,
            length: case.length(units.into()),
            map_length: case.map_length(units.into()),
            volume: case.measure("CELL_VOLUME", units.into()),
        }
    }

    fn measure(&self, property: &str) -> Measure {
        self.case.measure(property, self.units.into())
    }

    /// Statistics of a property as they are shown.
    fn statistics(&self, property: &str, found: Option<Statistics>) -> Option<Statistics> {
        let measure = self.measure(property);
        found.map(|s| Statistics {
            min: measure.show(s.min),
            max: measure.show(s.max),
            mean: measure.show(s.mean),
            ..s
        })
    }
}

fn facts(shown: &Shown<'_>, stats: &[String]) -> anyhow::Result<Value> {
    let case = shown.case;
    let grid = &case.grid;
    let dims = grid.main_dims();
    let faults = grid.fault_faces();
    let Shape {
        active,
        bounds,
        volume: signed,
        thin,
    } = Shape::of(grid, 0, shown);
    let mut facts = json!({
        "case": case.about.name,
        "files": case.about.files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>(),
        "dims": [dims.ni, dims.nj, dims.nk],
        "cells": dims.cells(),
        "active": active,
        "units": shown.length.unit,
        "map_axes": case.about.map_axes,
        "handedness": if signed < 0.0 { "left" } else { "right" },
        "bounds": bounds,
        "bulk_volume": shown.volume.show(signed.abs()),
        "thin_cells": thin,
        "fault_faces": {
            "i": faults[0],
            "j": faults[1],
            "named": case.about.named_faults.iter().map(named_fault).collect::<Vec<_>>(),
        },
        "nnc": case.about.nnc,
        "lgr": local_numbers(grid).map(|n| local_grid(shown, n)).collect::<Vec<_>>(),
        "porosity_model": case.about.porosity_model,
        "properties": case.properties.iter().map(|p| property(shown, p)).collect::<Vec<_>>(),
        "steps": case.steps.iter().enumerate().map(|(index, s)| {
            json!({"index": index, "report": s.report, "date": s.date, "days": s.days})
        }).collect::<Vec<_>>(),
        "wells": case.about.wells,
        "paths": case.about.paths.iter().map(|p| path(p)).collect::<Vec<_>>(),
        "notes": case.about.notes,
    });
    if shown.units != Units::File {
        facts["unit_system"] = json!(shown.units);
    }
    if let Some(unit) = &case.about.time_unit {
        facts["time_unit"] = json!(unit);
    }
    if let Some(axes) = grid.map_axes() {
        facts["map_units"] = json!(shown.map_length.unit);
        facts["map_bounds"] = map_bounds(shown, axes);
    }
    let mut statistics = vec![serde_json::Map::new(); grid.patches().len()];
    for asked in stats {
        // A difference has a step of its own in its name.
        let at_step = asked
            .rsplit_once('@')
            .filter(|(name, _)| !name.contains('-'));
        let (name, step) = match at_step {
            Some((name, step)) => (name, case.step(step)?),
            None => (asked.as_str(), case.step("last")?),
        };
        let field = case.field(name, step)?;
        for (patch, statistics) in statistics.iter_mut().enumerate() {
            let found = shown.statistics(name, statistics_in(grid, patch, &field));
            statistics.insert(asked.clone(), json!(found));
        }
    }
    // Each local grid behind the main one.
    let numbers = std::iter::once(0).chain(local_numbers(grid));
    for (place, patch) in numbers.enumerate() {
        let statistics = std::mem::take(&mut statistics[patch]);
        if !stats.is_empty() {
            let of = match place {
                0 => &mut facts,
                local => &mut facts["lgr"][local - 1],
            };
            of["stats"] = Value::Object(statistics);
        }
    }
    Ok(facts)
}

/// The numbers of the local grids; reservoirs are parts of the main one.
fn local_numbers(grid: &Grid) -> impl Iterator<Item = usize> + '_ {
    (1..grid.patches().len()).filter(|number| grid.patches()[*number].layers.is_none())
}

/// Statistics of a property in the active cells of a grid.
fn statistics_in(grid: &Grid, patch: usize, field: &CellField) -> Option<Statistics> {
    if grid.patches().len() == 1 {
        return field.statistics();
    }
    let cells = grid.active_cells().iter().map(|c| grid.dims().ijk(*c));
    let counts = cells.map(|cell| grid.is_first(cell) && is_in(grid, cell, patch));
    let counts: Vec<bool> = counts.collect();
    field.statistics_of(Some(&counts))
}

/// True where a cell is of a grid; the main one has its reservoirs too.
fn is_in(grid: &Grid, cell: Ijk, patch: usize) -> bool {
    let of_main = |number: &usize| grid.patches()[*number].layers.is_some();
    let number = grid.patch_of(cell);
    number.map(|n| if of_main(&n) { 0 } else { n }) == Some(patch)
}

/// What the active cells of a grid span.
struct Shape {
    active: usize,
    bounds: Value,
    volume: f64,
    thin: usize,
}

impl Shape {
    fn of(grid: &Grid, patch: usize, shown: &Shown<'_>) -> Self {
        let is_one = grid.patches().len() == 1;
        let cells = grid.active_by_column();
        let cells: Vec<Ijk> = cells.filter(|c| is_one || is_in(grid, *c, patch)).collect();
        let volume = match is_one {
            true => grid.signed_bulk_volume(),
            false => cells
                .iter()
                .map(|c| grid.hexahedron(*c).signed_volume())
                .sum(),
        };
        let bounds = grid.bounds_of(cells.par_iter().copied());
        Self {
            active: cells.iter().filter(|c| grid.is_first(**c)).count(),
            bounds: json!(bounds.map(|ends| {
                let ends = ends.map(|end| end.to_array().map(|v| shown.length.show(v)));
                json!({"min": ends[0], "max": ends[1]})
            })),
            volume,
            thin: cells
                .par_iter()
                .filter(|c| !grid.has_thickness(**c))
                .count(),
        }
    }
}

/// A local grid; its bounds and volume are those of the cells that are drawn.
fn local_grid(shown: &Shown<'_>, number: usize) -> Value {
    let grid = &shown.case.grid;
    let patch = &grid.patches()[number];
    let dims = patch.file_dims();
    let shape = Shape::of(grid, number, shown);
    let mut hosts: Vec<Ijk> = grid.hosts_of(number).map(|(_, host)| host).collect();
    hosts.sort_unstable_by_key(|host| grid.dims().cell(*host));
    hosts.dedup();
    json!({
        "name": patch.name,
        "parent": grid.patches()[patch.parent].name,
        "dims": [dims.ni, dims.nj, dims.nk],
        "active": shape.active,
        "bounds": shape.bounds,
        "bulk_volume": shown.volume.show(shape.volume.abs()),
        "cells_replaced": hosts.len(),
    })
}

fn named_fault(fault: &NamedFault) -> Value {
    let mut entry = json!({"name": fault.name, "faces": fault.faces});
    if let Some(multiplier) = fault.multiplier {
        entry["multiplier"] = json!(multiplier);
    }
    entry
}

fn property(shown: &Shown<'_>, property: &Property) -> Value {
    let mut entry = json!({
        "name": property.name,
        "kind": property.kind,
        "unit": shown.measure(&property.name).unit,
        "values": "active",
    });
    if property.kind == Kind::Dynamic {
        entry["steps"] = json!(property.steps);
    }
    if let Some(formula) = property.formula() {
        entry["formula"] = json!(formula);
    }
    if let Some(doubt) = &property.doubt {
        entry["doubt"] = json!(doubt);
    }
    entry
}

/// Bounds of the active cells in map coordinates; depth stays positive down.
fn map_bounds(shown: &Shown<'_>, axes: MapAxes) -> Value {
    let spaces = Spaces::new(Some(axes), 1.0);
    let grid = &shown.case.grid;
    let cells = grid.active_by_column();
    let corners = cells.filter(|c| is_in(grid, *c, 0)).flat_map_iter(|cell| {
        let corners = grid.hexahedron(cell).0;
        corners.map(|c| {
            let world = spaces.world_from_grid.transform_point3(c);
            spaces.map_from_world(world).to_array()
        })
    });
    let bounds = corners.map(|c| [c, c]).reduce_with(|a, b| {
        [
            std::array::from_fn(|n| a[0][n].min(b[0][n])),
            std::array::from_fn(|n| a[1][n].max(b[1][n])),
        ]
    });
    let [across, depth] = [&shown.map_length, &shown.length];
    let place = |[x, y, z]: [f64; 3]| [across.show(x), across.show(y), depth.show(z)];
    bounds.map_or(
        Value::Null,
        |[a, b]| json!({"min": place(a), "max": place(b)}),
    )
}

fn print_text(shown: &Shown<'_>, facts: &Value) {
    let case = shown.case;
    let dims = case.grid.main_dims();
    say_line!("{}", case.about.name);
    say_line!(
        "  {} x {} x {} = {} cells, {} active",
        dims.ni,
        dims.nj,
        dims.nk,
        dims.cells(),
        facts["active"]
    );
    say_line!(
        "  length unit {}, bulk volume {:.6e} {}, {}-handed",
        shown.length.unit,
        facts["bulk_volume"].as_f64().unwrap_or_default(),
        shown.volume.unit,
        facts["handedness"].as_str().unwrap_or_default()
    );
    if let Some(bounds) = facts.get("map_bounds") {
        let end = |end: &str, n: usize| bounds[end][n].as_f64().unwrap_or_default();
        let range = |n: usize| format!("{:.2} to {:.2}", end("min", n), end("max", n));
        let unit = &shown.map_length.unit;
        say_line!(
            "  easting {} {unit}, northing {} {unit}",
            range(0),
            range(1)
        );
    }
    say_line!(
        "  fault faces {} along i, {} along j; {} non-neighbor connections",
        facts["fault_faces"]["i"],
        facts["fault_faces"]["j"],
        case.about.nnc
    );
    for grid in facts["lgr"].as_array().into_iter().flatten() {
        let text = |key: &str| grid[key].as_str().unwrap_or_default();
        let parent = match text("parent") {
            "" => "the main grid",
            name => name,
        };
        say_line!(
            "  local grid {}: {} x {} x {}, {} active, in place of {} cells of {parent}",
            text("name"),
            grid["dims"][0],
            grid["dims"][1],
            grid["dims"][2],
            grid["active"],
            grid["cells_replaced"]
        );
    }
    for kind in [Kind::Static, Kind::Dynamic, Kind::Derived] {
        let names: Vec<_> = case
            .properties
            .iter()
            .filter(|p| p.kind == kind && !is_of_cases(case, &p.name))
            .map(|p| p.name.as_str())
            .collect();
        if !names.is_empty() {
            say_line!("  {kind:?}: {}", names.join(" "));
        }
    }
    print_cases(case);
    print_notes(case);
    if let Some(stats) = facts.get("stats").and_then(Value::as_object) {
        for (name, s) in stats {
            say_line!(
                "  {name}: min {} max {} mean {} undefined {}",
                s["min"],
                s["max"],
                s["mean"],
                s["undefined"]
            );
        }
    }
}

/// True of what is found of several cases.
fn is_of_cases(case: &Case, name: &str) -> bool {
    case.statistic(name).is_some() || case.minus.iter().any(|m| m.name == name)
}

/// The cases of which there are differences or statistics, and how these are called.
fn print_cases(case: &Case) {
    if let Some(minus) = case.minus.first() {
        let of: Vec<&str> = case.minus.iter().map(|m| m.now.as_str()).collect();
        say_line!(
            "  differences (such as {}) of: {}",
            minus.name,
            of.join(" ")
        );
    }
    let Some(ensemble) = &case.ensemble else {
        return;
    };
    say_line!("  cases: {}", ensemble.members.join(" "));
    let endings = Statistic::ALL.map(|(_, ending, _)| format!(".{ending}"));
    let of = case.properties.iter().filter_map(|p| {
        let (of, statistic) = case.statistic(&p.name)?;
        (statistic == Statistic::Mean).then_some(of)
    });
    let of: Vec<&str> = of.collect();
    say_line!("  statistics ({}) of: {}", endings.join(" "), of.join(" "));
}

/// What is known of properties, faults, steps and wells, by name.
fn print_notes(case: &Case) {
    for property in &case.properties {
        if let Some(formula) = property.formula() {
            say_line!("  {} = {formula}", property.name);
        }
        if let Some(doubt) = &property.doubt {
            say_line!("  {}: {doubt}", property.name);
        }
    }
    for fault in &case.about.named_faults {
        let multiplier = fault.multiplier.map(|m| format!(", multiplier {m}"));
        say_line!(
            "  fault {}: {} faces{}",
            fault.name,
            fault.faces,
            multiplier.unwrap_or_default()
        );
    }
    for (index, step) in case.steps.iter().enumerate() {
        say_line!(
            "  step {index}: report {}, {}, {} days",
            step.report,
            step.date,
            step.days
        );
    }
    if !case.about.wells.is_empty() {
        say_line!("  wells: {}", case.about.wells.join(" "));
    }
    for path in &case.about.paths {
        let file = path.file.file_name().unwrap_or_default().to_string_lossy();
        say_line!(
            "  path {}: {} points through {} cells, {} taken from {file}",
            path.name,
            path.points.len(),
            path.crossings.len(),
            path.vertical
        );
    }
}
