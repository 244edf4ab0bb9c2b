//! Which property is shown, how its values vary in a cell, and over which range.

use eframe::egui::{self, Ui};

use super::About;
use crate::case::Kind;
use crate::scene::Interpolation;
use crate::viewer::action::Action;

/// Groups in the order in which they are listed.
const GROUPS: [(Kind, &str); 3] = [
    (Kind::Dynamic, "Dynamic"),
    (Kind::Static, "Static"),
    (Kind::Derived, "Derived"),
];

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let id = ui.scope_id().with("search");
    let mut search: String = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let hint = egui::TextEdit::singleline(&mut search).hint_text("Search");
    ui.add(hint).on_hover_text("Part of a property's name");
    ui.data_mut(|d| d.insert_temp(id, search.clone()));
    let shown = about.picture.map(|p| p.view.property.as_str());
    let current = about.scene.property.as_deref().or(shown);
    let list = egui::ScrollArea::vertical().max_height(220.0);
    list.show(ui, |ui| {
        for (kind, group) in GROUPS {
            let matches = |name: &str| name.to_lowercase().contains(&search.to_lowercase());
            let of_kind = about.case.properties.iter();
            let mut of_kind = of_kind
                .filter(|p| p.kind == kind && matches(&p.name))
                .peekable();
            if of_kind.peek().is_none() {
                continue;
            }
            ui.weak(group);
            for property in of_kind {
                let unit = match property.unit.is_empty() {
                    true => "no unit".to_owned(),
                    false => property.unit.clone(),
                };
                let is_shown = current == Some(property.name.as_str());
                let label = ui.selectable_label(is_shown, &property.name);
                if label.on_hover_text(unit).clicked() {
                    actions.push(Action::Property(property.name.clone()));
                }
            }
        }
    });
    interpolation(ui, about, actions);
    range(ui, about, actions);
}

fn interpolation(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        for (value, name, what) in [
            (
                Interpolation::Cell,
                "Cell values",
                "One value a cell, as the simulator gives it",
            ),
            (
                Interpolation::Vertex,
                "Smooth",
                "Averages at the corners, never across a fault",
            ),
        ] {
            let is_on = about.scene.interpolation == value;
            if ui
                .selectable_label(is_on, name)
                .on_hover_text(what)
                .clicked()
            {
                actions.push(Action::Interpolation(value));
            }
        }
    });
}

fn range(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let mut range = about.scene.range.unwrap_or(picture.view.transfer.range);
    let speed = 0.005 * (range[1] - range[0]).abs().max(1e-9);
    ui.horizontal(|ui| {
        ui.label("Range");
        let mut changed = false;
        for (value, what) in range.iter_mut().zip(["Lower end", "Upper end"]) {
            let drag = egui::DragValue::new(value).speed(speed).max_decimals(6);
            let response = ui.add(drag);
            response.widget_info(|| egui::WidgetInfo::drag_value(true, 0.0));
            changed |= response.on_hover_text(what).changed();
        }
        if changed && range[0] < range[1] {
            actions.push(Action::Range(Some(range)));
        }
        let own = ui.add_enabled(about.scene.range.is_some(), egui::Button::new("Own"));
        if own
            .on_hover_text("The range of the step's values")
            .clicked()
        {
            actions.push(Action::Range(None));
        }
    });
}
