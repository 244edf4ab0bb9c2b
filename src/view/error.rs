//! Why a scene cannot be shown, and the checks of single values.

use crate::case::CaseError;

/// Why a scene cannot be shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A field has a value that is not allowed.
    #[error("scene: {field}: {problem}")]
    Field {
        /// Name of the field, dotted.
        field: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// A key is unknown or its value has another form.
    #[error("scene: {0}")]
    Text(String),
    /// The case cannot give what the scene asks for.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// No cell is active.
    #[error("the case has no active cell to show")]
    Empty,
    /// No active cell has a thickness.
    #[error("all active cells of the case have zero thickness; there is nothing to show")]
    Flat,
    /// The property is the same at all steps.
    #[error(
        "{0} is static, so there is no animation over its steps; name a property that changes with time, or animate over the orbit"
    )]
    Static(String),
    /// The steps of a film are not what they should be.
    #[error("steps: {0}")]
    Steps(String),
    /// A turn of the camera is not what it should be.
    #[error("a rotation needs at least one view and a finite number of degrees")]
    Turn,
}

pub(super) fn wrong(field: &'static str, problem: impl Into<String>) -> SceneError {
    SceneError::Field {
        field,
        problem: problem.into(),
    }
}

/// A number above 0.
pub(super) fn positive(field: &'static str, value: f64) -> Result<f64, SceneError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(wrong(field, format!("{value} must be above 0")))
    }
}

/// A number within limits.
pub(super) fn within(
    field: &'static str,
    value: f64,
    [low, high]: [f64; 2],
) -> Result<f64, SceneError> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(wrong(field, format!("{value} must be {low} to {high}")))
    }
}
