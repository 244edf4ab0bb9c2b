//! The window: tabs, panels around the viewport, and when which picture is asked for.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, Color32, ColorImage, Context, TextureHandle, TextureOptions, Ui};

use super::action::Action;
use super::document::{Document, Status};
use super::keys::{self, Command};
use super::loading::Loading;
use super::panels::{self, About, Panel, Player};
use super::settings::Settings;
use super::viewport::{self, Viewport};
use super::welcome::{self, Asked};
use super::worker::{Answer, Job, PickJob, Picture, PictureJob, Worker};
use super::{command, orbit};
use crate::picture;
use crate::scene::{LightingSpec, Scene};
use crate::strategies::StrategyKind;

/// The window's state.
pub struct Window {
    documents: Vec<Document>,
    current: usize,
    worker: Worker,
    flight: Option<Flight>,
    /// The last picture, of which document, and the texture that has it.
    shown: Option<Shown>,
    /// The scene whose draft, and whose final picture, is shown.
    drafted: Option<Scene>,
    finished: Option<Scene>,
    /// Milliseconds that a pixel of a draft takes.
    draft_ms: f64,
    /// When the scene changed last.
    changed: Instant,
    viewport: Viewport,
    adapter: Option<(String, bool)>,
    /// What to tell the user, and whether it is an error.
    message: Option<(String, bool)>,
    progress: Option<f32>,
    settings: Settings,
    shows_keys: bool,
    shows_notes: bool,
    chosen: Option<std::sync::mpsc::Receiver<Chosen>>,
}

/// The picture on its way.
struct Flight {
    wanted: Scene,
    is_draft: bool,
    is_cancelled: bool,
}

struct Shown {
    document: PathBuf,
    picture: Picture,
    texture: TextureHandle,
}

/// What a file dialog was for, and what was chosen.
enum Chosen {
    Case(PathBuf),
    LoadScene(PathBuf),
    SaveScene(PathBuf),
    Screenshot(PathBuf),
}

/// Milliseconds that a draft may take: 30 pictures a second.
const DRAFT_MS: f64 = 30.0;
/// The same where time plays: a step stands for longer.
const PLAY_MS: f64 = 250.0;
/// A final picture is made where nothing has changed for so long.
const REST: Duration = Duration::from_millis(150);
/// Time steps a second.
const PLAY: Duration = Duration::from_millis(400);
/// Side of a draft, as a part of full resolution, at least.
const COARSEST: f64 = 0.12;

impl Window {
    /// The window on some cases.
    pub fn new(ctx: &Context, cases: Vec<PathBuf>) -> Self {
        let waker = ctx.clone();
        let settings = Settings::load();
        let mut window = Self {
            documents: Vec::new(),
            current: 0,
            worker: Worker::start(move || waker.request_repaint()),
            flight: None,
            shown: None,
            drafted: None,
            finished: None,
            draft_ms: 1e-3,
            changed: Instant::now(),
            viewport: Viewport::default(),
            adapter: None,
            message: None,
            progress: None,
            settings,
            shows_keys: false,
            shows_notes: false,
            chosen: None,
        };
        for case in cases {
            window.open(ctx, case);
        }
        window
    }

    /// Opens a case in a tab of its own.
    pub fn open(&mut self, ctx: &Context, path: PathBuf) {
        let scene = self.first_scene();
        let loading = load(ctx, path.clone());
        self.documents.push(Document::new(path, loading, scene));
        self.show_tab(self.documents.len() - 1);
    }

    /// Brings a document to the front.
    fn show_tab(&mut self, tab: usize) {
        self.current = tab;
        self.finished = None;
        self.drafted = None;
    }

    /// The document in front.
    pub fn document(&self) -> Option<&Document> {
        self.documents.get(self.current)
    }

    /// The document in front, to change it.
    pub fn document_mut(&mut self) -> Option<&mut Document> {
        self.documents.get_mut(self.current)
    }

    /// What is told at the bottom, and whether it is an error.
    pub fn message(&self) -> Option<(&str, bool)> {
        self.message.as_ref().map(|(m, e)| (m.as_str(), *e))
    }

