//! Which property is shown, how its values vary in a cell, and over which range.

use eframe::egui::{self, Ui};

use super::PanelContext;
use super::controls::{list, number, one_of, show_chosen};
use crate::case::{Kind, Property, Statistic};
use crate::scene::{Coloring, Interpolation, Mode, OwnRange, RangeSpec, ScaleSpec};
use crate::viewer::action::Action;

/// Groups in the order in which they are listed.
const GROUPS: [(Kind, &str); 3] = [
    (Kind::Dynamic, "Dynamic"),
    (Kind::Static, "Static"),
    (Kind::Derived, "Derived"),
];

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let shown = about.picture.map(|p| p.view.shown.property.as_str());
    let current = about.scene.property.as_deref().or(shown).unwrap_or("");
    properties(ui, about, current, actions);
    statistics(ui, about, current, actions);
    differences(ui, about, current, actions);
    let are_categories = about.scene.transfer.coloring == Coloring::Categories;
    ui.add_enabled_ui(!are_categories, |ui| {
        interpolation(ui, about, actions);
        range(ui, about, actions);
    });
    if are_categories {
        ui.weak("Categories are cell values, each with its color.");
    }
}

/// The properties by group, those whose name has the text that is searched.
fn properties(ui: &mut Ui, about: &PanelContext<'_>, current: &str, actions: &mut Vec<Action>) {
    let id = ui.scope_id().with("search");
    let mut search: String = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let edit = egui::TextEdit::singleline(&mut search).hint_text("Search");
    let what = "Part of a property's name";
    ui.add(edit.desired_width(f32::INFINITY))
        .on_hover_text(what);
    ui.data_mut(|d| d.insert_temp(id, search.clone()));
    let now = about.case.now_of(current);
    let statistic = about.case.statistic(now);
    let now = statistic.map_or(now, |(of, _)| of);
    // Another property is shown by the same statistic.
    let chosen = |name: &str| {
        let same = statistic.map(|(_, statistic)| statistic.name(name));
        let same = same.filter(|name| about.case.property(name).is_ok());
        same.unwrap_or_else(|| name.to_owned())
    };
    let search = search.to_lowercase();
    // As high with few names as with many, so that what is below stays in its place.
    egui::ScrollArea::vertical()
        .max_height(190.0)
        .min_scrolled_height(190.0)
        .auto_shrink([false, false])
        .show(ui, |ui| {
            for (kind, group) in GROUPS {
                let all = about.properties();
                // What is derived from values that change with time changes too.
                let kind_of = |p: &Property| match p.steps {
                    0 => p.kind,
                    _ => Kind::Dynamic,
                };
                let of_kind = all.filter(|p| kind_of(p) == kind);
                let mut found = of_kind
                    .filter(|p| p.name.to_lowercase().contains(&search))
                    .peekable();
                if found.peek().is_none() {
                    continue;
                }
                ui.weak(group);
                for property in found {
                    let measure = about.measure(&property.name);
                    let unit = match measure.unit.as_str() {
                        "" => "No unit",
                        unit => unit,
                    };
                    let label = ui.selectable_label(now == property.name, &property.name);
                    if label.on_hover_text(unit).clicked() {
                        actions.push(Action::Property(chosen(&property.name)));
                    }
                }
            }
        });
}

/// Turns a property into a statistic over several cases, and back into its values in the first.
fn statistics(ui: &mut Ui, about: &PanelContext<'_>, current: &str, actions: &mut Vec<Action>) {
    let Some(ensemble) = &about.case.ensemble else {
        return;
    };
    let (of, now) = match about.case.statistic(current) {
        Some((of, statistic)) => (of, Some(statistic)),
        None => (current, None),
    };
    if about.case.property(&Statistic::Mean.name(of)).is_err() {
        return;
    }
    let own = format!("none: {}", ensemble.members[0]);
    let what = format!("Over {}", ensemble.members.join(", "));
    let text = now.map_or_else(|| own.clone(), |statistic| statistic.words().to_owned());
    list(ui, "Statistic", &what, &text, |ui| {
        if ui.selectable_label(now.is_none(), &own).clicked() {
            actions.push(Action::Property(of.to_owned()));
        }
        for (statistic, _, words) in Statistic::ALL {
            let entry = ui.selectable_label(now == Some(statistic), words);
            if entry.clicked() {
                actions.push(Action::Property(statistic.name(of)));
            }
        }
    });
}

