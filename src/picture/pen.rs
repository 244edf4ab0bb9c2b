//! What all drawings share: a canvas with ink, paper and sizes, title and thin lines.

use super::canvas::Canvas;
use super::legend::{GROUND, Legend};
use super::orientation::Text;
use crate::image::color::linear_from_srgb;
use crate::image::srgb_8bit;

/// A canvas with the color and sizes that suit its picture.
pub struct Pen<'a> {
    pub canvas: Canvas<'a>,
    /// Color of text and lines.
    pub ink: [u8; 3],
    /// The picture's background.
    pub paper: [u8; 3],
    pub dark_paper: bool,
    /// Text height in pixels; the unit of every size here.
    pub unit: f64,
    /// Width of thin lines in pixels.
    pub thin: f64,
}

impl<'a> Pen<'a> {
    /// Text height that suits a picture of this size.
    pub fn unit_of(size: [u32; 2]) -> f64 {
        (f64::from(size[0].min(size[1])) / 42.0).clamp(11.0, 160.0)
    }

    /// A pen that stands out from a background (sRGB, 0..1) and writes `unit` pixels high.
    pub fn new(canvas: Canvas<'a>, background: [f64; 3], unit: f64) -> Self {
        let [r, g, b] = background.map(linear_from_srgb);
        // At this luminance black and white stand out equally (contrast ratio of WCAG 2).
        let dark_paper = 0.2126 * r + 0.7152 * g + 0.0722 * b < 0.179;
        Self {
            canvas,
            ink: if dark_paper { [238; 3] } else { [28; 3] },
            paper: srgb_8bit(background),
            dark_paper,
            unit,
            thin: (unit / 22.0).max(1.0),
        }
    }

    /// Fades what lies under text or legend; on the bare background nothing changes.
    pub fn plate(&mut self, a: [f64; 2], b: [f64; 2]) {
        self.canvas.fill(a, b, self.paper, 0.8);
    }

    /// A line of text in ink.
    pub fn write(&mut self, text: &str, at: [f64; 2]) {
        self.canvas.text(text, at, self.unit, self.ink);
    }

    /// A text about its middle.
    pub fn write_at(&mut self, text: &Text) {
        let width = self.canvas.text_width(&text.text, text.height);
        let [x, y] = text.middle.to_array();
        let corner = [x - 0.5 * width, y - 0.5 * text.height];
        self.canvas.text(&text.text, corner, text.height, self.ink);
    }

    /// A rectangle of thin lines.
    pub fn frame(&mut self, [left, top]: [f64; 2], [right, bottom]: [f64; 2], strength: f64) {
        let corners = [
            [left, top],
            [right, top],
            [right, bottom],
            [left, bottom],
            [left, top],
        ];
        for side in corners.windows(2) {
            self.stroke([side[0], side[1]], strength);
        }
    }

    /// A thin line.
    pub fn stroke(&mut self, ends: [[f64; 2]; 2], strength: f64) {
        let widths = [self.thin; 2];
        self.canvas.line(ends, widths, self.ink, |_, _| strength);
    }

    /// A legend, as it was laid out.
    pub fn legend(&mut self, legend: &Legend) {
        let [low, high] = legend.ground.map(|p| p.to_array());
        self.canvas.fill(low, high, self.ink, GROUND);
        for ([low, high], color) in &legend.blocks {
            let [low, high] = [low, high].map(|p| p.to_array());
            self.canvas.fill(low, high, *color, 1.0);
        }
        for [low, high] in &legend.opacities {
            let (from, to, y) = (low.x, high.x, low.y as i64);
            for x in from.floor() as i64..to.ceil() as i64 {
                let covered = (to.min(x as f64 + 1.0) - from.max(x as f64)).clamp(0.0, 1.0);
                self.canvas.blend(x, y, self.ink, 0.4 * covered);
            }
        }
        for line in &legend.strokes {
            self.stroke(line.map(|p| p.to_array()), 0.8);
        }
        for text in &legend.texts {
            self.write_at(text);
        }
    }

    /// The line at the top of a picture, above 2.2 units.
    pub fn title(&mut self, title: &str) {
        self.title_until(title, "");
    }

    /// The same, of two parts: only the first one becomes shorter where there is no room.
    pub fn title_until(&mut self, title: &str, end: &str) {
        let margin = self.unit;
        let room = f64::from(self.canvas.size[0]) - 2.0 * margin;
        let wanted = 1.25 * self.unit;
        let width = |text: &str, height: f64| self.canvas.text_width(text, height);
        let fit = room / (width(title, wanted) + width(end, wanted)).max(1.0);
        // Long titles become smaller first, then shorter.
        let height = wanted * fit.clamp(0.7, 1.0);
        let left = room - width(end, height);
        let title = self.canvas.cut(title, height, left) + end;
        let top = 0.7 * margin;
        self.canvas.text(&title, [margin, top], height, self.ink);
    }
}
