//! Looking: the camera by pointer and keys.

use eframe::egui::{self, Key, Modifiers, vec2};
use strataray::scene::CameraSpec;

use super::common::{gpu, sample};
use super::driven::Driven;

#[test]
fn a_drag_turns_the_model_and_the_wheel_comes_closer() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let camera = |d: &Driven| d.harness.state().picture(0).unwrap().0.view.camera;
    let (before, picture) = (camera(&driven), driven.picture(0));
    let middle = driven.place("volume").center();
    driven.drag(middle, middle + vec2(120.0, 30.0));
    driven.wait_final();
    let turned = camera(&driven);
    assert!(turned.forward.dot(before.forward) < 0.95);
    assert!(turned.right.z.abs() < 1e-9, "the horizon stays level");
    assert!(driven.picture(0) != picture);
    driven.harness.hover_at(middle);
    driven.step();
    driven.harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 100.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    for _ in 0..20 {
        driven.step();
    }
    driven.wait_final();
    assert!(camera(&driven).eye.distance(turned.eye) > 0.0);
    // A drag is one change, and so is what the wheel did.
    driven.press(Modifiers::COMMAND, Key::Z);
    driven.press(Modifiers::COMMAND, Key::Z);
    driven.wait_final();
    assert_eq!(camera(&driven), before);
}

#[test]
fn keys_look_from_all_sides() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let ctrl_alt = Modifiers::COMMAND.plus(Modifiers::ALT);
    let mut seen = Vec::new();
    for key in [Key::N, Key::S, Key::E, Key::W, Key::T, Key::I] {
        driven.press(ctrl_alt, key);
        assert!(matches!(driven.scene().camera, CameraSpec::Framing(_)));
        driven.wait_final();
        let picture = driven.picture(0);
        assert!(!seen.contains(&picture), "{key:?}");
        seen.push(picture);
    }
    let forward = |d: &Driven| d.harness.state().picture(0).unwrap().0.view.camera.forward;
    driven.press(ctrl_alt, Key::N);
    driven.wait_final();
    assert!(forward(&driven).y > 0.99);
}
