//! A case: one grid, its properties and time steps. Values come through [`Source`], on demand.

mod cache;
mod cube;
mod difference;
mod ensemble;
pub mod load;
mod over_steps;
mod pairing;
mod paths;
mod pores;
mod shared;
mod simbox;
mod units;
mod vectors;
mod weights;
mod wells;

use std::sync::Arc;

pub use cache::FieldCache;
pub use cube::{Cube, CubeFile, Cubes, Quantiles, VerticalAxis};
use strataray_parsers::calendar;
pub use strataray_parsers::calendar::{date_of, days_from};

use crate::model::derived::Derived;
use crate::model::{CellField, FaultFaces, Grid, Ijk};

pub use difference::{Difference, Minus, difference_name, minus};
pub use ensemble::{Ensemble, Statistic, ensemble};
pub use over_steps::{Categories, MAX_CATEGORIES, OverSteps, ValueRange};
pub use pairing::{distinct_names, nearest, of_date};
pub use paths::WellPath;
pub use shared::GridPool;
pub use simbox::Simbox;
pub use units::{Measure, Units};
pub use vectors::{Vector, VectorKind, VectorSource, Vectors};
pub use weights::{Extent, Weighting, Weights};
pub use wells::{Connection, ConnectionAxis, Well, WellKind, WellsOfSteps};

/// Where a property's values come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// One set of values.
    Static,
    /// Values for each time step.
    Dynamic,
    /// Computed by this program.
    Derived,
}

/// A property that can be shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Property {
    /// Keyword or name.
    pub name: String,
    /// Static, dynamic or derived.
    pub kind: Kind,
    /// Unit; empty where there is none.
    pub unit: String,
    /// Number of steps that have it; 0 for a static one.
    pub steps: usize,
    /// Saturations that a derived one is the rest of: it is 1 minus their sum. Empty for all else.
    pub rest_of: Vec<String>,
    /// Why its values may not be what the deck means, as part of a sentence, such as
    /// `MULTIREG of the deck was not applied`; `None` where nothing is known against them.
    pub doubt: Option<String>,
}

impl Property {
    /// A property without steps, against whose values nothing is known.
    pub fn new(name: &str, kind: Kind, unit: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            unit: unit.to_owned(),
            steps: 0,
            rest_of: Vec::new(),
            doubt: None,
        }
    }

    /// True where it follows from the grid alone.
    pub fn is_of_grid(&self) -> bool {
        self.name == CONNECTIONS || Derived::ALL.iter().any(|(name, _)| *name == self.name)
    }

    /// How it is computed, such as `1 - SWAT - SGAS`, where that depends on what the files have.
    pub fn formula(&self) -> Option<String> {
        let terms = self.rest_of.iter().map(|name| format!(" - {name}"));
        (!self.rest_of.is_empty()).then(|| format!("1{}", terms.collect::<String>()))
    }
}

/// A report step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The simulator's report number.
    pub report: u32,
    /// `YYYY-MM-DD`, with ` hh:mm` or ` hh:mm:ss` within a day; empty where the file has none.
    pub date: String,
    /// Days since the start of the simulation.
    pub days: f64,
}

impl Step {
    /// Date and time of day in days since 1970; `None` where the file has none.
    pub fn moment(&self) -> Option<f64> {
        calendar::moment(&self.date)
    }

    /// Its date, or the day since the start where the file has none.
    pub fn when(&self) -> String {
        match self.date.is_empty() {
            true => format!("day {}", self.days),
            false => self.date.clone(),
        }
    }
}

/// A named fault and the number of faces its file gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedFault {
    /// Name.
    pub name: String,
    /// Cell faces.
    pub faces: usize,
    /// MULTFLT: the factor of transmissibilities across it; 0 seals it. `None` where the file has none.
    pub multiplier: Option<f64>,
}

