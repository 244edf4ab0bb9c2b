//! The truth that images are measured against: the same integral on the CPU, in plain f64.
//!
//! Nothing here is shared with the device: cells are found by a tree of boxes and Newton's method,
//! every sample of the lattice inside the model's box is located anew, and nothing is remembered
//! from one sample to the next. Light is found by many rays over a cone from every sample. Rays meet
//! surfaces where they meet the triangles of faces, found by a tree of boxes too.

mod cell;
mod integrate;
mod locate;
mod render;
#[cfg(test)]
mod tests;
mod tree;

pub use integrate::{Integrator, Ray, value_at, values_at};
pub use locate::{Located, Locator};
pub use render::render;
