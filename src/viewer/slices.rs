//! Single slices along I, J or K, stepped through one by one.

use serde::{Deserialize, Serialize};

use crate::model::Dims;
use crate::scene::{Filter, Indices};

/// Names of the axes.
pub const AXES: [&str; 3] = ["I", "J", "K"];

/// Which slices are stepped through, and what is drawn beside the one shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Slicing {
    /// The axis across which slices lie: 0 for I, 1 for J, 2 for K.
    pub axis: usize,
    /// The slice is drawn alone; else with all slices of higher numbers, as a cut through the model.
    pub alone: bool,
}

impl Default for Slicing {
    fn default() -> Self {
        Self {
            axis: 2,
            alone: true,
        }
    }
}

/// Slices along an axis.
pub fn count(dims: Dims, axis: usize) -> usize {
    [dims.ni, dims.nj, dims.nk][axis.min(2)]
}

impl Slicing {
    /// The slice that a filter shows, from 1; `None` where it shows none of its own.
    pub fn current(self, filter: &Filter, dims: Dims) -> Option<usize> {
        let count = count(dims, self.axis);
        match filter.along(self.axis) {
            None => (!self.alone).then_some(1),
            Some(Indices::Range([first, last])) => {
                let end = if self.alone { *first } else { count };
                (*last == end).then_some(*first)
            }
            Some(Indices::List(_)) => None,
        }
    }

    /// The filter with another slice, from 1; beyond the ends the first or last one.
    pub fn at(self, filter: &Filter, dims: Dims, slice: usize) -> Filter {
        let count = count(dims, self.axis);
        let first = slice.clamp(1, count);
        let last = if self.alone { first } else { count };
        let mut filter = filter.clone();
        let kept = Indices::Range([first, last]);
        *filter.along_mut(self.axis) = Some(kept).filter(|_| [first, last] != [1, count]);
        filter
    }

    /// The filter with the slice that lies `by` slices further; from no slice the first one, or the last.
    pub fn stepped(self, filter: &Filter, dims: Dims, by: isize) -> Filter {
        let next = match self.current(filter, dims) {
            Some(slice) => slice.saturating_add_signed(by),
            None if by > 0 => 1,
            None => usize::MAX,
        };
        self.at(filter, dims, next)
    }

    /// The same along another axis, and the filter with a slice there in place of the one here.
    pub fn along(self, axis: usize, filter: &Filter, dims: Dims) -> (Self, Filter) {
        let other = Self { axis, ..self };
        if self.axis == axis || filter.along(self.axis).is_none() {
            return (other, filter.clone());
        }
        let mut all = filter.clone();
        if self.current(filter, dims).is_some() {
            *all.along_mut(self.axis) = None;
            all = other.at(&all, dims, count(dims, axis).div_ceil(2));
        }
        (other, all)
    }

    /// Drawn alone or not, and the filter that shows the same slice so.
    pub fn with_alone(self, alone: bool, filter: &Filter, dims: Dims) -> (Self, Filter) {
        let other = Self { alone, ..self };
        let filter = match self.current(filter, dims) {
            Some(slice) if filter.along(self.axis).is_some() => other.at(filter, dims, slice),
            _ => filter.clone(),
        };
        (other, filter)
    }

    /// The slice shown, in words.
    pub fn words(self, filter: &Filter, dims: Dims) -> String {
        let axis = AXES[self.axis.min(2)];
        let count = count(dims, self.axis);
        match self.current(filter, dims) {
            Some(slice) => format!("{axis} {slice} of {count}"),
            None => format!("{axis} 1 to {count}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIMS: Dims = Dims {
        ni: 4,
        nj: 6,
        nk: 3,
    };

    fn k(filter: &Filter) -> Option<[usize; 2]> {
        filter.k.as_ref().and_then(Indices::ends)
    }

    #[test]
    fn slices_follow_each_other_and_stop_at_the_ends() {
        let slicing = Slicing::default();
        let mut filter = Filter::default();
        let mut shown = Vec::new();
        for by in [1, 1, 1, 1, -1, -1, -1] {
            filter = slicing.stepped(&filter, DIMS, by);
            shown.push(k(&filter).unwrap());
        }
        let expected = [1, 2, 3, 3, 2, 1, 1].map(|n| [n, n]);
        assert_eq!(shown, expected);
        assert_eq!(slicing.words(&filter, DIMS), "K 1 of 3");
        // From a range that is no slice, up comes from below.
        let filter = Filter {
            k: Some([1, 2].into()),
            ..Filter::default()
        };
        assert_eq!(k(&slicing.stepped(&filter, DIMS, -1)), Some([3, 3]));
    }

    #[test]
    fn a_cut_draws_what_lies_beyond() {
        let slicing = Slicing {
            alone: false,
            ..Slicing::default()
        };
        let cut = slicing.stepped(&Filter::default(), DIMS, 1);
        assert_eq!(k(&cut), Some([2, 3]));
        assert_eq!(slicing.stepped(&cut, DIMS, -1), Filter::default());
        let (alone, filter) = slicing.with_alone(true, &cut, DIMS);
        assert_eq!(k(&filter), Some([2, 2]));
        assert_eq!(alone.with_alone(false, &filter, DIMS), (slicing, cut));
    }

    #[test]
    fn another_axis_has_a_slice_of_its_own() {
        let slicing = Slicing::default();
        let filter = slicing.at(&Filter::default(), DIMS, 2);
        let (along_j, filter) = slicing.along(1, &filter, DIMS);
        assert_eq!(filter.k, None);
        assert_eq!(along_j.current(&filter, DIMS), Some(3));
        // Without a slice, the axis changes alone.
        let (_, same) = slicing.along(0, &Filter::default(), DIMS);
        assert_eq!(same, Filter::default());
    }
}
