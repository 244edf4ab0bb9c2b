//! Keeping: scenes, settings, what is undone; names of controls.

use eframe::egui::accesskit::Action as Asked;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use strataray::metrics::Comparison;
use strataray::scene::Scene;
use strataray::viewer::{Action, Settings, State};

use super::common::{gpu, sample};
use super::driven::Driven;

#[test]
fn a_saved_scene_makes_the_same_picture() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven
        .harness
        .state_mut()
        .apply(Action::Property("PRESSURE".into()));
    driven.click("SRG");
    driven.press(Modifiers::COMMAND.plus(Modifiers::ALT), Key::E);
    driven.wait_final();
    let (scene, picture) = (driven.scene().clone(), driven.picture(0));
    let file = driven.folder.path().join("scene.json");
    driven.harness.state().save_scene(&file).unwrap();
    // The command line reads the same file.
    let read: Scene = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!(read, scene);
    for _ in 0..5 {
        driven.press(Modifiers::COMMAND, Key::Z);
    }
    driven.wait_final();
    let apart = Comparison::of(&driven.picture(0), &picture).unwrap();
    assert!(apart.psnr_db < 60.0, "{apart:?}");
    driven.harness.state_mut().load_scene(&file).unwrap();
    driven.wait_final();
    assert_eq!(driven.scene(), &scene);
    // Rays pause by time, so sums may round differently, in single pixels.
    let apart = Comparison::of(&driven.picture(0), &picture).unwrap();
    assert!(apart.psnr_db > 90.0, "{apart:?}");
    // One that is none is refused, and changes nothing.
    std::fs::write(&file, "{\"propertee\": 1}").unwrap();
    let error = driven.harness.state_mut().load_scene(&file).unwrap_err();
    assert!(
        error.contains("propertee") && error.contains("scene.json"),
        "{error}"
    );
    assert_eq!(driven.scene(), &scene);
    // The whole state is plain data.
    let state = serde_json::to_string(&driven.document().state).unwrap();
    let state: State = serde_json::from_str(&state).unwrap();
    assert_eq!(state, driven.document().state);
}

#[test]
fn without_a_dialog_of_the_system_a_path_is_typed() {
    let Some(_) = gpu() else { return };
    if std::env::var_os("DISPLAY").is_some() || std::env::var_os("WAYLAND_DISPLAY").is_some() {
        eprintln!("SKIPPED: with a display, the system may show a dialog of its own");
        return;
    }
    let mut driven = Driven::showing(sample());
    driven.press(Modifiers::COMMAND, Key::S);
    while driven.harness.query_by_label("Path").is_none() {
        driven.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let file = driven.folder.path().join("typed.json");
    driven.press(Modifiers::COMMAND, Key::A);
    driven
        .harness
        .get_by_label("Path")
        .type_text(&file.display().to_string());
    driven.step();
    driven.press(Modifiers::NONE, Key::Enter);
    let (message, is_error) = driven.harness.state().message().unwrap();
    assert!(!is_error && message.contains("typed.json"), "{message}");
    let read: Scene = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!(&read, driven.scene());
    assert!(driven.harness.query_by_label("Path").is_none());
}

#[test]
fn what_was_chosen_is_remembered() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let file = driven.folder.path().join("settings.json");
    assert!(Settings::in_file(file.clone()).dark);
    driven.press(Modifiers::COMMAND, Key::D);
    assert!(!Settings::in_file(file.clone()).dark);
    driven.press(Modifiers::COMMAND, Key::B);
    assert!(driven.harness.query_by_label("LIBC").is_none());
    driven.press(Modifiers::COMMAND, Key::B);
    assert!(driven.harness.query_by_label("LIBC").is_some());
    driven.press(Modifiers::NONE, Key::F1);
    driven.harness.get_by_label("Play or pause");
}

#[test]
fn every_control_has_a_name_and_takes_the_focus() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    for panel in ["Property filters", "Clip planes", "Compare", "Statistics"] {
        driven.click(panel);
        driven.wait_settled();
    }
    let mut nameless = Vec::new();
    let mut count = 0;
    for node in driven.harness.root().children_recursive() {
        let node = node.accesskit_node();
        if !node.data().supports_action(Asked::Focus) {
            continue;
        }
        count += 1;
        let name = node.label().or_else(|| node.value()).unwrap_or_default();
        if name.trim().is_empty() {
            nameless.push(format!("{:?} at {:?}", node.role(), node.bounding_box()));
        }
    }
    assert!(count > 60, "{count} controls");
    assert!(nameless.is_empty(), "{nameless:#?}");
}
