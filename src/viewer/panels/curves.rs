//! Curves of the selected cells over time, in a window of their own.

use std::ops::RangeInclusive;

use eframe::egui::{self, Id, ScrollArea, Ui};
use egui_plot::{GridInput, GridMark, Line, Plot, PlotResponse, Points, VLine};

use super::PanelContext;
use super::controls::significant;
use super::dates::Calendar;
use super::values::named;
use crate::case::Case;
use crate::viewer::action::Action;
use crate::viewer::marks;
use crate::viewer::reader::{Curves, TimeCurve};
use crate::viewer::state::CurvePlots;

/// Points of a plot's height, at least.
const LEAST_HEIGHT: f32 = 130.0;
/// Months between marks of the axis, from dense to sparse, and about how many days that is.
const MARKS: [i64; 7] = [1, 3, 6, 12, 60, 120, 600];
const MONTH: f64 = 30.44;

/// Draws the curves, and which properties have some.
pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        properties(ui, about, actions);
        let step = pointed_before(ui).or(about.picture.map(|p| p.view.shown.step));
        if let Some(step) = step.and_then(|n| about.case.steps.get(n)) {
            ui.label(format!("{}   day {}", step.date, significant(step.days)));
        }
    });
    let Some(curves) = about.curves else {
        ui.weak("Select cells to see their curves.");
        return;
    };
    let count = curves.curves.len().max(1) as f32;
    let height = (ui.available_height() / count - 40.0).max(LEAST_HEIGHT);
    let mut pointed = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for curve in &curves.curves {
            pointed = self::curve(ui, about, curves, curve, height).or(pointed);
        }
    });
    ui.data_mut(|d| d.insert_temp(pointed_id(), pointed));
}

/// Where it is kept to which step the pointer points: all plots tell the values there.
fn pointed_id() -> Id {
    Id::unique("step that the pointer in the curves is at")
}

/// The step that the pointer pointed to in the frame before.
fn pointed_before(ui: &Ui) -> Option<usize> {
    ui.data(|d| d.get_temp::<Option<usize>>(pointed_id()))
        .flatten()
}

/// A list of the properties that change with time.
fn properties(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let chosen = &about.state.curves.properties;
    let mut choose = |properties| {
        actions.push(Action::Curves(CurvePlots {
            properties,
            ..about.state.curves.clone()
        }));
    };
    let shown = about.property();
    let text = match chosen.as_slice() {
        [] => format!("{} (as in the image)", shown.unwrap_or("-")),
        chosen => chosen.join(", "),
    };
    let menu = egui::ComboBox::from_id_salt("properties of the curves")
        .width(180.0)
        .truncate()
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .selected_text(text);
    let menu = menu.show_ui(ui, |ui| {
        if ui
            .selectable_label(chosen.is_empty(), "As in the image")
            .clicked()
        {
            choose(Vec::new());
        }
        let dynamic = about.case.properties.iter();
        for property in dynamic.filter(|p| about.case.is_dynamic(&p.name)) {
            let name = &property.name;
            let mut is_on = chosen.contains(name);
            if ui.checkbox(&mut is_on, name).changed() {
                let mut now = chosen.clone();
                now.retain(|n| n != name);
                now.extend(is_on.then(|| name.clone()));
                choose(now);
            }
        }
    });
    menu.response.on_hover_text("Properties shown as curves");
}

/// The curves of a property; the step that the pointer points to.
fn curve(
    ui: &mut Ui,
    about: &PanelContext<'_>,
    curves: &Curves,
    curve: &TimeCurve,
    height: f32,
) -> Option<usize> {
    let case = about.case;
    let name = format!("{} {}", curve.property, case.unit(&curve.property));
    ui.strong(name.trim_end());
    if curve.points.iter().all(|p| p.len() < 2) {
        ui.weak(format!("{} does not change with time.", curve.property));
        return None;
    }
    let pointed = pointed_before(ui);
    let ink = ui.visuals().weak_text_color();
    let days = |step: usize| case.steps.get(step).map_or(0.0, |s| s.days);
    let shown = about.picture.map(|p| p.view.shown.step);
    let response = plot(&curve.property, Calendar::of(&case.steps), height).show(ui, |plot| {
        for (n, points) in curve.points.iter().enumerate() {
            let points: Vec<_> = points
                .iter()
                .map(|(s, v)| [days(*s), f64::from(*v)])
                .collect();
            let name = curves
                .of
                .cells
                .get(n)
                .map_or_else(String::new, |c| named(*c));
            plot.line(Line::new(name, points).color(marks::color(n)));
        }
        for step in shown.into_iter().chain(pointed) {
            plot.vline(VLine::new("", days(step)).color(ink));
        }
        let Some(pointed) = pointed else { return };
        for (n, points) in curve.points.iter().enumerate() {
            let at = points.iter().find(|(step, _)| *step == pointed);
            let at: Vec<_> = at.iter().map(|(s, v)| [days(*s), f64::from(*v)]).collect();
            plot.points(Points::new("", at).radius(3.5).color(marks::color(n)));
        }
    });
    values(ui, curves, curve, pointed.or(shown));
    nearest(case, &response)
}

/// The values of the cells at a step, each in the color of its curve.
fn values(ui: &mut Ui, curves: &Curves, curve: &TimeCurve, step: Option<usize>) {
    ui.horizontal_wrapped(|ui| {
        for (n, (cell, points)) in curves.of.cells.iter().zip(&curve.points).enumerate() {
            let value = points.iter().find(|(at, _)| Some(*at) == step);
            let value = value.map_or("-".into(), |(_, v)| significant(f64::from(*v)));
            ui.colored_label(marks::color(n), format!("{}: {value}", named(*cell)));
        }
    });
}

/// The step that the pointer is nearest to.
fn nearest<R>(case: &Case, response: &PlotResponse<R>) -> Option<usize> {
    let at = response.response.hover_pos()?;
    let days = response.transform.value_from_position(at).x;
    let apart = |n: &usize| (case.steps[*n].days - days).abs();
    (0..case.steps.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)))
}

fn plot(property: &str, calendar: Option<Calendar>, height: f32) -> Plot<'static> {
    let text = move |days: f64| match calendar {
        Some(calendar) => calendar.date(days),
        None => format!("day {}", significant(days)),
    };
    let plot = Plot::new(("curves", property))
        .height(height)
        .allow_scroll(false)
        .link_axis(Id::unique("curves over time"), [true, false])
        .label_formatter(|_| None)
        .x_axis_formatter(move |mark: GridMark, _: &RangeInclusive<f64>| text(mark.value))
        .y_axis_formatter(|mark: GridMark, _: &RangeInclusive<f64>| significant(mark.value));
    match calendar {
        Some(calendar) => plot.x_grid_spacer(move |input| months(calendar, &input)),
        None => plot,
    }
}

/// Marks at the first of months or years: three thicknesses of them.
fn months(calendar: Calendar, input: &GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let first = MARKS
        .iter()
        .position(|m| *m as f64 * MONTH >= input.base_step_size);
    let from = first.unwrap_or(MARKS.len() - 1);
    let mut marks: Vec<GridMark> = Vec::new();
    for every in MARKS.iter().skip(from).take(3) {
        let step_size = *every as f64 * MONTH;
        for value in calendar.months([low, high], *every) {
            match marks.iter_mut().find(|m| m.value == value) {
                Some(known) => known.step_size = step_size,
                None => marks.push(GridMark { value, step_size }),
            }
        }
    }
    marks
}
