//! Which cells are drawn, the vertical exaggeration, and what is drawn beside the volume.

use eframe::egui::{self, Ui};

use super::About;
use crate::scene::{Hull, Inactive};
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let dims = about.case.grid.dims();
    let mut filter = about.scene.filter.clone();
    let before = filter.clone();
    for (name, range, count) in [
        ("I", &mut filter.i, dims.ni),
        ("J", &mut filter.j, dims.nj),
        ("K", &mut filter.k, dims.nk),
    ] {
        let [mut from, mut to] = range.unwrap_or([1, count]);
        ui.horizontal(|ui| {
            ui.label(name);
            ui.add(egui::Slider::new(&mut from, 1..=count).text(format!("{name} from")));
        });
        ui.horizontal(|ui| {
            ui.label("   ");
            ui.add(egui::Slider::new(&mut to, 1..=count).text(format!("{name} to")));
        });
        let kept = [from.min(to), to.max(from)];
        *range = (kept != [1, count]).then_some(kept);
    }
    if filter != before {
        actions.push(Action::Filter(filter));
    }
    exaggeration(ui, about, actions);
    beside(ui, about, actions);
}

fn exaggeration(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let mut factor = picture.view.vertical_exaggeration;
    if let Some(wanted) = about.scene.vertical_exaggeration {
        factor = wanted;
    }
    let slider = egui::Slider::new(&mut factor, 0.1..=100.0).logarithmic(true);
    if ui.add(slider.text("Vertical exaggeration")).changed() {
        actions.push(Action::Exaggeration(Some(factor)));
    }
}

fn beside(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let mut show = about.scene.show.clone();
    let mut ghosts = show.inactive == Inactive::Ghost;
    ui.checkbox(&mut ghosts, "Inactive cells");
    show.inactive = match ghosts {
        true => Inactive::Ghost,
        false => Inactive::Hidden,
    };
    let mut hull = show.hull == Hull::Opaque;
    ui.checkbox(&mut hull, "Opaque hull")
        .on_hover_text("The outer faces of the drawn cells, in the property's colors");
    show.hull = match hull {
        true => Hull::Opaque,
        false => Hull::Hidden,
    };
    ui.checkbox(&mut show.faults, "Fault surfaces")
        .on_hover_text("Half-transparent sheets, a color for each name in FAULTS");
    ui.checkbox(&mut show.cell_edges, "Edges of cells")
        .on_hover_text("On the hull, fault surfaces and opaque sections");
    ui.checkbox(&mut show.r#box, "Box and axes");
    ui.checkbox(&mut show.legend, "Legend and title");
    if show != about.scene.show {
        actions.push(Action::Show(show));
    }
}
