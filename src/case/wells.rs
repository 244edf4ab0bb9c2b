//! Wells of a step, and the cells that they are connected to.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::{CaseError, WellPath};
use crate::model::{Grid, Ijk};

/// What a well does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WellKind {
    /// It produces.
    Producer,
    /// It injects oil.
    OilInjector,
    /// It injects water.
    WaterInjector,
    /// It injects gas.
    GasInjector,
    /// The file does not say.
    Unknown,
    /// Nothing is known of it but its path.
    Path,
}

impl WellKind {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Producer => "producer",
            Self::OilInjector => "oil injector",
            Self::WaterInjector => "water injector",
            Self::GasInjector => "gas injector",
            Self::Unknown => "unknown",
            Self::Path => "path",
        }
    }
}

impl WellKind {
    /// With its state, such as `producer, open`.
    pub fn in_words(self, is_open: bool) -> String {
        match self {
            Self::Path => self.name().to_owned(),
            _ => format!("{}, {}", self.name(), if is_open { "open" } else { "shut" }),
        }
    }
}

/// The axis of a cell along which a connection runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ConnectionAxis {
    /// Along I.
    I,
    /// Along J.
    J,
    /// Along K.
    K,
}

/// A cell that a well is connected to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Connection {
    /// Name of the local grid that has the cell; `None` for the global one.
    pub grid: Option<String>,
    /// The cell.
    pub cell: Ijk,
    /// Something can flow.
    pub is_open: bool,
    /// The axis that it runs along.
    pub axis: ConnectionAxis,
}

/// A well at a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Well {
    /// Its name.
    pub name: String,
    /// What it does.
    pub kind: WellKind,
    /// It flows.
    pub is_open: bool,
    /// Its connections, in the order of the file.
    pub connections: Vec<Connection>,
    /// Its path, where a file has it.
    pub path: Option<Arc<WellPath>>,
    /// What the deck's schedule asks of it, such as ORAT and BHP, in the units of the deck.
    pub targets: Vec<(&'static str, f64)>,
}

impl Well {
    /// A well of which nothing is known but its path.
    pub fn of_path(path: &Arc<WellPath>) -> Self {
        Self {
            name: path.name.clone(),
            kind: WellKind::Path,
            is_open: true,
            connections: Vec::new(),
            path: Some(path.clone()),
            targets: Vec::new(),
        }
    }

    /// What it does, and whether it flows, such as `producer, open`.
    pub fn in_words(&self) -> String {
        self.kind.in_words(self.is_open)
    }

    /// False where nothing says where it is.
    pub fn has_place(&self) -> bool {
        !self.connections.is_empty() || self.path.is_some()
    }

    /// The cells of a case's grids that it is connected to, in the order of the file; of a well without connections
    /// those that its path goes through.
    pub fn cells<'a>(&'a self, grid: &'a Grid) -> impl Iterator<Item = Ijk> + use<'a> {
        let on_path = self.path_alone().into_iter();
        let on_path = on_path.flat_map(|path| path.crossings.iter().map(|c| c.cell));
        let connected = self.connections.iter().filter_map(|c| c.cell_in(grid));
        connected.chain(on_path)
    }

    /// As [`Self::cells`], of which those that a local grid refines are left out where others are in that grid.
    pub fn finest_cells<'a>(&'a self, grid: &'a Grid) -> impl Iterator<Item = Ijk> + use<'a> {
        let on_path = self.path_alone().into_iter();
        let on_path = on_path.flat_map(|path| path.finest_crossings(grid).map(|c| c.cell));
        let connections = self.finest_connections(grid);
        connections.filter_map(|c| c.cell_in(grid)).chain(on_path)
    }

    /// The path of a well without connections.
    fn path_alone(&self) -> Option<&WellPath> {
        let path = self.path.as_deref();
        path.filter(|_| self.connections.is_empty())
    }

    /// Its connections, of which one whose cell a local grid refines is left out where others are in that grid.
    pub fn finest_connections<'a>(
        &'a self,
        grid: &'a Grid,
    ) -> impl Iterator<Item = &'a Connection> + use<'a> {
        let refined = |connection: &Connection| grid.host(connection.cell_in(grid)?);
        let refined: Vec<Ijk> = self.connections.iter().filter_map(refined).collect();
        let is_refined = move |cell: Ijk| refined.contains(&cell);
        let connections = self.connections.iter();
        connections.filter(move |c| !c.cell_in(grid).is_some_and(&is_refined))
    }
}

impl Connection {
    /// Its cell in the lattice of a case's grids; `None` where its grid is not there, or does not have the cell.
    pub fn cell_in(&self, grid: &Grid) -> Option<Ijk> {
        let patch = match &self.grid {
            None => 0,
            Some(name) => grid.patch_named(name)?,
        };
        grid.in_lattice(patch, self.cell)
    }
}

/// Wells by step, once read: few bytes beside the values of a step.
#[derive(Debug, Default)]
pub struct WellsOfSteps(Mutex<HashMap<usize, Arc<Vec<Well>>>>);

impl WellsOfSteps {
    /// Those of a step, which `read` reads where they are not there.
    ///
    /// # Errors
    /// Those of `read`.
    pub fn get(
        &self,
        step: usize,
        read: impl FnOnce() -> Result<Vec<Well>, CaseError>,
    ) -> Result<Arc<Vec<Well>>, CaseError> {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(wells) = known().get(&step) {
            return Ok(wells.clone());
        }
        let wells = Arc::new(read()?);
        known().insert(step, wells.clone());
        Ok(wells)
    }
}
