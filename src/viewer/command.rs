//! The command line that makes the picture in the window.

use std::path::Path;

use crate::scene::Scene;

/// Writes a scene as JSON.
///
/// # Errors
/// When it cannot be written; the sentence is for people.
pub fn scene_text(scene: &Scene) -> Result<String, String> {
    serde_json::to_string_pretty(scene).map_err(|e| format!("the scene cannot be written: {e}"))
}

/// A line for a shell: the whole scene is in it, so that nothing else is needed.
///
/// # Errors
/// As [`scene_text`].
pub fn command(case: &Path, scene: &Scene) -> Result<String, String> {
    let json =
        serde_json::to_string(scene).map_err(|e| format!("the scene cannot be written: {e}"))?;
    Ok(format!(
        "printf '%s' {} > scene.json && strataray render {} --scene scene.json -o picture.png",
        quoted(&json),
        quoted(&case.display().to_string())
    ))
}

/// A word that a POSIX shell takes as it is.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_survive_a_shell() {
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
