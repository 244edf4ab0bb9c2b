//! The local reference system of a grid.

use roxmltree::Node;

use super::xml::{self, Part};
use crate::error::{ErrorKind, ParseError};

/// Where a grid's points are, in depth: `LocalDepth3dCrs`.
#[derive(Debug, Clone, PartialEq)]
pub struct Crs {
    /// Name of the object.
    pub uuid: String,
    /// Title.
    pub title: String,
    /// The local origin: along the first and second projected axis in [`Self::unit`], then of z in
    /// [`Self::vertical_unit`].
    pub origin: [f64; 3],
    /// From the projected to the local second axis, in radians, clockwise.
    pub rotation: f64,
    /// Unit of x and y, such as `m` or `ft`.
    pub unit: String,
    /// Unit of z.
    pub vertical_unit: String,
    /// Whether z is depth; else it is height.
    pub is_depth: bool,
    /// What the projected axes are, such as `easting northing`.
    pub axes: String,
}

impl Crs {
    pub(super) fn read(part: Part<'_>, root: Node<'_, '_>) -> Result<Self, ParseError> {
        let rotation: f64 = part.number(root, "ArealRotation")?;
        let unit = part.need(root, "ArealRotation")?.attribute("uom");
        let radians = match unit.unwrap_or("rad") {
            "rad" => 1.0,
            "dega" => 1f64.to_radians(),
            "gon" => 0.9f64.to_radians(),
            other => {
                let message =
                    format!("ArealRotation is in {other}, which is not read: use rad or dega");
                return Err(part.error(ErrorKind::Unsupported, message));
            }
        };
        let origin = [
            part.number(root, "XOffset")?,
            part.number(root, "YOffset")?,
            part.number(root, "ZOffset")?,
        ];
        let rotation = rotation * radians;
        if !origin.iter().chain([&rotation]).all(|v| v.is_finite()) {
            let message = "an offset or the rotation is not a finite number";
            return Err(part.error(ErrorKind::BadValue, message));
        }
        Ok(Self {
            uuid: xml::uuid(root),
            title: xml::title(root),
            origin,
            rotation,
            unit: xml::text_of(root, "ProjectedUom").to_owned(),
            vertical_unit: xml::text_of(root, "VerticalUom").to_owned(),
            is_depth: part.flag(root, "ZIncreasingDownward")?,
            axes: xml::text_of(root, "ProjectedAxisOrder").to_owned(),
        })
    }
}
