//! Property filters: cells whose values lie in ranges or among categories, all of which must hold.

use eframe::egui::{self, Color32, Role, Ui, WidgetInfo, vec2};

use super::PanelContext;
use super::cells::clear;
use super::controls::number;
use super::range_slider::RangeSlider;
use crate::scene::PropertyFilter;
use crate::transfer::coloring::palette;
use crate::viewer::action::Action;
use crate::viewer::spread::{Counts, part, value};

/// Height of a histogram, in points.
const HISTOGRAM: f32 = 46.0;
/// Room for what stands beside a property's name, in points.
const BESIDE: f32 = 142.0;
/// Height of a list of categories, in points.
const LIST: f32 = 150.0;

pub fn show(ui: &mut Ui, about: &PanelContext<'_>, actions: &mut Vec<Action>) {
    let mut filter = about.scene.filter.clone();
    let mut removed = None;
    for (n, row) in filter.properties.iter_mut().enumerate() {
        ui.push_id(n, |ui| {
            if heading(ui, about, row) {
                removed = Some(n);
            }
            ui.add_enabled_ui(row.enabled, |ui| values(ui, about, row));
            ui.separator();
        });
    }
    if let Some(n) = removed {
        filter.properties.remove(n);
    }
    ui.horizontal(|ui| {
        let add = ui.button("Add a filter");
        let what = "Filters by the property shown; it hides nothing until you move a handle";
        if add.on_hover_text(what).clicked()
            && let Some(name) = about.property()
        {
            // What a difference is taken from filters for it.
            filter
                .properties
                .push(PropertyFilter::open(about.case.now_of(name)));
        }
        clear(ui, &mut filter);
    });
    if filter != about.scene.filter {
        actions.push(Action::Filter(filter));
    }
}

/// Which property filters, whether it does, and how; true where it is to be removed.
fn heading(ui: &mut Ui, about: &PanelContext<'_>, row: &mut PropertyFilter) -> bool {
    ui.horizontal(|ui| {
        let on = ui.checkbox(&mut row.enabled, "");
        on.widget_info(|| {
            WidgetInfo::selected(Role::CheckBox, true, row.enabled, "Use this filter")
        });
        on.on_hover_text("Use this filter");
        let mut name = row.name.clone();
        property(ui, about, &mut name);
        if name != row.name {
            // Bounds of one property mean nothing for another.
            *row = PropertyFilter::open(name);
        }
        ui.checkbox(&mut row.invert, "Invert")
            .on_hover_text("Draws the other cells instead");
        let remove = ui.button("Remove");
        remove
            .on_hover_text("Removes the filter and draws its cells again")
            .clicked()
    })
    .inner
}

fn property(ui: &mut Ui, about: &PanelContext<'_>, name: &mut String) {
    egui::ComboBox::from_id_salt("property")
        .width((ui.available_width() - BESIDE).max(60.0))
        .truncate()
        .selected_text(name.clone())
        .show_ui(ui, |ui| {
            for property in about.properties() {
                ui.selectable_value(name, property.name.clone(), &property.name);
            }
        })
        .response
        .on_hover_text("The property whose values decide, at the step shown");
}

/// Which values are kept.
fn values(ui: &mut Ui, about: &PanelContext<'_>, row: &mut PropertyFilter) {
    let mut known = about.spreads.iter().rev();
    let spread = known.find(|s| s.property == row.name);
    match spread.map(|s| s.counts.as_ref()) {
        None => {
            ui.weak("reading values ...");
        }
        Some(None) => {
            ui.weak("No cell has a value.");
        }
        Some(Some(Counts::Bars { range, log, bars })) => {
            bounds(ui, about, row, (*range, *log), bars);
        }
        Some(Some(Counts::Categories(all))) => categories(ui, about, row, all),
    }
}

