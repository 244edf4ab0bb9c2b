//! What every executor starts from, made without a device: the grid in compact form, the numbers of a frame,
//! transfer tables, and lists of faces.

mod accel;
mod cells;
pub mod columns;
mod compact_grid;
pub mod faces;
pub mod frame;
pub mod layout;
pub mod surfaces;
pub mod transfer;

pub use cells::{drawn_words, ghost_words, values};
pub use compact_grid::{CompactGrid, GridFacts};
