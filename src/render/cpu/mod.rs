//! The executor on the CPU: rays in Rust, on all threads. It reads the same plan as the GPU's shaders, and its files
//! have the names of those that they are the twins of.

mod boundary;
mod cell;
mod edges;
mod executor;
mod facing;
mod frame;
mod grid;
mod libc;
mod locate;
mod picture;
mod plts;
mod projection;
mod raster;
mod renderer;
mod scene;
mod section;
mod shading;
mod surfaces;
mod tally;
mod thorough;
mod topology;
mod transfer;

pub use executor::CpuExecutor;
