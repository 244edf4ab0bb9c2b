//! Dialogs for files. They wait on a thread of their own.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use eframe::egui::Context;

use super::export::ExportSpec;

/// What a dialog was for, and what was chosen.
pub enum Chosen {
    /// A case to open.
    Case(PathBuf),
    /// A scene to load.
    LoadScene(PathBuf),
    /// Where to save the scene.
    SaveScene(PathBuf),
    /// Where to save the values of the selected cells.
    SaveTable(PathBuf),
    /// Where to write a picture or film.
    Export(Box<ExportSpec>, PathBuf),
}

/// A dialog that is open.
pub struct Dialog(Receiver<Option<Chosen>>);

impl Dialog {
    /// Asks for a file that exists.
    pub fn open(ctx: &Context, what: impl FnOnce(PathBuf) -> Chosen + Send + 'static) -> Self {
        Self::begin(ctx, what, rfd::FileDialog::pick_file)
    }

    /// Asks where to write a file.
    pub fn save(
        ctx: &Context,
        name: &'static str,
        what: impl FnOnce(PathBuf) -> Chosen + Send + 'static,
    ) -> Self {
        Self::begin(ctx, what, move |dialog| {
            dialog.set_file_name(name).save_file()
        })
    }

    fn begin(
        ctx: &Context,
        what: impl FnOnce(PathBuf) -> Chosen + Send + 'static,
        ask: impl FnOnce(rfd::FileDialog) -> Option<PathBuf> + Send + 'static,
    ) -> Self {
        let (send, chosen) = channel();
        let ctx = ctx.clone();
        std::thread::spawn(move || {
            // The window may be gone.
            let _ = send.send(ask(rfd::FileDialog::new()).map(what));
            ctx.request_repaint();
        });
        Self(chosen)
    }

    /// What was chosen, or nothing; `None` while the dialog is open.
    pub fn poll(&self) -> Option<Option<Chosen>> {
        match self.0.try_recv() {
            Ok(chosen) => Some(chosen),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(None),
        }
    }
}
