//! What the thread that makes images is asked for, and what it answers.

use std::sync::{Arc, Weak};
use std::time::Duration;

use glam::DVec2;

use crate::case::Case;
use crate::image::Rgb8;
use crate::image::metrics::Comparison;
use crate::model::Grid;
use crate::picking::Pick;
use crate::render::{DeviceBytes, FrameStats, LightTimes};
use crate::scene::Scene;
use crate::view::View;

/// A case and how it looks.
#[derive(Clone)]
pub struct RenderRequest {
    /// The case, in map space.
    pub case: Arc<Case>,
    /// How it looks; `size` is the picture's.
    pub scene: Scene,
}

impl RenderRequest {
    /// The case in the space of the scene. Takes time at the first call for a case.
    pub fn seen(&self) -> Arc<Case> {
        self.case.in_space(self.scene.space)
    }
}

impl PartialEq for RenderRequest {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.case, &other.case) && self.scene == other.scene
    }
}

/// What the thread is asked for. Each side keeps its own grid on the device.
pub enum ImageJob {
    /// A picture of a side.
    Picture {
        /// Which one.
        side: usize,
        /// Of what.
        wanted: RenderRequest,
        /// Good enough while something moves; else final.
        is_draft: bool,
    },
    /// What is seen at a place in a side's picture (0 to 1, right and down).
    Pick {
        /// Which one.
        side: usize,
        /// Of what.
        wanted: RenderRequest,
        /// Where.
        at: DVec2,
        /// Given back with the answer.
        why: PickPurpose,
    },
    /// How far two pictures are apart.
    Difference([Arc<Rgb8>; 2]),
    /// Frees what is kept of a case that was closed.
    Forget(Weak<Case>, Weak<Grid>),
}

/// What a place is looked at for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PickPurpose {
    /// Its cell is selected, alone.
    Select,
    /// Its cell joins those selected.
    AddToSelection,
    /// The pointer rests on it.
    Hover,
}

/// A picture that was made.
pub struct Picture {
    /// Over the scene's background.
    pub rgb: Arc<Rgb8>,
    /// How much of the background each pixel covers, 0 to 255.
    pub cover: Vec<u8>,
    /// What it shows.
    pub view: Arc<View>,
    /// Of what it was made.
    pub wanted: RenderRequest,
    /// Made while something moves, and coarser than asked for.
    pub is_draft: bool,
    /// What the rays cost.
    pub stats: FrameStats,
    /// What was prepared, and of it light.
    pub prepare: Duration,
    /// See [`crate::render::Frame`].
    pub light: LightTimes,
    /// Bytes on the device.
    pub bytes: DeviceBytes,
    /// From the job's arrival to the picture's end.
    pub took: Duration,
}

impl Picture {
    /// How much of the background is covered at a place (0 to 1, right and down), 0 to 1.
    pub fn covered(&self, at: DVec2) -> f32 {
        let [width, height] = self.rgb.size;
        let pixel = |part: f64, count: u32| (part * f64::from(count)).floor();
        let (x, y) = (pixel(at.x, width), pixel(at.y, height));
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(width) && y < f64::from(height);
        let index = y as usize * width as usize + x as usize;
        let cover = self.cover.get(index).filter(|_| inside);
        f32::from(cover.copied().unwrap_or(0)) / 255.0
    }
}

/// How far two pictures are apart.
pub struct ImageDifference {
    /// The pictures.
    pub of: [Arc<Rgb8>; 2],
    /// CIEDE2000 of each pixel, in colors.
    pub map: Rgb8,
    /// Figures.
    pub figures: Comparison,
}

/// What the thread says.
pub enum Answer {
    /// The adapter that makes the pictures.
    Adapter {
        /// Name and kind.
        name: String,
        /// It computes on the CPU.
        is_software: bool,
    },
    /// Part of the picture or of its preparation that is done.
    Progress(f32),
    /// A picture of a side.
    Picture(usize, Box<Picture>),
    /// It was canceled.
    Canceled,
    /// What is seen at the place, and what lies before and behind it.
    Picked(PickPurpose, Box<Pick>),
    /// How far two pictures are apart.
    Difference(Box<ImageDifference>),
    /// Nothing is kept of a case anymore.
    Forgotten,
    /// Why there is no picture, in one sentence.
    Failed(String),
    /// Why there is no other answer, in one sentence.
    Refused(String),
}
