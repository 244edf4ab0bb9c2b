//! Matrix and fractures of dual porosity: properties of both, and of the two together.

use crate::case::Property;

/// Behind the names of properties of fractures, and of matrix and fractures together.
const FRACTURE: &str = ".FRACTURE";
const TOTAL: &str = ".TOTAL";

/// Of what a property is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pores {
    /// The matrix, or all where there are no fractures.
    Matrix,
    /// The fractures.
    Fracture,
    /// Both, by pore volume.
    Total,
}

impl Pores {
    /// The array that a property's name stands for, and of what.
    pub fn of(name: &str) -> (&str, Self) {
        let known = [(FRACTURE, Self::Fracture), (TOTAL, Self::Total)];
        let found = known.iter().find_map(|(end, pores)| {
            let array = name.strip_suffix(end)?;
            Some((array, *pores))
        });
        found.unwrap_or((name, Self::Matrix))
    }

    /// The name of a property of these.
    pub fn name(self, array: &str) -> String {
        let end = match self {
            Self::Matrix => "",
            Self::Fracture => FRACTURE,
            Self::Total => TOTAL,
        };
        format!("{array}{end}")
    }

    /// A property of the matrix as that of these.
    pub fn twin(self, of: &Property) -> Property {
        Property {
            name: self.name(&of.name),
            rest_of: of.rest_of.iter().map(|name| self.name(name)).collect(),
            ..of.clone()
        }
    }
}

/// Means of the values of matrix and fractures by their pore volumes; of a cell that has one of them, its value.
///
/// **Shape**: all four by active cell; not a number where there is none.
pub fn means([matrix, fractures]: [&[f32]; 2], volumes: [&[f32]; 2]) -> Vec<f32> {
    let mean = |n: usize| {
        let of = [(matrix[n], volumes[0][n]), (fractures[n], volumes[1][n])];
        let there = of
            .iter()
            .filter(|(value, volume)| !value.is_nan() && *volume > 0.0);
        let [sum, volume] = there.fold([0.0; 2], |[sum, all], (value, volume)| {
            let volume = f64::from(*volume);
            [sum + volume * f64::from(*value), all + volume]
        });
        (sum / volume) as f32
    };
    (0..matrix.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_are_weighted_by_pore_volume() {
        let none = f32::NAN;
        let found = means(
            [&[0.2, 0.4, none, none], &[0.8, none, 0.6, none]],
            [&[3.0, 1.0, none, none], &[1.0, none, 2.0, none]],
        );
        assert_eq!(found[..3], [0.35, 0.4, 0.6]);
        assert!(found[3].is_nan());
    }

    #[test]
    fn names_say_of_what_a_property_is() {
        assert_eq!(Pores::of("SWAT"), ("SWAT", Pores::Matrix));
        assert_eq!(Pores::of("SWAT.FRACTURE"), ("SWAT", Pores::Fracture));
        assert_eq!(Pores::of("SWAT.TOTAL"), ("SWAT", Pores::Total));
    }
}
