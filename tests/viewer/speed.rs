//! What a hand at the mouse notices, by its causes: no time is measured here (`strataray bench --turn` does).

use eframe::egui::{Key, Modifiers, Pos2, vec2};
use strataray::scene::CameraSpec;
use strataray::viewer::{Action, Playback, Window};

use super::common::{data, gpu};
use super::driven::Driven;

/// The scene's camera of the picture shown.
fn drawn(window: &Window) -> Option<CameraSpec> {
    let (picture, _) = window.picture(0)?;
    Some(picture.wanted.scene.camera.clone())
}

/// Turns the model by some moves of the pointer. After each, frames until the picture from there is shown:
/// the drafts that came until then, at most.
fn turned(driven: &mut Driven, from: Pos2, moves: usize) -> u64 {
    driven.harness.hover_at(from);
    driven.step();
    driven.harness.drag_at(from);
    driven.step();
    // Beyond what could still be a click.
    let from = from + vec2(20.0, 0.0);
    driven.harness.hover_at(from);
    driven.step();
    driven.step();
    let mut most = 0;
    for n in 1..=moves {
        let before = driven.harness.state().drafts().made;
        let to = from + vec2(4.0 * n as f32, n as f32);
        driven.harness.hover_at(to);
        driven.step();
        let wanted = driven.scene().camera.clone();
        driven.wait("a picture from there", |w| {
            drawn(w).as_ref() == Some(&wanted)
        });
        most = most.max(driven.harness.state().drafts().made - before);
    }
    driven
        .harness
        .drop_at(from + vec2(4.0 * moves as f32, moves as f32));
    driven.step();
    most
}

#[test]
fn pictures_follow_the_pointer() {
    let Some(_) = gpu() else { return };
    let Some(case) = data("brugge/BRUGGE_0000.EGRID") else {
        return;
    };
    let mut driven = Driven::open(&[case]);
    driven.wait_final();
    for light in ["off", "soft"] {
        driven.click(light);
        driven.wait_final();
        let whole = driven.harness.state().picture(0).unwrap().0;
        let (size, cost, strategy) = (
            whole.rgb.size,
            whole.stats.work,
            whole.view.sampling.strategy,
        );
        let middle = driven.place("volume").center();
        let before = driven.harness.state().drafts().asked;
        let most = turned(&mut driven, middle, 20);
        // One that was on its way when the pointer moved, then one of the newest camera.
        assert!(most <= 2, "{most} drafts after a move");
        let state = driven.harness.state();
        let asked = state.drafts().asked - before;
        let (picture, _) = state.picture(0).unwrap();
        // Where whole pictures are made in time there are no drafts.
        assert!(asked >= 20 || !picture.is_draft, "{asked}");
        let pixels = |s: [u32; 2]| f64::from(s[0]) * f64::from(s[1]);
        let part = pixels(picture.rgb.size) / pixels(size);
        assert!((0.01..=1.0).contains(&part), "{part}");
        // A draft is cheaper by about as much as it is smaller.
        let work = picture.stats.work as f64 / cost.max(1) as f64;
        let is_other = picture.view.sampling.strategy != strategy;
        assert!(
            is_other || work <= 2.0 * part + 0.05,
            "{work} of the work, {part}"
        );
        driven.wait_final();
    }
}

#[test]
fn every_step_that_plays_is_seen() {
    let Some(_) = gpu() else { return };
    let Some(case) = data("brugge/BRUGGE_0000.EGRID") else {
        return;
    };
    let mut driven = Driven::open(&[case]);
    driven.wait_final();
    driven.press(Modifiers::NONE, Key::Home);
    driven.wait_final();
    let pace = Playback {
        steps_per_second: 30.0,
        repeats: false,
    };
    driven.harness.state_mut().apply(Action::Playback(pace));
    driven.press(Modifiers::NONE, Key::Space);
    let seen = std::cell::RefCell::new(vec![0]);
    driven.wait("the end", |w| {
        let (picture, _) = w.picture(0).unwrap();
        let mut seen = seen.borrow_mut();
        if seen.last() != Some(&picture.view.shown.step) {
            seen.push(picture.view.shown.step);
        }
        w.document().is_some_and(|d| d.playing.is_none())
    });
    let (last, count) = driven.document().step().unwrap();
    assert_eq!(last + 1, count);
    assert_eq!(seen.into_inner(), (0..count).collect::<Vec<_>>());
}
