//! Occlusion and the key light.

use eframe::egui::{self, Ui};
use glam::DVec3;

use super::PanelContext;
use super::controls::{one_of, slider};
use crate::scene::lighting::{LightMethod, LightSpec, OcclusionSpec, PRESETS, ShadowSpec};
use crate::scene::{LightMode, LightingSpec};
use crate::viewer::action::Action;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
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
        let strength = egui::Slider::new(&mut occlusion.strength, 0.0..=1.0);
        let what = "How much of the darkening is applied";
        slider(ui, "Occlusion strength", what, strength);
    }
    key_light(ui, &mut lighting);
    if let Some(occlusion) = &mut lighting.occlusion {
        egui::CollapsingHeader::new("Occlusion settings")
            .show(ui, |ui| cone(ui, occlusion))
            .header_response
            .on_hover_text(
                "How occlusion is found: cones from each point toward the viewer, or to all sides",
            );
    }
    if lighting != *current {
        actions.push(Action::Lighting(lighting));
    }
}

/// The first light from far away: on or off, where it comes from, how bright it is.
fn key_light(ui: &mut Ui, lighting: &mut LightingSpec) {
    let is_key = |light: &LightSpec| matches!(light, LightSpec::Directional { .. });
    let mut is_on = lighting.lights.iter().any(is_key);
    let switch = ui.checkbox(&mut is_on, "Key light");
    let switch = switch.on_hover_text("A light from one side, with shadows and highlights");
    if switch.changed() {
        match is_on {
            true => {
                lighting.lights.insert(0, LightSpec::key());
                lighting.blinn_phong = true;
            }
            false => {
                lighting.lights.retain(|light| !is_key(light));
                lighting.blinn_phong &= !lighting.lights.is_empty();
            }
        }
        return;
    }
    let share = lighting.share_of_lights();
    let key = lighting.lights.iter_mut().find(|light| is_key(light));
    let Some(LightSpec::Directional {
        direction,
        intensity,
        ..
    }) = key
    else {
        return;
    };
    let [mut azimuth, mut elevation] = angles(*direction);
    let what = "Compass direction that the light comes from: 0 north, 90 east";
    let from = egui::Slider::new(&mut azimuth, 0.0..=360.0).suffix("°");
    let mut moved = slider(ui, "Light azimuth", what, from.fixed_decimals(0));
    let what = "Height of the light above the horizon; 90 is straight above";
    let from = egui::Slider::new(&mut elevation, -90.0..=90.0).suffix("°");
    moved |= slider(ui, "Light elevation", what, from.fixed_decimals(0));
    if moved {
        *direction = direction_of([azimuth, elevation]);
    }
    let mut strength = intensity.unwrap_or(share);
    let what = "Brightness of the light; occlusion shades the ambient light beside it";
    let of = egui::Slider::new(&mut strength, 0.0..=2.0);
    if slider(ui, "Light strength", what, of) {
        *intensity = Some(strength);
    }
    shadows(ui, &mut lighting.shadows);
}

/// Azimuth (degrees clockwise from north) and elevation that light comes from.
fn angles(direction: [f64; 3]) -> [f64; 2] {
    let toward = -DVec3::from_array(direction).normalize_or_zero();
    let azimuth = toward.x.atan2(toward.y).to_degrees().rem_euclid(360.0);
    [azimuth, toward.z.clamp(-1.0, 1.0).asin().to_degrees()]
}

/// Where light goes that comes from there.
fn direction_of([azimuth, elevation]: [f64; 2]) -> [f64; 3] {
    let [azimuth, elevation] = [azimuth, elevation].map(f64::to_radians);
    let level = elevation.cos();
    let toward = [
        level * azimuth.sin(),
        level * azimuth.cos(),
        elevation.sin(),
    ];
    // Six digits: a scene file is read by people.
    toward.map(|v| -(1e6 * v).round() / 1e6)
}

/// How occlusion is found.
fn cone(ui: &mut Ui, occlusion: &mut OcclusionSpec) {
    method(ui, occlusion);
    let what = "Factor on the extinction that occludes";
    let attenuation = egui::Slider::new(&mut occlusion.attenuation, 0.0..=2.0);
    slider(ui, "Attenuation", what, attenuation);
    let what = "How far it looks, as a part of the model's diagonal";
    let length = egui::Slider::new(&mut occlusion.length, 0.01..=1.0);
    slider(ui, "Reach", what, length.logarithmic(true));
    if !occlusion.method.is_around() {
        toward_viewer(ui, occlusion);
    }
}

/// Which way it looks.
fn method(ui: &mut Ui, occlusion: &mut OcclusionSpec) {
    let methods = LightMethod::ALL.map(|method| (method, title(method), method.describe()));
    if let Some(method) = one_of(ui, "Looks", occlusion.method, &methods) {
        occlusion.method = method;
        if method.is_around() {
            occlusion.mode = LightMode::Preilluminated;
        }
    }
}

/// What a method is called in lists.
fn title(method: LightMethod) -> &'static str {
    match method {
        LightMethod::Cones => "To the viewer",
        LightMethod::Surround => "To all sides",
        LightMethod::SpaoMipmap => "All sides, quick",
        LightMethod::Vct => "To the viewer, by values",
        LightMethod::Sat => "To the viewer, by boxes",
    }
}

/// How shadows of the lights are found.
fn shadows(ui: &mut Ui, shadows: &mut ShadowSpec) {
    let name = |method| match method {
        LightMethod::Vct => "By values",
        LightMethod::Sat => "By boxes",
        _ => "Cones",
    };
    let methods: Vec<_> = LightMethod::ALL
        .into_iter()
        .filter(|method| !method.is_around())
        .map(|method| (method, name(method), method.describe()))
        .collect();
    if let Some(method) = one_of(ui, "Shadows", shadows.method, &methods) {
        shadows.method = method;
    }
}

fn toward_viewer(ui: &mut Ui, occlusion: &mut OcclusionSpec) {
    let modes = [
        (
            LightMode::Preilluminated,
            "Light volume",
            "Precomputed; recomputed when the camera moves",
        ),
        (
            LightMode::Image,
            "Every sample",
            "A cone at every sample: more exact, several times slower",
        ),
    ];
    if let Some(mode) = one_of(ui, "Found in", occlusion.mode, &modes) {
        occlusion.mode = mode;
    }
    let what = "Wider cones look at more of the surroundings";
    let angle = egui::Slider::new(&mut occlusion.half_angle_degrees, 1.0..=45.0);
    slider(ui, "Cone half angle", what, angle.suffix("°"));
    if occlusion.method != LightMethod::Cones {
        return;
    }
    let splits = [
        (1, "1", "Fastest"),
        (3, "3", "Between"),
        (7, "7", "Closest to the truth"),
    ];
    if let Some(splits) = one_of(ui, "Cones per direction", occlusion.splits, &splits) {
        occlusion.splits = splits;
    }
}

#[cfg(test)]
mod tests {
    use super::{angles, direction_of};

    #[test]
    fn light_comes_from_where_the_sliders_say() {
        // From the north, from the east, from above.
        for (from, direction) in [
            ([0.0, 0.0], [0.0, -1.0, 0.0]),
            ([90.0, 0.0], [-1.0, 0.0, 0.0]),
            ([0.0, 90.0], [0.0, 0.0, -1.0]),
        ] {
            assert_eq!(direction_of(from).map(|v| v + 0.0), direction);
        }
        let [azimuth, elevation] = angles(direction_of([301.0, 53.0]));
        assert!((azimuth - 301.0).abs() < 1e-3 && (elevation - 53.0).abs() < 1e-3);
    }
}
