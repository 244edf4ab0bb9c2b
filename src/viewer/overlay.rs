//! What the viewport draws over the picture: title, legend, box, what is for orientation.

use eframe::egui::{self, Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};
use glam::DVec2;

use super::studio::DIFFERENCE_SCALE;
use crate::metrics::Comparison;
use crate::picture::{
    Annotations, Arrow, CONNECTION, Orientation, Paper, legend_labels, on_screen,
};
use crate::scene::View;

const TEXT: f32 = 13.0;

/// Draws everything that the scene asks for.
pub fn draw(painter: &Painter, rect: Rect, view: &View, annotations: &Annotations) {
    let ink = ink(view);
    let [r, g, b] = CONNECTION;
    let stroke = Stroke::new(1.0, Color32::from_rgb(r, g, b));
    for ends in view.connections.iter() {
        if let Some(line) = on_screen(view, *ends, size(rect)) {
            painter.line_segment(line.map(|at| place(rect, at)), stroke);
        }
    }
    if annotations.show_box {
        model_box(painter, rect, view, ink);
    }
    let mut taken = Vec::new();
    if annotations.show_legend {
        let title = format!("{}{}", annotations.title, annotations.when);
        taken.push(write(
            painter,
            rect.left_top() + vec2(12.0, 10.0),
            Align2::LEFT_TOP,
            &title,
            ink,
            15.0,
        ));
        taken.push(legend(painter, rect, view, annotations, ink));
    }
    if annotations.show_box {
        orientation(painter, rect, view, annotations, ink, &taken);
    }
}

/// A color that stands out from the background.
fn ink(view: &View) -> Color32 {
    let [r, g, b] = view.background;
    match 0.2126 * r + 0.7152 * g + 0.0722 * b < 0.45 {
        true => Color32::from_gray(235),
        false => Color32::from_gray(30),
    }
}

fn write(painter: &Painter, at: Pos2, align: Align2, text: &str, ink: Color32, size: f32) -> Rect {
    painter.text(at, align, text, FontId::proportional(size), ink)
}

fn place(rect: Rect, at: DVec2) -> Pos2 {
    rect.left_top() + vec2(at.x as f32, at.y as f32)
}

fn model_box(painter: &Painter, rect: Rect, view: &View, ink: Color32) {
    let stroke = Stroke::new(1.0, ink.gamma_multiply(0.35));
    for line in Orientation::box_edges(view, size(rect)) {
        painter.line_segment(line.map(|at| place(rect, at)), stroke);
    }
}

fn size(rect: Rect) -> DVec2 {
    DVec2::new(f64::from(rect.width()), f64::from(rect.height()))
}

/// Coordinates, scale bar, directions and exaggeration, where nothing else is.
fn orientation(
    painter: &Painter,
    rect: Rect,
    view: &View,
    annotations: &Annotations,
    ink: Color32,
    taken: &[Rect],
) {
    let width = |text: &str| {
        let font = FontId::proportional(TEXT);
        let galley = painter.layout_no_wrap(text.to_owned(), font, ink);
        f64::from(galley.size().x)
    };
    let area = |taken: &Rect| {
        [taken.min, taken.max].map(|p| {
            let at = p - rect.min;
            DVec2::new(f64::from(at.x), f64::from(at.y))
        })
    };
    let made = Orientation::of(
        view,
        &annotations.length_unit,
        Paper {
            size: size(rect),
            unit: f64::from(TEXT),
            width: &width,
            is_dark: ink.r() > 128,
            taken: taken.iter().map(area).collect(),
        },
    );
    for line in &made.strokes {
        let line = line.map(|at| place(rect, at));
        painter.line_segment(line, Stroke::new(1.2, ink));
    }
    for one in &made.arrows {
        arrow(painter, rect, one);
    }
    for text in &made.texts {
        let at = place(rect, text.middle);
        let height = text.height as f32;
        write(painter, at, Align2::CENTER_CENTER, &text.text, ink, height);
    }
}

