//! Dialogs for files. They wait on a thread of their own; where the system has none, a sheet asks for a path.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use eframe::egui::{self, Context, Key};

use super::export::{ExportSpec, Kind};

/// What a file is for.
#[derive(Clone)]
pub enum Purpose {
    /// A case to open.
    Case,
    /// A scene to load.
    LoadScene,
    /// Where to save the scene.
    SaveScene,
    /// Where to save the values of the selected cells.
    SaveTable,
    /// Where to write a picture or film.
    Export(Box<ExportSpec>),
}

impl Purpose {
    fn title(&self) -> &'static str {
        match self {
            Self::Case => "Open a case",
            Self::LoadScene => "Load a scene",
            Self::SaveScene => "Save the scene",
            Self::SaveTable => "Save the values of the selected cells",
            Self::Export(_) => "Write a picture or film",
        }
    }

    /// Name of a file to be written; `None` for one that exists.
    fn new_name(&self) -> Option<&'static str> {
        match self {
            Self::Case | Self::LoadScene => None,
            Self::SaveScene => Some("scene.json"),
            Self::SaveTable => Some("cells.csv"),
            Self::Export(spec) if spec.kind == Kind::Still => Some("picture.png"),
            Self::Export(_) => Some("film.png"),
        }
    }
}

/// A dialog of the system that is open.
pub struct Dialog {
    purpose: Purpose,
    answer: Receiver<Option<PathBuf>>,
    begun: Instant,
}

/// What came of a dialog.
pub enum Outcome {
    /// A file was chosen.
    Chosen(Purpose, PathBuf),
    /// None was.
    Left,
    /// The system has no dialogs.
    NoDialog(Purpose),
}

/// Nobody leaves a dialog faster than this; a system without dialogs does.
const FASTEST: Duration = Duration::from_millis(500);

impl Dialog {
    /// Asks for a file.
    pub fn begin(ctx: &Context, purpose: Purpose) -> Self {
        let (send, answer) = channel();
        let ctx = ctx.clone();
        let (title, name) = (purpose.title(), purpose.new_name());
        std::thread::spawn(move || {
            let dialog = rfd::FileDialog::new().set_title(title);
            let chosen = match name {
                Some(name) => dialog.set_file_name(name).save_file(),
                None => dialog.pick_file(),
            };
            // The window may be gone.
            let _ = send.send(chosen);
            ctx.request_repaint();
        });
        Self {
            purpose,
            answer,
            begun: Instant::now(),
        }
    }

    /// What came of it; `None` while it is open.
    pub fn poll(&self) -> Option<Outcome> {
        let chosen = match self.answer.try_recv() {
            Ok(chosen) => chosen,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
        };
        Some(match chosen {
            Some(path) => Outcome::Chosen(self.purpose.clone(), path),
            None if self.begun.elapsed() < FASTEST => Outcome::NoDialog(self.purpose.clone()),
            None => Outcome::Left,
        })
    }
}

/// A sheet that asks for a path.
pub struct PathSheet {
    purpose: Purpose,
    path: String,
}

impl PathSheet {
    /// Asks for the path of a file.
    pub fn new(purpose: Purpose) -> Self {
        let folder = std::env::current_dir().unwrap_or_default();
        let path = folder.join(purpose.new_name().unwrap_or_default());
        Self {
            path: path.display().to_string(),
            purpose,
        }
    }

    /// Draws it; `None` while it is open, then what was chosen, if anything.
    pub fn show(&mut self, ctx: &Context) -> Option<Option<(Purpose, PathBuf)>> {
        let is_new = self.purpose.new_name().is_some();
        let (mut is_open, mut is_done) = (true, false);
        let title = self.purpose.title();
        egui::Window::new(title).open(&mut is_open).show(ctx, |ui| {
            ui.label("This system has no dialog for files, so please type the path.");
            let edit = egui::TextEdit::singleline(&mut self.path).desired_width(420.0);
            let response = ui.add(edit).on_hover_text("Path");
            response.request_focus();
            let path = expanded(&self.path);
            let exists = path.is_file();
            ui.horizontal(|ui| {
                let name = if is_new { "Save" } else { "Open" };
                let button = ui.add_enabled(is_new || path.exists(), egui::Button::new(name));
                is_done = button.clicked();
                match (is_new, exists) {
                    (true, true) => ui.weak("It replaces the file that is there."),
                    (false, false) => ui.weak("There is no such file."),
                    _ => ui.weak(""),
                };
            });
            is_done |= ui.input(|i| i.key_pressed(Key::Enter)) && (is_new || path.exists());
        });
        if is_done {
            return Some(Some((self.purpose.clone(), expanded(&self.path))));
        }
        (!is_open || ctx.input(|i| i.key_pressed(Key::Escape))).then_some(None)
    }
}

/// A path as typed, `~` being the user's folder.
fn expanded(path: &str) -> PathBuf {
    let path = path.trim();
    match (path.strip_prefix("~/"), std::env::var_os("HOME")) {
        (Some(rest), Some(home)) => PathBuf::from(home).join(rest),
        _ => PathBuf::from(path),
    }
}
