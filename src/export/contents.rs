//! What is exported: cells of a case, properties, steps.

use std::sync::Arc;

use glam::{DAffine3, DMat3};

use super::error::ExportError;
use crate::case::{Case, CaseError, Units};
use crate::model::{CellIndex, Grid, Ijk, Spaces};
use crate::view::View;

/// What is exported of a case.
pub struct Contents<'a> {
    /// The case.
    pub case: &'a Case,
    /// What is seen of it; absent where all active cells are written.
    pub view: Option<&'a View>,
    /// Units of the numbers in tables: at first those of the view, else those of the files. All other formats have those
    /// of the files.
    pub units: Units,
    /// Properties.
    pub properties: Vec<Exported>,
    /// Steps of those that change with time.
    pub steps: Vec<usize>,
    /// The grid: the case's, or its main grid alone.
    grid: Arc<Grid>,
    /// By active index of the grid the one of the case's, where it is another grid.
    places: Option<Vec<usize>>,
    /// By active index of the grid: true for cells that are written.
    drawn: Vec<bool>,
}

/// A property that is exported.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// Its name in the case, or that of a difference.
    pub name: String,
    /// Its unit; empty where there is none.
    pub unit: String,
    /// Its values change with the step.
    pub is_dynamic: bool,
}

impl<'a> Contents<'a> {
    /// The cells that a view shows, or all active ones that no local grid refines, and properties by name at some steps.
    ///
    /// # Errors
    /// When no cell is written, or the case does not have a property, or not at any of the steps.
    pub fn new(
        case: &'a Case,
        view: Option<&'a View>,
        names: &[String],
        steps: &[usize],
    ) -> Result<Self, ExportError> {
        let drawn = match view {
            Some(view) => view.seen_cells(&case.grid),
            None => {
                let all = || vec![true; case.grid.active_cells().len()];
                case.grid.finest().unwrap_or_else(all)
            }
        };
        if !drawn.contains(&true) {
            return Err(ExportError::Empty);
        }
        let mut properties: Vec<Exported> = Vec::new();
        for name in names {
            let property = exported(case, name, steps)?;
            if !properties.contains(&property) {
                properties.push(property);
            }
        }
        Ok(Self {
            case,
            view,
            units: view.map_or_else(Units::default, |view| view.notes.units),
            properties,
            steps: steps.to_vec(),
            grid: case.grid.clone(),
            places: None,
            drawn,
        })
    }

    /// The same of the main grid alone, for files that hold one grid: without a view all of its cells.
    ///
    /// # Errors
    /// When no cell is left.
    pub(super) fn of_main_grid(&self) -> Result<Self, ExportError> {
        let grid = &self.case.grid;
        let main = grid.main_alone();
        let main = main.map_err(|error| ExportError::Grid(error.to_string()))?;
        let places: Vec<usize> = grid.active_in(0).map(|(active, _)| active).collect();
        let is_drawn = |place: &usize| self.view.is_none() || self.drawn[*place];
        let drawn: Vec<bool> = places.iter().map(is_drawn).collect();
        if !drawn.contains(&true) {
            return Err(ExportError::Empty);
        }
        Ok(Self {
            case: self.case,
            view: self.view,
            units: self.units,
            properties: self.properties.clone(),
            steps: self.steps.clone(),
            grid: Arc::new(main),
            places: Some(places),
            drawn,
        })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// By active index of the grid: true for cells that are written.
    pub fn drawn(&self) -> &[bool] {
        &self.drawn
    }

    /// The cells that are written, in natural order.
    pub fn cells(&self) -> impl Iterator<Item = Ijk> + '_ {
        let dims = self.grid().dims();
        self.indices().map(move |cell| dims.ijk(cell))
    }

