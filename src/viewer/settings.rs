//! What is remembered from session to session, in one file of the user's configuration folder.

use std::path::{Path, PathBuf};

use etcetera::base_strategy::{BaseStrategy, choose_native_strategy};
use serde::{Deserialize, Serialize};

use super::state::Playback;
use crate::picture::film::FilmFormat;

/// Cases that are remembered, at most.
const MOST_RECENT: usize = 12;

/// What the user has chosen once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Cases opened last, the newest first.
    pub recent: Vec<PathBuf>,
    /// Light letters on dark ground.
    pub dark: bool,
    /// The picture alone, without panels.
    pub hides_panels: bool,
    /// The panels left and right of the picture that are folded.
    pub folded: [bool; 2],
    /// Size of letters and controls; 1 is the screen's own.
    pub zoom: f32,
    /// How time plays.
    pub pace: Playback,
    /// What the buttons of the mouse do.
    pub mouse: Mouse,
    /// The property that cases open with, where they have it and it varies; else what the case is about.
    pub first_property: Option<String>,
    /// How pictures and films are saved.
    pub export: ExportSettings,
    /// Where they are kept; `None` where they are not.
    #[serde(skip)]
    file: Option<PathBuf>,
    /// What is wrong with the file, in one sentence.
    #[serde(skip)]
    pub problem: Option<String>,
}

/// What the buttons of the mouse do: a preset (`src/viewer/mouse.rs` has the table).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mouse {
    /// Left rotates, middle moves, right zooms.
    #[default]
    Standard,
    /// As in Petrel, and in ResInsight's mode GeoQuest: left rotates, middle moves.
    Geoquest,
    /// As in RMS, and in ResInsight's mode RMS, which it has at first: left zooms, middle rotates, right moves.
    Rms,
    /// ResInsight's mode CAD: left moves, middle rotates.
    Cad,
    /// ResInsight's mode Ceetron: left moves, middle zooms, right rotates.
    Ceetron,
}

impl Mouse {
    /// All presets.
    pub const ALL: [Self; 5] = [
        Self::Standard,
        Self::Geoquest,
        Self::Rms,
        Self::Cad,
        Self::Ceetron,
    ];

    /// The next preset.
    #[must_use]
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|m| *m == self);
        Self::ALL[at.map_or(0, |n| (n + 1) % Self::ALL.len())]
    }

    /// Its name: the program that it is like.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "StrataRay",
            Self::Geoquest => "Petrel; ResInsight (GeoQuest)",
            Self::Rms => "RMS; ResInsight (RMS, its default)",
            Self::Cad => "ResInsight (CAD)",
            Self::Ceetron => "ResInsight (Ceetron)",
        }
    }
}

/// How pictures and films are saved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExportSettings {
    /// Width and height of a picture in pixels.
    pub size: [u32; 2],
    /// With title, legend, box and axes, as the scene says.
    pub annotated: bool,
    /// Films.
    pub film: AnimationSettings,
}

/// How films are saved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct AnimationSettings {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Kind of file.
    pub format: FilmFormat,
    /// It turns around the model instead of going through time.
    pub turns: bool,
    /// Time steps per second; the player's pace where absent.
    pub steps_per_second: Option<f64>,
    /// Pictures per second of a turn.
    pub turn_fps: f64,
    /// Pictures of a turn.
    pub views: usize,
}

impl Default for ExportSettings {
    fn default() -> Self {
        Self {
            size: [1920, 1080],
            annotated: true,
            film: AnimationSettings::default(),
        }
    }
}

impl Default for AnimationSettings {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            format: FilmFormat::default(),
            turns: false,
            steps_per_second: None,
            turn_fps: 12.0,
            views: 72,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            recent: Vec::new(),
            dark: true,
            hides_panels: false,
            folded: [false, false],
            zoom: 1.0,
            pace: Playback::default(),
            mouse: Mouse::default(),
            first_property: None,
            export: ExportSettings::default(),
            file: None,
            problem: None,
        }
    }
}

impl Settings {
    /// Those of the last session, or the default ones, from the user's configuration folder.
    pub fn of_user() -> Self {
        file().map_or_else(Self::default, Self::in_file)
    }

    /// Those that a file keeps, or the default ones where it does not.
    pub fn in_file(path: PathBuf) -> Self {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let known = match serde_json::from_str(&text) {
            Ok(known) => known,
            Err(error) if !text.trim().is_empty() => Self::instead_of(&path, &error),
            Err(_) => Self::default(),
        };
        Self {
            file: Some(path),
            ..known
        }
    }

    /// The default ones where a file is broken, which is kept under another name, for it is written anew.
    fn instead_of(path: &Path, error: &serde_json::Error) -> Self {
        let copy = path.with_extension("broken.json");
        let kept = match std::fs::copy(path, &copy) {
            Ok(_) => format!("a copy of it is {}", copy.display()),
            Err(error) => format!("it cannot be copied to {}: {error}", copy.display()),
        };
        let problem = format!(
            "{} is not valid, so the settings are the default ones; {kept} ({error})",
            path.display()
        );
        Self {
            problem: Some(problem),
            ..Self::default()
        }
    }

    /// Keeps them.
    ///
    /// # Errors
    /// When they cannot be written; the sentence is for people.
    pub fn save(&self) -> Result<(), String> {
        let Some(path) = &self.file else {
            return Ok(());
        };
        let write = || -> std::io::Result<()> {
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder)?;
            }
            std::fs::write(path, serde_json::to_string_pretty(self)?)
        };
        write().map_err(|e| format!("{} cannot be written: {e}", path.display()))
    }

    /// Puts a case in front of the recent ones.
    pub fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|p| *p != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }
}

/// Where they are kept; `None` where the system has no such place.
fn file() -> Option<PathBuf> {
    let chosen = std::env::var_os("STRATARAY_CONFIG").filter(|v| !v.is_empty());
    let folder = match chosen {
        Some(chosen) => PathBuf::from(chosen),
        None => choose_native_strategy().ok()?.config_dir(),
    };
    Some(folder.join("strataray").join("settings.json"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn a_broken_file_is_kept_and_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("settings.json");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Settings::in_file(path.clone())
        };
        let broken = read("{\"dark\": tru");
        assert!(broken.dark && broken.problem.unwrap().contains("settings.broken.json"));
        let copy = std::fs::read_to_string(folder.path().join("settings.broken.json"));
        assert_eq!(copy.unwrap(), "{\"dark\": tru");
        let known = read("{\"dark\": false}");
        assert!(!known.dark && known.problem.is_none());
        assert!(read("").problem.is_none());
    }
}
