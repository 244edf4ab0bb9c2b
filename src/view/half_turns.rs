//! Views from all sides: half a turn of the camera about one axis, or about each in turn.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};

use super::{Camera, View};
use crate::scene::Scene;

/// A view of a row of them.
#[derive(Debug, Clone)]
pub struct NamedView {
    /// What tells it from the others, such as `x 90°`.
    pub name: String,
    /// The view.
    pub view: View,
}

/// What the camera turns about, through the model's middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TurnAxis {
    /// The axis to the east.
    X,
    /// The axis to the north.
    Y,
    /// The vertical.
    Z,
    /// All three, one after another.
    All,
}

/// An axis of world space.
struct Axis {
    name: char,
    direction: DVec3,
}

const AXES: [Axis; 3] = [
    Axis {
        name: 'x',
        direction: DVec3::X,
    },
    Axis {
        name: 'y',
        direction: DVec3::Y,
    },
    Axis {
        name: 'z',
        direction: DVec3::Z,
    },
];

impl Axis {
    /// Turns the camera; the model seems to turn the other way, counterclockwise about the axis.
    fn turn(&self, angle: f64) -> DQuat {
        DQuat::from_axis_angle(self.direction, -angle)
    }
}

impl TurnAxis {
    fn axes(self) -> &'static [Axis] {
        match self {
            Self::X => &AXES[..1],
            Self::Y => &AXES[1..2],
            Self::Z => &AXES[2..],
            Self::All => &AXES,
        }
    }

    /// Which of the axes view `n` of `count` has come to, and the angle about it.
    fn place(self, n: usize, count: usize) -> (usize, f64) {
        // All three end at the start, which is not shown again; one alone shows its end.
        let parts = match self {
            Self::All => count,
            _ => (count - 1).max(1),
        };
        let gone = self.axes().len() * n;
        let axis = gone.saturating_sub(1) / parts;
        (axis, PI * (gone - axis * parts) as f64 / parts as f64)
    }
}

/// `count` views in all on the way of a scene's camera in half turns, at constant distance from the
/// middle of what is drawn. `view` is the scene's own, in whose direction the first one looks.
///
/// Half a turn about one axis ends with the view from the other side. Half turns about x, y and z, one
/// after another, lead back to the start, which is not shown again. A camera that frames what is drawn
/// looks at the middle and stands as far away as the view that needs the most.
pub fn half_turns(scene: &Scene, view: &View, about: TurnAxis, count: usize) -> Vec<NamedView> {
    let middle = view.world.subject.middle;
    let start = view.turning_camera(&scene.camera);
    let placed: Vec<_> = (0..count).map(|n| about.place(n, count)).collect();
    let camera = |&(at, angle): &(usize, f64)| {
        let done = about.axes()[..at].iter().map(|axis| axis.turn(PI));
        let done = done.fold(DQuat::IDENTITY, |before, turn| turn * before);
        start
            .turned(middle, about.axes()[at].turn(angle) * done)
            .before(&view.world.corners)
    };
    let mut cameras: Vec<Camera> = placed.iter().map(camera).collect();
    if scene.camera.framing_zoom().is_some() {
        Camera::stand_back(
            &mut cameras,
            &view.world.subject.points,
            middle,
            view.aspect(),
        );
    }
    let named = |((at, angle), camera): ((usize, f64), Camera)| NamedView {
        name: format!("{} {:.0}°", about.axes()[at].name, angle.to_degrees()),
        view: View {
            camera,
            ..view.clone()
        },
    };
    placed.into_iter().zip(cameras).map(named).collect()
}
