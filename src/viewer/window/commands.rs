//! What keys and menus do.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use eframe::egui::Context;

use super::Window;
use super::requests::ReadRequests;
use super::sheets::Sheets;
use crate::case::Case;
use crate::scene::{LightingSpec, Scene};
use crate::viewer::action::{Action, Beside};
use crate::viewer::dialogs::{Dialog, Purpose};
use crate::viewer::document::Document;
use crate::viewer::export::Export;
use crate::viewer::keys::Command;
use crate::viewer::shell_line;
use crate::viewer::state::{Comparison, CurvePlots, State, next_strategy};

/// Closed cases that can be opened again, at most.
const MOST_CLOSED: usize = 10;

impl Window {
    /// Does what a key or a line of a menu says.
    pub(super) fn perform(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::Open => self.ask_file(ctx, Purpose::Case),
            Command::AddFiles if self.document().is_none() => self.fail("open a case first"),
            Command::AddFiles => self.ask_file(ctx, Purpose::Add),
            Command::Close => self.close(self.current),
            Command::Reopen => self.reopen(ctx),
            Command::Reload => self.reload(ctx),
            Command::SaveScene => self.ask_file(ctx, Purpose::SaveScene),
            Command::LoadScene => self.ask_file(ctx, Purpose::LoadScene),
            Command::SaveTable => self.ask_file(ctx, Purpose::SaveTable),
            Command::SaveVectors => self.ask_file(ctx, Purpose::SaveVectors),
            Command::ExportCells => self.export_cells(ctx),
            Command::Screenshot => self.sheets.export = Some(false),
            Command::Film => self.sheets.export = Some(true),
            Command::CopyLine => self.copy_command(ctx),
            Command::Theme => {
                self.settings.dark = !self.settings.dark;
                self.keep_settings();
            }
            Command::Panels => {
                self.settings.hides_panels = !self.settings.hides_panels;
                self.keep_settings();
            }
            Command::Camera(change) => self.move_camera(change),
            Command::Mouse => {
                self.settings.mouse = self.settings.mouse.next();
                self.keep_settings();
                self.tell(format!("mouse as in {}", self.settings.mouse.name()));
            }
            Command::Settings => self.sheets.settings = !self.sheets.settings,
            Command::Help => self.sheets.keys = !self.sheets.keys,
            Command::Notes => self.sheets.notes = !self.sheets.notes,
            Command::Deselect if self.sheets.are_open() => self.sheets = Sheets::default(),
            Command::Case(by) => self.step_case(by),
            Command::Ensemble => self.open_ensemble(ctx),
            Command::Compare => {
                let told = self
                    .document_mut()
                    .and_then(|d| change(d, Command::Compare));
                self.message = told.map(|told| (told, false));
            }
            other => {
                let told = self.document_mut().and_then(|d| change(d, other));
                if let Some(told) = told {
                    self.tell(told);
                }
            }
        }
    }

    /// Closes a tab; it can be opened again as it was.
    pub(super) fn close(&mut self, tab: usize) {
        if tab >= self.documents.len() {
            return;
        }
        let document = self.documents.remove(tab);
        let before = usize::from(tab <= self.current);
        self.current = self.current.saturating_sub(before);
        if let Some(case) = &document.case {
            self.forget(case);
            self.tell(format!(
                "{} is closed; Ctrl+Shift+T opens it again",
                document.title()
            ));
        }
        self.closed.push((document.paths(), document.state));
        if self.closed.len() > MOST_CLOSED {
            self.closed.remove(0);
        }
    }

    /// Opens the case that was closed last, as it was.
    fn reopen(&mut self, ctx: &Context) {
        let Some((paths, state)) = self.closed.pop() else {
            self.tell("no case was closed");
            return;
        };
        let is_open = self.documents.iter().any(|d| d.is_of(&paths));
        self.show_case(ctx, paths);
        if let Some(document) = self.document_mut().filter(|_| !is_open) {
            document.state = state;
        }
    }

    /// Lets go of all that is kept of a case that is closed or was read again.
    pub(super) fn forget(&mut self, case: &Arc<Case>) {
        self.pictures.forget(case);
        self.reader.forget(case);
        self.asked = ReadRequests::default();
    }

    fn copy_command(&mut self, ctx: &Context) {
        let Some(document) = self.document() else {
            return;
        };
        let sizes = self.sides.sizes(ctx.pixels_per_point());
        let setup = &document.state.setup;
        // A difference within the case is a property of it; one of two cases has no name on the command line.
        let case = document.case.as_ref();
        let difference = self.difference_of_values().and_then(Result::ok);
        let difference = difference.filter(|(of, _)| case.is_some_and(|c| Arc::ptr_eq(of, c)));
        let is_first = setup.comparison.is_some() && difference.is_none();
        let scene = difference.map_or_else(|| setup.scene.clone(), |d| d.1);
        let scene = Scene {
            size: sizes[0].unwrap_or(scene.size),
            ..scene
        };
        let program = std::env::current_exe().unwrap_or_else(|_| "strataray".into());
        let line = shell_line::command(&program, &document.paths(), &scene);
        let told = line.map(|line| {
            ctx.copy_text(line);
            match is_first {
                true => "the command for the first image is on the clipboard".to_owned(),
                false => {
                    "the command is on the clipboard; it writes a PNG where it is run".to_owned()
                }
            }
        });
        self.answer(told);
    }

    /// Asks for a file.
    pub(super) fn ask_file(&mut self, ctx: &Context, purpose: Purpose) {
        self.dialog = Some(Dialog::begin(ctx, purpose));
    }

    /// Does what a file was asked for.
    pub(super) fn choose(&mut self, ctx: &Context, purpose: Purpose, mut paths: Vec<PathBuf>) {
        match purpose {
            Purpose::Case => return self.open(ctx, paths),
            Purpose::Add => return self.add(ctx, paths),
            _ => {}
        }
        let Some(path) = paths.pop().map(|path| purpose.file(path)) else {
            return;
        };
        let told = match purpose {
            Purpose::Case | Purpose::Add => return,
            Purpose::Export(spec) => {
                let waker = ctx.clone();
                self.export = Some(Export::begin(*spec, path, move || waker.request_repaint()));
                return;
            }
            Purpose::LoadScene => self.load_scene(&path),
            Purpose::SaveScene => self.save_scene(&path),
            Purpose::SaveTable => self.save_table(&path),
            Purpose::SaveVectors => self.save_vectors(&path),
        };
        self.answer(told);
    }
}

