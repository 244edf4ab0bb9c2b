//! Which cells are drawn by I, J and K, single slices, local grids, and the vertical exaggeration.

use eframe::egui::{self, Color32, Id, Role, Ui, WidgetInfo};

use super::PanelContext;
use super::range_slider::RangeSlider;
use crate::scene::{Filter, Indices};
use crate::viewer::action::Action;
use crate::viewer::slices::{AXES, count};

/// Width of the field for a list, in points.
const FIELD: f32 = 84.0;
/// Lists as they may be typed.
const FORM: &str = "2,4-6,10-30:2";

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let dims = about.case.grid.main_dims();
    let mut filter = about.scene.filter.clone();
    for (axis, name) in AXES.into_iter().enumerate() {
        ui.push_id(name, |ui| {
            let count = count(dims, axis);
            let id = ui.scope_id().with("typed");
            ui.horizontal(|ui| along(ui, id, name, filter.along_mut(axis), count));
            refusal(ui, id, filter.along(axis), count);
        });
    }
    ui.weak(format!("For example {FORM}: 10-30:2 is every second one"));
    slices(ui, about, &mut filter, actions);
    clear(ui, &mut filter);
    if filter != about.scene.filter {
        actions.push(Action::Filter(filter));
    }
    local_grids(ui, about, actions);
    exaggeration(ui, about, actions);
}

/// Switches local grids on and off; nothing where there are none.
fn local_grids(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let locals = about.case.grid.patches().iter().skip(1);
    let mut grids = about.scene.grids.clone();
    for patch in locals {
        let hidden = grids.hidden.iter();
        let at = hidden
            .clone()
            .position(|name| name.eq_ignore_ascii_case(&patch.name));
        let mut is_shown = at.is_none();
        let dims = patch.file_dims();
        let text = format!(
            "Local grid {} ({} x {} x {})",
            patch.name, dims.ni, dims.nj, dims.nk
        );
        let switch = ui.checkbox(&mut is_shown, text).on_hover_text(
            "On: its cells in place of those that it refines. Off: the cells that it refines",
        );
        match at {
            _ if !switch.changed() => {}
            Some(at) => drop(grids.hidden.remove(at)),
            None => grids.hidden.push(patch.name.clone()),
        }
    }
    if grids != about.scene.grids {
        actions.push(Action::Grids(grids));
    }
}

/// Clears all filters.
pub fn clear(ui: &mut Ui, filter: &mut Filter) {
    let is_set = *filter != Filter::default();
    let button = ui.add_enabled(is_set, egui::Button::new("Clear filters"));
    let what = "Draws all cells: clears I, J, K and the property filters";
    if button.on_hover_text(what).clicked() {
        *filter = Filter::default();
    }
}

/// First and last of an axis, by two handles, and a field for lists.
fn along(ui: &mut Ui, id: Id, name: &str, kept: &mut Option<Indices>, count: usize) {
    ui.label(name);
    let [first, last] = kept.as_ref().and_then(Indices::ends).unwrap_or([1, count]);
    let [first, last] = [first, last].map(|n| n.clamp(1, count));
    let most = count.max(2) as f64 - 1.0;
    let mut parts = [first, last].map(|n| (n - 1) as f64 / most);
    let slider = RangeSlider {
        names: [format!("First {name}"), format!("Last {name}")],
        values: [first as f64, last as f64],
        bars: &[],
        inverted: false,
        height: 16.0,
        width: (ui.available_width() - FIELD - 14.0).max(60.0),
        nudge: Some(1.0 / most),
    };
    if slider.show(ui, &mut parts) {
        let [a, b] = parts.map(|part| ((part * most).round() as usize + 1).min(count));
        if [a, b] != [first, last] {
            *kept = Some(Indices::Range([a, b])).filter(|_| [a, b] != [1, count]);
        }
    }
    field(ui, id, name, kept, count);
}

/// What was typed into a field and is not taken yet, and the text of the filter that it would replace.
#[derive(Clone, Default, PartialEq)]
struct Typed {
    text: String,
    over: String,
}

impl Typed {
    fn of(ui: &Ui, id: Id, shown: &str) -> Option<Self> {
        let typed: Option<Self> = ui.data(|d| d.get_temp(id));
        typed.filter(|t| t.over == shown)
    }
}

