//! Everything that owns a GPU object: device, shaders, the compact grid, frames and probes.

pub mod accel;
pub mod device;
pub mod frame;
pub mod grid_upload;
pub mod layout;
pub mod probe;
pub mod shader;
pub mod tiles;

pub use device::{Gpu, GpuError};
pub use frame::{FrameRenderer, FrameStats};
pub use grid_upload::{GpuBytes, GpuGrid};