    /// The last picture and whether it is the final one of what the scene asks for now.
    pub fn picture(&self) -> Option<(&Picture, bool)> {
        let shown = self.shown.as_ref()?;
        Some((&shown.picture, self.is_final()))
    }

    /// How a case is shown at first.
    fn first_scene(&self) -> Scene {
        let is_software = self.adapter.as_ref().is_none_or(|a| a.1);
        let lighting = match is_software {
            true => LightingSpec::default(),
            false => LightingSpec::preset("soft").unwrap_or_default(),
        };
        Scene {
            strategy: StrategyKind::Libc.name().into(),
            lighting,
            ..Scene::default()
        }
    }

    fn tell(&mut self, text: impl Into<String>) {
        self.message = Some((text.into(), false));
    }

    fn fail(&mut self, text: impl Into<String>) {
        self.message = Some((text.into(), true));
    }

    /// Takes in what happened since the last frame.
    fn listen(&mut self, ctx: &Context) {
        for answer in self.worker.poll() {
            self.take(ctx, answer);
        }
        let mut opened = Vec::new();
        for document in &mut self.documents {
            let Status::Loading(loading) = &document.status else {
                continue;
            };
            match loading.poll() {
                Some(Ok(case)) => {
                    opened.push(document.path.clone());
                    document.status = Status::Ready(case);
                }
                Some(Err(error)) => document.status = Status::Failed(error),
                None => {}
            }
        }
        for path in opened {
            self.settings.remember(&path);
            if let Err(error) = self.settings.save() {
                self.fail(error);
            }
        }
        let dropped = ctx.input(|i| i.raw.dropped_files.clone());
        for path in dropped.iter().map(|f| f.path().to_owned()) {
            self.open(ctx, path);
        }
        if let Some(chosen) = self.chosen.as_ref().and_then(|c| c.try_recv().ok()) {
            self.chosen = None;
            self.choose(ctx, chosen);
        }
    }

    fn take(&mut self, ctx: &Context, answer: Answer) {
        match answer {
            Answer::Adapter { name, is_software } => self.adapter = Some((name, is_software)),
            Answer::Progress(part) => self.progress = Some(part),
            Answer::Cancelled => {
                self.land();
            }
            Answer::Failed(error) => {
                // Not asked for again before the scene changes.
                if let Some(flight) = self.land() {
                    self.drafted = Some(flight.wanted.clone());
                    self.finished = Some(flight.wanted);
                }
                self.fail(error);
            }
            Answer::Picked(picked) => {
                if picked.is_none() {
                    self.tell("nothing is drawn there");
                }
                if let Some(document) = self.document_mut() {
                    document.picked = picked;
                }
            }
            Answer::Picture(picture) => {
                if let Some(flight) = self.land() {
                    self.arrive(ctx, *picture, flight);
                }
            }
        }
    }

    fn land(&mut self) -> Option<Flight> {
        self.progress = None;
        self.flight.take()
    }

    fn arrive(&mut self, ctx: &Context, picture: Picture, flight: Flight) {
        let pixels = f64::from(picture.size[0]) * f64::from(picture.size[1]);
        let ms = 1e3 * (picture.took - picture.prepare.min(picture.took)).as_secs_f64();
        if flight.is_draft {
            self.draft_ms = 0.5 * self.draft_ms + 0.5 * ms / pixels;
            self.drafted = Some(flight.wanted);
            // What is shown is no longer what was finished before.
            self.finished = None;
        } else {
            self.drafted = Some(flight.wanted.clone());
            self.finished = Some(flight.wanted);
        }
        let size = picture.size.map(|n| n as usize);
        let image = ColorImage::from_rgb(size, picture.rgb.as_flattened());
        let texture = ctx.load_texture("picture", image, TextureOptions::LINEAR);
        let document = self.document().map(|d| d.path.clone()).unwrap_or_default();
        if self.message.as_ref().is_some_and(|m| m.1) {
            self.message = None;
        }
        self.shown = Some(Shown {
            document,
            picture,
            texture,
        });
    }

