//! Opening: cases, broken ones, those whose files change or go.

use std::path::{Path, PathBuf};

use eframe::egui::{self, Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use strataray::viewer::Settings;

use super::common::{copy_of_sample, gpu, sample};
use super::driven::{Driven, covered};

#[test]
fn a_sample_is_opened_from_the_welcome_page() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::open(&[]);
    driven.step();
    assert!(driven.harness.state().document().is_none());
    driven.click("SCISSOR");
    driven.wait_final();
    let picture = driven.picture(0);
    assert!(covered(&picture, [255; 3]) > 0.05);
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
    assert!(covered(&driven.picture(0), [255; 3]) > 0.05);
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
    assert!(covered(&driven.picture(0), [255; 3]) > 0.05);
    driven.click("Close SCISSOR");
    assert!(driven.harness.state().document().is_none());
}

#[test]
fn files_that_are_cut_off_or_gone_end_in_a_sentence() {
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
    // A step that was not read before.
    driven.press(Modifiers::NONE, Key::End);
    driven.press(Modifiers::NONE, Key::ArrowLeft);
    driven.press(Modifiers::NONE, Key::ArrowLeft);
    driven.press(Modifiers::NONE, Key::ArrowLeft);
    driven.press(Modifiers::NONE, Key::ArrowLeft);
    driven.wait("an error", |w| w.message().is_some_and(|m| m.1));
    let (message, _) = driven.harness.state().message().unwrap();
    assert!(message.contains("cut off"), "{message}");
    // Nothing that was set is lost, and what was read can be shown again.
    driven.press(Modifiers::NONE, Key::Home);
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
    assert!(covered(&driven.picture(0), [255; 3]) > 0.05);
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