/// Commands that concern a document alone; what to tell of them.
fn change(document: &mut Document, command: Command) -> Option<String> {
    document.history.end_gesture();
    match command {
        Command::Undo => {
            let undone = document.history.undo(&mut document.state);
            return Some(undone.map_or("nothing to undo".into(), |n| format!("undone: {n}")));
        }
        Command::Redo => {
            let redone = document.history.redo(&mut document.state);
            return Some(redone.map_or("nothing to redo".into(), |n| format!("redone: {n}")));
        }
        Command::Play => {
            document.playing = match document.playing {
                Some(_) => None,
                None => Some(Instant::now()),
            };
        }
        Command::Step(by) => document.move_step(by, false),
        Command::End(last) => {
            document.move_step(if last { isize::MAX / 2 } else { isize::MIN / 2 }, false);
        }
        Command::Slice(by) => {
            let dims = document.case.as_ref()?.grid.main_dims();
            let State { setup, slicing, .. } = &document.state;
            let (slicing, filter) = (*slicing, slicing.stepped(&setup.scene.filter, dims, by));
            let told = slicing.words(&filter, dims);
            document.apply(Action::Filter(filter));
            return Some(told);
        }
        Command::SliceAxis(by) => {
            let dims = document.case.as_ref()?.grid.main_dims();
            let State { setup, slicing, .. } = &document.state;
            let axis = (slicing.axis as isize + by).rem_euclid(3) as usize;
            let (slicing, filter) = slicing.along(axis, &setup.scene.filter, dims);
            let told = format!("slices along {}", slicing.words(&filter, dims));
            document.apply(Action::Slicing(slicing));
            document.apply(Action::Filter(filter));
            return Some(told);
        }
        Command::Mode => {
            let mode = document.state.setup.scene.mode;
            document.apply(Action::Mode(mode.other()));
        }
        Command::Space => {
            let space = document.state.setup.scene.space;
            document.apply(Action::Space(space.other()));
        }
        Command::NextStrategy => {
            let next = next_strategy(document.state.setup.scene.strategy);
            document.apply(Action::Strategy(next));
            return Some(next.describe().to_owned());
        }
        Command::Light => {
            let is_off = document.state.setup.scene.lighting == LightingSpec::default();
            let soft = LightingSpec::preset("soft").filter(|_| is_off);
            document.apply(Action::Lighting(soft.unwrap_or_default()));
        }
        Command::Compare => return compare(document),
        Command::Curves => {
            let curves = &document.state.curves;
            document.apply(Action::Curves(CurvePlots {
                is_open: !curves.is_open,
                ..curves.clone()
            }));
        }
        Command::Deselect => document.apply(Action::Deselect),
        Command::AlongRay(by) => match document.along_ray(by) {
            Some(cell) => document.apply(Action::Select(cell, Beside::AllButLast)),
            None => return Some(no_more(document, by)),
        },
        _ => {}
    }
    None
}

/// Opens a second picture, or closes it.
fn compare(document: &mut Document) -> Option<String> {
    let setup = &document.state.setup;
    let next = match (&setup.comparison, &document.case) {
        (None, Some(case)) => Some(Comparison::opening(case, &setup.scene)),
        _ => None,
    };
    let told = next
        .is_some()
        .then(|| "more steps, properties, cases and strategies are in the Compare panel".into());
    document.apply(Action::Compare(next));
    told
}

/// Why there is no cell to step to along the line of sight.
fn no_more(document: &Document, by: isize) -> String {
    match (document.along_ray(0), by < 0) {
        (None, _) => "click a cell first; then , and . step along the line of sight",
        (Some(_), true) => "no cell lies in front of this one",
        (Some(_), false) => "no cell lies behind this one",
    }
    .into()
}
