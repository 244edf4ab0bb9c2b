//! From a view to a picture, on a device.

pub mod gpu;
mod renderer;

pub use renderer::{Frame, Renderer};