/// Two handles over the histogram, and the bounds as numbers. A handle at its end leaves that side open.
fn bounds(
    ui: &mut Ui,
    about: &PanelContext<'_>,
    row: &mut PropertyFilter,
    (range, log): ([f64; 2], bool),
    bars: &[u32],
) {
    let measure = about.measure(&row.name);
    let [low, high] = range;
    let ends = [row.min.unwrap_or(low), row.max.unwrap_or(high)];
    let mut parts = match low < high {
        true => ends.map(|end| part(range, log, end)),
        false => [0.0, 1.0],
    };
    let most = bars.iter().copied().max().unwrap_or(0).max(1);
    // By the square root, so that few cells are seen beside many.
    let height = |count: &u32| (f64::from(*count) / f64::from(most)).sqrt() as f32;
    let heights: Vec<f32> = bars.iter().map(height).collect();
    let before = parts;
    let slider = RangeSlider {
        names: [
            format!("Smallest {}", row.name),
            format!("Largest {}", row.name),
        ],
        values: ends.map(|end| measure.show(end)),
        bars: &heights,
        inverted: row.invert,
        height: HISTOGRAM,
        width: ui.available_width(),
        nudge: None,
    };
    if slider.show(ui, &mut parts) {
        // Rounded as it is read.
        let shown = |part: f64| six_digits(measure.show(value(range, log, part)));
        let bound = |part: f64| measure.read(shown(part));
        if parts[0] != before[0] {
            row.min = (parts[0] > 0.0).then(|| bound(parts[0]));
        }
        if parts[1] != before[1] {
            row.max = (parts[1] < 1.0).then(|| bound(parts[1]));
        }
    }
    let [low, high] = range.map(|end| measure.show(end));
    let speed = 0.002 * (high - low).abs().max(1e-9);
    ui.horizontal(|ui| {
        let [min, max] = &mut ends.map(|end| measure.show(end));
        let what = "Smallest value drawn; open at the smallest of all steps";
        if number(ui, min, speed, "Smallest value drawn", what) {
            let kept = measure.read(*min);
            row.min = (*min > low).then_some(kept);
            // The end that is moved pushes the other one.
            row.max = row.max.map(|max| max.max(kept));
        }
        ui.label("to");
        let what = "Largest value drawn; open at the largest of all steps";
        if number(ui, max, speed, "Largest value drawn", what) {
            let kept = measure.read(*max);
            row.max = (*max < high).then_some(kept);
            row.min = row.min.map(|min| min.min(kept));
        }
        ui.weak(&measure.unit);
        let open = ui.add_enabled(row.limits(), egui::Button::new("All"));
        if open.on_hover_text("Opens both ends").clicked() {
            (row.min, row.max, row.values) = (None, None, None);
        }
    });
}

/// A check box for each category: number, color, cells.
fn categories(ui: &mut Ui, about: &PanelContext<'_>, row: &mut PropertyFilter, all: &[(f64, u32)]) {
    let kept = |values: &Option<Vec<f64>>, v: f64| values.as_ref().is_none_or(|k| k.contains(&v));
    let before: Vec<bool> = all.iter().map(|(v, _)| kept(&row.values, *v)).collect();
    let mut flags = before.clone();
    ui.horizontal(|ui| {
        for (name, on, what) in [
            ("All", true, "Checks every category"),
            ("None", false, "Clears every check box"),
        ] {
            if ui.button(name).on_hover_text(what).clicked() {
                flags.fill(on);
            }
        }
        let count = flags.iter().filter(|f| **f).count();
        ui.weak(format!("{count} of {} checked", all.len()));
    });
    let colors = colors(about, &row.name, all);
    egui::ScrollArea::vertical()
        .max_height(LIST)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for (n, (value, cells)) in all.iter().enumerate() {
                ui.horizontal(|ui| {
                    let (place, _) = ui.allocate_exact_size(vec2(12.0, 12.0), egui::Sense::hover());
                    ui.painter().rect_filled(place, 2.0, colors[n]);
                    let name = format!("{} {value}", row.name);
                    let check = ui.checkbox(&mut flags[n], value.to_string());
                    let is_on = flags[n];
                    check.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, is_on, &name));
                    ui.weak(match cells {
                        1 => "1 cell".to_owned(),
                        cells => format!("{cells} cells"),
                    });
                });
            }
        });
    if flags != before {
        let checked = all.iter().zip(&flags).filter(|(_, on)| **on);
        let values: Vec<f64> = checked.map(|((v, _), _)| *v).collect();
        (row.min, row.max) = (None, None);
        row.values = (values.len() < all.len()).then_some(values);
    }
}

/// The colors that categories have in the picture, where it shows them; else those that they would have.
fn colors(about: &PanelContext<'_>, property: &str, all: &[(f64, u32)]) -> Vec<Color32> {
    let shown = about.picture.filter(|p| p.view.shown.property == property);
    let of_view = |value: f64| {
        let transfer = &shown?.view.style.transfer;
        let shown = transfer.scale.shown(value, transfer.range[0]);
        shown
            .is_finite()
            .then(|| transfer.srgb(transfer.position(shown)))
    };
    let own = palette(all.len());
    let colors = all.iter().zip(own);
    let colors = colors.map(|((v, _), own)| of_view(*v).unwrap_or(own));
    colors
        .map(|c| {
            let [r, g, b] = c.map(|v| (255.0 * v).round() as u8);
            Color32::from_rgb(r, g, b)
        })
        .collect()
}

/// A number as people read it, which is what the scene has then.
fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
