//! The panels at both sides of the picture. Each side folds by itself, and both cannot be open at once where the
//! window is narrow.

use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::{self, CollapsingResponse, Margin, ScrollArea, Ui, WidgetInfo};

use super::Window;
use crate::case::Case;
use crate::scene::Scene;
use crate::viewer::action::Action;
use crate::viewer::keys::Command;
use crate::viewer::panels::{self, Panel, PanelContext};
use crate::viewer::state::CompareLayout;

/// Points of a side's panels.
const WIDTH: f32 = 280.0;
const LEAST: f32 = 240.0;
const MOST: f32 = 520.0;
/// Points that the picture has beside panels on both sides, at least.
const PICTURE: f32 = 360.0;
/// Points of the strip that opens a folded side.
const STRIP: f32 = 26.0;
/// Points between the scroll bar of the panels and their edge, which can be dragged.
const EDGE: i8 = 10;

/// Points beside the panels that belong to their scroll bar.
const BAR: f32 = 10.0;
/// Points of the height of the curves below the picture at first and at least, and the part of it that they take at
/// most.
const CURVES: f32 = 300.0;
const LEAST_CURVES: f32 = 120.0;
const MOST_CURVES: f32 = 0.8;

const NAMES: [&str; 2] = ["left", "right"];

/// Which sides are folded by the user, and which one was opened last: where there is room for one only, it is
/// that.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Docks {
    last: usize,
}

/// Which sides are open in a window of a width.
fn open(width: f32, folded: [bool; 2], last: usize) -> [bool; 2] {
    let wanted = folded.map(|f| !f);
    if width >= 2.0 * WIDTH + PICTURE || wanted != [true, true] {
        return wanted;
    }
    [last == 0, last == 1]
}

impl Window {
    /// Draws the panels of both sides.
    pub(super) fn panels(
        &mut self,
        ui: &mut Ui,
        case: &Arc<Case>,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        let others = self.other_cases();
        let Some(about) = self.about(case, scene, &others) else {
            return;
        };
        let folded = self.settings.folded;
        let open = open(ui.available_width(), folded, self.docks.last);
        let mut turned = None;
        for (side, list) in [&panels::LEFT[..], &panels::RIGHT].into_iter().enumerate() {
            let is_turned = match open[side] {
                true => unfolded(ui, side, list, &about, actions),
                false => strip(ui, side),
            };
            turned = is_turned.then_some(side).or(turned);
        }
        let Some(side) = turned else { return };
        self.settings.folded[side] = open[side];
        if open[side] && !open[1 - side] {
            // The other side was folded for want of room, and does not open by itself in its place.
            self.settings.folded[1 - side] = true;
        }
        if !open[side] {
            self.docks.last = side;
        }
        self.keep_settings();
    }
}

impl Window {
    /// The curves over time below the picture, where they are shown; what was asked for there beside changes.
    pub(super) fn curves(
        &self,
        ui: &mut Ui,
        case: &Arc<Case>,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) -> Option<Command> {
        let others = self.other_cases();
        let about = self.about(case, scene, &others)?;
        if !about.state.curves.is_open {
            return None;
        }
        let dock = egui::Panel::bottom("curves")
            .default_size(CURVES)
            .size_range(LEAST_CURVES..=MOST_CURVES * ui.available_height())
            .show(ui, |ui| {
                // As high as it was left, whatever is in it.
                ui.set_min_height(ui.available_height());
                panels::curves(ui, &about, actions)
            });
        dock.inner
    }

    /// Path and name of the other cases that are open.
    fn other_cases(&self) -> Vec<(PathBuf, String)> {
        let others = self.documents.iter().zip(self.titles()).enumerate();
        let others = others.filter(|(n, _)| *n != self.current);
        others.map(|(_, (d, title))| (d.key(), title)).collect()
    }

    /// What panels know.
    fn about<'a>(
        &'a self,
        case: &'a Arc<Case>,
        scene: &'a Scene,
        others: &'a [(PathBuf, String)],
    ) -> Option<PanelContext<'a>> {
        let document = self.document()?;
        let wells = document.wells.as_ref();
        let wells = wells.filter(|w| Arc::ptr_eq(&w.case, case));
        let comparison = document.state.setup.comparison.as_ref();
        let is_compared = comparison.is_some_and(|c| c.layout == CompareLayout::ColorDifference);
        Some(PanelContext {
            case,
            state: &document.state,
            scene,
            picture: self.pictures.shown(0, case).map(|s| &s.picture),
            difference: self.pictures.difference().filter(|_| is_compared),
            refusal: self.difference_of_values().and_then(Result::err),
            pick: document.pick.as_ref(),
            table: document.table.as_ref(),
            curves: document.curves.as_ref(),
            vectors: document
                .vectors
                .as_ref()
                .filter(|v| Arc::ptr_eq(&v.case, case)),
            wells: wells.map(|w| w.wells.as_slice()),
            spreads: &document.spreads,
            others,
        })
    }
}

