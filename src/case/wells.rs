//! Wells of a step, and the cells that they are connected to.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::CaseError;
use crate::model::{Dims, Ijk};

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
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Well {
    /// Its name.
    pub name: String,
    /// What it does.
    pub kind: WellKind,
    /// It flows.
    pub is_open: bool,
    /// Its connections, in the order of the file.
    pub connections: Vec<Connection>,
}

impl Well {
    /// The cells of the global grid that it is connected to, in the order of the file.
    pub fn global_cells(&self, dims: Dims) -> impl Iterator<Item = Ijk> {
        let of_global = self.connections.iter().filter(|c| c.grid.is_none());
        let cells = of_global.map(|c| c.cell);
        cells.filter(move |c| c.i < dims.ni && c.j < dims.nj && c.k < dims.nk)
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
