//! The window: what it keeps, and what happens in each frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, Context, Ui};

use super::action::{Action, Beside};
use super::dialogs::Dialog;
use super::document::Document;
use super::export::Export;
use super::keys;
use super::loading::Loading;
use super::pictures::{Event, Pictures};
use super::reader::{Cells, Read, Reader};
use super::settings::Settings;
use super::sheets::Sheets;
use super::sides::Sides;
use super::state::{Setup, State};
use super::watch::{Change, Watch};
use super::worker::{Difference, Picture, Wanted, Why};
use super::{bar, command, panels};
use crate::case::Case;
use crate::picking::Hit;
use crate::scene::{LightingSpec, Scene};
use crate::strategies::StrategyKind;

/// The window's state.
pub struct Window {
    pub(super) documents: Vec<Document>,
    pub(super) current: usize,
    pub(super) pictures: Pictures,
    pub(super) reader: Reader,
    pub(super) sides: Sides,
    pub(super) settings: Settings,
    pub(super) sheets: Sheets,
    pub(super) dialog: Option<Dialog>,
    pub(super) export: Option<Export>,
    /// What to tell the user, and whether it is an error.
    pub(super) message: Option<(String, bool)>,
    /// Cases opened from now on are read again when their files change.
    watches: bool,
    /// The property that is to be shown once it is known how it looks.
    awaited: Option<String>,
    /// What the reader was asked for last.
    asked: Asked,
    /// The size of letters that is remembered has been set.
    is_zoomed: bool,
}

/// What the reader was asked for last.
#[derive(Default, PartialEq)]
struct Asked {
    table: Option<(Cells, usize)>,
    curves: Option<(Cells, String)>,
    ahead: Option<(usize, Vec<(String, usize)>)>,
    look: Option<String>,
}

/// Steps that are read ahead.
const AHEAD: usize = 3;

impl Window {
    /// The window on some cases; where it `watches`, it follows their files.
    pub fn new(ctx: &Context, cases: Vec<PathBuf>, watches: bool, settings: Settings) -> Self {
        let waker = ctx.clone();
        let mut window = Self {
            documents: Vec::new(),
            current: 0,
            pictures: Pictures::new(ctx),
            reader: Reader::start(move || waker.request_repaint()),
            sides: Sides::default(),
            settings,
            sheets: Sheets::default(),
            dialog: None,
            export: None,
            message: None,
            watches,
            awaited: None,
            asked: Asked::default(),
            is_zoomed: false,
        };
        for case in cases {
            window.open(ctx, case);
        }
        window
    }

    /// Opens a case in a tab of its own, or brings the tab to the front that has it.
    pub fn open(&mut self, ctx: &Context, path: PathBuf) {
        if let Some(tab) = self.documents.iter().position(|d| d.path == path) {
            self.current = tab;
            return;
        }
        let state = State {
            setup: Setup {
                scene: self.first_scene(),
                ..Setup::default()
            },
            pace: self.settings.pace,
            ..State::default()
        };
        let loading = load(ctx, path.clone());
        self.documents.push(Document::new(path, loading, state));
        self.current = self.documents.len() - 1;
    }

    /// Reads the case in front again; it stays as it is until then.
    pub fn reload(&mut self, ctx: &Context) {
        if let Some(document) = self.document_mut() {
            document.loading = Some(load(ctx, document.path.clone()));
        }
    }

    /// The document in front.
    pub fn document(&self) -> Option<&Document> {
        self.documents.get(self.current)
    }

    /// The document in front, to change it.
    pub fn document_mut(&mut self) -> Option<&mut Document> {
        self.documents.get_mut(self.current)
    }

    /// Makes a change of the document in front. A property that was never shown comes once it is known how
    /// it looks.
    pub fn apply(&mut self, action: Action) {
        let Some(document) = self.documents.get_mut(self.current) else {
            return;
        };
        match (&action, &document.case) {
            (Action::Property(property), Some(case)) if document.lacks_look(property) => {
                self.reader.look(case.clone(), property.clone());
                self.awaited = Some(property.clone());
            }
            _ => document.apply(action),
        }
    }

    /// What is told at the bottom, and whether it is an error.
    pub fn message(&self) -> Option<(&str, bool)> {
        self.message.as_ref().map(|(m, e)| (m.as_str(), *e))
    }

