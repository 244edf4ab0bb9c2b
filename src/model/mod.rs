//! The reservoir in f64: corner-point geometry, topology and fields. No files, no GPU.

mod activity;
mod borders;
mod column;
pub mod corner_point;
mod depth_lists;
pub mod derivatives;
pub mod derived;
pub mod face_tree;
pub mod faults;
pub mod fields;
mod flat;
pub mod grid;
pub mod ids;
mod lattice;
mod outliers;
mod patches;
pub mod spaces;
pub mod summary;
pub mod synthetic;
pub mod topology;
mod vertices;

pub use activity::ColumnBits;
pub use column::Column;
pub use corner_point::Hexahedron;
pub use depth_lists::{DepthList, UsedDepths};
pub use face_tree::{FaceHit, FaceTree};
pub use faults::FaultFaces;
pub use fields::{CellField, Statistics, VertexField};
pub use grid::{Grid, GridInput, ModelError, Pillar};
pub use ids::{ActiveIndex, CellIndex, Dims, Ijk};
pub use lattice::LocalGrid;
pub use outliers::FAR;
pub use patches::{GridCell, Patch};
pub use spaces::{MapAxes, MapUnit, Space, Spaces};
pub use summary::Summary;
