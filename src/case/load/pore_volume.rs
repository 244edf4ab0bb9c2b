//! Pore volumes of decks as a simulator finds them: cells with too little (MINPV) become inactive, and with dual porosity
//! they weigh matrix and fractures.

use strataray_parsers::deck::DeckProperty;
use strataray_parsers::units::{LengthUnit, UnitSystem};

use super::grids::Loaded;
use super::slots::CellFlags;
use crate::model::derived::Derived;
use crate::model::{CellIndex, Grid};

/// MINPV of a whole deck that gives none.
const DEFAULT: f64 = 1e-6;

/// The array of pore volumes.
const PORE_VOLUME: &str = "PORV";

/// What x and y of a grid's corners are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Cells {
    /// Lengths.
    Boxes,
    /// Radii, and angles in degrees.
    Rings,
}

impl Cells {
    /// Volumes by active cell.
    fn bulk_volumes(self, grid: &Grid) -> Vec<f64> {
        let volumes = Derived::Volume.field(grid);
        let cells = grid.active_cells().iter().zip(volumes.values());
        let volume = |(cell, volume): (&CellIndex, &f32)| {
            let volume = f64::from(*volume);
            match self {
                Self::Boxes => volume,
                // A degree is as wide as the radius has it.
                Self::Rings => {
                    let middle = grid.hexahedron(grid.dims().ijk(*cell)).center();
                    volume * middle.x.to_radians()
                }
            }
        };
        cells.map(volume).collect()
    }
}

/// How small the pore volume of a deck's cells may be.
pub struct Least {
    /// MINPV, if the deck gives it.
    given: Option<f64>,
    volume: f64,
    /// A cubic length unit of the grid, as pore volume.
    unit: f64,
}

impl Least {
    /// What a deck says, or implies where a simulator runs it; `None` where cells may have any pore volume.
    fn of(loaded: &Loaded, units: UnitSystem, length: LengthUnit) -> Option<Self> {
        // A deck that names phases is one that a simulator runs.
        let is_whole = loaded.is_deck && loaded.phases != 0;
        let given = loaded.min_pore_volume;
        Some(Self {
            given,
            volume: given.or(is_whole.then_some(DEFAULT))?,
            unit: unit(units, length),
        })
    }

    /// Makes cells of the main grid inactive whose pore volume is below the least; with dual porosity the matrix or the
    /// fractures of a cell. A note says how many, or why none.
    fn leave_small(&self, loaded: &mut Loaded, notes: &mut Vec<String>) {
        let cells = Cells::Boxes;
        let count = self.leave_out(cells, &mut loaded.grid, &mut loaded.flags, &loaded.texts);
        if self.given.is_some() {
            notes.extend(doubt(&loaded.texts));
        }
        if count > 0 {
            notes.push(self.note(count, ""));
        }
    }

    /// Makes cells inactive, or the matrix or the fractures of cells, and says how many.
    fn leave_out(
        &self,
        cells: Cells,
        grid: &mut Grid,
        flags: &mut CellFlags,
        texts: &[DeckProperty],
    ) -> usize {
        let mut parts = match &flags.porosity {
            Some(flags) => flags.clone(),
            None => vec![1; grid.dims().cells()],
        };
        let mut count = 0;
        for (half, part) in [(0, 1), (1, 2)] {
            let Some(volumes) = volumes(cells, grid, texts, self.unit, half) else {
                continue;
            };
            for (cell, volume) in grid.active_cells().iter().zip(volumes) {
                let parts = &mut parts[cell.0 as usize];
                if volume < self.volume && *parts & part != 0 {
                    *parts &= !part;
                    count += 1;
                }
            }
        }
        if count > 0 {
            grid.retain_active(|cell| parts[cell.0 as usize] != 0);
            if let Some(flags) = &mut flags.porosity {
                *flags = parts;
            }
        }
        count
    }

    /// As [`Self::leave_small`], for a local grid with its own arrays.
    pub fn leave_small_of_local(
        &self,
        name: &str,
        cells: Cells,
        grid: &mut Grid,
        flags: &mut CellFlags,
        texts: &[DeckProperty],
        notes: &mut Vec<String>,
    ) {
        let count = self.leave_out(cells, grid, flags, texts);
        if count > 0 {
            notes.push(self.note(count, &format!(" of local grid {name}")));
        }
    }

