//! The executor on the CPU: rays in Rust, on all threads. It reads the same plan as the GPU's shaders, and its files
//! have the names of those that they are the twins of.

mod along;
mod around;
mod boundary;
mod bricks;
mod cell;
mod cone_rays;
mod cones;
mod each;
mod edges;
mod executor;
mod extinction;
mod facing;
mod frame;
mod grid;
mod illuminate;
mod illumination;
mod kept;
mod lamps;
mod libc;
mod light;
mod locate;
mod mean;
mod picture;
mod pieces;
mod plts;
mod projection;
mod random;
mod raster;
mod renderer;
mod resample;
mod samples;
mod sat;
mod scene;
mod section;
mod segments;
mod shading;
mod srg;
mod surfaces;
mod tally;
mod thorough;
mod topology;
mod transfer;
mod vct;
mod volume;

pub use executor::CpuExecutor;