fn arrow(painter: &Painter, rect: Rect, arrow: &Arrow) {
    let [from, tip] = arrow.ends.map(|at| place(rect, at));
    let [shaft, head, head_length] = arrow.shape.map(|v| v as f32);
    let [r, g, b] = arrow.color;
    let color = Color32::from_rgb(r, g, b);
    let along = tip - from;
    if along.length() < 2.0 * shaft {
        // It points at the viewer or away.
        painter.circle_filled(tip, 0.5 * head, color);
        return;
    }
    let neck = tip - along * (head_length / along.length()).min(0.6);
    painter.line_segment([from, neck], Stroke::new(shaft, color));
    let side = along.normalized().rot90() * 0.5 * head;
    let corners = vec![tip, neck + side, neck - side];
    painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
}

/// Draws the legend and says what it covers.
fn legend(
    painter: &Painter,
    rect: Rect,
    view: &View,
    annotations: &Annotations,
    ink: Color32,
) -> Rect {
    let height = (0.5 * rect.height()).min(260.0);
    let top = rect.center().y - 0.5 * height;
    let right = rect.right() - 64.0;
    let bar = Rect::from_min_size(pos2(right - 18.0, top), vec2(18.0, height));
    let transfer = &view.transfer;
    let mut mesh = egui::Mesh::default();
    const BANDS: u32 = 64;
    for n in 0..=BANDS {
        let position = f64::from(n) / f64::from(BANDS);
        let [r, g, b] = transfer.srgb(position).map(|v| (255.0 * v).round() as u8);
        let y = bar.bottom() - position as f32 * height;
        for x in [bar.left(), bar.right()] {
            mesh.colored_vertex(pos2(x, y), Color32::from_rgb(r, g, b));
        }
        if n > 0 {
            let at = 2 * n;
            mesh.add_triangle(at - 2, at - 1, at);
            mesh.add_triangle(at - 1, at + 1, at);
        }
    }
    painter.add(mesh);
    painter.rect_stroke(bar, 0.0, Stroke::new(1.0, ink), egui::StrokeKind::Outside);
    let mut covered = bar.expand(4.0);
    let [low, high] = transfer.range;
    for (value, label) in legend_labels(transfer.range, 6) {
        let position = if high > low {
            (value - low) / (high - low)
        } else {
            0.5
        };
        let y = bar.bottom() - position as f32 * height;
        painter.line_segment(
            [pos2(bar.right(), y), pos2(bar.right() + 4.0, y)],
            Stroke::new(1.0, ink),
        );
        covered |= write(
            painter,
            pos2(bar.right() + 7.0, y),
            Align2::LEFT_CENTER,
            &label,
            ink,
            TEXT,
        );
    }
    let heading = match annotations.unit.is_empty() {
        true => annotations.property.clone(),
        false => format!("{}\n{}", annotations.property, annotations.unit),
    };
    let at = pos2(bar.center().x, top - 8.0);
    covered | write(painter, at, Align2::CENTER_BOTTOM, &heading, ink, TEXT)
}

/// A short text beside the pointer.
pub fn tip(ui: &egui::Ui, at: Pos2, text: &str) {
    let painter = ui.painter();
    let visuals = ui.visuals();
    let font = FontId::proportional(TEXT);
    let text = painter.layout_no_wrap(text.to_owned(), font, visuals.strong_text_color());
    let place = Rect::from_min_size(at, text.size()).expand(5.0);
    painter.rect_filled(place, 3.0, visuals.window_fill());
    painter.galley(at, text, visuals.strong_text_color());
}

/// Which strategy made a picture that is compared, below its title.
pub fn strategy(painter: &Painter, rect: Rect, view: &View) {
    let at = rect.left_top() + vec2(12.0, 30.0);
    let name = view.strategy.name().to_uppercase();
    write(painter, at, Align2::LEFT_TOP, &name, ink(view), 15.0);
}

/// What a map of differences means.
pub fn difference(painter: &Painter, rect: Rect, figures: &Comparison) {
    let text = format!(
        "CIEDE2000: mean {:.2}, 99 % below {:.2}; brightest at {DIFFERENCE_SCALE} or more",
        figures.ciede2000_mean, figures.ciede2000_p99
    );
    let at = rect.left_top() + vec2(12.0, 10.0);
    write(painter, at, Align2::LEFT_TOP, &text, Color32::WHITE, 15.0);
}
