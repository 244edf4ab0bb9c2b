//! Opening: cases, broken ones, those whose files change or go.

use std::path::{Path, PathBuf};

use eframe::egui::{self, Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use strataray::viewer::{Action, Settings, Window};

use super::common::{copy_of_sample, gpu, sample, tiny};
use super::driven::Driven;

#[test]
fn a_sample_is_opened_from_the_welcome_page() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::open(&[]);
    driven.step();
    assert!(driven.harness.state().document().is_none());
    driven.click("SCISSOR");
    driven.wait_final();
    assert!(driven.covered() > 0.05);
    driven.harness.get_by_label("volume");
    // It is remembered, in the file that was named.
    let file = driven.folder.path().join("settings.json");
    assert_eq!(Settings::in_file(file).recent.len(), 1);
    // What the window draws has the picture in the middle.
    let image = driven.harness.render().unwrap();
    let place = driven.place("volume");
    let drawn = (0..place.width() as u32).filter(|x| {
        let at = [place.left() as u32 + x, place.center().y as u32];
        image.get_pixel(at[0], at[1]).0[..3] != [255; 3]
    });
    assert!(drawn.count() > 50);
}

#[test]
fn a_broken_case_says_why_and_harms_no_other() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let broken = copy_of_sample(folder.path());
    let bytes = std::fs::read(&broken).unwrap();
    std::fs::write(&broken, &bytes[..bytes.len() / 3]).unwrap();
    let mut driven = Driven::open(&[sample(), broken]);
    driven.wait("the error", |w| {
        w.document().is_some_and(|d| d.error.is_some())
    });
    driven.step();
    let error = driven.document().error.clone().unwrap();
    assert!(
        error.contains("SCISSOR.EGRID") && !error.contains('\n'),
        "{error}"
    );
    driven.harness.get_by_label(&error);
    driven.click("Close");
    driven.wait_final();
    assert!(driven.document().error.is_none());
    assert!(driven.covered() > 0.05);
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("a case is opened by its path".into())
    }
}

#[test]
fn a_dropped_file_opens_in_a_tab() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::open(&[]);
    let file = std::sync::Arc::new(Dropped(sample()));
    driven.harness.input_mut().dropped_files.push(file);
    driven.wait_final();
    assert!(driven.covered() > 0.05);
    driven.click("Close SCISSOR");
    assert!(driven.harness.state().document().is_none());
}

#[test]
fn what_was_read_stays_where_files_are_cut_off_and_files_that_are_gone_end_in_a_sentence() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let case = copy_of_sample(folder.path());
    let mut driven = Driven::showing(case.clone());
    driven.press(Modifiers::NONE, Key::Home);
    driven.wait_final();
    let scene = driven.scene().clone();
    let restart = std::fs::OpenOptions::new()
        .write(true)
        .open(case.with_extension("UNRST"));
    restart.unwrap().set_len(1000).unwrap();
    // A property that was not shown before: files that are not large are in memory.
    driven
        .harness
        .state_mut()
        .apply(Action::Property("PRESSURE".into()));
    driven.wait_final();
    assert_eq!(driven.scene().property.as_deref(), Some("PRESSURE"));
    let message = driven.harness.state().message();
    assert!(message.is_none_or(|m| !m.1), "{message:?}");
    // Nothing that was set is lost.
    driven
        .harness
        .state_mut()
        .apply(Action::Property("SOIL".into()));
    driven.wait_final();
    assert_eq!(driven.scene(), &scene);
    for file in std::fs::read_dir(folder.path()).unwrap() {
        std::fs::remove_file(file.unwrap().path()).unwrap();
    }
    driven.press(Modifiers::NONE, Key::F5);
    driven.wait("an error", |w| {
        w.document().is_some_and(|d| d.error.is_some())
    });
    driven.wait_final();
    assert!(driven.covered() > 0.05);
}

#[test]
fn a_running_simulation_is_followed() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let case = copy_of_sample(folder.path());
    let restart = case.with_extension("UNRST");
    let whole = std::fs::read(&restart).unwrap();
    // The second half of the last step is not written yet.
    std::fs::write(&restart, &whole[..whole.len() - 2000]).unwrap();
    let mut driven = Driven::sized(&[case], [900.0, 600.0], true);
    driven.wait_final();
    let steps = |d: &Driven| d.document().case.as_ref().unwrap().steps.len();
    let before = steps(&driven);
    let shown = driven.document().step().unwrap().0;
    assert_eq!(shown, before - 1);
    std::fs::write(&restart, &whole).unwrap();
    driven.wait("the last step", move |w| {
        let case = w.document().and_then(|d| d.case.as_ref());
        case.is_some_and(|c| c.steps.len() == before + 1)
    });
    driven.wait_final();
    // The window stood on the last step, and does so still.
    assert_eq!(driven.document().step().unwrap().0, before);
}

