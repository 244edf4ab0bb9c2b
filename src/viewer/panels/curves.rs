//! Curves of the selected cells over time, and all that is known of them as text.

use std::fmt::Write;

use eframe::egui::Ui;
use egui_plot::{Line, Plot, VLine};

use super::About;
use super::selection::named;
use crate::viewer::marks;
use crate::viewer::reader::{Curves, Table};

/// Draws the curves.
pub fn show(ui: &mut Ui, about: &About<'_>, curves: &Curves) {
    if curves.points.iter().all(|p| p.len() < 2) {
        ui.weak(format!("{} does not change with time.", curves.property));
        return;
    }
    let unit = about.case.unit(&curves.property);
    ui.label(format!("{} {unit} over days", curves.property));
    let plot = Plot::new("curves").height(140.0).allow_scroll(false);
    let ui_ink = ui.visuals().weak_text_color();
    plot.show(ui, |plot| {
        let curves = curves.of.cells.iter().zip(&curves.points);
        for (n, (cell, points)) in curves.enumerate() {
            plot.line(Line::new(named(*cell), points.clone()).color(marks::color(n)));
        }
        let shown = about
            .picture
            .and_then(|p| about.case.steps.get(p.view.step));
        if let Some(step) = shown {
            let line = VLine::new("", step.days);
            plot.vline(line.color(ui_ink));
        }
    });
}

/// Values of the step, then curves, as comma-separated text with a heading each.
pub fn csv(table: &Table, curves: Option<&Curves>) -> String {
    let mut text = String::from("property,unit");
    let heads = |text: &mut String, cells: &[[usize; 3]]| {
        for [i, j, k] in cells {
            // Writing to a string cannot fail.
            let _ = write!(text, ",{i} {j} {k}");
        }
        text.push('\n');
    };
    heads(&mut text, &table.of.cells);
    for (name, unit, values) in &table.rows {
        let _ = write!(text, "{name},{unit}");
        for value in values {
            let _ = match value {
                Some(value) => write!(text, ",{value}"),
                None => write!(text, ","),
            };
        }
        text.push('\n');
    }
    if let Some(curves) = curves {
        let _ = write!(text, "\n{},days", curves.property);
        heads(&mut text, &curves.of.cells);
        let steps = &curves.of.case.steps;
        for step in steps {
            let _ = write!(text, "{},{}", step.date, step.days);
            for points in &curves.points {
                let value = points.iter().find(|p| p[0] == step.days);
                let _ = match value {
                    Some([_, value]) => write!(text, ",{value}"),
                    None => write!(text, ","),
                };
            }
            text.push('\n');
        }
    }
    text
}
