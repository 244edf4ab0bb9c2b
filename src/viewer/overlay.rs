//! What the viewport draws over the picture: title, legend, box, what is for orientation.

use eframe::egui::{self, Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};
use glam::DVec2;

use super::studio::difference_title;
use super::worker::Picture;
use crate::metrics::Comparison;
use crate::picture::{Annotations, Arrow, CONNECTION, Orientation, Paper, legend_marks, on_screen};
use crate::scene::View;
use crate::transfer::Scale;

const TEXT: f32 = 13.0;

/// Draws everything that the scene asks for over a picture, as it is seen from a view.
pub fn draw(
    painter: &Painter,
    rect: Rect,
    picture: &Picture,
    view: &View,
    annotations: &Annotations,
) {
    let ink = ink(view);
    let [r, g, b] = CONNECTION;
    let stroke = Stroke::new(1.0, Color32::from_rgb(r, g, b));
    for ends in view.connections.iter() {
        if let Some(line) = on_screen(view, *ends, size(rect)) {
            painter.line_segment(line.map(|at| place(rect, at)), stroke);
        }
    }
    if annotations.show_box {
        model_box(painter, rect, picture, view, ink);
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

/// Parts of an edge of the box, each as faint as the picture covers what is behind it.
const PARTS: u32 = 48;

/// The far edges of the box, behind the model.
fn model_box(painter: &Painter, rect: Rect, picture: &Picture, view: &View, ink: Color32) {
    for line in Orientation::box_edges(view, size(rect)) {
        let [a, b] = line;
        let at = |n: u32| a.lerp(b, f64::from(n) / f64::from(PARTS));
        for n in 0..PARTS {
            let ends = [at(n), at(n + 1)];
            let cover = picture.covered(0.5 * (ends[0] + ends[1]) / size(rect));
            let stroke = Stroke::new(1.0, ink.gamma_multiply(0.35 * (1.0 - cover)));
            painter.line_segment(ends.map(|at| place(rect, at)), stroke);
        }
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
    let transfer = &view.transfer;
    let wanted = (0.5 * rect.height()).min(260.0);
    let height = match &transfer.scale {
        Scale::Categories(values) => wanted.min(20.0 * values.len().max(1) as f32),
        _ => wanted,
    };
    let top = rect.center().y - 0.5 * height;
    let right = rect.right() - 64.0;
    let bar = Rect::from_min_size(pos2(right - 18.0, top), vec2(18.0, height));
    color_bar(painter, bar, |position| transfer.srgb(position));
    let boxes = match &transfer.scale {
        Scale::Categories(values) => values.len().max(1),
        _ => 1,
    };
    for n in 0..boxes {
        let part = |n: usize| n as f32 / boxes as f32;
        let corners = [vec2(0.0, part(n)), vec2(1.0, part(n + 1))].map(|c| bar.lerp_inside(c));
        let outline = Rect::from_two_pos(corners[0], corners[1]);
        painter.rect_stroke(
            outline,
            0.0,
            Stroke::new(1.0, ink),
            egui::StrokeKind::Outside,
        );
    }
    let mut covered = bar.expand(4.0);
    for (position, label) in legend_marks(transfer, 6, (height / (1.2 * TEXT)) as usize) {
        let y = bar.bottom() - position as f32 * height;
        let ends = [pos2(bar.right(), y), pos2(bar.right() + 4.0, y)];
        painter.line_segment(ends, Stroke::new(1.0, ink));
        let at = pos2(bar.right() + 7.0, y);
        covered |= write(painter, at, Align2::LEFT_CENTER, &label, ink, TEXT);
    }
    let heading = match annotations.unit.is_empty() {
        true => annotations.property.clone(),
        false => format!("{}\n{}", annotations.property, annotations.unit),
    };
    let at = pos2(bar.center().x, top - 8.0);
    covered | write(painter, at, Align2::CENTER_BOTTOM, &heading, ink, TEXT)
}

/// Fills `bar` with the colors of positions from 0 to 1, from the lower end of its longer side to the
/// other: each row of points has one color, so that steps stay sharp.
pub fn color_bar(painter: &Painter, bar: Rect, color: impl Fn(f64) -> [f64; 3]) {
    let upright = bar.height() > bar.width();
    let rows = bar.height().max(bar.width()).ceil().clamp(1.0, 1024.0) as u32;
    let mut mesh = egui::Mesh::default();
    for n in 0..rows {
        let [r, g, b] =
            color((f64::from(n) + 0.5) / f64::from(rows)).map(|v| (255.0 * v).round() as u8);
        let ends = [n, n + 1].map(|n| n as f32 / rows as f32);
        let corners = match upright {
            true => [vec2(0.0, 1.0 - ends[1]), vec2(1.0, 1.0 - ends[0])],
            false => [vec2(ends[0], 0.0), vec2(ends[1], 1.0)],
        };
        let [low, high] = corners.map(|c| bar.lerp_inside(c));
        mesh.add_colored_rect(Rect::from_min_max(low, high), Color32::from_rgb(r, g, b));
    }
    painter.add(mesh);
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

/// What a picture that is compared has of its own, below its title.
pub fn own(painter: &Painter, rect: Rect, view: &View, text: &str) {
    let at = rect.left_top() + vec2(12.0, 30.0);
    write(painter, at, Align2::LEFT_TOP, text, ink(view), 15.0);
}

/// The legend of a picture of which only the left part is seen.
pub fn legend_of_part(painter: &Painter, rect: Rect, view: &View, annotations: &Annotations) {
    legend(painter, rect, view, annotations, ink(view));
}

/// Why a picture that was asked for is not there, across its middle.
pub fn refusal(painter: &Painter, rect: Rect, why: &str) {
    let ink = Color32::from_gray(30);
    let width = (rect.width() - 80.0).clamp(120.0, 560.0);
    let text = painter.layout(why.to_owned(), FontId::proportional(16.0), ink, width);
    let place = Align2::CENTER_CENTER.anchor_size(rect.center(), text.size());
    let stroke = Stroke::new(1.0, Color32::from_gray(120));
    let plate = Color32::from_gray(245);
    painter.rect(
        place.expand(12.0),
        4.0,
        plate,
        stroke,
        egui::StrokeKind::Outside,
    );
    painter.galley(place.min, text, ink);
}

/// What a map of differences means.
pub fn difference(painter: &Painter, rect: Rect, figures: &Comparison) {
    let text = difference_title(figures);
    let at = rect.left_top() + vec2(12.0, 10.0);
    write(painter, at, Align2::LEFT_TOP, &text, Color32::WHITE, 15.0);
}
