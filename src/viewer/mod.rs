//! The viewer: a window on cases, their scenes and pictures. Only this module knows the interface's library.
//!
//! A document is plain data; panels change its scene through named actions; pictures follow on a thread of
//! their own.

mod action;
mod budget;
mod cases;
mod dialogs;
mod document;
mod drafts;
mod export;
mod handles;
mod history;
mod job;
mod keys;
mod link;
mod loading;
mod marks;
mod mouse;
mod orbit;
mod overlay;
mod pages;
mod panels;
mod pictures;
mod reader;
mod render_session;
mod settings;
mod shell_line;
mod slices;
mod spread;
mod state;
mod turning;
mod vectors;
mod viewport;
mod watch;
mod welcome;
mod window;
mod worker;

use std::path::PathBuf;

pub use action::{Action, Beside};
pub use document::Document;
pub use job::{ImageDifference, Picture};
pub use pictures::DraftCount;
pub use reader::{Curves, Table, TimeCurve};
pub use settings::Settings;
pub use slices::Slicing;
pub use spread::{Counts, Spread};
pub use state::{CompareLayout, Comparison, CurvePlots, Playback, Setup, State};
pub use turning::{Turned, turn};
pub use vectors::{VectorCurve, VectorCurves, VectorRequest};
pub use window::Window;

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// There is no display.
    #[error(
        "there is no display for a window; `strataray render CASE -o picture.png` makes a picture without one"
    )]
    NoDisplay,
    /// The system or the driver refuses.
    #[error(
        "the window cannot be opened: {0}; `strataray doctor` tells what is missing, and `strataray render CASE -o image.png` needs no window"
    )]
    Refused(String),
}

/// Opens the window on cases and returns when it is closed. Where it `watches`, cases are read again when
/// their files change.
///
/// # Errors
/// When there is no display or no graphics driver; the sentence says what to do.
pub fn run(cases: Vec<PathBuf>, watches: bool) -> Result<(), ViewerError> {
    let names = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    if cfg!(target_os = "linux") && !names.into_iter().any(is_set) {
        return Err(ViewerError::NoDisplay);
    }
    let viewport = eframe::egui::ViewportBuilder::default()
        .with_title("StrataRay")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([480.0, 320.0])
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions {
        viewport,
        ..Default::default()
    };
    let create = |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(Window::new(
            &cc.egui_ctx,
            cases,
            watches,
            Settings::of_user(),
        )))
    };
    eframe::run_native("strataray", options, Box::new(create))
        .map_err(|e| ViewerError::Refused(e.to_string()))
}
