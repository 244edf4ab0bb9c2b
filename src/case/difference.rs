//! Differences of values, cell by cell: of two properties or steps of a case by their name, and of two cases.

use std::sync::Arc;

use super::{
    About, Case, CaseError, FieldCache, Kind, OverSteps, Property, Source, Step, Vectors, Well,
    WellsOfSteps,
};
use crate::model::CellField;

/// Stands for the step shown, in place of another one's.
const SAME: &str = "same";

/// A difference by its name: `PRESSURE-PRESSURE@0` to a step, `SWAT-SOIL@same` of two properties.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Difference<'a> {
    /// The property from which is taken.
    pub now: &'a str,
    /// The property that is taken away.
    pub base: &'a str,
    /// The step at which that is; the one shown where absent.
    pub at: Option<&'a str>,
}

/// The name of a difference; `at` is a step or, of two cases, the name of the other one.
pub fn difference_name(now: &str, base: &str, at: Option<&str>) -> String {
    format!("{now}-{base}@{}", at.unwrap_or(SAME))
}

impl Case {
    /// The difference that a name stands for; `None` where it is a property, or no difference.
    pub fn difference<'a>(&self, name: &'a str) -> Option<Difference<'a>> {
        if self.property(name).is_ok() {
            return None;
        }
        let (names, at) = name.rsplit_once('@')?;
        let exists = |name: &str| self.property(name).is_ok();
        let mut dashes = names.match_indices('-').map(|(at, _)| at);
        let between = dashes.find(|at| exists(&names[..*at]) && exists(&names[at + 1..]));
        // Where one of them does not exist, whoever asks for it says so.
        let (now, base) = match between {
            Some(dash) => (&names[..dash], &names[dash + 1..]),
            None => names.rsplit_once('-')?,
        };
        let at = Some(at).filter(|at| *at != SAME);
        Some(Difference { now, base, at })
    }

    /// What a property or difference is called above a picture: `SOIL change relative to 2001-06-30`.
    pub fn title_of(&self, name: &str) -> String {
        let Some(Difference { now, base, at }) = self.difference(name) else {
            let known = self.minus.as_ref().filter(|m| m.name == name);
            return known.map_or_else(|| name.to_owned(), |m| m.title.clone());
        };
        let at = at.and_then(|at| self.step(at).ok());
        let when = at.and_then(|n| self.steps.get(n));
        let when = when.map(|step| match step.date.is_empty() {
            true => format!("day {}", step.days),
            false => step.date.clone(),
        });
        match when {
            // The date of the step shown follows.
            Some(when) if now == base => format!("{now} change relative to {when}"),
            Some(when) => format!("{now} minus {base} of {when}"),
            None => format!("{now} minus {base}"),
        }
    }

    /// What stands over the legend of a property or difference.
    pub fn heading_of(&self, name: &str) -> String {
        let known = self.minus.as_ref().filter(|m| m.name == name);
        let pair = match (self.difference(name), known) {
            (Some(Difference { now, base, .. }), _) => Some([now, base]),
            (None, Some(minus)) => Some([minus.now.as_str(), minus.base.as_str()]),
            (None, None) => None,
        };
        match pair {
            Some([now, base]) if now == base => format!("{now} difference"),
            Some([now, base]) => format!("{now} minus {base}"),
            None => name.to_owned(),
        }
    }

    /// The property from which a difference is taken; a property itself.
    pub fn now_of<'a>(&'a self, name: &'a str) -> &'a str {
        let own = self.minus.as_ref().filter(|m| m.name == name);
        match (self.difference(name), own) {
            (Some(difference), _) => difference.now,
            (None, Some(minus)) => &minus.now,
            (None, None) => name,
        }
    }

    /// Why two properties have no difference, in one sentence; `None` where they have one.
    pub fn refuses_difference(&self, now: &str, base: &str, other: &Self) -> Option<String> {
        let units = [self.property(now), other.property(base)];
        let [now, base] = match units {
            [Ok(now), Ok(base)] => [now, base],
            [Err(error), _] | [_, Err(error)] => return Some(error.to_string()),
        };
        let words = |unit: &str| match unit {
            "" => "has no unit".to_owned(),
            unit => format!("is in {unit}"),
        };
        (now.unit != base.unit).then(|| {
            format!(
                "{} {} and {} {}: their difference has no meaning.",
                now.name,
                words(&now.unit),
                base.name,
                words(&base.unit)
            )
        })
    }

    pub(super) fn step_difference(
        &self,
        difference: Difference<'_>,
        step: usize,
    ) -> Result<CellField, CaseError> {
        let base_step = match difference.at {
            Some(at) => self.step(at)?,
            None => step,
        };
        let now = self.field(difference.now, step)?;
        let base = self.field(difference.base, base_step)?;
        let pairs = now.values().iter().zip(base.values());
        Ok(CellField::new(pairs.map(|(a, b)| a - b).collect()))
    }
}

