//! The window: what it keeps, and what happens in each frame.

mod bar;
mod camera;
mod cases;
mod commands;
mod difference;
mod docks;
mod events;
mod persistence;
mod requests;
mod sheets;
mod sides;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, Context, Ui};

use super::action::Action;
use super::cases::{Meaning, meaning};
use super::dialogs::{CasesSheet, Dialog};
use super::document::Document;
use super::export::Export;
use super::job::{ImageDifference, Picture};
use super::keys;
use super::loading::Loading;
use super::pictures::{DraftCount, Pictures};
use super::reader::Reader;
use super::settings::Settings;
use super::state::{CurvePlots, State};
use crate::case::GridPool;
use crate::case::load::{self, CasePaths};
use crate::picking::Pick;
use difference::CaseDifference;
use docks::Docks;
use requests::ReadRequests;
use sheets::Sheets;
use sides::Sides;

/// The window's state.
pub struct Window {
    documents: Vec<Document>,
    current: usize,
    /// Cases that were closed, and how they looked; the last one is at the end.
    closed: Vec<(CasePaths, State)>,
    pictures: Pictures,
    reader: Reader,
    sides: Sides,
    docks: Docks,
    settings: Settings,
    sheets: Sheets,
    dialog: Option<Dialog>,
    export: Option<Export>,
    /// What to tell the user, and whether it is an error.
    message: Option<(String, bool)>,
    /// Cases opened from now on are read again when their files change.
    watches: bool,
    /// The property that is to be shown once it is known how it looks.
    awaited: Option<String>,
    /// What the reader was asked for last.
    asked: ReadRequests,
    /// The grids of the cases that are open, equal ones once.
    grids: Arc<GridPool>,
    /// The difference of two cases that was asked for last.
    case_difference: Option<CaseDifference>,
    /// The size of letters that is remembered has been set.
    is_zoomed: bool,
}

impl Window {
    /// The window on some cases; where it `watches`, it follows their files.
    pub fn new(ctx: &Context, cases: Vec<PathBuf>, watches: bool, settings: Settings) -> Self {
        let (waker, reader_waker) = (ctx.clone(), ctx.clone());
        let message = settings.problem.clone().map(|problem| (problem, true));
        let mut window = Self {
            documents: Vec::new(),
            current: 0,
            closed: Vec::new(),
            pictures: Pictures::new(move || waker.request_repaint()),
            reader: Reader::start(move || reader_waker.request_repaint()),
            sides: Sides::default(),
            docks: Docks::default(),
            settings,
            sheets: Sheets::default(),
            dialog: None,
            export: None,
            message,
            watches,
            awaited: None,
            asked: ReadRequests::default(),
            grids: Arc::default(),
            case_difference: None,
            is_zoomed: false,
        };
        window.open(ctx, cases);
        window
    }

    /// Opens what was named, dropped or chosen together. Of a folder with several cases the user chooses. Files
    /// without a grid are added to the case that they were named with, or to the one in front.
    pub fn open(&mut self, ctx: &Context, paths: Vec<PathBuf>) {
        let mut files = Vec::new();
        for path in paths {
            match meaning(&path) {
                Meaning::Case(case) if path.is_dir() => files.push(case),
                Meaning::Several(cases) => self.sheets.cases = Some(CasesSheet::new(cases)),
                // What is no case says why when it is read.
                Meaning::Case(_) | Meaning::Nothing(_) => files.push(path),
            }
        }
        let are_added = |file: &PathBuf| file.is_file() && !load::is_case(file);
        let has_case = self.document().is_some_and(|d| d.case.is_some());
        if has_case && !files.is_empty() && files.iter().all(are_added) {
            self.add(ctx, files);
            return;
        }
        // What is not there says so in a tab of its own, and keeps no other case from opening.
        let (there, missing): (Vec<_>, Vec<_>) =
            files.into_iter().partition(|file| load::is_there(file));
        let missing = missing.into_iter().map(CasePaths::of);
        for paths in load::group(&there).into_iter().chain(missing) {
            self.show_case(ctx, paths);
        }
    }

    /// Adds files to the case in front, which is read again with them.
    pub(super) fn add(&mut self, ctx: &Context, files: Vec<PathBuf>) {
        let Some(document) = self.document_mut() else {
            return;
        };
        let names: Vec<_> = files.iter().filter_map(|f| f.file_name()).collect();
        let names: Vec<_> = names.iter().map(|n| n.to_string_lossy()).collect();
        let told = format!("{} is added to {}", names.join(", "), document.title());
        document.with.retain(|known| !files.contains(known));
        document.with.extend(files);
        self.tell(told);
        self.reload(ctx);
    }

