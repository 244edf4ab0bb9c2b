//! What is drawn beside the volume: hull, faults, inactive cells, connections, box and legend.

use eframe::egui::{self, Color32, Ui, vec2};

use super::About;
use crate::scene::surfaces::fault_color;
use crate::scene::{Hull, Inactive, Show};
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let mut show = about.scene.show.clone();
    egui::Grid::new("what is shown").num_columns(2).show(ui, |ui| {
        let mut hull = show.hull == Hull::Opaque;
        ui.checkbox(&mut hull, "Opaque hull")
            .on_hover_text("The outer faces of the drawn cells, in the property's colors");
        show.hull = if hull { Hull::Opaque } else { Hull::Hidden };
        ui.checkbox(&mut show.cell_edges, "Edges of cells")
            .on_hover_text("On hull, fault surfaces and opaque sections");
        ui.end_row();
        ui.checkbox(&mut show.faults, "Fault surfaces")
            .on_hover_text("Half-transparent sheets, a color for each name in FAULTS; rest the pointer on one to read its throw");
        let mut ghosts = show.inactive == Inactive::Ghost;
        ui.checkbox(&mut ghosts, "Inactive cells")
            .on_hover_text("Faint and gray");
        show.inactive = if ghosts { Inactive::Ghost } else { Inactive::Hidden };
        ui.end_row();
        connections(ui, about, &mut show);
        ui.checkbox(&mut show.r#box, "Box and axes")
            .on_hover_text("The model's box, axes and scale");
        ui.end_row();
        ui.checkbox(&mut show.legend, "Legend")
            .on_hover_text("Legend and title");
        ui.end_row();
    });
    if show != about.scene.show {
        actions.push(Action::Show(show));
    }
    if about.scene.show.faults {
        names(ui, about);
    }
}

fn connections(ui: &mut Ui, about: &About<'_>, show: &mut Show) {
    let count = about.case.about.nnc;
    let button = egui::Checkbox::new(&mut show.nnc, "NNC");
    ui.add_enabled(count > 0, button).on_hover_text(format!(
        "Lines between the cells of the {count} non-neighbor connections"
    ));
}

/// Names of the faults with their colors.
fn names(ui: &mut Ui, about: &About<'_>) {
    let named = about.case.about.named_faults.iter().enumerate();
    let named = named.map(|(n, f)| (Some(n), f.name.as_str()));
    ui.horizontal_wrapped(|ui| {
        for (number, name) in named.chain([(None, "without a name")]) {
            let [r, g, b] = fault_color(number).map(|v| (255.0 * v).round() as u8);
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), egui::Sense::hover());
            ui.painter()
                .rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
            ui.label(name);
        }
    });
}
