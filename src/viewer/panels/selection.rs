//! The selected cells: where they are, what the case says of them, what can be done with them.

use eframe::egui::{self, Ui};

use super::cells::clear;
use super::controls::significant;
use super::{PanelContext, table, values};
use crate::case::{Case, Units};
use crate::model::Ijk;
use crate::picking::{Fault, Hit, Part, Pick};
use crate::picture::Lengths;
use crate::scene::{Filter, PropertyFilter, ScaleSpec};
use crate::view::wells::Head;
use crate::viewer::action::{Action, Beside};
use crate::viewer::reader::Table;
use crate::viewer::state::CurvePlots;

/// The same on a log scale, as a factor.
const ALIKE_FACTOR: f64 = 1.25;
/// Half of the part of the color range within which values are alike.
const ALIKE: f64 = 0.025;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let selected = &about.state.selected;
    let Some(last) = selected.last() else {
        ui.weak("Click a cell in the picture; Ctrl adds more.");
        go_to(ui, about, actions);
        return;
    };
    if let Some(pick) = about.pick {
        let hit = pick.hit.as_ref();
        // What was seen there holds for the step and property of the click.
        let view = about.picture.map(|p| &p.view);
        let is_shown =
            view.is_some_and(|v| v.shown.step == pick.step && v.shown.property == pick.property);
        if let Some(hit) = hit.filter(|h| is_shown && h.ijk.one_based() == *last) {
            ui.label(about.lengths().place(hit.map.to_array()));
            ui.label(seen(pick, hit, about.case, about.units()));
        }
        if let Some(cell) = about.case.grid.dims().one_based(*last) {
            along_ray(ui, pick, cell, actions);
        }
    }
    go_to(ui, about, actions);
    if let Some(table) = about.table {
        values::show(ui, table, about.property(), about.units());
        buttons(ui, about, table, actions);
    }
}

/// What of the cell is seen: the value at the place where it differs from the cell's own, and how much of the
/// pixel it is.
fn seen(pick: &Pick, hit: &Hit, case: &Case, units: Units) -> String {
    let mut lines = Vec::new();
    match &hit.part {
        Part::Inside => {}
        Part::Section => lines.push("On a clip plane".into()),
        Part::Face(_) => lines.push("Outer face".into()),
        Part::Fault(fault) => lines.push(of_fault(fault, case, units)),
    }
    lines.extend(between_cells(pick, hit, case, units));
    let share = 100.0 * hit.contribution;
    lines.push(format!("{share:.0} % of this pixel"));
    lines.join("\n")
}

/// The value at the place, where it is another one than the cell's: interpolated between cells.
fn between_cells(pick: &Pick, hit: &Hit, case: &Case, units: Units) -> Option<String> {
    let shown = value(&pick.property, hit.shown, case, units);
    let is_between = hit.is_between;
    is_between.then(|| format!("{shown} at this point (interpolated)"))
}

/// A value with its property's name and unit.
fn value(property: &str, value: f64, case: &Case, units: Units) -> String {
    let measure = case.measure(property, units);
    let value = significant(measure.show(value));
    let text = format!("{property} {value} {}", measure.unit);
    text.trim_end().to_owned()
}

/// A fault with its throw, and the cells on its near and far side.
fn of_fault(fault: &Fault, case: &Case, units: Units) -> String {
    let length = Lengths::of(case, units).grid;
    let [near, far] = [fault.near, fault.far].map(|cell| case.grid.cell_name(cell));
    format!(
        "{}\nBetween {near} and, beyond it, {far}",
        fault.in_words(&length)
    )
}

/// What is seen where the pointer rests, in words; `None` where nothing is.
pub fn hover_text(pick: &Pick, case: &Case, units: Units) -> Option<String> {
    let mut lines = Vec::new();
    lines.extend(pick.well.as_ref().map(Head::in_words));
    if let Some(hit) = &pick.hit {
        let cell = case.grid.cell_name(hit.ijk);
        let value = value(&pick.property, hit.value, case, units);
        lines.push(format!("{cell}   {value}"));
        lines.extend(between_cells(pick, hit, case, units));
    }
    let fault = pick.fault.as_ref();
    lines.extend(fault.map(|fault| of_fault(fault, case, units)));
    (!lines.is_empty()).then(|| lines.join("\n"))
}

/// How many cells lie before and behind one on the ray of the last click, and steps to them.
fn along_ray(ui: &mut Ui, pick: &Pick, cell: Ijk, actions: &mut Vec<Action>) {
    let Some([before, behind]) = pick.around(cell) else {
        return;
    };
    ui.horizontal(|ui| {
        for (by, name, what) in [
            (-1, "<", "Cell in front, along the line of sight (,)"),
            (1, ">", "Cell behind, along the line of sight (.)"),
        ] {
            let next = pick.beside(cell, by);
            let button = ui.add_enabled(next.is_some(), egui::Button::new(name));
            button.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, next.is_some(), what)
            });
            if let Some(next) = next.filter(|_| button.on_hover_text(what).clicked()) {
                actions.push(Action::Select(next.one_based(), Beside::AllButLast));
            }
        }
        let cells = if before == 1 { "cell" } else { "cells" };
        ui.label(format!("{before} {cells} in front, {behind} behind"));
    });
}

