//! Everything that owns a GPU object: device, shaders, the compact grid, frames and probes.

pub mod bind_groups;
mod cube;
pub mod device;
pub mod executor;
pub mod extinction;
pub mod faces;
pub mod frame;
pub mod grid_upload;
pub mod illumination;
mod kept;
pub mod pipeline;
pub mod probe;
pub mod pyramids;
mod renderer;
pub mod resample;
pub mod round;
mod sat;
pub mod shader;
pub mod slabs;
pub mod strategies;
pub mod strategy;
pub mod surfaces;
mod target;
pub mod tiles;
pub mod transfer_tables;
mod vct;
pub mod volume;

pub use device::Gpu;
pub use executor::GpuExecutor;
pub use frame::{Drawing, FrameRenderer};
pub use grid_upload::GpuGrid;
pub use pipeline::{Pipeline, RasterPipeline, flag};
pub use renderer::GpuRenderer;
pub use round::{Place, Round};
