//! What images cost.

use std::time::Duration;

use crate::image::Image;
use crate::scene::{Interpolation, StrategyKind};
use crate::view::View;

/// An image and what it cost.
pub struct Frame {
    /// The image.
    pub image: Image,
    /// What its rays cost.
    pub stats: FrameStats,
    /// Time to bring field, selection and what the strategy keeps up to date.
    pub prepare: Duration,
    /// Of it, what bringing the light up to date took.
    pub light: LightTimes,
    /// Bytes on the device by purpose.
    pub bytes: DeviceBytes,
    /// What holding the grid in fewer bits has changed.
    pub storage_error: StorageError,
}

impl Frame {
    /// The frame whose rays took the median time; `None` of none.
    pub fn median(mut frames: Vec<Self>) -> Option<Self> {
        frames.sort_by_key(|f| f.stats.frame);
        let middle = frames.len() / 2;
        (middle < frames.len()).then(|| frames.swap_remove(middle))
    }
}

/// The largest changes that came of holding numbers in 16 bits; none where these are exact.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct StorageError {
    /// Of a depth, in the grid's length unit.
    pub depth: f64,
    /// Of a value, in the scale of the colors.
    pub value: f64,
}

/// What a frame cost.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameStats {
    /// Time of the rays: by the adapter's clock where it has one, else by the host's.
    pub frame: Duration,
    /// Wall time of the frame with readback.
    pub wall: Duration,
    /// CPU time of the process meanwhile, filled in by who measures it.
    pub cpu: Duration,
    /// Longest single submission.
    pub longest_submission: Duration,
    /// Lattice samples inside drawn cells.
    pub samples: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Steps from a cell to its neighbor.
    pub topological_steps: u64,
    /// Point locations through the acceleration grid.
    pub grid_fallbacks: u64,
    /// Pixels whose alpha is not zero.
    pub covered_pixels: u64,
    /// Times that rays came into the drawn model. PLTS: first samples inside, at the start of the ray or behind one
    /// outside. LIBC: boundary faces through which rays began to walk, and rays that start inside; faces of faults
    /// count where rays are set not to walk across. SRG: rays that meet the model, once each. None where cells are
    /// solid, for there no ray is cast.
    pub entries: u64,
    /// Lookups of a point without a cell to start from: those of `grid_fallbacks`, which are all of PLTS's that
    /// neither a neighbor nor the cell of a boundary face answers and those that set LIBC's rays right, and points of
    /// opaque sections. SRG looks up no others,
    /// for its samples come from the volume.
    pub point_locations: u64,
    /// Cells that rays passed through, each time. PLTS: in which they have samples; LIBC: all, down to those between
    /// two samples. None by SRG, whose rays know no cells, nor where cells are solid.
    pub cell_crossings: u64,
    /// Lattice samples that lie inside a drawn cell and were found in none.
    ///
    /// PLTS: the faces of a cell enclose the sample. Asked are the cell of the last sample before those that are not
    /// found, that of the first one after them, and each one that a thorough search has tried; in a cell that
    /// encloses a point, winding around it, the trilinear map takes it. Holes, faults that gape and hidden cells are
    /// thus not counted, nor what is within a thousandth of a cell of its faces.
    /// LIBC: samples are found by the segments that they lie on, so that only a ray that lost its way can lose one:
    /// it is counted where neither walk nor point location go on and the last cell encloses the next sample.
    /// SRG: none, for samples come from the volume; nor where cells are solid.
    pub lost_samples: u64,
    /// Rays that have reached their end.
    pub finished_rays: u64,
    /// LIBC: entries into the model of the ray that has most of them.
    pub peels: u64,
    /// LIBC: rays that lost their way at an edge or vertex and were set right by point location.
    pub recovered_rays: u64,
    /// LIBC: rays that could not be set right.
    pub lost_rays: u64,
    /// Samples of a volume beside the model, with a value or without.
    pub cube_samples: u64,
    /// Loop iterations of all rays and surface points, about.
    pub work: u64,
    /// Times that a ray paused within what it was doing.
    pub pauses: u64,
    /// Number of submissions.
    pub submissions: u32,
    /// Bytes of the image on the device.
    pub target_bytes: u64,
}

/// Bytes of a cell: four pillars, and depths of its corners.
const CELL_BYTES: u64 = 4 * 24 + 8 * 4;
/// Bytes of the values of a cell, by vertices and as one.
const VALUE_BYTES: [u64; 2] = [8 * 4, 4];
/// Bytes of the voxels around a sample of the resampled grid.
const SAMPLE_BYTES: u64 = 8 * 4;

impl FrameStats {
    /// Bytes of geometry and values in exact storage that the rays read at least: all of a cell each time that one is crossed or
    /// looked up, and by SRG the voxels around each sample. Lists of faces, the acceleration grid, light and what
    /// Newton's method reads again are not among them.
    pub fn bytes_read(&self, view: &View) -> u64 {
        let values = match view.shown.cells.interpolation {
            Interpolation::Vertex => VALUE_BYTES[0],
            Interpolation::Cell => VALUE_BYTES[1],
        };
        let of_cells = (self.cell_crossings + self.point_locations) * (CELL_BYTES + values);
        match view.sampling.strategy {
            StrategyKind::Srg => of_cells + SAMPLE_BYTES * self.samples,
            StrategyKind::Plts | StrategyKind::Libc => of_cells,
        }
    }
}

/// Times that bringing the light up to date took, by stage; zero where nothing was to be done.
#[derive(Debug, Clone, Copy, Default)]
pub struct LightTimes {
    /// Values by point location.
    pub field: Duration,
    /// Extinction pyramid.
    pub extinction: Duration,
    /// Light volumes, and gradients.
    pub volumes: Duration,
}

/// Bytes on the device by purpose.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct DeviceBytes {
    /// Pillars, depth lists, drawn cells.
    pub geometry: u64,
    /// Acceleration grid.
    pub acceleration: u64,
    /// Values of the property shown.
    pub property: u64,
    /// Resampled grids.
    pub resampled: u64,
    /// Light and occlusion volumes.
    pub lighting: u64,
    /// A volume beside the model.
    pub cube: u64,
    /// Images.
    pub targets: u64,
}

impl DeviceBytes {
    /// All of them.
    pub fn total(self) -> u64 {
        let Self {
            geometry,
            acceleration,
            property,
            resampled,
            lighting,
            cube,
            targets,
        } = self;
        geometry + acceleration + property + resampled + lighting + cube + targets
    }
}

impl std::ops::Add for DeviceBytes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            geometry: self.geometry + other.geometry,
            acceleration: self.acceleration + other.acceleration,
            property: self.property + other.property,
            resampled: self.resampled + other.resampled,
            lighting: self.lighting + other.lighting,
            cube: self.cube + other.cube,
            targets: self.targets + other.targets,
        }
    }
}
