//! The page without a case: samples, recent cases, where to drop a file.

use std::path::{Path, PathBuf};

use eframe::egui::{CentralPanel, Color32, Label, RichText, ScrollArea, Spinner, Ui};

use super::document::Document;
use super::settings::Settings;

/// What the user asked for.
pub enum WelcomeRequest {
    /// A case.
    Open(PathBuf),
    /// The dialog for files.
    Dialog,
}

/// What a hand new to the window needs to know.
const FIRST_STEPS: [(&str, &str); 5] = [
    ("Left drag", "rotates about the point under the pointer"),
    ("Wheel, two fingers", "zooms"),
    ("Click", "shows all values of the cell under the pointer"),
    ("Space", "plays the time steps"),
    ("F1", "lists all keyboard shortcuts"),
];

/// Draws the page.
pub fn show(ui: &mut Ui, settings: &Settings) -> Option<WelcomeRequest> {
    let mut asked = None;
    page(ui, 0.1, |ui| {
        ui.heading(RichText::new("StrataRay").size(34.0));
        ui.label("See inside a reservoir model. Open a case, or drop its files on the window.");
        ui.add_space(16.0);
        if ui.button("Open a case ...").clicked() {
            asked = Some(WelcomeRequest::Dialog);
        }
        if let Some(sample) = sample() {
            section(ui, "Sample");
            if ui.link(name_of(&sample)).clicked() {
                asked = Some(WelcomeRequest::Open(sample));
            }
            ui.label("A faulted oil field after 20 years of water flood:\nwhich oil is left, and behind which fault?");
        }
        if !settings.recent.is_empty() {
            section(ui, "Recent cases");
        }
        for case in &settings.recent {
            let case = recent(ui, case);
            asked = case.map(WelcomeRequest::Open).or(asked.take());
        }
        ui.add_space(28.0);
        for (what, does) in FIRST_STEPS {
            ui.weak(format!("{what} {does}"));
        }
    });
    asked
}

/// A case that was opened before, with its folder; it where it was clicked.
fn recent(ui: &mut Ui, case: &Path) -> Option<PathBuf> {
    let link = ui.link(name_of(case));
    let link = link.on_hover_text(case.display().to_string());
    if let Some(folder) = case.parent() {
        ui.add(Label::new(RichText::new(short(folder)).weak().small()).truncate());
    }
    link.clicked().then(|| case.to_owned())
}

fn name_of(case: &Path) -> String {
    let name = case.file_stem().unwrap_or(case.as_os_str());
    name.to_string_lossy().into_owned()
}

/// A folder, with `~` for the user's own.
fn short(folder: &Path) -> String {
    let home = std::env::var_os("HOME").filter(|h| !h.is_empty());
    match home.and_then(|home| folder.strip_prefix(home).ok()) {
        Some(rest) => Path::new("~").join(rest).display().to_string(),
        None => folder.display().to_string(),
    }
}

/// A page in the middle of the window, between menus and status, that scrolls where it has to.
fn page(ui: &mut Ui, from_top: f32, show: impl FnOnce(&mut Ui)) {
    CentralPanel::default().show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.vertical_centered(|ui| {
                ui.add_space(from_top * ui.available_height());
                show(ui);
            });
        });
    });
}

/// What the user asked for on the page of a case that is not there.
pub enum MissingCaseAnswer {
    /// Leaves it.
    Close,
    /// Reads it again.
    Again,
}

/// The page of a case that is being opened, or could not be.
pub fn waiting(ui: &mut Ui, document: &Document) -> Option<MissingCaseAnswer> {
    let mut answer = None;
    page(ui, 0.3, |ui| match (&document.loading, &document.error) {
        (Some(loading), _) => {
            ui.heading(format!("Opening {}", document.title()));
            ui.add(
                Label::new(RichText::new(document.path.display().to_string()).weak()).truncate(),
            );
            ui.add_space(12.0);
            ui.add(Spinner::new());
            ui.label(format!("{} ...", loading.stage()));
            ui.add_space(12.0);
            if ui.button("Cancel").clicked() {
                answer = Some(MissingCaseAnswer::Close);
            }
        }
        (None, error) => {
            ui.heading(format!("{} was not opened", document.title()));
            ui.add_space(12.0);
            let red = Color32::from_rgb(220, 80, 60);
            let error = error.as_deref().unwrap_or("opening it was canceled");
            ui.add(Label::new(RichText::new(error).color(red)).wrap());
            ui.add_space(12.0);
            if ui.button("Try again").clicked() {
                answer = Some(MissingCaseAnswer::Again);
            }
            if ui.button("Close").clicked() {
                answer = Some(MissingCaseAnswer::Close);
            }
        }
    });
    answer
}

fn section(ui: &mut Ui, title: &str) {
    ui.add_space(18.0);
    ui.strong(title);
}

/// The bundled sample: beside the program, in the folder where it was started, or where it was built.
fn sample() -> Option<PathBuf> {
    let beside = std::env::current_exe().ok();
    let beside = beside
        .as_deref()
        .and_then(|p| p.parent())
        .map(|p| p.join("samples"));
    let here = PathBuf::from("samples");
    let built = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples");
    let folders = beside.into_iter().chain([here, built]);
    let mut cases = folders.map(|folder| folder.join("scissor").join("SCISSOR.EGRID"));
    cases.find(|p| p.is_file())
}
