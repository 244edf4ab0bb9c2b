//! What the buttons of the mouse and a touchpad do, as a table of presets.

use eframe::egui::{self, Modifiers, PointerButton, Rect, Ui};
use glam::DVec2;

use super::settings::Mouse;

/// What a drag does to the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Turns it around what is under the pointer.
    Rotate,
    /// Moves it across.
    Pan,
    /// Comes closer where one drags up, to where the drag began.
    Zoom,
}

/// A button with keys held down, and what dragging with it does.
type Binding = (PointerButton, Modifiers, Motion);

/// What every preset has, so that a touchpad needs no other button than the left one.
const LEFT: [Binding; 2] = [
    (PointerButton::Primary, Modifiers::SHIFT, Motion::Pan),
    (PointerButton::Primary, Modifiers::COMMAND, Motion::Rotate),
];
const STANDARD: [Binding; 3] = [
    (PointerButton::Primary, Modifiers::NONE, Motion::Rotate),
    (PointerButton::Middle, Modifiers::NONE, Motion::Pan),
    (PointerButton::Secondary, Modifiers::NONE, Motion::Zoom),
];
const GEOQUEST: [Binding; 2] = [
    (PointerButton::Primary, Modifiers::NONE, Motion::Rotate),
    (PointerButton::Middle, Modifiers::NONE, Motion::Pan),
];
const RMS: [Binding; 3] = [
    (PointerButton::Primary, Modifiers::NONE, Motion::Zoom),
    (PointerButton::Middle, Modifiers::NONE, Motion::Rotate),
    (PointerButton::Secondary, Modifiers::NONE, Motion::Pan),
];
const CAD: [Binding; 3] = [
    (PointerButton::Primary, Modifiers::NONE, Motion::Pan),
    (PointerButton::Middle, Modifiers::SHIFT, Motion::Pan),
    (PointerButton::Middle, Modifiers::NONE, Motion::Rotate),
];
const CEETRON: [Binding; 3] = [
    (PointerButton::Primary, Modifiers::NONE, Motion::Pan),
    (PointerButton::Middle, Modifiers::NONE, Motion::Zoom),
    (PointerButton::Secondary, Modifiers::NONE, Motion::Rotate),
];

impl Mouse {
    /// Its bindings; the first that fits counts.
    fn bindings(self) -> impl Iterator<Item = &'static Binding> {
        let own: &[Binding] = match self {
            Self::Standard => &STANDARD,
            Self::Geoquest => &GEOQUEST,
            Self::Rms => &RMS,
            Self::Cad => &CAD,
            Self::Ceetron => &CEETRON,
        };
        LEFT.iter().chain(own)
    }

    /// What a drag with a button does while keys are held down.
    pub fn motion(self, button: PointerButton, held: Modifiers) -> Option<Motion> {
        let fits = |(b, m, _): &&Binding| *b == button && held.contains(*m);
        self.bindings().find(fits).map(|b| b.2)
    }

    /// Each drag and what it does, for people.
    pub fn describe(self) -> impl Iterator<Item = (String, &'static str)> {
        let drags = self.bindings().map(|(button, held, motion)| {
            let button = match button {
                PointerButton::Primary => "left drag",
                PointerButton::Middle => "middle drag",
                _ => "right drag",
            };
            let keys = match (held.shift, held.command) {
                (true, _) => "Shift + ",
                (_, true) => "Ctrl + ",
                _ => "",
            };
            let does = match motion {
                Motion::Rotate => "Rotates about the point under the pointer",
                Motion::Pan => "Pans",
                Motion::Zoom => "Zooms",
            };
            (format!("{keys}{button}"), does)
        });
        let wheel = "Wheel, two fingers or pinch".to_owned();
        drags.chain([(wheel, "Zooms toward the pointer")])
    }
}

/// Zoom of a turn of the wheel by a point.
const WHEEL: f64 = 0.004;
/// Zoom of a drag across the height of the picture, as a power of e.
const DRAG: f64 = 3.0;

/// The pointer in terms of the picture.
pub struct Input {
    /// Where it is, 0 to 1 to the right and down.
    pub at: Option<DVec2>,
    /// A drag: what it does, and how far it went in parts of the picture's height.
    pub drag: Option<(Motion, DVec2)>,
    /// Factor by which the wheel or a pinch comes closer.
    pub zoom: Option<f64>,
}

impl Input {
    /// What was done over the picture in this frame.
    pub fn of(ui: &Ui, response: &egui::Response, rect: Rect, mouse: Mouse) -> Self {
        let pointer = response.hover_pos().or(response.interact_pointer_pos());
        let at = pointer.map(|p| {
            let at = (p - rect.min) / rect.size();
            DVec2::new(f64::from(at.x), f64::from(at.y))
        });
        let by = response.drag_delta() / rect.height().max(1.0);
        let by = DVec2::new(f64::from(by.x), f64::from(by.y));
        let held = ui.input(|i| i.modifiers);
        let buttons = [
            PointerButton::Primary,
            PointerButton::Middle,
            PointerButton::Secondary,
        ];
        let button = buttons.into_iter().find(|b| response.dragged_by(*b));
        let motion = button.and_then(|b| mouse.motion(b, held));
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta, i.zoom_delta()));
        let factor = f64::from(pinch) * (WHEEL * f64::from(scroll.y)).exp();
        let zoom = (response.hovered() && factor != 1.0).then_some(factor);
        Self {
            at,
            drag: motion.map(|motion| (motion, by)),
            zoom,
        }
    }
}

/// Factor by which a drag comes closer.
pub fn drag_zoom(by: DVec2) -> f64 {
    (-DRAG * by.y).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dragging_up_comes_closer() {
        assert!(drag_zoom(DVec2::new(0.0, -0.1)) > 1.0 && drag_zoom(DVec2::Y) < 1.0);
    }

    #[test]
    fn every_preset_does_all_with_the_left_button() {
        let left = PointerButton::Primary;
        for mouse in Mouse::ALL {
            let motion = |held| mouse.motion(left, held);
            assert_eq!(motion(Modifiers::SHIFT), Some(Motion::Pan));
            assert_eq!(motion(Modifiers::COMMAND), Some(Motion::Rotate));
        }
    }

    #[test]
    fn presets_are_those_of_the_programs() {
        let buttons = [
            PointerButton::Primary,
            PointerButton::Middle,
            PointerButton::Secondary,
        ];
        let plain = |mouse: Mouse| buttons.map(|b| mouse.motion(b, Modifiers::NONE));
        let [rotate, pan, zoom] = [Motion::Rotate, Motion::Pan, Motion::Zoom].map(Some);
        assert_eq!(plain(Mouse::Standard), [rotate, pan, zoom]);
        assert_eq!(plain(Mouse::Geoquest), [rotate, pan, None]);
        assert_eq!(plain(Mouse::Rms), [zoom, rotate, pan]);
        assert_eq!(plain(Mouse::Cad), [pan, rotate, None]);
        assert_eq!(plain(Mouse::Ceetron), [pan, zoom, rotate]);
        let shifted = Mouse::Cad.motion(PointerButton::Middle, Modifiers::SHIFT);
        assert_eq!(shifted, pan);
        // Each is reached, and each is named after a program.
        let mut mouse = Mouse::default();
        for _ in Mouse::ALL {
            mouse = mouse.next();
            assert!(mouse.describe().count() > 4);
        }
        assert_eq!(mouse, Mouse::default());
        for program in ["Petrel", "RMS", "ResInsight"] {
            assert!(Mouse::ALL.iter().any(|m| m.name().starts_with(program)));
        }
    }
}
