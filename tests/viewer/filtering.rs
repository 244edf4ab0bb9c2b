//! Filtering: I, J, K, single slices, values, categories, faults.

use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use strataray::scene::{Filter, Indices, ShownFaults};
use strataray::viewer::{Action, Counts};

use super::common::{gpu, sample};
use super::driven::Driven;

/// Cells that the picture draws.
fn drawn(driven: &Driven) -> usize {
    let (picture, _) = driven.harness.state().picture(0).unwrap();
    picture
        .view
        .shown
        .cells
        .drawn
        .iter()
        .filter(|d| **d)
        .count()
}

/// Types into a field in place of what is there.
fn type_into(driven: &mut Driven, label: &str, text: &str) {
    let place = driven.place(label).center();
    driven.click_at(place, Modifiers::NONE);
    driven.press(Modifiers::COMMAND, Key::A);
    driven.harness.get_by_label(label).type_text(text);
    driven.step();
    driven.press(Modifiers::NONE, Key::Enter);
}

#[test]
fn rows_and_lists_take_cells_away() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let all = driven.covered();
    let handle = driven.place("Last I").center();
    driven.drag(handle, handle - vec2(60.0, 0.0));
    let Some(Indices::Range([1, last])) = driven.scene().filter.i else {
        panic!("{:?}", driven.scene().filter);
    };
    assert!(last < 35, "{last}");
    driven.wait_final();
    let some = driven.covered();
    assert!(some < 0.9 * all, "{some} {all}");
    driven.click("Clear filters");
    driven.wait_final();
    // Sums may round differently at an edge.
    assert!((driven.covered() - all).abs() < 1e-4);
    // A list stays as it was typed; one that cannot be understood changes nothing and is said.
    type_into(&mut driven, "List of K", "2,4-6,8-10:2");
    let list = Some(Indices::List("2,4-6,8-10:2".into()));
    assert_eq!(driven.scene().filter.k, list);
    type_into(&mut driven, "List of K", "4-11");
    assert_eq!(driven.scene().filter.k, list);
    driven
        .harness
        .get_by_label("4-11 does not lie within 1 to 10");
    type_into(&mut driven, "List of K", "1-10");
    assert_eq!(driven.scene().filter, Filter::default());
}

#[test]
fn slices_are_stepped_through_by_key() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let all = drawn(&driven);
    let k = |d: &Driven| d.scene().filter.k.clone();
    driven.press(Modifiers::NONE, Key::PageDown);
    driven.press(Modifiers::NONE, Key::PageDown);
    assert_eq!(k(&driven), Some([2, 2].into()));
    driven.wait_final();
    let slice = drawn(&driven);
    assert!(slice > 0 && slice < all / 5, "{slice} {all}");
    driven.press(Modifiers::NONE, Key::PageUp);
    driven.press(Modifiers::NONE, Key::PageUp);
    assert_eq!(k(&driven), Some([1, 1].into()));
    // The next axis after K is I.
    driven.press(Modifiers::SHIFT, Key::PageDown);
    assert_eq!(k(&driven), None);
    assert_eq!(driven.scene().filter.i, Some([20, 20].into()));
    // Off, the section is the face of a cut.
    driven.click("Section only");
    assert_eq!(driven.scene().filter.i, Some([20, 40].into()));
    driven.wait_final();
    assert!(drawn(&driven) > all / 3);
    driven.press(Modifiers::NONE, Key::PageDown);
    assert_eq!(driven.scene().filter.i, Some([21, 40].into()));
    assert_eq!(driven.harness.state().message().unwrap().0, "I 21 of 40");
}

#[test]
fn a_new_filter_hides_nothing_until_a_handle_is_moved() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::sized(&[sample()], [1280.0, 1400.0], false);
    driven.wait_final();
    let all = drawn(&driven);
    driven.click("Property filters");
    driven.wait_settled();
    driven.click("Add a filter");
    driven.wait("the histogram", |w| {
        w.document().is_some_and(|d| !d.spreads.is_empty())
    });
    driven.wait_final();
    assert_eq!(drawn(&driven), all);
    assert!(!driven.scene().filter.limits());
    let name = driven.scene().filter.properties[0].name.clone();
    assert_eq!(name, "SOIL");
    let handle = driven.place("Smallest SOIL").center();
    driven.drag(handle, handle + vec2(120.0, 0.0));
    let filter = driven.scene().filter.properties[0].clone();
    assert!(
        filter.min.is_some_and(|v| v > 0.2) && filter.max.is_none(),
        "{filter:?}"
    );
    driven.wait_final();
    let some = drawn(&driven);
    assert!(some > 0 && some < all);
    // What passes is solid: a pixel that is covered is covered well.
    driven.click("Invert");
    driven.wait_final();
    assert_eq!(drawn(&driven), all - some);
    driven.click("Use this filter");
    driven.wait_final();
    assert_eq!(drawn(&driven), all);
    assert_eq!(driven.scene().filter.properties[0].min, filter.min);
    driven.click("Remove");
    assert_eq!(driven.scene().filter, Filter::default());
}

#[test]
fn categories_are_checked_one_by_one() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::sized(&[sample()], [1280.0, 1400.0], false);
    driven.wait_final();
    let all = drawn(&driven);
    driven
        .harness
        .state_mut()
        .apply(Action::Property("FIPNUM".into()));
    driven.wait_final();
    driven.click("Property filters");
    driven.wait_settled();
    driven.click("Add a filter");
    driven.wait("the categories", |w| {
        w.document().is_some_and(|d| !d.spreads.is_empty())
    });
    let spread = driven.document().spreads[0].clone();
    let Some(Counts::Categories(blocks)) = &spread.counts else {
        panic!("{} has {:?}", spread.property, spread.counts);
    };
    assert_eq!(blocks.len(), 4);
    driven.click("FIPNUM 2");
    driven.click("FIPNUM 4");
    assert_eq!(
        driven.scene().filter.properties[0].values,
        Some(vec![1.0, 3.0])
    );
    driven.wait_final();
    let some = drawn(&driven);
    assert!(some > 0 && some < all);
    driven.click("FIPNUM 2");
    driven.click("FIPNUM 4");
    assert!(!driven.scene().filter.limits());
}

#[test]
fn faults_are_shown_one_by_one() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::sized(&[sample()], [1280.0, 1400.0], false);
    driven.wait_final();
    driven.click("Fault surfaces");
    driven.click("Faults (3)");
    driven.wait_settled();
    let faces = |d: &Driven| {
        let (picture, _) = d.harness.state().picture(0).unwrap();
        let case = d.document().case.as_ref().unwrap();
        picture.view.fault_faces(&case.grid).len()
    };
    driven.wait_final();
    let all = faces(&driven);
    driven.click("F2");
    let left = ["F1", "F3"].map(str::to_owned).to_vec();
    assert_eq!(driven.scene().show.faults, ShownFaults::Named(left));
    driven.wait_final();
    let some = faces(&driven);
    assert!(some > 0 && some < all, "{some} {all}");
    let case = driven.document().case.clone().unwrap();
    // F2 throws most: 46 m in the south.
    let throws = case.largest_throws();
    assert!((40.0..50.0).contains(&throws[1].unwrap()), "{throws:?}");
    driven.click("None");
    assert_eq!(driven.scene().show.faults, ShownFaults::All(false));
}
