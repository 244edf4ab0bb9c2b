//! From linear, premultiplied pixels to files with legend, title and axes.

mod annotate;
mod axes;
mod canvas;
mod files;
mod legend;
mod ticks;

pub use annotate::{Annotations, annotate, finished};
pub use files::{Format, PictureError, write_exr, write_png};

use crate::transfer::function::{linear_from_srgb, srgb_from_linear};

/// A picture in linear light, alpha premultiplied, without background.
///
/// **Shape**: `pixels[y * width + x]`, the top row first.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Linear red, green, blue, each times alpha, and alpha.
    pub pixels: Vec<[f32; 4]>,
}

impl Image {
    /// The picture over a background (sRGB, 0..1), added in linear light, as 8-bit sRGB.
    pub fn over_background_8bit(&self, background: [f64; 3]) -> Vec<[u8; 3]> {
        let background = background.map(linear_from_srgb);
        let encode = |p: &[f32; 4]| {
            std::array::from_fn(|c| {
                let linear = f64::from(p[c]) + (1.0 - f64::from(p[3])) * background[c];
                (255.0 * srgb_from_linear(linear.clamp(0.0, 1.0))).round() as u8
            })
        };
        self.pixels.iter().map(encode).collect()
    }
}

/// A picture in 8-bit sRGB.
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
    /// A picture of one color.
    pub fn filled(size: [u32; 2], color: [u8; 3]) -> Self {
        let pixels = vec![color; size[0] as usize * size[1] as usize];
        Self { size, pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn background_shows_where_nothing_covers_it() {
        let pixels = vec![[0.0; 4], [0.5, 0.5, 0.5, 1.0], [0.25, 0.0, 0.0, 0.5]];
        let image = Image {
            size: [3, 1],
            pixels,
        };
        let over_white = image.over_background_8bit([1.0; 3]);
        // Linear 0.5 is sRGB 0.7354 = 188; half white and a quarter red: 0.75 -> 225, 0.5 -> 188.
        assert_eq!(over_white, [[255; 3], [188; 3], [225, 188, 188]]);
    }
}
