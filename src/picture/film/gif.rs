//! GIF: 256 colors a picture.
//!
//! Each picture has its own palette, made of the pixels that changed since the one before; what did
//! not change is transparent. Palettes of whole pictures let what stands still flicker. One palette
//! for the whole film is about as good, but needs all pictures before the first can be written.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::ops::Range;
use std::path::Path;

use color_quant::NeuQuant;

use super::{Encoder, FilmShape, ticks};
use crate::picture::files::Cause;

/// Palette entry of what stays as it was.
const UNCHANGED: u8 = 255;
/// Of how many pixels one is looked at for the palette: with fewer than all, legends band and arrows
/// lose their color.
const SAMPLED: i32 = 1;

pub struct Gif {
    encoder: gif::Encoder<BufWriter<File>>,
    size: [u16; 2],
    before: Vec<[u8; 3]>,
}

impl Gif {
    pub fn create(path: &Path, shape: FilmShape) -> Result<Self, Cause> {
        let [Ok(width), Ok(height)] = shape.size.map(u16::try_from) else {
            return Err("pictures of a GIF have at most 65535 pixels each way".into());
        };
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = gif::Encoder::new(file, width, height, &[])?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        Ok(Self {
            encoder,
            size: [width, height],
            before: Vec::new(),
        })
    }
}

impl Encoder for Gif {
    fn add(&mut self, rgb: &[[u8; 3]], seen: Range<f64>) -> Result<(), Cause> {
        let changed = |n: usize| self.before.get(n) != rgb.get(n);
        let news: Vec<_> = (0..rgb.len()).filter(|&n| changed(n)).collect();
        let (palette, index) = palette(news.iter().map(|&n| rgb[n]));
        let mut indices = vec![UNCHANGED; rgb.len()];
        for n in news {
            indices[n] = index[&rgb[n]];
        }
        self.encoder.write_frame(&gif::Frame {
            delay: ticks(&seen, 100.0),
            dispose: gif::DisposalMethod::Keep,
            transparent: Some(UNCHANGED),
            width: self.size[0],
            height: self.size[1],
            palette: Some(palette),
            buffer: indices.into(),
            ..gif::Frame::default()
        })?;
        self.before = rgb.to_vec();
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), Cause> {
        Ok(self.encoder.into_inner()?.flush()?)
    }
}

/// A palette for pixels, with room for [`UNCHANGED`], and the entry of each color.
fn palette(pixels: impl Iterator<Item = [u8; 3]> + Clone) -> (Vec<u8>, BTreeMap<[u8; 3], u8>) {
    let mut index: BTreeMap<_, _> = pixels.clone().map(|p| (p, 0)).collect();
    let mut palette = vec![0; 3 * 256];
    if index.len() <= usize::from(UNCHANGED) {
        for (at, (color, entry)) in (0..UNCHANGED).zip(&mut index) {
            *entry = at;
            palette[3 * usize::from(at)..][..3].copy_from_slice(color);
        }
        return (palette, index);
    }
    let rgba: Vec<u8> = pixels.flat_map(|[r, g, b]| [r, g, b, 255]).collect();
    let quantizer = NeuQuant::new(SAMPLED, usize::from(UNCHANGED), &rgba);
    for ([r, g, b], entry) in &mut index {
        *entry = quantizer.index_of(&[*r, *g, *b, 255]) as u8;
    }
    let colors = quantizer.color_map_rgb();
    palette[..colors.len()].copy_from_slice(&colors);
    (palette, index)
}
