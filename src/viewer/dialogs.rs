//! Dialogs for files. They wait on a thread of their own; where the system has none, a sheet asks for a path.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use eframe::egui::{self, Context, Key, Ui};

use super::cases::{self, Meaning};
use super::export::{ExportKind, ExportSpec};

/// What a file is for.
#[derive(Clone)]
pub enum Purpose {
    /// A case to open.
    Case,
    /// Files to add to the case in front.
    Add,
    /// A scene to load.
    LoadScene,
    /// Where to save the scene.
    SaveScene,
    /// Where to save the values of the selected cells.
    SaveTable,
    /// Where to save the summary vectors that are shown.
    SaveVectors,
    /// Where to write a picture or film.
    Export(Box<ExportSpec>),
}

impl Purpose {
    fn title(&self) -> &'static str {
        match self {
            Self::Case => "Open a case",
            Self::Add => "Add files to the case",
            Self::LoadScene => "Load a scene",
            Self::SaveScene => "Save the scene",
            Self::SaveTable => "Save the values of the selected cells",
            Self::SaveVectors => "Save the summary vectors shown",
            Self::Export(spec) => match spec.kind {
                ExportKind::Still => "Save an image",
                ExportKind::Cells => {
                    "Export cells (.vtu, .EGRID, .grdecl, .roff, .csv, .parquet, .glb)"
                }
                ExportKind::Steps { .. } | ExportKind::Orbit { .. } => "Save an animation",
            },
        }
    }

    /// Name of a file to be written; `None` for one that exists.
    fn new_name(&self) -> Option<String> {
        match self {
            Self::Case | Self::Add | Self::LoadScene => None,
            Self::SaveScene => Some("scene.json".into()),
            Self::SaveTable => Some("cells.csv".into()),
            Self::SaveVectors => Some("vectors.csv".into()),
            Self::Export(spec) => Some(match spec.ending() {
                Some(ending) => format!("{}.{ending}", spec.case.about.name),
                None => format!("{}-images", spec.case.about.name),
            }),
        }
    }

    /// What is written where `path` was chosen: a path without an ending gets one, or is a folder where
    /// numbered images are written.
    pub fn file(&self, path: PathBuf) -> PathBuf {
        let name = self.new_name().map(PathBuf::from);
        let has_ending = path.extension().is_some() || path.is_dir();
        match name.as_deref().map(Path::extension) {
            Some(Some(ending)) if !has_ending => path.with_extension(ending),
            Some(None) if !has_ending => path.join(""),
            _ => path,
        }
    }

    /// True where a folder is written.
    fn is_folder(&self) -> bool {
        matches!(self, Self::Export(spec) if spec.ending().is_none())
    }
}

/// A dialog of the system that is open.
pub struct Dialog {
    purpose: Purpose,
    answer: Receiver<SystemAnswer>,
    begun: Instant,
}

/// What the system's dialog said.
enum SystemAnswer {
    Chosen(Vec<PathBuf>),
    Left,
    NoDialog,
}

/// What came of a dialog.
pub enum Outcome {
    /// Files were chosen: one, or more where cases are opened.
    Chosen(Purpose, Vec<PathBuf>),
    /// None was.
    Left,
    /// The system has no dialogs.
    NoDialog(Purpose),
}

/// Nobody leaves a dialog faster than this; a system whose dialogs fail does.
const FASTEST: Duration = Duration::from_millis(500);

