//! Summary vectors over time: a plot for each unit, measured values as points.

use eframe::egui::{Color32, Ui};
use egui_plot::{Line, Points, VLine};

use super::PanelContext;
use super::controls::significant;
use super::over_time::{TimeAxis, nearest, pointed_before, touched};
use crate::case::{Measure, Vectors};
use crate::viewer::action::Action;
use crate::viewer::marks;
use crate::viewer::vectors::VectorCurve;

/// Colors of oil, water and gas, where a plot has a curve of each at most.
const PHASES: [(u8, Color32); 3] = [
    (b'O', Color32::from_rgb(0, 158, 115)),
    (b'W', Color32::from_rgb(64, 140, 220)),
    (b'G', Color32::from_rgb(213, 94, 0)),
];

/// A vector, its color, and how its values are shown.
type PlottedCurve<'a> = (&'a VectorCurve, Color32, Measure);

/// Vectors that share an axis, each in its color.
pub struct UnitPlot<'a> {
    unit: String,
    vectors: &'a Vectors,
    curves: Vec<PlottedCurve<'a>>,
}

impl UnitPlot<'_> {
    /// The keywords of its vectors, each once.
    fn title(&self) -> String {
        let mut keywords: Vec<&str> = Vec::new();
        for (curve, ..) in &self.curves {
            let keyword = curve.vector.keyword.as_str();
            if !keywords.contains(&keyword) {
                keywords.push(keyword);
            }
        }
        keywords.join(", ")
    }
}

/// The vectors asked for by their units. Volumes and rates of gas are by themselves: they have the unit of liquids
/// and are much larger.
pub fn grouped<'a>(about: &PanelContext<'a>) -> Vec<UnitPlot<'a>> {
    let Some((of_case, Ok(vectors))) = about.vectors.map(|v| (v, &v.vectors)) else {
        return Vec::new();
    };
    let units = about.units();
    let key = |c: &'a VectorCurve| {
        let is_gas = phase(c) == Some(b'G') && !c.vector.unit.is_empty();
        (units.of_vector(&c.vector).unit, is_gas)
    };
    let mut groups: Vec<((String, bool), Vec<&VectorCurve>)> = Vec::new();
    for curve in &of_case.curves {
        match groups.iter_mut().find(|(known, _)| *known == key(curve)) {
            Some((_, curves)) => curves.push(curve),
            None => groups.push((key(curve), vec![curve])),
        }
    }
    let plot = |((unit, _), curves)| UnitPlot {
        unit,
        vectors,
        curves: colored(curves)
            .into_iter()
            .map(|(curve, color)| (curve, color, units.of_vector(&curve.vector)))
            .collect(),
    };
    groups.into_iter().map(plot).collect()
}

/// The letter of the phase that a vector is of.
fn phase(curve: &VectorCurve) -> Option<u8> {
    curve.vector.keyword.as_bytes().get(1).copied()
}

/// The name of a vector, of a measured one that of its computed twin, which has the same color.
fn computed_name(curve: &VectorCurve) -> String {
    let vector = &curve.vector;
    let keyword = match vector.is_history {
        true => vector.keyword.trim_end_matches('H'),
        false => &vector.keyword,
    };
    vector.name.replacen(&vector.keyword, keyword, 1)
}

/// Each curve with its color: of its phase where each phase is there once, else by their order.
fn colored(curves: Vec<&VectorCurve>) -> Vec<(&VectorCurve, Color32)> {
    let mut kinds: Vec<(String, Option<Color32>)> = Vec::new();
    for curve in &curves {
        let name = computed_name(curve);
        if !kinds.iter().any(|(known, _)| *known == name) {
            let of_phase = PHASES
                .iter()
                .find(|(letter, _)| phase(curve) == Some(*letter));
            kinds.push((name, of_phase.map(|p| p.1)));
        }
    }
    let count = |color| kinds.iter().filter(|(_, c)| *c == color).count();
    let by_phase = kinds.iter().all(|(_, c)| c.is_some() && count(*c) == 1);
    let color = |curve: &VectorCurve| {
        let name = computed_name(curve);
        let place = kinds.iter().position(|(known, _)| *known == name);
        let place = place.unwrap_or(0);
        let of_phase = kinds[place].1.filter(|_| by_phase);
        of_phase.unwrap_or_else(|| marks::color(place, kinds.len()))
    };
    curves.into_iter().map(|c| (c, color(c))).collect()
}

