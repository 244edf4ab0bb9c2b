//! ROFF: grids and properties of RMS, binary (`roff-bin`) or as text (`roff-asc`).
//!
//! A file is a list of tags with items, single ones or arrays of bool, byte, char, int, float or double. Read are
//! `filedata`, `dimensions`, `translate`, `scale`, `subgrids`, `cornerLines`, `zvalues` with `splitEnz`, `active` and
//! each `parameter`; other tags are passed over, and are there in [`RoffFile::tags`].
//!
//! Layers count from the bottom and depths point up in these files. [`RoffGrid::pillars`] and [`RoffFile::values`] turn
//! both: layer 1 is the uppermost, and depth grows downward. What the tags mean is as xtgeo documents it
//! (`xtgeo/grid3d/_roff_grid.py`, `_roff_parameter.py`). Units are not in the file. [`RoffWriter`] writes grids and
//! properties in binary form.
//!
//! ```
//! use strataray_parsers::roff::RoffFile;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = r#"roff-asc
//! #ROFF file#
//! tag filedata
//! char filetype "parameter"
//! endtag
//! tag dimensions
//! int nX 1
//! int nY 1
//! int nZ 3
//! endtag
//! tag parameter
//! char name "PORO"
//! array float data 3
//! 0.25 -999.0 0.125
//! endtag
//! "#;
//! let file = RoffFile::from_bytes(("A.ROFF", text))?;
//! let parameters = file.parameters()?;
//! assert_eq!(parameters[0].name, "PORO");
//! // From the top down; -999 stands for no value.
//! let values = file.values(&parameters[0])?;
//! assert_eq!((values[0], values[2]), (0.125, 0.25));
//! assert!(values[1].is_nan());
//! # Ok(())
//! # }
//! ```

mod grid;
mod index;
mod write;

use std::path::Path;

use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError};
use crate::geometry::{Lengths, unaddressable};
use crate::records::Form;

pub use grid::{Pillars, RoffGrid};
pub use index::{Item, Kind, Tag};
pub use write::RoffWriter;

/// Stands for no value in parameters of bytes, and in all others.
const NO_BYTE: f64 = 255.0;
const NO_VALUE: f64 = -999.0;

/// A file with the index of its tags.
#[derive(Debug)]
pub struct RoffFile {
    file: FileBytes,
    form: Form,
    is_little: bool,
    tags: Vec<Tag>,
}

/// A property: one value per cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// True for whole numbers that stand for something, such as facies.
    pub is_discrete: bool,
    /// What the values of a discrete one stand for.
    pub codes: Vec<(i32, String)>,
    data: Item,
}

impl RoffFile {
    /// Opens a file and indexes its tags.
    ///
    /// # Errors
    /// When the file cannot be read, is no ROFF file, or ends too early.
    pub fn open(path: &Path) -> Result<Self, ParseError> {
        Self::from_bytes(FileBytes::open(path)?)
    }

