//! What keys and menus do.

use std::time::Instant;

use eframe::egui::Context;

use super::action::Action;
use super::command;
use super::dialogs::{Chosen, Dialog};
use super::document::Document;
use super::export::Export;
use super::keys::Command;
use super::settings::Mouse;
use super::state::{Comparison, next_strategy};
use super::window::Window;
use crate::scene::LightingSpec;

impl Window {
    /// Does what a key or a line of a menu says.
    pub(super) fn perform(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::Open => self.dialog = Some(Dialog::open(ctx, Chosen::Case)),
            Command::Close => self.close(self.current),
            Command::Reload => self.reload(ctx),
            Command::SaveScene => {
                self.dialog = Some(Dialog::save(ctx, "scene.json", Chosen::SaveScene));
            }
            Command::LoadScene => self.dialog = Some(Dialog::open(ctx, Chosen::LoadScene)),
            Command::SaveTable => {
                self.dialog = Some(Dialog::save(ctx, "cells.csv", Chosen::SaveTable));
            }
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
            Command::Look(look) => self.look(look),
            Command::Mouse => {
                self.settings.mouse = self.settings.mouse.next();
                self.keep_settings();
                self.tell(match self.settings.mouse {
                    Mouse::Standard => "left drag turns, middle moves, right zooms",
                    Mouse::Rms => "left drag zooms, middle turns, right moves",
                });
            }
            Command::Help => self.sheets.keys = !self.sheets.keys,
            Command::Notes => self.sheets.notes = !self.sheets.notes,
            other => {
                let told = self.document_mut().and_then(|d| change(d, other));
                if let Some(told) = told {
                    self.tell(told);
                }
            }
        }
    }

    /// Closes a tab.
    pub(super) fn close(&mut self, tab: usize) {
        if tab < self.documents.len() {
            self.documents.remove(tab);
            let before = usize::from(tab <= self.current);
            self.current = self.current.saturating_sub(before);
        }
    }

    fn copy_command(&mut self, ctx: &Context) {
        let Some(document) = self.document() else {
            return;
        };
        let line = command::command(&document.path, &document.state.setup.scene);
        let told = line.map(|line| {
            ctx.copy_text(line);
            "the command line is in the clipboard".to_owned()
        });
        self.answer(told);
    }

    /// Does what a dialog was for.
    pub(super) fn choose(&mut self, ctx: &Context, chosen: Chosen) {
        match chosen {
            Chosen::Case(path) => self.open(ctx, path),
            Chosen::LoadScene(path) => {
                let told = self.load_scene(&path);
                self.answer(told);
            }
            Chosen::SaveScene(path) => {
                let told = self.save_scene(&path);
                self.answer(told);
            }
            Chosen::SaveTable(path) => {
                let told = self.save_table(&path);
                self.answer(told);
            }
            Chosen::Export(spec, path) => {
                let waker = ctx.clone();
                self.export = Some(Export::begin(*spec, path, move || waker.request_repaint()));
            }
        }
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
        Command::NextStrategy => {
            let next = next_strategy(&document.state.setup.scene.strategy);
            document.apply(Action::Strategy(next.name().into()));
            return Some(next.describe().to_owned());
        }
        Command::Light => {
            let off = LightingSpec::default();
            let next = match document.state.setup.scene.lighting == off {
                true => LightingSpec::preset("soft").unwrap_or_default(),
                false => off,
            };
            document.apply(Action::Lighting(next));
        }
        Command::Compare => {
            let next = match document.state.setup.comparison {
                Some(_) => None,
                None => Some(Comparison::with_next_strategy(&document.state.setup.scene)),
            };
            document.apply(Action::Compare(next));
        }
        Command::Deselect => document.apply(Action::Deselect),
        _ => {}
    }
    None
}