#[test]
fn windows_of_any_size_are_drawn() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    for size in [
        [1.0, 1.0],
        [30.0, 700.0],
        [600.0, 20.0],
        [480.0, 320.0],
        [1280.0, 800.0],
    ] {
        driven.harness.set_size(vec2(size[0], size[1]));
        for _ in 0..3 {
            driven.step();
        }
    }
    // A monitor with other pixels.
    driven.harness.set_pixels_per_point(2.0);
    driven.wait_final();
    let place = driven.place("volume");
    assert!(driven.picture(0).size[0] as f32 > 1.9 * place.width());
}

/// Number of colors in a place of what the window draws: more than a few where something is written.
fn colors(driven: &mut Driven, place: egui::Rect) -> usize {
    let image = driven.harness.render().unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for y in place.top() as u32..place.bottom() as u32 {
        for x in place.left() as u32..place.right() as u32 {
            seen.insert(image.get_pixel(x, y).0);
        }
    }
    seen.len()
}

#[test]
fn pages_without_a_picture_leave_menus_and_status_alone() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("BROKEN.EGRID");
    std::fs::write(&broken, "no grid").unwrap();
    for cases in [vec![], vec![broken]] {
        let mut driven = Driven::open(&cases);
        driven.step();
        driven.wait("the page", |w| {
            w.document().is_none_or(|d| d.error.is_some())
        });
        driven.step();
        for menu in ["File", "Edit", "Help"] {
            let place = driven.place(menu);
            assert!(colors(&mut driven, place) > 3, "{menu} is painted over");
        }
        if !cases.is_empty() {
            let tab = driven.place("Close BROKEN.EGRID");
            assert!(colors(&mut driven, tab) > 3);
            driven.harness.get_by_label("BROKEN.EGRID was not opened");
            driven.harness.get_by_label("Try again");
        }
    }
}

#[test]
fn of_a_folder_with_several_cases_one_is_chosen() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let first = copy_of_sample(folder.path());
    for ending in ["EGRID", "INIT", "UNRST"] {
        let from = first.with_extension(ending);
        std::fs::copy(from, folder.path().join(format!("OTHER.{ending}"))).unwrap();
    }
    let mut driven = Driven::open(&[folder.path().to_owned()]);
    driven.wait_settled();
    assert!(driven.harness.state().document().is_none());
    driven.harness.get_by_label("SCISSOR.EGRID");
    driven.click("OTHER.EGRID");
    driven.wait_final();
    assert_eq!(driven.document().title(), "OTHER");
    assert!(driven.harness.query_by_label("Choose a case").is_none());
    // A folder with one case is that case.
    let one = tempfile::tempdir().unwrap();
    copy_of_sample(one.path());
    let driven = Driven::showing(one.path().to_owned());
    assert_eq!(driven.document().title(), "SCISSOR");
}

#[test]
fn a_closed_case_is_let_go_and_comes_back_as_it_was() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven.click("SRG");
    driven.harness.state_mut().apply(Action::Select(
        [23, 6, 2],
        strataray::viewer::Beside::Nothing,
    ));
    driven.wait("values", |w| w.document().unwrap().table.is_some());
    driven.wait_final();
    let state = driven.document().state.clone();
    let case = std::sync::Arc::downgrade(driven.document().case.as_ref().unwrap());
    driven.press(Modifiers::COMMAND, Key::W);
    assert!(driven.harness.state().document().is_none());
    let (told, is_error) = driven.harness.state().message().unwrap();
    assert!(!is_error && told.contains("Ctrl+Shift+T"), "{told}");
    driven.wait("the case's memory", |_| case.strong_count() == 0);
    // Where it was opened from is told on the page that is there now.
    let folder = sample().parent().unwrap().to_owned();
    let home = std::env::var("HOME").unwrap_or_default();
    let short = folder.display().to_string().replacen(&home, "~", 1);
    let is_folder = |label: &str| driven.harness.query_by_label(label).is_some();
    assert!(is_folder(&short) || is_folder(&folder.display().to_string()));
    driven.press(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::T);
    driven.wait_final();
    assert_eq!(driven.document().state, state);
    // A case that is read again does not keep what was read before.
    let case = std::sync::Arc::downgrade(driven.document().case.as_ref().unwrap());
    driven.press(Modifiers::NONE, Key::F5);
    driven.wait("the memory of what was read before", |_| {
        case.strong_count() == 0
    });
    driven.wait_final();
}

/// All controls that can be seen or clicked now, by name.
fn controls(driven: &Driven) -> Vec<(String, egui::Rect)> {
    let named = |node: egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        // Of what is not drawn there is no place.
        let place = node.bounding_box()?;
        let [x0, y0, x1, y1] = [place.x0, place.y0, place.x1, place.y1].map(|v| v as f32);
        let rect = egui::Rect::from_min_max(egui::pos2(x0, y0), egui::pos2(x1, y1));
        let is_control = node
            .data()
            .supports_action(eframe::egui::accesskit::Action::Focus);
        let name = node.label().or_else(|| node.value())?;
        (is_control && !node.is_hidden()).then_some((name, rect))
    };
    let nodes = driven.harness.root().children_recursive();
    nodes.filter_map(named).collect()
}

