//! Scenes and values in files.

use std::path::Path;

use super::Window;
use crate::scene::{Scene, read_text};
use crate::viewer::action::Action;
use crate::viewer::{panels, shell_line};

impl Window {
    /// Loads a scene into the document in front.
    ///
    /// # Errors
    /// When the file is no scene; the sentence names it.
    pub fn load_scene(&mut self, path: &Path) -> Result<String, String> {
        let why = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let text = read_text(path).map_err(|e| why(&e))?;
        let scene: Scene = serde_json::from_str(&text).map_err(|e| why(&e))?;
        let document = self.document_mut().ok_or("open a case first")?;
        document.history.end_gesture();
        document.apply(Action::Scene(Box::new(scene)));
        Ok(format!("the scene of {} is shown", path.display()))
    }

    /// Saves the scene of the document in front.
    ///
    /// # Errors
    /// When it cannot be written; the sentence names the file.
    pub fn save_scene(&self, path: &Path) -> Result<String, String> {
        let document = self.document().ok_or("there is no scene to save")?;
        let text = shell_line::scene_text(&document.state.setup.scene)?;
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(format!("the scene is in {}", path.display()))
    }

    /// Saves the summary vectors that are shown as one comma-separated table, a row for each time.
    ///
    /// # Errors
    /// When none is shown, or the file cannot be written; the sentence names it.
    pub fn save_vectors(&self, path: &Path) -> Result<String, String> {
        let document = self.document().ok_or("open a case first")?;
        let vectors = document.vectors.as_ref().filter(|v| !v.curves.is_empty());
        let vectors = vectors.ok_or("choose summary vectors below the picture first (Ctrl + G)")?;
        let text = vectors.csv(document.units())?;
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(format!("the summary vectors are in {}", path.display()))
    }

    /// Saves the values of the selected cells, and their curves, as one comma-separated table.
    ///
    /// # Errors
    /// When none is selected, or the file cannot be written; the sentence names it.
    pub fn save_table(&self, path: &Path) -> Result<String, String> {
        let document = self.document().ok_or("open a case first")?;
        let table = document.table.as_ref().ok_or("select a cell first")?;
        let text = panels::csv(table, document.curves.as_ref(), document.units())?;
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(format!("the values are in {}", path.display()))
    }
}
