//! Statistics over several cases on one grid, cell by cell: means, spreads and percentiles as properties of the first.

use std::sync::Arc;

use rayon::prelude::*;

use super::pairing::{Pairing, distinct_names};
use super::{About, Case, CaseError, Kind, Property, Source, Vectors, Well};
use crate::model::CellField;
use crate::transfer::kinds::Quantity;

/// What is found of the values that a cell has in several cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// Arithmetic mean.
    Mean,
    /// Standard deviation, that of a sample (n - 1); not a number of a single value.
    Deviation,
    /// Smallest value.
    Minimum,
    /// Value below which 10 % of the cases lie, interpolated between two of them.
    P10,
    /// Median.
    P50,
    /// Value below which 90 % of the cases lie.
    P90,
    /// Largest value.
    Maximum,
}

impl Statistic {
    /// All of them, with what follows the property's name, and in words.
    pub const ALL: [(Self, &'static str, &'static str); 7] = [
        (Self::Mean, "MEAN", "mean"),
        (Self::Deviation, "STD", "standard deviation"),
        (Self::Minimum, "MIN", "minimum"),
        (Self::P10, "P10", "P10 (10 % lie below)"),
        (Self::P50, "P50", "median"),
        (Self::P90, "P90", "P90 (90 % lie below)"),
        (Self::Maximum, "MAX", "maximum"),
    ];

    /// In words.
    pub fn words(self) -> &'static str {
        let own = Self::ALL.iter().find(|(s, ..)| *s == self);
        own.map_or("", |(_, _, words)| words)
    }

    /// The name of a property's statistic, such as `SWAT.MEAN`.
    pub fn name(self, property: &str) -> String {
        let own = Self::ALL.iter().find(|(s, ..)| *s == self);
        format!("{property}.{}", own.map_or("", |(_, ending, _)| ending))
    }

    /// Of some values, whose order changes; not a number of none.
    fn of(self, values: &mut [f32]) -> f32 {
        let count = values.len() as f64;
        let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / count;
        match self {
            Self::Mean => mean as f32,
            Self::Deviation if values.len() < 2 => f32::NAN,
            Self::Deviation => {
                let squares = values.iter().map(|v| (f64::from(*v) - mean).powi(2));
                (squares.sum::<f64>() / (count - 1.0)).sqrt() as f32
            }
            Self::Minimum => percentile(values, 0.0),
            Self::P10 => percentile(values, 0.1),
            Self::P50 => percentile(values, 0.5),
            Self::P90 => percentile(values, 0.9),
            Self::Maximum => percentile(values, 1.0),
        }
    }
}

/// The value below which a part of some values lies, interpolated between the two that are nearest.
fn percentile(values: &mut [f32], part: f64) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    let Some(last) = values.len().checked_sub(1) else {
        return f32::NAN;
    };
    let at = part * last as f64;
    let [low, high] = [at.floor(), at.ceil()].map(|n| f64::from(values[n as usize]));
    (low + at.fract() * (high - low)) as f32
}

/// The cases of which another one has statistics.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ensemble {
    /// Names by which they are told apart, that of the first in front.
    pub members: Vec<String>,
    /// True where not all of them have values in all cells at all steps.
    has_gaps: bool,
    /// Properties that have statistics, and their kinds, by the name of these.
    statistics: Vec<(String, String, Statistic)>,
}

impl Ensemble {
    fn find(&self, name: &str) -> Option<(&str, Statistic)> {
        let found = self.statistics.iter().find(|(own, ..)| own == name);
        found.map(|(_, of, statistic)| (of.as_str(), *statistic))
    }
}

impl Case {
    /// The property of which `name` is a statistic over several cases, and which one; `None` where it is none.
    pub fn statistic(&self, name: &str) -> Option<(&str, Statistic)> {
        self.ensemble.as_ref()?.find(name)
    }

    /// What a statistic is called above a picture; any other name as it is.
    pub(super) fn title_of_statistic(&self, name: &str) -> String {
        match (self.statistic(name), &self.ensemble) {
            (Some((of, statistic)), Some(ensemble)) => {
                let count = ensemble.members.len();
                let up_to = if ensemble.has_gaps { "up to " } else { "" };
                format!("{of}, {} of {up_to}{count} cases", statistic.words())
            }
            _ => name.to_owned(),
        }
    }
}

