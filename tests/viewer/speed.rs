//! Speed: what a hand at the mouse notices.

use std::time::{Duration, Instant};

use eframe::egui::{Pos2, vec2};

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
    let mut driven = Driven::open(&[case]);
    driven.wait_final();
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
}
