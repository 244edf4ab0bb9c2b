//! Arrays as objects name them: by a constant, by cells that differ, or by a dataset of an HDF5 file.

use roxmltree::Node;

use super::hdf5::Files;
use super::xml::{self, Part};
use crate::error::{ErrorKind, ParseError};
use crate::geometry::zeros;

/// Where the values of an array are.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Constant(f64),
    /// Those at the places in `indices` are 1, or 0 where `is_true` is false, and all others the opposite.
    Indices {
        indices: Dataset,
        is_true: bool,
    },
    Dataset(Dataset),
}

/// A dataset of an HDF5 file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dataset {
    /// Object that stands for the file.
    pub(super) file: String,
    pub(super) name: String,
    /// Number that stands for no value.
    pub(super) none: Option<f64>,
}

impl Values {
    pub(super) fn read(part: Part<'_>, node: Node<'_, '_>) -> Result<Self, ParseError> {
        Ok(match xml::type_of(node) {
            "BooleanConstantArray" => {
                Self::Constant(f64::from(u8::from(part.flag(node, "Value")?)))
            }
            "DoubleConstantArray" | "IntegerConstantArray" => {
                Self::Constant(part.number(node, "Value")?)
            }
            "BooleanArrayFromIndexArray" => Self::Indices {
                indices: Dataset::child(part, node, "Indices")?,
                is_true: part.flag(node, "IndexIsTrue")?,
            },
            _ => Self::Dataset(Dataset::of(part, node)?),
        })
    }

    /// The numbers, NaN where there is none, of which there have to be `count`.
    pub(super) fn numbers(&self, files: &Files, count: usize) -> Result<Vec<f64>, ParseError> {
        let full = |value: f64| {
            let mut values = zeros(count).ok_or_else(|| files.too_large(count))?;
            values.fill(value);
            Ok(values)
        };
        match self {
            Self::Constant(value) => full(*value),
            Self::Dataset(dataset) => dataset.numbers(files, count),
            Self::Indices { indices, is_true } => {
                let value = f64::from(u8::from(*is_true));
                let mut values = full(1.0 - value)?;
                for place in files.any_count(indices)? {
                    let at = index(place, count).ok_or_else(|| {
                        let message = format!("{place} is none of {count} places");
                        files.error(indices, ErrorKind::BadValue, message)
                    })?;
                    values[at] = value;
                }
                Ok(values)
            }
        }
    }
}

impl Dataset {
    /// The dataset of the child of `node` called `name`.
    pub(super) fn child(
        part: Part<'_>,
        node: Node<'_, '_>,
        name: &str,
    ) -> Result<Self, ParseError> {
        Self::of(part, part.need(node, name)?)
    }

    /// The dataset that an array is.
    pub(super) fn of(part: Part<'_>, node: Node<'_, '_>) -> Result<Self, ParseError> {
        let dataset = match xml::type_of(node) {
            "BooleanHdf5Array" | "DoubleHdf5Array" | "IntegerHdf5Array" => "Values",
            "Point3dHdf5Array" => "Coordinates",
            other => {
                let name = node.tag_name().name();
                let message = format!("{name} is a {other}, which is not read");
                return Err(part.error(ErrorKind::Unsupported, message));
            }
        };
        let dataset = part.need(node, dataset)?;
        Ok(Self {
            file: xml::reference(dataset, "HdfProxy"),
            name: xml::text(part.need(dataset, "PathInHdfFile")?).to_owned(),
            none: part.number_if(node, "NullValue")?,
        })
    }

    /// The numbers, of which there have to be `count`; NaN where there is none.
    pub(super) fn numbers(&self, files: &Files, count: usize) -> Result<Vec<f64>, ParseError> {
        let mut values = files.numbers(self, count)?;
        if let Some(none) = self.none {
            let gone = values.iter_mut().filter(|v| **v == none);
            gone.for_each(|v| *v = f64::NAN);
        }
        Ok(values)
    }
}

/// A number as the index of one of `count` items.
pub(super) fn index(value: f64, count: usize) -> Option<usize> {
    let is_index = value >= 0.0 && value < count as f64 && value.fract() == 0.0;
    is_index.then_some(value as usize)
}