fn panel(side: usize, name: String) -> egui::Panel {
    match side {
        0 => egui::Panel::left(name),
        _ => egui::Panel::right(name),
    }
}

/// The panels of a side, one below the other; true where they are to be folded.
fn unfolded(
    ui: &mut Ui,
    side: usize,
    list: &[Panel],
    about: &PanelContext<'_>,
    actions: &mut Vec<Action>,
) -> bool {
    let mut folds = false;
    let mut frame = egui::Frame::side_top_panel(ui.style());
    let edge = Margin {
        left: if side == 1 {
            EDGE
        } else {
            frame.inner_margin.left
        },
        right: if side == 0 {
            EDGE
        } else {
            frame.inner_margin.right
        },
        ..frame.inner_margin
    };
    frame = frame.inner_margin(edge);
    panel(side, NAMES[side].to_owned())
        .frame(frame)
        .default_size(WIDTH)
        .size_range(LEAST..=MOST)
        .show(ui, |ui| {
            // Filled whatever is in it, so that the picture keeps its size.
            let scroll = ScrollArea::vertical().auto_shrink(false);
            // The bar covers no control: points of the curve lie at its right end.
            ui.spacing_mut().scroll.floating_allocated_width = BAR;
            scroll.show(ui, |ui| {
                for panel in list {
                    let title = match (panel.count)(about) {
                        0 => panel.title.to_owned(),
                        count => format!("{} ({count})", panel.title),
                    };
                    let shown = egui::CollapsingHeader::new(title)
                        .id_salt(panel.title)
                        .default_open(panel.is_open)
                        .show(ui, |ui| (panel.show)(ui, about, actions));
                    reveal(ui, &shown);
                }
                ui.separator();
                let arrow = ["«", "»"][side];
                folds = button(ui, arrow, &format!("Hide the {} panels", NAMES[side]));
            });
        });
    folds
}

/// Scrolls while a panel opens, so that all of it is seen, or as much as there is room for.
fn reveal(ui: &Ui, shown: &CollapsingResponse<()>) {
    let header = &shown.header_response;
    let id = header.id.with("opens");
    if header.clicked() {
        ui.data_mut(|d| d.insert_temp(id, shown.openness < 0.5));
    }
    let opens = ui.data(|d| d.get_temp(id)).unwrap_or(false);
    let Some(body) = shown.body_response.as_ref().filter(|_| opens) else {
        return;
    };
    let all = header.rect.union(body.rect);
    let fits = all.height() <= ui.clip_rect().height();
    ui.scroll_to_rect(all, (!fits).then_some(egui::Align::TOP));
    if shown.fully_open() {
        ui.data_mut(|d| d.remove_temp::<bool>(id));
    }
}

/// What is left of a folded side; true where it is to be opened.
fn strip(ui: &mut Ui, side: usize) -> bool {
    let mut opens = false;
    panel(side, format!("{} strip", NAMES[side]))
        .resizable(false)
        .exact_size(STRIP)
        .frame(egui::Frame::side_top_panel(ui.style()).inner_margin(2))
        .show(ui, |ui| {
            let arrow = ["»", "«"][side];
            opens = button(ui, arrow, &format!("Show the {} panels", NAMES[side]));
        });
    opens
}

fn button(ui: &mut Ui, text: &str, name: &str) -> bool {
    let button = ui.small_button(text);
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, name));
    button.on_hover_text(name).clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_fold_one_by_one() {
        let both = [false, false];
        assert_eq!(open(1280.0, both, 0), [true, true]);
        assert_eq!(open(533.0, both, 0), [true, false]);
        assert_eq!(open(533.0, both, 1), [false, true]);
        // What the user folded stays so, whatever the width.
        assert_eq!(open(1280.0, [true, false], 0), [false, true]);
        assert_eq!(open(320.0, [true, true], 1), [false, false]);
        // The other side can be opened where one was folded.
        assert_eq!(open(533.0, [true, false], 0), [false, true]);
    }
}