/// The first of several cases on one grid, with statistics over all of them: `SWAT.MEAN` and so on of each property that all
/// have in one unit, but of regions and of what follows from the grid.
///
/// Steps are those of the first case; of another one counts the step of the same date. A statistic is of the cases that have a
/// value in the cell; what is missing is in the notes. The values of all cases at a step are in memory while it is found.
///
/// # Errors
/// When there are fewer than two cases, or the grids differ; the sentence says in what.
pub fn ensemble(cases: &[Arc<Case>]) -> Result<Case, String> {
    let [first, others @ ..] = cases else {
        return Err("there is no case".into());
    };
    if others.is_empty() {
        return Err("statistics over cases need two of them or more".into());
    }
    let members = distinct_names(&cases.iter().map(Arc::as_ref).collect::<Vec<_>>());
    let mut pairings = Vec::with_capacity(others.len());
    let mut notes = Vec::new();
    for (other, name) in others.iter().zip(&members[1..]) {
        let mut pairing = Pairing::of(first, other, [&members[0], name])?;
        let of_pair = pairing.lacks.take().into_iter();
        let of_pair = of_pair.chain(std::mem::take(&mut pairing.notes));
        notes.extend(of_pair.map(|note| format!("statistics: {note}")));
        pairings.push(pairing);
    }
    let has_gaps = !notes.is_empty();
    let (common, missing) = common(first, others);
    if !missing.is_empty() {
        notes.push(format!(
            "there are no statistics of {}: not all cases have them in one unit",
            missing.join(", ")
        ));
    }
    let mut properties = first.properties.clone();
    let mut statistics = Vec::new();
    for property in common {
        for (statistic, ..) in Statistic::ALL {
            let name = statistic.name(&property.name);
            let kind = match property.steps {
                0 => Kind::Static,
                _ => Kind::Dynamic,
            };
            properties.push(Property {
                steps: property.steps,
                doubt: property.doubt.clone(),
                ..Property::new(&name, kind, &property.unit)
            });
            statistics.push((name, property.name.clone(), statistic));
        }
    }
    let ensemble = Ensemble {
        members,
        has_gaps,
        statistics,
    };
    Ok(Case {
        about: About {
            name: format!("{} and {} more", ensemble.members[0], others.len()),
            files: cases.iter().flat_map(|c| c.about.files.clone()).collect(),
            notes,
            ..first.about.clone()
        },
        properties,
        source: Arc::new(Members {
            cases: cases.to_vec(),
            pairings,
            ensemble: ensemble.clone(),
        }),
        ensemble: Some(ensemble),
        ..first.derived_case()
    })
}

/// The properties that have statistics, and the names of those that not all cases have.
fn common<'a>(first: &'a Case, others: &[Arc<Case>]) -> (Vec<&'a Property>, Vec<&'a str>) {
    let is_measured = |p: &&Property| !p.is_of_grid() && Quantity::of(&p.name) != Quantity::Region;
    let is_common = |p: &&Property| {
        let has = |case: &Arc<Case>| case.property(&p.name).is_ok_and(|q| q.unit == p.unit);
        others.iter().all(has)
    };
    let all = first.properties.iter().filter(is_measured);
    let (common, missing): (Vec<_>, Vec<_>) = all.partition(is_common);
    (common, missing.iter().map(|p| p.name.as_str()).collect())
}

/// Values of the first of several cases, and statistics over all.
struct Members {
    cases: Vec<Arc<Case>>,
    /// Of the first with each of the others.
    pairings: Vec<Pairing>,
    ensemble: Ensemble,
}

/// Values of a case, and how its cells belong to those of the first; `None` of the first itself.
type Member<'a> = (CellField, Option<&'a Pairing>);

impl Members {
    /// The values that the cases have on the date of a step of the first. They are not kept: there are many of them.
    fn fields(&self, name: &str, step: usize) -> Result<Vec<Member<'_>>, CaseError> {
        let pairings = self.pairings.iter().map(Some);
        let pairs = self.cases.iter().zip(std::iter::once(None).chain(pairings));
        let field = |(case, pairing): (&Arc<Case>, Option<&'_ Pairing>)| {
            let step = match pairing {
                Some(pairing) if case.is_dynamic(name) => pairing.steps.get(step).copied()?,
                _ => Some(step),
            };
            match case.computed(name, step?) {
                Ok(field) => Some(Ok(field)),
                Err(error) if error.is_gap() => None,
                Err(error) => Some(Err(error)),
            }
        };
        let mut fields = Vec::new();
        for (case, pairing) in pairs {
            if let Some(found) = field((case, pairing)) {
                fields.push((found?, pairing));
            }
        }
        Ok(fields)
    }
}

impl Source for Members {
    fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, CaseError> {
        let Some((of, statistic)) = self.ensemble.find(name) else {
            return self.cases[0].values_where_they_are(name, step);
        };
        let fields = self.fields(of, step)?;
        if fields.is_empty() {
            return Ok(None);
        }
        let value = |(field, pairing): &Member<'_>, cell: usize| match pairing {
            Some(pairing) => pairing.value(field.values(), cell),
            None => field.values()[cell],
        };
        let cells = 0..self.cases[0].grid.active_cells().len();
        let found = cells.into_par_iter().map_init(Vec::new, |values, cell| {
            values.clear();
            let all = fields.iter().map(|field| value(field, cell));
            values.extend(all.filter(|v| !v.is_nan()));
            statistic.of(values)
        });
        Ok(Some(found.collect()))
    }

    fn wells(&self, step: usize) -> Result<Vec<Well>, CaseError> {
        Ok(self.cases[0].wells(step)?.to_vec())
    }

    fn vectors(&self) -> Result<Option<Arc<Vectors>>, CaseError> {
        self.cases[0].vectors()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_few_values() {
        let of = |statistic: Statistic| statistic.of(&mut [4.0, 1.0, 3.0, 2.0, 10.0]);
        assert_eq!(of(Statistic::Mean), 4.0);
        // As numpy has them: std with ddof=1, and percentiles by linear interpolation.
        assert!((of(Statistic::Deviation) - 3.535_534).abs() < 1e-6);
        assert!((of(Statistic::P10) - 1.4).abs() < 1e-6);
        assert!((of(Statistic::P90) - 7.6).abs() < 1e-6);
        assert_eq!(of(Statistic::P50), 3.0);
        assert_eq!(
            (of(Statistic::Minimum), of(Statistic::Maximum)),
            (1.0, 10.0)
        );
        for (statistic, ..) in Statistic::ALL {
            assert!(statistic.of(&mut []).is_nan());
        }
        assert!(Statistic::Deviation.of(&mut [1.0]).is_nan());
    }
}
