//! Time steps by number, date or name.

use super::error::SceneError;
use crate::case::Case;
use crate::scene::StepSpec;

/// The step that a scene names, of what changes with time; else 0.
pub(super) fn step_of(case: &Case, spec: &StepSpec, dynamic: bool) -> Result<usize, SceneError> {
    if !dynamic {
        return Ok(0);
    }
    Ok(match spec {
        StepSpec::Index(n) => case.step(&n.to_string())?,
        StepSpec::Name(name) => case.step(name)?,
    })
}

/// The step of which wells are shown: the one that a scene names, whether or not its property changes with time.
pub(super) fn well_step(case: &Case, spec: &StepSpec) -> usize {
    let last = case.steps.len().saturating_sub(1);
    step_of(case, spec, true).unwrap_or(last)
}

/// The steps that `chosen` names: `A..B` with both ends, each a number, a date, `first` or `last`;
/// all where absent. Of these the first and each `every`th after it.
///
/// # Errors
/// When the text does not have this form or names a step that the case does not have.
pub fn steps(case: &Case, chosen: Option<&str>, every: usize) -> Result<Vec<usize>, SceneError> {
    let (from, to) = match chosen {
        None => ("first", "last"),
        Some(text) => text.split_once("..").ok_or_else(|| {
            SceneError::Steps(format!("{text}: give the first and the last like 0..10"))
        })?,
    };
    let [first, last] = [case.step(from)?, case.step(to)?];
    if first > last {
        let problem = format!("{from}..{to}: the first must not come after the last");
        return Err(SceneError::Steps(problem));
    }
    Ok((first..=last).step_by(every.max(1)).collect())
}
