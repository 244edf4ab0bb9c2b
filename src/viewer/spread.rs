//! How the values of a property are spread: what filters by value are set on.

use std::sync::Arc;

use crate::case::{Case, Categories};
use crate::transfer::kinds::Quantity;
use crate::view::look;

/// Bars of a histogram.
pub const BARS: usize = 64;

/// The values of a property at a step, counted.
pub struct Spread {
    /// Of which case.
    pub case: Arc<Case>,
    /// Which property.
    pub property: String,
    /// At which step.
    pub step: usize,
    /// What was found; `None` where no cell has a value.
    pub counts: Option<Counts>,
}

/// Cells by value.
#[derive(Debug, Clone, PartialEq)]
pub enum Counts {
    /// In equal parts of the range of all steps.
    Bars {
        /// Smallest and largest value of all steps.
        range: [f64; 2],
        /// Parts are equal in the logarithm.
        log: bool,
        /// Active cells of each part.
        bars: Vec<u32>,
    },
    /// By whole number, rising: all that occur at any step, with their active cells at this one.
    Categories(Vec<(f64, u32)>),
}

impl Spread {
    /// Reads the values and counts them; the range needs those of all steps.
    pub fn of(case: &Arc<Case>, property: &str, step: usize) -> Self {
        Self {
            case: case.clone(),
            property: property.to_owned(),
            step,
            counts: counts(case, property, step),
        }
    }

    /// True where it is of a property at a step of a case.
    pub fn is_of(&self, case: &Arc<Case>, property: &str, step: usize) -> bool {
        Arc::ptr_eq(&self.case, case) && self.property == property && self.step == step
    }
}

fn counts(case: &Case, property: &str, step: usize) -> Option<Counts> {
    // A step without values has no bars, and the range still says where filters may be set.
    let field = case.field(property, step).ok().map(|f| case.finest(f));
    let values = field.as_ref().map_or(&[][..], |f| f.values());
    if look::numbers_regions(case, property)
        && let Ok(Categories::Values(known)) = case.categories(property)
    {
        return Some(by_category(&known, values)).filter(|_| !known.is_empty());
    }
    let range = case.range_over_steps(property).ok().flatten()?;
    let log = Quantity::of(property) == Quantity::Wide && range.least_positive.is_some();
    let low = match range.least_positive {
        Some(least) if log => least,
        _ => range.min,
    };
    Some(bars([low, range.max], log, values))
}

fn by_category(known: &[f64], values: &[f32]) -> Counts {
    let mut counts: Vec<(f64, u32)> = known.iter().map(|v| (*v, 0)).collect();
    for value in values.iter().filter(|v| !v.is_nan()) {
        // Adding 0 turns a negative zero into zero.
        let at = known.binary_search_by(|v| v.total_cmp(&(f64::from(*value) + 0.0)));
        if let Ok(at) = at {
            counts[at].1 += 1;
        }
    }
    Counts::Categories(counts)
}

fn bars(range: [f64; 2], log: bool, values: &[f32]) -> Counts {
    let mut bars = vec![0; BARS];
    for value in values.iter().filter(|v| !v.is_nan()) {
        let at = (part(range, log, f64::from(*value)) * BARS as f64) as usize;
        bars[at.min(BARS - 1)] += 1;
    }
    Counts::Bars { range, log, bars }
}

/// Where a value lies in a range, from 0 to 1.
pub fn part([low, high]: [f64; 2], log: bool, value: f64) -> f64 {
    let scaled = |v: f64| if log { v.max(low).ln() } else { v };
    let width = scaled(high) - scaled(low);
    match width > 0.0 {
        true => ((scaled(value) - scaled(low)) / width).clamp(0.0, 1.0),
        false => 0.5,
    }
}

/// The value at a part of a range.
pub fn value([low, high]: [f64; 2], log: bool, part: f64) -> f64 {
    match log {
        true => (low.ln() + part * (high.ln() - low.ln())).exp(),
        false => low + part * (high - low),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::case::load;
    use crate::model::CellField;

    fn total(counts: &Counts) -> u32 {
        match counts {
            Counts::Bars { bars, .. } => bars.iter().sum(),
            Counts::Categories(all) => all.iter().map(|c| c.1).sum(),
        }
    }

    #[test]
    fn every_value_is_counted_once() {
        let file = "samples/scissor/SCISSOR.EGRID";
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        let case = Arc::new(load::open(&path).unwrap());
        for property in ["SOIL", "PERMX", "FIPNUM", "PORO"] {
            let Ok(field) = case.field(property, 0) else {
                continue;
            };
            let defined = |f: &CellField| f.values().iter().filter(|v| !v.is_nan()).count();
            let counts = Spread::of(&case, property, 0).counts.unwrap();
            assert_eq!(total(&counts) as usize, defined(&field), "{property}");
            if let Counts::Bars { range, log, .. } = counts {
                assert_eq!(log, property == "PERMX");
                let all = case.range_over_steps(property).unwrap().unwrap();
                assert_eq!(range[1], all.max);
            }
        }
    }

    #[test]
    fn parts_of_a_range_come_back() {
        for log in [false, true] {
            for at in [0.0, 0.25, 1.0] {
                let there = value([0.1, 1000.0], log, at);
                assert!((part([0.1, 1000.0], log, there) - at).abs() < 1e-12);
            }
        }
        assert_eq!(part([2.0, 2.0], false, 2.0), 0.5);
        assert_eq!(part([0.1, 10.0], true, -5.0), 0.0);
        assert_eq!(
            by_category(&[0.0, 2.0], &[-0.0, 2.0, f32::NAN]),
            Counts::Categories(vec![(0.0, 1), (2.0, 1)])
        );
    }
}