/// What the files say of the case beside grid and values.
#[derive(Debug, Clone, Default)]
pub struct About {
    /// Base name.
    pub name: String,
    /// Files that were read.
    pub files: Vec<std::path::PathBuf>,
    /// Length unit of the grid: METRES, FEET or CM.
    pub length_unit: String,
    /// The six numbers of MAPAXES as read.
    pub map_axes: Option<[f64; 6]>,
    /// Unit of the vertical axis where it is time, as of seismic, and no depth.
    pub time_unit: Option<String>,
    /// The property that the case is about, where its files have one above all: the values of a volume.
    pub subject: Option<String>,
    /// Length unit of map coordinates: METRES, FEET or CM.
    pub map_unit: String,
    /// `single`, `dual` or `dual_permeability`. With fractures, properties such as `SWAT` are of the matrix,
    /// `SWAT.FRACTURE` of the fractures, and `SWAT.TOTAL` of both by pore volume.
    pub porosity_model: String,
    /// Non-neighbor connections of the global grid, as the file counts them.
    pub nnc: usize,
    /// Faults that have a name.
    pub named_faults: Vec<NamedFault>,
    /// Wells by name.
    pub wells: Vec<String>,
    /// Paths of wells.
    pub paths: Vec<Arc<WellPath>>,
    /// Files with summary vectors, which are read once they are asked for.
    pub summary: Vec<std::path::PathBuf>,
    /// What loading took.
    pub load_times: LoadTimes,
    /// What was not loaded or does not fit, one sentence each.
    pub notes: Vec<String>,
}

/// Time that parts of loading took.
#[derive(Debug, Clone, Copy, Default)]
pub struct LoadTimes {
    /// Building the grid from its arrays.
    pub model: std::time::Duration,
}

