//! ROFF: the grid in map coordinates, and properties with a value for each cell.

use std::collections::BTreeSet;
use std::path::Path;

use glam::DVec3;
use strataray_parsers::roff::{Pillars, RoffGrid, RoffWriter};

use super::contents::{Contents, Exported};
use super::error::{ExportError, failed};
use super::output::Output;
use crate::view::look;

/// Writes the grid and all properties at all steps.
pub(super) fn write(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    let cells = contents.grid().dims().cells();
    let pairs = contents.pairs();
    output.expect((8 + pairs.len()) * cells);
    let grid = RoffGrid::of(&pillars(contents), origin(contents));
    let mut writer = RoffWriter::new(output.file(path)?, &grid).map_err(failed(path))?;
    output.advance(8 * cells)?;
    for (property, step) in pairs {
        if let Some(values) = contents.values(&property.name, step.unwrap_or_default())? {
            let name = name(contents, property, step);
            let written = match look::numbers_regions(contents.case, &property.name) {
                true => {
                    let whole = |v: f32| (!v.is_nan()).then_some(v as i32);
                    let values = contents.spread(values.into_iter().map(whole), None);
                    writer.discrete(&name, &codes(&values), &values)
                }
                false => writer.real(&name, &contents.spread(values, f32::NAN)),
            };
            written.map_err(failed(path))?;
        }
        output.advance(cells)?;
    }
    writer.finish().map(drop).map_err(failed(path))
}

/// Region numbers are their own names.
fn codes(values: &[Option<i32>]) -> Vec<(i32, String)> {
    let numbers: BTreeSet<i32> = values.iter().copied().flatten().collect();
    numbers.into_iter().map(|n| (n, n.to_string())).collect()
}

/// A property's name, with the date of the step where several are written: `SWAT_20010630`, or the number of the step
/// where it has no day of its own.
fn name(contents: &Contents<'_>, property: &Exported, step: Option<usize>) -> String {
    let Some(step) = step.filter(|_| contents.steps.len() > 1) else {
        return property.name.clone();
    };
    let steps = &contents.case.steps;
    let date = |n: usize| steps.get(n).map_or("", |s| s.date.as_str());
    let day = |n: usize| date(n).split(' ').next().unwrap_or_default();
    let is_alone = contents
        .steps
        .iter()
        .filter(|n| day(**n) == day(step))
        .count()
        == 1;
    match day(step) {
        day if is_alone && !day.is_empty() => format!("{}_{}", property.name, day.replace('-', "")),
        _ => format!("{}_step{step}", property.name),
    }
}

/// Pillars and depths in map coordinates.
fn pillars(contents: &Contents<'_>) -> Pillars {
    let grid = contents.grid();
    let map = contents.map_from_grid();
    let to_map = |end: DVec3| {
        let [x, y, z] = map.transform_point3(end).to_array();
        [x, y, -z]
    };
    let ends = grid.pillars().iter().flat_map(|p| [p.top, p.bottom]);
    let dims = grid.dims();
    let scale = to_map(DVec3::Z)[2];
    Pillars {
        dims: [dims.ni, dims.nj, dims.nk],
        coord: ends.flat_map(to_map).collect(),
        zcorn: grid.main_corners(|depth| scale * depth).1,
        actnum: Some(contents.actnum()),
    }
}

/// Where x and y are counted from, so that 32 bits tell millimeters: a round place that has 32 bits itself. It goes by
/// the active cells, for pillars without any lie anywhere.
fn origin(contents: &Contents<'_>) -> [f64; 2] {
    let [low, high] = contents.grid().bounds().unwrap_or_default();
    let map = contents.map_from_grid();
    let corners = [low, high, low.with_x(high.x), low.with_y(high.y)];
    let corners = corners.map(|corner| map.transform_point3(corner));
    [0, 1].map(|axis| {
        let least = corners
            .iter()
            .map(|c| c[axis])
            .fold(f64::INFINITY, f64::min);
        f64::from((1000.0 * (least / 1000.0).floor()) as f32)
    })
}
