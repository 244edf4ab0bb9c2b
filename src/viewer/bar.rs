//! What lies above and below the picture: menus, tabs, the player, messages.

use eframe::egui::{self, Color32, Context, Ui};

use super::keys::{self, Command};
use super::looking::Look;
use super::panels::{self, Asked};
use super::window::Window;

/// The menus and what is in them.
const MENUS: [(&str, &[Command]); 5] = [
    (
        "File",
        &[
            Command::Open,
            Command::Reload,
            Command::SaveScene,
            Command::LoadScene,
            Command::Screenshot,
            Command::Film,
            Command::SaveTable,
            Command::CopyLine,
            Command::Close,
        ],
    ),
    ("Edit", &[Command::Undo, Command::Redo]),
    (
        "Look",
        &[
            Command::Look(Look::FrameAll),
            Command::Look(Look::FrameSelection),
            Command::Look(Look::From(0)),
            Command::Look(Look::From(1)),
            Command::Look(Look::From(2)),
            Command::Look(Look::From(3)),
            Command::Look(Look::From(4)),
            Command::Look(Look::From(6)),
            Command::Look(Look::From(5)),
            Command::Look(Look::Projection),
            Command::Mouse,
            Command::Panels,
            Command::Theme,
        ],
    ),
    (
        "Picture",
        &[
            Command::NextStrategy,
            Command::Light,
            Command::Compare,
            Command::Play,
        ],
    ),
    ("Help", &[Command::Help, Command::Notes]),
];

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
            ui.separator();
            for (name, command) in [
                ("Open", Command::Open),
                ("Undo", Command::Undo),
                ("Redo", Command::Redo),
                ("Frame all", Command::Look(Look::FrameAll)),
                ("Save picture", Command::Screenshot),
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
        for (n, document) in window.documents.iter().enumerate() {
            let is_current = n == window.current;
            let tab = ui.selectable_label(is_current, document.title());
            if tab
                .on_hover_text(document.path.display().to_string())
                .clicked()
            {
                chosen = Some(n);
            }
            let close = ui.small_button("×").on_hover_text("Close this case");
            close.widget_info(|| {
                let name = format!("Close {}", document.title());
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
            Some(Asked::Do(asked)) => command = Some(asked),
            Some(Asked::Change(action)) => window.apply(action),
            None => {}
        }
        ui.horizontal(|ui| {
            message(window, ui);
            let case = window.document().and_then(|d| d.case.as_ref());
            let notes = case.map_or(0, |c| c.about.notes.len());
            let text = match notes {
                1 => "1 note on what was not loaded".to_owned(),
                _ => format!("{notes} notes on what was not loaded"),
            };
            if notes > 0 && ui.link(text).clicked() {
                command = Some(Command::Notes);
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if let Some((name, _)) = &window.pictures.adapter {
                    ui.weak(name);
                }
                ui.label(progress(window));
                if let Some(document) = window.document_mut() {
                    loading(ui, document);
                }
                exporting(window, ui);
            });
        });
    });
    if let Some(command) = command {
        window.perform(ctx, command);
    }
}

fn message(window: &Window, ui: &mut Ui) {
    let red = Color32::from_rgb(220, 80, 60);
    match &window.message {
        Some((text, true)) => ui.colored_label(red, text),
        Some((text, false)) => ui.label(text),
        None => {
            // Why a case that is shown could not be read again.
            let shown = window.document().filter(|d| d.case.is_some());
            let error = shown.and_then(|d| d.error.as_deref());
            ui.colored_label(red, error.unwrap_or_default())
        }
    };
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
fn loading(ui: &mut Ui, document: &mut super::document::Document) {
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
    ui.label(format!("reading again: {stage}"));
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
