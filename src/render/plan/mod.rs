//! What every executor starts from, made without a device: the grid in compact form, the numbers of a frame,
//! transfer tables, lists of faces, and what light and volumes are made of.

mod accel;
pub mod around;
pub mod bricks;
mod cells;
pub mod columns;
mod compact_grid;
pub mod cones;
pub mod cube;
pub mod extinction;
mod face_bins;
pub mod faces;
pub mod frame;
pub mod layout;
pub mod light;
mod lists;
pub mod majorants;
pub mod occluders;
pub mod packing;
pub mod sat;
pub mod srg;
pub mod surfaces;
pub mod transfer;
pub mod tubes;
pub mod vct;
pub mod visible;
pub mod volume;

pub use cells::{Values, cell_bits, drawn_words, ghost_words};
pub use compact_grid::{CompactGrid, GridFacts, list_entry};
pub use face_bins::face_bins;
