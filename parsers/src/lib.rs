//! Readers and writers of Eclipse-style reservoir files, as written: no geometry, no GPU.
//!
//! Three levels: bytes (a memory map, records, tokens), typed records ([`egrid`], [`init`],
//! [`restart`], [`deck`]), and the [`case`] that finds the files belonging together. Bad files
//! end in a [`ParseError`] that names file, keyword and place; no reader panics, prints, or
//! allocates by a count that the remaining bytes do not cover.

pub mod arrays;
mod bytes;
pub mod calendar;
pub mod case;
pub mod cells;
pub mod deck;
pub mod egrid;
pub mod error;
mod geometry;
pub mod init;
#[cfg(feature = "mmap")]
mod mapped;
mod parallel;
pub mod records;
pub mod restart;
pub mod units;

pub use bytes::FileBytes;
pub use error::{At, ErrorKind, ParseError, Warning, Warnings};