    /// The scene in the size of the viewport.
    fn wanted(&self, ctx: &Context, part: f64) -> Option<Scene> {
        let document = self.document()?;
        let rect = self.viewport.rect?;
        Some(Scene {
            size: viewport::pixels(rect, ctx.pixels_per_point(), part as f32),
            ..document.scene.clone()
        })
    }

    fn is_final(&self) -> bool {
        let full = |s: &Scene| self.document().is_some_and(|d| same_but_size(s, &d.scene));
        self.finished.as_ref().is_some_and(full)
    }

    /// Asks for the next picture, where one is due.
    fn schedule(&mut self, ctx: &Context, is_busy: bool) {
        let Some(case) = self.document().and_then(Document::case).cloned() else {
            return;
        };
        let Some(wanted) = self.wanted(ctx, 1.0) else {
            return;
        };
        if let Some(flight) = &mut self.flight {
            if !flight.is_draft && !flight.is_cancelled && flight.wanted != wanted {
                flight.is_cancelled = true;
                self.worker.cancel();
            }
            return;
        }
        let plays = self.document().is_some_and(|d| d.playing.is_some());
        let draft_ms = if plays { PLAY_MS } else { DRAFT_MS };
        let is_busy = is_busy || plays;
        let pixels = f64::from(wanted.size[0]) * f64::from(wanted.size[1]);
        let full_ms = self.draft_ms * pixels;
        let is_draft = if self.finished.as_ref() == Some(&wanted) {
            return;
        } else if full_ms <= draft_ms {
            false
        } else if self.drafted.as_ref() != Some(&wanted) {
            true
        } else if is_busy || self.changed.elapsed() < REST {
            ctx.request_repaint_after(REST);
            return;
        } else {
            false
        };
        let part = match is_draft {
            true => (draft_ms / full_ms).sqrt().clamp(COARSEST, 1.0),
            false => 1.0,
        };
        let Some(scene) = self.wanted(ctx, part) else {
            return;
        };
        self.worker.ask(Job::Picture(PictureJob {
            case,
            scene,
            is_draft,
        }));
        self.flight = Some(Flight {
            wanted,
            is_draft,
            is_cancelled: false,
        });
    }

    /// Goes to the next step where time plays and the picture of this one is there.
    fn play(&mut self, ctx: &Context) {
        let has_picture = self.flight.is_none();
        let Some(document) = self.document_mut() else {
            return;
        };
        let Some(since) = document.playing else {
            return;
        };
        let waits = PLAY.saturating_sub(since.elapsed());
        if waits.is_zero() && has_picture {
            document.playing = Some(Instant::now());
            document.move_step(1, true);
        }
        ctx.request_repaint_after(waits.max(Duration::from_millis(10)));
    }

