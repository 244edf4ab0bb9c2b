//! Properties of cells, and time series.

use roxmltree::Node;

use super::arrays::Values;
use super::xml::{self, Part};
use crate::error::{ErrorKind, ParseError};

/// What the values of a property are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PropertyClass {
    /// Real numbers.
    Continuous,
    /// Whole numbers.
    Discrete,
    /// Whole numbers that stand for something, such as facies.
    Categorical,
}

/// A property: one value per cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Property {
    /// Name of the object.
    pub uuid: String,
    /// Title, by which people know it.
    pub title: String,
    /// What the values are.
    pub class: PropertyClass,
    /// Kind, such as `porosity`; that of a local kind is its title.
    pub kind: String,
    /// Unit, such as `bar`; empty where the object has none.
    pub unit: String,
    /// Values of its facets, such as `I` of a permeability.
    pub facets: Vec<String>,
    /// Number of the realization.
    pub realization: Option<u32>,
    /// The time that the values are of; `None` for all times.
    pub time: Option<TimeIndex>,
    /// Name of the grid object.
    pub grid: String,
    pub(super) values: Values,
}

/// A time of a series.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimeIndex {
    /// Name of the series object.
    pub series: String,
    /// Which of its times, from 0.
    pub index: usize,
}

/// Times that properties are of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimeSeries {
    /// Name of the object.
    pub uuid: String,
    /// Title.
    pub title: String,
    /// As `2021-01-01T06:30:00Z`, or with fewer parts; those of geologic ages are empty.
    pub times: Vec<String>,
}

impl Property {
    /// Reads the object of a property; the error says why it is not read.
    pub(super) fn read(
        part: Part<'_>,
        root: Node<'_, '_>,
        class: PropertyClass,
    ) -> Result<Self, ParseError> {
        let refuse = |message: String| Err(part.error(ErrorKind::Unsupported, message));
        let element = xml::text_of(root, "IndexableElement");
        if element != "cells" {
            return refuse(format!(
                "has values of {element}: only those of cells are read"
            ));
        }
        let count: usize = part.number_if(root, "Count")?.unwrap_or(1);
        if count != 1 {
            return refuse(format!(
                "has {count} values for each cell: only single ones are read"
            ));
        }
        let patches = || root.children().filter(|n| xml::is(*n, "PatchOfValues"));
        if patches().count() != 1 {
            return refuse("has its values in several patches, which is not read".into());
        }
        let patch = part.need(root, "PatchOfValues")?;
        let kind = part.need(root, "PropertyKind")?;
        let kind = match xml::child(kind, "LocalPropertyKind") {
            Some(local) => xml::text_of(local, "Title"),
            None => xml::text_of(kind, "Kind"),
        };
        let time = xml::child(root, "TimeIndex").map(|node| {
            Ok(TimeIndex {
                series: xml::reference(node, "TimeSeries"),
                index: part.number(node, "Index")?,
            })
        });
        let facets = root.children().filter(|n| xml::is(*n, "Facet"));
        Ok(Self {
            uuid: xml::uuid(root),
            title: xml::title(root),
            class,
            kind: kind.to_owned(),
            unit: xml::text_of(root, "UOM").to_owned(),
            facets: facets
                .map(|n| xml::text_of(n, "Value").to_owned())
                .collect(),
            realization: part.number_if(root, "RealizationIndex")?,
            time: time.transpose()?,
            grid: xml::reference(root, "SupportingRepresentation"),
            values: Values::read(part, part.need(patch, "Values")?)?,
        })
    }
}

impl TimeSeries {
    pub(super) fn read(root: Node<'_, '_>) -> Self {
        let times = root.children().filter(|n| xml::is(*n, "Time"));
        // Before years are counted as geologists do, dates mean nothing.
        let text = |node| match xml::child(node, "YearOffset") {
            Some(_) => String::new(),
            None => xml::text_of(node, "DateTime").to_owned(),
        };
        Self {
            uuid: xml::uuid(root),
            title: xml::title(root),
            times: times.map(text).collect(),
        }
    }
}
