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

/// Draws the page.
pub fn show(ui: &mut Ui, settings: &Settings) -> Option<Asked> {
    let mut asked = None;
    ui.vertical_centered(|ui| {
        ui.add_space(0.15 * ui.available_height());
        ui.heading(RichText::new("StrataRay").size(34.0));
        ui.label("Reservoirs from the inside. Drop a case on the window, or open one.");
        ui.add_space(16.0);
        if ui.button("Open a case ...").clicked() {
            asked = Some(Asked::Dialog);
        }
        let samples = samples();
        section(ui, "Samples", &samples, &mut asked);
        section(ui, "Recent cases", &settings.recent, &mut asked);
    });
    asked
}

/// The page of a case that is being opened, or could not be; true where it is closed.
pub fn waiting(ui: &mut Ui, document: &Document) -> bool {
    let mut closes = false;
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

/// The bundled samples: beside the program, in the folder where it was started, or where it was built.
fn samples() -> Vec<PathBuf> {
    let beside = std::env::current_exe().ok();
    let beside = beside
        .as_deref()
        .and_then(|p| p.parent())
        .map(|p| p.join("samples"));
    let here = PathBuf::from("samples");
    let built = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples");
    let folders = beside.into_iter().chain([here, built]);
    let case = |folder: PathBuf| folder.join("scissor").join("SCISSOR.EGRID");
    folders
        .map(case)
        .find(|p| p.is_file())
        .into_iter()
        .collect()
}
