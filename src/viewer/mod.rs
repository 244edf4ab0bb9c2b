//! The viewer: a window on cases, their scenes and pictures. Only this module knows the interface's library.
//!
//! A document is plain data; panels change its scene through named actions; pictures follow on a thread of
//! their own.

mod action;
mod command;
mod document;
mod history;
mod keys;
mod loading;
mod orbit;
mod overlay;
mod panels;
mod settings;
mod viewport;
mod welcome;
mod window;
mod worker;

use std::path::PathBuf;

pub use action::Action;
pub use document::{Document, Status};
pub use window::Window;

/// Opens the window on cases and returns when it is closed.
///
/// # Errors
/// When there is no display or no graphics driver; the sentence says what to do.
pub fn run(cases: Vec<PathBuf>) -> Result<(), String> {
    let names = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    if cfg!(target_os = "linux") && !names.into_iter().any(is_set) {
        return Err("there is no display for a window; `strataray render CASE -o picture.png` makes a picture without one".into());
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
        Ok(Box::new(Window::new(&cc.egui_ctx, cases)))
    };
    eframe::run_native("strataray", options, Box::new(create))
        .map_err(|e| format!("the window cannot be opened: {e}"))
}
