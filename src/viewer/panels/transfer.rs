//! The transfer function: scale, colors, and the opacity curve with curves to begin from.

use eframe::egui::{Rect, Ui, vec2};

use super::controls::{list, number, one_of};
use super::{PanelContext, curve};
use crate::model::derivatives;
use crate::scene::transfer::BANDS;
use crate::scene::{ColorSpec, Coloring, OpacitySpec, RangeSpec, ScaleSpec, TransferSpec};
use crate::transfer::function::color_at;
use crate::transfer::{boundaries, presets};
use crate::view::look::look_of;
use crate::viewer::action::Action;
use crate::viewer::overlay;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let before = &about.scene.transfer;
    let mut spec = before.clone();
    let mut points: Vec<[f64; 2]> = match &spec.opacity {
        Some(OpacitySpec::Points(points)) => points.clone(),
        _ => {
            let shown = picture.view.style.transfer.opacity.iter();
            shown.map(|p| [p.0, p.1]).collect()
        }
    };
    let measure = about.measure(&picture.view.shown.property);
    if curve::show(ui, &picture.view, &measure, &mut points) {
        spec.opacity = Some(OpacitySpec::Points(points));
        // Points that were found refer to the length that was found with them.
        let length = picture.view.style.transfer.reference_length;
        spec.reference_length.get_or_insert(length);
    }
    opacities(ui, about, &mut spec);
    scale(ui, &mut spec, about.scene.range, actions);
    coloring(ui, &mut spec);
    color_maps(ui, &mut spec);
    let reset = ui.button("Reset");
    let what = "Scale, colors and opacity that suit the kind of property shown";
    if reset.on_hover_text(what).clicked() {
        spec = look_of(about.case, &picture.view.shown.property).transfer;
    }
    if spec != *before {
        actions.push(Action::Transfer(spec));
    }
}

/// A curve to begin from: its name, what it shows, its points.
type Preset = (&'static str, &'static str, &'static [[f64; 2]]);

const PRESETS: [Preset; 5] = [
    (
        "Ramp",
        "The higher the value, the more opaque",
        &[[0.0, 0.02], [0.5, 0.1], [1.0, 0.5]],
    ),
    (
        "Peak",
        "A narrow band of values, to be moved; the rest is faint",
        &[
            [0.0, 0.005],
            [0.42, 0.005],
            [0.5, 0.8],
            [0.58, 0.005],
            [1.0, 0.005],
        ],
    ),
    ("Uniform", "All values alike", &[[0.0, 0.15], [1.0, 0.15]]),
    (
        "Highest only",
        "The highest fifth of the values shown",
        &[[0.0, 0.0], [0.78, 0.0], [0.82, 0.4], [1.0, 0.6]],
    ),
    (
        "Lowest only",
        "The lowest fifth of the values shown",
        &[[0.0, 0.6], [0.18, 0.4], [0.22, 0.0], [1.0, 0.0]],
    ),
];

fn opacities(ui: &mut Ui, about: &PanelContext<'_>, spec: &mut TransferSpec) {
    ui.horizontal_wrapped(|ui| {
        ui.label("Opacity");
        for (name, what, points) in PRESETS {
            if ui.button(name).on_hover_text(what).clicked() {
                spec.opacity = Some(OpacitySpec::Points(over(extent(about), points)));
            }
        }
        let what = "The values looked for are solid and the rest is a haze; found from the values shown";
        if ui.button("Automatic").on_hover_text(what).clicked() {
            spec.opacity = Some(OpacitySpec::AUTOMATIC);
            spec.reference_length = None;
        }
        let found = ui.button("Boundaries");
        let what = "Peaks where values change most from cell to cell at the step shown; a ramp where they change evenly";
        if found.on_hover_text(what).clicked() {
            let points = found_in(about).unwrap_or_else(|| PRESETS[0].2.to_vec());
            spec.opacity = Some(OpacitySpec::Points(points));
        }
    });
}

/// Positions of the smallest and largest value of the step shown.
fn extent(about: &PanelContext<'_>) -> [f64; 2] {
    let view = about.picture.map(|p| &p.view);
    let found = view.and_then(|v| Some((v.shown.cells.value_range()?, &v.style.transfer)));
    found.map_or([0.0, 1.0], |(ends, transfer)| {
        ends.map(|v| transfer.position(v))
    })
}

/// A curve over a part of the range, even on both sides of it.
fn over([low, high]: [f64; 2], curve: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return Vec::new();
    };
    let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
    let place = |[at, opacity]: &[f64; 2]| [low + at * (high - low), *opacity];
    let before = (low > 0.0).then_some([0.0, first[1]]);
    let behind = (high < 1.0).then_some([1.0, last[1]]);
    let curve = curve.iter().map(place);
    before.into_iter().chain(curve).chain(behind).collect()
}

