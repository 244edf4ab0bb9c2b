//! The cell that was picked: where it is, and what the case says of it.

use eframe::egui::{self, Ui};

use super::About;
use crate::viewer::action::Action;
use crate::viewer::worker::Picked;

pub fn show(ui: &mut Ui, about: &About<'_>, _actions: &mut Vec<Action>) {
    let Some(picked) = about.picked else {
        ui.weak("Click into the picture.");
        return;
    };
    let text = text(picked, about.case.unit(&picked.property));
    for line in text.lines().take(3) {
        ui.label(line);
    }
    let list = egui::ScrollArea::vertical()
        .id_salt("values")
        .max_height(160.0);
    list.show(ui, |ui| {
        egui::Grid::new("values of the picked cell")
            .striped(true)
            .show(ui, |ui| {
                for (name, unit, value) in &picked.values {
                    ui.label(name);
                    ui.label(format!("{value:.6}"));
                    ui.weak(unit);
                    ui.end_row();
                }
            });
    });
    if ui
        .button("Copy")
        .on_hover_text("All of it, as text")
        .clicked()
    {
        ui.ctx().copy_text(text);
    }
}

/// Cell, place, value here, then every property of the cell.
fn text(picked: &Picked, unit: &str) -> String {
    let ijk = picked.ijk;
    let [east, north, depth] = picked.map.to_array();
    let mut text = format!(
        "I {} J {} K {}\nE {east:.1} N {north:.1} depth {depth:.2}\n{} {:.6} {unit}\n",
        ijk.i + 1,
        ijk.j + 1,
        ijk.k + 1,
        picked.property,
        picked.value,
    );
    for (name, unit, value) in &picked.values {
        text += &format!("{name}\t{value}\t{unit}\n");
    }
    text
}
