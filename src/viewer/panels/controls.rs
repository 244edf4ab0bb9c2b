//! Controls that panels share: a name, then what there is to choose, never wider than the panel.

use eframe::egui::{self, Response, Ui, WidgetInfo};

/// What a choice sets, its text, and what it means.
pub type Choice<'a, T> = (T, &'a str, &'a str);

/// A row of choices behind a name, in more lines where it is too long; the one that was clicked.
pub fn one_of<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    current: T,
    choices: &[Choice<'_, T>],
) -> Option<T> {
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        ui.label(name);
        for (value, text, what) in choices {
            let is_on = *value == current;
            let response = ui.selectable_label(is_on, *text);
            let full = format!("{name}: {text}");
            response.widget_info(|| {
                WidgetInfo::selected(egui::Role::RadioButton, ui.is_enabled(), is_on, &full)
            });
            if response.on_hover_text(*what).clicked() {
                chosen = Some(*value);
            }
        }
    });
    chosen
}

/// A list that opens behind a name, as wide as there is room.
pub fn list(ui: &mut Ui, name: &str, what: &str, current: &str, show: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        let label = ui.label(name);
        let combo = egui::ComboBox::from_id_salt(name)
            .width(ui.available_width())
            .truncate()
            .selected_text(current);
        let response = combo.show_ui(ui, show).response;
        response.labelled_by(label.id).on_hover_text(what);
    });
}

/// A slider behind a name, as wide as there is room; true where it changed.
pub fn slider(ui: &mut Ui, name: &str, what: &str, slider: egui::Slider<'_>) -> bool {
    ui.horizontal(|ui| {
        let label = ui.label(name);
        ui.spacing_mut().slider_width = (ui.available_width() - BESIDE_SLIDER).max(40.0);
        let slider = ui.add(slider).labelled_by(label.id);
        slider.on_hover_text(what).changed()
    })
    .inner
}

/// Points that the number beside a slider takes.
const BESIDE_SLIDER: f32 = 76.0;

/// A number to drag or type, with six digits; true where it changed.
pub fn number(ui: &mut Ui, value: &mut f64, speed: f64, name: &str, what: &str) -> bool {
    let drag = egui::DragValue::new(value)
        .speed(speed)
        .custom_formatter(|v, _| significant(v));
    let response: Response = ui.add(drag);
    let shown = *value;
    response.widget_info(|| WidgetInfo::slider(ui.is_enabled(), shown, name));
    response.on_hover_text(what).changed()
}

/// A value with six digits, and no zeros at its end.
pub fn significant(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded {
        v if v == 0.0 || (1e-4..1e7).contains(&f64::abs(v)) => v.to_string(),
        v => format!("{v:e}"),
    }
}

/// Brings the entry that is chosen into view when a list is opened, and not while it is scrolled.
pub fn show_chosen(ui: &Ui, entry: &Response) {
    let id = ui.scope_id().with("shown in frame");
    let now = ui.ctx().cumulative_frame_nr();
    let last: Option<u64> = ui.data(|d| d.get_temp(id));
    if last.is_none_or(|last| now > last + 1) {
        entry.scroll_to_me(Some(egui::Align::Center));
    }
    ui.data_mut(|d| d.insert_temp(id, now));
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn six_digits_are_shown() {
        for (value, text) in [
            (298.552_19, "298.552"),
            (0.1 + 0.2, "0.3"),
            (-12_345_678.9, "-1.23457e7"),
            (1e-9, "1e-9"),
            (0.0, "0"),
        ] {
            assert_eq!(significant(value), text);
        }
    }
}
