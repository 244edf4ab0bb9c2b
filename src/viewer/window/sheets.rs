//! Sheets over the window: shortcuts, what was not loaded, how a picture or film is saved.

use eframe::egui::{self, Context, Ui};

use super::Window;
use crate::picture::film::FilmFormat;
use crate::scene::Scene;
use crate::viewer::dialogs::{CasesSheet, PathSheet, Purpose, SheetResult};
use crate::viewer::export::{ExportKind, ExportSpec};
use crate::viewer::keys;
use crate::viewer::panels::{Choice, list, one_of};
use crate::viewer::settings::{AnimationSettings, Mouse};
use crate::viewer::state::Playback;

/// Which sheets are open.
#[derive(Default)]
pub struct Sheets {
    /// The shortcuts.
    pub keys: bool,
    /// What was not loaded.
    pub notes: bool,
    /// Mouse, theme, size of letters.
    pub settings: bool,
    /// How a picture (false) or a film (true) is saved.
    pub export: Option<bool>,
    /// The path of a file.
    pub path: Option<PathSheet>,
    /// Which of several cases to open.
    pub cases: Option<CasesSheet>,
}

impl Sheets {
    /// True where one is.
    pub fn are_open(&self) -> bool {
        let simple = [self.keys, self.notes, self.settings];
        simple.contains(&true)
            || self.export.is_some()
            || self.path.is_some()
            || self.cases.is_some()
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
        self.settings_sheet(ctx);
        if let Some(is_film) = self.sheets.export {
            self.export_sheet(ctx, is_film);
        }
        if let Some(asked) = self.sheets.path.as_mut().and_then(|sheet| sheet.show(ctx)) {
            self.sheets.path = None;
            if let SheetResult::Files(purpose, paths) = asked {
                self.choose(ctx, purpose, paths);
            }
        }
        if let Some(chosen) = self.sheets.cases.as_ref().and_then(|sheet| sheet.show(ctx)) {
            self.sheets.cases = None;
            self.open(ctx, chosen);
        }
    }

    fn settings_sheet(&mut self, ctx: &Context) {
        let (mut is_open, mut chosen) = (self.sheets.settings, self.settings.clone());
        let document = self.document();
        let shown = document.and_then(|d| d.state.setup.scene.property.clone());
        egui::Window::new("Settings")
            .open(&mut is_open)
            .show(ctx, |ui| {
                let current = chosen.mouse.name();
                list(
                    ui,
                    "Mouse",
                    "Which program the mouse buttons follow",
                    current,
                    |ui| {
                        for mouse in Mouse::ALL {
                            ui.selectable_value(&mut chosen.mouse, mouse, mouse.name());
                        }
                    },
                );
                egui::Grid::new("drags").num_columns(2).show(ui, |ui| {
                    for (what, does) in chosen.mouse.describe() {
                        ui.weak(what);
                        ui.weak(does);
                        ui.end_row();
                    }
                });
                first_property(ui, &mut chosen.first_property, shown.as_deref());
                let themes = [
                    (true, "Dark", "Light text on dark panels"),
                    (false, "Light", "Dark text on light panels"),
                ];
                if let Some(dark) = one_of(ui, "Theme", chosen.dark, &themes) {
                    chosen.dark = dark;
                }
                ui.horizontal(|ui| {
                    ui.label("UI scale");
                    let mut percent = 100.0 * ctx.zoom_factor();
                    let drag = egui::DragValue::new(&mut percent).range(50.0..=300.0);
                    let drag = drag
                        .max_decimals(0)
                        .suffix(" %")
                        .update_while_editing(false);
                    // Not while it is dragged: the window would change under the pointer.
                    if ui
                        .add(drag.speed(0.0))
                        .on_hover_text("Ctrl + plus, minus, 0")
                        .changed()
                    {
                        ctx.set_zoom_factor(percent / 100.0);
                    }
                });
            });
        self.sheets.settings = is_open;
        if chosen != self.settings {
            self.settings = chosen;
            self.keep_settings();
        }
    }

    /// Asks where to write the drawn cells; the ending that is chosen says the format.
    pub(super) fn export_cells(&mut self, ctx: &Context) {
        let Some((case, scene)) = self.subject() else {
            self.fail("open a case first");
            return;
        };
        let spec = ExportSpec {
            case,
            scene,
            kind: ExportKind::Cells,
            format: FilmFormat::default(),
            plain: true,
            compared: None,
            marked: Vec::new(),
        };
        self.ask_file(ctx, Purpose::Export(Box::new(spec)));
    }

