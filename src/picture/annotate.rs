//! Title, legend, orientation axes and the model's box, drawn into the 8-bit picture.

use glam::DVec3;

use super::Image;
use super::canvas::Canvas;
use super::ticks::{label, ticks};
use crate::scene::View;

/// What to write and draw.
#[derive(Debug, Clone, Default)]
pub struct Annotations {
    /// Line at the top.
    pub title: String,
    /// Name over the legend.
    pub property: String,
    /// Unit behind the name; may be empty.
    pub unit: String,
    /// Draw title and legend.
    pub show_legend: bool,
    /// Draw the box and the axes.
    pub show_box: bool,
}

/// Pictures lower or narrower than this get no annotations: nothing would be readable.
const SMALLEST: [u32; 2] = [200, 150];

/// Draws annotations into a picture that was put over its background.
pub fn annotate(rgb: &mut [[u8; 3]], image: &Image, view: &View, annotations: &Annotations) {
    if image.size[0] < SMALLEST[0] || image.size[1] < SMALLEST[1] {
        return;
    }
    let [r, g, b] = view.background;
    let dark_background = 0.2126 * r + 0.7152 * g + 0.0722 * b < 0.5;
    let ink = if dark_background { [235; 3] } else { [40; 3] };
    let height = (f64::from(image.size[1].min(image.size[0])) / 42.0).clamp(11.0, 80.0);
    let mut pen = Pen {
        canvas: Canvas::new(image.size, rgb),
        ink,
        height,
    };
    if annotations.show_box {
        pen.model_box(image, view);
        pen.axes(view);
    }
    if annotations.show_legend {
        pen.title(&annotations.title);
        pen.legend(view, annotations);
    }
}

struct Pen<'a> {
    canvas: Canvas<'a>,
    ink: [u8; 3],
    /// Text height in pixels.
    height: f64,
}

impl Pen<'_> {
    fn title(&mut self, title: &str) {
        let room = f64::from(self.canvas.size[0]) - 2.0 * self.height;
        let wanted = 1.25 * self.height;
        let width = self.canvas.text_width(title, wanted).max(1.0);
        let height = wanted * (room / width).min(1.0);
        self.canvas
            .text(title, self.height, 0.7 * self.height, height, self.ink);
    }

    /// A bar of the transfer function's colors; its strength beside it is the opacity curve.
    fn legend(&mut self, view: &View, annotations: &Annotations) {
        let [w, h] = self.canvas.size.map(f64::from);
        let unit = self.height;
        let (bar, top, bottom) = (1.2 * unit, 0.26 * h, 0.74 * h);
        let [low, high] = view.transfer.range;
        let labels: Vec<(f64, String)> = ticks([low, high], 5)
            .into_iter()
            .map(|v| (v, label(v, high - low)))
            .collect();
        let widest = labels
            .iter()
            .map(|(_, t)| self.canvas.text_width(t, unit))
            .fold(0.0, f64::max);
        let name = annotations.property.as_str();
        let heading = self
            .canvas
            .text_width(name, unit)
            .max(self.canvas.text_width(&annotations.unit, unit));
        let left = w - (bar + 0.9 * unit + widest).max(heading).min(0.5 * w) - unit;
        self.canvas
            .text(name, left, top - 2.6 * unit, unit, self.ink);
        self.canvas
            .text(&annotations.unit, left, top - 1.45 * unit, unit, self.ink);
        for y in top as i64..bottom as i64 {
            let position = 1.0 - (y as f64 + 0.5 - top) / (bottom - top);
            let color = view
                .transfer
                .srgb(position)
                .map(|v| (255.0 * v).round() as u8);
            for x in 0..bar as i64 {
                self.canvas.blend(left as i64 + x, y, color, 1.0);
            }
        }
        let ink = self.ink;
        self.outline([left, top], [left + bar.floor(), bottom]);
        for (value, text) in labels {
            let y = bottom - (bottom - top) * view.transfer.position(value);
            let x = left + bar;
            self.canvas
                .line([x, y], [x + 0.35 * unit, y], 1.0, ink, |_, _| 1.0);
            self.canvas
                .text(&text, x + 0.55 * unit, y - 0.55 * unit, unit, ink);
        }
        let scale = format!("z x {}", label(view.vertical_exaggeration, 1.0));
        self.canvas
            .text(&scale, left, bottom + 0.8 * unit, unit, ink);
    }

    fn outline(&mut self, a: [f64; 2], b: [f64; 2]) {
        let corners = [a, [b[0], a[1]], b, [a[0], b[1]], a];
        for pair in corners.windows(2) {
            self.canvas
                .line(pair[0], pair[1], 1.0, self.ink, |_, _| 0.8);
        }
    }

    /// East, north and up as seen by the camera, in the lower left corner.
    fn axes(&mut self, view: &View) {
        let length = 3.0 * self.height;
        let center = [1.6 * length, f64::from(self.canvas.size[1]) - 1.5 * length];
        let camera = &view.camera;
        let mut arrows = [
            (DVec3::X, [205, 50, 45], "E"),
            (DVec3::Y, [40, 150, 60], "N"),
            (DVec3::Z, [50, 90, 210], "Up"),
        ];
        // Far ones first.
        arrows.sort_by(|a, b| b.0.dot(camera.forward).total_cmp(&a.0.dot(camera.forward)));
        for (axis, color, name) in arrows {
            let (x, y) = (axis.dot(camera.right), -axis.dot(camera.up));
            let tip = [center[0] + length * x, center[1] + length * y];
            self.canvas
                .line(center, tip, 0.16 * self.height, color, |_, _| 1.0);
            let width = self.canvas.text_width(name, self.height);
            let at = [
                center[0] + 1.28 * length * x - 0.5 * width,
                center[1] + 1.28 * length * y - 0.5 * self.height,
            ];
            self.canvas.text(name, at[0], at[1], self.height, color);
        }
    }

    /// Edges of the model's box, under the volume.
    fn model_box(&mut self, image: &Image, view: &View) {
        let [width, height] = image.size;
        let aspect = f64::from(width) / f64::from(height);
        let corners: [_; 8] = std::array::from_fn(|c| {
            let at = view.camera.project(view.box_corners[c], aspect)?;
            Some([at.x * f64::from(width), at.y * f64::from(height)])
        });
        let alpha = |x: i64, y: i64| {
            let inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
            let pixel = inside
                .then(|| image.pixels.get((x + i64::from(width) * y) as usize))
                .flatten();
            0.35 * (1.0 - f64::from(pixel.map_or(0.0, |p| p[3])))
        };
        for a in 0..8usize {
            for axis in 0..3 {
                let b = a | 1 << axis;
                if let (true, Some(from), Some(to)) = (a != b, corners[a], corners[b]) {
                    self.canvas.line(from, to, 1.0, self.ink, alpha);
                }
            }
        }
    }
}
