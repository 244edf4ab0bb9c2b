//! A scene resolved against a case: what is shown, from where, how it looks, and how it is sampled.

pub mod bounds;
pub mod camera;
pub mod clip;
mod colors;
mod error;
pub mod facts;
mod filter;
pub mod framing;
pub mod ghosts;
mod half_turns;
pub mod lighting;
pub mod look;
mod resolve;
mod sequence;
pub mod step;
pub mod surfaces;
pub mod voxels;

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

pub use bounds::model_corners;
pub use camera::Camera;
pub use clip::ClipPlane;
pub use error::SceneError;
pub use facts::Facts;
pub use framing::{Direction, Extents, Subject};
pub use half_turns::{NamedView, TurnAxis, half_turns};
pub use lighting::Lighting;
pub use look::default_property;
pub use resolve::resolve;
pub use sequence::{Sequence, Turn};
pub use surfaces::Surfaces;

use crate::image::Blending;
use crate::model::{CellField, FaultFaces, Grid, Spaces};
use crate::scene::{CameraSpec, Interpolation, LibcSettings, SrgSettings, StrategyKind};
use crate::transfer::TransferFunction;
use bounds::box_corners;
use ghosts::Ghosts;
use resolve::{camera as placed, checked_size};

/// All that a renderer needs beside the grid: what every strategy and the reference integrate.
///
/// **Units**: lengths in world space, the grid's length unit.
#[derive(Debug, Clone)]
pub struct View {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The camera in world space.
    pub camera: Camera,
    /// Where the model is.
    pub world: World,
    /// What is shown of it.
    pub shown: Shown,
    /// How that looks.
    pub style: Style,
    /// How rays sample it.
    pub sampling: Sampling,
    /// What is written beside and over it.
    pub notes: Notes,
}

/// Where a model is in world space.
#[derive(Debug, Clone)]
pub struct World {
    /// Grid to world and back.
    pub spaces: Spaces,
    /// Factor on depth in world space.
    pub vertical_exaggeration: f64,
    /// Box of the active cells in world space.
    pub bounds: [DVec3; 2],
    /// Corners of the model's box in world space; bit n of the index is the end along axis n.
    pub corners: [DVec3; 8],
    /// The cells that cameras frame.
    pub subject: Arc<Subject>,
}

/// What a view shows of a case.
#[derive(Debug, Clone)]
pub struct Shown {
    /// Name of the property.
    pub property: String,
    /// Step.
    pub step: usize,
    /// Its values, in the scale of the transfer function; see [`View::true_value`].
    pub field: Arc<CellField>,
    /// How values vary inside a cell.
    pub interpolation: Interpolation,
    /// By active index: true where the cell is drawn (has thickness and a value, passes the filter).
    pub drawn: Arc<Vec<bool>>,
    /// Where inactive cells are shown: the grid that field and selection go by then.
    pub ghosts: Option<Arc<Ghosts>>,
    /// Planes that cut parts away.
    pub clip: Vec<ClipPlane>,
    /// Ends in world space of the connections that are marked: those of drawn cells.
    pub connections: Arc<Vec<[DVec3; 2]>>,
    /// Which faces lie on faults that have a name.
    pub named_faults: Arc<FaultFaces>,
    /// By number of the named faults: true where the fault is drawn, of which those without a name are none;
    /// all faults where absent.
    pub chosen_faults: Option<Arc<[bool]>>,
}

/// How what is shown looks.
#[derive(Debug, Clone)]
pub struct Style {
    /// Background in sRGB, 0..1.
    pub background: [f64; 3],
    /// Value to color and extinction.
    pub transfer: TransferFunction,
    /// Values of the step shown lie below its range, and above.
    pub beyond: [bool; 2],
    /// The numbers in which colors are shaded and blended.
    pub blending: Blending,
    /// Surfaces in the volume.
    pub surfaces: Surfaces,
    /// Occlusion and lights.
    pub lighting: Lighting,
}

/// How rays sample what is shown.
#[derive(Debug, Clone)]
pub struct Sampling {
    /// The strategy asked for.
    pub strategy: StrategyKind,
    /// Samples lie at distances `(n + 1/2) * step` from where rays start.
    pub step: f64,
    /// Transmittance at which a ray ends.
    pub early_termination: f64,
    /// Settings of the cell-to-cell strategy.
    pub libc: LibcSettings,
    /// Settings of the resampled-grid strategy.
    pub srg: SrgSettings,
}

/// What is written beside and over an image.
#[derive(Debug, Clone)]
pub struct Notes {
    /// Draw the box and axes.
    pub has_box: bool,
    /// Draw legend and title.
    pub has_legend: bool,
    /// What is drawn in numbers, for the line below the picture; `None` where that is hidden.
    pub facts: Option<Arc<Facts>>,
}

impl View {
    /// The same view by a strategy.
    #[must_use]
    pub fn by(&self, strategy: StrategyKind) -> Self {
        let mut view = self.clone();
        view.sampling.strategy = strategy;
        view
    }

    /// The same view from another camera, in another size; nothing is read.
    ///
    /// # Errors
    /// When camera or size are not allowed.
    pub fn seen_from(&self, camera_spec: &CameraSpec, size: [u32; 2]) -> Result<Self, SceneError> {
        let size = checked_size(size)?;
        let of = (&*self.world.subject, &self.world.corners);
        let camera = placed(camera_spec, size, of, self.notes.has_box)?;
        Ok(Self {
            size,
            camera,
            ..self.clone()
        })
    }

    /// Smallest and largest corner in grid space of the drawn cells of `grid` (the case's), ghosts aside; `None`
    /// where none is drawn.
    pub fn drawn_bounds(&self, grid: &Grid) -> Option<[DVec3; 2]> {
        let drawn = self.drawn_active(grid);
        let cells = grid.active_cells().par_iter().zip(drawn);
        grid.bounds_of(cells.filter_map(|(cell, drawn)| drawn.then(|| grid.dims().ijk(*cell))))
    }

    /// Corners in world space of a box given by its smallest and largest corner in grid space; bit n of the
    /// index is the end along axis n.
    pub fn corners_of(&self, bounds: [DVec3; 2]) -> [DVec3; 8] {
        box_corners(&self.world.spaces, bounds)
    }

    /// The value that a number of [`Shown::field`], or between such numbers, stands for.
    pub fn true_value(&self, shown: f64) -> f64 {
        self.style.transfer.scale.true_value(shown)
    }

    /// True where rays pass through something: between the faces of solid cells there is nothing but ghosts.
    pub fn casts_rays(&self) -> bool {
        !self.style.surfaces.solid || self.shown.ghosts.is_some()
    }

    /// Color of a position in the range of values, in the numbers that are blended.
    pub fn color_at(&self, position: f64) -> [f64; 3] {
        self.style
            .blending
            .of_srgb(self.style.transfer.srgb(position))
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }
}
