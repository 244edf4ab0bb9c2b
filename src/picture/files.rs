//! PNG and EXR files, written whole or not at all.

use std::io;
use std::path::{Path, PathBuf};

use super::Image;

/// Why a picture could not be written.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The extension is neither .png nor .exr.
    #[error("{0}: pictures are written as .png or .exr")]
    Format(PathBuf),
    /// The file could not be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
}

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
    whole(path, |temporary| {
        image::save_buffer_with_format(
            temporary,
            rgb.as_flattened(),
            size[0],
            size[1],
            image::ColorType::Rgb8,
            image::ImageFormat::Png,
        )
    })
}

/// Writes linear, premultiplied RGBA.
///
/// # Errors
/// When the file cannot be written.
pub fn write_exr(path: &Path, image: &Image) -> Result<(), PictureError> {
    whole(path, |temporary| {
        let bytes: &[u8] = bytemuck::cast_slice(&image.pixels);
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

/// Writes beside `path` and renames, so that no half file stays.
fn whole(
    path: &Path,
    write: impl FnOnce(&Path) -> image::ImageResult<()>,
) -> Result<(), PictureError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(name);
    let done =
        write(&temporary).and_then(|()| std::fs::rename(&temporary, path).map_err(Into::into));
    done.map_err(|source| {
        // The error that matters is the first; a leftover is only untidy.
        drop::<io::Result<()>>(std::fs::remove_file(&temporary));
        PictureError::Write {
            path: path.to_owned(),
            source,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ok_exr_gives_back_the_same_floats() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let pixels: Vec<[f32; 4]> = (0..12u8)
            .map(|n| [0.1, 1.5, 1e-3, 0.05].map(|v| v * f32::from(n)))
            .collect();
        write_exr(
            &path,
            &Image {
                size: [4, 3],
                pixels: pixels.clone(),
            },
        )
        .unwrap();
        let read = image::open(&path).unwrap().into_rgba32f();
        assert_eq!(read.as_raw().as_slice(), pixels.as_flattened());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn err_unknown_extension_and_missing_folder() {
        assert!(Format::from_path(Path::new("a.jpg")).is_err());
        let error = write_png(Path::new("/no/such/folder/a.png"), [1, 1], &[[0; 3]]).unwrap_err();
        assert!(error.to_string().contains("/no/such/folder/a.png"));
    }
}
