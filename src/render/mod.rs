//! From a view to an image: the contract that whoever makes images fulfils, and those who do.
//!
//! An [`Executor`] is a device, or the like of one. It makes a [`Renderer`] for a grid, which holds what it needs of
//! that. An image is a [`Job`]: it is advanced until a deadline or run to its end, and dropped where nobody wants
//! it anymore. Whoever shows, saves, compares, times or picks uses these alone.

mod adapters;
pub mod cpu;
mod error;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod job;
pub mod line_of_sight;
pub mod plan;
pub mod revisions;
mod stats;

use std::sync::Arc;

use glam::{DVec2, DVec3};

pub use adapters::AdapterFacts;
pub use cpu::CpuExecutor;
pub use error::RenderError;
pub use job::Job;
pub use line_of_sight::{LineOfSight, SurfacePoint, TubePoint, tube_at};
pub use stats::{DeviceBytes, Frame, FrameStats, LightTimes, StorageError};

use crate::image::resampling::reduced;
use crate::model::{Grid, Ijk};
use crate::view::View;
use job::{Progress, Work};
use line_of_sight::{Sighting, SurfaceTree};

/// Who makes images.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExecutorInfo {
    /// Kind of executor: `gpu` or `cpu`.
    pub executor: &'static str,
    /// Name and kind of the adapter in one line.
    pub adapter: String,
    /// The adapter is a program on the CPU.
    pub is_software: bool,
    /// Why a GPU that is there is not used instead.
    pub problem: Option<String>,
}

/// A device, or the like of one.
pub trait Executor: Send + Sync {
    /// What it is.
    fn info(&self) -> ExecutorInfo;

    /// Prepares for a grid; what it keeps of that is freed with the renderer.
    ///
    /// # Errors
    /// When the grid does not fit.
    fn renderer(&self, grid: &Arc<Grid>) -> Result<Box<dyn Renderer>, RenderError>;

    /// Frees what dropped renderers have left.
    ///
    /// # Errors
    /// When the device was lost or reported an error.
    fn tidy(&self) -> Result<(), RenderError>;
}

/// A point that lies in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located {
    /// The cell.
    pub ijk: Ijk,
    /// (s, t, r) in [-1, 1]^3.
    pub parameters: DVec3,
    /// Value of the field there.
    pub value: f64,
}

/// Makes images of the views of one grid, and remakes only what a view changes.
pub trait Renderer {
    /// The grid.
    fn grid(&self) -> &Arc<Grid>;

    /// What preparing for the grid took.
    fn setup_times(&self) -> SetupTimes;

    /// Brings the values and drawn cells of a view up to date. Images do so by themselves; done before, it is no part
    /// of what the first one takes.
    ///
    /// # Errors
    /// When the values do not fit.
    fn prepare(&mut self, view: &View) -> Result<(), RenderError>;

    /// Begins an image.
    fn start<'a>(&'a mut self, view: &'a View) -> Job<'a, Frame> {
        Job::new(|progress| match view.sampling.supersample {
            1 => self.cast(view, progress),
            _ => Box::pin(async move {
                let mut frame = self.cast(&view.of_rays(), progress).await?;
                frame.image = reduced(frame.image, view.size);
                Ok(frame)
            }),
        })
    }

    /// Casts the rays of an image, given a view with a pixel for each of them ([`View::of_rays`]).
    fn cast<'a>(&'a mut self, rays: &'a View, progress: Progress) -> Work<'a, Frame>;

    /// Locates points of world space in the drawn cells of a view; `None` where a point lies in none.
    ///
    /// # Errors
    /// When the device reports an error.
    fn locate(
        &mut self,
        view: &View,
        points: &[DVec3],
    ) -> Result<Vec<Option<Located>>, RenderError>;

    /// What lies on the ray through a place in the image of a view (0 to 1, right and down); `None` where the ray
    /// misses all that is kept.
    ///
    /// # Errors
    /// When the device reports an error.
    fn look(&mut self, view: &View, at: DVec2) -> Result<Option<LineOfSight>, RenderError> {
        let grid = self.grid().clone();
        let Some(sighting) = Sighting::through(&grid, view, at, self.surface_tree()) else {
            return Ok(None);
        };
        let located = self.locate(view, &sighting.points())?;
        Ok(Some(sighting.located(&located)))
    }

    /// The faces of surfaces that [`Self::look`] has met, kept from one place to the next.
    fn surface_tree(&mut self) -> &mut SurfaceTree;

    /// Makes an image, and tells after each piece how much of it, or of what is prepared for it, is done.
    ///
    /// # Errors
    /// When there is none, and [`RenderError::Canceled`] where `progress` returned false.
    fn render(
        &mut self,
        view: &View,
        progress: &dyn Fn(f64) -> bool,
    ) -> Result<Frame, RenderError> {
        self.start(view).run(progress)
    }
}

/// Wall times of preparing for a grid.
#[derive(Debug, Clone, Copy, Default)]
pub struct SetupTimes {
    /// Bringing the grid to the device.
    pub upload: std::time::Duration,
    /// Building the acceleration grid.
    pub acceleration: std::time::Duration,
}

/// Names the adapter that is opened where nobody asks for another one, as `--adapter` does.
pub const ADAPTER: &str = "STRATARAY_ADAPTER";

/// Opens what makes images: where `adapter` is given, or else the variable [`ADAPTER`], the best adapter whose name
/// contains that, whatever the letter case, `cpu` being the CPU itself; otherwise the best GPU, and where there is none
/// the CPU.
///
/// # Errors
/// When there is no such adapter, or it lacks a limit.
pub fn executor(adapter: Option<&str>) -> Result<Arc<dyn Executor>, RenderError> {
    let variable = std::env::var(ADAPTER).ok().filter(|name| !name.is_empty());
    match adapter.or(variable.as_deref()) {
        Some(name) if name.eq_ignore_ascii_case("cpu") => Ok(Arc::new(CpuExecutor::default())),
        Some(name) => by_name(name),
        None => Ok(match best_gpu() {
            Ok(Some(gpu)) => gpu,
            Ok(None) => Arc::new(CpuExecutor::default()),
            Err(error) => Arc::new(CpuExecutor::instead_of(&error)),
        }),
    }
}

/// All adapters, the best one first.
pub fn adapters() -> Vec<AdapterFacts> {
    #[cfg(feature = "gpu")]
    return gpu::device::adapters();
    #[cfg(not(feature = "gpu"))]
    Vec::new()
}

/// The best GPU; `None` where there is none but in software, which the CPU does better by itself.
fn best_gpu() -> Result<Option<Arc<dyn Executor>>, RenderError> {
    #[cfg(feature = "gpu")]
    return Ok(gpu::GpuExecutor::hardware()?.map(|gpu| Arc::new(gpu) as Arc<dyn Executor>));
    #[cfg(not(feature = "gpu"))]
    Ok(None)
}

fn by_name(name: &str) -> Result<Arc<dyn Executor>, RenderError> {
    #[cfg(feature = "gpu")]
    return Ok(Arc::new(gpu::GpuExecutor::new(Some(name))?));
    #[cfg(not(feature = "gpu"))]
    Err(RenderError::NoSuchAdapter {
        wanted: name.to_owned(),
        known: "cpu".to_owned(),
    })
}
