//! What the viewport draws over the volume: connections, box, what is for orientation.

use eframe::egui::{self, Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, vec2};
use glam::DVec2;

use super::job::Picture;
use crate::picture::{
    Annotations, Arrow, CONNECTION, Orientation, Paper, Text, on_screen, well_names,
};
use crate::view::View;

/// Height of letters in and beside pictures, in points.
pub const TEXT: f32 = 13.0;

/// Draws everything that the scene asks for over the volume, as it is seen from a view.
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
    for ends in view.shown.connections.iter() {
        if let Some(line) = on_screen(view, *ends, size(rect)) {
            painter.line_segment(line.map(|at| place(rect, at)), stroke);
        }
    }
    let width = |text: &str| width(painter, text);
    let mut paper = Paper {
        size: size(rect),
        unit: f64::from(TEXT),
        width: &width,
        is_dark: ink.r() > 128,
        taken: Vec::new(),
    };
    let names = well_names(view, &paper);
    let areas = names.texts.iter().map(|name| name.area(width(&name.text)));
    paper.taken.extend(areas);
    if annotations.show_box {
        model_box(painter, rect, picture, view, ink);
        let made = Orientation::of(view, &annotations.lengths, paper);
        orientation(painter, rect, &made, ink);
    }
    for line in &names.leaders {
        let line = line.map(|at| place(rect, at));
        painter.line_segment(line, Stroke::new(1.0, ink));
    }
    for name in &names.texts {
        let [low, high] = name.area(width(&name.text)).map(|at| place(rect, at));
        let [r, g, b] = view.style.background.map(|v| (255.0 * v) as u8);
        let plate = Color32::from_rgba_unmultiplied(r, g, b, 200);
        painter.rect_filled(Rect::from_min_max(low, high), 2.0, plate);
        write(painter, rect, name, ink);
    }
}

/// A color that stands out from the background.
pub fn ink(view: &View) -> Color32 {
    let [r, g, b] = view.style.background;
    match 0.2126 * r + 0.7152 * g + 0.0722 * b < 0.45 {
        true => Color32::from_gray(235),
        false => Color32::from_gray(30),
    }
}

/// Writes a text that was laid out for a rectangle.
pub fn write(painter: &Painter, rect: Rect, text: &Text, ink: Color32) {
    let (at, font) = (
        place(rect, text.middle),
        FontId::proportional(text.height as f32),
    );
    painter.text(at, Align2::CENTER_CENTER, &text.text, font, ink);
}

/// Width of a text in points.
pub fn width(painter: &Painter, text: &str) -> f64 {
    let font = FontId::proportional(TEXT);
    let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
    f64::from(galley.size().x)
}

/// Where in the window a place of a rectangle is.
pub fn place(rect: Rect, at: DVec2) -> Pos2 {
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

/// Width and height of a rectangle.
pub fn size(rect: Rect) -> DVec2 {
    DVec2::new(f64::from(rect.width()), f64::from(rect.height()))
}

/// Coordinates, scale bar and directions.
fn orientation(painter: &Painter, rect: Rect, made: &Orientation, ink: Color32) {
    for line in &made.strokes {
        let line = line.map(|at| place(rect, at));
        painter.line_segment(line, Stroke::new(1.2, ink));
    }
    for one in &made.arrows {
        arrow(painter, rect, one);
    }
    for text in &made.texts {
        write(painter, rect, text, ink);
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
