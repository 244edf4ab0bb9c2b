//! Property filters: cells whose values lie in ranges, all of which must hold.

use eframe::egui::{self, Ui};

use super::About;
use crate::scene::PropertyFilter;
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let mut filter = about.scene.filter.clone();
    let mut removed = None;
    for (n, row) in filter.properties.iter_mut().enumerate() {
        ui.push_id(n, |ui| {
            ui.horizontal(|ui| {
                property(ui, about, &mut row.name);
                let remove = ui.button("Remove").on_hover_text("Draws these cells again");
                if remove.clicked() {
                    removed = Some(n);
                }
            });
            range(ui, about, row);
        });
    }
    if let Some(n) = removed {
        filter.properties.remove(n);
    }
    let add = ui.button("Add a filter");
    if add
        .on_hover_text("Draws the cells whose value of the property shown lies in a range")
        .clicked()
        && let Some(picture) = about.picture
    {
        let [min, max] = bounds(about, &picture.view.property);
        filter.properties.push(PropertyFilter {
            name: picture.view.property.clone(),
            min,
            max,
        });
    }
    if filter != about.scene.filter {
        actions.push(Action::Filter(filter));
    }
}

fn property(ui: &mut Ui, about: &About<'_>, name: &mut String) {
    egui::ComboBox::from_id_salt("property")
        .width(130.0)
        .selected_text(name.clone())
        .show_ui(ui, |ui| {
            for property in &about.case.properties {
                ui.selectable_value(name, property.name.clone(), &property.name);
            }
        })
        .response
        .on_hover_text("The property whose values decide");
}

fn range(ui: &mut Ui, about: &About<'_>, row: &mut PropertyFilter) {
    let unit = about.case.unit(&row.name).to_owned();
    let [low, high] = bounds(about, &row.name);
    let speed = 0.002 * (high - low).abs().max(1e-9);
    ui.horizontal(|ui| {
        for (value, what) in [
            (&mut row.min, "Smallest value drawn"),
            (&mut row.max, "Largest value drawn"),
        ] {
            let drag = egui::DragValue::new(value).speed(speed).max_decimals(6);
            ui.add(drag).on_hover_text(what);
        }
        ui.weak(unit);
        let all = ui
            .button("All")
            .on_hover_text("The whole range of the property at this step");
        if all.clicked() {
            [row.min, row.max] = [low, high];
        }
    });
}

/// Smallest and largest value of a property at the step shown.
fn bounds(about: &About<'_>, name: &str) -> [f64; 2] {
    let step = about.picture.map_or(0, |p| p.view.step);
    let field = about.case.field(name, step).ok();
    let statistics = field.and_then(|f| f.statistics());
    statistics.map_or([0.0, 1.0], |s| [s.min, s.max])
}