    /// Opens a case in a tab of its own, or brings the tab to the front that has it.
    pub(super) fn show_case(&mut self, ctx: &Context, paths: CasePaths) {
        let tab = self.documents.iter().position(|d| d.is_of(&paths));
        if let Some(tab) = tab {
            self.current = tab;
            // The same case with other files is read again with all of them.
            let new = |file: &&PathBuf| !self.documents[tab].with.contains(file);
            let added: Vec<PathBuf> = paths.with.iter().filter(new).cloned().collect();
            if !added.is_empty() {
                self.add(ctx, added);
            }
            return;
        }
        let state = State {
            pace: self.settings.pace,
            ..State::default()
        };
        let loading = self.load(ctx, paths.clone());
        self.documents.push(Document::new(paths, loading, state));
        self.current = self.documents.len() - 1;
    }

    /// Begins to open a case.
    fn load(&self, ctx: &Context, paths: CasePaths) -> Loading {
        begin_loading(
            ctx,
            paths,
            self.settings.first_property.clone(),
            &self.grids,
        )
    }

    /// Reads the case in front again; it stays as it is until then.
    pub fn reload(&mut self, ctx: &Context) {
        let Some(paths) = self.document().map(Document::paths) else {
            return;
        };
        let loading = self.load(ctx, paths);
        if let Some(document) = self.document_mut() {
            document.loading = Some(loading);
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
        let held = match action {
            Action::Filter(_) => self.held_camera(),
            _ => None,
        };
        let Some(document) = self.documents.get_mut(self.current) else {
            return;
        };
        match (&action, &document.case) {
            (Action::Property(property), Some(case)) if document.lacks_look(property) => {
                self.reader.look(case.clone(), property.clone());
                self.awaited = Some(property.clone());
            }
            (Action::Filter(_), _) => document.apply_filter(action, held),
            (Action::Well(..), Some(case)) => {
                let opens = !case.about.summary.is_empty();
                document.apply(action);
                let curves = document.state.curves.clone();
                document.apply(Action::Curves(CurvePlots {
                    is_open: opens || curves.is_open,
                    ..curves
                }));
            }
            _ => document.apply(action),
        }
        // What was told of an earlier change is of no interest anymore.
        self.message = self.message.take().filter(|m| m.1);
    }

    /// What is told at the bottom, and whether it is an error.
    pub fn message(&self) -> Option<(&str, bool)> {
        self.message.as_ref().map(|(m, e)| (m.as_str(), *e))
    }

    /// The picture of a side that is shown, and whether all that is asked for is.
    pub fn picture(&self, side: usize) -> Option<(&Picture, bool)> {
        let case = match side {
            0 => self.subject()?.0,
            _ => self.other_case()?,
        };
        let shown = self.pictures.shown(side, &case)?;
        let is_awaited = self.awaited.is_some() || self.awaits_difference();
        let is_final = !is_awaited && self.pictures.are_final();
        Some((&shown.picture, is_final))
    }

    /// How many drafts were asked for, and came.
    pub fn drafts(&self) -> DraftCount {
        self.pictures.drafts
    }

    /// What is seen where the pointer rests.
    pub fn hovered(&self) -> Option<&Pick> {
        self.sides.hover.as_ref()
    }

    /// How far the two pictures shown are apart, once that is known.
    pub fn difference(&self) -> Option<&ImageDifference> {
        self.pictures.difference().map(|d| &d.difference)
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
        let waits = Duration::from_secs_f64(1.0 / pace.steps_per_second.max(0.01));
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

    /// A frame.
    fn show(&mut self, ui: &mut Ui, ctx: &Context) {
        ctx.set_theme(match self.settings.dark {
            true => egui::Theme::Dark,
            false => egui::Theme::Light,
        });
        self.remember(ctx);
        self.listen(ctx);
        self.subtract_cases();
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

/// Begins to open a case, with a property in front where the case has it.
pub(super) fn begin_loading(
    ctx: &Context,
    paths: CasePaths,
    property: Option<String>,
    grids: &Arc<GridPool>,
) -> Loading {
    let waker = ctx.clone();
    Loading::begin(paths, property, grids.clone(), move || {
        waker.request_repaint();
    })
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.show(ui, &ctx);
    }
}
