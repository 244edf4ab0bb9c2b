//! Lengths and places as they are written in pictures and beside them.

use crate::case::{Case, Measure, Units};

/// A length unit of a grid file as it is written behind numbers.
pub fn short_unit(name: &str) -> String {
    match name {
        "METRES" => "m".into(),
        "FEET" => "ft".into(),
        other => other.to_lowercase(),
    }
}

/// How lengths of a case are written, with short units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lengths {
    /// Lengths of the grid.
    pub grid: Measure,
    /// Depths, or times where the vertical axis is one.
    pub vertical: Measure,
    /// The vertical axis is time.
    pub is_time: bool,
    /// Eastings and northings.
    pub map: Measure,
}

impl Lengths {
    /// Those of a case in some units.
    pub fn of(case: &Case, units: Units) -> Self {
        let short = |mut measure: Measure| {
            measure.unit = short_unit(&measure.unit);
            measure
        };
        Self {
            grid: short(case.length(units)),
            vertical: short(case.vertical(units)),
            is_time: case.about.time_unit.is_some(),
            map: short(case.map_length(units)),
        }
    }

    /// Lengths as they are, in one unit.
    #[cfg(test)]
    pub fn named(unit: &str) -> Self {
        Self {
            grid: Measure::of_file(unit),
            vertical: Measure::of_file(unit),
            is_time: false,
            map: Measure::of_file(unit),
        }
    }

    /// Easting, northing and depth as they are shown.
    pub fn shown(&self, [east, north, depth]: [f64; 3]) -> [f64; 3] {
        [
            self.map.show(east),
            self.map.show(north),
            self.vertical.show(depth),
        ]
    }

    /// A place on the map in words.
    pub fn place(&self, place: [f64; 3]) -> String {
        let [east, north, depth] = self.shown(place);
        let (map, vertical) = (&self.map.unit, &self.vertical.unit);
        let name = if self.is_time { "time" } else { "depth" };
        let unit = match map == vertical {
            true => String::new(),
            false => format!(" {map}"),
        };
        format!("E {east:.1}{unit}  N {north:.1}{unit}  {name} {depth:.2} {vertical}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_name_the_unit_of_the_map_where_it_is_another_one() {
        let mut lengths = Lengths::named("m");
        let place = [500_000.04, 6e6, 2000.0];
        assert_eq!(
            lengths.place(place),
            "E 500000.0  N 6000000.0  depth 2000.00 m"
        );
        lengths.vertical.unit = "ft".into();
        assert_eq!(
            lengths.place(place),
            "E 500000.0 m  N 6000000.0 m  depth 2000.00 ft"
        );
        lengths.vertical.unit = "ms".into();
        lengths.is_time = true;
        assert_eq!(
            lengths.place(place),
            "E 500000.0 m  N 6000000.0 m  time 2000.00 ms"
        );
    }
}
