//! What the values of the drawn cells are like, and what the last picture cost.

use std::sync::{Arc, Weak};
use std::time::Duration;

use eframe::egui::{self, Ui};

use super::PanelContext;
use super::controls::significant;
use crate::model::{CellField, Summary};
use crate::view::View;
use crate::viewer::action::Action;
use crate::viewer::job::Picture;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, _actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    values(ui, about, picture);
    let ms = |d: Duration| format!("{:.1} ms", 1e3 * d.as_secs_f64());
    let megabytes = picture.bytes.total() as f64 / f64::from(1 << 20);
    let light = picture.light;
    let rows = [
        (
            "Image",
            format!("{} x {}", picture.rgb.size[0], picture.rgb.size[1]),
        ),
        ("Rays", ms(picture.stats.frame)),
        ("Preparation", ms(picture.prepare)),
        ("Light", ms(light.field + light.extinction + light.volumes)),
        ("Samples", picture.stats.samples.to_string()),
        ("On the device", format!("{megabytes:.1} MB")),
        ("Lost rays", picture.stats.lost_rays.to_string()),
        ("Lost samples", picture.stats.lost_samples.to_string()),
    ];
    egui::Grid::new("statistics").striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            ui.label(value);
            ui.end_row();
        }
    });
}

/// Values and cells that a summary is of; they may be gone.
type Counted = (Weak<CellField>, Weak<Vec<bool>>);

/// Values of the drawn cells at the step shown.
fn values(ui: &mut Ui, about: &PanelContext<'_>, picture: &Picture) {
    let view = &picture.view;
    // Counted again only where values or cells are others.
    let of = (
        Arc::downgrade(&view.shown.cells.field),
        Arc::downgrade(&view.shown.cells.drawn),
    );
    let id = ui.scope_id().with("summary");
    let known: Option<(Counted, Option<Summary>)> = ui.data(|d| d.get_temp(id));
    let is_same = |known: &Counted| known.0.ptr_eq(&of.0) && known.1.ptr_eq(&of.1);
    let summary = match known.filter(|(known, _)| is_same(known)) {
        Some((_, summary)) => summary,
        None => {
            let summary = summary(about, view);
            ui.data_mut(|d| d.insert_temp(id, (of, summary)));
            summary
        }
    };
    let Some(summary) = summary else {
        ui.weak("No cell with a value is drawn.");
        return;
    };
    let measure = about.measure(&view.shown.property);
    ui.label(format!(
        "{} of {} drawn cells, {}",
        view.shown.property,
        summary.count,
        match measure.unit.as_str() {
            "" => "no unit",
            unit => unit,
        }
    ));
    let [low, middle, high] = summary.percentiles;
    let weighted = summary
        .weighted
        .map(|v| ("Mean, weighted by pore volume", v));
    let rows = [("Smallest", summary.min), ("Mean", summary.mean)];
    let rows = rows.into_iter().chain(weighted).chain([
        ("Largest", summary.max),
        ("P10 (10 % of cells are below)", low),
        ("P50 (median)", middle),
        ("P90 (90 % of cells are below)", high),
    ]);
    egui::Grid::new("values").striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            ui.label(significant(measure.show(value)));
            ui.end_row();
        }
    });
    ui.separator();
}

fn summary(about: &PanelContext<'_>, view: &View) -> Option<Summary> {
    let field = about
        .case
        .field(&view.shown.property, view.shown.step)
        .ok()?;
    let weights = about.case.field("PORV", 0).ok();
    let weights = weights.as_ref().map(|w| w.values());
    Summary::of(field.values(), &view.shown.cells.drawn, weights)
}
