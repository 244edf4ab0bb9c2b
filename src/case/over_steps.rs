//! What the values of a property are like over all steps: read once, then kept by name.

use std::collections::HashMap;
use std::convert::Infallible;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use glam::DVec3;
use rayon::prelude::*;

use super::weights::{Extent, Weights};
use super::{Case, CaseError};
use crate::model::{CellField, Space, derivatives};
use crate::transfer::Scale;
use crate::transfer::boundaries::{self, Boundary};
use crate::transfer::opacity::Opacity;

/// Values that one thread looks through at a time.
const PIECE: usize = 1 << 14;

/// Smallest and largest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueRange {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Smallest value above zero.
    pub least_positive: Option<f64>,
}

impl ValueRange {
    /// That of the defined values of a field; `None` where there is none.
    pub fn of(field: &CellField) -> Option<Self> {
        let start = [f32::INFINITY, f32::NEG_INFINITY, f32::INFINITY];
        // No comparison holds for what is undefined.
        let add = |[min, max, least]: [f32; 3], v: &f32| {
            [
                if *v < min { *v } else { min },
                if *v > max { *v } else { max },
                if *v > 0.0 && *v < least { *v } else { least },
            ]
        };
        let pieces = field.values().par_chunks(PIECE);
        let ends = pieces.map(|values| values.iter().fold(start, add));
        let join = |a: [f32; 3], b: [f32; 3]| [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2])];
        let [min, max, least] = ends.reduce(|| start, join).map(f64::from);
        (min <= max).then(|| Self {
            min,
            max,
            least_positive: least.is_finite().then_some(least),
        })
    }

    fn with(self, other: Self) -> Self {
        let least = [self.least_positive, other.least_positive];
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            least_positive: least.into_iter().flatten().min_by(f64::total_cmp),
        }
    }
}

/// The different values of a property, where they are numbers of something.
#[derive(Debug, Clone, PartialEq)]
pub enum Categories {
    /// Whole numbers, rising; none where no value is defined.
    Values(Arc<[f64]>),
    /// One that is not whole.
    NotWhole(f64),
    /// More than [`MAX_CATEGORIES`].
    TooMany,
}

/// Categories at most.
pub const MAX_CATEGORIES: usize = 64;

impl Categories {
    /// The values of fields that come one after another.
    fn of<E>(fields: impl Iterator<Item = Result<Arc<CellField>, E>>) -> Result<Self, E> {
        let mut values: Vec<f64> = Vec::new();
        for field in fields {
            for value in field?.values().iter().map(|v| f64::from(*v)) {
                if value.is_nan() {
                    continue;
                }
                // Zero of either sign is one value.
                let value = value + 0.0;
                let Err(at) = values.binary_search_by(|v| v.total_cmp(&value)) else {
                    continue;
                };
                if value.fract() != 0.0 {
                    return Ok(Self::NotWhole(value));
                }
                if values.len() == MAX_CATEGORIES {
                    return Ok(Self::TooMany);
                }
                values.insert(at, value);
            }
        }
        Ok(Self::Values(values.into()))
    }
}

/// What was found out, by property; and of cells and faults.
#[derive(Default)]
pub struct OverSteps {
    ranges: Kept<Option<ValueRange>>,
    categories: Kept<Categories>,
    boundaries: Kept<Arc<[Boundary]>>,
    opacities: Kept<Option<Opacity>>,
    weights: OnceLock<Weights>,
    /// By space, and the mean edges by exaggeration too.
    extents: Kept<Arc<Vec<Extent>>>,
    mean_edges: Kept<DVec3>,
    throws: OnceLock<Arc<[Option<f64>]>>,
}

impl OverSteps {
    pub(super) fn weights(&self, find: impl FnOnce() -> Weights) -> Weights {
        self.weights.get_or_init(find).clone()
    }

    pub(super) fn extents(
        &self,
        space: Space,
        find: impl FnOnce() -> Arc<Vec<Extent>>,
    ) -> Arc<Vec<Extent>> {
        let find = || Ok::<_, Infallible>(find());
        let Ok(extents) = self.extents.get(&format!("{space:?}"), find);
        extents
    }

    pub(super) fn mean_edges(
        &self,
        space: Space,
        exaggeration: f64,
        find: impl FnOnce() -> DVec3,
    ) -> DVec3 {
        let find = || Ok::<_, Infallible>(find());
        let key = format!("{space:?} {exaggeration}");
        let Ok(edges) = self.mean_edges.get(&key, find);
        edges
    }

    /// The opacity that is known by a key that says what it was found for, or the one that `find` finds.
    pub(crate) fn opacity<E>(
        &self,
        key: &str,
        find: impl FnOnce() -> Result<Option<Opacity>, E>,
    ) -> Result<Option<Opacity>, E> {
        self.opacities.get(key, find)
    }
}

struct Kept<T>(Mutex<HashMap<String, T>>);

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Clone> Kept<T> {
    /// What is kept under a name, or what `make` makes, which is kept from then on.
    fn get<E>(&self, name: &str, make: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        // Whole entries are put in, so a thread that panicked left none half made.
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept().get(name).cloned();
        if let Some(known) = known {
            return Ok(known);
        }
        let made = make()?;
        kept().insert(name.to_owned(), made.clone());
        Ok(made)
    }
}

impl Case {
    /// The values of a property (or a difference) at the last step that has it; `None` where no step has.
    ///
    /// # Errors
    /// When the property does not exist or its file cannot be read.
    pub fn last_field(&self, name: &str) -> Result<Option<Arc<CellField>>, CaseError> {
        for step in self.steps_of(name).rev() {
            if let Some(field) = self.field_where_it_is(name, step)? {
                return Ok(Some(field));
            }
        }
        Ok(None)
    }

