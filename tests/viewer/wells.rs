//! Wells and summary vectors in the window.

use eframe::egui::{Modifiers, Rect, vec2};
use egui_kittest::kittest::Queryable;
use strataray::scene::ShownWells;
use strataray::viewer::{Action, CurvePlots, VectorCurves};

use super::common::{self, gpu};
use super::driven::Driven;

/// A window on the Reek model, with the panel of wells open and room for it.
fn reek() -> Option<Driven> {
    gpu()?;
    let mut driven = Driven::showing(common::data("reek/REEK.EGRID")?);
    for panel in ["Property", "Cell filter", "Display", "Wells (8)"] {
        driven.click(panel);
        driven.wait_settled();
    }
    Some(driven)
}

fn wait_vectors(driven: &mut Driven, count: usize) {
    driven.wait("vectors", |w| {
        let vectors = w.document().and_then(|d| d.vectors.as_ref());
        vectors.is_some_and(|v| v.curves.len() == count)
    });
    driven.wait_settled();
}

fn vectors(driven: &Driven) -> &VectorCurves {
    driven.document().vectors.as_ref().unwrap()
}

fn names(driven: &Driven) -> Vec<&str> {
    let curves = vectors(driven).curves.iter();
    curves.map(|c| c.vector.name.as_str()).collect()
}

#[test]
fn a_click_on_a_well_selects_it_with_its_cells_and_curves() {
    let Some(mut driven) = reek() else { return };
    driven.click("OP_5");
    let state = &driven.document().state;
    assert_eq!(state.well.as_deref(), Some("OP_5"));
    // As ICON of the restart file has them.
    let column: Vec<_> = (1..=14).map(|k| [25, 35, k]).collect();
    assert_eq!(state.selected, column);
    wait_vectors(&mut driven, 4);
    assert_eq!(
        names(&driven),
        ["WOPR:OP_5", "WWPR:OP_5", "WWCT:OP_5", "WBHP:OP_5"]
    );
    // No gas is produced. An injector has other ones.
    driven.click("WI_1");
    wait_vectors(&mut driven, 2);
    assert_eq!(names(&driven), ["WBHP:WI_1", "WWIR:WI_1"]);
    // A cell alone is no well.
    let cell = Action::Select([20, 20, 1], strataray::viewer::Beside::Nothing);
    driven.harness.state_mut().apply(cell);
    wait_vectors(&mut driven, 0);
    assert_eq!(driven.document().state.well, None);
}

#[test]
fn a_click_on_a_well_in_the_picture_is_one_on_its_name() {
    let Some(mut driven) = reek() else { return };
    let view = driven.harness.state().picture(0).unwrap().0.view.clone();
    let head = view.shown.wells.heads.iter().find(|h| h.name == "OP_2");
    let at = view
        .camera
        .project(head.unwrap().at, view.aspect())
        .unwrap();
    let place = driven.place("volume");
    let at = place.min + vec2(at.x as f32, at.y as f32) * place.size();
    driven.click_at(at, Modifiers::NONE);
    driven.wait("the well", |w| {
        w.document().is_some_and(|d| d.state.well.is_some())
    });
    assert_eq!(driven.document().state.well.as_deref(), Some("OP_2"));
    assert!(driven.document().state.selected.contains(&[20, 15, 1]));
    wait_vectors(&mut driven, 4);
    assert!(driven.document().state.curves.is_open);
}