/// The property of a case that is its difference to another one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Minus {
    /// Its name.
    pub name: String,
    /// The property from which is taken.
    pub now: String,
    /// The property that is taken away.
    pub base: String,
    /// What stands above the picture.
    title: String,
}

/// Case `a` with one property more: its values of `now` minus those of `base` in case `b`, cell by cell.
///
/// A step is matched with that of `b` whose date is nearest, and where the dates differ, both are in its date;
/// `at` is a step of `a` whose match is taken away at all steps. A cell that is active in `a` alone has no
/// value. The grid is `a`'s own, not a copy.
///
/// # Errors
/// When the grids have other dimensions, or the properties cannot be subtracted; the sentence says which.
pub fn minus(
    a: &Arc<Case>,
    b: &Arc<Case>,
    [now, base]: [&str; 2],
    at: Option<usize>,
    name: &str,
) -> Result<Case, String> {
    let names = [a, b].map(|case| case.about.name.clone());
    let dims = [a, b].map(|case| case.grid.dims());
    if dims[0] != dims[1] {
        let [x, y] = dims.map(|d| format!("{} x {} x {}", d.ni, d.nj, d.nk));
        return Err(format!(
            "{} has {x} cells and {} has {y}: a difference cell by cell needs equal grids.",
            names[0], names[1]
        ));
    }
    if let Some(why) = a.refuses_difference(now, base, b) {
        return Err(why);
    }
    let steps: Vec<Option<usize>> = (0..a.steps.len())
        .map(|n| nearest(&a.steps[at.unwrap_or(n).min(a.steps.len() - 1)], &b.steps))
        .collect();
    let title = match now == base {
        true => now.to_owned(),
        false => format!("{now} minus {base}"),
    };
    let (kind, count) = match a.is_dynamic(now) || b.is_dynamic(base) {
        true => (Kind::Dynamic, a.steps.len()),
        false => (Kind::Static, 0),
    };
    let doubts = [a.property(now), b.property(base)].map(|p| p.ok().and_then(|p| p.doubt.clone()));
    let property = Property {
        steps: count,
        doubt: doubts.into_iter().flatten().next(),
        ..Property::new(name, kind, a.unit(now))
    };
    Ok(Case {
        grid: a.grid.clone(),
        about: About {
            name: format!("{} minus {}", names[0], names[1]),
            ..a.about.clone()
        },
        fault_faces: a.fault_faces.clone(),
        connections: a.connections.clone(),
        steps: dated(a, b, &steps),
        properties: a.properties.iter().cloned().chain([property]).collect(),
        source: Arc::new(Subtracted {
            of: [a.clone(), b.clone()],
            names: [now, base].map(str::to_owned),
            own: name.to_owned(),
            places: places(a, b),
            steps,
        }),
        cache: Arc::new(FieldCache::default()),
        over_steps: Arc::new(OverSteps::default()),
        wells: Arc::new(WellsOfSteps::default()),
        simbox: a.simbox.of_same_grid(),
        minus: Some(Minus {
            name: name.to_owned(),
            now: now.to_owned(),
            base: base.to_owned(),
            title,
        }),
    })
}

/// The steps of `a`, with both dates where that of the match is another.
fn dated(a: &Case, b: &Case, matches: &[Option<usize>]) -> Vec<Step> {
    let dated = |(step, other): (&Step, &Option<usize>)| {
        let other = other.and_then(|n| b.steps.get(n));
        let date = match other {
            Some(other) if other.date != step.date => format!("{} minus {}", step.date, other.date),
            _ => step.date.clone(),
        };
        Step {
            date,
            ..step.clone()
        }
    };
    a.steps.iter().zip(matches).map(dated).collect()
}

/// The active index in `b` of each active cell of `a`.
fn places(a: &Case, b: &Case) -> Vec<Option<u32>> {
    let cells = a.grid.active_cells().iter();
    cells
        .map(|&cell| b.grid.active_index(cell).map(|active| active.0))
        .collect()
}

/// The step whose date is nearest to that of another one, or whose days are where dates are missing; `None`
/// where there are no steps.
pub fn nearest(step: &Step, steps: &[Step]) -> Option<usize> {
    let moment = step.moment();
    let apart = |other: &Step| match (moment, other.moment()) {
        (Some(a), Some(b)) => (a - b).abs(),
        _ => (step.days - other.days).abs(),
    };
    let all = steps.iter().enumerate();
    all.min_by(|a, b| apart(a.1).total_cmp(&apart(b.1)))
        .map(|(n, _)| n)
}

/// Values of a case, and of one property those of another case taken away.
struct Subtracted {
    of: [Arc<Case>; 2],
    /// The properties subtracted, of each case.
    names: [String; 2],
    /// Name of the difference.
    own: String,
    /// The active index in the second case of each active cell of the first.
    places: Vec<Option<u32>>,
    /// The step of the second case for each of the first.
    steps: Vec<Option<usize>>,
}

impl Source for Subtracted {
    fn wells(&self, step: usize) -> Result<Vec<Well>, CaseError> {
        Ok(self.of[0].wells(step)?.to_vec())
    }

