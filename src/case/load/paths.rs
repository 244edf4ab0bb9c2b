//! From files with paths of wells to paths in the space of the grid.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use strataray_parsers::paths::{self, Vertical};
use strataray_parsers::units::LengthUnit;
use strataray_parsers::{ParseError, Warnings};

use crate::case::{About, WellPath};
use crate::model::{Grid, Spaces};

/// Wells that a note names, at most.
const MOST_NAMES: usize = 5;
/// Points of a segment at which its distance from the model is looked at.
const PLACES: usize = 8;

/// Paths as their files have them.
pub struct Files<'a>(Vec<(&'a Path, Vec<paths::WellPath>)>);

/// Reads the paths of some files.
///
/// # Errors
/// When one is not there or is damaged.
pub fn read<'a>(
    files: impl IntoIterator<Item = &'a Path>,
    about: &mut About,
    warnings: &mut Warnings,
) -> Result<Files<'a>, ParseError> {
    let mut read = Vec::new();
    for file in files {
        read.push((file, paths::read(file, warnings)?));
        about.files.push(file.to_owned());
    }
    Ok(Files(read))
}

/// The paths in the space of a grid; what of them is not near it, and what was guessed, becomes a note.
pub fn placed(files: Files<'_>, grid: &Grid, about: &mut About) -> Vec<Arc<WellPath>> {
    let mut all = Vec::new();
    for (file, wells) in files.0 {
        let first = wells.first();
        if first.is_some_and(|well| well.vertical == Vertical::ElevationBySign) {
            about.notes.push(format!(
                "{}: the third coordinate was taken as elevation, as its largest values are negative",
                file.display()
            ));
        }
        let own: Vec<_> = wells
            .into_iter()
            .map(|well| placed_one(well, file, grid, about))
            .collect();
        note_distances(&own, file, grid, about);
        all.extend(own.into_iter().map(Arc::new));
    }
    all
}

fn placed_one(well: paths::WellPath, file: &Path, grid: &Grid, about: &About) -> WellPath {
    let spaces = Spaces::new(grid.map_axes(), 1.0);
    // What a file says in meters may be of a grid in feet.
    let factor = |unit: &str| {
        let known = well.unit.zip(LengthUnit::from_name(unit));
        known.map_or(1.0, |(from, to)| from.meters() / to.meters())
    };
    let [on_map, down] = [&about.map_unit, &about.length_unit].map(|unit| factor(unit));
    let in_grid = |point: &[f64; 3]| {
        let map = DVec3::from_array(*point) * DVec3::new(on_map, on_map, down);
        let world = spaces.world_from_map(map);
        spaces.grid_from_world.transform_point3(world)
    };
    let points: Vec<DVec3> = well.points.iter().map(in_grid).collect();
    WellPath {
        crossings: grid.crossed_by(&points),
        name: well.name,
        file: file.to_owned(),
        vertical: well.vertical.in_words(),
        points,
        measured: well.measured,
    }
}

/// Notes which paths of a file go through no cell, and how far away they are.
fn note_distances(paths: &[WellPath], file: &Path, grid: &Grid, about: &mut About) {
    let Some(bounds) = grid.bounds() else {
        return;
    };
    let diagonal = bounds[0].distance(bounds[1]);
    let outside = paths.iter().filter(|path| path.crossings.is_empty());
    let outside: Vec<_> = outside
        .map(|path| (path, distance(&path.points, bounds)))
        .collect();
    let (far, near): (Vec<_>, Vec<_>) = outside.into_iter().partition(|(_, away)| *away > diagonal);
    let names = |of: &[(&WellPath, f64)]| {
        let mut names: Vec<String> = of.iter().map(|(path, _)| path.name.clone()).collect();
        let more = names.len().saturating_sub(MOST_NAMES);
        if more > 0 {
            names.truncate(MOST_NAMES);
            names.push(format!("{more} more"));
        }
        names.join(", ")
    };
    if let Some(nearest) = far.iter().map(|(_, away)| *away).reduce(f64::min) {
        let hint = match fits_the_grid(&far, grid, bounds) {
            true => "the numbers are near those of the grid itself, without MAPAXES",
            false => "different coordinate systems or units?",
        };
        about.notes.push(format!(
            "{}: the paths of {} lie {} from the model and are not drawn: {hint}",
            file.display(),
            names(&far),
            in_words(nearest, &about.length_unit)
        ));
    }
    if !near.is_empty() {
        about.notes.push(format!(
            "{}: the paths of {} go through no active cell",
            file.display(),
            names(&near)
        ));
    }
}

/// True where the numbers of paths, taken for those of the grid itself, are near it.
fn fits_the_grid(far: &[(&WellPath, f64)], grid: &Grid, bounds: [DVec3; 2]) -> bool {
    let spaces = Spaces::new(grid.map_axes(), 1.0);
    let as_written = |point: &DVec3| {
        let world = spaces.world_from_grid.transform_point3(*point);
        spaces.map_from_world(world)
    };
    let diagonal = bounds[0].distance(bounds[1]);
    grid.map_axes().is_some()
        && far.iter().any(|(path, _)| {
            let points: Vec<DVec3> = path.points.iter().map(as_written).collect();
            distance(&points, bounds) <= diagonal
        })
}

/// Smallest distance of a line from a box.
fn distance(points: &[DVec3], [low, high]: [DVec3; 2]) -> f64 {
    let away = |p: DVec3| p.distance(p.clamp(low, high));
    let on_segment = |ends: &[DVec3]| {
        let places = (0..=PLACES).map(|n| ends[0].lerp(ends[1], n as f64 / PLACES as f64));
        places.map(away).fold(f64::INFINITY, f64::min)
    };
    let segments = points.windows(2).map(on_segment);
    segments.fold(f64::INFINITY, f64::min)
}

/// A length such as `450 km`, in the unit of a grid.
fn in_words(length: f64, unit: &str) -> String {
    let short = LengthUnit::from_name(unit).map_or("", LengthUnit::short);
    match short {
        "M" if length >= 1e4 => format!("{:.0} km", length / 1e3),
        "M" => format!("{length:.0} m"),
        "FT" => format!("{length:.0} ft"),
        _ => format!("{length:.0} {}", short.to_lowercase()),
    }
}
