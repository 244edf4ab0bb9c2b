//! In which units numbers are shown and typed. What is kept is in the units of the files: values of cells, lengths of the
//! grid, and every number of a scene. It is converted where people see it or type it, and only there.

use strataray_parsers::units::{Conversion, LengthUnit, UnitSystem};

use super::{Case, Vector};

/// The units in which numbers are shown: those of the files, or of a system.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Units {
    system: Option<UnitSystem>,
}

/// How numbers of a quantity are shown: `shown = kept * factor + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    /// The unit shown; empty where there is none.
    pub unit: String,
    factor: f64,
    offset: f64,
}

impl Default for Measure {
    /// Numbers as they are, without a unit.
    fn default() -> Self {
        Self::of_file("")
    }
}

impl Measure {
    /// Numbers as they are, in the unit of a file.
    pub fn of_file(unit: &str) -> Self {
        Self {
            unit: unit.to_owned(),
            factor: 1.0,
            offset: 0.0,
        }
    }

    fn of(conversion: Option<Conversion>, unit: &str) -> Self {
        conversion.map_or_else(
            || Self::of_file(unit),
            |c| Self {
                unit: c.unit.to_owned(),
                factor: c.factor,
                offset: c.offset,
            },
        )
    }

    /// The number that is shown for one that is kept.
    pub fn show(&self, kept: f64) -> f64 {
        kept * self.factor + self.offset
    }

    /// The number that is kept for one that is typed.
    pub fn read(&self, shown: f64) -> f64 {
        (shown - self.offset) / self.factor
    }

    /// The same of a value as files have them.
    pub fn show_single(&self, kept: f32) -> f32 {
        match self.is_of_file() {
            true => kept,
            false => self.show(f64::from(kept)) as f32,
        }
    }

    /// True where numbers are shown as they are kept.
    fn is_of_file(&self) -> bool {
        self.factor == 1.0 && self.offset == 0.0
    }

    /// Of differences of such numbers: 10 C more are 18 F more.
    #[must_use]
    pub fn of_differences(self) -> Self {
        Self {
            offset: 0.0,
            ..self
        }
    }
}

impl From<UnitSystem> for Units {
    fn from(system: UnitSystem) -> Self {
        Self {
            system: Some(system),
        }
    }
}

impl Units {
    /// Those of a unit system.
    pub const METRIC: Self = Self::of_system(UnitSystem::Metric);
    /// Those of a unit system.
    pub const FIELD: Self = Self::of_system(UnitSystem::Field);
    /// Those of a unit system.
    pub const LAB: Self = Self::of_system(UnitSystem::Lab);
    /// Those of a unit system.
    pub const PVT_M: Self = Self::of_system(UnitSystem::PvtM);

    const fn of_system(system: UnitSystem) -> Self {
        Self {
            system: Some(system),
        }
    }

    /// How numbers in a unit are shown; `quantity` is their keyword. A unit that is not known stays as it is.
    pub fn of_unit(self, unit: &str, quantity: &str) -> Measure {
        let conversion = |system: UnitSystem| system.conversion(unit, quantity);
        Measure::of(self.system.and_then(conversion), unit)
    }

    /// How the values of a summary vector are shown.
    pub fn of_vector(self, vector: &Vector) -> Measure {
        self.of_unit(&vector.unit, &vector.keyword)
    }

    /// How lengths in a unit (METRES, FEET or CM) are shown; units are such names too.
    pub fn of_length(self, unit: &str) -> Measure {
        let from = LengthUnit::from_name(unit);
        let pair = from.zip(self.system.map(UnitSystem::length));
        let to_other = pair.filter(|(from, to)| from != to);
        to_other.map_or_else(
            || Measure::of_file(unit),
            |(from, to)| Measure {
                unit: to.name().to_owned(),
                factor: from.meters() / to.meters(),
                offset: 0.0,
            },
        )
    }
}

impl Case {
    /// How the values of a property, or of a difference of one, are shown.
    pub fn measure(&self, property: &str, units: Units) -> Measure {
        let now = self.now_of(property);
        // Those of a fracture are of the same kind.
        let quantity = now.split('.').next().unwrap_or(now).to_ascii_uppercase();
        let measure = units.of_unit(self.unit(property), &quantity);
        match now == property {
            true => measure,
            false => measure.of_differences(),
        }
    }

    /// How lengths and depths of the grid are shown.
    pub fn length(&self, units: Units) -> Measure {
        units.of_length(&self.about.length_unit)
    }

    /// How depths are shown: as lengths, or as times where the vertical axis is one.
    pub fn vertical(&self, units: Units) -> Measure {
        match &self.about.time_unit {
            Some(unit) => Measure::of_file(unit),
            None => self.length(units),
        }
    }

    /// How eastings and northings are shown.
    pub fn map_length(&self, units: Units) -> Measure {
        units.of_length(&self.about.map_unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_is_what_is_shown() {
        let field = Units::FIELD;
        let temperature = field.of_unit("C", "TEMP");
        assert_eq!(temperature.unit, "F");
        assert!((temperature.show(100.0) - 212.0).abs() < 1e-9);
        assert!((temperature.read(212.0) - 100.0).abs() < 1e-9);
        let change = temperature.clone().of_differences();
        assert!((change.show(10.0) - 18.0).abs() < 1e-9);
        assert!((temperature.show(10.0) - 50.0).abs() < 1e-9);
        // A unit that is not known, and the units of the files, change nothing.
        for measure in [
            field.of_unit("TONNES", "X"),
            Units::default().of_unit("C", "TEMP"),
        ] {
            assert_eq!((measure.show(0.1), measure.read(0.1)), (0.1, 0.1));
        }
        assert_eq!(field.of_unit("TONNES", "X").unit, "TONNES");
    }

    #[test]
    fn lengths_go_by_the_words_of_the_files() {
        let measure = Units::FIELD.of_length("METRES");
        assert_eq!(measure.unit, "FEET");
        assert!((measure.show(0.3048) - 1.0).abs() < 1e-12);
        assert_eq!(Units::LAB.of_length("FEET").show(1.0), 30.48);
        assert_eq!(Units::METRIC.of_length("METRES").show(0.1), 0.1);
        assert_eq!(Units::METRIC.of_length("").unit, "");
    }
}
