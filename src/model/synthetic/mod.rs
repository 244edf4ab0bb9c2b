//! Synthetic models: made by formula from a name, dimensions and a seed, for tests and timing.
//!
//! Nothing here reads or writes: the same arguments give the same model on every call. `structure`
//! makes faults, pillars and depths, `activity` the outline, `flood` rock and a water flood, `plain`
//! the box with known answers.

mod activity;
mod flood;
mod noise;
mod plain;
mod structure;
mod volumes;

use super::grid::ModelError;
use super::ids::{Dims, Ijk};

pub use volumes::{SyntheticVolume, VOLUMES, VolumeRecipe};

/// What stands behind a name.
#[derive(Debug, Clone, Copy)]
pub struct Recipe {
    /// The name, in lower case.
    pub name: &'static str,
    /// Dimensions unless others are asked for.
    pub dims: Dims,
    /// Active cells at these dimensions; other dimensions have about the same share.
    pub active: usize,
    shape: Option<Shape>,
}

/// How a faulted model differs from another; the box has none.
#[derive(Debug, Clone, Copy)]
struct Shape {
    /// Number of faults.
    faults: usize,
    /// Every so many layers one pinches out over part of the field; 0 for none.
    pinching_every: usize,
    /// Thin intervals that belong to no layer.
    gaps: bool,
}

/// All synthetic models. `r1` to `r5` have the dimensions and active cells of the models that
/// the literature on this method times (campagnolo-2021, table 4.1); `r6` is larger than these.
pub const RECIPES: [Recipe; 8] = [
    recipe("r1", [60, 20, 10], 12_000, (3, 0, false)),
    recipe("r2", [76, 43, 23], 28_952, (4, 6, false)),
    recipe("r3", [46, 69, 30], 42_353, (5, 6, true)),
    recipe("r4", [102, 72, 40], 286_840, (6, 15, false)),
    recipe("r5", [346, 352, 100], 6_245_219, (9, 7, false)),
    recipe("r6", [640, 520, 150], 30_000_000, (12, 9, false)),
    recipe("faulted", [60, 50, 20], 42_000, (6, 5, true)),
    Recipe {
        name: "box",
        dims: dims([10, 10, 5]),
        active: 500,
        shape: None,
    },
];

const fn dims([ni, nj, nk]: [usize; 3]) -> Dims {
    Dims { ni, nj, nk }
}

const fn recipe(
    name: &'static str,
    size: [usize; 3],
    active: usize,
    (faults, pinching_every, gaps): (usize, usize, bool),
) -> Recipe {
    let shape = Some(Shape {
        faults,
        pinching_every,
        gaps,
    });
    let dims = dims(size);
    Recipe {
        name,
        dims,
        active,
        shape,
    }
}

impl Recipe {
    /// The recipe called `name`, in any letter case.
    pub fn named(name: &str) -> Option<&'static Self> {
        RECIPES.iter().find(|r| r.name.eq_ignore_ascii_case(name))
    }

    /// Makes the model with `steps` report steps; the box is the same for every seed.
    ///
    /// # Errors
    /// When there are no cells or more than 2^31-1, or not enough memory for their corners.
    pub fn build(&self, dims: Dims, seed: u64, steps: usize) -> Result<Synthetic, ModelError> {
        let Dims { ni, nj, nk } = dims;
        let cells = dims.checked_cells();
        let cells = cells.ok_or(ModelError::Dimensions(ni, nj, nk))?;
        // A plain allocation would end the process where memory is short, so ask first.
        let room = Vec::<f32>::new().try_reserve_exact(8 * cells);
        room.map_err(|_| ModelError::Memory(ni, nj, nk))?;
        let steps = report_steps(steps);
        let (geometry, fields) = match self.shape {
            None => plain::build(dims),
            Some(shape) => {
                let share = self.active as f64 / self.dims.cells() as f64;
                faulted(dims, shape, share, seed)
            }
        };
        Ok(Synthetic {
            geometry,
            steps,
            fields,
        })
    }
}

