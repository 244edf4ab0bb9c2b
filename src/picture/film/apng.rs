//! Animated PNG: lossless.

use std::fs::File;
use std::io::BufWriter;
use std::ops::Range;
use std::path::Path;

use super::{Encoder, FilmShape, ticks};
use crate::picture::files::Cause;

pub struct Apng(png::Writer<BufWriter<File>>);

impl Apng {
    pub fn create(path: &Path, shape: FilmShape) -> Result<Self, Cause> {
        let [width, height] = shape.size;
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        // No number of plays: it goes on forever.
        encoder.set_animated(shape.pictures, 0)?;
        Ok(Self(encoder.write_header()?))
    }
}

impl Encoder for Apng {
    fn add(&mut self, rgb: &[[u8; 3]], seen: Range<f64>) -> Result<(), Cause> {
        self.0.set_frame_delay(ticks(&seen, 1000.0), 1000)?;
        Ok(self.0.write_image_data(rgb.as_flattened())?)
    }

    fn finish(self: Box<Self>) -> Result<(), Cause> {
        Ok(self.0.finish()?)
    }
}