    fn indices(&self) -> impl Iterator<Item = CellIndex> + '_ {
        let cells = self.grid().active_cells().iter().zip(&self.drawn);
        cells.filter(|(_, drawn)| **drawn).map(|(cell, _)| *cell)
    }

    /// How many cells are written.
    pub fn count(&self) -> usize {
        self.drawn.iter().filter(|drawn| **drawn).count()
    }

    /// Properties that are the same at all steps.
    pub fn statics(&self) -> impl Iterator<Item = &Exported> + Clone {
        self.properties.iter().filter(|p| !p.is_dynamic)
    }

    /// Properties that change with the step.
    pub fn dynamics(&self) -> impl Iterator<Item = &Exported> + Clone {
        self.properties.iter().filter(|p| p.is_dynamic)
    }

    /// The steps that files differ by: none where no property changes with time.
    pub fn changing_steps(&self) -> &[usize] {
        match self.dynamics().next() {
            Some(_) => &self.steps,
            None => &[],
        }
    }

    /// Each property with each of the steps that it is written at, those of one step together.
    pub fn pairs(&self) -> Vec<(&Exported, Option<usize>)> {
        let statics = self.statics().map(|p| (p, None));
        let at = |step: &usize| {
            let step = Some(*step);
            self.dynamics().map(move |p| (p, step))
        };
        statics.chain(self.steps.iter().flat_map(at)).collect()
    }

    /// Values of the cells that are written, in natural order, NaN where undefined; `None` where the property has none
    /// at this step.
    ///
    /// # Errors
    /// When they cannot be read.
    pub fn values(&self, property: &str, step: usize) -> Result<Option<Vec<f32>>, ExportError> {
        let field = match self.case.field(property, step) {
            Err(error) if error.is_gap() => return Ok(None),
            field => field?,
        };
        let values = field.values();
        let value = |active: usize| match &self.places {
            Some(places) => values[places[active]],
            None => values[active],
        };
        let drawn = (0..self.drawn.len()).filter(|active| self.drawn[*active]);
        Ok(Some(drawn.map(value).collect()))
    }

    /// A value for each of all cells, from one for each that is written and one for all others.
    pub fn spread<T: Clone>(&self, values: impl IntoIterator<Item = T>, other: T) -> Vec<T> {
        let mut all = vec![other; self.grid().dims().cells()];
        for (cell, value) in self.indices().zip(values) {
            all[cell.0 as usize] = value;
        }
        all
    }

    /// 1 for cells that are written, else 0.
    pub fn actnum(&self) -> Vec<i32> {
        self.spread(std::iter::repeat_n(1, self.count()), 0)
    }

    /// The unit of the map, or of the grid where that lies on none.
    pub fn map_unit(&self) -> &str {
        let axes = self.grid().map_axes();
        let unit = axes.and_then(|axes| axes.unit);
        unit.map_or(&self.case.about.length_unit, |unit| unit.name)
    }

    /// Map coordinates from those of the grid: z is up, and all lengths are in the unit of the map.
    pub fn map_from_grid(&self) -> DAffine3 {
        let spaces = Spaces::new(self.grid().map_axes(), 1.0);
        let unit = spaces.map_unit.map_or(1.0, |unit| unit.length);
        DAffine3::from_mat3(DMat3::from_diagonal(glam::DVec3::splat(1.0 / unit)))
            * spaces.world_from_grid
    }
}

fn exported(case: &Case, name: &str, steps: &[usize]) -> Result<Exported, ExportError> {
    let name = match case.difference(name) {
        Some(_) => name.to_owned(),
        None => case.property(name)?.name.clone(),
    };
    let is_dynamic = case.is_dynamic(&name);
    if is_dynamic {
        has_values(case, &name, steps)?;
    }
    Ok(Exported {
        unit: case.unit(&name).to_owned(),
        name,
        is_dynamic,
    })
}

/// Refuses a property that has no values at any of the steps; those at the first step that has some are read.
fn has_values(case: &Case, name: &str, steps: &[usize]) -> Result<(), CaseError> {
    let mut missing = None;
    for step in steps {
        match case.field(name, *step) {
            Err(error) if error.is_gap() => missing = missing.or(Some(error)),
            field => return field.map(drop),
        }
    }
    missing.map_or(Ok(()), Err)
}

/// True where all coordinates of a grid are 32-bit numbers.
pub(super) fn is_single(grid: &Grid) -> bool {
    let is = |v: f64| f64::from(v as f32) == v;
    let ends = |p: &crate::model::Pillar| p.top.to_array().into_iter().chain(p.bottom.to_array());
    grid.depths().iter().all(|v| is(*v)) && grid.pillars().iter().flat_map(ends).all(is)
}