    fn perform(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::Open => self.ask_file(ctx, Chosen::Case),
            Command::Help => self.shows_keys = !self.shows_keys,
            Command::Theme => {
                self.settings.dark = !self.settings.dark;
                if let Err(error) = self.settings.save() {
                    self.fail(error);
                }
            }
            Command::SaveScene => self.ask_new_file(ctx, "scene.json", Chosen::SaveScene),
            Command::LoadScene => self.ask_file(ctx, Chosen::LoadScene),
            Command::Screenshot => self.ask_new_file(ctx, "picture.png", Chosen::Screenshot),
            Command::CopyLine => self.copy_command(ctx),
            Command::Reload => self.reload(ctx),
            other => self.change(other),
        }
    }

    /// Commands that concern the document alone.
    fn change(&mut self, command: Command) {
        let message = {
            let Some(document) = self.documents.get_mut(self.current) else {
                return;
            };
            document.history.end_gesture();
            match command {
                Command::Undo => {
                    let undone = document.history.undo(&mut document.scene);
                    Some(undone.map_or("nothing to undo".into(), |n| format!("undone: {n}")))
                }
                Command::Redo => {
                    let redone = document.history.redo(&mut document.scene);
                    Some(redone.map_or("nothing to redo".into(), |n| format!("redone: {n}")))
                }
                Command::Play => {
                    document.playing = match document.playing {
                        Some(_) => None,
                        None => Some(Instant::now()),
                    };
                    None
                }
                Command::Step(by) => {
                    document.move_step(by, false);
                    None
                }
                Command::End(last) => {
                    document.move_step(if last { isize::MAX / 2 } else { isize::MIN / 2 }, false);
                    None
                }
                Command::View(n) => {
                    let (_, azimuth, elevation) = orbit::VIEWS[n];
                    document.apply(Action::Camera(orbit::framing(azimuth, elevation)));
                    None
                }
                Command::FrameAll => {
                    document.apply(Action::Camera(orbit::framing(205.0, 35.0)));
                    None
                }
                Command::NextStrategy => {
                    let all = StrategyKind::ALL;
                    let at = all.iter().position(|k| k.name() == document.scene.strategy);
                    let next = all[at.map_or(0, |n| (n + 1) % all.len())];
                    document.apply(Action::Strategy(next.name().into()));
                    Some(next.describe().to_owned())
                }
                Command::Light => {
                    let off = LightingSpec::default();
                    let on = LightingSpec::preset("soft").unwrap_or_default();
                    let next = if document.scene.lighting == off {
                        on
                    } else {
                        off
                    };
                    document.apply(Action::Lighting(next));
                    None
                }
                _ => None,
            }
        };
        if let Some(message) = message {
            self.tell(message);
        }
    }

    fn reload(&mut self, ctx: &Context) {
        if let Some(document) = self.document_mut() {
            document.status = Status::Loading(load(ctx, document.path.clone()));
            self.finished = None;
            self.drafted = None;
        }
    }

    fn copy_command(&mut self, ctx: &Context) {
        let Some(document) = self.document() else {
            return;
        };
        match command::command(&document.path, &document.scene) {
            Ok(text) => {
                ctx.copy_text(text);
                self.tell("the command line is in the clipboard");
            }
            Err(error) => self.fail(error),
        }
    }

    fn ask_file(&mut self, ctx: &Context, what: fn(PathBuf) -> Chosen) {
        self.dialog(ctx, what, |dialog| dialog.pick_file());
    }

    fn ask_new_file(&mut self, ctx: &Context, name: &'static str, what: fn(PathBuf) -> Chosen) {
        self.dialog(ctx, what, move |dialog| {
            dialog.set_file_name(name).save_file()
        });
    }

    /// Dialogs wait on a thread of their own.
    fn dialog(
        &mut self,
        ctx: &Context,
        what: fn(PathBuf) -> Chosen,
        ask: impl FnOnce(rfd::FileDialog) -> Option<PathBuf> + Send + 'static,
    ) {
        let (send, chosen) = std::sync::mpsc::channel();
        self.chosen = Some(chosen);
        let ctx = ctx.clone();
        std::thread::spawn(move || {
            if let Some(path) = ask(rfd::FileDialog::new()) {
                // The window may be gone.
                let _ = send.send(what(path));
            }
            ctx.request_repaint();
        });
    }

    fn choose(&mut self, ctx: &Context, chosen: Chosen) {
        let done = match chosen {
            Chosen::Case(path) => {
                self.open(ctx, path);
                return;
            }
            Chosen::LoadScene(path) => self.load_scene(&path),
            Chosen::SaveScene(path) => self.save_scene(&path),
            Chosen::Screenshot(path) => self.save_picture(&path),
        };
        match done {
            Ok(text) => self.tell(text),
            Err(error) => self.fail(error),
        }
    }

    /// Loads a scene into the document in front.
    ///
    /// # Errors
    /// When the file is no scene; the sentence names it.
    pub fn load_scene(&mut self, path: &std::path::Path) -> Result<String, String> {
        let why = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let text = std::fs::read_to_string(path).map_err(|e| why(&e))?;
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
    pub fn save_scene(&self, path: &std::path::Path) -> Result<String, String> {
        let document = self.document().ok_or("there is no scene to save")?;
        let text = command::scene_text(&document.scene)?;
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(format!("the scene is in {}", path.display()))
    }

    /// Saves the last picture with title, legend and axes as the command line draws them.
    ///
    /// # Errors
    /// When there is none or it cannot be written.
    pub fn save_picture(&self, path: &std::path::Path) -> Result<String, String> {
        let shown = self.shown.as_ref().ok_or("there is no picture to save")?;
        let picture = &shown.picture;
        picture::write_png(path, picture.size, &picture.rgb).map_err(|e| e.to_string())?;
        Ok(format!("the picture is in {}", path.display()))
    }
}

