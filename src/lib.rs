//! StrataRay: volume ray casting of corner-point reservoir grids and their simulation results.
//!
//! Each room imports only from those before it:
//!
//! | room | what |
//! | --- | --- |
//! | [`image`] | pictures as pixels, colors, and how far two pictures are apart |
//! | [`model`] | the corner-point grid: cells, topology, faults, fields; models by formula |
//! | [`transfer`] | values to color and extinction |
//! | [`mod@case`] | a model with its properties and steps; from files ([`case::load`]) and into them ([`case::save`]) |
//! | [`scene`] | what a scene file says |
//! | [`view`] | a scene resolved against a case: what is shown, from where, and how it looks |
//! | [`render`] | from a view to an image, on the GPU |
//! | [`mod@reference`] | the same in plain f64 on the CPU: the truth that the others are measured against |
//! | [`picking`] | what is seen at a place in the image |
//! | [`picture`] | image files, legends, axes, films |
//! | [`mod@compare`] | strategies side by side |
//! | [`viewer`] | the window |

pub mod case;
#[cfg(feature = "gpu")]
pub mod compare;
pub mod image;
pub mod model;
#[cfg(feature = "gpu")]
pub mod picking;
pub mod picture;
pub mod reference;
#[cfg(feature = "gpu")]
pub mod render;
pub mod scene;
pub mod transfer;
pub mod view;
#[cfg(feature = "viewer")]
pub mod viewer;