fn shown(kept: Option<&Indices>, count: usize) -> String {
    kept.map_or_else(|| format!("1-{count}"), Indices::text)
}

/// A field for a number, a range or a list; what cannot be understood stays, and is said below.
fn field(ui: &mut Ui, id: Id, name: &str, kept: &mut Option<Indices>, count: usize) {
    let shown = shown(kept.as_ref(), count);
    let typed = Typed::of(ui, id, &shown);
    let mut text = typed.map_or_else(|| shown.clone(), |t| t.text);
    let is_wrong = Indices::typed(&text, count).is_err();
    let mut edit = egui::TextEdit::singleline(&mut text).desired_width(FIELD - 10.0);
    if is_wrong {
        edit = edit.text_color(wrong(ui));
    }
    let response = ui.add(edit);
    let label = format!("List of {name}");
    response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, &label));
    let response = response.on_hover_text(format!(
        "{name} drawn, 1 to {count}: a number, a range or a list such as {FORM}"
    ));
    if response.lost_focus()
        && let Ok(indices) = Indices::typed(&text, count)
    {
        *kept = indices;
        ui.data_mut(|d| d.remove_temp::<Typed>(id));
    } else if response.changed() {
        let typed = Typed { text, over: shown };
        ui.data_mut(|d| d.insert_temp(id, typed));
    }
}

/// Why what was typed is not taken.
fn refusal(ui: &mut Ui, id: Id, kept: Option<&Indices>, count: usize) {
    let why = match (Typed::of(ui, id, &shown(kept, count)), kept) {
        (Some(typed), _) => Indices::typed(&typed.text, count).err(),
        (None, Some(kept)) => kept.flags(count).err(),
        (None, None) => None,
    };
    if let Some(why) = why {
        ui.colored_label(wrong(ui), why);
    }
}

fn wrong(ui: &Ui) -> Color32 {
    ui.visuals().error_fg_color
}

/// Steps through single slices of an axis.
fn slices(ui: &mut Ui, about: &PanelContext<'_>, filter: &mut Filter, actions: &mut Vec<Action>) {
    let dims = about.case.grid.main_dims();
    let before = about.state.slicing;
    let mut slicing = before;
    ui.horizontal_wrapped(|ui| {
        ui.label("Slices");
        for (axis, name) in AXES.into_iter().enumerate() {
            let is_on = slicing.axis == axis;
            let button = ui.selectable_label(is_on, name);
            let label = format!("Slices along {name}");
            button.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, is_on, &label));
            let what = format!("Page Up and Page Down step through {name}; with Shift they change the axis");
            if button.on_hover_text(what).clicked() {
                (slicing, *filter) = slicing.along(axis, filter, dims);
            }
        }
        for (text, by, what) in [
            ("<", -1, "Previous slice (Page Up)"),
            (">", 1, "Next slice (Page Down)"),
        ] {
            let button = ui.button(text);
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, what));
            if button.on_hover_text(what).clicked() {
                *filter = slicing.stepped(filter, dims, by);
            }
        }
        ui.label(slicing.words(filter, dims));
        let mut alone = slicing.alone;
        let switch = ui.checkbox(&mut alone, "Section only").on_hover_text(
            "On: the slice alone. Off: the slice and the cells beyond it, as a cut through the model",
        );
        if switch.changed() {
            (slicing, *filter) = slicing.with_alone(alone, filter, dims);
        }
    });
    if slicing != before {
        actions.push(Action::Slicing(slicing));
    }
}

fn exaggeration(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let wanted = about.scene.vertical_exaggeration;
    let mut factor = wanted.unwrap_or(picture.view.world.vertical_exaggeration);
    ui.label("Vertical exaggeration");
    ui.horizontal(|ui| {
        ui.spacing_mut().slider_width = 130.0;
        let slider = egui::Slider::new(&mut factor, 0.1..=100.0).logarithmic(true);
        let slider = ui.add(slider.prefix("×"));
        if slider
            .on_hover_text("Factor on depth, 0.1 to 100")
            .changed()
        {
            actions.push(Action::Exaggeration(Some(factor)));
        }
        let own = ui.add_enabled(wanted.is_some(), egui::Button::new("Auto"));
        if own
            .on_hover_text("Chosen from the shape of the model")
            .clicked()
        {
            actions.push(Action::Exaggeration(None));
        }
    });
}
