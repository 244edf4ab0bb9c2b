//! A scene resolved against a case: what is shown, from where, how it looks, and how it is sampled.

pub mod bounds;
pub mod camera;
pub mod clip;
mod colors;
pub mod cube;
mod error;
pub mod facts;
mod filter;
pub mod framing;
pub mod ghosts;
mod grids;
mod half_turns;
pub mod lighting;
pub mod look;
mod resolve;
mod sequence;
pub mod step;
pub mod surfaces;
pub mod voxels;
pub mod wells;

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

pub use bounds::model_corners;
pub use camera::Camera;
pub use clip::ClipPlane;
pub use cube::ShownCube;
pub use error::SceneError;
pub use facts::Facts;
pub use framing::{Direction, Extents, Subject};
pub use half_turns::{NamedView, TurnAxis, half_turns};
pub use lighting::Lighting;
pub use look::default_property;
pub use resolve::{resolve, warnings};
pub use sequence::{Sequence, Turn};
pub use surfaces::Surfaces;
pub use wells::Wells;

use crate::case::Units;
use crate::image::Blending;
use crate::model::{CellField, FaultFaces, Grid, Space, Spaces};
use crate::scene::{
    CameraSpec, Integration, Interpolation, LibcSettings, PltsSettings, SrgSettings, Storage,
    StrategyKind,
};
use crate::transfer::TransferFunction;
use bounds::box_corners;
use ghosts::Ghosts;
pub use grids::ShownGrids;
use resolve::{Framed, camera as placed, checked_size};

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

impl From<crate::scene::Space> for Space {
    fn from(space: crate::scene::Space) -> Self {
        match space {
            crate::scene::Space::Map => Self::Map,
            crate::scene::Space::Ijk => Self::Ijk,
        }
    }
}

impl From<crate::scene::Units> for Units {
    fn from(units: crate::scene::Units) -> Self {
        match units {
            crate::scene::Units::File => Self::default(),
            crate::scene::Units::Metric => Self::METRIC,
            crate::scene::Units::Field => Self::FIELD,
            crate::scene::Units::Lab => Self::LAB,
            crate::scene::Units::PvtM => Self::PVT_M,
        }
    }
}

/// Where a model is in world space.
#[derive(Debug, Clone)]
pub struct World {
    /// Grid to world and back.
    pub spaces: Spaces,
    /// True places, or those by I, J and K.
    pub space: Space,
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
    /// Which cells are drawn, and their values.
    pub cells: ShownCells,
    /// Planes that cut parts away.
    pub clip: Vec<ClipPlane>,
    /// Ends in world space of the connections that are marked: those of drawn cells.
    pub connections: Arc<Vec<[DVec3; 2]>>,
    /// Wells of the step.
    pub wells: Arc<Wells>,
    /// Which faces lie on faults that have a name.
    pub named_faults: Arc<FaultFaces>,
    /// By number of the named faults: true where the fault is drawn, of which those without a name are none;
    /// all faults where absent.
    pub chosen_faults: Option<Arc<[bool]>>,
    /// A regular volume that is drawn together with the cells.
    pub cube: Option<Arc<ShownCube>>,
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
    /// Rays along each axis of a pixel.
    pub supersample: u32,
    /// Settings of the cell-to-cell strategy.
    pub libc: LibcSettings,
    /// Settings of point location with topological search.
    pub plts: PltsSettings,
    /// Settings of the resampled-grid strategy.
    pub srg: SrgSettings,
    /// How depths and values are held.
    pub storage: Storage,
}

impl Sampling {
    /// The same beside a cube: where there is one, by samples of cells, no segments.
    fn beside(mut self, cube: Option<&ShownCube>) -> Self {
        if cube.is_some() {
            self.libc.integration = Integration::Samples;
            self.plts.integration = Integration::Samples;
        }
        self
    }
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
    /// The units in which numbers are written; all others of a view are in those of the files.
    pub units: Units,
    /// What the scene asks for in vain, one sentence each.
    pub warnings: Vec<String>,
}

