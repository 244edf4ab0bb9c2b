//! What the values of chosen cells are like.

/// Smallest, largest, mean and middle values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Cells that were chosen and have a value.
    pub count: usize,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Mean by the weights, where there are some above 0.
    pub weighted: Option<f64>,
    /// Values that a tenth, half and nine tenths of the cells do not exceed.
    pub percentiles: [f64; 3],
}

impl Summary {
    /// Of the values of the cells that `chosen` names, NaN being none; `None` where there are none.
    ///
    /// **Shape**: values, `chosen` and `weights` by active cell.
    pub fn of(values: &[f32], chosen: &[bool], weights: Option<&[f32]>) -> Option<Self> {
        let cells = values.iter().zip(chosen).enumerate();
        let cells = cells.filter(|(_, (v, chosen))| **chosen && !v.is_nan());
        let (mut kept, mut sum, mut weighted, mut weight) = (Vec::new(), 0.0, 0.0, 0.0);
        for (n, (value, _)) in cells {
            kept.push(*value);
            sum += f64::from(*value);
            let w = weights
                .and_then(|w| w.get(n))
                .map_or(0.0, |w| f64::from(*w));
            if w > 0.0 {
                weighted += w * f64::from(*value);
                weight += w;
            }
        }
        let last = kept.len().checked_sub(1)?;
        let mut at = |part: f64| {
            let place = (part * last as f64).round() as usize;
            let (_, value, _) = kept.select_nth_unstable_by(place, f32::total_cmp);
            f64::from(*value)
        };
        let [min, low, middle, high, max] = [0.0, 0.1, 0.5, 0.9, 1.0].map(&mut at);
        Some(Self {
            count: last + 1,
            min,
            max,
            mean: sum / (last + 1) as f64,
            weighted: (weight > 0.0).then(|| weighted / weight),
            percentiles: [low, middle, high],
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn only_chosen_cells_with_a_value_count() {
        let values: Vec<f32> = (0..=100).map(|n| n as f32).chain([f32::NAN, 1e6]).collect();
        let chosen: Vec<bool> = (0..103).map(|n| n != 102).collect();
        let summary = Summary::of(&values, &chosen, None).unwrap();
        assert_eq!((summary.count, summary.min, summary.max), (101, 0.0, 100.0));
        assert_eq!(
            (summary.mean, summary.percentiles),
            (50.0, [10.0, 50.0, 90.0])
        );
        assert_eq!(summary.weighted, None);
        let mut weights = vec![0.0; 103];
        (weights[20], weights[40]) = (3.0, 1.0);
        let weighted = Summary::of(&values, &chosen, Some(&weights))
            .unwrap()
            .weighted;
        assert_eq!(weighted, Some(25.0));
        assert_eq!(Summary::of(&values, &[false; 103], None), None);
    }
}
