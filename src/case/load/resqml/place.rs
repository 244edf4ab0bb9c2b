//! From the local reference system of a package to the map.

use strataray_parsers::resqml::{Crs, Package};
use strataray_parsers::units::LengthUnit;
use strataray_parsers::{At, ErrorKind, ParseError};

/// From a local reference system to the map, with depth.
pub(super) struct Place {
    pub(super) unit: LengthUnit,
    /// What lengths of x and y, and of z, are multiplied by.
    scale: [f64; 2],
    /// Which of x and y is east, and the signs of east and north.
    has_east_second: bool,
    signs: [f64; 2],
    /// East and north, scaled.
    origin: [f64; 2],
    z: f64,
    is_depth: bool,
    sine: f64,
    cosine: f64,
}

impl Place {
    pub(super) fn of(package: &Package, crs: &Crs) -> Result<Self, ParseError> {
        let refuse = |message: String| {
            let kind = ErrorKind::Unsupported;
            ParseError::of(kind, package.path(), At::File, "LocalDepth3dCrs", message)
        };
        let meters = |unit: &str| {
            let found = meters(unit);
            found.ok_or_else(|| refuse(format!("its unit {unit:?} is not known: use m or ft")))
        };
        let lateral = meters(&crs.unit)?;
        let unit = LengthUnit::from_name(&crs.unit).unwrap_or(LengthUnit::Metre);
        let scale = [lateral, meters(&crs.vertical_unit)?].map(|m| m / unit.meters());
        let axes: Vec<&str> = crs.axes.split_whitespace().collect();
        let (has_east_second, [east, north]) = match axes[..] {
            [a @ ("easting" | "westing"), b @ ("northing" | "southing")] => (false, [a, b]),
            [b @ ("northing" | "southing"), a @ ("easting" | "westing")] => (true, [a, b]),
            _ => {
                let message = format!("its axes are {:?}, which is not read", crs.axes);
                return Err(refuse(message));
            }
        };
        let sign = |is_reversed: bool| if is_reversed { -1.0 } else { 1.0 };
        let mut place = Self {
            unit,
            scale,
            has_east_second,
            signs: [sign(east == "westing"), sign(north == "southing")],
            origin: [0.0; 2],
            z: crs.origin[2],
            is_depth: crs.is_depth,
            sine: crs.rotation.sin(),
            cosine: crs.rotation.cos(),
        };
        place.origin = place.east_north(crs.origin[0], crs.origin[1]);
        Ok(place)
    }

    fn east_north(&self, x: f64, y: f64) -> [f64; 2] {
        let [east, north] = if self.has_east_second { [y, x] } else { [x, y] };
        [
            self.signs[0] * east * self.scale[0],
            self.signs[1] * north * self.scale[0],
        ]
    }

    /// A point on the map, with its depth.
    pub(super) fn map(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [east, north] = self.east_north(x, y);
        // Local axes are turned clockwise.
        let z = (z + self.z) * self.scale[1];
        [
            self.origin[0] + east * self.cosine + north * self.sine,
            self.origin[1] - east * self.sine + north * self.cosine,
            if self.is_depth { z } else { -z },
        ]
    }
}

/// Meters of a unit of lengths as RESQML calls it.
fn meters(unit: &str) -> Option<f64> {
    Some(match unit {
        "m" => 1.0,
        "ft" => 0.3048,
        "cm" => 0.01,
        "mm" => 0.001,
        "km" => 1000.0,
        "ft[US]" => 1200.0 / 3937.0,
        _ => return None,
    })
}
