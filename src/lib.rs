//! StrataRay: volume ray casting of corner-point reservoir grids and their simulation results.
//!
//! Modules in the order in which data flows:
//! [`load`] turns files into a [`case::Case`] (a [`model`] and its results; [`save`] writes the files
//! of synthetic ones), a [`scene`] says what to look at and is resolved against the case, [`transfer`]
//! maps values to color and extinction, [`gpu`] holds the compact grid on the device, [`strategies`]
//! cast the rays, a [`renderer`] remakes only what a view changes, [`picking`] finds what lies under the pointer, [`mod@reference`] does the same on
//! the CPU in plain f64, [`metrics`] and [`mod@compare`] say how far pictures are apart, and
//! [`picture`] turns the result into a file or a film.

pub mod case;
pub mod compare;
pub mod filming;
pub mod gpu;
pub mod load;
pub mod markdown;
pub mod metrics;
pub mod model;
pub mod picking;
pub mod picture;
pub mod reference;
pub mod renderer;
pub mod save;
pub mod scene;
pub mod strategies;
pub mod transfer;
pub mod viewer;