    /// The range of a property's values (or a difference's) over all steps that have it, but for cells that a local
    /// grid refines; `None` where no value is defined. Read at the first call.
    ///
    /// # Errors
    /// When the property does not exist or its file cannot be read.
    pub fn range_over_steps(&self, name: &str) -> Result<Option<ValueRange>, CaseError> {
        self.over_steps.ranges.get(name, || {
            let steps = self.steps_of(name).into_par_iter();
            let ranges = steps.map(|step| {
                let field = self.field_where_it_is(name, step)?;
                Ok(field.and_then(|f| ValueRange::of(&self.finest(f))))
            });
            let ranges = ranges.collect::<Result<Vec<_>, CaseError>>()?;
            Ok(ranges.into_iter().flatten().reduce(ValueRange::with))
        })
    }

    /// The different values of a property at all steps, where they are whole numbers, but for cells that a local grid
    /// refines. Read at the first call.
    ///
    /// # Errors
    /// When the property does not exist or its file cannot be read.
    pub fn categories(&self, name: &str) -> Result<Categories, CaseError> {
        self.over_steps.categories.get(name, || {
            let steps = self.steps_of(name);
            let fields = steps.map(|step| self.field_where_it_is(name, step).transpose());
            let finest = fields.flatten().map(|field| field.map(|f| self.finest(f)));
            Categories::of(finest)
        })
    }

    /// Boundaries in the values of a property at the last step that has it, in a scale. Found at the
    /// first call.
    ///
    /// # Errors
    /// When the property does not exist or its file cannot be read.
    pub fn boundaries(&self, name: &str, scale: &Scale) -> Result<Arc<[Boundary]>, CaseError> {
        let key = match scale {
            Scale::Categories(_) => return Ok(Arc::default()),
            Scale::Linear => name.to_owned(),
            Scale::Log => format!("log {name}"),
        };
        self.over_steps.boundaries.get(&key, || {
            let Some(field) = self.last_field(name)? else {
                return Ok(Arc::default());
            };
            let field = scale.field(&field, f64::NAN);
            let samples = derivatives::samples(self.grid.in_map_space(), &field, None);
            Ok(boundaries::find(&samples).into())
        })
    }

    /// The largest throw of each named fault, whichever side lies deeper, in the grid's length unit; `None` of
    /// one without a face between two active cells. Found at the first call.
    pub fn largest_throws(&self) -> Arc<[Option<f64>]> {
        let find = || {
            let mut largest = vec![None; self.about.named_faults.len()];
            let grid = self.grid.in_map_space();
            for (fault, ijk, face) in self.fault_faces.faces(grid.dims().nk) {
                let throw = grid.throw(ijk, face).map(f64::abs);
                if let (Some(throw), Some(largest)) = (throw, largest.get_mut(fault)) {
                    *largest = Some(largest.map_or(throw, |known: f64| known.max(throw)));
                }
            }
            largest.into()
        };
        self.over_steps.throws.get_or_init(find).clone()
    }

    /// The values of a field but for cells that a local grid refines: the finer ones count in their place, and a
    /// simulator may leave anything there.
    pub(crate) fn finest(&self, field: Arc<CellField>) -> Arc<CellField> {
        let Some(finest) = self.grid.finest() else {
            return field;
        };
        let values = field.values().iter().zip(finest);
        let values = values.map(|(value, is_finest)| if is_finest { *value } else { f32::NAN });
        Arc::new(CellField::new(values.collect()))
    }

    fn steps_of(&self, name: &str) -> std::ops::Range<usize> {
        match self.is_dynamic(name) {
            true => 0..self.steps.len(),
            false => 0..1,
        }
    }

    fn field_where_it_is(
        &self,
        name: &str,
        step: usize,
    ) -> Result<Option<Arc<CellField>>, CaseError> {
        match self.field(name, step) {
            Ok(field) => Ok(Some(field)),
            Err(error) if error.is_gap() => Ok(None),
            Err(error) => Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(values: &[f32]) -> CellField {
        CellField::new(values.to_vec())
    }

    #[test]
    fn ranges_leave_out_what_is_undefined() {
        let range = ValueRange::of(&field(&[-2.0, f32::NAN, 0.5, 3.0, 1e20])).unwrap();
        assert_eq!((range.min, range.max), (-2.0, 3.0));
        assert_eq!(range.least_positive, Some(0.5));
        let negative = ValueRange::of(&field(&[-2.0, 0.0])).unwrap();
        assert_eq!(negative.least_positive, None);
        assert_eq!(negative.with(range).least_positive, Some(0.5));
        assert_eq!(ValueRange::of(&field(&[f32::NAN])), None);
    }

    #[test]
    fn categories_are_whole_and_few() {
        let of = |fields: &[&[f32]]| {
            let fields = fields.iter().map(|f| Ok::<_, Infallible>(field(f).into()));
            Categories::of(fields).unwrap()
        };
        let two_steps = of(&[&[3.0, 1.0, f32::NAN], &[-0.0, 0.0, 3.0]]);
        assert_eq!(two_steps, Categories::Values([0.0, 1.0, 3.0].into()));
        assert_eq!(of(&[&[1.0], &[0.5]]), Categories::NotWhole(0.5));
        let many: Vec<f32> = (0..65).map(|n| n as f32).collect();
        assert_eq!(of(&[&many]), Categories::TooMany);
        assert!(matches!(of(&[&many[1..]]), Categories::Values(v) if v.len() == 64));
        assert_eq!(of(&[&[f32::NAN]]), Categories::Values([].into()));
    }
}