impl Dialog {
    /// Asks for a file.
    pub fn begin(ctx: &Context, purpose: Purpose) -> Self {
        let (send, answer) = channel();
        let ctx = ctx.clone();
        let (title, name) = (purpose.title(), purpose.new_name());
        let has_many = matches!(purpose, Purpose::Case | Purpose::Add);
        std::thread::spawn(move || {
            let dialog = rfd::FileDialog::new().set_title(title);
            let one = |chosen: Option<PathBuf>| chosen.map(|path| vec![path]);
            let chosen = match name {
                _ if !system_has_dialogs() => None,
                Some(name) => Some(one(dialog.set_file_name(name).save_file())),
                None if has_many => Some(dialog.pick_files()),
                None => Some(one(dialog.pick_file())),
            };
            // The window may be gone.
            let _ = send.send(match chosen {
                Some(Some(paths)) => SystemAnswer::Chosen(paths),
                Some(None) => SystemAnswer::Left,
                None => SystemAnswer::NoDialog,
            });
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
        let answer = match self.answer.try_recv() {
            Ok(answer) => answer,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => SystemAnswer::NoDialog,
        };
        let purpose = self.purpose.clone();
        Some(match answer {
            SystemAnswer::Chosen(paths) => Outcome::Chosen(purpose, paths),
            SystemAnswer::Left if self.begun.elapsed() >= FASTEST => Outcome::Left,
            _ => Outcome::NoDialog(purpose),
        })
    }
}

/// True where the system may show a dialog: on Linux one of the desktop's portal, which is reached by the
/// session bus, or of the program zenity.
fn system_has_dialogs() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let variable = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty());
    let has_bus = variable("DBUS_SESSION_BUS_ADDRESS").is_some()
        || variable("XDG_RUNTIME_DIR").is_some_and(|d| PathBuf::from(d).join("bus").exists());
    let folders = variable("PATH").unwrap_or_default();
    has_bus || std::env::split_paths(&folders).any(|f| f.join("zenity").is_file())
}

/// A sheet that asks for a path.
pub struct PathSheet {
    purpose: Purpose,
    path: String,
    /// The text field has had the focus.
    is_begun: bool,
    /// What was found for the path that was typed.
    found: Option<TypedPath>,
}

/// What a path means, looked up when it changes.
struct TypedPath {
    path: String,
    wanted: Choosable,
    offered: Vec<PathBuf>,
}

/// What came of a sheet.
pub enum SheetResult {
    /// Files, as from a dialog.
    Files(Purpose, Vec<PathBuf>),
    /// It was closed.
    Left,
}

impl PathSheet {
    /// Asks for the path of a file.
    pub fn new(purpose: Purpose) -> Self {
        let folder = std::env::current_dir().unwrap_or_default();
        let path = folder.join(purpose.new_name().unwrap_or_default());
        Self {
            path: path.display().to_string(),
            purpose,
            is_begun: false,
            found: None,
        }
    }

    /// Draws it; `None` while it is open.
    pub fn show(&mut self, ctx: &Context) -> Option<SheetResult> {
        let (mut is_open, mut chosen) = (true, None);
        egui::Window::new(self.purpose.title())
            .open(&mut is_open)
            .default_width(440.0)
            .show(ctx, |ui| chosen = self.body(ui));
        if let Some(paths) = chosen {
            return Some(SheetResult::Files(self.purpose.clone(), paths));
        }
        (!is_open || ctx.input(|i| i.key_pressed(Key::Escape))).then_some(SheetResult::Left)
    }

    /// The files that were chosen.
    fn body(&mut self, ui: &mut Ui) -> Option<Vec<PathBuf>> {
        ui.label("This system has no file dialog. Type the path; ~ is your home folder.");
        let edit = egui::TextEdit::singleline(&mut self.path).desired_width(f32::INFINITY);
        let response = ui.add(edit).on_hover_text("Path");
        if !self.is_begun {
            self.is_begun = true;
            response.request_focus();
        }
        let is_entered = response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        let known = self.found.take().filter(|f| f.path == self.path);
        let found = known.unwrap_or_else(|| self.look_up());
        let wanted = found.wanted.clone();
        let mut chosen = None;
        ui.horizontal_wrapped(|ui| {
            let name = match self.purpose.new_name() {
                Some(_) => "Save",
                None => "Open",
            };
            let button = ui.add_enabled(wanted.0.is_some(), egui::Button::new(name));
            if button.clicked() || is_entered {
                chosen = wanted.0;
            }
            ui.weak(wanted.1);
        });
        if is_entered && chosen.is_none() {
            response.request_focus();
        }
        if matches!(self.purpose, Purpose::Case) {
            let offered = self.offer(ui, &found.offered);
            chosen = offered.map(|case| vec![case]).or(chosen);
        }
        self.found = Some(found);
        chosen
    }

