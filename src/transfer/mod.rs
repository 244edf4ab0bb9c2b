//! From a value to color and extinction.

pub mod boundaries;
pub mod coloring;
pub mod function;
pub mod kinds;
pub mod opacity;
pub mod presets;
mod scale;
mod shares;

pub use function::{Curve, TransferFunction};
pub use scale::Scale;