#[test]
fn nothing_is_out_of_reach_in_a_small_window() {
    let Some(_) = gpu() else { return };
    // 800x600 pixels, at 100 % and at 150 %.
    for (width, height) in [(800.0, 600.0), (533.0, 400.0)] {
        let mut driven = Driven::sized(&[sample()], [width, height], false);
        driven.wait_final();
        let window = egui::Rect::from_min_size(egui::Pos2::ZERO, vec2(width, height));
        let is_inside = |driven: &Driven, name: &str| {
            let places = driven.places(name);
            let is_in = |place: &egui::Rect| window.expand(1.0).contains_rect(*place);
            assert!(places.iter().all(is_in), "{name}: {places:?}");
        };
        for name in ["File", "Help", "First", "Play", "Last", "Time step"] {
            is_inside(&driven, name);
        }
        // What lies in no panel that scrolls is inside the window.
        let outside: Vec<_> = controls(&driven)
            .into_iter()
            .filter(|(_, rect)| rect.right() > width + 1.0)
            .collect();
        assert!(outside.is_empty(), "{outside:?}");
        let image = driven.place("image");
        assert!(image.width() >= 200.0 && image.height() >= 200.0);
        // The legend stands beside it.
        let picture = driven.place("volume");
        assert!(picture.width() >= 140.0 && picture.height() >= 200.0);
        // Both sides can be opened, one after the other where both have no room.
        let is_open = |driven: &Driven, name: &str| driven.harness.query_by_label(name).is_some();
        assert!(is_open(&driven, "Property"));
        if !is_open(&driven, "Transfer function") {
            assert!(width < 900.0);
            driven.click("Show the right panels");
            driven.wait_settled();
            assert!(is_open(&driven, "Transfer function") && !is_open(&driven, "Property"));
            driven.click("Show the left panels");
            driven.wait_settled();
            assert!(is_open(&driven, "Property") && !is_open(&driven, "Transfer function"));
        }
        driven.click("Hide the left panels");
        driven.wait_settled();
        assert!(!is_open(&driven, "Property"));
        let wide = driven.place("volume");
        assert!(
            wide.width() > picture.width() + 100.0,
            "{wide:?} {picture:?}"
        );
        // Sheets fit too.
        driven.press(Modifiers::NONE, Key::F1);
        driven.wait_settled();
        is_inside(&driven, "Keys");
        driven.press(Modifiers::NONE, Key::Escape);
        driven.press(Modifiers::COMMAND, Key::F12);
        driven.wait_settled();
        is_inside(&driven, "Save ...");
    }
}

#[test]
fn panels_are_widened_by_their_edges() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    for to in [40.0, -40.0] {
        for off in [-3.0, 3.0] {
            let before = driven.place("volume").width();
            let image = driven.place("image");
            // The edges of the panels lie beside the image.
            let edge = match to > 0.0 {
                true => image.left() - 4.0,
                false => image.right() + 4.0,
            };
            let from = egui::pos2(edge + off, 400.0);
            driven.drag(from, from + vec2(0.5 * to, 0.0));
            driven.wait_settled();
            let after = driven.place("volume").width();
            let told = format!("{before} {after} at {off} of {edge}, {image:?}");
            assert!(after < before - 10.0, "{told}");
        }
    }
}

#[test]
fn files_without_a_grid_are_added_to_the_case() {
    let Some(_) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let grid = tiny::write(folder.path(), "GRID.GRDECL", tiny::grid_text());
    let write = |name: &str| {
        let text = format!("{name}\n 60*100 60*300 /\n");
        tiny::write(folder.path(), &format!("{name}.inc"), text)
    };
    let [first, second] = ["PERMX", "PERMY"].map(write);
    let has = |w: &Window, name: &str| {
        let case = w.document().and_then(|d| d.case.as_ref());
        case.is_some_and(|c| c.properties.iter().any(|p| p.name == name))
    };
    // Named together with a grid.
    let mut driven = Driven::open(&[first.clone(), grid.clone()]);
    driven.wait_final();
    assert!(has(driven.harness.state(), "PERMX"));
    assert_eq!(driven.document().with, std::slice::from_ref(&first));
    let state = driven.document().state.clone();
    // Dropped on the case that is open: it stays as it looks.
    let file = std::sync::Arc::new(Dropped(second.clone()));
    driven.harness.input_mut().dropped_files.push(file);
    driven.wait("the property that was added", |w| has(w, "PERMY"));
    driven.wait_final();
    assert!(has(driven.harness.state(), "PERMX"));
    assert_eq!(driven.document().with, [first, second]);
    assert_eq!(driven.document().state, state);
    assert_eq!(driven.document().title(), "GRID");
    // A case that is no part of it gets a tab of its own.
    let file = std::sync::Arc::new(Dropped(sample()));
    driven.harness.input_mut().dropped_files.push(file);
    driven.wait("the other case", |w| {
        w.document()
            .is_some_and(|d| d.case.is_some() && d.title() == "SCISSOR")
    });
}