/// The cells that rays meet, and their values.
#[derive(Debug, Clone)]
pub struct ShownCells {
    /// Values by active index, in the scale of the transfer function; see [`View::true_value`]. They are there
    /// whether or not the cell is drawn.
    pub field: Arc<CellField>,
    /// How values vary inside a cell.
    pub interpolation: Interpolation,
    /// By active index: true where the cell is drawn (has thickness and a value, passes the filter).
    pub drawn: Arc<Vec<bool>>,
    /// A filter hides cells by their place or value.
    pub is_filtered: bool,
    /// Where inactive cells are shown: these too, beside the drawn ones.
    pub ghosts: Option<Arc<Ghosts>>,
}

impl ShownCells {
    /// Cells of a field, by active index, of which `drawn` are drawn.
    pub fn new(field: Arc<CellField>, drawn: Vec<bool>, interpolation: Interpolation) -> Self {
        Self {
            field,
            interpolation,
            drawn: Arc::new(drawn),
            is_filtered: false,
            ghosts: None,
        }
    }

    /// True where another selection of the same case's cells has the same values, and draws the same cells.
    pub fn is_same(&self, other: &Self) -> bool {
        let kinds = |s: &Self| (s.interpolation, s.is_filtered, s.ghosts.is_some());
        // Pointers first: `Arc` compares them where equality is exact.
        kinds(self) == kinds(other) && self.field == other.field && self.drawn == other.drawn
    }

    /// By active index the cells whose values count for averages at vertices and for ranges; `None` where all do.
    /// Of a filtered view these are the drawn ones, so that no value shows of a cell that is filtered away.
    pub fn valued(&self) -> Option<&[bool]> {
        self.is_filtered.then_some(&self.drawn)
    }

    /// Smallest and largest value of [`Self::field`] among these cells; `None` where no value is defined.
    pub fn value_range(&self) -> Option<[f64; 2]> {
        let statistics = self.field.statistics_of(self.valued())?;
        Some([statistics.min, statistics.max])
    }

    /// Given the case's grid: the grid that rays pass, and by its active index the cells of it that are drawn.
    pub fn in_grid<'a>(&'a self, grid: &'a Grid) -> (&'a Grid, &'a [bool]) {
        match &self.ghosts {
            None => (grid, &self.drawn),
            Some(ghosts) => (&ghosts.grid, &ghosts.drawn),
        }
    }
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
        let size = checked_size(size, self.sampling.supersample)?;
        let (world, cube) = (&self.world, self.shown.cube.as_deref());
        let of = Framed::new(&world.subject, &world.corners, cube);
        let camera = placed(camera_spec, size, &of, self.notes.has_box)?;
        Ok(Self {
            size,
            camera,
            ..self.clone()
        })
    }

    /// The same view with a pixel for each ray. Lines are as wide there as [`Sampling::supersample`] pixels.
    #[must_use]
    pub fn of_rays(&self) -> Self {
        Self {
            size: self.size.map(|n| n * self.sampling.supersample),
            ..self.clone()
        }
    }

    /// Smallest and largest corner in grid space of the drawn cells of `grid` (the case's), ghosts aside; `None`
    /// where none is drawn.
    pub fn drawn_bounds(&self, grid: &Grid) -> Option<[DVec3; 2]> {
        let cells = grid.active_cells().par_iter().zip(&*self.shown.cells.drawn);
        grid.bounds_of(cells.filter_map(|(cell, drawn)| drawn.then(|| grid.dims().ijk(*cell))))
    }

    /// By active index of `grid` (the case's): the drawn cells that clip planes do not cut away whole.
    pub fn seen_cells(&self, grid: &Grid) -> Vec<bool> {
        let Shown { cells, clip, .. } = &self.shown;
        facts::uncut(grid, &cells.drawn, clip, &self.world.spaces)
    }

    /// Corners in world space of a box given by its smallest and largest corner in grid space; bit n of the
    /// index is the end along axis n.
    pub fn corners_of(&self, bounds: [DVec3; 2]) -> [DVec3; 8] {
        box_corners(&self.world.spaces, bounds)
    }

    /// The value that a number of [`ShownCells::field`], or between such numbers, stands for.
    pub fn true_value(&self, shown: f64) -> f64 {
        self.style.transfer.scale.true_value(shown)
    }

    /// True where rays pass through something: between the faces of solid cells there is nothing but ghosts.
    pub fn casts_rays(&self) -> bool {
        !self.style.surfaces.solid || self.shown.cells.ghosts.is_some()
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
