//! What happened since the last frame: answers of threads, files that changed, what was dropped.

use std::path::PathBuf;

use eframe::egui::Context;

use super::{Window, begin_loading};
use crate::picking::Pick;
use crate::view::wells::Head;
use crate::viewer::action::{Action, Beside};
use crate::viewer::dialogs::{Dialog, Outcome, PathSheet};
use crate::viewer::export::Export;
use crate::viewer::job::PickPurpose;
use crate::viewer::pictures::Event;
use crate::viewer::reader::Read;
use crate::viewer::watch::{Change, Watch};

impl Window {
    /// Takes in what happened since the last frame.
    pub(super) fn listen(&mut self, ctx: &Context) {
        for event in self.pictures.listen(ctx) {
            match event {
                Event::Came => {
                    if self.message.as_ref().is_some_and(|m| m.1) {
                        self.message = None;
                    }
                }
                Event::Failed(error) => self.fail(error),
                Event::Picked(why, pick) => self.picked(why, *pick),
            }
        }
        self.listen_to_files(ctx);
        for read in self.reader.poll() {
            self.take(read);
        }
        let dropped = ctx.input(|i| i.raw.dropped_files.clone());
        if !dropped.is_empty() {
            self.open(ctx, dropped.iter().map(|f| f.path().to_owned()).collect());
        }
        if let Some(outcome) = self.dialog.as_ref().and_then(Dialog::poll) {
            self.dialog = None;
            match outcome {
                Outcome::Chosen(purpose, paths) => self.choose(ctx, purpose, paths),
                Outcome::Left => {}
                Outcome::NoDialog(purpose) => self.sheets.path = Some(PathSheet::new(purpose)),
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
            Read::Vectors(vectors) => &vectors.case,
            Read::Wells(wells) => &wells.case,
            Read::Look(case, ..) => case,
            Read::Spread(spread) => &spread.case,
        };
        let case = case.clone();
        let awaited = self.awaited.clone();
        let mut is_here = false;
        match (self.document_of(&case), read) {
            (Some(document), Read::Table(table)) => document.table = Some(table),
            (Some(document), Read::Curves(curves)) => document.curves = Some(curves),
            (Some(document), Read::Vectors(vectors)) => document.vectors = Some(vectors),
            (Some(document), Read::Wells(wells)) => document.take_wells(wells),
            (Some(document), Read::Spread(spread)) => document.spreads.push(spread),
            (Some(document), Read::Look(_, property, look)) => {
                document
                    .state
                    .setup
                    .looks
                    .entry(property.clone())
                    .or_insert(look);
                if awaited.as_ref() == Some(&property) {
                    is_here = true;
                    document.apply(Action::Property(property));
                }
            }
            (None, _) => {}
        }
        if is_here {
            self.awaited = None;
        }
    }

    /// Cases that came, and files that changed.
    fn listen_to_files(&mut self, ctx: &Context) {
        let (mut opened, mut replaced) = (Vec::new(), Vec::new());
        let mut gone = None;
        let mut has_grown = false;
        for document in &mut self.documents {
            let before = document.case.clone();
            if document.listen() {
                replaced.extend(before);
                opened.push(document.path.clone());
                if self.watches
                    && let Some(case) = &document.case
                {
                    let watch = |files: &[PathBuf]| {
                        let waker = ctx.clone();
                        Watch::begin(files.to_vec(), move || waker.request_repaint())
                    };
                    document.watch = Some(watch(&case.about.files));
                    let summary = &case.about.summary;
                    document.summary_watch = (!summary.is_empty()).then(|| watch(summary));
                }
            }
            match document.watch.as_ref().and_then(Watch::poll) {
                Some(Change::Written) => {
                    let paths = document.paths();
                    document.loading = Some(begin_loading(ctx, paths, None, &self.grids));
                }
                Some(Change::Gone) => gone = Some(document.title()),
                None => {}
            }
            let summary = document.summary_watch.as_ref().and_then(Watch::poll);
            has_grown |= summary == Some(Change::Written);
        }
        if has_grown {
            self.asked.forget_vectors();
        }
        if let Some(name) = gone {
            self.fail(format!(
                "a file of {name} was removed; what was read stays, and F5 reloads the case"
            ));
        }
        for case in replaced {
            self.forget(&case);
        }
        if opened.is_empty() {
            return;
        }
        for path in opened {
            self.settings.remember(&path);
        }
        self.keep_settings();
    }

    /// Selects a well that was clicked in the picture.
    fn select_well(&mut self, head: &Head) {
        let well = self.document().and_then(|document| {
            let mut wells = document.wells.as_ref()?.wells.iter();
            let well = wells.find(|well| well.name == head.name)?;
            let cells = well.finest_cells(&document.case.as_ref()?.grid);
            Some(cells.map(|cell| cell.one_based()).collect())
        });
        self.apply(Action::Well(head.name.clone(), well.unwrap_or_default()));
        self.tell(head.in_words());
    }

    fn picked(&mut self, why: PickPurpose, pick: Pick) {
        if why == PickPurpose::Hover {
            let is_seen = pick.hit.is_some() || pick.fault.is_some() || pick.well.is_some();
            self.sides.hover = is_seen.then_some(pick);
            return;
        }
        let Some(hit) = &pick.hit else {
            match pick.well {
                Some(well) => self.select_well(&well),
                None => self.tell("no cell under the pointer"),
            }
            return;
        };
        let cell = hit.ijk.one_based();
        let beside = match why {
            PickPurpose::AddToSelection => Beside::Others,
            _ => Beside::Nothing,
        };
        if let Some(document) = self.document_mut() {
            document.pick = Some(pick);
            document.apply(Action::Select(cell, beside));
        }
    }
}
