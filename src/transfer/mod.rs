//! From a value to color and extinction.

pub mod function;
pub mod presets;

pub use function::TransferFunction;
