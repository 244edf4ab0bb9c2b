//! Curves over time below the picture: summary vectors, and properties of the selected cells.

use eframe::egui::{self, ScrollArea, Ui};
use egui_plot::{Line, Points, VLine};

use super::PanelContext;
use super::controls::significant;
use super::over_time::{TimeAxis, keep_pointed, nearest_step, pointed_before, touched};
use super::{vector_list, vector_plots};
use crate::case::Measure;
use crate::viewer::action::Action;
use crate::viewer::keys::Command;
use crate::viewer::marks;
use crate::viewer::reader::{Curves, TimeCurve};
use crate::viewer::state::CurvePlots;

/// Points of a plot, at least.
const LEAST: [f32; 2] = [330.0, 110.0];
/// Points of what is written above and below a plot.
const TEXTS: f32 = 66.0;

/// A plot of its own.
enum TimePlot<'a> {
    Vectors(vector_plots::UnitPlot<'a>),
    Cells(&'a TimeCurve),
}

/// Draws the curves, and which ones there are; what was asked for beside changes.
pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) -> Option<Command> {
    let mut asked = None;
    ui.horizontal_wrapped(|ui| {
        let close = ui
            .small_button("×")
            .on_hover_text("Hides the curves (Ctrl + G)");
        close
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Hide the curves"));
        if close.clicked() {
            actions.push(Action::Curves(CurvePlots {
                is_open: false,
                ..about.state.curves.clone()
            }));
        }
        properties(ui, about, actions);
        vector_list::menu(ui, about, actions);
        asked = save(ui, about);
        let shown = about.picture.map(|p| p.view.shown.step);
        let pointed = pointed_before(ui).and_then(|days| nearest_step(about.case, days));
        if let Some(step) = pointed.or(shown).and_then(|n| about.case.steps.get(n)) {
            ui.label(format!("{}   day {}", step.date, significant(step.days)));
        }
    });
    let vectors = about.vectors.and_then(|v| v.vectors.as_ref().ok());
    let axis = TimeAxis::of(about.case, vectors.map(|v| &**v));
    let of_cells = about.curves.map_or(&[][..], |c| &c.curves);
    let plots = vector_plots::grouped(about).into_iter();
    let plots = plots.map(TimePlot::Vectors);
    let plots: Vec<_> = plots.chain(of_cells.iter().map(TimePlot::Cells)).collect();
    if plots.is_empty() {
        ui.weak(match about.case.about.summary.is_empty() {
            true => "Select cells to see their curves.",
            false => "Select cells or a well to see their curves, or choose summary vectors.",
        });
        return asked;
    }
    let columns = ((ui.available_width() / LEAST[0]) as usize).clamp(1, plots.len());
    let rows = plots.len().div_ceil(columns) as f32;
    let height = (ui.available_height() / rows - TEXTS).max(LEAST[1]);
    let mut pointed = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for row in plots.chunks(columns) {
            ui.columns(columns, |places| {
                for (ui, plot) in places.iter_mut().zip(row) {
                    let at = match plot {
                        TimePlot::Vectors(plot) => {
                            vector_plots::show(ui, about, (axis, height), plot, actions)
                        }
                        TimePlot::Cells(curve) => {
                            self::curve(ui, about, (axis, height), curve, actions)
                        }
                    };
                    pointed = at.or(pointed);
                }
            });
        }
    });
    keep_pointed(ui, pointed);
    asked
}

/// Saves or copies the vectors that are shown.
fn save(ui: &mut Ui, about: &PanelContext<'_>) -> Option<Command> {
    let vectors = about.vectors.filter(|v| !v.curves.is_empty())?;
    let copy = ui
        .button("Copy")
        .on_hover_text("Copies the summary vectors shown as CSV: a row for each time");
    if copy.clicked()
        && let Ok(text) = vectors.csv(about.units())
    {
        ui.ctx().copy_text(text);
    }
    let save = ui
        .button("Save CSV ...")
        .on_hover_text("Saves the summary vectors shown: a row for each time (Ctrl + Shift + G)");
    save.clicked().then_some(Command::SaveVectors)
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
    menu.response
        .on_hover_text("Properties of the selected cells that are shown as curves");
}

/// The curves of a property; the place on the axis that the pointer is at.
fn curve(
    ui: &mut Ui,
    about: &PanelContext<'_>,
    (axis, height): (TimeAxis, f32),
    curve: &TimeCurve,
    actions: &mut Vec<Action>,
) -> Option<f64> {
    let case = about.case;
    let curves = about.curves?;
    ui.strong(&curve.property);
    if curve.points.iter().all(|p| p.len() < 2) {
        ui.weak(format!("{} does not change with time.", curve.property));
        return None;
    }
    let pointed = pointed_before(ui).and_then(|days| nearest_step(case, days));
    let ink = ui.visuals().weak_text_color();
    let days = |step: usize| case.steps.get(step).map_or(0.0, |s| s.days);
    let measure = about.measure(&curve.property);
    let place = |(step, value): &(usize, f32)| [days(*step), measure.show(f64::from(*value))];
    let shown = about.picture.map(|p| p.view.shown.step);
    let count = curves.of.cells.len();
    let plot = axis.plot(&curve.property, &measure.unit, height);
    let response = plot.show(ui, |plot| {
        for (n, points) in curve.points.iter().enumerate() {
            let points: Vec<_> = points.iter().map(place).collect();
            let name = curves
                .of
                .cells
                .get(n)
                .map_or_else(String::new, |c| case.grid.name_of(*c).to_string());
            plot.line(Line::new(name, points).color(marks::color(n, count)));
        }
        for step in shown.into_iter().chain(pointed) {
            plot.vline(VLine::new("", days(step)).color(ink));
        }
        let Some(pointed) = pointed else { return };
        for (n, points) in curve.points.iter().enumerate() {
            let at = points.iter().find(|(step, _)| *step == pointed);
            let at: Vec<_> = at.into_iter().map(place).collect();
            plot.points(
                Points::new("", at)
                    .radius(3.5)
                    .color(marks::color(n, count)),
            );
        }
    });
    values(ui, curves, curve, &measure, pointed.or(shown));
    touched(case, &response, actions)
}

/// The values of the cells at a step, each in the color of its curve.
fn values(ui: &mut Ui, curves: &Curves, curve: &TimeCurve, measure: &Measure, step: Option<usize>) {
    let count = curves.of.cells.len();
    ui.horizontal_wrapped(|ui| {
        for (n, (cell, points)) in curves.of.cells.iter().zip(&curve.points).enumerate() {
            let value = points.iter().find(|(at, _)| Some(*at) == step);
            let value = value.map_or("-".into(), |(_, v)| {
                significant(measure.show(f64::from(*v)))
            });
            let name = curves.of.case.grid.name_of(*cell);
            ui.colored_label(marks::color(n, count), format!("{name}: {value}"));
        }
    });
}
