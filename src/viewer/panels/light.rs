//! Occlusion and lights.

use eframe::egui::{self, Ui};

use super::About;
use crate::scene::LightMode;
use crate::scene::LightingSpec;
use crate::scene::lighting::PRESETS;
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let current = &about.scene.lighting;
    ui.horizontal_wrapped(|ui| {
        for (name, what) in PRESETS {
            let Some(preset) = LightingSpec::preset(name) else {
                continue;
            };
            let label = ui.selectable_label(preset == *current, name);
            if label.on_hover_text(what).clicked() {
                actions.push(Action::Lighting(preset));
            }
        }
    });
    let mut lighting = current.clone();
    if let Some(occlusion) = &mut lighting.occlusion {
        ui.horizontal(|ui| {
            for (mode, name, what) in [
                (
                    LightMode::Preilluminated,
                    "Before rays",
                    "In a light volume, made anew as the camera moves",
                ),
                (
                    LightMode::Image,
                    "At samples",
                    "Exact to the method, several times slower",
                ),
            ] {
                if ui
                    .selectable_label(occlusion.mode == mode, name)
                    .on_hover_text(what)
                    .clicked()
                {
                    occlusion.mode = mode;
                }
            }
        });
        let angle = egui::Slider::new(&mut occlusion.half_angle_degrees, 1.0..=45.0);
        ui.add(angle.text("Half angle °"));
        let strength = egui::Slider::new(&mut occlusion.attenuation, 0.0..=2.0);
        ui.add(strength.text("Attenuation"));
        ui.horizontal(|ui| {
            ui.label("Parts");
            for splits in [1, 3, 7] {
                if ui
                    .selectable_label(occlusion.splits == splits, splits.to_string())
                    .clicked()
                {
                    occlusion.splits = splits;
                }
            }
        });
    }
    if lighting != *current {
        actions.push(Action::Lighting(lighting));
    }
}
