//! The transfer function: histogram, opacity curve with points to drag, color maps.

use eframe::egui::{self, Color32, Pos2, Rect, Sense, Stroke, Ui, vec2};

use super::About;
use crate::scene::{ColorSpec, TransferSpec};
use crate::transfer::presets;
use crate::viewer::action::Action;

const BINS: usize = 64;
/// Points nearer than this to the pointer are taken, in points of the screen.
const GRIP: f32 = 10.0;

pub fn show(ui: &mut Ui, about: &About<'_>, actions: &mut Vec<Action>) {
    let Some(picture) = about.picture else { return };
    let shown = &picture.view.transfer;
    let spec = &about.scene.transfer;
    let mut points: Vec<[f64; 2]> = match &spec.opacity {
        Some(points) => points.clone(),
        None => shown.opacity.iter().map(|p| [p.0, p.1]).collect(),
    };
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), 120.0), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "opacity curve"));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    histogram(
        &painter,
        rect,
        picture.view.field.values(),
        shown.range,
        |p| {
            let [r, g, b] = shown.srgb(p).map(|v| (255.0 * v) as u8);
            Color32::from_rgb(r, g, b)
        },
    );
    let place = |p: [f64; 2]| rect.lerp_inside(vec2(p[0] as f32, 1.0 - p[1] as f32));
    let line: Vec<Pos2> = points.iter().map(|p| place(*p)).collect();
    let ink = ui.visuals().text_color();
    painter.line(line.clone(), Stroke::new(2.0, ink));
    for point in &line {
        painter.circle(
            *point,
            4.0,
            ui.visuals().extreme_bg_color,
            Stroke::new(2.0, ink),
        );
    }
    if edited(&response, rect, &mut points, &line, ui) {
        let spec = TransferSpec {
            opacity: Some(points),
            ..spec.clone()
        };
        actions.push(Action::Transfer(spec));
    }
    response.on_hover_text("Drag points, double-click for a new one, right-click to remove one");
    colors(ui, spec, actions);
}

fn histogram(
    painter: &egui::Painter,
    rect: Rect,
    values: &[f32],
    [low, high]: [f64; 2],
    color: impl Fn(f64) -> Color32,
) {
    let mut bins = [0u32; BINS];
    let scale = BINS as f64 / (high - low).max(1e-30);
    for value in values.iter().map(|v| (f64::from(*v) - low) * scale) {
        // Values outside the range, and NaN, are in no bin.
        if (0.0..=BINS as f64).contains(&value) {
            bins[(value as usize).min(BINS - 1)] += 1;
        }
    }
    // By the root, so that few cells are seen beside many.
    let most = f64::from(bins.iter().copied().max().unwrap_or(1).max(1)).sqrt();
    for (n, count) in bins.iter().enumerate() {
        let part = |n: usize| n as f32 / BINS as f32;
        let height = (f64::from(*count).sqrt() / most) as f32;
        let bar = Rect::from_min_max(
            rect.lerp_inside(vec2(part(n), 1.0 - height)),
            rect.lerp_inside(vec2(part(n + 1), 1.0)),
        );
        painter.rect_filled(bar, 0.0, color((n as f64 + 0.5) / BINS as f64));
    }
}

/// Lets the pointer change the points; true where it did.
fn edited(
    response: &egui::Response,
    rect: Rect,
    points: &mut Vec<[f64; 2]>,
    line: &[Pos2],
    ui: &Ui,
) -> bool {
    let id = response.id.with("grabbed");
    let Some(pointer) = response.interact_pointer_pos() else {
        ui.data_mut(|d| d.remove::<usize>(id));
        return false;
    };
    let at = (pointer - rect.min) / rect.size();
    let at = [
        f64::from(at.x.clamp(0.0, 1.0)),
        f64::from(1.0 - at.y.clamp(0.0, 1.0)),
    ];
    let near = |p: &Pos2| p.distance(pointer);
    let nearest = (0..line.len()).min_by(|a, b| near(&line[*a]).total_cmp(&near(&line[*b])));
    let nearest = nearest.filter(|n| near(&line[*n]) < GRIP);
    if response.double_clicked() && nearest.is_none() {
        let after = points.partition_point(|p| p[0] <= at[0]);
        points.insert(after, at);
        return true;
    }
    if response.secondary_clicked() && points.len() > 1 {
        if let Some(n) = nearest {
            points.remove(n);
            return true;
        }
        return false;
    }
    if response.drag_started()
        && let Some(n) = nearest
    {
        ui.data_mut(|d| d.insert_temp(id, n));
    }
    let grabbed: Option<usize> = ui.data(|d| d.get_temp(id));
    match grabbed.filter(|n| *n < points.len() && response.dragged()) {
        Some(n) => {
            let low = if n > 0 { points[n - 1][0] } else { 0.0 };
            let high = points.get(n + 1).map_or(1.0, |p| p[0]);
            points[n] = [at[0].clamp(low, high), at[1]];
            true
        }
        None => false,
    }
}

fn colors(ui: &mut Ui, spec: &TransferSpec, actions: &mut Vec<Action>) {
    let current = match &spec.color {
        ColorSpec::Name(name) => name.as_str(),
        ColorSpec::Points(_) => "own",
    };
    egui::ComboBox::from_label("Color map")
        .selected_text(current)
        .show_ui(ui, |ui| {
            for name in presets::NAMES {
                if ui.selectable_label(current == name, name).clicked() {
                    let color = ColorSpec::Name(name.into());
                    actions.push(Action::Transfer(TransferSpec {
                        color,
                        ..spec.clone()
                    }));
                }
            }
        });
    if ui.button("Default curve").clicked() {
        actions.push(Action::Transfer(TransferSpec {
            opacity: None,
            ..spec.clone()
        }));
    }
}
