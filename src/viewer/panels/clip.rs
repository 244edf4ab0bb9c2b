//! Clip planes: where they are, how they lean, what their sections look like. They can be moved in the
//! picture too.

use eframe::egui::{self, Ui};
use glam::DVec3;

use super::PanelContext;
use crate::case::Measure;
use crate::scene::{ClipSpec, CutFace};
use crate::view::View;
use crate::view::clip::MAX_CLIP_PLANES;
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let view = &picture.view;
    let length = about.world_length();
    let mut planes = about.scene.clip.clone();
    let mut removed = None;
    for (n, plane) in planes.iter_mut().enumerate() {
        ui.push_id(n, |ui| {
            ui.horizontal(|ui| {
                ui.strong(format!("Plane {}", n + 1));
                let flip = ui.button("Flip").on_hover_text("Keeps the other side");
                if flip.clicked() {
                    plane.normal = (-DVec3::from_array(plane.normal)).to_array();
                }
                let mut opaque = plane.face == CutFace::Opaque;
                ui.checkbox(&mut opaque, "Opaque")
                    .on_hover_text("Its section through the cells is opaque and colored");
                plane.face = if opaque {
                    CutFace::Opaque
                } else {
                    CutFace::Open
                };
                let remove = ui.button("Remove").on_hover_text("Removes the plane");
                if remove.clicked() {
                    removed = Some(n);
                }
            });
            lean(ui, view, &length, plane);
        });
    }
    if let Some(n) = removed {
        planes.remove(n);
    }
    add(ui, view, &mut planes);
    if planes.len() > 1 {
        let button = ui.button("Remove all");
        if button
            .on_hover_text("Shows the whole model again")
            .clicked()
        {
            planes.clear();
        }
    }
    if planes != about.scene.clip {
        actions.push(Action::Clip(planes));
    }
}

/// Direction and place of a plane.
fn lean(ui: &mut Ui, view: &View, length: &Measure, plane: &mut ClipSpec) {
    let normal = DVec3::from_array(plane.normal).normalize_or(DVec3::X);
    let mut azimuth = normal.x.atan2(normal.y).to_degrees().rem_euclid(360.0);
    // Without a negative zero.
    let mut dip = normal.z.clamp(-1.0, 1.0).asin().to_degrees() + 0.0;
    let middle = middle(view);
    let reach = 0.5 * view.world.bounds[0].distance(view.world.bounds[1]);
    let reach = length.show(reach);
    let mut offset = length.show((DVec3::from_array(plane.point) - middle).dot(normal));
    ui.horizontal(|ui| {
        let before = (azimuth, dip, offset);
        for (value, range, suffix, what) in [
            (
                &mut azimuth,
                0.0..=360.0,
                "°",
                "Compass direction of the side that is kept",
            ),
            (
                &mut dip,
                -90.0..=90.0,
                "°",
                "How far it looks up; 90 keeps what is above",
            ),
        ] {
            let drag = egui::DragValue::new(value).range(range).suffix(suffix);
            ui.add(drag.max_decimals(1)).on_hover_text(what);
        }
        let drag = egui::DragValue::new(&mut offset)
            .speed(0.002 * reach)
            .range(-reach..=reach)
            .max_decimals(2);
        ui.add(drag).on_hover_text(
            format!("Distance from the model's middle, {}", length.unit)
                .trim_end_matches([',', ' ']),
        );
        if before != (azimuth, dip, offset) {
            let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
            let (sin_d, cos_d) = dip.to_radians().sin_cos();
            let normal = DVec3::new(sin_a * cos_d, cos_a * cos_d, sin_d);
            plane.normal = normal.to_array();
            plane.point = (middle + length.read(offset) * normal).to_array();
        }
    });
}

fn middle(view: &View) -> DVec3 {
    0.5 * (view.world.bounds[0] + view.world.bounds[1])
}

/// Buttons for new planes.
fn add(ui: &mut Ui, view: &View, planes: &mut Vec<ClipSpec>) {
    let new = |point: DVec3, normal: DVec3| ClipSpec {
        point: point.to_array(),
        normal: normal.to_array(),
        face: CutFace::Open,
    };
    ui.horizontal_wrapped(|ui| {
        ui.label("Add");
        let room = MAX_CLIP_PLANES - planes.len().min(MAX_CLIP_PLANES);
        for (name, normal, what) in [
            ("East", DVec3::X, "Keeps what is east of the middle"),
            ("North", DVec3::Y, "Keeps what is north of the middle"),
            ("Below", -DVec3::Z, "Keeps what is below the middle"),
            (
                "View",
                view.camera.forward,
                "Keeps what is behind the middle as seen from here",
            ),
        ] {
            let button = ui.add_enabled(room > 0, egui::Button::new(name));
            if button.on_hover_text(what).clicked() {
                planes.push(new(middle(view), normal));
            }
        }
        let button = ui.add_enabled(room >= 6, egui::Button::new("Box"));
        let what = "Six planes around the inner half of the model";
        if button.on_hover_text(what).clicked() {
            let [low, high] = view.world.bounds;
            let inner = [low + 0.2 * (high - low), high - 0.2 * (high - low)];
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                planes.push(new(inner[0], axis));
                planes.push(new(inner[1], -axis));
            }
        }
    });
}