/// Why a property could not be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// There is no such property.
    #[error("there is no property {name}; {known}")]
    UnknownProperty {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// There is no such step.
    #[error("there is no step {asked}; {known}")]
    UnknownStep {
        /// What was asked for.
        asked: String,
        /// What there is.
        known: String,
    },
    /// A day has several steps.
    #[error("{asked} has the steps {steps}; name one by its number or with the time of day")]
    SeveralSteps {
        /// What was asked for.
        asked: String,
        /// Numbers and times of the steps.
        steps: String,
    },
    /// The property has no values at this step.
    #[error("{name} has no values at step {step}")]
    NotAtStep {
        /// Property.
        name: String,
        /// Step.
        step: usize,
    },
    /// The values need another case, which has no step of this date.
    #[error("{case} has no step of {date}, and values of another date do not take its place")]
    NoStepOfDate {
        /// Name of the other case.
        case: String,
        /// Date that it lacks.
        date: String,
    },
    /// The file could not be read.
    #[error(transparent)]
    Parse(#[from] strataray_parsers::ParseError),
}

impl CaseError {
    /// True where a property has no values at a step, and may have some at others.
    pub fn is_gap(&self) -> bool {
        matches!(self, Self::NotAtStep { .. } | Self::NoStepOfDate { .. })
    }
}

/// Gives the values of file properties; implemented by [`crate::case::load`].
pub trait Source: Send + Sync {
    /// Values of the active cells; `None` where the property has none at this step.
    ///
    /// # Errors
    /// When the file cannot be read.
    fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, CaseError>;

    /// The wells at a step; none where the files have none.
    ///
    /// # Errors
    /// When the file cannot be read.
    fn wells(&self, _step: usize) -> Result<Vec<Well>, CaseError> {
        Ok(Vec::new())
    }

    /// The summary vectors, kept once they are read; `None` where there are none.
    ///
    /// # Errors
    /// When their files cannot be read.
    fn vectors(&self) -> Result<Option<Arc<Vectors>>, CaseError> {
        Ok(None)
    }
}

/// One grid, its properties and time steps.
pub struct Case {
    /// The grid; differences to other cases share it.
    pub grid: Arc<Grid>,
    /// What else the files say.
    pub about: About,
    /// Which faces lie on the faults of [`About::named_faults`], by their number there.
    pub fault_faces: Arc<FaultFaces>,
    /// Pairs of cells that flow connects though they are no neighbors (NNC).
    pub connections: Vec<[Ijk; 2]>,
    /// Time steps in file order.
    pub steps: Vec<Step>,
    /// Properties that can be shown.
    pub properties: Vec<Property>,
    /// Gives the values.
    pub source: Arc<dyn Source>,
    /// Fields used last.
    pub cache: Arc<FieldCache>,
    /// Wells of steps, once read.
    pub wells: Arc<WellsOfSteps>,
    /// What was found out of properties over all steps.
    pub over_steps: Arc<OverSteps>,
    /// The properties that are differences to another case, of a case made by [`minus`].
    pub minus: Vec<Minus>,
    /// The cases of which it has statistics, of a case made by [`ensemble`].
    pub ensemble: Option<Ensemble>,
    /// The same case in index space.
    pub simbox: Simbox,
    /// Regular volumes that are shown with it, once read.
    pub cubes: Arc<Cubes>,
}

impl Case {
    /// The property called `name`, whatever its letter case.
    ///
    /// # Errors
    /// When there is none; the sentence lists what there is.
    pub fn property(&self, name: &str) -> Result<&Property, CaseError> {
        let found = self
            .properties
            .iter()
            .find(|p| p.name.eq_ignore_ascii_case(name));
        found.ok_or_else(|| CaseError::UnknownProperty {
            name: name.to_owned(),
            known: format!(
                "this case has {}",
                self.properties
                    .iter()
                    .map(|p| p.name.as_str())
                    .collect::<Vec<_>>()
                    .join(", ")
            ),
        })
    }

    /// Values of a property at a step (ignored for static ones); those used last are kept.
    ///
    /// `name` may be a difference: to a step as `PRESSURE-PRESSURE@0`, of two properties as `SWAT-SOIL@same`.
    ///
    /// # Errors
    /// When the property or step does not exist or its file cannot be read.
    pub fn field(&self, name: &str, step: usize) -> Result<Arc<CellField>, CaseError> {
        let step = if self.is_dynamic(name) { step } else { 0 };
        if let Some(known) = self.cache.find(name, step) {
            return Ok(known);
        }
        let field = Arc::new(self.computed(name, step)?);
        self.cache.keep(name, step, &field);
        Ok(field)
    }

    /// The wells at a step, kept once they are read.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn wells(&self, step: usize) -> Result<Arc<Vec<Well>>, CaseError> {
        self.wells.get(step, || self.source.wells(step))
    }

    /// The summary vectors, kept once they are read; `None` where the case has none.
    ///
    /// # Errors
    /// When their files cannot be read.
    pub fn vectors(&self) -> Result<Option<Arc<Vectors>>, CaseError> {
        self.source.vectors()
    }

    /// What belongs to a case that is made of this one with values of its own: all but these, and what they make known.
    fn derived_case(&self) -> Self {
        Self {
            grid: self.grid.clone(),
            about: self.about.clone(),
            fault_faces: self.fault_faces.clone(),
            connections: self.connections.clone(),
            steps: self.steps.clone(),
            properties: self.properties.clone(),
            source: self.source.clone(),
            cache: Arc::default(),
            wells: Arc::default(),
            over_steps: Arc::default(),
            minus: Vec::new(),
            ensemble: self.ensemble.clone(),
            simbox: self.simbox.of_same_grid(),
            cubes: self.cubes.clone(),
        }
    }

    /// Values for a case that is made of this one; `None` where there are none at this step.
    fn values_where_they_are(
        &self,
        name: &str,
        step: usize,
    ) -> Result<Option<Vec<f32>>, CaseError> {
        match self.field(name, step) {
            Ok(field) => Ok(Some(field.values().to_vec())),
            Err(CaseError::NotAtStep { .. } | CaseError::UnknownProperty { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn computed(&self, name: &str, step: usize) -> Result<CellField, CaseError> {
        if let Some(difference) = self.difference(name) {
            return self.step_difference(difference, step);
        }
        let property = self.property(name)?;
        match property.kind {
            Kind::Dynamic if self.steps.get(step).is_none() => {
                Err(self.unknown_step(&step.to_string()))
            }
            Kind::Derived => self.derived(property, step),
            _ => self.file_values(&property.name, step),
        }
    }

    /// The unit of a property or of a difference of one.
    pub fn unit(&self, name: &str) -> &str {
        let name = self.difference(name).map_or(name, |d| d.now);
        self.property(name).map_or("", |p| &p.unit)
    }

    /// True where the values of `name` change with the step.
    pub fn is_dynamic(&self, name: &str) -> bool {
        let is_dynamic = |name: &str| self.property(name).is_ok_and(|p| p.steps > 0);
        match self.difference(name) {
            Some(d) => is_dynamic(d.now) || is_dynamic(d.base),
            None => is_dynamic(name),
        }
    }

    /// The step that `text` names: `first`, `last`, a number from 0, a date, or a date with the time of day such as
    /// `2025-01-01 06:30`.
    ///
    /// # Errors
    /// When there is no such step, or several are of that date.
    pub fn step(&self, text: &str) -> Result<usize, CaseError> {
        let found = match text.trim() {
            "first" => Some(0),
            "last" => Some(self.steps.len().saturating_sub(1)),
            text => match text.parse::<usize>() {
                Ok(number) => (number < self.steps.len().max(1)).then_some(number),
                Err(_) => self.step_of_date(text)?,
            },
        };
        found.ok_or_else(|| self.unknown_step(text))
    }

    fn step_of_date(&self, text: &str) -> Result<Option<usize>, CaseError> {
        let those = |is: &dyn Fn(&Step) -> bool| -> Vec<usize> {
            let steps = self.steps.iter().enumerate();
            steps.filter(|(_, s)| is(s)).map(|(n, _)| n).collect()
        };
        let asked = calendar::moment(text);
        let of_day = |s: &Step| s.date.split(' ').next() == Some(text);
        let mut found = those(&|s| s.date == text || asked.is_some() && s.moment() == asked);
        if found.is_empty() && asked.is_some() {
            // A date alone is enough where the day has one step.
            found = those(&of_day);
        }
        match found[..] {
            [] => Ok(None),
            [step] => Ok(Some(step)),
            _ => Err(self.several_steps(text, &found)),
        }
    }

    fn several_steps(&self, asked: &str, found: &[usize]) -> CaseError {
        let named = found
            .iter()
            .map(|&n| format!("{n} ({})", self.steps[n].date));
        let mut steps: Vec<String> = named.take(6).collect();
        if found.len() > steps.len() {
            steps.push(format!("{} more", found.len() - steps.len()));
        }
        CaseError::SeveralSteps {
            asked: asked.to_owned(),
            steps: steps.join(", "),
        }
    }

    fn unknown_step(&self, asked: &str) -> CaseError {
        let known = match (self.steps.first(), self.steps.last()) {
            (Some(a), Some(b)) => format!(
                "this case has steps 0 to {} ({} to {})",
                self.steps.len() - 1,
                a.date,
                b.date
            ),
            _ => "this case has no time steps".into(),
        };
        CaseError::UnknownStep {
            asked: asked.to_owned(),
            known,
        }
    }

    fn file_values(&self, name: &str, step: usize) -> Result<CellField, CaseError> {
        match self.source.values(name, step)? {
            Some(values) => Ok(CellField::new(values)),
            None => Err(CaseError::NotAtStep {
                name: name.to_owned(),
                step,
            }),
        }
    }

    fn derived(&self, property: &Property, step: usize) -> Result<CellField, CaseError> {
        if let Some((_, derived)) = Derived::ALL.iter().find(|(n, _)| *n == property.name) {
            return Ok(derived.field(self.grid.in_map_space()));
        }
        let values = match property.name.as_str() {
            _ if !property.rest_of.is_empty() => self.rest_of(&property.rest_of, step)?,
            CONNECTIONS => self.connection_counts(),
            _ => {
                let thickness = self.derived_thickness()?;
                let poro = self.file_values("PORO", step)?;
                let ntg = match self.properties.iter().any(|p| p.name == "NTG") {
                    true => self.file_values("NTG", step)?.values().to_vec(),
                    false => vec![1.0; thickness.len()],
                };
                let terms = poro.values().iter().zip(&ntg).zip(&thickness);
                terms.map(|((p, n), t)| p * n * t).collect()
            }
        };
        Ok(CellField::new(values))
    }

    /// 1 minus the sum of some saturations.
    fn rest_of(&self, names: &[String], step: usize) -> Result<Vec<f32>, CaseError> {
        let mut rest = vec![1.0; self.grid.active_cells().len()];
        for name in names {
            let field = self.file_values(name, step)?;
            for (rest, value) in rest.iter_mut().zip(field.values()) {
                *rest -= value;
            }
        }
        Ok(rest)
    }

    /// True where a property is 0 in all cells at a step, as where a run has a phase in name only.
    ///
    /// # Errors
    /// As [`Self::field`].
    pub fn is_all_zero(&self, name: &str, step: usize) -> Result<bool, CaseError> {
        let field = self.field(name, step)?;
        let mut defined = field.values().iter().filter(|v| !v.is_nan()).peekable();
        Ok(defined.peek().is_some() && defined.all(|v| *v == 0.0))
    }

    /// Connections of each active cell.
    fn connection_counts(&self) -> Vec<f32> {
        let mut counts = vec![0.0; self.grid.active_cells().len()];
        for ijk in self.connections.iter().flatten() {
            if let Some(active) = self.grid.active_index(self.grid.dims().cell(*ijk)) {
                counts[active.0 as usize] += 1.0;
            }
        }
        counts
    }

    /// DZ of the file where there is one, else the geometric thickness.
    fn derived_thickness(&self) -> Result<Vec<f32>, CaseError> {
        Ok(match self.source.values("DZ", 0)? {
            Some(dz) => CellField::new(dz).values().to_vec(),
            None => {
                let grid = self.grid.in_map_space();
                Derived::Thickness.field(grid).values().to_vec()
            }
        })
    }
}

/// Number of non-neighbor connections of a cell.
pub const CONNECTIONS: &str = "NNC";
/// Porosity times net-to-gross times thickness.
pub const POROSITY_THICKNESS: &str = "PORO_THICKNESS";
