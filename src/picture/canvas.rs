//! Lines, boxes and anti-aliased text on 8-bit pixels.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont};

use crate::image::Rgb8;

/// Pixels being drawn on.
pub struct Canvas<'a> {
    /// Width and height.
    pub size: [u32; 2],
    pixels: &'a mut [[u8; 3]],
    font: Option<FontRef<'static>>,
}

impl Rgb8 {
    /// To draw on.
    pub(super) fn canvas(&mut self) -> Canvas<'_> {
        Canvas::new(self.size, &mut self.pixels)
    }
}

impl<'a> Canvas<'a> {
    /// A canvas over the rows of a picture.
    pub fn new(size: [u32; 2], pixels: &'a mut [[u8; 3]]) -> Self {
        // The font comes with the program; were it damaged, pictures would lack text, no more.
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).ok();
        Self { size, pixels, font }
    }

    /// Mixes a color into a pixel; outside the picture nothing happens.
    pub fn blend(&mut self, x: i64, y: i64, color: [u8; 3], coverage: f64) {
        let [w, h] = self.size.map(i64::from);
        if (0..w).contains(&x)
            && (0..h).contains(&y)
            && let Some(pixel) = self.pixels.get_mut((x + w * y) as usize)
        {
            for (p, c) in pixel.iter_mut().zip(color) {
                *p = (f64::from(*p) + (f64::from(c) - f64::from(*p)) * coverage.clamp(0.0, 1.0))
                    .round() as u8;
            }
        }
    }

    /// Mixes a color into a rectangle from its upper left to its lower right corner.
    pub fn fill(&mut self, a: [f64; 2], b: [f64; 2], color: [u8; 3], coverage: f64) {
        let [w, h] = self.size.map(f64::from);
        let pixels = |from: f64, to: f64, end: f64| {
            from.round().clamp(0.0, end) as i64..to.round().clamp(0.0, end) as i64
        };
        for y in pixels(a[1], b[1], h) {
            for x in pixels(a[0], b[0], w) {
                self.blend(x, y, color, coverage);
            }
        }
    }

    /// A line as wide as `widths` at its two ends, in pixels; `coverage` gives its strength at each
    /// pixel. Its ends are round; where it tapers, as an arrow's head, the first end is flat.
    pub fn line(
        &mut self,
        [a, b]: [[f64; 2]; 2],
        widths: [f64; 2],
        color: [u8; 3],
        coverage: impl Fn(i64, i64) -> f64,
    ) {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length2 = dx * dx + dy * dy;
        if !length2.is_finite() {
            return;
        }
        let length2 = length2.max(1e-12);
        let [w, h] = self.size.map(f64::from);
        let reach = 0.5 * widths[0].max(widths[1]) + 1.0;
        let pixels = |a: f64, b: f64, end: f64| {
            let (low, high) = (a.min(b) - reach, a.max(b) + reach);
            low.clamp(-1.0, end) as i64..=high.clamp(-1.0, end) as i64
        };
        for y in pixels(a[1], b[1], h) {
            // Only the part of the line near this row: boxes' edges cross large pictures.
            let at = |reach: f64| ((y as f64 + 0.5 + reach - a[1]) / dy).clamp(0.0, 1.0);
            let part = if dy.abs() < 1e-9 {
                [0.0, 1.0]
            } else {
                [at(-reach), at(reach)]
            };
            for x in pixels(a[0] + part[0] * dx, a[0] + part[1] * dx, w) {
                let (px, py) = (x as f64 + 0.5 - a[0], y as f64 + 0.5 - a[1]);
                let past_start = (px * dx + py * dy) / length2;
                let along = past_start.clamp(0.0, 1.0);
                let distance = (px - along * dx).hypot(py - along * dy);
                let width = widths[0] + (widths[1] - widths[0]) * along;
                let mut strength = (0.5 * width + 0.5 - distance).clamp(0.0, 1.0);
                if widths[0] != widths[1] {
                    strength = strength.min(past_start * length2.sqrt() + 0.5);
                }
                if strength > 0.0 {
                    self.blend(x, y, color, strength * coverage(x, y));
                }
            }
        }
    }

    /// Width of a text of `height` pixels.
    pub fn text_width(&self, text: &str, height: f64) -> f64 {
        let Some(font) = &self.font else { return 0.0 };
        let font = font.as_scaled(PxScale::from(height as f32));
        let advance = |c| f64::from(font.h_advance(font.glyph_id(c)));
        printable(text).map(advance).sum()
    }

    /// The text, cut with an ellipsis where it would be wider than `room`.
    pub fn cut(&self, text: &str, height: f64, room: f64) -> String {
        let width = |text: &str| self.text_width(text, height);
        if width(text) <= room {
            return text.to_owned();
        }
        let mut left = room - width("…");
        let fits = |c: &char| {
            left -= width(c.encode_utf8(&mut [0; 4]));
            left >= 0.0
        };
        let start: String = printable(text).take_while(fits).collect();
        start.trim_end().to_owned() + "…"
    }

    /// Draws a text of `height` pixels with its upper left corner at (x, y).
    pub fn text(&mut self, text: &str, [x, y]: [f64; 2], height: f64, color: [u8; 3]) {
        let Some(font) = self.font.clone() else {
            return;
        };
        let scaled = font.as_scaled(PxScale::from(height as f32));
        let mut pen = x as f32;
        for c in printable(text) {
            let id = scaled.glyph_id(c);
            let position = ab_glyph::point(pen, y as f32 + scaled.ascent());
            let glyph = id.with_scale_and_position(PxScale::from(height as f32), position);
            pen += scaled.h_advance(id);
            if let Some(outline) = font.outline_glyph(glyph) {
                let bounds = outline.px_bounds();
                outline.draw(|gx, gy, coverage| {
                    let (px, py) = (
                        bounds.min.x as i64 + i64::from(gx),
                        bounds.min.y as i64 + i64::from(gy),
                    );
                    // A light face on few pixels needs some weight.
                    self.blend(px, py, color, (1.35 * f64::from(coverage)).min(1.0));
                });
            }
        }
    }
}

/// Names come from files, in which anything may stand.
fn printable(text: &str) -> impl Iterator<Item = char> {
    text.chars().filter(|c| !c.is_control())
}
