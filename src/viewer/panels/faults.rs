//! The faults that have a name: color, on or off, largest throw.

use eframe::egui::{self, Color32, Ui, vec2};

use super::PanelContext;
use super::controls::significant;
use crate::scene::ShownFaults;
use crate::view::surfaces::fault_color;
use crate::viewer::action::Action;

/// Height of the list, in points.
const LIST: f32 = 180.0;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let named = &about.case.about.named_faults;
    if named.is_empty() {
        ui.weak("This case names no faults. Names come from FAULTS in a deck: use File > Add files to the case (Ctrl + Shift + O).");
        return;
    }
    let mut shown = about.scene.show.faults.clone();
    ui.horizontal(|ui| {
        for (name, all, what) in [
            ("All", true, "Draws every fault, with and without a name"),
            ("None", false, "Draws no fault"),
        ] {
            if ui.button(name).on_hover_text(what).clicked() {
                shown = ShownFaults::All(all);
            }
        }
        ui.weak("Largest throw at the right");
    });
    egui::ScrollArea::vertical()
        .max_height(LIST)
        .auto_shrink([false, true])
        .show(ui, |ui| list(ui, about, &mut shown));
    ui.weak("Throw: how much deeper the far side lies; below 0 where it lies higher.");
    if shown != about.scene.show.faults {
        let mut show = about.scene.show.clone();
        show.faults = shown;
        actions.push(Action::Show(show));
    }
}

fn list(ui: &mut Ui, about: &PanelContext<'_>, shown: &mut ShownFaults) {
    let length = about.lengths().grid;
    let named = &about.case.about.named_faults;
    let throws = about.case.largest_throws();
    egui::Grid::new("faults")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for (n, fault) in named.iter().enumerate() {
                ui.horizontal(|ui| {
                    swatch(ui, Some(n));
                    let mut is_on = shown.shows(Some(&fault.name));
                    let check = ui.checkbox(&mut is_on, &fault.name);
                    if check.changed() {
                        let names = named.iter().map(|f| f.name.clone());
                        let kept = |name: &String| match *name == fault.name {
                            true => is_on,
                            false => shown.shows(Some(name)),
                        };
                        *shown = ShownFaults::Named(names.filter(kept).collect());
                    }
                });
                ui.label(match throws.get(n).copied().flatten() {
                    Some(throw) => {
                        let throw = significant(rounded(length.show(throw)));
                        format!("{throw} {}", length.unit)
                    }
                    None => "no faces".to_owned(),
                });
                ui.end_row();
            }
            ui.horizontal(|ui| {
                swatch(ui, None);
                let mut is_on = shown.shows(None);
                let check = egui::Checkbox::new(&mut is_on, "without a name");
                ui.add_enabled(false, check)
                    .on_disabled_hover_text("Faults without a name are drawn with All");
            });
            ui.end_row();
        });
}

fn swatch(ui: &mut Ui, number: Option<usize>) {
    let [r, g, b] = fault_color(number).map(|v| (255.0 * v).round() as u8);
    let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), egui::Sense::hover());
    ui.painter()
        .rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
}

/// To a tenth, which is as exact as depths of faults are.
fn rounded(throw: f64) -> f64 {
    (10.0 * throw).round() / 10.0
}
