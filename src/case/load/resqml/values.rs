//! Properties of a package, under the names that they are shown by, and the steps of its time series.

use std::path::{Path, PathBuf};

use strataray_parsers::ParseError;
use strataray_parsers::calendar;
use strataray_parsers::resqml::{IjkGrid, Package, Property as FileProperty};

use crate::case::{Kind, Property, Step};

/// Values in the order of layers from the top.
pub(super) fn turned<T: Copy>([ni, nj, _]: [usize; 3], is_upward: bool, values: &[T]) -> Vec<T> {
    match is_upward {
        true => values.chunks(ni * nj).rev().flatten().copied().collect(),
        false => values.to_vec(),
    }
}

/// The properties of the grid of a package, whose values are read when they are asked for.
pub struct PackageValues {
    package: Package,
    dims: [usize; 3],
    is_upward: bool,
    steps: Vec<Step>,
    /// Which properties of the package are known by which name, and at which step.
    named: Vec<Named>,
    /// Of the property that says which cells are active.
    active: Option<usize>,
}

struct Named {
    name: String,
    unit: String,
    step: Option<usize>,
    property: usize,
}

impl PackageValues {
    pub(super) fn of(
        package: Package,
        grid: &str,
        geometry: &IjkGrid,
        notes: &mut Vec<String>,
    ) -> Self {
        let properties = package.properties().iter().enumerate();
        let own: Vec<(usize, &FileProperty)> = properties.filter(|(_, p)| p.grid == grid).collect();
        let others = package.properties().len() - own.len();
        if others > 0 && package.grids().len() == 1 {
            notes.push(format!(
                "{others} properties are not of the grid that is shown"
            ));
        }
        let is_active = |(_, p): &&(usize, &FileProperty)| {
            p.kind.eq_ignore_ascii_case("active") && p.time.is_none()
        };
        let active = own.iter().find(is_active).map(|(n, _)| *n);
        let series = series_of(&package, &own, notes);
        let steps = series.map_or_else(Vec::new, |n| steps(&package.series()[n].times));
        let series = series.map(|n| package.series()[n].uuid.as_str());
        let own = own.into_iter().filter(|(n, _)| Some(*n) != active);
        let mut named: Vec<Named> = Vec::new();
        for (number, property) in own {
            let step = property.time.as_ref().map(|time| time.index);
            let is_of_other = property
                .time
                .as_ref()
                .is_some_and(|t| Some(t.series.as_str()) != series);
            if is_of_other || step.is_some_and(|step| step >= steps.len()) {
                continue;
            }
            named.push(Named {
                name: free_name(&named, property, step),
                unit: unit(&property.unit),
                step,
                property: number,
            });
        }
        Self {
            dims: geometry.dims,
            is_upward: geometry.is_upward,
            steps,
            named,
            active,
            package,
        }
    }

    /// The files that arrays are in.
    pub fn array_files(&self) -> Vec<PathBuf> {
        self.package.array_files().map(Path::to_owned).collect()
    }

    /// The steps of the time series.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Leaves out all that changes with time, because results have steps of their own; the sentence says so.
    pub fn drop_steps(&mut self) -> Option<String> {
        self.steps.clear();
        let before = self.named.len();
        self.named.retain(|named| named.step.is_none());
        (self.named.len() < before)
            .then(|| "what changes with time in the package is not shown: the restart has steps of its own".into())
    }

    /// True where there is a property of that name.
    pub fn has(&self, name: &str) -> bool {
        self.named.iter().any(|named| named.name == name)
    }

    /// All properties in the order of the package.
    pub fn properties(&self) -> Vec<Property> {
        let mut list: Vec<Property> = Vec::new();
        for named in &self.named {
            let at_step = usize::from(named.step.is_some());
            match list.iter_mut().find(|p| p.name == named.name) {
                Some(known) => known.steps += at_step,
                None => {
                    let kind = match named.step {
                        Some(_) => Kind::Dynamic,
                        None => Kind::Static,
                    };
                    list.push(Property {
                        steps: at_step,
                        ..Property::new(&named.name, kind, &named.unit)
                    });
                }
            }
        }
        list
    }

    /// The values of all cells; `None` where the property has none at the step.
    pub fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, ParseError> {
        let is_it = |n: &&Named| n.name == name && n.step.is_none_or(|s| s == step);
        let Some(named) = self.named.iter().find(is_it) else {
            return Ok(None);
        };
        let property = &self.package.properties()[named.property];
        let values = self.package.values(property, self.dims)?;
        let values: Vec<f32> = values.iter().map(|v| *v as f32).collect();
        Ok(Some(turned(self.dims, self.is_upward, &values)))
    }

