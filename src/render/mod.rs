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
pub use error::RenderError;
pub use job::Job;
pub use line_of_sight::{LineOfSight, SurfacePoint};
pub use stats::{DeviceBytes, Frame, FrameStats, LightTimes};

use crate::model::{Grid, Ijk};
use crate::view::View;

/// Who makes images.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExecutorInfo {
    /// Kind of executor: `gpu` or `cpu`.
    pub executor: &'static str,
    /// Name and kind of the adapter in one line.
    pub adapter: String,
    /// The adapter is a program on the CPU.
    pub is_software: bool,
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
    fn start<'a>(&'a mut self, view: &'a View) -> Job<'a, Frame>;

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
    fn look(&mut self, view: &View, at: DVec2) -> Result<Option<LineOfSight>, RenderError>;

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

/// Opens the best executor, or the best one whose adapter's name contains `adapter`, whatever the letter case; `cpu`
/// is the one without an adapter.
///
/// # Errors
/// When there is no (such) adapter, or it lacks a limit.
pub fn executor(adapter: Option<&str>) -> Result<Arc<dyn Executor>, RenderError> {
    match adapter {
        Some(name) if name.eq_ignore_ascii_case("cpu") => Ok(Arc::new(cpu::CpuExecutor)),
        adapter => by_adapter(adapter),
    }
}

/// All adapters, the best one first.
pub fn adapters() -> Vec<AdapterFacts> {
    #[cfg(feature = "gpu")]
    return gpu::device::adapters();
    #[cfg(not(feature = "gpu"))]
    Vec::new()
}

#[cfg(feature = "gpu")]
fn by_adapter(adapter: Option<&str>) -> Result<Arc<dyn Executor>, RenderError> {
    Ok(Arc::new(gpu::GpuExecutor::new(adapter)?))
}

#[cfg(not(feature = "gpu"))]
fn by_adapter(adapter: Option<&str>) -> Result<Arc<dyn Executor>, RenderError> {
    match adapter {
        None => Ok(Arc::new(cpu::CpuExecutor)),
        Some(name) => Err(RenderError::NoSuchAdapter {
            wanted: name.to_owned(),
            known: "cpu".to_owned(),
        }),
    }
}
