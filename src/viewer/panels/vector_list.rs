//! The list from which summary vectors are chosen: by a filter and by what they are of.

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, PopupCloseBehavior, ScrollArea, Ui};

use super::PanelContext;
use crate::case::{Units, Vector, VectorKind, Vectors};
use crate::scene::names;
use crate::viewer::action::Action;
use crate::viewer::state::CurvePlots;

/// Points of the list.
const SIZE: [f32; 2] = [250.0, 260.0];

/// What the user looks for.
#[derive(Debug, Clone, Default)]
struct Sought {
    text: String,
    kind: Option<VectorKind>,
}

impl Sought {
    /// True where a vector has all words; words may be patterns with `*` and `?`.
    fn fits(&self, vector: &Vector) -> bool {
        let name = &vector.name;
        let has = |word: &str| match word.contains(['*', '?']) {
            true => names::matches(word, name),
            false => name.to_lowercase().contains(&word.to_lowercase()),
        };
        self.kind.is_none_or(|kind| kind == vector.kind) && self.text.split_whitespace().all(has)
    }
}

/// A button that opens the list; none where the case has no summary.
pub fn menu(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    if about.case.about.summary.is_empty() {
        return;
    }
    let text = match about.state.curves.vectors.len() {
        0 => "Summary vectors".to_owned(),
        count => format!("Summary vectors ({count})"),
    };
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let button = MenuButton::new(text).config(config);
    let (button, _) = button.ui(ui, |ui| match about.vectors.map(|v| &v.vectors) {
        Some(Ok(vectors)) => list(ui, about, vectors, actions),
        Some(Err(why)) => {
            ui.label(why);
        }
        None => {
            ui.weak("The summary is being read.");
        }
    });
    button.on_hover_text("Curves of the field, groups, wells, regions and cells that are shown");
}

fn list(ui: &mut Ui, about: &PanelContext<'_>, vectors: &Vectors, actions: &mut Vec<Action>) {
    ui.set_width(SIZE[0]);
    let id = ui.scope_id().with("sought");
    let mut sought: Sought = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let chosen = &about.state.curves.vectors;
    let mut now = chosen.clone();
    ui.horizontal(|ui| {
        let edit = egui::TextEdit::singleline(&mut sought.text)
            .hint_text("Filter, such as WOPR OP_*")
            .desired_width(SIZE[0] - 60.0);
        let edit = ui.add(edit);
        edit.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Filter vectors")
        });
        let clear = ui.add_enabled(!now.is_empty(), egui::Button::new("Clear"));
        if clear.on_hover_text("Shows none of them").clicked() {
            now.clear();
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.selectable_value(&mut sought.kind, None, "all");
        for kind in VectorKind::ALL {
            if vectors.list.iter().any(|v| v.kind == kind) {
                ui.selectable_value(&mut sought.kind, Some(kind), kind.name());
            }
        }
    });
    let found: Vec<&Vector> = vectors.list.iter().filter(|v| sought.fits(v)).collect();
    ui.weak(format!("{} of {} vectors", found.len(), vectors.list.len()));
    let row = ui.spacing().interact_size.y;
    ScrollArea::vertical()
        .max_height(SIZE[1])
        .auto_shrink([false, true])
        .show_rows(ui, row, found.len(), |ui, rows| {
            for vector in &found[rows] {
                entry(ui, vector, about.units(), &mut now);
            }
        });
    for note in &vectors.notes {
        ui.weak(note);
    }
    ui.data_mut(|d| d.insert_temp(id, sought));
    if now != *chosen {
        actions.push(Action::Curves(CurvePlots {
            vectors: now,
            ..about.state.curves.clone()
        }));
    }
}

/// A vector that is shown or not.
fn entry(ui: &mut Ui, vector: &Vector, units: Units, chosen: &mut Vec<String>) {
    ui.horizontal(|ui| {
        let name = &vector.name;
        let mut is_on = chosen.contains(name);
        if ui.checkbox(&mut is_on, name).changed() {
            chosen.retain(|n| n != name);
            chosen.extend(is_on.then(|| name.clone()));
        }
        ui.weak(units.of_vector(vector).unit);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_kinds_are_looked_for() {
        let vector = Vector {
            name: "WOPR:OP_1".into(),
            keyword: "WOPR".into(),
            kind: VectorKind::Well,
            well: Some("OP_1".into()),
            unit: "SM3/DAY".into(),
            is_history: false,
        };
        let fits = |text: &str, kind| {
            let text = text.to_owned();
            Sought { text, kind }.fits(&vector)
        };
        for text in ["", "wopr", "op_1 WO", "W*:OP_?", " :op "] {
            assert!(fits(text, None), "{text}");
        }
        for text in ["wwpr", "wopr op_2", "OP_*", "W?:OP_1"] {
            assert!(!fits(text, None), "{text}");
        }
        assert!(fits("w", Some(VectorKind::Well)) && !fits("w", Some(VectorKind::Field)));
    }
}
