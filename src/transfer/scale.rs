//! What positions in a transfer function's range follow.

use std::sync::Arc;

use rayon::prelude::*;

use crate::model::CellField;

/// What the numbers of a field and of a range stand for, so that positions are linear in them.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Scale {
    /// The values themselves.
    #[default]
    Linear,
    /// Decimal logarithms of the values.
    Log,
    /// Ranks, from 0, of the values among these.
    ///
    /// **Invariants**: rising.
    Categories(Arc<[f64]>),
}

impl Scale {
    /// The value that a number stands for; of a category the nearest one.
    pub fn true_value(&self, shown: f64) -> f64 {
        match self {
            Self::Linear => shown,
            Self::Log => 10f64.powf(shown),
            Self::Categories(values) => {
                let rank = shown.round().max(0.0) as usize;
                let value = values.get(rank).or(values.last());
                value.map_or(f64::NAN, |v| *v)
            }
        }
    }

    /// The number that stands for a value; `lowest` where a value has no logarithm, NaN where it is no
    /// category.
    pub fn shown(&self, value: f64, lowest: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Log if value <= 0.0 => lowest,
            Self::Log => value.log10(),
            Self::Categories(values) => {
                // Adding 0 turns a negative zero into zero.
                let rank = values.binary_search_by(|v| v.total_cmp(&(value + 0.0)));
                rank.map_or(f64::NAN, |rank| rank as f64)
            }
        }
    }

    /// A field of values in this scale; see [`Self::shown`].
    pub fn field(&self, field: &Arc<CellField>, lowest: f64) -> Arc<CellField> {
        if *self == Self::Linear {
            return field.clone();
        }
        let shown = |v: &f32| self.shown(f64::from(*v), lowest) as f32;
        let shown = field.values().par_iter().map(shown).collect();
        Arc::new(CellField::new(shown))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back() {
        let categories = Scale::Categories([1.0, 2.0, 7.0].into());
        for (scale, values) in [
            (Scale::Linear, [-3.0, 0.0, 7.5]),
            (Scale::Log, [1e-6, 1.0, 2.5e4]),
            (categories.clone(), [1.0, 2.0, 7.0]),
        ] {
            for value in values {
                let back = scale.true_value(scale.shown(value, f64::NAN));
                assert!(
                    (back - value).abs() <= 1e-12 * value.abs(),
                    "{scale:?} {value}"
                );
            }
        }
        assert_eq!(categories.shown(7.0, 0.0), 2.0);
        assert!(categories.shown(3.0, 0.0).is_nan());
        assert_eq!(categories.true_value(1e9), 7.0);
        assert!(Scale::Categories([].into()).true_value(0.0).is_nan());
    }

    #[test]
    fn what_has_no_logarithm_lies_at_the_low_end() {
        let field = Arc::new(CellField::new(vec![0.0, -5.0, 100.0, f32::NAN]));
        let log = Scale::Log.field(&field, -3.0);
        assert_eq!(log.values()[..3], [-3.0, -3.0, 2.0]);
        assert!(log.values()[3].is_nan());
    }
}
