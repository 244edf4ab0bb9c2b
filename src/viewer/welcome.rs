//! The page without a case: samples, recent cases, where to drop a file.

use std::path::PathBuf;

use eframe::egui::{Color32, RichText, Spinner, Ui};

use super::document::Document;
use super::settings::Settings;

/// What the user asked for.
pub enum Asked {
    /// A case.
    Open(PathBuf),
    /// The dialog for files.
    Dialog,
}

/// What a hand new to the window needs to know.
const FIRST_STEPS: [(&str, &str); 5] = [
    ("Left drag", "turns around what is under the pointer"),
    ("Wheel, two fingers", "comes closer"),
    ("Click", "tells all values of the cell that is seen there"),
    ("Space", "plays the time steps"),
    ("F1", "lists all keys"),
];

/// Draws the page.
pub fn show(ui: &mut Ui, settings: &Settings) -> Option<Asked> {
    let mut asked = None;
    fill(ui);
    ui.vertical_centered(|ui| {
        ui.add_space(0.12 * ui.available_height());
        ui.heading(RichText::new("StrataRay").size(34.0));
        ui.label("Reservoirs from the inside. Drop a case on the window, or open one.");
        ui.add_space(16.0);
        if ui.button("Open a case ...").clicked() {
            asked = Some(Asked::Dialog);
        }
        if let Some(sample) = sample() {
            section(ui, "Sample", &[sample], &mut asked);
            ui.label("A faulted oil field after 20 years of water flood:\nwhich oil is left, and behind which fault?");
        }
        section(ui, "Recent cases", &settings.recent, &mut asked);
        ui.add_space(28.0);
        for (what, does) in FIRST_STEPS {
            ui.weak(format!("{what} {does}"));
        }
    });
    asked
}

/// Paints the ground of a page without a picture.
fn fill(ui: &Ui) {
    let ground = ui.visuals().panel_fill;
    ui.painter().rect_filled(ui.max_rect(), 0.0, ground);
}

/// The page of a case that is being opened, or could not be; true where it is closed.
pub fn waiting(ui: &mut Ui, document: &Document) -> bool {
    let mut closes = false;
    fill(ui);
    ui.vertical_centered(|ui| {
        ui.add_space(0.4 * ui.available_height());
        ui.label(document.path.display().to_string());
        match (&document.loading, &document.error) {
            (Some(loading), _) => {
                ui.add(Spinner::new());
                ui.label(format!("reading {}", loading.stage()));
                closes = ui.button("Cancel").clicked();
            }
            (None, error) => {
                let red = Color32::from_rgb(220, 80, 60);
                ui.colored_label(red, error.as_deref().unwrap_or("it was not opened"));
                closes = ui.button("Close").clicked();
            }
        }
    });
    closes
}

fn section(ui: &mut Ui, title: &str, cases: &[PathBuf], asked: &mut Option<Asked>) {
    if cases.is_empty() {
        return;
    }
    ui.add_space(18.0);
    ui.strong(title);
    for case in cases {
        let name = case.file_stem().unwrap_or_default().to_string_lossy();
        if ui
            .link(name)
            .on_hover_text(case.display().to_string())
            .clicked()
        {
            *asked = Some(Asked::Open(case.clone()));
        }
    }
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
