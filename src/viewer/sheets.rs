//! Sheets over the window: shortcuts, what was not loaded, how a picture or film is saved.

use eframe::egui::{self, Context, Ui};

use super::dialogs::{PathSheet, Purpose};
use super::export::{ExportSpec, Kind};
use super::keys;
use super::settings::{Export, Mouse};
use super::window::Window;
use crate::scene::Scene;

/// Which sheets are open.
#[derive(Default)]
pub struct Sheets {
    /// The shortcuts.
    pub keys: bool,
    /// What was not loaded.
    pub notes: bool,
    /// How a picture (false) or a film (true) is saved.
    pub export: Option<bool>,
    /// The path of a file.
    pub path: Option<PathSheet>,
}

impl Sheets {
    /// True where one is.
    pub fn are_open(&self) -> bool {
        self.keys || self.notes || self.export.is_some() || self.path.is_some()
    }
}

impl Window {
    /// Draws the sheets that are open.
    pub(super) fn show_sheets(&mut self, ctx: &Context) {
        egui::Window::new("Keys")
            .open(&mut self.sheets.keys)
            .vscroll(true)
            .default_height(560.0)
            .show(ctx, |ui| {
                shortcuts(ui, ctx, self.settings.mouse);
            });
        let notes = self.document().and_then(|d| d.case.clone());
        egui::Window::new("Not loaded")
            .open(&mut self.sheets.notes)
            .show(ctx, |ui| {
                let notes = notes.iter().flat_map(|c| &c.about.notes);
                let mut notes = notes.peekable();
                if notes.peek().is_none() {
                    ui.label("Everything was loaded.");
                }
                for note in notes {
                    ui.label(note);
                }
            });
        if let Some(is_film) = self.sheets.export {
            self.export_sheet(ctx, is_film);
        }
        if let Some(answer) = self.sheets.path.as_mut().and_then(|sheet| sheet.show(ctx)) {
            self.sheets.path = None;
            if let Some((purpose, path)) = answer {
                self.choose(ctx, purpose, path);
            }
        }
    }

    fn export_sheet(&mut self, ctx: &Context, is_film: bool) {
        let Some((case, scene)) = self.subject() else {
            self.sheets.export = None;
            self.fail("open a case first");
            return;
        };
        let (mut is_open, mut is_asked) = (true, false);
        let mut export = self.settings.export;
        let title = if is_film {
            "Save a film"
        } else {
            "Save a picture"
        };
        egui::Window::new(title).open(&mut is_open).show(ctx, |ui| {
            size(ui, &mut export);
            if is_film {
                film(ui, &mut export);
            }
            ui.checkbox(&mut export.annotated, "Title, legend, box and axes");
            is_asked = ui.button("Save ...").clicked();
        });
        if export != self.settings.export {
            self.settings.export = export;
            self.keep_settings();
        }
        if !is_open || is_asked {
            self.sheets.export = None;
        }
        if is_asked {
            let kind = match (is_film, export.turns) {
                (false, _) => Kind::Still,
                (true, false) => Kind::Steps { fps: export.fps },
                (true, true) => Kind::Orbit {
                    fps: export.fps,
                    views: export.views,
                },
            };
            let spec = ExportSpec {
                case,
                scene: Scene {
                    size: export.size,
                    ..scene
                },
                kind,
                plain: !export.annotated,
                compared: self.compared(),
                marked: self
                    .document()
                    .map_or_else(Vec::new, |d| d.state.selected.clone()),
            };
            self.ask_file(ctx, Purpose::Export(Box::new(spec)));
        }
    }
}

fn shortcuts(ui: &mut Ui, ctx: &Context, mouse: Mouse) {
    egui::Grid::new("keys")
        .striped(true)
        .num_columns(2)
        .show(ui, |ui| {
            for (modifiers, key, _, what) in keys::SHORTCUTS {
                ui.label(keys::text(ctx, modifiers, key));
                ui.label(what);
                ui.end_row();
            }
            for (what, does) in mouse.describe() {
                ui.label(what);
                ui.label(does);
                ui.end_row();
            }
            for (what, does) in [
                ("Click", "Selects the cell under the pointer"),
                ("Ctrl + click", "Selects it beside others, or lets it go"),
                ("Tab, Shift + Tab", "To the next control, or the one before"),
                (
                    "Ctrl + plus, minus, 0",
                    "Larger, smaller or standard letters",
                ),
            ] {
                ui.label(what);
                ui.label(does);
                ui.end_row();
            }
        });
}

fn size(ui: &mut Ui, export: &mut Export) {
    ui.horizontal(|ui| {
        for (value, name) in export.size.iter_mut().zip(["Width", "Height"]) {
            ui.label(name);
            let drag = egui::DragValue::new(value).range(16..=16384).suffix(" px");
            ui.add(drag).on_hover_text(format!("{name} in pixels"));
        }
    });
}

fn film(ui: &mut Ui, export: &mut Export) {
    ui.horizontal(|ui| {
        for (turns, name, what) in [
            (false, "Time steps", "One picture for each time step"),
            (true, "Turn", "Once around the model"),
        ] {
            if ui
                .selectable_label(export.turns == turns, name)
                .on_hover_text(what)
                .clicked()
            {
                export.turns = turns;
            }
        }
    });
    ui.horizontal(|ui| {
        let fps = egui::DragValue::new(&mut export.fps)
            .range(0.2..=60.0)
            .suffix(" pictures/s");
        ui.add(fps).on_hover_text("Pictures a second");
        if export.turns {
            let views = egui::DragValue::new(&mut export.views)
                .range(2..=1000)
                .suffix(" pictures");
            ui.add(views).on_hover_text("Pictures of the whole turn");
        }
    });
    ui.weak("The name's ending says the format: .png (animated), .gif, .mp4 where built in.");
}
