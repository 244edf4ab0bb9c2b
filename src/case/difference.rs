//! Differences of values, cell by cell: of two properties or steps of a case by their name, and of two cases.

use std::sync::Arc;

use super::pairing::{Pairing, distinct_names, no_step};
use super::{About, Case, CaseError, Kind, Property, Source, Step, Vectors, Well};
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
    /// The name of the difference to another case of a property, whatever its letter case; `None` where it has none.
    pub fn minus_of(&self, property: &str) -> Option<&str> {
        let mut all = self.minus.iter();
        let found = all.find(|m| m.now.eq_ignore_ascii_case(property));
        found.map(|m| m.name.as_str())
    }

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
            return match self.subtracted(name) {
                Some(minus) => minus.title(),
                None => self.title_of_statistic(name),
            };
        };
        let at = at.and_then(|at| self.step(at).ok());
        let when = at.and_then(|n| self.steps.get(n));
        let when = when.map(Step::when);
        match when {
            // The date of the step shown follows.
            Some(when) if now == base => format!("{now} change relative to {when}"),
            Some(when) => format!("{now} minus {base} of {when}"),
            None => format!("{now} minus {base}"),
        }
    }

    /// The property that is a difference to another case.
    fn subtracted(&self, name: &str) -> Option<&Minus> {
        self.minus.iter().find(|m| m.name == name)
    }

    /// What stands over the legend of a property or difference.
    pub fn heading_of(&self, name: &str) -> String {
        let known = self.subtracted(name);
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
        match (self.difference(name), self.subtracted(name)) {
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

/// A property of a case that is a difference to another one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Minus {
    /// Its name.
    pub name: String,
    /// The property from which is taken.
    pub now: String,
    /// The property that is taken away.
    pub base: String,
}

impl Minus {
    /// What stands above the picture.
    fn title(&self) -> String {
        match self.now == self.base {
            true => self.now.clone(),
            false => format!("{} minus {}", self.now, self.base),
        }
    }

    /// Each property that two cases have in one unit, but those of the grid alone; a difference is called as `SWAT-SWAT@B`
    /// where B is `other`.
    pub fn of_all(a: &Case, b: &Case, other: &str) -> Vec<Self> {
        let is_of_both = |p: &&Property| {
            let twin = b.property(&p.name);
            !p.is_of_grid() && twin.is_ok_and(|twin| twin.unit == p.unit)
        };
        let minus = |p: &Property| Self {
            name: difference_name(&p.name, &p.name, Some(other)),
            now: p.name.clone(),
            base: p.name.clone(),
        };
        a.properties.iter().filter(is_of_both).map(minus).collect()
    }
}

/// Case `a` with more properties: its values of `now` minus those of `base` in case `b`, cell by cell.
///
/// A step is matched with that of `b` of the same date, and has no values where there is none; `at` is a step of `a` whose
/// match is taken away at all steps. A cell that is active in one case alone has no value. The notes are what of both does
/// not match. The grid is `a`'s own, not a copy.
///
/// # Errors
/// When the grids differ, no date is in both cases, or the properties cannot be subtracted; the sentence says which.
pub fn minus(
    a: &Arc<Case>,
    b: &Arc<Case>,
    differences: &[Minus],
    at: Option<usize>,
) -> Result<Case, String> {
    let names = distinct_names(&[a, b]);
    let [of_a, of_b] = [&names[0], &names[1]].map(String::as_str);
    let mut pairing = Pairing::of(a, b, [of_a, of_b])?;
    if let Some(at) = at.filter(|at| *at < a.steps.len()) {
        pairing.steps = vec![pairing.steps[at]; a.steps.len()];
    }
    let changes = |m: &Minus| a.is_dynamic(&m.now) || b.is_dynamic(&m.base);
    if !a.steps.is_empty()
        && pairing.steps.iter().all(Option::is_none)
        && differences.iter().all(changes)
    {
        return Err(no_date(a, b, at, [of_a, of_b]));
    }
    let mut properties = a.properties.clone();
    for m in differences {
        if let Some(why) = a.refuses_difference(&m.now, &m.base, b) {
            return Err(why);
        }
        let (kind, steps) = match changes(m) {
            true => (Kind::Dynamic, a.steps.len()),
            false => (Kind::Static, 0),
        };
        let doubts = [a.property(&m.now), b.property(&m.base)];
        let doubts = doubts.map(|p| p.ok().and_then(|p| p.doubt.clone()));
        properties.push(Property {
            steps,
            doubt: doubts.into_iter().flatten().next(),
            ..Property::new(&m.name, kind, a.unit(&m.now))
        });
    }
    let changes = differences.iter().any(changes);
    let lacks = pairing.lacks.take().filter(|_| changes && at.is_none());
    let notes = lacks.into_iter().chain(std::mem::take(&mut pairing.notes));
    Ok(Case {
        about: About {
            name: format!("{of_a} minus {of_b}"),
            notes: notes.collect(),
            ..a.about.clone()
        },
        properties,
        source: Arc::new(Subtracted {
            of: [a.clone(), b.clone()],
            differences: differences.to_vec(),
            pairing,
            other: of_b.to_owned(),
        }),
        minus: differences.to_vec(),
        ..a.derived_case()
    })
}

/// Why no step has a difference.
fn no_date(a: &Case, b: &Case, at: Option<usize>, [of_a, of_b]: [&str; 2]) -> String {
    if let Some(step) = at.and_then(|at| a.steps.get(at)) {
        return no_step(step, of_b).to_string();
    }
    let span = |case: &Case| match (case.steps.first(), case.steps.last()) {
        (Some(first), Some(last)) => format!("{} to {}", first.when(), last.when()),
        _ => "none".into(),
    };
    format!(
        "no step of {of_a} ({}) has the date of one of {of_b} ({}): there is no difference",
        span(a),
        span(b)
    )
}

/// Values of a case, and of some properties those of another case taken away.
struct Subtracted {
    of: [Arc<Case>; 2],
    differences: Vec<Minus>,
    pairing: Pairing,
    /// What the second case is called.
    other: String,
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
        let Some(minus) = self.differences.iter().find(|m| m.name == name) else {
            return a.values_where_they_are(name, step);
        };
        let other = match b.is_dynamic(&minus.base) {
            false => 0,
            true => match (self.pairing.steps.get(step), a.steps.get(step)) {
                (Some(Some(other)), _) => *other,
                (_, Some(step)) => return Err(no_step(step, &self.other)),
                _ => return Ok(None),
            },
        };
        let fields = [a.field(&minus.now, step), b.field(&minus.base, other)];
        let [now, base] = match fields {
            [Ok(now), Ok(base)] => [now, base],
            [Err(CaseError::NotAtStep { .. }), _] | [_, Err(CaseError::NotAtStep { .. })] => {
                return Ok(None);
            }
            [Err(error), _] | [_, Err(error)] => return Err(error),
        };
        let cells = now.values().iter().enumerate();
        let difference = |(n, v): (usize, &f32)| v - self.pairing.value(base.values(), n);
        Ok(Some(cells.map(difference).collect()))
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

    /// The sample under another name, with dates that are changed.
    fn renamed(name: &str, date: impl Fn(usize, &str) -> String) -> Arc<Case> {
        let mut other = load::open(&sample().about.files[0]).unwrap();
        for (n, step) in other.steps.iter_mut().enumerate() {
            step.date = date(n, &step.date);
        }
        other.about.name = name.into();
        Arc::new(other)
    }

    fn of_soil(other: &str) -> Minus {
        Minus {
            name: difference_name("SOIL", "SOIL", Some(other)),
            now: "SOIL".into(),
            base: "SOIL".into(),
        }
    }

    #[test]
    fn two_cases_are_subtracted_at_equal_dates() {
        let a = sample();
        // The same dates but for one.
        let b = renamed("OTHER", |n, date| match n {
            1 => date.replace("-01-01", "-01-15"),
            _ => date.to_owned(),
        });
        let soil = of_soil("OTHER");
        let own = &soil.name;
        let case = minus(&a, &b, std::slice::from_ref(&soil), None).unwrap();
        assert_eq!(case.about.name, "SCISSOR minus OTHER");
        assert_eq!(case.steps, a.steps);
        assert_eq!(case.title_of(own), "SOIL");
        assert_eq!(case.heading_of(own), "SOIL difference");
        let last = case.steps.len() - 1;
        let is_zero = |v: &f32| *v == 0.0;
        assert!(case.field(own, last).unwrap().values().iter().all(is_zero));
        // No other date's values stand in for the one that is missing, and that is said.
        let error = case.field(own, 1).unwrap_err();
        let date = a.steps[1].date.as_str();
        assert!(
            matches!(&error, CaseError::NoStepOfDate { case, date: d } if case == "OTHER" && d == date),
            "{error}"
        );
        let told = format!("1 of {} steps of SCISSOR", a.steps.len());
        assert!(
            case.about
                .notes
                .iter()
                .any(|n| n.contains(&told) && n.contains(date))
        );
        let whole = minus(
            &a,
            &renamed("SAME", |_, d| d.into()),
            &[of_soil("SAME")],
            None,
        );
        assert!(
            !whole
                .unwrap()
                .about
                .notes
                .iter()
                .any(|n| n.contains("steps of"))
        );
        // To the first step of the other one, and what else the case has.
        let to_first = minus(&a, &b, std::slice::from_ref(&soil), Some(0)).unwrap();
        assert_eq!(
            to_first.field(own, last).unwrap(),
            a.field("SOIL-SOIL@0", last).unwrap()
        );
        assert_eq!(
            to_first.field("PORO", 0).unwrap(),
            a.field("PORO", 0).unwrap()
        );
        assert!(Arc::ptr_eq(&case.grid, &a.grid));
        // Where no date is in both there is nothing to subtract.
        let late = renamed("LATE", |_, date| date.replace("-01-01", "-01-15"));
        let refused = minus(&a, &late, &[of_soil("LATE")], None).err().unwrap();
        assert!(
            refused.contains("LATE") && refused.contains(date_of(&late)),
            "{refused}"
        );
        let refused = minus(&a, &b, &[soil], Some(1)).err().unwrap();
        assert!(refused.contains("OTHER has no step of"), "{refused}");
    }

    fn date_of(case: &Case) -> &str {
        &case.steps[0].date
    }

    #[test]
    fn all_properties_of_two_cases_are_subtracted_but_those_of_the_grid() {
        let a = sample();
        let b = renamed("B", |_, date| date.to_owned());
        let all = Minus::of_all(&a, &b, "B");
        let case = minus(&a, &b, &all, None).unwrap();
        for name in ["PORO-PORO@B", "PRESSURE-PRESSURE@B", "SOIL-SOIL@B"] {
            assert!(case.property(name).is_ok(), "{name}");
        }
        for name in ["DEPTH-DEPTH@B", "I-I@B"] {
            assert!(case.property(name).is_err(), "{name}");
        }
    }
}