    /// As [`Self::open`], for a file that is in memory.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn from_bytes(file: impl Into<FileBytes>) -> Result<Self, ParseError> {
        let file = file.into();
        let (form, is_little, tags) = index::index(&file)?;
        Ok(Self {
            file,
            form,
            is_little,
            tags,
        })
    }

    /// All tags in the order of the file.
    pub fn tags(&self) -> &[Tag] {
        &self.tags
    }

    /// The first tag called `name`.
    pub fn find(&self, name: &str) -> Option<&Tag> {
        self.tags.iter().find(|tag| tag.name == name)
    }

    /// The path that was opened, or the name that was given.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// Cells along i, j and k.
    ///
    /// # Errors
    /// When `dimensions` is missing, or not that of a grid.
    pub fn dims(&self) -> Result<[usize; 3], ParseError> {
        let tag = self.need("dimensions")?;
        let mut dims = [0; 3];
        for (size, name) in dims.iter_mut().zip(["nX", "nY", "nZ"]) {
            let value = self.number(tag, name)?.unwrap_or(0.0);
            *size = if value >= 1.0 { value as usize } else { 0 };
        }
        match Lengths::of(dims) {
            Some(_) => Ok(dims),
            None => {
                let at = self.form.place(self.file.bytes(), tag.offset);
                let kind = ErrorKind::BadValue;
                let message = unaddressable(dims);
                Err(ParseError::of(kind, self.path(), at, &tag.name, message))
            }
        }
    }

    /// The grid; `None` where the file has parameters alone.
    ///
    /// # Errors
    /// When an array of it is missing or has the wrong length.
    pub fn grid(&self) -> Result<Option<RoffGrid>, ParseError> {
        match self.find("cornerLines") {
            Some(_) => grid::read(self).map(Some),
            None => Ok(None),
        }
    }

    /// The properties in the order of the file.
    ///
    /// # Errors
    /// When one has no name or no values, or not one for each cell.
    pub fn parameters(&self) -> Result<Vec<Parameter>, ParseError> {
        let tags = self.tags.iter().filter(|tag| tag.name == "parameter");
        tags.map(|tag| self.parameter(tag)).collect()
    }

    fn parameter(&self, tag: &Tag) -> Result<Parameter, ParseError> {
        let lacks = |name: &str| {
            let at = self.form.place(self.file.bytes(), tag.offset);
            let message = format!("has no {name}");
            ParseError::of(
                ErrorKind::MissingKeyword,
                self.path(),
                at,
                &tag.name,
                message,
            )
        };
        let name = tag.find("name").ok_or_else(|| lacks("name"))?;
        let name = self.strings(name)?.into_iter().next().unwrap_or_default();
        let data = tag.find("data").ok_or_else(|| lacks("data"))?;
        let [ni, nj, nk] = self.dims()?;
        self.check_count(data, ni * nj * nk)?;
        let names = tag.find("codeNames").map(|item| self.strings(item));
        let values = tag.find("codeValues").map(|item| self.f64s(item));
        let names = names.transpose()?.unwrap_or_default();
        let values = values.transpose()?.unwrap_or_default();
        let values = values.into_iter().map(|v| v as i32);
        Ok(Parameter {
            name,
            is_discrete: !matches!(data.kind, Kind::Float | Kind::Double),
            codes: values.zip(names).collect(),
            data: data.clone(),
        })
    }

    /// Values of a property in natural order: i fastest, then j, then k from the top. NaN where there is none.
    ///
    /// # Errors
    /// When the values are damaged.
    pub fn values(&self, parameter: &Parameter) -> Result<Vec<f64>, ParseError> {
        let values = self.f64s(&parameter.data)?;
        let none = match parameter.data.kind {
            Kind::Byte => NO_BYTE,
            _ => NO_VALUE,
        };
        let value = |v: &f64| if *v == none { f64::NAN } else { *v };
        Ok(natural(self.dims()?, &values, value))
    }

    fn need(&self, name: &str) -> Result<&Tag, ParseError> {
        self.find(name).ok_or_else(|| {
            let message = "is missing; a grid needs dimensions, cornerLines and zvalues";
            let kind = ErrorKind::MissingKeyword;
            ParseError::of(kind, self.path(), At::File, name, message)
        })
    }

    fn number(&self, tag: &Tag, name: &str) -> Result<Option<f64>, ParseError> {
        let values = tag.find(name).map(|item| self.f64s(item)).transpose()?;
        Ok(values.and_then(|v| v.first().copied()))
    }

    fn check_count(&self, item: &Item, expected: usize) -> Result<(), ParseError> {
        let found = item.count;
        match found == expected as u64 {
            true => Ok(()),
            false => {
                let message = format!("expected {expected} values, found {found}");
                Err(self.error(ErrorKind::WrongCount, item, message))
            }
        }
    }

    fn error(&self, kind: ErrorKind, item: &Item, message: impl Into<String>) -> ParseError {
        let at = self.form.place(self.file.bytes(), item.offset);
        ParseError::of(kind, self.path(), at, &item.name, message)
    }
}

/// From the order of the file, where k runs fastest, from the bottom, to the natural one.
fn natural<T, U>([ni, nj, nk]: [usize; 3], values: &[T], value: impl Fn(&T) -> U) -> Vec<U> {
    let cell = |n: usize| {
        let [i, j, k] = [n % ni, n / ni % nj, n / ni / nj];
        (i * nj + j) * nk + nk - 1 - k
    };
    (0..values.len()).map(|n| value(&values[cell(n)])).collect()
}
