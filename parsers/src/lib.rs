//! Readers and writers of Eclipse-style reservoir files, and of regular volumes such as seismic ([`volume`]), as written:
//! no geometry, no GPU.
//!
//! Three levels: bytes (records, tokens), typed records ([`egrid`], [`init`],
//! [`restart`], [`wells`], [`paths`], [`summary`], [`deck`], [`roff`], [`resqml`]), and the [`case`] that finds the files belonging together. Bad files
//! end in a [`ParseError`] that names file, keyword and place; no reader panics, prints, or
//! allocates by a count that the remaining bytes do not cover.
//!
//! Every reader takes a path, or [`FileBytes`]: bytes in memory with a name for errors. Decks take a path and
//! [`deck::DeckFiles`], where the files they include are found too. What is odd and does not stop a reader goes
//! to [`Warnings`].
//!
//! # A grid
//!
//! ```
//! use strataray_parsers::{Warnings, egrid::Egrid, records::RecordWriter};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut writer = RecordWriter::new(Vec::new());
//! writer.inte("GRIDHEAD", &[1, 1, 1, 1])?;
//! writer.real("COORD", &[0.0; 6 * 4])?;
//! writer.real("ZCORN", &[0.0, 0.0, 0.0, 0.0, 10.0, 10.0, 10.0, 10.0])?;
//! let bytes = writer.finish()?;
//!
//! let grid = Egrid::from_bytes(("CASE.EGRID", bytes), &mut Warnings::default())?;
//! assert_eq!(grid.dims, [1, 1, 1]);
//! // Eight depths per cell.
//! assert_eq!(grid.zcorn[7], 10.0);
//! # Ok(())
//! # }
//! ```
//!
//! # Static properties
//!
//! ```
//! use strataray_parsers::{Warnings, cells::Head, init};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let head = Head { dims: [3, 1, 1], active: 2, ..Head::default() };
//! let bytes = init::write(Vec::new(), &head, [("PORO", vec![0.2, 0.3])])?;
//!
//! let arrays = init::from_bytes(("CASE.INIT", bytes), &mut Warnings::default())?;
//! let poro = arrays.find("PORO").ok_or("no PORO")?;
//! // One value per active cell.
//! assert_eq!(arrays.values(poro)?, [0.2, 0.3]);
//! # Ok(())
//! # }
//! ```
//!
//! # Time steps
//!
//! ```
//! use strataray_parsers::{Warnings, cells::Head, restart, wells::Well};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let head = Head { active: 1, date: "2001-06-30".into(), ..Head::default() };
//! let mut writer = restart::RestartWriter::new(Vec::new());
//! writer.step(4, 31.0, &head, &[Well::named("P1")], [("PRESSURE", vec![250.0])])?;
//! let bytes = writer.finish()?;
//!
//! let steps = restart::unified_from_bytes(("CASE.UNRST", bytes), &mut Warnings::default())?;
//! assert_eq!((steps[0].report, steps[0].days), (4, 31.0));
//! assert_eq!(steps[0].wells()?, ["P1"]);
//! # Ok(())
//! # }
//! ```
//!
//! # A deck
//!
//! ```
//! use std::path::Path;
//! use strataray_parsers::{ErrorKind, Warnings, deck::{Grdecl, MemoryFiles}};
//!
//! # fn main() -> Result<(), strataray_parsers::ParseError> {
//! let deck = "SPECGRID\n 1 1 1 1 F /\nCOORD\n 24*0 /\nZCORN\n 4*0 4*10 /\nPORO\n 0.25 /\n";
//! let read = |text: String| {
//!     let path = Path::new("CASE.GRDECL");
//!     let files = MemoryFiles::from_iter([(path, text)]);
//!     Grdecl::read_from(&files, path, &[], &mut Warnings::default())
//! };
//! let grid = read(deck.to_owned())?;
//! assert_eq!(grid.properties[0].values, [0.25]);
//!
//! let error = read(deck.replace("ZCORN", "DEPTHS")).unwrap_err();
//! assert_eq!(error.kind, ErrorKind::MissingKeyword);
//! assert_eq!(error.to_string(), "CASE.GRDECL: no grid: ZCORN is missing: open the file that has the grid");
//! # Ok(())
//! # }
//! ```
//!
//! # Features
//!
//! `parallel`, on by default: arrays are read and converted in several threads. Without it, as for a browser, in the one
//! that asks.

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
mod parallel;
pub mod paths;
mod radial;
pub mod records;
pub mod resqml;
pub mod restart;
pub mod roff;
pub mod summary;
pub mod units;
pub mod volume;
pub mod wells;

pub use bytes::FileBytes;
pub use error::{At, ErrorKind, ParseError, Warning, Warnings};
