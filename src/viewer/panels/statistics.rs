//! What the last picture cost.

use std::time::Duration;

use eframe::egui::{self, Ui};

use super::About;
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &About<'_>, _actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let ms = |d: Duration| format!("{:.1} ms", 1e3 * d.as_secs_f64());
    let megabytes = picture.bytes.total() as f64 / f64::from(1 << 20);
    let light = picture.light;
    let rows = [
        (
            "Picture",
            format!("{} x {}", picture.rgb.size[0], picture.rgb.size[1]),
        ),
        ("Rays", ms(picture.stats.frame)),
        ("Preparation", ms(picture.prepare)),
        ("Light", ms(light.field + light.extinction + light.volumes)),
        ("Samples", picture.stats.samples.to_string()),
        ("On the GPU", format!("{megabytes:.1} MB")),
        ("Lost rays", picture.stats.lost_rays.to_string()),
    ];
    egui::Grid::new("statistics").striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            ui.label(value);
            ui.end_row();
        }
    });
}
