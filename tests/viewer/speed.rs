//! Speed: what a hand at the mouse notices.

use std::time::{Duration, Instant};

use eframe::egui::{Key, Modifiers, Pos2, vec2};
use strataray::viewer::{Action, Pace};

use super::common::{data, gpu};
use super::driven::Driven;

/// From a move of the pointer to the picture from there, and the longest frame meanwhile.
fn rotated(driven: &mut Driven, from: Pos2, moves: usize) -> (Vec<Duration>, Duration) {
    let camera = |d: &Driven| d.harness.state().picture(0).unwrap().0.view.camera;
    driven.harness.hover_at(from);
    driven.step();
    driven.harness.drag_at(from);
    driven.step();
    // Beyond what could still be a click.
    let from = from + vec2(20.0, 0.0);
    driven.harness.hover_at(from);
    driven.step();
    driven.step();
    driven.slowest = Duration::ZERO;
    let mut took = Vec::new();
    for n in 1..=moves {
        let before = camera(driven);
        let start = Instant::now();
        driven
            .harness
            .hover_at(from + vec2(4.0 * n as f32, n as f32));
        driven.wait("a picture from there", |w| {
            w.picture(0).unwrap().0.view.camera != before
        });
        took.push(start.elapsed());
    }
    driven
        .harness
        .drop_at(from + vec2(4.0 * moves as f32, moves as f32));
    driven.step();
    took.sort();
    (took, driven.slowest)
}

#[test]
fn pictures_follow_the_pointer_and_no_frame_waits() {
    let Some(_) = gpu() else { return };
    let Some(case) = data("brugge/BRUGGE_0000.EGRID") else {
        return;
    };
    let start = Instant::now();
    let mut driven = Driven::open(&[case]);
    driven.wait("the first picture", |w| w.picture(0).is_some());
    let first = start.elapsed();
    driven.wait_final();
    eprintln!(
        "first picture after {first:?}, final one after {:?}",
        start.elapsed()
    );
    let loading = driven.slowest;
    for light in ["off", "soft"] {
        driven.click(light);
        driven.wait_final();
        let middle = driven.place("volume").center();
        let (took, slowest) = rotated(&mut driven, middle, 30);
        let median = took[took.len() / 2];
        eprintln!(
            "brugge, 1280x800, light {light}: input to picture {median:?} (median of {}), {:?} at most; \
             longest frame {loading:?} while loading, {slowest:?} while rotating",
            took.len(),
            took.last().unwrap()
        );
        // The goals are 100 ms and 250 ms on a quiet machine; a machine that tests other things at the
        // same time gets twice that.
        assert!(median < Duration::from_millis(200), "{median:?}");
        assert!(loading < Duration::from_millis(500), "{loading:?}");
        driven.wait_final();
    }
    let played = steps_a_second(&mut driven);
    eprintln!("{played:.1} steps a second play");
    assert!(played > 1.0, "{played}");
}

/// Steps that play in a second, as fast as they come.
fn steps_a_second(driven: &mut Driven) -> f64 {
    driven.click("off");
    driven.press(Modifiers::NONE, Key::Home);
    driven.wait_final();
    let pace = Pace {
        steps_a_second: 30.0,
        repeats: false,
    };
    driven.harness.state_mut().apply(Action::Pace(pace));
    let start = Instant::now();
    driven.press(Modifiers::NONE, Key::Space);
    driven.wait("the end", |w| {
        w.document().is_some_and(|d| d.playing.is_none())
    });
    let (last, count) = driven.document().step().unwrap();
    assert_eq!(last + 1, count);
    last as f64 / start.elapsed().as_secs_f64()
}