/// I, J and K from 1 of the cell selected last; of one in a local grid those of the main grid's cell that it lies in.
fn last_of_main(about: &PanelContext<'_>) -> Option<[usize; 3]> {
    let grid = &about.case.grid;
    let last = grid.dims().one_based(*about.state.selected.last()?)?;
    Some(grid.main_cell(last).one_based())
}

/// A cell of the main grid by its numbers.
fn go_to(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let grid = &about.case.grid;
    let dims = grid.main_dims();
    let id = ui.scope_id().with("cell");
    let start = last_of_main(about).unwrap_or([1; 3]);
    // What was typed counts until another cell is selected.
    let typed: Option<([usize; 3], [usize; 3])> = ui.data(|d| d.get_temp(id));
    let typed = typed.filter(|(of, _)| *of == start);
    let mut cell = typed.map_or(start, |(_, cell)| cell);
    ui.horizontal(|ui| {
        let axes = [("I", dims.ni), ("J", dims.nj), ("K", dims.nk)];
        for (value, (name, count)) in cell.iter_mut().zip(axes) {
            let drag = egui::DragValue::new(value)
                .range(1..=count)
                .prefix(format!("{name} "));
            ui.add(drag).on_hover_text(format!("{name}, 1 to {count}"));
        }
        let select = ui
            .button("Select")
            .on_hover_text("Adds this cell to the selection");
        if select.clicked() {
            let place = dims.one_based(cell).and_then(|c| grid.in_lattice(0, c));
            let place = place.map_or(cell, |place| place.one_based());
            actions.push(Action::Select(place, Beside::Others));
        }
    });
    ui.data_mut(|d| d.insert_temp(id, (start, cell)));
}

fn buttons(ui: &mut Ui, about: &PanelContext<'_>, table: &Table, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        let curves = ui
            .button("Curves ...")
            .on_hover_text("Properties of these cells over time, below the picture");
        if curves.clicked() {
            actions.push(Action::Curves(CurvePlots {
                is_open: true,
                ..about.state.curves.clone()
            }));
        }
        let copy = ui.button("Copy").on_hover_text("Copies a table with one row per cell, step and property as CSV; Ctrl + Shift + S saves it");
        if copy.clicked()
            && let Ok(text) = table::csv(table, about.curves, about.units())
        {
            ui.ctx().copy_text(text);
        }
        let clear = ui.button("Clear").on_hover_text("Deselects all cells");
        if clear.clicked() {
            actions.push(Action::Deselect);
        }
        // A difference of two cases is a property of neither, so that neither can be filtered by it.
        let mut minus = about.case.minus.iter();
        let can = minus.all(|m| Some(m.name.as_str()) != about.property());
        let alike = ui.add_enabled(can, egui::Button::new("Filter to similar values"));
        let what = "Draws only cells whose value of the property shown is close to that of the last selected cell";
        let refusal = "Not for a difference of two cases; filter by a property of one of them";
        if alike
            .on_hover_text(what)
            .on_disabled_hover_text(refusal)
            .clicked()
            && let Some(filter) = like(about)
        {
            actions.push(Action::Filter(filter));
        }
    });
    ui.horizontal(|ui| {
        ui.label("Isolate");
        let Some([i, j, k]) = last_of_main(about) else {
            return;
        };
        let filter = &about.scene.filter;
        for (name, wanted) in [
            (
                "I",
                Filter {
                    i: Some([i, i].into()),
                    ..filter.clone()
                },
            ),
            (
                "J",
                Filter {
                    j: Some([j, j].into()),
                    ..filter.clone()
                },
            ),
            (
                "K",
                Filter {
                    k: Some([k, k].into()),
                    ..filter.clone()
                },
            ),
        ] {
            let what =
                format!("Draws only the cells with the same {name} as the last selected one");
            if ui.button(name).on_hover_text(what).clicked() {
                actions.push(Action::Filter(wanted));
            }
        }
        let mut kept = filter.clone();
        clear(ui, &mut kept);
        if kept != *filter {
            actions.push(Action::Filter(kept));
        }
    });
}

/// The filter that keeps values like the last cell's: the same where they are whole numbers, else those
/// within a part of the color range.
fn like(about: &PanelContext<'_>) -> Option<Filter> {
    let picture = about.picture?;
    let name = &picture.view.shown.property;
    let grid = &about.case.grid;
    let cell = grid.dims().one_based(*about.state.selected.last()?)?;
    let field = about.case.field(name, picture.view.shown.step).ok()?;
    let value = f64::from(field.value(grid, grid.dims().cell(cell))?);
    let are_whole = field
        .values()
        .iter()
        .all(|v| v.is_nan() || v.fract() == 0.0);
    let range = field.statistics()?;
    let is_log = about.scene.transfer.scale == ScaleSpec::Log && value > 0.0;
    let [min, max] = if are_whole {
        [value; 2]
    } else if is_log {
        // By factors, as the colors go.
        [value / ALIKE_FACTOR, value * ALIKE_FACTOR]
    } else {
        let reach = ALIKE * (range.max - range.min);
        [
            (value - reach).max(range.min),
            (value + reach).min(range.max),
        ]
    };
    let mut filter = about.scene.filter.clone();
    filter.properties.retain(|p| p.name != *name);
    filter.properties.push(PropertyFilter {
        min: Some(min),
        max: Some(max),
        ..PropertyFilter::open(name)
    });
    Some(filter)
}
