//! What lies above and below the picture: menus, tabs, the player, messages.

use eframe::egui::{self, Color32, Context, Ui};

use super::Window;
use crate::scene::{Mode, Space};
use crate::viewer::action::Action;
use crate::viewer::keys::{self, CameraMove, Command};
use crate::viewer::panels::{self, PlayerRequest};

/// The menus and what is in them.
const MENUS: [(&str, &[Command]); 5] = [
    (
        "File",
        &[
            Command::Open,
            Command::AddFiles,
            Command::Reload,
            Command::SaveScene,
            Command::LoadScene,
            Command::Screenshot,
            Command::Film,
            Command::SaveTable,
            Command::SaveVectors,
            Command::ExportCells,
            Command::CopyLine,
            Command::Ensemble,
            Command::Close,
            Command::Reopen,
        ],
    ),
    ("Edit", &[Command::Undo, Command::Redo, Command::Settings]),
    (
        "View",
        &[
            Command::Camera(CameraMove::FrameAll),
            Command::Camera(CameraMove::FrameSelection),
            Command::Camera(CameraMove::From(0)),
            Command::Camera(CameraMove::From(1)),
            Command::Camera(CameraMove::From(2)),
            Command::Camera(CameraMove::From(3)),
            Command::Camera(CameraMove::From(4)),
            Command::Camera(CameraMove::From(6)),
            Command::Camera(CameraMove::From(5)),
            Command::Camera(CameraMove::Projection),
            Command::Case(1),
            Command::Case(-1),
            Command::Mouse,
            Command::Panels,
            Command::Theme,
        ],
    ),
    (
        "Image",
        &[
            Command::Mode,
            Command::Space,
            Command::NextStrategy,
            Command::Light,
            Command::Compare,
            Command::Curves,
            Command::Play,
        ],
    ),
    ("Help", &[Command::Help, Command::Notes]),
];

/// Narrower windows do without the buttons beside the menus, and without the adapter's name.
const WIDTH_OF_BUTTONS: f32 = 400.0;
const WIDTH_OF_ADAPTER: f32 = 700.0;

/// Menus and tabs.
pub fn top(window: &mut Window, ui: &mut Ui, ctx: &Context) {
    let mut asked = None;
    egui::Panel::top("bar").show(ui, |ui| {
        egui::MenuBar::new().ui(ui, |ui| {
            for (name, commands) in MENUS {
                ui.menu_button(name, |ui| {
                    for command in commands {
                        if entry(ui, ctx, *command) {
                            asked = Some(*command);
                        }
                    }
                });
            }
            modes(window, ui, ctx);
            space(window, ui, ctx);
            // All of these are in the menus too.
            if ui.available_width() < WIDTH_OF_BUTTONS {
                return;
            }
            ui.separator();
            for (name, command) in [
                ("Open", Command::Open),
                ("Undo", Command::Undo),
                ("Redo", Command::Redo),
                ("Frame all", Command::Camera(CameraMove::FrameAll)),
                ("Save image", Command::Screenshot),
                ("Keys", Command::Help),
            ] {
                let hint = hint(ctx, command);
                if ui.button(name).on_hover_text(hint).clicked() {
                    asked = Some(command);
                }
            }
        });
        tabs(window, ui);
    });
    if let Some(command) = asked {
        window.perform(ctx, command);
    }
}

/// The two modes, the one in use marked.
fn modes(window: &mut Window, ui: &mut Ui, ctx: &Context) {
    let document = window.document().filter(|d| d.case.is_some());
    let Some(mode) = document.map(|d| d.state.setup.scene.mode) else {
        return;
    };
    ui.separator();
    let key = hint(ctx, Command::Mode);
    for (other, name, what) in [
        (
            Mode::Cells,
            "Cells",
            "Opaque cells: outer faces and sections",
        ),
        (
            Mode::Volume,
            "Volume",
            "Rays through the inside: the values looked for are solid, the rest is a haze",
        ),
    ] {
        let button = ui.selectable_label(mode == other, name);
        if button.on_hover_text(format!("{what}\n{key}")).clicked() && mode != other {
            window.apply(Action::Mode(other));
        }
    }
}

/// The switch between true places and those by I, J and K.
fn space(window: &mut Window, ui: &mut Ui, ctx: &Context) {
    let document = window.document().filter(|d| d.case.is_some());
    let Some(space) = document.map(|d| d.state.setup.scene.space) else {
        return;
    };
    ui.separator();
    let what = "Flat layers and square columns by I, J and K (simbox), values unchanged";
    let key = hint(ctx, Command::Space);
    let button = ui.selectable_label(space == Space::Ijk, "IJK");
    if button.on_hover_text(format!("{what}\n{key}")).clicked() {
        window.apply(Action::Space(space.other()));
    }
}

