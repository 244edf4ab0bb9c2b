//! Comparing: two pictures from one camera.

use eframe::egui::{Key, Modifiers, vec2};
use strataray::viewer::{Action, Comparison, Layout};

use super::common::{copy_of_sample, data, gpu, sample};
use super::driven::{Driven, covered};

/// Mean CIEDE2000 of pictures of the same: rays pause by time, so single pixels may round differently.
const SAME: f64 = 1e-3;

#[test]
fn two_strategies_stand_beside_each_other() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let alone = driven.picture(0);
    driven.press(Modifiers::NONE, Key::C);
    driven.wait_final();
    let views = [0, 1].map(|n| driven.harness.state().picture(n).unwrap().0.view.clone());
    assert_ne!(views[0].strategy, views[1].strategy);
    assert_eq!(views[0].camera, views[1].camera);
    assert!(2 * views[0].size[0] <= alone.size[0]);
    // A drag on the second one turns both.
    let before = views[0].camera;
    let both = driven.places("volume");
    assert_eq!(both.len(), 2);
    driven.drag(both[1].center(), both[1].center() + vec2(80.0, 0.0));
    driven.wait_final();
    let cameras = [0, 1].map(|n| driven.harness.state().picture(n).unwrap().0.view.camera);
    assert_eq!(cameras[0], cameras[1]);
    assert_ne!(cameras[0], before);
}

#[test]
fn a_difference_is_measured_and_a_wipe_dragged() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let comparison = Comparison {
        layout: Layout::Difference,
        strategy: Some("srg".into()),
        ..Comparison::default()
    };
    let apply =
        |d: &mut Driven, c: Comparison| d.harness.state_mut().apply(Action::Compare(Some(c)));
    apply(&mut driven, comparison.clone());
    driven.wait_final();
    driven.wait("the difference", |w| w.difference().is_some());
    let mean = |d: &Driven| {
        d.harness
            .state()
            .difference()
            .unwrap()
            .figures
            .ciede2000_mean
    };
    let strategies = mean(&driven);
    assert!(strategies > 10.0 * SAME && strategies < 3.0, "{strategies}");
    // With itself there is none; with another step there is more.
    apply(
        &mut driven,
        Comparison {
            strategy: None,
            ..comparison.clone()
        },
    );
    driven.wait_final();
    driven.wait("no difference", |w| {
        w.difference()
            .is_some_and(|d| d.figures.ciede2000_mean < SAME)
    });
    apply(
        &mut driven,
        Comparison {
            strategy: None,
            step: Some(strataray::scene::StepSpec::Index(0)),
            ..comparison.clone()
        },
    );
    driven.wait_final();
    driven.wait("a difference", |w| {
        w.difference()
            .is_some_and(|d| d.figures.ciede2000_mean > 10.0 * SAME)
    });
    apply(
        &mut driven,
        Comparison {
            layout: Layout::Wipe(0.5),
            ..comparison
        },
    );
    driven.wait_final();
    let line = driven.place("wipe").center();
    driven.drag(line, line + vec2(-100.0, 0.0));
    let layout = driven
        .document()
        .state
        .setup
        .comparison
        .as_ref()
        .unwrap()
        .layout;
    assert!(
        matches!(layout, Layout::Wipe(at) if at < 0.45),
        "{layout:?}"
    );
}

#[test]
fn two_cases_are_seen_alike_wherever_they_lie() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut others = vec![copy_of_sample(folder.path())];
    others.extend(data("spe1/SPE1CASE1.EGRID"));
    for other in others {
        let mut driven = Driven::open(&[other.clone(), sample()]);
        driven.wait_final();
        driven.press(Modifiers::NONE, Key::Home);
        let comparison = Comparison {
            case: Some(other.clone()),
            ..Comparison::default()
        };
        let action = Action::Compare(Some(comparison));
        driven.harness.state_mut().apply(action);
        driven.wait("both cases", |w| w.picture(1).is_some());
        driven.wait_final();
        let shown = |d: &Driven| d.harness.state().picture(1).unwrap().0.view.clone();
        let covered_by = |d: &Driven| covered(&d.picture(1), [255; 3]);
        assert!(covered_by(&driven) > 0.03, "{}", other.display());
        // A drag on either turns both.
        let before = shown(&driven).camera;
        for place in driven.places("volume") {
            driven.drag(place.center(), place.center() + vec2(40.0, 0.0));
        }
        driven.wait_final();
        assert!(covered_by(&driven) > 0.03, "{}", other.display());
        let turned = shown(&driven).camera;
        assert!(turned.forward.dot(before.forward) < 0.999);
        let first = driven.harness.state().picture(0).unwrap().0.view.camera;
        assert!(turned.forward.distance(first.forward) < 1e-6);
    }
}