    /// The picture of a side that is shown, and whether all that is asked for is.
    pub fn picture(&self, side: usize) -> Option<(&Picture, bool)> {
        let case = match side {
            0 => self.document()?.case.clone()?,
            _ => self.other_case()?,
        };
        let shown = self.pictures.shown(side, &case)?;
        let is_final = self.awaited.is_none() && self.pictures.are_final();
        Some((&shown.picture, is_final))
    }

    /// How far the two pictures shown are apart, once that is known.
    pub fn difference(&self) -> Option<&Difference> {
        self.pictures.difference().map(|d| &d.difference)
    }

    /// How a case is shown at first.
    fn first_scene(&self) -> Scene {
        let is_software = self.pictures.adapter.as_ref().is_none_or(|a| a.1);
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

    pub(super) fn tell(&mut self, text: impl Into<String>) {
        self.message = Some((text.into(), false));
    }

    pub(super) fn fail(&mut self, text: impl Into<String>) {
        self.message = Some((text.into(), true));
    }

    pub(super) fn answer(&mut self, result: Result<String, String>) {
        match result {
            Ok(text) => self.tell(text),
            Err(error) => self.fail(error),
        }
    }

    pub(super) fn keep_settings(&mut self) {
        if let Err(error) = self.settings.save() {
            self.fail(error);
        }
    }

    /// Takes in what happened since the last frame.
    fn listen(&mut self, ctx: &Context) {
        for event in self.pictures.listen(ctx) {
            match event {
                Event::Came => {
                    if self.message.as_ref().is_some_and(|m| m.1) {
                        self.message = None;
                    }
                }
                Event::Failed(error) => self.fail(error),
                Event::Picked(why, hit) => self.picked(why, hit),
            }
        }
        self.listen_to_files(ctx);
        for read in self.reader.poll() {
            self.take(read);
        }
        let dropped = ctx.input(|i| i.raw.dropped_files.clone());
        for path in dropped.iter().map(|f| f.path().to_owned()) {
            self.open(ctx, path);
        }
        if let Some(chosen) = self.dialog.as_ref().and_then(Dialog::poll) {
            self.dialog = None;
            if let Some(chosen) = chosen {
                self.choose(ctx, chosen);
            }
        }
        if let Some(done) = self.export.as_ref().and_then(Export::poll) {
            self.export = None;
            self.answer(done);
        }
    }

    /// Gives a document what was read for it, if it is still there.
    fn take(&mut self, read: Read) {
        let case = match &read {
            Read::Table(table) => &table.of.case,
            Read::Curves(curves) => &curves.of.case,
            Read::Look(case, ..) => case,
        };
        let is_of = |d: &&mut Document| d.case.as_ref().is_some_and(|c| Arc::ptr_eq(c, case));
        let document = self.documents.iter_mut().find(is_of);
        match (document, read) {
            (Some(document), Read::Table(table)) => document.table = Some(table),
            (Some(document), Read::Curves(curves)) => document.curves = Some(curves),
            (Some(document), Read::Look(_, property, look)) => {
                document
                    .state
                    .setup
                    .looks
                    .entry(property.clone())
                    .or_insert(look);
                if self.awaited.as_ref() == Some(&property) {
                    self.awaited = None;
                    document.apply(Action::Property(property));
                }
            }
            (None, _) => {}
        }
    }

    /// Cases that came, and files that changed.
    fn listen_to_files(&mut self, ctx: &Context) {
        let mut opened = Vec::new();
        let mut gone = None;
        for document in &mut self.documents {
            if document.listen() {
                opened.push(document.path.clone());
                if self.watches
                    && let Some(case) = &document.case
                {
                    let waker = ctx.clone();
                    let files = case.about.files.clone();
                    document.watch = Some(Watch::begin(files, move || waker.request_repaint()));
                }
            }
            match document.watch.as_ref().and_then(Watch::poll) {
                Some(Change::Written) => document.loading = Some(load(ctx, document.path.clone())),
                Some(Change::Gone) => gone = Some(document.title()),
                None => {}
            }
        }
        if let Some(name) = gone {
            self.fail(format!(
                "a file of {name} is gone; what was read of it stays, and F5 reads it again"
            ));
        }
        if opened.is_empty() {
            return;
        }
        for path in opened {
            self.settings.remember(&path);
        }
        self.keep_settings();
    }

    fn picked(&mut self, why: Why, hit: Option<Hit>) {
        if why == Why::Hover {
            self.sides.hover = hit;
            return;
        }
        let Some(hit) = hit else {
            self.tell("nothing is drawn there");
            return;
        };
        let cell = [hit.ijk.i, hit.ijk.j, hit.ijk.k].map(|n| n + 1);
        let beside = match why {
            Why::Join => Beside::Others,
            _ => Beside::Nothing,
        };
        if let Some(document) = self.document_mut() {
            document.hit = Some(hit);
            document.apply(Action::Select(cell, beside));
        }
    }

    /// The case that the second picture is of.
    pub(super) fn other_case(&self) -> Option<Arc<Case>> {
        let document = self.document()?;
        let comparison = document.state.setup.comparison.as_ref()?;
        match &comparison.case {
            Some(path) => {
                let other = self.documents.iter().find(|d| d.path == *path);
                other.and_then(|d| d.case.clone())
            }
            None => document.case.clone(),
        }
    }

    /// What is to be shown, a scene for each side in the size of its place.
    fn wanted(&self, ctx: &Context) -> Vec<Wanted> {
        let Some(document) = self.document() else {
            return Vec::new();
        };
        let Some(case) = document.case.clone() else {
            return Vec::new();
        };
        let setup = &document.state.setup;
        let sizes = self.sides.sizes(ctx.pixels_per_point());
        let mut wanted = Vec::new();
        if let Some(size) = sizes[0] {
            let scene = Scene {
                size,
                ..setup.scene.clone()
            };
            wanted.push(Wanted { case, scene });
        }
        if let (Some(comparison), Some(size), Some(case)) =
            (&setup.comparison, sizes[1], self.other_case())
        {
            let scene = match comparison.case {
                Some(_) => setup.compared(&self.linked(&setup.scene)),
                None => setup.compared(&setup.scene),
            };
            wanted.extend(scene.map(|scene| Wanted {
                case,
                scene: Scene { size, ..scene },
            }));
        }
        wanted
    }

    /// The scene with camera and exaggeration of the first picture, which may depend on its case.
    fn linked(&self, scene: &Scene) -> Scene {
        let Some((picture, _)) = self.picture(0) else {
            return scene.clone();
        };
        let size = picture.view.size;
        let camera = picture.view.seen_from(&scene.camera, size);
        Scene {
            camera: camera.map_or_else(
                |_| scene.camera.clone(),
                |v| super::orbit::spec(&v.camera, &v.box_corners),
            ),
            vertical_exaggeration: scene
                .vertical_exaggeration
                .or(Some(picture.view.vertical_exaggeration)),
            ..scene.clone()
        }
    }

    /// Asks for the values that panels show, and for those of the next steps.
    fn read(&mut self) {
        let Some(document) = self.documents.get_mut(self.current) else {
            return;
        };
        let Some(case) = document.case.clone() else {
            return;
        };
        let step = document.step().map_or(0, |(step, _)| step);
        let shown = self.pictures.shown(0, &case);
        let Some(property) = shown.map(|s| s.picture.view.property.clone()) else {
            return;
        };
        let cells = document.state.selected.clone();
        let mut asked = Asked::default();
        if cells.is_empty() {
            (document.table, document.curves) = (None, None);
        } else {
            let of = Cells {
                case: case.clone(),
                cells,
            };
            asked.table = Some((of.clone(), step));
            asked.curves = Some((of, property.clone()));
        }
        let filters = document.state.setup.scene.filter.properties.iter();
        let names: Vec<String> = filters.map(|f| f.name.clone()).chain([property]).collect();
        let next = (step + 1..case.steps.len()).take(AHEAD);
        let next = next.flat_map(|s| names.iter().map(move |n| (n.clone(), s)));
        let compared = document.state.setup.comparison.as_ref();
        asked.look = compared
            .and_then(|c| c.property.clone())
            .filter(|p| document.lacks_look(p));
        asked.ahead = Some((Arc::as_ptr(&case).addr(), next.collect()));
        if asked.table != self.asked.table
            && let Some((of, step)) = &asked.table
        {
            self.reader.table(of.clone(), *step);
        }
        if asked.curves != self.asked.curves
            && let Some((of, property)) = &asked.curves
        {
            self.reader.curves(of.clone(), property.clone());
        }
        if asked.look != self.asked.look
            && let Some(property) = &asked.look
        {
            self.reader.look(case.clone(), property.clone());
        }
        if asked.ahead != self.asked.ahead
            && let Some((_, fields)) = &asked.ahead
        {
            self.reader.ahead(case, fields.clone());
        }
        self.asked = asked;
    }

    /// Remembers the size of letters and the pace of time as they were chosen last.
    fn remember(&mut self, ctx: &Context) {
        if !self.is_zoomed {
            self.is_zoomed = true;
            ctx.set_zoom_factor(self.settings.zoom.clamp(0.3, 4.0));
            return;
        }
        let pace = self.document().map_or(self.settings.pace, |d| d.state.pace);
        let chosen = (ctx.zoom_factor(), pace);
        if chosen != (self.settings.zoom, self.settings.pace) {
            (self.settings.zoom, self.settings.pace) = chosen;
            self.keep_settings();
        }
    }

    /// Goes to the next step where time plays and the picture of this one is there.
    fn play(&mut self, ctx: &Context) {
        let has_picture = self.pictures.on_its_way().is_none();
        let Some(document) = self.document_mut() else {
            return;
        };
        let Some(since) = document.playing else {
            return;
        };
        let pace = document.state.pace;
        let waits = Duration::from_secs_f64(1.0 / pace.steps_a_second.max(0.01));
        let waits = waits.saturating_sub(since.elapsed());
        if waits.is_zero() && has_picture {
            let is_last = document
                .step()
                .is_none_or(|(step, count)| step + 1 == count);
            if is_last && !pace.repeats {
                document.playing = None;
                return;
            }
            document.playing = Some(Instant::now());
            document.move_step(1, true);
        }
        ctx.request_repaint_after(waits.max(Duration::from_millis(10)));
    }

    /// Loads a scene into the document in front.
    ///
    /// # Errors
    /// When the file is no scene; the sentence names it.
    pub fn load_scene(&mut self, path: &Path) -> Result<String, String> {
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
    pub fn save_scene(&self, path: &Path) -> Result<String, String> {
        let document = self.document().ok_or("there is no scene to save")?;
        let text = command::scene_text(&document.state.setup.scene)?;
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(format!("the scene is in {}", path.display()))
    }

    /// Saves the values of the selected cells, and their curves, as comma-separated text.
    ///
    /// # Errors
    /// When none is selected, or the file cannot be written; the sentence names it.
    pub fn save_table(&self, path: &Path) -> Result<String, String> {
        let document = self.document().ok_or("open a case first")?;
        let table = document.table.as_ref().ok_or("select a cell first")?;
        let text = panels::csv(table, document.curves.as_ref());
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(format!("the values are in {}", path.display()))
    }

    /// A frame.
    fn show(&mut self, ui: &mut Ui, ctx: &Context) {
        ctx.set_theme(match self.settings.dark {
            true => egui::Theme::Dark,
            false => egui::Theme::Light,
        });
        self.remember(ctx);
        self.listen(ctx);
        for command in keys::pressed(ctx) {
            self.perform(ctx, command);
        }
        bar::top(self, ui, ctx);
        bar::bottom(self, ui, ctx);
        self.body(ui, ctx);
        self.show_sheets(ctx);
        self.play(ctx);
        self.read();
        let is_down = ctx.input(|i| i.pointer.any_down());
        let scrolls =
            ctx.input(|i| i.smooth_scroll_delta != egui::Vec2::ZERO || i.zoom_delta() != 1.0);
        if !is_down
            && !scrolls
            && let Some(document) = self.document_mut()
        {
            document.history.end_gesture();
        }
        let plays = self.document().is_some_and(|d| d.playing.is_some());
        let wanted = self.wanted(ctx);
        self.pictures.schedule(ctx, wanted, is_down, plays);
    }
}

fn load(ctx: &Context, path: PathBuf) -> Loading {
    let waker = ctx.clone();
    Loading::begin(path, move || waker.request_repaint())
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.show(ui, &ctx);
    }
}
