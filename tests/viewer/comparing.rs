//! Comparing: two pictures from one camera.

use eframe::egui::{Key, Modifiers, vec2};
use strataray::scene::{RangeSpec, StepSpec, StrategyKind};
use strataray::view::View;
use strataray::viewer::{Action, CompareLayout, Comparison, Picture};

use super::common::{copy_of_sample, data, gpu, sample};
use super::driven::Driven;

/// Mean CIEDE2000 of pictures of the same: rays pause by time, so single pixels may round differently.
const SAME: f64 = 1e-3;

fn compare(driven: &mut Driven, comparison: Comparison) {
    let action = Action::Compare(Some(comparison));
    driven.harness.state_mut().apply(action);
}

fn view(driven: &Driven, side: usize) -> View {
    let (picture, _) = driven.harness.state().picture(side).unwrap();
    View::clone(&picture.view)
}

#[test]
fn this_step_stands_beside_the_first_one() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let alone = driven.picture(0);
    driven.press(Modifiers::NONE, Key::C);
    driven.wait_final();
    let views = [0, 1].map(|n| view(&driven, n));
    assert_eq!(views.each_ref().map(|v| v.shown.step), [20, 0]);
    assert_eq!(views[0].sampling.strategy, views[1].sampling.strategy);
    assert_eq!(views[0].camera, views[1].camera);
    assert!(2 * views[0].size[0] <= alone.size[0]);
    // A drag on the second one turns both.
    let before = views[0].camera;
    let both = driven.places("volume");
    assert_eq!(both.len(), 2);
    driven.drag(both[1].center(), both[1].center() + vec2(80.0, 0.0));
    driven.wait_final();
    let cameras = [0, 1].map(|n| view(&driven, n).camera);
    assert_eq!(cameras[0], cameras[1]);
    assert_ne!(cameras[0], before);
    // What does not change with time has another strategy beside it.
    driven.press(Modifiers::NONE, Key::C);
    driven
        .harness
        .state_mut()
        .apply(Action::Property("PORO".into()));
    driven.wait_final();
    driven.press(Modifiers::NONE, Key::C);
    driven.wait_final();
    assert_ne!(
        view(&driven, 0).sampling.strategy,
        view(&driven, 1).sampling.strategy
    );
}

#[test]
fn colors_are_compared_of_strategies_and_a_wipe_is_dragged() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let comparison = Comparison {
        layout: CompareLayout::ColorDifference,
        strategy: Some(StrategyKind::Srg),
        ..Comparison::default()
    };
    let mean = |d: &Driven| {
        d.harness
            .state()
            .difference()
            .unwrap()
            .figures
            .ciede2000_mean
    };
    compare(&mut driven, comparison.clone());
    driven.wait_final();
    driven.wait("the difference", |w| w.difference().is_some());
    let strategies = mean(&driven);
    assert!(strategies > 10.0 * SAME && strategies < 3.0, "{strategies}");
    // With itself there is none.
    compare(
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
    compare(
        &mut driven,
        Comparison {
            layout: CompareLayout::Wipe(0.5),
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
        matches!(layout, CompareLayout::Wipe(at) if at < 0.45),
        "{layout:?}"
    );
}

#[test]
fn a_difference_of_steps_is_one_of_values() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::sized(&[sample()], [1280.0, 1400.0], false);
    driven.wait_final();
    driven.click("Compare");
    driven.wait_settled();
    driven.click("Difference");
    driven.wait_final();
    let shown = view(&driven, 0);
    assert!(driven.harness.state().picture(1).is_none());
    assert_eq!(
        (shown.shown.property.as_str(), shown.shown.step),
        ("SOIL-SOIL@0", 20)
    );
    let case = driven.document().case.clone().unwrap();
    let [now, then] = [20, 0].map(|step| case.field("SOIL", step).unwrap());
    for (n, v) in shown.shown.cells.field.values().iter().enumerate() {
        assert_eq!(*v, now.values()[n] - then.values()[n]);
    }
    // Around 0, where neither color is.
    let [low, high] = shown.style.transfer.true_range();
    assert!(low == -high && high > 0.3, "{low} {high}");
    let middle = shown.style.transfer.srgb(0.5);
    assert!(middle.iter().all(|v| *v > 0.8), "{middle:?}");
    // Its colors are its own, and the property keeps what it had.
    let before = driven.scene().clone();
    let range = RangeSpec::Fixed([-0.2, 0.2]);
    driven.harness.state_mut().apply(Action::Range(range));
    driven.wait_final();
    assert_eq!(view(&driven, 0).style.transfer.true_range(), [-0.2, 0.2]);
    assert_eq!(driven.scene(), &before);
    driven.press(Modifiers::COMMAND, Key::Z);
    driven.wait_final();
    assert_eq!(view(&driven, 0).style.transfer.true_range(), [low, high]);
    // Time goes on in the difference; a property that stays the same has none.
    driven.press(Modifiers::NONE, Key::Home);
    driven.wait_final();
    assert!(
        view(&driven, 0)
            .shown
            .cells
            .field
            .values()
            .iter()
            .all(|v| *v == 0.0 || v.is_nan())
    );
    driven
        .harness
        .state_mut()
        .apply(Action::Property("PORO".into()));
    driven.wait("the reason", |w| {
        matches!(w.difference_of_values(), Some(Err(why)) if why.contains("does not change with time"))
    });
}

#[test]
fn a_difference_of_cases_is_made_cell_by_cell() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let copy = copy_of_sample(folder.path());
    let mut driven = Driven::open(&[copy.clone(), sample()]);
    driven.wait_final();
    let of = |case: &std::path::Path, step: Option<usize>| Comparison {
        layout: CompareLayout::Difference,
        case: Some(case.to_owned()),
        step: step.map(StepSpec::Index),
        ..Comparison::default()
    };
    compare(&mut driven, of(&copy, None));
    driven.wait_final();
    let shown = view(&driven, 0);
    assert_eq!(shown.shown.property, "SOIL-SOIL@SCISSOR");
    assert!(
        shown
            .shown
            .cells
            .field
            .values()
            .iter()
            .all(|v| *v == 0.0 || v.is_nan())
    );
    // Against the first step of the other one.
    compare(&mut driven, of(&copy, Some(0)));
    driven.wait("the first step", |w| {
        let oil = |p: &Picture| {
            p.view
                .shown
                .cells
                .field
                .values()
                .iter()
                .any(|v| v.abs() > 0.3)
        };
        w.picture(0).is_some_and(|(p, is_final)| is_final && oil(p))
    });
    // Cells are picked in it, with the value that is seen.
    let place = driven.place("volume");
    driven.click_at(place.center(), Modifiers::NONE);
    driven.wait("the cell", |w| {
        w.document().is_some_and(|d| d.table.is_some())
    });
    let table = driven.document().table.clone().unwrap();
    assert!(table.rows.iter().any(|r| r.0 == "SOIL-SOIL@SCISSOR"));
    // Grids of other sizes have no difference, and it is said why.
    if let Some(other) = data("spe1/SPE1CASE1.EGRID") {
        let mut driven = Driven::open(&[other.clone(), sample()]);
        driven.wait_final();
        compare(&mut driven, of(&other, None));
        driven.wait("the reason", |w| {
            matches!(w.difference_of_values(), Some(Err(why)) if why.contains("40 x 30 x 10 cells"))
        });
        driven.wait_final();
    }
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
        let covered_by = |d: &Driven| d.covered_by(1);
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
