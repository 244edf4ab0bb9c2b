//! Images as pixels, the numbers in which their colors are blended, and how far two of them are apart.

mod blending;
pub mod color;
pub mod metrics;
pub mod resampling;

use std::borrow::Cow;

pub use blending::Blending;

/// An image without background, alpha premultiplied.
///
/// **Shape**: `pixels[y * width + x]`, the top row first.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The numbers in which its colors were blended.
    pub blending: Blending,
    /// Red, green, blue, each times alpha, and alpha.
    pub pixels: Vec<[f32; 4]>,
}

impl Image {
    /// The image over a background (sRGB, 0..1), blended as the image is, as 8-bit sRGB.
    pub fn over_background_8bit(&self, background: [f64; 3]) -> Vec<[u8; 3]> {
        let background = self.blending.of_srgb(background);
        let encode = |p: &[f32; 4]| {
            let [r, g, b, alpha] = p.map(f64::from);
            let color = [r, g, b];
            let over = std::array::from_fn(|c| color[c] + (1.0 - alpha) * background[c]);
            srgb_8bit(self.blending.to_srgb(over))
        };
        self.pixels.iter().map(encode).collect()
    }

    /// Its pixels in linear light, premultiplied: of each the color by itself, decoded, times alpha.
    pub fn linear_pixels(&self) -> Cow<'_, [[f32; 4]]> {
        let decode = |p: &[f32; 4]| {
            let [r, g, b, alpha] = p.map(f64::from);
            if alpha <= 0.0 {
                return [0.0, 0.0, 0.0, p[3]];
            }
            let own = [r, g, b].map(|v| v / alpha);
            let [r, g, b] = self.blending.to_linear(own).map(|v| (v * alpha) as f32);
            [r, g, b, p[3]]
        };
        match self.blending {
            Blending::Linear => Cow::Borrowed(&self.pixels),
            Blending::Display => Cow::Owned(self.pixels.iter().map(decode).collect()),
        }
    }
}

/// An image in 8-bit sRGB.
///
/// **Shape**: `pixels[y * width + x]`, the top row first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rgb8 {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

impl Rgb8 {
    /// An image of one color.
    pub fn filled(size: [u32; 2], color: [u8; 3]) -> Self {
        let pixels = vec![color; size[0] as usize * size[1] as usize];
        Self { size, pixels }
    }

    /// This image at most `widest` pixels wide; where it was wider, each pixel is the mean of those
    /// that it covers.
    #[must_use]
    pub fn shrunk(&self, widest: u32) -> Self {
        let [width, height] = self.size;
        let pixels = self.pixels.as_flattened().to_vec();
        let large = image::RgbImage::from_raw(width, height, pixels);
        let Some(large) = large.filter(|_| width > widest.max(1)) else {
            return self.clone();
        };
        let share = f64::from(widest.max(1)) / f64::from(width);
        let size = [width, height].map(|n| (share * f64::from(n)).round().max(1.0) as u32);
        let small = image::imageops::thumbnail(&large, size[0], size[1]);
        Self {
            size,
            pixels: small.pixels().map(|p| p.0).collect(),
        }
    }

    /// Copies another image into this one, its upper left corner at `at`; what would lie outside
    /// is left out.
    pub fn paste(&mut self, other: &Self, at: [u32; 2]) {
        let [width, other_width] = [self.size[0], other.size[0]].map(|w| w as usize);
        let [left, top] = at.map(|n| n as usize);
        let room = width.saturating_sub(left).min(other_width);
        if room == 0 {
            return;
        }
        let rows = self.pixels.chunks_mut(width).skip(top);
        for (row, other) in rows.zip(other.pixels.chunks(other_width)) {
            for (pixel, color) in row
                .iter_mut()
                .skip(left)
                .zip(&other[..room.min(other.len())])
            {
                *pixel = *color;
            }
        }
    }
}

/// A color in sRGB, 0..1, with 8 bits a channel.
pub fn srgb_8bit(color: [f64; 3]) -> [u8; 3] {
    color.map(|v| (255.0 * v).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn background_shows_where_nothing_covers_it() {
        let pixels = vec![[0.0; 4], [0.5, 0.5, 0.5, 1.0], [0.25, 0.0, 0.0, 0.5]];
        let image = |blending| Image {
            size: [3, 1],
            blending,
            pixels: pixels.clone(),
        };
        let over_white = |blending| image(blending).over_background_8bit([1.0; 3]);
        // Linear 0.5 is sRGB 0.7354 = 188; half white and a quarter red: 0.75 -> 225, 0.5 -> 188.
        let linear = [[255; 3], [188; 3], [225, 188, 188]];
        assert_eq!(over_white(Blending::Linear), linear);
        let display = [[255; 3], [128; 3], [191, 128, 128]];
        assert_eq!(over_white(Blending::Display), display);
    }

    #[test]
    fn linear_pixels_hold_the_light_of_each_color() {
        let pixels = vec![[0.0; 4], [0.5, 1.0, 0.0, 1.0], [0.25, 0.5, 0.0, 0.5]];
        let image = |blending| Image {
            size: [3, 1],
            blending,
            pixels: pixels.clone(),
        };
        assert_eq!(*image(Blending::Linear).linear_pixels(), pixels);
        let decoded = image(Blending::Display);
        // sRGB 0.5 is linear 0.21404, whatever the opacity.
        for (pixel, alpha) in decoded.linear_pixels().iter().zip([0.0, 1.0, 0.5]) {
            let expected = [0.214_041 * alpha, alpha, 0.0, alpha];
            for c in 0..4 {
                assert!((pixel[c] - expected[c]).abs() < 1e-6, "{pixel:?}");
            }
        }
    }

    #[test]
    fn shrunk_pixels_are_means_of_what_they_cover() {
        let mut picture = Rgb8::filled([6, 4], [0; 3]);
        for pixel in picture.pixels.iter_mut().step_by(2) {
            *pixel = [200; 3];
        }
        let small = picture.shrunk(3);
        assert_eq!(small, Rgb8::filled([3, 2], [100; 3]));
        assert_eq!(picture.shrunk(1).size, [1, 1]);
        for widest in [6, 7, u32::MAX] {
            assert_eq!(picture.shrunk(widest), picture);
        }
        // Nothing to shrink, and a broken one.
        assert_eq!(Rgb8::filled([0, 3], [0; 3]).shrunk(0).size, [0, 3]);
        picture.pixels.pop();
        assert_eq!(picture.shrunk(3), picture);
    }

    #[test]
    fn paste_keeps_what_lies_outside() {
        let (old, new) = ([1; 3], [9; 3]);
        let pasted = |size, at| {
            let mut picture = Rgb8::filled([3, 2], old);
            picture.paste(&Rgb8::filled(size, new), at);
            let is_new = |p: &[u8; 3]| u8::from(*p == new);
            picture.pixels.iter().map(is_new).collect::<Vec<u8>>()
        };
        assert_eq!(pasted([1, 2], [1, 0]), [0, 1, 0, 0, 1, 0]);
        assert_eq!(pasted([5, 5], [2, 1]), [0, 0, 0, 0, 0, 1]);
        for (size, at) in [([2, 2], [3, 0]), ([2, 2], [0, 2]), ([0, 2], [0, 0])] {
            assert_eq!(pasted(size, at), [0; 6], "{size:?} {at:?}");
        }
    }
}
