//! Lines, boxes and anti-aliased text on 8-bit pixels.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont};

/// Pixels being drawn on.
pub struct Canvas<'a> {
    /// Width and height.
    pub size: [u32; 2],
    pixels: &'a mut [[u8; 3]],
    font: Option<FontRef<'static>>,
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

    /// A line of `width` pixels; `coverage` gives its strength at each pixel.
    pub fn line(
        &mut self,
        a: [f64; 2],
        b: [f64; 2],
        width: f64,
        color: [u8; 3],
        coverage: impl Fn(i64, i64) -> f64,
    ) {
        let [w, h] = self.size.map(f64::from);
        let reach = width + 1.0;
        let bound = |v: f64, high: f64| v.clamp(-1.0, high) as i64;
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length2 = (dx * dx + dy * dy).max(1e-12);
        if !length2.is_finite() {
            return;
        }
        let ys = bound(a[1].min(b[1]) - reach, h)..=bound(a[1].max(b[1]) + reach, h);
        for y in ys {
            for x in bound(a[0].min(b[0]) - reach, w)..=bound(a[0].max(b[0]) + reach, w) {
                let (px, py) = (x as f64 + 0.5 - a[0], y as f64 + 0.5 - a[1]);
                let along = ((px * dx + py * dy) / length2).clamp(0.0, 1.0);
                let distance = (px - along * dx).hypot(py - along * dy);
                let strength = (0.5 * width + 0.5 - distance).clamp(0.0, 1.0);
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
        text.chars()
            .map(|c| f64::from(font.h_advance(font.glyph_id(c))))
            .sum()
    }

    /// Draws a text of `height` pixels with its upper left corner at (x, y).
    pub fn text(&mut self, text: &str, x: f64, y: f64, height: f64, color: [u8; 3]) {
        let Some(font) = self.font.clone() else {
            return;
        };
        let scaled = font.as_scaled(PxScale::from(height as f32));
        let mut pen = x as f32;
        for c in text.chars() {
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
