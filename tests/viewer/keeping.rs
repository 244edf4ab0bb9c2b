//! Keeping: scenes, settings, what is undone; names of controls.

use eframe::egui::accesskit::Action as Asked;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use strataray::image::metrics::Comparison as Apart;
use strataray::picture::film::FilmFormat;
use strataray::scene::{Scene, StepSpec};
use strataray::viewer::{Action, CompareLayout, Comparison, Settings, State};

use super::common::{copy_of_sample, gpu, sample};
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
    assert_ne!(driven.scene(), &scene);
    assert!(driven.picture(0) != picture);
    driven.harness.state_mut().load_scene(&file).unwrap();
    driven.wait_final();
    assert_eq!(driven.scene(), &scene);
    // Rays pause by time, so sums may round differently, in single pixels.
    let apart = Apart::of(&driven.picture(0), &picture).unwrap();
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

/// Frames until the sheet is there that asks for a path; false where the system may have a dialog of its own.
fn path_is_asked(driven: &mut Driven) -> bool {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    if is_set("DBUS_SESSION_BUS_ADDRESS") || is_set("WAYLAND_DISPLAY") {
        eprintln!("SKIPPED: the system may show a dialog of its own");
        return false;
    }
    let start = std::time::Instant::now();
    while driven.harness.query_by_label("Path").is_none() {
        driven.step();
        assert!(start.elapsed() < std::time::Duration::from_secs(60));
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    true
}

fn type_path(driven: &mut Driven, path: &str) {
    driven.press(Modifiers::COMMAND, Key::A);
    driven.harness.get_by_label("Path").type_text(path);
    driven.step();
    driven.step();
}

#[test]
fn without_a_dialog_of_the_system_a_path_is_typed() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven.press(Modifiers::COMMAND, Key::S);
    if !path_is_asked(&mut driven) {
        return;
    }
    // A folder is no file, and a folder that is not there holds none.
    let folder = driven.folder.path().display().to_string();
    type_path(&mut driven, &folder);
    driven
        .harness
        .get_by_label("This is a folder; add a file name.");
    type_path(&mut driven, &format!("{folder}/no/scene"));
    driven.harness.get_by_label("There is no such folder.");
    // The ending is added.
    let file = driven.folder.path().join("typed.json");
    type_path(&mut driven, &format!("{folder}/typed"));
    driven.press(Modifiers::NONE, Key::Enter);
    let (message, is_error) = driven.harness.state().message().unwrap();
    assert!(!is_error && message.contains("typed.json"), "{message}");
    let read: Scene = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    assert_eq!(&read, driven.scene());
    assert!(driven.harness.query_by_label("Path").is_none());
}

#[test]
fn a_typed_case_may_be_a_base_name_or_a_folder() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::open(&[]);
    driven.press(Modifiers::COMMAND, Key::O);
    if !path_is_asked(&mut driven) {
        return;
    }
    let folder = driven.folder.path().join("cases");
    std::fs::create_dir(&folder).unwrap();
    copy_of_sample(&folder);
    let other = folder.join("OTHER.EGRID");
    std::fs::copy(folder.join("SCISSOR.EGRID"), &other).unwrap();
    // What is typed is completed: the folder, then what is in it.
    let outer = driven.folder.path().display().to_string();
    type_path(&mut driven, &format!("{outer}/ca"));
    driven.click("cases/");
    driven.harness.get_by_label("2 cases; choose one:");
    driven.harness.get_by_label("OTHER.EGRID");
    type_path(&mut driven, &folder.join("scissor").display().to_string());
    driven.harness.get_by_label("Opens SCISSOR.EGRID.");
    driven.press(Modifiers::NONE, Key::Enter);
    driven.wait_final();
    assert_eq!(driven.document().title(), "SCISSOR");
    assert!(driven.document().path.ends_with("cases/SCISSOR.EGRID"));
}

