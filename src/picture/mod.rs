//! From linear, premultiplied pixels to files with legend, title and axes.

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
