//! RESQML 2.0.1: packages of XML objects (`.epc`) with arrays in HDF5 files beside them.
//!
//! Read are grids of rows, columns and layers (`IjkGridRepresentation`) with points or lines of their own, the
//! reference system they are in, their properties of cells, and time series. Arrays stay in the HDF5 files until they
//! are asked for.
//!
//! Arrays run as in the file: i fastest, then j, then k, whose direction is [`IjkGrid::is_upward`]. Points are in the
//! local reference system, [`Crs`]. What the objects mean is as the standard has it, and as resqpy writes it.
//!
//! ```no_run
//! use std::path::Path;
//! use strataray_parsers::resqml::Package;
//!
//! # fn main() -> Result<(), strataray_parsers::ParseError> {
//! let package = Package::open(Path::new("model.epc"))?;
//! let grid = package.geometry(&package.grids()[0])?;
//! for property in package.properties() {
//!     let values = package.values(property, grid.dims)?;
//! }
//! # Ok(())
//! # }
//! ```

mod arrays;
mod crs;
mod grid;
mod hdf5;
mod package;
mod parts;
mod property;
mod xml;

pub use crs::Crs;
pub use grid::{IjkGrid, LineKind, Lines, Points, Split};
pub use package::{GridPart, Package};
pub use parts::is_package;
pub use property::{Property, PropertyClass, TimeIndex, TimeSeries};
