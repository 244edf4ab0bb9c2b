//! Looking: the camera by pointer and keys.

use eframe::egui::{self, Key, Modifiers, vec2};
use glam::DVec3;
use strataray::scene::{CameraSpec, Filter, Show, ShownWells};
use strataray::view::Camera;
use strataray::viewer::Action;

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

fn camera(driven: &Driven) -> Camera {
    driven.harness.state().picture(0).unwrap().0.view.camera
}

#[test]
fn keys_do_all_that_the_pointer_does() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let press = |driven: &mut Driven, modifiers, key| {
        let before = camera(driven);
        driven.press(modifiers, key);
        driven.wait_final();
        (before, camera(driven))
    };
    let (before, parallel) = press(&mut driven, Modifiers::NONE, Key::Num5);
    assert!(before.parallel.is_none() && parallel.parallel.is_some());
    let (before, turned) = press(&mut driven, Modifiers::SHIFT, Key::ArrowRight);
    let [a, b] = [before, turned].map(|c| c.forward.truncate());
    assert!((a.angle_to(b).abs().to_degrees() - 10.0).abs() < 1e-6);
    let (before, above) = press(&mut driven, Modifiers::SHIFT, Key::ArrowUp);
    assert!(above.forward.z < before.forward.z - 0.1);
    let (before, near) = press(&mut driven, Modifiers::NONE, Key::Plus);
    let factor = before.parallel.unwrap() / near.parallel.unwrap();
    assert!((factor - 1.25).abs() < 1e-9, "{factor}");
    let (_, all) = press(&mut driven, Modifiers::NONE, Key::F);
    assert!(all.forward.distance(near.forward) < 1e-6 && all.parallel > near.parallel);
    let (_, perspective) = press(&mut driven, Modifiers::NONE, Key::Num5);
    assert!(perspective.parallel.is_none());
    let (_, below) = press(&mut driven, Modifiers::COMMAND.plus(Modifiers::ALT), Key::B);
    assert!(below.forward.z > 0.99);
}

#[test]
fn what_is_selected_or_drawn_is_framed_from_the_same_direction() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let whole = camera(&driven);
    let corner = Filter {
        i: Some([1, 4].into()),
        j: Some([1, 4].into()),
        ..Filter::default()
    };
    driven.harness.state_mut().apply(Action::Filter(corner));
    driven.wait_final();
    driven.press(Modifiers::NONE, Key::Z);
    driven.wait_final();
    let window = driven.harness.state();
    let (view, case) = (
        window.picture(0).unwrap().0.view.clone(),
        driven.document().case.clone().unwrap(),
    );
    assert!(view.camera.forward.distance(whole.forward) < 1e-9);
    let drawn = view.corners_of(view.drawn_bounds(&case.grid).unwrap());
    let seen = |c: &DVec3, camera: &Camera| camera.project(*c, view.aspect()).unwrap() - 0.5;
    let reach = |camera: &Camera| {
        let reaches = drawn.iter().map(|c| seen(c, camera).abs().max_element());
        reaches.fold(0.0, f64::max)
    };
    let (now, before) = (reach(&view.camera), reach(&whole));
    assert!(now < 0.5 && now > 0.35, "{now} {before}");
    let size = |camera: &Camera| seen(&drawn[0], camera).distance(seen(&drawn[7], camera));
    assert!(size(&view.camera) > 1.5 * size(&whole));
}

#[test]
fn buttons_do_what_the_preset_says() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let middle = driven.place("volume").center();
    let start = camera(&driven);
    // As in Petrel, then as in RMS: the left button zooms.
    driven.press(Modifiers::COMMAND, Key::M);
    driven.press(Modifiers::COMMAND, Key::M);
    driven.drag(middle, middle - vec2(0.0, 60.0));
    driven.wait_final();
    let near = camera(&driven);
    assert!(near.forward.distance(start.forward) < 1e-9);
    assert!((near.eye - start.eye).dot(start.forward) > 0.0);
    // Around to the first preset: it rotates.
    for _ in 0..3 {
        driven.press(Modifiers::COMMAND, Key::M);
    }
    driven.drag(middle, middle - vec2(0.0, 60.0));
    driven.wait_final();
    assert!(camera(&driven).forward.distance(near.forward) > 0.1);
}

#[test]
fn one_switch_shows_index_space_and_undo_brings_the_map_back() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let view = |d: &Driven| d.harness.state().picture(0).unwrap().0.view.clone();
    // A click on a well would open its curves, beside which the image is smaller.
    let show = Show {
        wells: ShownWells::All(false),
        ..driven.scene().show.clone()
    };
    driven.harness.state_mut().apply(Action::Show(show));
    driven.wait_final();
    let before = driven.scene().clone();
    let map = view(&driven);
    assert!(map.world.space.is_map());
    // A camera of the map would see nothing of a model of forty columns.
    let middle = driven.place("volume").center();
    driven.drag(middle, middle + vec2(60.0, 20.0));
    driven.wait_final();
    let turned = camera(&driven);
    driven.press(Modifiers::NONE, Key::I);
    driven.wait_final();
    let flat = view(&driven);
    assert!(!flat.world.space.is_map());
    assert!(flat.world.bounds[1].x < 41.0 && driven.covered() > 0.1);
    // What is clicked has the same name in both, and a drag turns about it.
    driven.click_at(middle, Modifiers::NONE);
    driven.wait("a selected cell", |w| {
        let document = w.document().unwrap();
        !document.state.selected.is_empty()
    });
    driven.drag(middle, middle + vec2(40.0, 0.0));
    driven.wait_final();
    assert!(driven.covered() > 0.1);
    driven.press(Modifiers::COMMAND, Key::Z);
    driven.press(Modifiers::COMMAND, Key::Z);
    driven.wait_final();
    assert_eq!(camera(&driven), turned);
    driven.press(Modifiers::COMMAND, Key::Z);
    driven.wait_final();
    // The image may have another size by now: a selected cell has made the panel beside it wider.
    assert_eq!(driven.scene(), &before);
    let now = view(&driven);
    assert!(now.world.space.is_map() && now.camera.forward == map.camera.forward);
    // The button does what the key does.
    driven.click("IJK");
    driven.wait_final();
    assert!(!view(&driven).world.space.is_map());
    driven.click("IJK");
    driven.wait_final();
    assert!(view(&driven).world.space.is_map());
}