/// A line of a menu: what it does, and its key.
fn entry(ui: &mut Ui, ctx: &Context, command: Command) -> bool {
    let known = keys::SHORTCUTS.iter().find(|s| s.2 == command);
    let Some((modifiers, key, _, what)) = known else {
        return false;
    };
    let button = egui::Button::new(*what).shortcut_text(keys::text(ctx, *modifiers, *key));
    ui.add(button).clicked()
}

fn hint(ctx: &Context, command: Command) -> String {
    let known = keys::SHORTCUTS.iter().find(|s| s.2 == command);
    known.map_or_else(String::new, |(m, k, _, what)| {
        format!("{what} ({})", keys::text(ctx, *m, *k))
    })
}

fn tabs(window: &mut Window, ui: &mut Ui) {
    let (mut closes, mut chosen) = (None, None);
    ui.horizontal_wrapped(|ui| {
        for (n, (document, title)) in window.documents.iter().zip(window.titles()).enumerate() {
            let is_current = n == window.current;
            let tab = ui.selectable_label(is_current, &title);
            if tab
                .on_hover_text(document.key().display().to_string())
                .clicked()
            {
                chosen = Some(n);
            }
            let close = ui.small_button("×").on_hover_text("Close this case");
            close.widget_info(|| {
                let name = format!("Close {title}");
                egui::WidgetInfo::labeled(egui::Role::Button, true, name)
            });
            if close.clicked() {
                closes = Some(n);
            }
        }
    });
    if let Some(n) = chosen {
        window.current = n;
    }
    if let Some(n) = closes {
        window.close(n);
    }
}

/// The player, messages, and how far the picture is.
pub fn bottom(window: &mut Window, ui: &mut Ui, ctx: &Context) {
    let mut command = None;
    egui::Panel::bottom("status").show(ui, |ui| {
        match window.document().and_then(|d| panels::player(ui, d)) {
            Some(PlayerRequest::Do(asked)) => command = Some(asked),
            Some(PlayerRequest::Change(action)) => window.apply(action),
            None => {}
        }
        let row = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
        // From the right: what is left of the row is the message's, which never lies under something else.
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        ui.allocate_ui_with_layout(row, layout, |ui| {
            if let Some((name, _)) = &window.pictures.adapter
                && row.x > WIDTH_OF_ADAPTER
            {
                ui.weak(name);
            }
            ui.label(progress(window));
            if let Some(document) = window.document_mut() {
                loading(ui, document);
            }
            exporting(window, ui);
            let case = window.document().and_then(|d| d.case.as_ref());
            let notes = case.map_or(0, |c| c.about.notes.len());
            let text = match notes {
                1 => "1 note on what was not loaded".to_owned(),
                _ => format!("{notes} notes on what was not loaded"),
            };
            if notes > 0 && ui.link(text).clicked() {
                command = Some(Command::Notes);
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                message(window, ui);
            });
        });
    });
    if let Some(command) = command {
        window.perform(ctx, command);
    }
}

/// What is told, in one line, in full where the pointer rests on it.
fn message(window: &Window, ui: &mut Ui) {
    // Why a case that is shown could not be read again.
    let shown = window.document().filter(|d| d.case.is_some());
    let stale = shown.and_then(|d| d.error.as_ref());
    let told = window
        .message
        .as_ref()
        .map(|(text, is_error)| (text, *is_error));
    // What the scene asks for in vain.
    let warning = window.picture(0);
    let warning = warning.and_then(|(picture, _)| picture.view.notes.warnings.first());
    let told = told.or(stale.map(|error| (error, true)));
    let Some((text, is_error)) = told.or(warning.map(|text| (text, false))) else {
        return;
    };
    let rich = egui::RichText::new(text);
    let rich = match is_error {
        true => rich.color(Color32::from_rgb(220, 80, 60)),
        false => rich,
    };
    ui.add(egui::Label::new(rich).truncate());
}

/// How far the picture is.
fn progress(window: &Window) -> String {
    match (window.pictures.on_its_way(), window.pictures.progress) {
        (Some(true), Some(part)) => format!("refining {:.0} %", 100.0 * part),
        (Some(_), _) => "drawing".into(),
        (None, _) if window.pictures.are_final() => "final".into(),
        (None, _) => String::new(),
    }
}

/// A case that is read again while it is shown.
fn loading(ui: &mut Ui, document: &mut crate::viewer::document::Document) {
    let Some(stage) = document.loading.as_ref().map(|l| l.stage()) else {
        return;
    };
    if document.case.is_none() {
        return;
    }
    if ui
        .small_button("Cancel")
        .on_hover_text("Keeps the case as it is")
        .clicked()
    {
        document.loading = None;
    }
    ui.label(format!("again: {stage}"));
}

/// A picture or film that is being made for a file.
fn exporting(window: &mut Window, ui: &mut Ui) {
    let Some(export) = &window.export else {
        return;
    };
    let cancel = ui.small_button("Cancel").on_hover_text("Writes nothing");
    if cancel.clicked() {
        export.cancel();
    }
    ui.add(egui::ProgressBar::new(export.done()).desired_width(120.0));
    ui.label(&export.what);
}