    fn look_up(&self) -> TypedPath {
        let path = cases::expanded(&self.path);
        let wanted = match self.purpose {
            Purpose::Case => of_case(&path),
            Purpose::Add | Purpose::LoadScene => of_old(&path),
            _ if self.purpose.is_folder() && path.is_dir() => {
                (Some(vec![path.clone()]), String::new())
            }
            _ => of_new(&self.purpose.file(path.clone())),
        };
        TypedPath {
            path: self.path.clone(),
            wanted,
            offered: cases::offered(&path, &self.path),
        }
    }

    /// Lists what the path may go on with; the case that was clicked. A folder that was clicked is the path.
    fn offer(&mut self, ui: &mut Ui, offered: &[PathBuf]) -> Option<PathBuf> {
        let mut chosen = None;
        egui::ScrollArea::vertical()
            .max_height(180.0)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for entry in offered {
                    let name = entry.file_name().unwrap_or_default().to_string_lossy();
                    if entry.is_dir() {
                        let name = format!("{name}{}", std::path::MAIN_SEPARATOR);
                        if ui.link(name).clicked() {
                            self.path = format!("{}{}", entry.display(), std::path::MAIN_SEPARATOR);
                            // The cursor comes back to the end of it.
                            self.is_begun = false;
                        }
                    } else if ui.link(name.as_ref()).clicked() {
                        chosen = Some(entry.clone());
                    }
                }
            });
        chosen
    }
}

/// Files that can be chosen by a path, and what to say of it.
type Choosable = (Option<Vec<PathBuf>>, String);

fn of_case(path: &Path) -> Choosable {
    match cases::meaning(path) {
        Meaning::Case(case) => {
            let name = case.file_name().unwrap_or_default().to_string_lossy();
            let said = format!("Opens {name}.");
            (Some(vec![case]), said)
        }
        Meaning::Several(all) => (
            Some(vec![path.to_owned()]),
            format!("{} cases; choose one:", all.len()),
        ),
        Meaning::Nothing(_) => (None, "There is no such case.".into()),
    }
}

fn of_old(path: &Path) -> Choosable {
    match path.is_file() {
        true => (Some(vec![path.to_owned()]), String::new()),
        false => (None, "There is no such file.".into()),
    }
}

fn of_new(path: &Path) -> Choosable {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
    if path.is_dir() {
        (None, "This is a folder; add a file name.".into())
    } else if folder.is_some_and(|f| !f.is_dir()) {
        (None, "There is no such folder.".into())
    } else if path.is_file() {
        let said = "Replaces the existing file.".into();
        (Some(vec![path.to_owned()]), said)
    } else {
        (Some(vec![path.to_owned()]), String::new())
    }
}

/// A sheet with the cases of a folder.
pub struct CasesSheet {
    cases: Vec<PathBuf>,
}

impl CasesSheet {
    /// Asks which of some cases to open.
    pub fn new(cases: Vec<PathBuf>) -> Self {
        Self { cases }
    }

    /// Draws it; `None` while it is open, then what was chosen, if anything.
    pub fn show(&self, ctx: &Context) -> Option<Vec<PathBuf>> {
        let (mut is_open, mut chosen) = (true, None);
        let folder = self.cases.first().and_then(|c| c.parent());
        egui::Window::new("Choose a case")
            .open(&mut is_open)
            .show(ctx, |ui| {
                if let Some(folder) = folder {
                    ui.label(format!(
                        "{} cases in {}",
                        self.cases.len(),
                        folder.display()
                    ));
                }
                let list = egui::ScrollArea::vertical().max_height(260.0);
                list.show(ui, |ui| {
                    for case in &self.cases {
                        let name = case.file_name().unwrap_or_default().to_string_lossy();
                        if ui.link(name).clicked() {
                            chosen = Some(vec![case.clone()]);
                        }
                    }
                });
                if ui.button("Open all").clicked() {
                    chosen = Some(self.cases.clone());
                }
            });
        let is_left = !is_open || ctx.input(|i| i.key_pressed(Key::Escape));
        chosen.or(is_left.then(Vec::new))
    }
}
