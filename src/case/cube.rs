//! Regular volumes that are shown together with a case, such as seismic: samples on a lattice in the space of the map.
//! Called cubes, so that they are not taken for volumes that are made of the cells.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DAffine3;

use super::CaseError;

/// A regular volume.
#[derive(Debug, PartialEq)]
pub struct Cube {
    /// What the values are, or the name of the file.
    pub name: String,
    /// Unit of the values; empty where the file has none.
    pub unit: String,
    /// Samples along i, j and k.
    pub size: [usize; 3],
    /// From numbers of samples, from 0, to easting, northing and depth.
    pub map_from_sample: DAffine3,
    /// Values, i fastest, then j, then k; NaN where there is none.
    pub values: Vec<f32>,
    /// Samples of the file along each axis that one of these is the mean of.
    pub reduced: usize,
    /// What the values are like; `None` where there are none.
    pub quantiles: Option<Quantiles>,
    /// What is odd, and what was done about it, one sentence each.
    pub notes: Vec<String>,
}

/// What values are like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantiles {
    /// Smallest value.
    pub min: f64,
    /// Above 2 % of the values.
    pub low: f64,
    /// Below 2 % of the values.
    pub high: f64,
    /// Largest value.
    pub max: f64,
}

/// Values that quantiles are taken from, about.
const ASKED: usize = 1 << 20;
/// Part of the values that quantiles leave out at each end.
const OUTSIDE: f64 = 0.02;

impl Quantiles {
    /// Of the finite ones among some values.
    pub fn of(values: &[f32]) -> Option<Self> {
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let (min, max) = finite().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        let mut asked: Vec<f32> = finite().step_by(values.len() / ASKED + 1).collect();
        asked.sort_unstable_by(f32::total_cmp);
        let last = asked.len().checked_sub(1)?;
        let at = |part: f64| f64::from(asked[(part * last as f64).round() as usize]);
        Some(Self {
            min: f64::from(min),
            low: at(OUTSIDE),
            high: at(1.0 - OUTSIDE),
            max: f64::from(max),
        })
    }
}

/// What the third coordinate of a file is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VerticalAxis {
    /// As its format usually has it: depth in SEG-Y, elevation in all others.
    OfFormat,
    /// It grows downward.
    Depth,
    /// It grows upward.
    Elevation,
    /// Two-way time in milliseconds, with a speed of sound in lengths a second.
    Time(f64),
}

/// A file with a cube, and how it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct CubeFile {
    /// The file.
    pub path: PathBuf,
    /// What its third coordinate is.
    pub vertical: VerticalAxis,
}

/// Cubes, once read: those that were asked for last.
#[derive(Debug, Default)]
pub struct Cubes(Mutex<Vec<(CubeFile, Arc<Cube>)>>);

/// Cubes that are kept.
const KEPT: usize = 2;

impl Cubes {
    /// That of a file, which `read` reads where it is not there.
    ///
    /// # Errors
    /// Those of `read`.
    pub fn get(
        &self,
        file: &CubeFile,
        read: impl FnOnce(&CubeFile) -> Result<Cube, CaseError>,
    ) -> Result<Arc<Cube>, CaseError> {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, cube)) = known().iter().find(|(of, _)| of == file) {
            return Ok(cube.clone());
        }
        let cube = Arc::new(read(file)?);
        let mut known = known();
        known.insert(0, (file.clone(), cube.clone()));
        known.truncate(KEPT);
        Ok(cube)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_leave_out_the_ends_and_what_is_absent() {
        let values: Vec<f32> = (0..=1000).map(|n| n as f32).chain([f32::NAN]).collect();
        let found = Quantiles::of(&values).unwrap();
        assert_eq!((found.min, found.max), (0.0, 1000.0));
        assert_eq!((found.low, found.high), (20.0, 980.0));
        assert_eq!(Quantiles::of(&[f32::NAN]), None);
    }
}
