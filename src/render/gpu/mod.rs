//! Everything that owns a GPU object: device, shaders, the compact grid, frames and probes.

pub mod accel;
pub mod bind_groups;
pub mod columns;
pub mod cones;
pub mod device;
mod error;
pub mod extinction;
pub mod faces;
pub mod frame;
pub mod grid_upload;
pub mod illumination;
pub mod layout;
pub mod pipeline;
pub mod probe;
pub mod pyramids;
pub mod resample;
pub mod round;
pub mod shader;
pub mod slabs;
pub mod strategies;
pub mod strategy;
pub mod surfaces;
mod target;
pub mod tiles;
pub mod transfer_tables;
mod uniforms;
pub mod volume;

pub use device::Gpu;
pub use error::GpuError;
pub use frame::{Drawing, FrameRenderer, FrameStats};
pub use grid_upload::{GpuBytes, GpuGrid, Versions};
pub use pipeline::{Pipeline, RasterPipeline, flag};
pub use round::{Place, Round};
