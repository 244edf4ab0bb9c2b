//! The views that make a film: over time steps, or once around the model.

use glam::DQuat;

use super::look::default_property;
use super::resolve::resolve_over;
use super::{Camera, SceneError, View, resolve};
use crate::case::Case;
use crate::scene::{RangeSpec, ScaleSpec, Scene, StepSpec};

/// A way around the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// How far the camera's azimuth changes; below 0 the other way around.
    pub degrees: f64,
    /// Number of views.
    pub views: usize,
}

impl Turn {
    /// Angles from the first view on. A full turn does not show that one a second time; a part of a
    /// turn ends at its last angle.
    fn radians(self) -> impl Iterator<Item = f64> {
        let full = self.degrees % 360.0 == 0.0;
        let gaps = if full { self.views } else { self.views - 1 };
        let each = self.degrees.to_radians() / gaps.max(1) as f64;
        (0..self.views).map(move |n| n as f64 * each)
    }
}

/// A row of views, each made when it is asked for.
///
/// **Invariants**: at least one view; all have the same range of values, hence the same colors and
/// opacities for the same values.
#[derive(Debug, Clone)]
pub struct Sequence {
    views: Views,
    left_out: Vec<String>,
}

#[derive(Debug, Clone)]
enum Views {
    Steps {
        scene: Box<Scene>,
        steps: Vec<usize>,
        range: [f64; 2],
    },
    Turn {
        scene: Box<Scene>,
        view: Box<View>,
        turn: Turn,
        cameras: Vec<Camera>,
    },
}

impl Sequence {
    /// The scene at each of `steps`, over one range of values: the scene's, or that of all steps,
    /// which are looked at one after another. Steps without the scene's values are left out.
    ///
    /// `progress` is told the fraction done and returns false to cancel; the result is `None` then.
    ///
    /// # Errors
    /// When the property does not change with time, or the scene cannot be shown at one of the steps.
    pub fn over_steps(
        scene: &Scene,
        case: &Case,
        steps: &[usize],
        progress: &dyn Fn(f64) -> bool,
    ) -> Result<Option<Self>, SceneError> {
        let name = scene.property.clone();
        let property = name.unwrap_or_else(|| default_property(case));
        if !case.is_dynamic(&property) {
            // That there is no such property would be the more telling error.
            resolve(scene, case)?;
            return Err(SceneError::Static(property));
        }
        let (mut range, mut used, mut left_out) = (None, Vec::new(), Vec::new());
        let mut missing = None;
        // A step without values above 0 has a place in the range of a log scale over all of them.
        let mut linear = scene.clone();
        linear.transfer.scale = match scene.range {
            RangeSpec::Fixed(_) => scene.transfer.scale,
            RangeSpec::Own(_) => ScaleSpec::Linear,
        };
        for (n, &step) in steps.iter().enumerate() {
            match resolve(&at_step(&linear, step), case) {
                Ok(view) => {
                    used.push(step);
                    range = union(range, defined_range(scene, &view));
                }
                Err(SceneError::Case(error)) if error.is_gap() => {
                    left_out.push(format!("step {step} is left out: {error}"));
                    missing = Some(error);
                }
                Err(error) => return Err(error),
            }
            if !progress((n + 1) as f64 / steps.len() as f64) {
                return Ok(None);
            }
        }
        if used.is_empty() {
            return Err(missing.map_or_else(
                || SceneError::Steps("none is chosen".into()),
                SceneError::Case,
            ));
        }
        Ok(Some(Self {
            views: Views::Steps {
                scene: Box::new(scene.clone()),
                steps: used,
                range: range.unwrap_or([0.0, 1.0]),
            },
            left_out,
        }))
    }

    /// The scene from all around the vertical line through the middle of what is drawn, beginning where its
    /// camera is. A camera that frames what is drawn looks at that middle and stands back as far as the whole
    /// turn needs.
    ///
    /// # Errors
    /// When the scene cannot be shown, or the turn has no views or no finite angle.
    pub fn around(scene: &Scene, case: &Case, turn: Turn) -> Result<Self, SceneError> {
        if turn.views < 1 || !turn.degrees.is_finite() {
            return Err(SceneError::Turn);
        }
        let view = resolve(scene, case)?;
        Ok(Self {
            views: Views::Turn {
                cameras: cameras(scene, &view, turn),
                scene: Box::new(scene.clone()),
                view: Box::new(view),
                turn,
            },
            left_out: Vec::new(),
        })
    }

    /// The same views in another size.
    ///
    /// # Errors
    /// When the size is not allowed.
    pub fn sized(mut self, size: [u32; 2]) -> Result<Self, SceneError> {
        match &mut self.views {
            Views::Steps { scene, .. } => scene.size = size,
            Views::Turn {
                scene,
                view,
                turn,
                cameras: all,
            } => {
                **view = view.seen_from(&scene.camera, size)?;
                *all = cameras(scene, view, *turn);
            }
        }
        Ok(self)
    }

    /// Number of views.
    pub fn count(&self) -> usize {
        match &self.views {
            Views::Steps { steps, .. } => steps.len(),
            Views::Turn { cameras, .. } => cameras.len(),
        }
    }

    /// Sentences about steps that are not shown.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// True values at both ends of the color map in every view.
    pub fn range(&self) -> [f64; 2] {
        match &self.views {
            Views::Steps { range, .. } => *range,
            Views::Turn { view, .. } => view.style.transfer.true_range(),
        }
    }

    /// The view number `n` (the last one for any beyond it) of the case that the sequence was made of.
    ///
    /// # Errors
    /// When the values cannot be read anymore.
    pub fn view(&self, n: usize, case: &Case) -> Result<View, SceneError> {
        let n = n.min(self.count() - 1);
        Ok(match &self.views {
            Views::Steps {
                scene,
                steps,
                range,
            } => resolve_over(&at_step(scene, steps[n]), case, Some(*range))?,
            Views::Turn { view, cameras, .. } => View {
                camera: cameras[n],
                ..View::clone(view)
            },
        })
    }
}

/// The cameras of a turn of a scene, whose own view is given.
fn cameras(scene: &Scene, view: &View, turn: Turn) -> Vec<Camera> {
    let middle = view.world.subject.middle;
    let start = view.turning_camera(&scene.camera);
    let turned = |a: f64| {
        let turned = start.turned(middle, DQuat::from_rotation_z(-a));
        turned.before(&view.world.corners)
    };
    let mut cameras: Vec<Camera> = turn.radians().map(turned).collect();
    if scene.camera.framing_zoom().is_some() {
        Camera::stand_back(
            &mut cameras,
            &view.world.subject.points,
            middle,
            view.aspect(),
        );
    }
    cameras
}

fn at_step(scene: &Scene, step: usize) -> Scene {
    Scene {
        step: StepSpec::Index(step),
        ..scene.clone()
    }
}

/// The scene's range, or that of the values of one step; `None` where none is defined.
fn defined_range(scene: &Scene, view: &View) -> Option<[f64; 2]> {
    let fixed = matches!(scene.range, RangeSpec::Fixed(_));
    let defined = fixed || view.shown.cells.value_range().is_some();
    defined.then(|| view.style.transfer.true_range())
}

fn union(a: Option<[f64; 2]>, b: Option<[f64; 2]>) -> Option<[f64; 2]> {
    match (a, b) {
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
        _ => a.or(b),
    }
}