    fn export_sheet(&mut self, ctx: &Context, is_film: bool) {
        let pace = self.document().map(|d| d.state.pace);
        let Some(((case, scene), pace)) = self.subject().zip(pace) else {
            self.sheets.export = None;
            self.fail("open a case first");
            return;
        };
        let (mut is_open, mut is_asked) = (true, false);
        let mut export = self.settings.export;
        let title = if is_film {
            "Save an animation"
        } else {
            "Save an image"
        };
        let window = self.sides.sizes(ctx.pixels_per_point())[0];
        egui::Window::new(title).open(&mut is_open).show(ctx, |ui| {
            let [of_image, of_film] = [&mut export.size, &mut export.film.size];
            size(ui, if is_film { of_film } else { of_image }, window);
            if is_film {
                film(ui, &mut export.film, pace);
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
            let spec = ExportSpec {
                case,
                scene: Scene {
                    size: if is_film {
                        export.film.size
                    } else {
                        export.size
                    },
                    ..scene
                },
                kind: kind(is_film, &export.film, pace),
                format: export.film.format,
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

/// Which property cases open with.
fn first_property(ui: &mut Ui, chosen: &mut Option<String>, shown: Option<&str>) {
    let what = "The property that a case opens with. Automatic: oil, gas or water saturation, else pressure or porosity";
    let current = chosen.clone().unwrap_or_else(|| "Automatic".into());
    list(ui, "First property", what, &current, |ui| {
        ui.selectable_value(chosen, None, "Automatic");
        let before = chosen.clone();
        let mut names: Vec<&str> = [before.as_deref(), shown].into_iter().flatten().collect();
        names.dedup();
        for name in names {
            ui.selectable_value(chosen, Some(name.to_owned()), name);
        }
    });
}

fn kind(is_film: bool, film: &AnimationSettings, pace: Playback) -> ExportKind {
    match (is_film, film.turns) {
        (false, _) => ExportKind::Still,
        (true, false) => ExportKind::Steps {
            fps: film.steps_per_second.unwrap_or(pace.steps_per_second),
        },
        (true, true) => ExportKind::Orbit {
            fps: film.turn_fps,
            views: film.views,
        },
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
                ("Ctrl + click", "Adds it to the selection, or removes it"),
                ("Tab, Shift + Tab", "Next or previous control"),
                ("Ctrl + plus, minus, 0", "UI scale: larger, smaller, reset"),
            ] {
                ui.label(what);
                ui.label(does);
                ui.end_row();
            }
        });
}

fn size(ui: &mut Ui, size: &mut [u32; 2], window: Option<[u32; 2]>) {
    ui.horizontal_wrapped(|ui| {
        for (value, name) in size.iter_mut().zip(["Width", "Height"]) {
            ui.label(name);
            let drag = egui::DragValue::new(value).range(16..=16384).suffix(" px");
            ui.add(drag).on_hover_text(format!("{name} in pixels"));
        }
        let as_shown = ui
            .button("As in the window")
            .on_hover_text("The size of the image in the window");
        if let Some(window) = window.filter(|_| as_shown.clicked()) {
            *size = window;
        }
    });
}

fn film(ui: &mut Ui, film: &mut AnimationSettings, pace: Playback) {
    let kinds = [
        (false, "Time steps", "One image per time step"),
        (true, "Rotation", "One full rotation about the model"),
    ];
    if let Some(turns) = one_of(ui, "Shows", film.turns, &kinds) {
        film.turns = turns;
    }
    let formats: Vec<_> = FilmFormat::OF_BUILD.iter().map(|f| described(*f)).collect();
    if let Some(format) = one_of(ui, "Format", film.format, &formats) {
        film.format = format;
    }
    ui.horizontal_wrapped(|ui| match film.turns {
        true => {
            let fps = egui::DragValue::new(&mut film.turn_fps)
                .range(0.2..=60.0)
                .suffix(" images/s");
            ui.add(fps).on_hover_text("Images per second");
            let views = egui::DragValue::new(&mut film.views)
                .range(2..=1000)
                .suffix(" images");
            ui.add(views)
                .on_hover_text("Number of images in the full rotation");
        }
        false => {
            let mut follows = film.steps_per_second.is_none();
            let text = format!("Player speed ({} steps/s)", pace.steps_per_second);
            if ui.checkbox(&mut follows, text).changed() {
                film.steps_per_second = (!follows).then_some(pace.steps_per_second);
            }
            if let Some(steps) = &mut film.steps_per_second {
                let drag = egui::DragValue::new(steps)
                    .range(0.2..=60.0)
                    .suffix(" steps/s");
                ui.add(drag).on_hover_text("Time steps per second");
            }
        }
    });
}

/// A format, its name and what it is good for.
fn described(format: FilmFormat) -> Choice<'static, FilmFormat> {
    let (name, what) = match format {
        FilmFormat::Gif => ("GIF", "256 colors; plays everywhere, also in slides"),
        FilmFormat::Apng => (
            "Animated PNG",
            "All colors; plays in browsers, not in slides",
        ),
        FilmFormat::Mp4 => ("MP4", "H.264 video"),
        FilmFormat::Frames => ("Numbered images", "PNG files in a folder"),
    };
    (format, name, what)
}