/// Peaks at the boundaries in what is shown.
fn found_in(about: &PanelContext<'_>) -> Option<Vec<[f64; 2]>> {
    let view = &about.picture?.view;
    let samples = derivatives::samples(
        &about.case.grid,
        &view.shown.cells.field,
        view.shown.cells.valued(),
    );
    let found = boundaries::find(&samples);
    let curve = boundaries::curve(&found, view.style.transfer.range)?;
    Some(
        curve
            .into_iter()
            .map(|(at, opacity)| [at, opacity])
            .collect(),
    )
}

fn scale(ui: &mut Ui, spec: &mut TransferSpec, range: RangeSpec, actions: &mut Vec<Action>) {
    let choices = [
        (ScaleSpec::Linear, "Linear", "Colors follow the values"),
        (
            ScaleSpec::Log,
            "Log",
            "Colors follow the logarithms of the values; those at or below 0 have the lowest color",
        ),
    ];
    if let Some(chosen) = one_of(ui, "Scale", spec.scale, &choices) {
        spec.scale = chosen;
        if chosen == ScaleSpec::Log && matches!(range, RangeSpec::Fixed([low, _]) if low <= 0.0) {
            // Of no use where logarithms count: the step's own positive values are.
            actions.push(Action::Range(RangeSpec::STEP));
        }
        if chosen == ScaleSpec::Log && spec.coloring == Coloring::Categories {
            spec.coloring = Coloring::Continuous;
        }
    }
}

fn coloring(ui: &mut Ui, spec: &mut TransferSpec) {
    let choices = [
        (Coloring::Continuous, "Continuous", "Smooth color gradient"),
        (
            Coloring::Banded,
            "Bands",
            "One color for each of equal parts of the range",
        ),
        (
            Coloring::Categories,
            "Categories",
            "One color for each whole number, as of regions or rock types",
        ),
    ];
    if let Some(chosen) = one_of(ui, "Colors", spec.coloring, &choices) {
        spec.coloring = chosen;
        if chosen == Coloring::Categories {
            spec.scale = ScaleSpec::Linear;
            // A curve over values says nothing of categories.
            spec.opacity = None;
        }
    }
    if spec.coloring == Coloring::Banded {
        let [least, most] = BANDS.map(|n| n as f64);
        let mut bands = spec.bands as f64;
        ui.horizontal(|ui| {
            ui.label("Number of bands");
            if number(ui, &mut bands, 0.1, "Number of bands", "2 to 64") {
                spec.bands = bands.round().clamp(least, most) as usize;
            }
        });
    }
}

/// The color maps, each with a picture of it.
fn color_maps(ui: &mut Ui, spec: &mut TransferSpec) {
    let current = match &spec.color {
        ColorSpec::Name(name) => name.clone(),
        ColorSpec::Points(_) => "custom".to_owned(),
    };
    let what = "Colors from the low to the high end of the range";
    list(ui, "Color map", what, &current, |ui| {
        for name in presets::NAMES {
            let width = ui.available_width().max(220.0);
            let button = eframe::egui::Button::selectable(current == name, name);
            let response = ui.add(button.min_size(vec2(width, 0.0)));
            if let Some(map) = presets::color_map(name) {
                let right = Rect::from_min_max(
                    response.rect.left_top() + vec2(80.0, 3.0),
                    response.rect.right_bottom() - vec2(4.0, 3.0),
                );
                overlay::color_bar(ui.painter(), right, |p| color_at(&map, p));
            }
            if response.clicked() {
                spec.color = ColorSpec::Name(name.into());
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::over;

    #[test]
    fn a_curve_lies_over_the_values_shown() {
        let curve = [[0.0, 0.0], [0.8, 0.0], [1.0, 0.6]];
        assert_eq!(over([0.0, 1.0], &curve), curve);
        let found = over([0.0, 0.5], &curve);
        assert_eq!(found, [[0.0, 0.0], [0.4, 0.0], [0.5, 0.6], [1.0, 0.6]]);
        let found = over([0.5, 1.0], &curve);
        assert_eq!(found[..2], [[0.0, 0.0], [0.5, 0.0]]);
        // One value is everywhere in the range.
        assert_eq!(over([0.3, 0.3], &curve), curve);
    }
}