fn load(ctx: &Context, path: PathBuf) -> Loading {
    let waker = ctx.clone();
    Loading::begin(path, move || waker.request_repaint())
}

fn same_but_size(a: &Scene, b: &Scene) -> bool {
    let with = |s: &Scene| Scene {
        size: [1, 1],
        ..s.clone()
    };
    with(a) == with(b)
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.show(ui, &ctx);
    }
}

impl Window {
    fn show(&mut self, ui: &mut Ui, ctx: &Context) {
        ctx.set_theme(match self.settings.dark {
            true => egui::Theme::Dark,
            false => egui::Theme::Light,
        });
        self.listen(ctx);
        for command in keys::pressed(ctx) {
            self.perform(ctx, command);
        }
        let scene_before = self.document().map(|d| d.scene.clone());
        self.bar(ui, ctx);
        self.status(ui);
        self.body(ui, ctx);
        self.sheets(ctx);
        if scene_before != self.document().map(|d| d.scene.clone()) {
            self.changed = Instant::now();
        }
        self.play(ctx);
        let is_down = ctx.input(|i| i.pointer.any_down());
        if !is_down && let Some(document) = self.document_mut() {
            document.history.end_gesture();
        }
        self.schedule(ctx, is_down);
    }

    fn bar(&mut self, ui: &mut Ui, ctx: &Context) {
        egui::Panel::top("bar").show(ui, |ui| {
            ui.horizontal(|ui| {
                let buttons = [
                    ("Open", Command::Open),
                    ("Reload", Command::Reload),
                    ("Undo", Command::Undo),
                    ("Redo", Command::Redo),
                    ("Frame all", Command::FrameAll),
                    ("Save scene", Command::SaveScene),
                    ("Load scene", Command::LoadScene),
                    ("Picture", Command::Screenshot),
                    ("Copy as command", Command::CopyLine),
                    ("Keys", Command::Help),
                ];
                for (name, command) in buttons {
                    let shortcut = keys::SHORTCUTS.iter().find(|s| s.2 == command);
                    let hint = shortcut.map_or_else(String::new, |(m, k, _, what)| {
                        format!("{what} ({})", keys::text(ctx, *m, *k))
                    });
                    if ui.button(name).on_hover_text(hint).clicked() {
                        self.perform(ctx, command);
                    }
                }
            });
            self.tabs(ui);
        });
    }

    fn tabs(&mut self, ui: &mut Ui) {
        let (mut closes, mut chosen) = (None, None);
        ui.horizontal(|ui| {
            for (n, document) in self.documents.iter().enumerate() {
                if ui
                    .selectable_label(n == self.current, document.title())
                    .clicked()
                {
                    chosen = Some(n);
                }
                if ui.small_button("×").on_hover_text("Close").clicked() {
                    closes = Some(n);
                }
            }
        });
        if let Some(n) = chosen {
            self.show_tab(n);
        }
        if let Some(n) = closes {
            self.documents.remove(n);
            let before = usize::from(n <= self.current);
            self.show_tab(self.current.saturating_sub(before));
        }
    }

