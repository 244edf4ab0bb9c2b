//! What is drawn beside the volume: hull, faults, inactive cells, connections, box and legend.

use eframe::egui::{self, Ui};

use super::PanelContext;
use super::controls::{list, one_of};
use crate::scene::{CutFace, Hull, Inactive, Mode, Show, ShownFaults, ShownWells, Units};
use crate::transfer::presets::parse_color;
use crate::view::Surfaces;
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let mut show = about.scene.show.clone();
    hull(ui, about, &mut show);
    egui::Grid::new("what is shown").num_columns(2).show(ui, |ui| {
        let is_cut = about.scene.clip.iter().any(|c| c.face == CutFace::Opaque);
        let has_faces = Surfaces::of(about.scene).has_hull() || show.faults.are_shown() || is_cut;
        let mut has_edges = Surfaces::of(about.scene).cell_edges;
        let edges = egui::Checkbox::new(&mut has_edges, "Edges of cells");
        let what = "On hull, fault surfaces and opaque sections";
        ui.add_enabled(has_faces, edges)
            .on_hover_text(what)
            .on_disabled_hover_text("There are none: show the hull, fault surfaces or an opaque section");
        if has_edges != Surfaces::of(about.scene).cell_edges {
            show.cell_edges = Some(has_edges);
        }
        ui.end_row();
        let mut faults = show.faults.are_shown();
        let switch = ui.checkbox(&mut faults, "Fault surfaces");
        if switch.on_hover_text("Half-transparent surfaces, one color per name in FAULTS; rest the pointer on one to read its throw").changed() {
            show.faults = ShownFaults::All(faults);
        }
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
        let has_wells = !about.case.about.wells.is_empty();
        let mut wells = show.wells.are_shown();
        let switch = egui::Checkbox::new(&mut wells, "Wells");
        let switch = ui.add_enabled(has_wells, switch)
            .on_hover_text("Tubes along the paths of wells, or through the cells that they are connected to: green for producers, blue for water injectors, orange for gas injectors, purple where only the path is known, gray where nothing flows")
            .on_disabled_hover_text("The files name no wells");
        if switch.changed() {
            show.wells = ShownWells::All(wells);
        }
        ui.end_row();
        background(ui, about, actions);
        ui.end_row();
    });
    units(ui, about, actions);
    if show != about.scene.show {
        actions.push(Action::Show(show));
    }
}

/// The units of all numbers that are shown and typed.
fn units(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let current = about.scene.units;
    let what = "Units of all numbers shown and typed; colors, filters and cameras stay as they are";
    list(ui, "Units", what, current.describe(), |ui| {
        for units in Units::ALL {
            if ui
                .selectable_label(units == current, units.describe())
                .clicked()
            {
                actions.push(Action::Units(units));
            }
        }
    });
}

/// The outer faces of what is drawn; of opaque cells they are the image.
fn hull(ui: &mut Ui, about: &PanelContext<'_>, show: &mut Show) {
    let choices = [
        (Hull::Hidden, "None", "Only the inside is drawn"),
        (
            Hull::Faint,
            "Faint",
            "A faint gray outline of the drawn cells around the inside",
        ),
        (
            Hull::Opaque,
            "Opaque",
            "The outer faces of the drawn cells, in the property's colors",
        ),
    ];
    let is_volume = about.scene.mode == Mode::Volume;
    ui.add_enabled_ui(is_volume, |ui| {
        if let Some(chosen) = one_of(ui, "Hull", show.hull, &choices) {
            show.hull = chosen;
        }
    })
    .response
    .on_disabled_hover_text("In the mode Cells the outer faces are always drawn");
}

/// The background of the image.
fn background(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let Some(color) = parse_color(&about.scene.background) else {
        return;
    };
    let mut rgb = color.map(|v| (255.0 * v).round() as u8);
    ui.horizontal(|ui| {
        let button = ui.color_edit_button_srgb(&mut rgb);
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ColorWell, true, "Background"));
        let is_changed = button.on_hover_text("Color behind the model").changed();
        ui.label("Background");
        if is_changed {
            let [r, g, b] = rgb;
            actions.push(Action::Background(format!("#{r:02x}{g:02x}{b:02x}")));
        }
    });
}

fn connections(ui: &mut Ui, about: &PanelContext<'_>, show: &mut Show) {
    let count = about.case.about.nnc;
    let button = egui::Checkbox::new(&mut show.nnc, "NNC");
    ui.add_enabled(count > 0, button).on_hover_text(format!(
        "Lines between the cells of the {count} non-neighbor connections"
    ));
}