    /// Which cells are active by the property that says so.
    pub(super) fn active(&self, dims: [usize; 3], notes: &mut Vec<String>) -> Option<Vec<bool>> {
        let property = &self.package.properties()[self.active?];
        match self.package.values(property, dims) {
            Ok(values) => {
                let is_active: Vec<bool> = values.iter().map(|v| *v > 0.0).collect();
                Some(turned(dims, self.is_upward, &is_active))
            }
            Err(error) => {
                notes.push(format!("which cells are active was not read: {error}"));
                None
            }
        }
    }
}

/// A unit as it is shown: none where both sides of a ratio are the same.
fn unit(uom: &str) -> String {
    match uom.split_once('/') {
        Some((a, b)) if a == b => String::new(),
        None if uom == "Euc" => String::new(),
        _ => uom.to_owned(),
    }
}

/// The title of a property, with its facets or a number where another one has it at the same time.
fn free_name(named: &[Named], property: &FileProperty, step: Option<usize>) -> String {
    let is_free = |name: &String| {
        // What changes with time and what does not are two properties.
        let mut others = named.iter().filter(|n| n.name.eq_ignore_ascii_case(name));
        !others.any(|n| n.step == step || n.step.is_none() || step.is_none())
    };
    let title = match property.title.trim() {
        "" => property.kind.clone(),
        title => title.to_owned(),
    };
    let with_facets = match &property.facets[..] {
        [] => None,
        facets => Some(format!("{title} {}", facets.join(" "))),
    };
    let base = with_facets.clone().unwrap_or_else(|| title.clone());
    let numbered = (2..).map(|n| format!("{base} {n}"));
    let mut names = std::iter::once(title).chain(with_facets).chain(numbered);
    names.find(is_free).unwrap_or(base)
}

/// The series that most properties are of; others are told.
fn series_of(
    package: &Package,
    own: &[(usize, &FileProperty)],
    notes: &mut Vec<String>,
) -> Option<usize> {
    let times = || own.iter().filter_map(|(_, p)| p.time.as_ref());
    let count = |uuid: &str| times().filter(|t| t.series == uuid).count();
    let counts = package.series().iter().enumerate();
    let counts: Vec<(usize, usize)> = counts.map(|(n, s)| (n, count(&s.uuid))).collect();
    // Of several with as many the first.
    let most = counts.iter().rev().max_by_key(|(_, count)| *count);
    let most = most.filter(|(_, count)| *count > 0).copied();
    let is_shown = |t: &&strataray_parsers::resqml::TimeIndex| {
        most.is_some_and(|(n, _)| {
            let series = &package.series()[n];
            series.uuid == t.series && t.index < series.times.len()
        })
    };
    let left = times().filter(|t| !is_shown(t)).count();
    if left > 0 {
        notes.push(format!(
            "{left} properties are of times beyond the time series that is shown: they were left out"
        ));
    }
    most.map(|(n, _)| n)
}

/// The steps of times such as `2021-01-01T06:30:00Z`; those that are no dates count as days from the first.
fn steps(times: &[String]) -> Vec<Step> {
    let moments: Vec<Option<f64>> = times.iter().map(|time| moment(time)).collect();
    let start = moments.iter().flatten().copied().next();
    let step = |(n, moment): (usize, &Option<f64>)| Step {
        report: n as u32,
        date: moment.map(calendar::text).unwrap_or_default(),
        days: moment
            .zip(start)
            .map_or(n as f64, |(moment, start)| moment - start),
    };
    moments.iter().enumerate().map(step).collect()
}

/// Days since 1970 of a time as XML has it; its zone is passed over.
fn moment(time: &str) -> Option<f64> {
    let (date, clock) = time.split_once('T').unwrap_or((time, "00:00:00"));
    let clock = clock.split(['Z', '+', '-', '.']).next().unwrap_or_default();
    calendar::moment(&format!("{} {clock}", date.trim_end_matches('Z')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_dates() {
        let times = [
            "2020-01-01",
            "2020-01-02T06:30:00Z",
            "2020-02-01T00:00:00.000+01:00",
            "",
        ];
        let steps = steps(&times.map(str::to_owned));
        let dates: Vec<&str> = steps.iter().map(|s| s.date.as_str()).collect();
        assert_eq!(dates, ["2020-01-01", "2020-01-02 06:30", "2020-02-01", ""]);
        assert!((steps[1].days - 1.270_833).abs() < 1e-6);
        assert_eq!(steps[2].days, 31.0);
    }
}