fn faulted(dims: Dims, shape: Shape, share: f64, seed: u64) -> (Geometry, Fields) {
    let mut random = fastrand::Rng::with_seed(seed);
    let structure = structure::Structure::new(dims, shape, &mut random);
    let zcorn = structure.zcorn();
    let coord = structure.coord(&zcorn);
    let actnum = activity::actnum(&structure, &zcorn, share, &mut random);
    let flood = flood::Flood::new(&structure, &zcorn, &actnum, &mut random);
    let geometry = Geometry {
        dims,
        coord,
        zcorn,
        actnum,
        map_axes: Some(MAP_AXES),
    };
    (geometry, Fields::Flood(flood))
}

/// A map system turned by the angle of the 3-4-5 triangle, in numbers that f32 holds exactly.
const MAP_AXES: [f64; 6] = [
    449_400.0,
    6_800_800.0,
    450_000.0,
    6_800_000.0,
    450_800.0,
    6_800_600.0,
];

/// A model: arrays as files hold them, and its properties.
#[derive(Debug)]
pub struct Synthetic {
    /// The grid.
    pub geometry: Geometry,
    /// Report steps.
    pub steps: Vec<Step>,
    /// Gives the values of properties.
    pub fields: Fields,
}

/// The arrays of a grid.
///
/// **Shape**: as in [`super::GridInput`]. **Units**: meters.
#[derive(Debug)]
pub struct Geometry {
    /// Cells along each axis.
    pub dims: Dims,
    /// Pillar ends.
    pub coord: Vec<f32>,
    /// Corner depths.
    pub zcorn: Vec<f32>,
    /// 1 for an active cell, else 0.
    pub actnum: Vec<i32>,
    /// The six numbers of MAPAXES, `None` where coordinates are map coordinates.
    pub map_axes: Option<[f64; 6]>,
}

/// A report step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Report number.
    pub report: u32,
    /// `YYYY-MM-DD`.
    pub date: String,
    /// Days since the first step.
    pub days: f64,
    /// 0 at the first step, 1 at the last.
    pub time: f64,
}

/// Values of properties, computed when asked for.
#[derive(Debug)]
pub enum Fields {
    /// Linear in the cell's place and in time.
    Linear(plain::Linear),
    /// Channels, layers and a water flood.
    Flood(flood::Flood),
}

impl Fields {
    /// Properties that do not change with time.
    pub const STATIC: [&'static str; 5] = ["PORO", "PERMX", "PERMY", "PERMZ", "NTG"];
    /// Properties that every step has; pressure in bar.
    pub const DYNAMIC: [&'static str; 3] = ["PRESSURE", "SWAT", "SGAS"];

    /// Values of the active cells at a time from 0 to 1; `None` for a name that is not listed.
    pub fn values(&self, name: &str, time: f64) -> Option<Vec<f32>> {
        match self {
            Self::Linear(linear) => linear.values(name, time),
            Self::Flood(flood) => flood.values(name, time),
        }
    }

    /// The wells.
    pub fn wells(&self) -> &[Well] {
        match self {
            Self::Linear(_) => &[],
            Self::Flood(flood) => &flood.wells,
        }
    }
}

/// A well, which is there from the first step on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Well {
    /// Its name.
    pub name: String,
    /// It injects water; else it produces.
    pub is_injector: bool,
    /// The cells that it is open to, downward.
    pub cells: Vec<Ijk>,
}

/// Months that the report steps span where there are not more of them.
const MONTHS: usize = 216;

/// Steps on the first of a month, from 2000-01-01 on, evenly over 18 years or each month.
fn report_steps(count: usize) -> Vec<Step> {
    let gap = (MONTHS / (count.max(2) - 1)).max(1);
    let last = days_to_month(gap * (count.max(2) - 1));
    let step = |n: usize| {
        let month = gap * n;
        let days = days_to_month(month);
        Step {
            report: n as u32,
            date: format!("{}-{:02}-01", 2000 + month / 12, month % 12 + 1),
            days,
            time: days / last,
        }
    };
    (0..count).map(step).collect()
}

/// Days from 2000-01-01 to the first of a month counted from there.
fn days_to_month(month: usize) -> f64 {
    let year = 2000 + month / 12;
    let is_leap = |y: usize| y.is_multiple_of(4) && !y.is_multiple_of(100) || y.is_multiple_of(400);
    let before = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334][month % 12];
    let years: usize = (2000..year).map(|y| 365 + usize::from(is_leap(y))).sum();
    let leap_day = usize::from(month % 12 > 1 && is_leap(year));
    (years + before + leap_day) as f64
}
