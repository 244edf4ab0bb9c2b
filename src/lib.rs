//! StrataRay: volume ray casting of corner-point reservoir grids and their simulation results.
//!
//! [`Session`] is the short way in: open a case, read values, locate points, make images.
//!
//! ```no_run
//! use strataray::{Session, picture};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut session = Session::open("samples/scissor/SCISSOR.EGRID")?;
//! let scene = session.scene(r#"{"property": "SOIL", "step": "last", "size": [1200, 800]}"#)?;
//! let made = session.picture(&scene)?;
//! picture::write_png("soil.png".as_ref(), made.size, &made.pixels)?;
//! # Ok(())
//! # }
//! ```
//!
//! Each room imports only from those before it:
//!
//! | room | what |
//! | --- | --- |
//! | [`image`] | images as pixels, colors, and how far two images are apart |
//! | [`model`] | the corner-point grid: cells, topology, faults, fields; models by formula |
//! | [`transfer`] | values to color and extinction |
//! | [`mod@case`] | a model with its properties and steps, from files ([`case::load`]) |
//! | [`scene`] | what a scene file says |
//! | [`view`] | a scene resolved against a case: what is shown, from where, and how it looks |
//! | [`export`] | cells, values and surfaces as files of other programs |
//! | [`render`] | from a view to an image, on the GPU or on the CPU |
//! | [`mod@reference`] | the same in plain f64 on the CPU: the truth that the others are measured against |
//! | [`picking`] | what is seen at a place in the image |
//! | [`picture`] | image files, legends, axes, films |
//! | [`session`] | the short way in |
//! | [`mod@compare`] | strategies side by side |
//! | [`viewer`] | the window |

pub mod case;
pub mod compare;
mod draft;
pub mod export;
pub mod image;
pub mod model;
pub mod picking;
pub mod picture;
pub mod reference;
pub mod render;
pub mod scene;
pub mod session;
pub mod transfer;
pub mod view;
#[cfg(feature = "viewer")]
pub mod viewer;

pub use session::{Error, Session};
pub use strataray_parsers::{self as parsers, ParseError};
