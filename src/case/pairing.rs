//! Which cells and steps of two cases on one grid belong together.

use std::collections::HashSet;
use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;

use super::{Case, CaseError, Step};
use crate::model::{Dims, Grid, Ijk};

/// Days within which two moments are one: files round the time of day.
const ONE_MOMENT: f64 = 1.0 / 1440.0;
/// Corners are in one place where they are less than this part of the model's diagonal apart.
const ONE_PLACE: f64 = 1e-5;
/// Steps that a note names.
const NAMED: usize = 3;

/// The cells and steps of a case, and those of another one that they are compared with.
pub struct Pairing {
    /// The active index in the other case of each active cell; `None` where all are the same.
    places: Option<Vec<Option<u32>>>,
    /// The step of the other case that is of the same date, for each step.
    pub steps: Vec<Option<usize>>,
    /// Which steps have no match, in one sentence.
    pub lacks: Option<String>,
    /// How many cells only one of the cases has, one sentence each.
    pub notes: Vec<String>,
}

impl Pairing {
    /// Of two cases, called by `names` in sentences.
    ///
    /// # Errors
    /// When the grids differ in more than which cells are active; the sentence says in what.
    pub fn of(a: &Case, b: &Case, names: [&str; 2]) -> Result<Self, String> {
        if let Some(differs) = difference_of_grids(a, b, names) {
            return Err(format!(
                "{differs}: values are compared cell by cell on equal grids"
            ));
        }
        let steps: Vec<_> = a.steps.iter().map(|s| of_date(s, &b.steps)).collect();
        let mut notes = Vec::new();
        let places = places(&a.grid, &b.grid);
        if let Some(places) = &places {
            let common = places.iter().flatten().count();
            let alone = [places.len(), b.grid.active_cells().len()].map(|n| n - common);
            for (count, [here, there]) in alone.into_iter().zip([names, [names[1], names[0]]]) {
                if count > 0 {
                    notes.push(format!(
                        "{count} cells are active in {here} and not in {there}: they are left out"
                    ));
                }
            }
        }
        Ok(Self {
            places,
            lacks: missing_steps(a, &steps, names),
            steps,
            notes,
        })
    }

    /// The value in the other case of an active cell; not a number where that has none.
    pub fn value(&self, values: &[f32], active: usize) -> f32 {
        let place = match &self.places {
            None => Some(active),
            Some(places) => places[active].map(|n| n as usize),
        };
        let value = place.and_then(|n| values.get(n));
        value.copied().unwrap_or(f32::NAN)
    }
}

/// The step of the same date and time of day, or of as many days where dates are missing.
pub fn of_date(step: &Step, steps: &[Step]) -> Option<usize> {
    steps
        .iter()
        .position(|other| apart(step, other) < ONE_MOMENT)
}

/// The step whose date is nearest; `None` where there are no steps.
pub fn nearest(step: &Step, steps: &[Step]) -> Option<usize> {
    let all = steps.iter().enumerate();
    all.min_by(|a, b| apart(step, a.1).total_cmp(&apart(step, b.1)))
        .map(|(n, _)| n)
}

/// Days between two steps.
fn apart(a: &Step, b: &Step) -> f64 {
    match (a.moment(), b.moment()) {
        (Some(a), Some(b)) => (a - b).abs(),
        _ => (a.days - b.days).abs(),
    }
}

/// Why a step has no values: the other case has none of its date.
pub fn no_step(step: &Step, other: &str) -> CaseError {
    CaseError::NoStepOfDate {
        case: other.to_owned(),
        date: step.when(),
    }
}

fn missing_steps(a: &Case, steps: &[Option<usize>], names: [&str; 2]) -> Option<String> {
    let pairs = a.steps.iter().zip(steps);
    let missing: Vec<String> = pairs
        .filter(|(_, other)| other.is_none())
        .map(|(step, _)| step.when())
        .collect();
    let more = match missing.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let named: Vec<_> = missing.iter().take(NAMED).cloned().collect();
    (!missing.is_empty()).then(|| {
        format!(
            "{} of {} steps of {} have no step of the same date in {} ({}{more})",
            missing.len(),
            steps.len(),
            names[0],
            names[1],
            named.join(", ")
        )
    })
}

/// The active index in `b` of each active cell of `a`; `None` where they are the same.
fn places(a: &Grid, b: &Grid) -> Option<Vec<Option<u32>>> {
    let cells = a.active_cells();
    (cells != b.active_cells()).then(|| {
        let place = |cell: &_| b.active_index(*cell).map(|active| active.0);
        cells.iter().map(place).collect()
    })
}

