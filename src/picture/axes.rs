//! What is for orientation, drawn into the picture.

use glam::DVec2;

use super::orientation::{Arrow, Orientation, on_screen};
use super::pen::Pen;
use crate::image::Image;
use crate::view::View;

/// Color of the lines between cells of non-neighbor connections.
pub const CONNECTION: [u8; 3] = [225, 30, 170];

/// Draws lines between the cells of the view's connections, over the volume: its depth is not known here.
pub fn draw_connections(pen: &mut Pen, view: &View, size: DVec2) {
    let thin = pen.thin;
    for ends in view.shown.connections.iter() {
        if let Some(line) = on_screen(view, *ends, size) {
            let line = line.map(|p| p.to_array());
            pen.canvas.line(line, [thin; 2], CONNECTION, |_, _| 0.8);
        }
    }
}

/// Draws the edges of the box, under the volume.
pub fn draw_edges(pen: &mut Pen, image: &Image, edges: &[[DVec2; 2]]) {
    let [width, height] = image.size.map(i64::from);
    let strength = |x: i64, y: i64| {
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        let pixel = inside.then(|| image.pixels.get((x + width * y) as usize));
        0.5 * (1.0 - f64::from(pixel.flatten().map_or(0.0, |p| p[3])))
    };
    let (ink, thin) = (pen.ink, pen.thin);
    for line in edges {
        let line = line.map(|p| p.to_array());
        pen.canvas.line(line, [thin; 2], ink, strength);
    }
}

/// Draws all that lies over the volume.
pub fn draw_marks(pen: &mut Pen, orientation: &Orientation) {
    for text in &orientation.texts {
        let width = pen.canvas.text_width(&text.text, text.height);
        let half = DVec2::new(0.5 * width + 0.3 * pen.unit, 0.6 * text.height);
        pen.plate(
            (text.middle - half).to_array(),
            (text.middle + half).to_array(),
        );
    }
    for line in &orientation.strokes {
        pen.stroke(line.map(|p| p.to_array()), 1.0);
    }
    for one in &orientation.arrows {
        arrow(pen, one);
    }
    for text in &orientation.texts {
        pen.write_at(text);
    }
}

fn arrow(pen: &mut Pen, arrow: &Arrow) {
    let [from, tip] = arrow.ends;
    let [shaft, head, head_length] = arrow.shape;
    let length = from.distance(tip);
    if length < 2.0 * shaft {
        // It points at the viewer or away.
        let dot = [from.to_array(); 2];
        pen.canvas.line(dot, [head; 2], arrow.color, |_, _| 1.0);
        return;
    }
    let neck = tip.lerp(from, (head_length / length).min(0.6));
    let [from, neck, tip] = [from, neck, tip].map(|p| p.to_array());
    let lines = [([from, neck], [shaft; 2]), ([neck, tip], [head, 0.0])];
    for (ends, widths) in lines {
        pen.canvas.line(ends, widths, arrow.color, |_, _| 1.0);
    }
}