    fn note(&self, count: usize, of: &str) -> String {
        match self.given {
            Some(least) => {
                format!("{count} cells{of} with a pore volume below MINPV ({least}) are inactive")
            }
            None => format!("{count} cells{of} without pore volume are inactive"),
        }
    }
}

fn array<'a>(texts: &'a [DeckProperty], name: &str) -> Option<&'a DeckProperty> {
    texts.iter().find(|property| property.name == name)
}

/// Why cells that MINPV leaves out may be others than a simulator's.
fn doubt(texts: &[DeckProperty]) -> Option<String> {
    if array(texts, "PORO").is_none() {
        return Some("MINPV was not applied: the deck gives no PORO".into());
    }
    let used = ["PORO", "NTG", "MULTPV", PORE_VOLUME];
    let mut doubts = used
        .iter()
        .filter_map(|name| array(texts, name)?.doubt.as_ref());
    let doubt = doubts.next()?;
    Some(format!(
        "MINPV may leave out other cells than the simulator: {doubt}"
    ))
}

/// Pore volumes by active cell, of the matrix (half 0) or of the fractures (half 1): those that are given, else bulk volume
/// times PORO, NTG and MULTPV. `None` without PORO.
fn volumes(
    cells: Cells,
    grid: &Grid,
    texts: &[DeckProperty],
    unit: f64,
    half: usize,
) -> Option<Vec<f64>> {
    let first = half * grid.dims().cells();
    let porosity = array(texts, "PORO").filter(|p| p.values.len() > first)?;
    let factors = [Some(porosity), array(texts, "NTG"), array(texts, "MULTPV")];
    let given = array(texts, PORE_VOLUME);
    let bulk = cells.bulk_volumes(grid);
    let volume = |(cell, bulk): (usize, f64)| {
        let value = |p: &DeckProperty| p.values.get(first + cell).copied();
        let factors = factors.iter().flatten().filter_map(|p| value(p));
        let computed = || bulk * unit * factors.product::<f64>();
        let given = given.and_then(value).filter(|v| !v.is_nan());
        given.unwrap_or_else(computed)
    };
    let cells = grid.active_cells().iter().map(|cell| cell.0 as usize);
    Some(cells.zip(bulk).map(volume).collect())
}

/// Makes cells of a deck inactive that are too small, and finds the pore volumes of dual porosity. How small cells may be,
/// and a cubic length unit of a deck's grid as pore volume, are for its local grids.
pub fn of_deck(
    loaded: &mut Loaded,
    units: UnitSystem,
    length: LengthUnit,
    notes: &mut Vec<String>,
) -> (Option<Least>, Option<f64>) {
    let least = Least::of(loaded, units, length);
    if let Some(least) = &least {
        least.leave_small(loaded, notes);
    }
    let unit = loaded.is_deck.then(|| unit(units, length));
    if let Some(unit) = unit.filter(|_| loaded.flags.porosity.is_some()) {
        complete(Cells::Boxes, &loaded.grid, &mut loaded.texts, unit);
    }
    (least, unit)
}

/// A cubic length unit of the grid, as pore volume.
fn unit(units: UnitSystem, length: LengthUnit) -> f64 {
    length.meters().powi(3) / units.pore_volume_in_cubic_meters()
}

/// Gives a grid of a deck of dual porosity the pore volumes of matrix and fractures, where the deck says what they follow
/// from.
pub fn complete(cells: Cells, grid: &Grid, texts: &mut Vec<DeckProperty>, unit: f64) {
    let halves = [0, 1].map(|half| volumes(cells, grid, texts, unit, half));
    let [Some(matrix), Some(fractures)] = halves else {
        return;
    };
    let count = grid.dims().cells();
    let mut values = vec![f64::NAN; 2 * count];
    for (half, volumes) in [matrix, fractures].into_iter().enumerate() {
        for (cell, volume) in grid.active_cells().iter().zip(volumes) {
            values[half * count + cell.0 as usize] = volume;
        }
    }
    let doubt = array(texts, PORE_VOLUME).and_then(|p| p.doubt.clone());
    let name = PORE_VOLUME.to_owned();
    texts.retain(|p| p.name != name);
    texts.push(DeckProperty {
        name,
        values,
        doubt,
    });
}
