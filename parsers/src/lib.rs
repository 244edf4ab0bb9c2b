//! Readers of Eclipse-style reservoir files, as written: no geometry, no GPU.
//!
//! Three levels: bytes (a memory map, records, tokens), typed records ([`egrid`], [`init`],
//! [`restart`], [`deck`]), and the [`case`] that finds the files belonging together. Bad files
//! end in a [`ParseError`] that names file, keyword and place; no reader panics, prints, or
//! allocates by a count that the remaining bytes do not cover.

pub mod error;
pub mod mapped;

pub use error::{At, ParseError, Warning, Warnings};
pub use mapped::MappedFile;
