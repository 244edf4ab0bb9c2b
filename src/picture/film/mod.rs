//! Films: pictures written one after another as they come, in the end whole or not at all.

mod apng;
mod frames;
mod gif;
#[cfg(feature = "mp4")]
mod mp4;

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::PictureError;
use super::files::{Cause, matching};
use crate::draft::Draft;

/// Kinds of films.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FilmFormat {
    /// Animated PNG: lossless, plays in browsers.
    Apng,
    /// 256 colors a picture; plays in slides too.
    #[default]
    Gif,
    /// H.264, in builds with the feature `mp4`.
    Mp4,
    /// A folder of numbered pictures.
    Frames,
}

impl FilmFormat {
    /// The formats that this build writes, the one that plays in most programs first.
    pub const OF_BUILD: &'static [Self] = &[
        Self::Gif,
        Self::Apng,
        #[cfg(feature = "mp4")]
        Self::Mp4,
        Self::Frames,
    ];

    /// Ending of its files; `None` for a folder.
    pub fn ending(self) -> Option<&'static str> {
        match self {
            Self::Apng => Some("png"),
            Self::Gif => Some("gif"),
            Self::Mp4 => Some("mp4"),
            Self::Frames => None,
        }
    }

    /// The format that an output asks for by its extension, or by being a folder.
    ///
    /// # Errors
    /// When it is none that this build writes.
    pub fn from_path(path: &Path) -> Result<Self, PictureError> {
        if path.is_dir() || path.to_string_lossy().ends_with(std::path::is_separator) {
            return Ok(Self::Frames);
        }
        let extension = path.extension().and_then(|e| e.to_str());
        match extension.unwrap_or_default().to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Apng),
            "gif" => Ok(Self::Gif),
            "mp4" if cfg!(feature = "mp4") => Ok(Self::Mp4),
            "mp4" => Err(PictureError::NoMp4(path.to_owned())),
            _ => Err(PictureError::FilmFormat(path.to_owned())),
        }
    }
}

/// What is known of a film before its first picture.
///
/// **Invariants**: at least one picture; `fps` above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmShape {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Number of pictures.
    pub pictures: u32,
    /// Pictures a second.
    pub fps: f64,
    /// Seconds for which the last picture stands longer than the others.
    pub hold: f64,
}

impl FilmShape {
    /// Seconds from and until which a picture is seen.
    fn seen(&self, picture: u32) -> Range<f64> {
        let start = |n: u32| f64::from(n) / self.fps;
        let hold = if picture + 1 < self.pictures {
            0.0
        } else {
            self.hold
        };
        start(picture)..start(picture + 1) + hold
    }
}

/// A duration in whole units, rounded such that the sum of many stays right.
fn ticks(seen: &Range<f64>, per_second: f64) -> u16 {
    let at = |seconds: f64| (seconds * per_second).round();
    (at(seen.end) - at(seen.start)) as u16
}

/// Writes one format.
trait Encoder {
    /// Adds a picture of the film's size, seen for a part of the film (in seconds).
    fn add(&mut self, rgb: &[[u8; 3]], seen: Range<f64>) -> Result<(), Cause>;

    /// Writes what comes after the last picture.
    fn finish(self: Box<Self>) -> Result<(), Cause>;
}

/// A film in the making: dropped before [`Self::finish`], it leaves nothing.
pub struct Film {
    path: PathBuf,
    shape: FilmShape,
    added: u32,
    // Before the draft: what an encoder holds open is closed before it is removed.
    encoder: Box<dyn Encoder>,
    draft: Draft,
}

impl Film {
    /// Begins a film at `path`, whose form says the format.
    ///
    /// # Errors
    /// When this build does not write the format, the format not this size, or the place cannot be
    /// written.
    pub fn create(path: &Path, shape: FilmShape) -> Result<Self, PictureError> {
        let format = FilmFormat::from_path(path)?;
        if format == FilmFormat::Frames {
            frames::refuse_longer(path, shape.pictures)?;
        }
        let draft = Draft::of(path);
        let encoder = encoder(format, draft.path(), shape);
        Ok(Self {
            encoder: encoder.map_err(|cause| PictureError::write(path, cause))?,
            path: path.to_owned(),
            shape,
            added: 0,
            draft,
        })
    }

    /// Adds the next picture in 8-bit sRGB, the top row first.
    ///
    /// # Errors
    /// When it has another size than the film or cannot be written.
    pub fn add(&mut self, rgb: &[[u8; 3]]) -> Result<(), PictureError> {
        let seen = self.shape.seen(self.added);
        self.added += 1;
        matching(self.shape.size, rgb.len())
            .map_err(Cause::from)
            .and_then(|()| self.encoder.add(rgb, seen))
            .map_err(|cause| PictureError::write(&self.path, cause))
    }

    /// Ends the film and puts it in its place.
    ///
    /// # Errors
    /// When pictures are missing or the film cannot be written.
    pub fn finish(self) -> Result<(), PictureError> {
        let (added, wanted) = (self.added, self.shape.pictures);
        let end = || {
            if added != wanted {
                return Err(format!("the animation has {added} images instead of {wanted}").into());
            }
            self.encoder.finish()?;
            Ok(self.draft.keep()?)
        };
        end().map_err(|cause| PictureError::write(&self.path, cause))
    }
}

fn encoder(format: FilmFormat, path: &Path, shape: FilmShape) -> Result<Box<dyn Encoder>, Cause> {
    Ok(match format {
        FilmFormat::Apng => Box::new(apng::Apng::create(path, shape)?),
        FilmFormat::Gif => Box::new(gif::Gif::create(path, shape)?),
        FilmFormat::Frames => Box::new(frames::Frames::create(path, shape)?),
        #[cfg(feature = "mp4")]
        FilmFormat::Mp4 => Box::new(mp4::Mp4::create(path, shape)?),
        #[cfg(not(feature = "mp4"))]
        FilmFormat::Mp4 => return Err(PictureError::NoMp4(path.to_owned()).into()),
    })
}

#[cfg(test)]
mod tests;
