//! Coloring: range, scale, coloring, differences, the opacity curve by keyboard.

use eframe::egui::{Key, Modifiers};
use strataray::scene::{Coloring, OpacitySpec, RangeSpec, ScaleSpec};

use super::common::{gpu, sample};
use super::driven::Driven;

fn points(driven: &Driven) -> Vec<[f64; 2]> {
    match &driven.scene().transfer.opacity {
        Some(OpacitySpec::Points(points)) => points.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn range_scale_and_coloring_are_chosen() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let plain = driven.picture(0);
    driven.click("Range: All steps");
    assert_eq!(driven.scene().range, RangeSpec::STEPS);
    driven.click("Range: Fixed");
    assert!(matches!(driven.scene().range, RangeSpec::Fixed([a, b]) if a < b));
    driven.click("Range: Step");
    assert_eq!(driven.scene().range, RangeSpec::STEP);
    driven.click("Colors: Bands");
    assert_eq!(driven.scene().transfer.coloring, Coloring::Banded);
    driven.wait_final();
    assert!(driven.picture(0) != plain);
    driven.click("DEPTH");
    driven.wait_final();
    driven.click("Scale: Log");
    assert_eq!(driven.scene().transfer.scale, ScaleSpec::Log);
    driven.wait_final();
    // Depths are not whole: a sentence says so.
    driven.click("Colors: Categories");
    assert_eq!(driven.scene().transfer.scale, ScaleSpec::Linear);
    driven.wait("the refusal", |w| {
        w.message()
            .is_some_and(|(text, is_error)| is_error && text.contains("not whole"))
    });
    driven.click("Reset");
    driven.wait_final();
    assert_eq!(driven.scene().transfer.coloring, Coloring::Continuous);
}

#[test]
fn a_difference_to_a_step_is_shown_and_left() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven.click("PRESSURE");
    driven.wait_final();
    driven.click("Difference to");
    driven.wait_settled();
    driven.click("0   2005-01-01");
    driven.wait_final();
    assert_eq!(
        driven.scene().property.as_deref(),
        Some("PRESSURE-PRESSURE@0")
    );
    // It looks as differences do: the same on both sides of zero.
    let RangeSpec::Fixed([low, high]) = driven.scene().range else {
        panic!("{:?}", driven.scene().range);
    };
    assert!(high > 0.0 && low == -high, "{low} {high}");
    driven.wait_settled();
    driven.click("Difference to");
    driven.wait_settled();
    driven.click("none");
    assert_eq!(driven.scene().property.as_deref(), Some("PRESSURE"));
}

#[test]
fn the_curve_is_edited_by_keyboard() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven.click("Ramp");
    let ramp = points(&driven);
    driven.click("Boundaries");
    assert_ne!(points(&driven), ramp);
    driven.click("Ramp");
    let step = driven.document().step();
    let middle = driven.place("opacity curve").center_top() + eframe::egui::vec2(20.0, 20.0);
    driven.click_at(middle, Modifiers::NONE);
    driven.press(Modifiers::NONE, Key::ArrowRight);
    driven.press(Modifiers::SHIFT, Key::ArrowUp);
    let moved = points(&driven);
    assert!((moved[1][1] - ramp[1][1] - 0.01).abs() < 1e-9, "{moved:?}");
    driven.press(Modifiers::NONE, Key::Insert);
    assert_eq!(points(&driven).len(), ramp.len() + 1);
    driven.press(Modifiers::NONE, Key::Delete);
    assert_eq!(points(&driven), moved);
    // The keys were the curve's: the step is the same. Without the focus they are the player's.
    assert_eq!(driven.document().step(), step);
    driven.press(Modifiers::NONE, Key::Escape);
    driven.press(Modifiers::NONE, Key::ArrowLeft);
    assert_ne!(driven.document().step(), step);
}
