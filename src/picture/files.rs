//! PNG and EXR files, written whole or not at all.

use std::path::{Path, PathBuf};

use image::error::{ParameterError, ParameterErrorKind};

use crate::draft::Draft;
use crate::image::Image;

/// Why a picture or film could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The extension is neither .png nor .exr.
    #[error("{0}: images are written as .png or .exr")]
    Format(PathBuf),
    /// The extension is none of a film.
    #[error(
        "{0}: animations are written as .gif, .png (animated) or .mp4, or as numbered images into a folder (DIR/)"
    )]
    FilmFormat(PathBuf),
    /// This build writes no MP4.
    #[error(
        "{0}: this build writes no MP4; build it with `cargo build --release --features mp4` (needs a C++ compiler; H.264 is covered by patents), or name a .png"
    )]
    NoMp4(PathBuf),
    /// A folder holds more pictures than the film will have.
    #[error(
        "{0} is left from a longer animation; remove it and those after it, or name another folder"
    )]
    Longer(PathBuf),
    /// The file could not be written.
    #[error("cannot write {path}: {cause}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why; part of the sentence, so no source that would be shown a second time.
        cause: Cause,
    },
}

impl PictureError {
    /// For a file and what went wrong with it.
    pub(super) fn write(path: &Path, cause: Cause) -> Self {
        Self::Write {
            path: path.to_owned(),
            cause,
        }
    }
}

/// What an encoder or the system said.
pub(super) type Cause = Box<dyn std::error::Error + Send + Sync>;

/// Kinds of picture files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB.
    Png,
    /// Linear, premultiplied RGBA floats.
    Exr,
}

impl Format {
    /// The format that a file's extension asks for.
    ///
    /// # Errors
    /// When it is neither `.png` nor `.exr`.
    pub fn from_path(path: &Path) -> Result<Self, PictureError> {
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(PictureError::Format(path.to_owned())),
        }
    }
}

/// Writes 8-bit sRGB pixels.
///
/// # Errors
/// When the file cannot be written.
pub fn write_png(path: &Path, size: [u32; 2], rgb: &[[u8; 3]]) -> Result<(), PictureError> {
    whole(path, |temporary| save_png(temporary, size, rgb))
}

/// Writes 8-bit sRGB pixels right where they belong.
pub(super) fn save_png(path: &Path, size: [u32; 2], rgb: &[[u8; 3]]) -> image::ImageResult<()> {
    matching(size, rgb.len())?;
    image::save_buffer_with_format(
        path,
        rgb.as_flattened(),
        size[0],
        size[1],
        image::ColorType::Rgb8,
        image::ImageFormat::Png,
    )
}

/// Writes linear, premultiplied RGBA, whatever the picture was blended in.
///
/// # Errors
/// When the file cannot be written.
pub fn write_exr(path: &Path, image: &Image) -> Result<(), PictureError> {
    whole(path, |temporary| {
        matching(image.size, image.pixels.len())?;
        let pixels = image.linear_pixels();
        let bytes: &[u8] = bytemuck::cast_slice(&pixels);
        image::save_buffer_with_format(
            temporary,
            bytes,
            image.size[0],
            image.size[1],
            image::ColorType::Rgba32F,
            image::ImageFormat::OpenExr,
        )
    })
}

/// The encoders panic over a wrong number of pixels.
pub(super) fn matching([width, height]: [u32; 2], pixels: usize) -> image::ImageResult<()> {
    if u64::from(width) * u64::from(height) == pixels as u64 {
        return Ok(());
    }
    let kind = ParameterErrorKind::DimensionMismatch;
    Err(image::ImageError::Parameter(ParameterError::from_kind(
        kind,
    )))
}

/// Writes beside `path` and renames, so that no half file stays.
fn whole(
    path: &Path,
    write: impl FnOnce(&Path) -> image::ImageResult<()>,
) -> Result<(), PictureError> {
    let draft = Draft::of(path);
    let written = write(draft.path()).map_err(Cause::from);
    written
        .and_then(|()| Ok(draft.keep()?))
        .map_err(|cause| PictureError::write(path, cause))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Blending;

    #[test]
    fn ok_exr_gives_back_the_same_floats() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let pixels: Vec<[f32; 4]> = (0..12u8)
            .map(|n| [0.1, -1.5, 1e-30, 3e8].map(|v| v * f32::from(n)))
            .collect();
        let image = Image {
            size: [4, 3],
            blending: Blending::Linear,
            pixels,
        };
        write_exr(&path, &image).unwrap();
        let read = image::open(&path).unwrap().into_rgba32f();
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(read.as_raw()), bits(image.pixels.as_flattened()));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn ok_png_replaces_a_file_and_gives_back_the_same_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, "older").unwrap();
        let rgb: Vec<[u8; 3]> = (0..6).map(|n| [n, 50 * n, 255 - n]).collect();
        write_png(&path, [3, 2], &rgb).unwrap();
        let read = image::open(&path).unwrap().into_rgb8();
        assert_eq!(read.dimensions(), (3, 2));
        assert_eq!(read.as_raw().as_slice(), rgb.as_flattened());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn err_wrong_number_of_pixels_leaves_the_older_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, "older").unwrap();
        assert!(write_png(&path, [3, 2], &[[0; 3]; 5]).is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"older");
        let image = Image {
            size: [2, 2],
            blending: Blending::Linear,
            pixels: Vec::new(),
        };
        assert!(write_exr(&folder.path().join("a.exr"), &image).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn ok_extensions_in_any_case() {
        assert_eq!(
            Format::from_path(Path::new("a.b.PNG")).unwrap(),
            Format::Png
        );
        assert_eq!(Format::from_path(Path::new("é.exr")).unwrap(), Format::Exr);
    }

    #[test]
    fn err_unknown_extension_and_missing_folder() {
        for unknown in ["a.jpg", "a", "", ".png"] {
            let error = Format::from_path(Path::new(unknown))
                .unwrap_err()
                .to_string();
            assert!(error.contains(".png") && error.contains(".exr"), "{error}");
        }
        let error = write_png(Path::new("/no/such/folder/a.png"), [1, 1], &[[0; 3]]).unwrap_err();
        assert!(error.to_string().contains("/no/such/folder/a.png"));
    }
}
