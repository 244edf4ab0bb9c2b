//! What a strategy is to a frame.

use crate::model::Grid;
use crate::render::DeviceBytes;
use crate::render::gpu::faces::FaceList;
use crate::render::gpu::{Gpu, GpuGrid, Round, flag, grid_upload, surfaces};
use crate::render::job::{Progress, Work};
use crate::render::plan::light::Shading;
use crate::view::{Surfaces, View};

/// What a strategy prepares from.
pub struct Preparation<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The grid in f64.
    pub model: &'a Grid,
    /// The grid on the device, with field and selection of the view.
    pub grid: &'a GpuGrid,
    /// What is looked at.
    pub view: &'a View,
    /// The boundary faces of the drawn cells, for a strategy that needs them.
    pub faces: Option<&'a FaceList>,
    /// Told the fraction done.
    pub progress: &'a Progress,
}

/// Options that are constants of every strategy's pipelines.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Common {
    grid: grid_upload::Constants,
    shading: Shading,
    surfaces: Surfaces,
    /// A cube is shown beside the model.
    cube: bool,
}

impl Common {
    /// What grid and view ask for.
    pub fn of(what: &Preparation<'_>) -> Self {
        Self {
            grid: what.grid.constants(),
            shading: Shading::of(&what.view.style.lighting),
            surfaces: what.view.style.surfaces,
            cube: what.view.shown.cube.is_some(),
        }
    }

    /// True where samples cast rays over cones.
    pub(super) fn casts_rays(self) -> bool {
        self.shading.casts_rays()
    }

    /// Names and values of the shaders' `override` constants.
    pub fn pairs(self) -> impl Iterator<Item = (&'static str, f64)> {
        let [grid, shading] = [self.grid.pairs().to_vec(), self.shading.pairs().to_vec()];
        let surfaces = surfaces::constants(self.surfaces);
        let cube = [("CUBE", flag(self.cube))];
        grid.into_iter().chain(shading).chain(surfaces).chain(cube)
    }
}

/// What a strategy gives to a frame.
///
/// The bind groups 0 frame, 1 grid and 2 transfer function are the same for all; group 3 is the
/// strategy's own. A tile is made in rounds: each is one submission that takes every ray further, until
/// the shader has counted all as finished.
pub trait RenderStrategy {
    /// Bytes of the state of a ray between rounds.
    fn ray_state_bytes(&self) -> u64;

    /// Loop iterations that a ray makes in a round at least: the more a round costs beside them, the
    /// fewer, so that tiles are large.
    fn least_work(&self) -> u64 {
        500
    }

    /// True where it goes by the boundary faces: then they are listed before it prepares.
    fn needs_faces(&self) -> bool {
        false
    }

    /// Brings up to date what the strategy keeps beside the grid.
    ///
    /// # Errors
    /// When the device refuses.
    fn prepare<'a>(&'a mut self, what: &'a Preparation<'a>) -> Work<'a, ()>;

    /// Bytes of what the strategy keeps beside the grid.
    fn bytes(&self) -> DeviceBytes {
        DeviceBytes::default()
    }

    /// Records one round of a tile.
    fn encode(&mut self, round: &Round<'_>, encoder: &mut wgpu::CommandEncoder);
}