#[test]
fn wells_are_listed_hidden_and_filtered_by() {
    let Some(mut driven) = reek() else { return };
    let heads = |driven: &Driven| {
        let (picture, _) = driven.harness.state().picture(0).unwrap();
        picture.view.shown.wells.heads.len()
    };
    assert_eq!(heads(&driven), 8);
    driven.click("Draw OP_1");
    driven.wait_final();
    assert_eq!(heads(&driven), 7);
    assert!(!driven.scene().show.wells.shows("OP_1"));
    // By kind: only those are listed, and hidden.
    driven.click("Kind: water injector");
    driven.wait_settled();
    assert!(driven.harness.query_by_label("Draw OP_2").is_none());
    driven.click("Hide the wells listed");
    driven.wait_final();
    let named = ["OP_2", "OP_3", "OP_4", "OP_5"].map(str::to_owned).to_vec();
    assert_eq!(heads(&driven), named.len());
    match &driven.scene().show.wells {
        ShownWells::Named(names) => {
            let mut names = names.clone();
            names.sort();
            assert_eq!(names, named);
        }
        other => panic!("{other:?}"),
    }
    // Their cells alone.
    let all = driven.covered();
    driven.click("Only connected cells");
    driven.wait_final();
    assert_eq!(driven.scene().filter.wells, ["WI_1", "WI_2", "WI_3"]);
    assert!(driven.covered() < 0.5 * all);
    driven.click("Only connected cells");
    assert!(driven.scene().filter.wells.is_empty());
    driven.click("Kind: all");
    driven.click("Show the wells listed");
    assert_eq!(driven.scene().show.wells, ShownWells::All(true));
}

#[test]
fn vectors_are_chosen_from_a_list_and_saved() {
    let Some(mut driven) = reek() else { return };
    let open = CurvePlots {
        is_open: true,
        ..CurvePlots::default()
    };
    driven.harness.state_mut().apply(Action::Curves(open));
    wait_vectors(&mut driven, 0);
    driven.click("Summary vectors");
    driven.wait_settled();
    driven.harness.get_by_label("434 of 434 vectors");
    driven.harness.get_by_label("Filter vectors").click();
    driven.step();
    driven
        .harness
        .event(eframe::egui::Event::Text("fopr".into()));
    driven.wait_settled();
    for name in ["FOPR", "FOPRH"] {
        driven.harness.get_by_label(name).click();
        driven.step();
    }
    wait_vectors(&mut driven, 2);
    assert_eq!(driven.document().state.curves.vectors, ["FOPR", "FOPRH"]);
    // One unit, one plot: the values at the step shown stand below it.
    let last = vectors(&driven).curves[0].values.last().copied().unwrap();
    let six_digits = format!("FOPR: {last:.2}");
    let window = Rect::from_min_size(Default::default(), vec2(1280.0, 800.0));
    let told = driven.place(&six_digits);
    assert!(window.contains_rect(told), "{told:?}");
    let file = driven.folder.path().join("vectors.csv");
    driven.harness.state().save_vectors(&file).unwrap();
    let mut reader = csv::Reader::from_path(&file).unwrap();
    let heads: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    assert_eq!(heads, ["date", "days", "FOPR [SM3/DAY]", "FOPRH [SM3/DAY]"]);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 45);
    // Dates and days as resdata reads them.
    assert_eq!((&rows[0][0], &rows[0][1]), ("2000-01-02", "1"));
    assert_eq!((&rows[44][0], &rows[44][1]), ("2003-01-02", "1097"));
    assert_eq!(rows[44][2].parse(), Ok(last));
}

#[test]
fn a_click_on_a_plot_goes_to_the_nearest_step() {
    let Some(mut driven) = reek() else { return };
    let chosen = CurvePlots {
        is_open: true,
        vectors: vec!["FOPR".into()],
        ..CurvePlots::default()
    };
    driven.harness.state_mut().apply(Action::Curves(chosen));
    wait_vectors(&mut driven, 1);
    let (step, count) = driven.document().step().unwrap();
    assert_eq!(step + 1, count);
    // The values stand below the plot, whose axis begins at the left.
    let case = driven.document().case.clone().unwrap();
    let last = vectors(&driven).curves[0].values[44];
    let told = driven.place(&format!("FOPR: {last:.2}"));
    driven.click_at(told.left_top() + vec2(60.0, -60.0), Modifiers::NONE);
    driven.wait_settled();
    let now = driven.document().step().unwrap().0;
    assert!(now < step && now < case.steps.len() / 2, "{now}");
}