/// Draws a plot with the values at the pointer, or at the step shown; the place on the axis that the pointer is at.
pub fn show(
    ui: &mut Ui,
    about: &PanelContext<'_>,
    (axis, height): (TimeAxis, f32),
    plot: &UnitPlot<'_>,
    actions: &mut Vec<Action>,
) -> Option<f64> {
    let times = || plot.vectors.days.iter().map(|days| axis.of_vectors(*days));
    let at: Vec<f64> = times().collect();
    let step = about.picture.map(|p| p.view.shown.step);
    let step = step.and_then(|n| about.case.steps.get(n)).map(|s| s.days);
    let pointed = pointed_before(ui).and_then(|days| nearest(times(), days));
    let told = pointed.or(step.and_then(|days| nearest(times(), days)));
    let ink = ui.visuals().weak_text_color();
    ui.strong(plot.title());
    let first = plot.curves.first().map_or("", |(c, ..)| &c.vector.name);
    let response = axis.plot(first, &plot.unit, height).show(ui, |ui| {
        for (curve, color, measure) in &plot.curves {
            let values = at.iter().zip(&curve.values);
            let values = values.filter(|(_, v)| !v.is_nan());
            let points: Vec<_> = values
                .map(|(at, v)| [*at, measure.show(f64::from(*v))])
                .collect();
            let name = &curve.vector.name;
            match curve.vector.is_history {
                true => ui.points(Points::new(name, points).radius(2.0).color(*color)),
                false => ui.line(Line::new(name, points).color(*color)),
            }
        }
        let times = step.into_iter().chain(pointed.map(|n| at[n]));
        for time in times {
            ui.vline(VLine::new("", time).color(ink));
        }
        let Some(n) = pointed else { return };
        for (curve, color, measure) in &plot.curves {
            let value = curve.values.get(n).filter(|v| !v.is_nan());
            let value = value.map(|v| [at[n], measure.show(f64::from(*v))]);
            let value: Vec<_> = value.into_iter().collect();
            ui.points(Points::new("", value).radius(3.5).color(*color));
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak(told.map_or_else(String::new, |n| plot.vectors.date(n)));
        for (curve, color, measure) in &plot.curves {
            let value = told.and_then(|n| curve.values.get(n));
            let value = value.filter(|v| !v.is_nan());
            let value = value.map_or("-".into(), |v| significant(measure.show(f64::from(*v))));
            ui.colored_label(*color, format!("{}: {value}", curve.vector.name));
        }
    });
    touched(about.case, &response, actions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Vector, VectorKind};

    fn curve(keyword: &str, well: &str, is_history: bool) -> VectorCurve {
        VectorCurve {
            vector: Vector {
                name: format!("{keyword}:{well}"),
                keyword: keyword.into(),
                kind: VectorKind::Well,
                well: Some(well.into()),
                unit: "SM3/DAY".into(),
                is_history,
            },
            values: vec![1.0],
        }
    }

    #[test]
    fn phases_and_measured_twins_have_their_colors() {
        let [oil, water, measured] =
            [("WOPR", false), ("WWPR", false), ("WOPRH", true)].map(|(k, h)| curve(k, "P1", h));
        let other = curve("WOPR", "P2", false);
        let colors = |curves: Vec<&VectorCurve>| -> Vec<Color32> {
            colored(curves).into_iter().map(|c| c.1).collect()
        };
        assert_eq!(
            colors(vec![&oil, &water, &measured]),
            [PHASES[0].1, PHASES[1].1, PHASES[0].1]
        );
        // Two wells are told apart.
        let two = colors(vec![&oil, &measured, &other]);
        assert_eq!(two[0], two[1]);
        assert_ne!(two[0], two[2]);
    }
}
