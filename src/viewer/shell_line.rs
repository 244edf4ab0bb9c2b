//! The command line that makes the picture in the window.

use std::path::Path;

use crate::case::load::CasePaths;
use crate::scene::Scene;

/// Writes a scene as JSON.
///
/// # Errors
/// When it cannot be written; the sentence is for people.
pub fn scene_text(scene: &Scene) -> Result<String, String> {
    serde_json::to_string_pretty(scene).map_err(|e| format!("the scene cannot be written: {e}"))
}

/// A line for a POSIX shell that can be run as it stands, in any folder: the whole scene is in it, `program`
/// and `case` are absolute, and the name of the picture has the time at which the line is run, so that no
/// file is replaced.
///
/// # Errors
/// As [`scene_text`].
pub fn command(program: &Path, paths: &CasePaths, scene: &Scene) -> Result<String, String> {
    let json =
        serde_json::to_string(scene).map_err(|e| format!("the scene cannot be written: {e}"))?;
    let name = paths.path.file_stem().unwrap_or_default().to_string_lossy();
    let absolute = |path: &Path| {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        quoted(&path.display().to_string())
    };
    let with = match paths.with.as_slice() {
        [] => String::new(),
        files => {
            let files: Vec<_> = files.iter().map(|f| absolute(f)).collect();
            format!(" --with {}", files.join(" "))
        }
    };
    let others: Vec<_> = paths.others.iter().map(|o| absolute(&o.path)).collect();
    let ensemble = match others.is_empty() {
        true => String::new(),
        false => format!(" --ensemble {}", others.join(" ")),
    };
    Ok(format!(
        "printf '%s' {} | {} render {}{with}{ensemble} --scene - -o {}-$(date +%Y%m%d-%H%M%S).png",
        quoted(&json),
        absolute(program),
        absolute(&paths.path),
        // A name that begins with a dash would be an option.
        quoted(&format!("./{name}")),
    ))
}

/// A word that a POSIX shell takes as it is.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn quotes_survive_a_shell() {
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }

    /// A shell runs the line; a program that only tells what it got stands for ours.
    #[cfg(unix)]
    #[test]
    fn a_shell_hands_over_scene_and_paths() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("it's a program");
        std::fs::write(&program, "#!/bin/sh\nprintf '%s\\n' \"$@\"; cat\n").unwrap();
        std::fs::set_permissions(&program, PermissionsExt::from_mode(0o755)).unwrap();
        let case = folder.path().join("-of two words.EGRID");
        let scene = Scene {
            property: Some("it's SOIL $HOME `id`".into()),
            size: [123, 45],
            ..Scene::default()
        };
        let paths = CasePaths {
            path: case.clone(),
            with: vec![folder.path().join("its faults.inc")],
            others: Vec::new(),
        };
        let line = command(&program, &paths, &scene).unwrap();
        let run = std::process::Command::new("sh")
            .args(["-c", &line])
            .output();
        let said = String::from_utf8(run.unwrap().stdout).unwrap();
        let mut lines = said.splitn(9, '\n');
        let mut next = || lines.next().unwrap().to_owned();
        assert_eq!(next(), "render");
        assert_eq!(next(), case.display().to_string());
        let with = paths.with[0].display().to_string();
        assert_eq!([next(), next()], ["--with".to_owned(), with]);
        assert_eq!([next(), next(), next()], ["--scene", "-", "-o"]);
        let name = next();
        assert!(
            name.starts_with("./-of two words-2") && name.ends_with(".png"),
            "{name}"
        );
        let read: Scene = serde_json::from_str(&next()).unwrap();
        assert_eq!(read, scene);
    }
}