/// Turns a property that changes with time into its difference to a step, and back.
fn differences(ui: &mut Ui, about: &PanelContext<'_>, current: &str, actions: &mut Vec<Action>) {
    if !about.case.is_dynamic(current) {
        return;
    }
    let (now, base) = match about.case.difference(current) {
        Some(d) => (d.now, d.at.and_then(|step| about.case.step(step).ok())),
        None => (current, None),
    };
    let steps = about.case.steps.iter().enumerate();
    let named: Vec<String> = steps.map(|(n, s)| format!("{n}   {}", s.date)).collect();
    let text = base
        .and_then(|n| named.get(n))
        .map_or("none", String::as_str);
    let what = "Shows the values minus those of another step";
    list(ui, "Difference to", what, text, |ui| {
        if ui.selectable_label(base.is_none(), "none").clicked() {
            actions.push(Action::Property(now.to_owned()));
        }
        for (n, text) in named.iter().enumerate() {
            let entry = ui.selectable_label(base == Some(n), text);
            if base == Some(n) {
                show_chosen(ui, &entry);
            }
            if entry.clicked() {
                actions.push(Action::Property(format!("{now}-{now}@{n}")));
            }
        }
    });
}

fn interpolation(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let choices = [
        (
            Interpolation::Cell,
            "Cells",
            "One value per cell, as the simulator writes it",
        ),
        (
            Interpolation::Vertex,
            "Smooth",
            "Averages at the corners, never across a fault",
        ),
    ];
    let is_volume = about.scene.mode == Mode::Volume;
    let shown = match is_volume {
        true => about.scene.interpolation,
        false => Interpolation::Cell,
    };
    ui.add_enabled_ui(is_volume, |ui| {
        if let Some(chosen) = one_of(ui, "Values", shown, &choices) {
            actions.push(Action::Interpolation(chosen));
        }
    })
    .response
    .on_disabled_hover_text("In the mode Cells each cell has the color of its own value");
}

/// What a range is taken from.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Own(OwnRange),
    Fixed,
}

fn range(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let [mut low, mut high] = match about.scene.range {
        RangeSpec::Fixed(range) => range,
        RangeSpec::Own(_) => picture.view.style.transfer.true_range(),
    };
    let current = match about.scene.range {
        RangeSpec::Own(of) => Of::Own(of),
        RangeSpec::Fixed(_) => Of::Fixed,
    };
    let choices = [
        (
            Of::Own(OwnRange::Step),
            "Step",
            "From the smallest to the largest value of the step shown",
        ),
        (
            Of::Own(OwnRange::Steps),
            "All steps",
            "From the smallest to the largest value of all steps: colors mean the same while time plays",
        ),
        (Of::Fixed, "Fixed", "The two values below"),
    ];
    match one_of(ui, "Range", current, &choices) {
        Some(Of::Own(of)) => actions.push(Action::Range(RangeSpec::Own(of))),
        Some(Of::Fixed) if low < high => actions.push(Action::Range(RangeSpec::Fixed([low, high]))),
        _ => {}
    }
    let measure = about.measure(&picture.view.shown.property);
    let unit = measure.unit.as_str();
    let is_log = about.scene.transfer.scale == ScaleSpec::Log;
    [low, high] = [low, high].map(|end| measure.show(end));
    let span = (high - low).abs().max(1e-9);
    ui.horizontal(|ui| {
        let mut changed = false;
        for (value, name) in [(&mut low, "Lower end"), (&mut high, "Upper end")] {
            let speed = if is_log {
                0.02 * value.abs()
            } else {
                0.005 * span
            };
            let what = format!("{name} of the color map, {unit}");
            changed |= number(ui, value, speed, name, what.trim_end_matches([',', ' ']));
        }
        ui.weak(unit);
        let [low, high] = [low, high].map(|end| measure.read(end));
        if changed && low < high && (low > 0.0 || !is_log) {
            actions.push(Action::Range(RangeSpec::Fixed([low, high])));
        }
    });
}