#[test]
fn an_animation_has_the_players_pace_and_only_formats_of_this_build() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let file = driven.folder.path().join("settings.json");
    let settings = || Settings::in_file(file.clone()).export;
    driven.press(Modifiers::COMMAND, Key::F12);
    driven.wait_settled();
    assert_eq!(settings().film.steps_per_second, None);
    let pace = driven.document().state.pace.steps_per_second;
    driven
        .harness
        .get_by_label(&format!("Player speed ({pace} steps/s)"));
    assert_eq!(settings().film.format, FilmFormat::Gif);
    let has_mp4 = driven.harness.query_by_label("Format: MP4").is_some();
    assert_eq!(has_mp4, cfg!(feature = "mp4"));
    // Its size is not that of the next image.
    let before = settings().size;
    driven.click("As in the window");
    let window = driven.picture(0).size;
    assert_eq!(settings().film.size, window);
    assert_eq!(settings().size, before);
    driven.click("Format: Animated PNG");
    assert_eq!(settings().film.format, FilmFormat::Apng);
    driven.press(Modifiers::NONE, Key::Escape);
    driven.press(Modifiers::NONE, Key::F12);
    driven.wait_settled();
    driven.harness.get_by_label("Save an image");
    assert!(driven.harness.query_by_label("Format: GIF").is_none());
}

#[test]
fn the_mouse_is_as_in_the_program_that_was_chosen() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    driven.press(Modifiers::COMMAND, Key::Comma);
    driven.wait_settled();
    driven.click("Mouse");
    driven.wait_settled();
    driven.click("RMS; ResInsight (RMS, its default)");
    driven.press(Modifiers::NONE, Key::Escape);
    driven.wait_settled();
    let file = driven.folder.path().join("settings.json");
    assert_eq!(
        Settings::in_file(file).mouse.name(),
        "RMS; ResInsight (RMS, its default)"
    );
    // The left button comes closer now.
    driven.wait_final();
    let eye = |d: &Driven| d.harness.state().picture(0).unwrap().0.view.camera.eye;
    let before = eye(&driven);
    let middle = driven.place("volume").center();
    driven.drag(middle, middle - eframe::egui::vec2(0.0, 80.0));
    driven.wait_final();
    let after = eye(&driven);
    let bounds = driven
        .harness
        .state()
        .picture(0)
        .unwrap()
        .0
        .view
        .world
        .bounds;
    let center = (bounds[0] + bounds[1]) / 2.0;
    assert!(after.distance(center) < 0.95 * before.distance(center));
}

/// The text that Ctrl+Shift+C copies.
fn copied(driven: &mut Driven) -> String {
    // All in one frame, whose output it is.
    let modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
    let input = driven.harness.input_mut();
    input.events.push(eframe::egui::Event::Key {
        key: Key::C,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    });
    driven.step();
    let commands = &driven.harness.output().platform_output.commands;
    let copied = commands.iter().find_map(|c| match c {
        eframe::egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    copied.unwrap()
}

#[test]
fn a_command_is_copied_at_the_size_of_the_window() {
    let Some(_) = gpu() else { return };
    let mut driven = Driven::showing(sample());
    let size = driven.picture(0).size;
    let line = copied(&mut driven);
    let wanted = format!("\"size\":[{},{}]", size[0], size[1]);
    assert!(line.contains(&wanted), "{line}");
    assert!(line.contains("\"property\":\"SOIL\""), "{line}");
    // A difference within the case is what the line draws.
    let difference = Comparison {
        layout: CompareLayout::Difference,
        step: Some(StepSpec::Index(0)),
        ..Comparison::default()
    };
    driven
        .harness
        .state_mut()
        .apply(Action::Compare(Some(difference)));
    driven.wait_final();
    let line = copied(&mut driven);
    assert!(line.contains("\"property\":\"SOIL-SOIL@0\""), "{line}");
    let (message, _) = driven.harness.state().message().unwrap();
    assert!(message.contains("writes a PNG"), "{message}");
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
