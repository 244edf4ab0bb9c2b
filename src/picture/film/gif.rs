//! GIF: 256 colors a picture.
//!
//! Each picture has its own palette, made of the pixels that changed since the one before; what did
//! not change is transparent. Palettes of whole pictures let what stands still flicker. One palette
//! for the whole film is about as good, but needs all pictures before the first can be written.

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
/// Entries for colors that are far from all others: few pixels, such as a date's, have no weight in
/// the palette of many.
const OUTLIERS: usize = 64;

pub struct Gif {
    encoder: gif::Encoder<BufWriter<File>>,
    size: [u16; 2],
    before: Vec<[u8; 3]>,
}

impl Gif {
    pub fn create(path: &Path, shape: FilmShape) -> Result<Self, Cause> {
        let [Ok(width), Ok(height)] = shape.size.map(u16::try_from) else {
            return Err("images of a GIF have at most 65535 pixels each way".into());
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
        let palette = Palette::new(news.iter().map(|&n| rgb[n]).collect());
        let mut indices = vec![UNCHANGED; rgb.len()];
        for n in news {
            indices[n] = palette.entry(rgb[n]);
        }
        self.encoder.write_frame(&gif::Frame {
            delay: ticks(&seen, 100.0),
            dispose: gif::DisposalMethod::Keep,
            transparent: Some(UNCHANGED),
            width: self.size[0],
            height: self.size[1],
            palette: Some(palette.table()),
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

/// At most 255 colors, which leaves room for [`UNCHANGED`], and which one is nearest to which color.
struct Palette {
    entries: Vec<[u8; 3]>,
    /// In ascending order of the color.
    nearest: Vec<Nearest>,
}

struct Nearest {
    color: [u8; 3],
    entry: u8,
    /// Squared, in 8-bit sRGB.
    distance: i32,
}

impl Palette {
    fn new(mut pixels: Vec<[u8; 3]>) -> Self {
        pixels.sort_unstable();
        let mut colors = pixels.clone();
        colors.dedup();
        let few = colors.len() <= usize::from(UNCHANGED);
        let frequent = if few { Vec::new() } else { frequent(&pixels) };
        let far = |color| Nearest {
            color,
            entry: UNCHANGED,
            distance: i32::MAX,
        };
        let mut palette = Self {
            entries: Vec::new(),
            nearest: colors.into_iter().map(far).collect(),
        };
        for color in frequent {
            palette.add(color);
        }
        let farthest = |palette: &Self| {
            let farthest = palette.nearest.iter().max_by_key(|n| n.distance)?;
            (farthest.distance > 0).then_some(farthest.color)
        };
        while palette.entries.len() < usize::from(UNCHANGED)
            && let Some(color) = farthest(&palette)
        {
            palette.add(color);
        }
        palette
    }

    fn add(&mut self, color: [u8; 3]) {
        let entry = self.entries.len() as u8;
        self.entries.push(color);
        for nearest in &mut self.nearest {
            let apart = |c: usize| i32::from(color[c]) - i32::from(nearest.color[c]);
            let distance = (0..3).map(|c| apart(c) * apart(c)).sum();
            if distance < nearest.distance {
                (nearest.entry, nearest.distance) = (entry, distance);
            }
        }
    }

    /// Entry of a color; [`UNCHANGED`] for one that was not given.
    fn entry(&self, color: [u8; 3]) -> u8 {
        let found = self.nearest.binary_search_by_key(&color, |n| n.color);
        found.map_or(UNCHANGED, |at| self.nearest[at].entry)
    }

    /// Red, green and blue of 256 entries.
    fn table(&self) -> Vec<u8> {
        let mut table = self.entries.as_flattened().to_vec();
        table.resize(3 * 256, 0);
        table
    }
}

/// Colors for most pixels, by a neural network (NeuQuant).
fn frequent(pixels: &[[u8; 3]]) -> Vec<[u8; 3]> {
    let rgba: Vec<u8> = pixels
        .iter()
        .flat_map(|[r, g, b]| [*r, *g, *b, 255])
        .collect();
    let network = NeuQuant::new(SAMPLED, usize::from(UNCHANGED) - OUTLIERS, &rgba);
    let colors = network.color_map_rgb();
    colors.as_chunks().0.to_vec()
}
