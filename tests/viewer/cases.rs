//! Several open cases on one grid.

use std::sync::Arc;

use eframe::egui::{Key, Modifiers};
use strataray::scene::{Mode, StepSpec};
use strataray::viewer::Action;

use super::common::{copy_of_sample, gpu, sample};
use super::driven::Driven;

#[test]
fn cases_are_stepped_through_and_taken_together() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let copy = copy_of_sample(folder.path());
    let mut driven = Driven::open(&[sample(), copy.clone()]);
    driven.wait_final();
    let grid = |d: &Driven| d.document().case.as_ref().unwrap().grid.clone();
    let first = grid(&driven);
    assert_eq!(driven.document().path, copy);
    for action in [Action::Step(3), Action::Mode(Mode::Cells)] {
        driven.harness.state_mut().apply(action);
    }
    driven.press(Modifiers::COMMAND, Key::PageDown);
    driven.wait_final();
    // The other tab is in front, looks as this one did, and holds the same grid.
    assert_eq!(driven.document().path, sample());
    let scene = driven.scene();
    assert_eq!(
        (&scene.step, scene.mode),
        (&StepSpec::Index(3), Mode::Cells)
    );
    assert!(Arc::ptr_eq(&first, &grid(&driven)));
    driven.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    driven.wait_final();
    assert_eq!(driven.document().others.len(), 1);
    assert!(Arc::ptr_eq(&first, &grid(&driven)));
    let spread = Action::Property("SOIL.STD".into());
    driven.harness.state_mut().apply(spread);
    driven.wait_final();
    let (picture, _) = driven.harness.state().picture(0).unwrap();
    assert_eq!(picture.view.shown.property, "SOIL.STD");
    let values = picture.view.shown.cells.field.values();
    // Both cases are one and the same.
    assert!(values.iter().all(|v| *v == 0.0));
}