    fn vectors(&self) -> Result<Option<Arc<Vectors>>, CaseError> {
        self.of[0].vectors()
    }

    fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, CaseError> {
        let [a, b] = &self.of;
        if name != self.own {
            return match a.field(name, step) {
                Ok(field) => Ok(Some(field.values().to_vec())),
                Err(CaseError::NotAtStep { .. } | CaseError::UnknownProperty { .. }) => Ok(None),
                Err(error) => Err(error),
            };
        }
        let other = self.steps.get(step).copied().flatten().unwrap_or(0);
        let fields = [
            a.field(&self.names[0], step),
            b.field(&self.names[1], other),
        ];
        let [now, base] = match fields {
            [Ok(now), Ok(base)] => [now, base],
            [Err(CaseError::NotAtStep { .. }), _] | [_, Err(CaseError::NotAtStep { .. })] => {
                return Ok(None);
            }
            [Err(error), _] | [_, Err(error)] => return Err(error),
        };
        let there = |place: &Option<u32>| {
            let value = place.and_then(|n| base.values().get(n as usize));
            value.copied().unwrap_or(f32::NAN)
        };
        let pairs = now.values().iter().zip(&self.places);
        Ok(Some(pairs.map(|(v, place)| v - there(place)).collect()))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::case::load;

    fn sample() -> Arc<Case> {
        let file = "samples/scissor/SCISSOR.EGRID";
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        Arc::new(load::open(&path).unwrap())
    }

    #[test]
    fn names_of_differences_are_told_from_properties() {
        let case = sample();
        let of = |name| case.difference(name);
        let to_step = of("SOIL-SOIL@3").unwrap();
        assert_eq!((to_step.now, to_step.at), ("SOIL", Some("3")));
        let of_two = of("SWAT-SOIL@same").unwrap();
        assert_eq!((of_two.base, of_two.at), ("SOIL", None));
        let dated = of("SWAT-SWAT@2015-01-01").unwrap();
        assert_eq!((dated.now, dated.at), ("SWAT", Some("2015-01-01")));
        assert_eq!(of("SOIL"), None);
        assert_eq!(of("SOIL-SWAT"), None);
        assert_eq!(difference_name("SWAT", "SOIL", None), "SWAT-SOIL@same");
        let title = case.title_of("SOIL-SOIL@0");
        assert_eq!(
            title,
            format!("SOIL change relative to {}", case.steps[0].date)
        );
        assert_eq!(case.heading_of("SOIL-SOIL@0"), "SOIL difference");
        assert_eq!(case.title_of("SWAT-SOIL@same"), "SWAT minus SOIL");
        assert_eq!(case.title_of("SOIL"), "SOIL");
    }

    #[test]
    fn properties_of_one_step_are_subtracted() {
        let case = sample();
        let last = case.steps.len() - 1;
        let [a, b] = ["SWAT", "SOIL"].map(|n| case.field(n, last).unwrap());
        let difference = case.field("SWAT-SOIL@same", last).unwrap();
        for (n, v) in difference.values().iter().enumerate() {
            assert_eq!(*v, a.values()[n] - b.values()[n]);
        }
        assert!(case.is_dynamic("SWAT-SOIL@same"));
        let why = case.refuses_difference("PRESSURE", "SOIL", &case).unwrap();
        assert!(
            why.contains("PRESSURE is in") && why.contains("SOIL has no unit"),
            "{why}"
        );
    }

    #[test]
    fn two_cases_are_subtracted_at_the_nearest_dates() {
        let a = sample();
        // The same case whose steps are a fortnight late.
        let mut late = load::open(&a.about.files[0]).unwrap();
        for step in &mut late.steps {
            step.date = step.date.replace("-01-01", "-01-15");
        }
        late.about.name = "LATE".into();
        let b = Arc::new(late);
        let own = difference_name("SOIL", "SOIL", Some("LATE"));
        let case = minus(&a, &b, ["SOIL", "SOIL"], None, &own).unwrap();
        assert_eq!(case.about.name, "SCISSOR minus LATE");
        let last = case.steps.len() - 1;
        let dates = [&a, &b].map(|c| c.steps[last].date.clone());
        assert_eq!(case.steps[last].date, dates.join(" minus "));
        assert_eq!(case.title_of(&own), "SOIL");
        assert_eq!(case.heading_of(&own), "SOIL difference");
        assert!(
            case.field(&own, last)
                .unwrap()
                .values()
                .iter()
                .all(|v| *v == 0.0)
        );
        // To the first step of the other one, and what else the case has.
        let to_first = minus(&a, &b, ["SOIL", "SOIL"], Some(0), &own).unwrap();
        assert_eq!(
            to_first.field(&own, last).unwrap(),
            a.field("SOIL-SOIL@0", last).unwrap()
        );
        assert_eq!(
            to_first.field("PORO", 0).unwrap(),
            a.field("PORO", 0).unwrap()
        );
        assert!(Arc::ptr_eq(&case.grid, &a.grid));
    }
}