/// In what two grids differ beside which cells are active, as a part of a sentence.
fn difference_of_grids(a: &Case, b: &Case, [of_a, of_b]: [&str; 2]) -> Option<String> {
    let [x, y] = [a, b].map(|case| case.grid.main_dims());
    if x != y {
        let [x, y] = [x, y].map(|Dims { ni, nj, nk }| format!("{ni} x {nj} x {nk}"));
        return Some(format!("{of_a} has {x} cells and {of_b} has {y}"));
    }
    let units = [a, b].map(|case| case.about.length_unit.as_str());
    if units[0] != units[1] {
        let [x, y] = units;
        return Some(format!(
            "the grid of {of_a} is in {x} and that of {of_b} in {y}"
        ));
    }
    let [x, y] = [a, b].map(|case| case.grid.in_map_space());
    if x.shares_geometry(y) {
        return None;
    }
    if x.patches() != y.patches() {
        return Some(format!("{of_a} and {of_b} have other local grids"));
    }
    let (distance, cell) = farthest_corner(x, y)?;
    let size = x.bounds().map_or(0.0, |[low, high]| low.distance(high));
    let largest = x
        .bounds()
        .map_or(0.0, |[low, high]| low.abs().max(high.abs()).max_element());
    // Coordinates of files are 32-bit numbers.
    let is_same = distance <= ONE_PLACE * size + largest * f64::from(f32::EPSILON);
    (!is_same).then(|| {
        format!(
            "the corners of cell {} lie up to {distance:.3} {} apart in {of_a} and {of_b}",
            x.cell_name(cell),
            units[0]
        )
    })
}

/// The largest distance between corners of a cell that is active in both grids, and which cell that is.
fn farthest_corner(a: &Grid, b: &Grid) -> Option<(f64, Ijk)> {
    let cells = a.active_by_column().filter(|cell| b.is_active(*cell));
    let distance = |cell: Ijk| {
        let pairs = a.hexahedron(cell).0.into_iter().zip(b.hexahedron(cell).0);
        let distances = pairs.map(|(x, y): (DVec3, DVec3)| x.distance(y));
        (distances.fold(0.0, f64::max), cell)
    };
    cells
        .map(distance)
        .max_by(|x, y| x.0.total_cmp(&y.0).then(cell_order(y.1, x.1)))
}

/// The first of equal ones is told, whatever the threads.
fn cell_order(a: Ijk, b: Ijk) -> std::cmp::Ordering {
    [a.k, a.j, a.i].cmp(&[b.k, b.j, b.i])
}

/// Names of cases by which they can be told apart: of several with one name, with the folder in which they differ.
pub fn distinct_names(cases: &[&Case]) -> Vec<String> {
    let name = |case: &Case| case.about.name.clone();
    let of = |case: &&Case| {
        let alike: Vec<&&Case> = cases.iter().filter(|c| name(c) == name(case)).collect();
        match alike.len() {
            1 => name(case),
            _ => match telling_folder(case, &alike) {
                Some(folder) => format!("{folder}/{}", name(case)),
                None => name(case),
            },
        }
    };
    let names: Vec<String> = cases.iter().map(of).collect();
    let is_told = names.iter().collect::<HashSet<_>>().len() == names.len();
    let numbered = names.iter().enumerate();
    match is_told {
        true => names,
        false => numbered
            .map(|(n, name)| format!("{name} #{}", n + 1))
            .collect(),
    }
}

/// The folder nearest to a case's file that is not the same for all of some cases.
fn telling_folder(case: &Case, alike: &[&&Case]) -> Option<String> {
    let folders = |case: &Case| -> Vec<String> {
        let file = case.about.files.first();
        let whole = file.and_then(|file| std::path::absolute(file).ok());
        let above = whole.as_deref().into_iter().flat_map(Path::ancestors);
        let names = above.skip(1).filter_map(Path::file_name);
        names.map(|n| n.to_string_lossy().into_owned()).collect()
    };
    let own = folders(case);
    let others: Vec<Vec<String>> = alike.iter().map(|case| folders(case)).collect();
    let differs = |n: &usize| others.iter().any(|other| other.get(*n) != own.get(*n));
    let level = (0..own.len()).find(differs)?;
    own.into_iter().nth(level)
}
