//! Numbered pictures in a folder, for other programs to make a film of.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::{Encoder, FilmShape};
use crate::picture::files::{Cause, PictureError, save_png};

pub struct Frames {
    folder: PathBuf,
    size: [u32; 2],
    next: u32,
}

impl Frames {
    pub fn create(folder: &Path, shape: FilmShape) -> Result<Self, Cause> {
        std::fs::create_dir(folder)?;
        Ok(Self {
            folder: folder.to_owned(),
            size: shape.size,
            next: 0,
        })
    }
}

impl Encoder for Frames {
    fn add(&mut self, rgb: &[[u8; 3]], _: Range<f64>) -> Result<(), Cause> {
        let path = self.folder.join(name(self.next));
        self.next += 1;
        Ok(save_png(&path, self.size, rgb)?)
    }

    fn finish(self: Box<Self>) -> Result<(), Cause> {
        Ok(())
    }
}

fn name(picture: u32) -> String {
    format!("frame_{picture:04}.png")
}

/// Refuses a folder in which the pictures of an earlier, longer film would follow the new ones.
pub fn refuse_longer(folder: &Path, pictures: u32) -> Result<(), PictureError> {
    let next = folder.join(name(pictures));
    if next.exists() {
        return Err(PictureError::Longer(next));
    }
    Ok(())
}
