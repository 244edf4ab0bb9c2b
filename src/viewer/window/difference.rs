//! What the first picture is of: the case in front as its scene says, or the difference of the values of two.

use std::sync::Arc;

use super::Window;
use crate::case::{self, Case, Minus, nearest};
use crate::scene::{Scene, StepSpec};
use crate::viewer::document::Document;
use crate::viewer::export::Compared;
use crate::viewer::state::Setup;

/// The difference of two cases that was made last.
pub struct CaseDifference {
    /// The cases, and the name of the difference.
    of: ([Arc<Case>; 2], String, Option<usize>),
    made: Result<Arc<Case>, String>,
}

impl Window {
    /// The second picture as it is shown, with the selected cells, for saving what is on screen.
    pub(super) fn compared(&self) -> Option<Compared> {
        let setup = &self.document()?.state.setup;
        let layout = setup.comparison.as_ref()?.layout;
        let (case, scene) = self.other()?;
        Some(Compared {
            case,
            scene,
            layout,
        })
    }
}

impl Window {
    /// The case and scene of the first picture.
    pub(super) fn subject(&self) -> Option<(Arc<Case>, Scene)> {
        match self.difference_of_values() {
            Some(Ok(difference)) => Some(difference),
            _ => {
                let document = self.document()?;
                Some((document.case.clone()?, document.state.setup.scene.clone()))
            }
        }
    }

    /// The case and scene of the difference of values that is asked for, or why there is none, in one sentence;
    /// `None` where none is asked for.
    pub fn difference_of_values(&self) -> Option<Result<(Arc<Case>, Scene), String>> {
        let document = self.document()?;
        let case = document.case.as_ref()?;
        let setup = &document.state.setup;
        let name = setup.difference()?;
        let comparison = setup.comparison.as_ref()?;
        let case = match &comparison.case {
            None => refusal(case, setup).map_or_else(|| Ok(case.clone()), Err),
            Some(_) => {
                let made = self.case_difference.as_ref().filter(|d| d.of.1 == name);
                made?.made.clone()
            }
        };
        Some(case.map(|case| {
            let mut scene = setup.scene.clone();
            let look = setup.looks.get(&name).cloned();
            look.unwrap_or_default().apply(&mut scene);
            scene.property = Some(name);
            (case, scene)
        }))
    }

    /// True where a difference is asked for that is not made yet, or whose look has not been found.
    pub(super) fn awaits_difference(&self) -> bool {
        let setup = self.document().map(|d| &d.state.setup);
        let Some((setup, name)) = setup.and_then(|s| Some((s, s.difference()?))) else {
            return false;
        };
        match self.difference_of_values() {
            Some(difference) => difference.is_ok() && !setup.looks.contains_key(&name),
            None => true,
        }
    }

    /// Makes the difference of two cases where one is asked for and was not made yet.
    pub(super) fn subtract_cases(&mut self) {
        let of = self.cases_to_subtract();
        let is_known = match (&self.case_difference, &of) {
            (Some(known), Some(of)) => {
                let [a, b] = [0, 1].map(|n| Arc::ptr_eq(&known.of.0[n], &of.0[n]));
                a && b && known.of.1 == of.1 && known.of.2 == of.2
            }
            (known, of) => known.is_none() && of.is_none(),
        };
        if is_known {
            return;
        }
        self.case_difference = of.map(|of| {
            let setup = self.document().map(|d| &d.state.setup);
            let made = setup
                .and_then(|setup| {
                    let now = setup.scene.property.as_deref()?;
                    let base = setup
                        .comparison
                        .as_ref()?
                        .property
                        .as_deref()
                        .unwrap_or(now);
                    let minus = Minus {
                        name: of.1.clone(),
                        now: now.to_owned(),
                        base: base.to_owned(),
                    };
                    Some(case::minus(&of.0[0], &of.0[1], &[minus], of.2).map(Arc::new))
                })
                .unwrap_or_else(|| Err("Choose a property first.".into()));
            CaseDifference { of, made }
        });
    }

    fn cases_to_subtract(&self) -> Option<([Arc<Case>; 2], String, Option<usize>)> {
        let document = self.document()?;
        let setup = &document.state.setup;
        let name = setup.difference()?;
        let comparison = setup.comparison.as_ref()?;
        comparison.case.as_ref()?;
        let a = document.case.clone()?;
        let at = comparison.step.as_ref().and_then(|step| match step {
            StepSpec::Index(n) => Some(*n),
            StepSpec::Name(name) => a.step(name).ok(),
        });
        Some(([a, self.other_case()?], name, at))
    }

    /// The document that a case belongs to, or the difference of whose case it is.
    pub(super) fn document_of(&mut self, case: &Arc<Case>) -> Option<&mut Document> {
        let difference = self.case_difference.as_ref();
        let made = difference.filter(|d| d.made.as_ref().is_ok_and(|made| Arc::ptr_eq(made, case)));
        let case = made.map_or_else(|| case.clone(), |d| d.of.0[0].clone());
        let is_of = |d: &&mut Document| d.case.as_ref().is_some_and(|c| Arc::ptr_eq(c, &case));
        self.documents.iter_mut().find(is_of)
    }
}

/// Why there is no difference within one case, in one sentence.
fn refusal(case: &Case, setup: &Setup) -> Option<String> {
    let comparison = setup.comparison.as_ref()?;
    let now = setup.scene.property.as_deref()?;
    let base = comparison.property.as_deref().unwrap_or(now);
    if case.difference(now).is_some() {
        return Some(format!(
            "{now} is a difference already. Choose a property in its place."
        ));
    }
    if now == base && !case.is_dynamic(now) {
        return Some(format!(
            "{now} does not change with time, so its steps do not differ. Choose another property."
        ));
    }
    case.refuses_difference(now, base, case)
}

/// The step of another case whose date is nearest to that of a step.
pub fn same_date(case: &Case, step: &StepSpec, other: &Case) -> StepSpec {
    let number = match step {
        StepSpec::Index(n) => Some(*n),
        StepSpec::Name(name) => case.step(name).ok(),
    };
    let of_case = number.and_then(|n| case.steps.get(n));
    let found = of_case.and_then(|step| nearest(step, &other.steps));
    found.map_or_else(|| step.clone(), StepSpec::Index)
}