    fn status(&mut self, ui: &mut Ui) {
        egui::Panel::bottom("status").show(ui, |ui| {
            let asked = self.document().and_then(|d| panels::player(ui, d));
            if let Some(document) = self.document_mut() {
                match asked {
                    Some(Player::Toggle) => self.change(Command::Play),
                    Some(Player::Move(by)) => document.move_step(by, false),
                    Some(Player::Go(step)) => document.apply(Action::Step(step)),
                    None => {}
                }
            }
            ui.horizontal(|ui| {
                if let Some((text, is_error)) = &self.message {
                    let color = if *is_error {
                        Color32::from_rgb(220, 80, 60)
                    } else {
                        ui.visuals().text_color()
                    };
                    ui.colored_label(color, text);
                }
                let notes = self
                    .document()
                    .and_then(Document::case)
                    .map_or(0, |c| c.about.notes.len());
                if notes > 0
                    && ui
                        .link(format!("{notes} notes on what was not loaded"))
                        .clicked()
                {
                    self.shows_notes = true;
                }
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if let Some((name, _)) = &self.adapter {
                        ui.weak(name);
                    }
                    let state = match (&self.flight, self.progress) {
                        (Some(f), Some(p)) if !f.is_draft => format!("refining {:.0} %", 100.0 * p),
                        (Some(_), _) => "drawing".into(),
                        (None, _) if self.is_final() => "final".into(),
                        (None, _) => String::new(),
                    };
                    ui.label(state);
                });
            });
        });
    }

    fn body(&mut self, ui: &mut Ui, ctx: &Context) {
        let Some(document) = self.documents.get(self.current) else {
            let asked = welcome::show(ui, &self.settings);
            match asked {
                Some(Asked::Open(path)) => self.open(ctx, path),
                Some(Asked::Dialog) => self.perform(ctx, Command::Open),
                None => {}
            }
            return;
        };
        let case = match &document.status {
            Status::Ready(case) => case.clone(),
            Status::Loading(_) => {
                ui.centered_and_justified(|ui| {
                    ui.label(format!("Opening {} ...", document.path.display()))
                });
                return;
            }
            Status::Failed(error) => {
                ui.centered_and_justified(|ui| ui.label(error));
                return;
            }
        };
        let mut actions = Vec::new();
        let mine = self.shown.as_ref().filter(|s| s.document == document.path);
        let about = About {
            case: &case,
            scene: &document.scene,
            picture: mine.map(|s| &s.picture),
            picked: document.picked.as_ref(),
        };
        side(
            ui,
            egui::Panel::left("left"),
            &panels::LEFT,
            &about,
            &mut actions,
        );
        side(
            ui,
            egui::Panel::right("right"),
            &panels::RIGHT,
            &about,
            &mut actions,
        );
        let shown = mine.map(|s| (&s.texture, &s.picture.view));
        let touched = self.viewport.show(ui, &case, &document.scene, shown);
        actions.extend(touched.actions);
        if let (Some(at), Some(mut scene)) = (touched.pick, self.wanted(ctx, 1.0)) {
            scene.size = scene.size.map(|n| n.max(1));
            self.worker.ask(Job::Pick(PickJob {
                case: Arc::clone(&case),
                scene,
                at,
            }));
        }
        if let Some(document) = self.document_mut() {
            for action in actions {
                document.apply(action);
            }
        }
    }

    fn sheets(&mut self, ctx: &Context) {
        egui::Window::new("Keys").open(&mut self.shows_keys).show(ctx, |ui| {
            egui::Grid::new("keys").striped(true).show(ui, |ui| {
                for (modifiers, key, _, what) in keys::SHORTCUTS {
                    ui.label(keys::text(ctx, modifiers, key));
                    ui.label(what);
                    ui.end_row();
                }
            });
            ui.label("Left drag turns, middle or Shift + left drag moves, the wheel zooms to the pointer, a click picks a cell.");
        });
        let notes = self.documents.get(self.current).and_then(Document::case);
        let notes = notes.map_or_else(Vec::new, |c| c.about.notes.clone());
        egui::Window::new("Not loaded")
            .open(&mut self.shows_notes)
            .show(ctx, |ui| {
                for note in notes {
                    ui.label(note);
                }
            });
    }
}

/// Draws the panels of a side, one below the other.
fn side(
    ui: &mut Ui,
    panel: egui::Panel,
    list: &[Panel],
    about: &About<'_>,
    actions: &mut Vec<Action>,
) {
    panel.exact_size(280.0).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            for (title, show) in list {
                egui::CollapsingHeader::new(*title)
                    .default_open(true)
                    .show(ui, |ui| show(ui, about, actions));
            }
        });
    });
}
