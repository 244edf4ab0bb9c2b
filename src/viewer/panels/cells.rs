//! Which cells are drawn, by I, J and K, and the vertical exaggeration.

use eframe::egui::{self, Ui};

use super::About;
use crate::scene::Filter;
use crate::viewer::action::Action;

/// Width of a slider, in points: two stand beside each other.
const SLIDER: f32 = 58.0;

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let dims = about.case.grid.dims();
    let mut filter = about.scene.filter.clone();
    let before = filter.clone();
    for (name, range, count) in [
        ("I", &mut filter.i, dims.ni),
        ("J", &mut filter.j, dims.nj),
        ("K", &mut filter.k, dims.nk),
    ] {
        ui.horizontal(|ui| between(ui, name, range, count));
    }
    let all = ui.add_enabled(filter != Filter::default(), egui::Button::new("All cells"));
    if all
        .on_hover_text("Takes these and the property filters away")
        .clicked()
    {
        filter = Filter::default();
    }
    if filter != before {
        actions.push(Action::Filter(filter));
    }
    exaggeration(ui, about, actions);
}

/// First and last row, column or layer; a slider each, and a button for one more or less.
fn between(ui: &mut Ui, name: &str, range: &mut Option<[usize; 2]>, count: usize) {
    ui.spacing_mut().slider_width = SLIDER;
    ui.spacing_mut().interact_size.x = 32.0;
    let [mut from, mut to] = range.unwrap_or([1, count]);
    let before = [from, to];
    ui.label(name);
    for (value, end) in [(&mut from, "first"), (&mut to, "last")] {
        let slider = ui.add(egui::Slider::new(value, 1..=count));
        slider.on_hover_text(format!("The {end} {name} drawn, 1 to {count}"));
    }
    if [from, to] != before {
        // The end that was moved pushes the other one.
        if from > to {
            match from == before[0] {
                true => from = to,
                false => to = from,
            }
        }
        *range = ([from, to] != [1, count]).then_some([from, to]);
    }
}

fn exaggeration(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let wanted = about.scene.vertical_exaggeration;
    let mut factor = wanted.unwrap_or(picture.view.vertical_exaggeration);
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
            .on_hover_text("One that suits the model's shape")
            .clicked()
        {
            actions.push(Action::Exaggeration(None));
        }
    });
}
