//! Pore volumes of decks as a simulator finds them: cells with too little (MINPV) become inactive, and with dual porosity
//! they weigh matrix and fractures.

use strataray_parsers::deck::DeckProperty;
use strataray_parsers::units::{LengthUnit, UnitSystem};

use super::grids::Loaded;
use crate::model::Grid;
use crate::model::derived::Derived;

/// MINPV of a whole deck that gives none.
const DEFAULT: f64 = 1e-6;

/// The array of pore volumes.
const PORE_VOLUME: &str = "PORV";

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
    pub fn of(loaded: &Loaded, units: UnitSystem, length: LengthUnit) -> Option<Self> {
        // A deck that names phases is one that a simulator runs.
        let is_whole = loaded.is_deck && loaded.phases != 0;
        let given = loaded.min_pore_volume;
        Some(Self {
            given,
            volume: given.or(is_whole.then_some(DEFAULT))?,
            unit: length.meters().powi(3) / units.pore_volume_in_cubic_meters(),
        })
    }

    /// Makes cells of the main grid inactive whose pore volume is below the least; with dual porosity the matrix or the
    /// fractures of a cell. A note says how many, or why none.
    pub fn leave_small(&self, loaded: &mut Loaded, notes: &mut Vec<String>) {
        let cells = loaded.grid.dims().cells();
        let mut parts = match &loaded.flags.porosity {
            Some(flags) => flags.clone(),
            None => vec![1; cells],
        };
        let mut count = 0;
        for (half, part) in [(0, 1), (1, 2)] {
            let Some(volumes) = volumes(&loaded.grid, &loaded.texts, self.unit, half) else {
                continue;
            };
            for (cell, volume) in loaded.grid.active_cells().iter().zip(volumes) {
                let parts = &mut parts[cell.0 as usize];
                if volume < self.volume && *parts & part != 0 {
                    *parts &= !part;
                    count += 1;
                }
            }
        }
        if self.given.is_some() {
            notes.extend(doubt(&loaded.texts));
        }
        if count == 0 {
            return;
        }
        loaded
            .grid
            .retain_active(|cell| parts[cell.0 as usize] != 0);
        if let Some(flags) = &mut loaded.flags.porosity {
            *flags = parts;
        }
        notes.push(self.note(count, ""));
    }

    /// As [`Self::leave_small`], for a local grid with its own arrays.
    pub fn leave_small_of_local(
        &self,
        name: &str,
        grid: &mut Grid,
        texts: &[DeckProperty],
        notes: &mut Vec<String>,
    ) {
        let Some(volumes) = volumes(grid, texts, self.unit, 0) else {
            return;
        };
        let before = grid.active_cells().len();
        let mut keeps = vec![true; grid.dims().cells()];
        for (cell, volume) in grid.active_cells().iter().zip(volumes) {
            keeps[cell.0 as usize] = volume >= self.volume || volume.is_nan();
        }
        grid.retain_active(|cell| keeps[cell.0 as usize]);
        let count = before - grid.active_cells().len();
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
fn volumes(grid: &Grid, texts: &[DeckProperty], unit: f64, half: usize) -> Option<Vec<f64>> {
    let first = half * grid.dims().cells();
    let porosity = array(texts, "PORO").filter(|p| p.values.len() > first)?;
    let factors = [Some(porosity), array(texts, "NTG"), array(texts, "MULTPV")];
    let given = array(texts, PORE_VOLUME);
    let bulk = Derived::Volume.field(grid);
    let volume = |(cell, bulk): (usize, &f32)| {
        let value = |p: &DeckProperty| p.values.get(first + cell).copied();
        let factors = factors.iter().flatten().filter_map(|p| value(p));
        let computed = || f64::from(*bulk) * unit * factors.product::<f64>();
        let given = given.and_then(value).filter(|v| !v.is_nan());
        given.unwrap_or_else(computed)
    };
    let cells = grid.active_cells().iter().map(|cell| cell.0 as usize);
    Some(cells.zip(bulk.values()).map(volume).collect())
}

/// Gives a deck of dual porosity the pore volumes of matrix and fractures, where it says what they follow from.
pub fn complete(loaded: &mut Loaded, units: UnitSystem, length: LengthUnit) {
    if !loaded.is_deck || loaded.flags.porosity.is_none() {
        return;
    }
    let unit = length.meters().powi(3) / units.pore_volume_in_cubic_meters();
    let halves = [0, 1].map(|half| volumes(&loaded.grid, &loaded.texts, unit, half));
    let [Some(matrix), Some(fractures)] = halves else {
        return;
    };
    let cells = loaded.grid.dims().cells();
    let mut values = vec![f64::NAN; 2 * cells];
    for (half, volumes) in [matrix, fractures].into_iter().enumerate() {
        for (cell, volume) in loaded.grid.active_cells().iter().zip(volumes) {
            values[half * cells + cell.0 as usize] = volume;
        }
    }
    let doubt = array(&loaded.texts, PORE_VOLUME).and_then(|p| p.doubt.clone());
    let name = PORE_VOLUME.to_owned();
    loaded.texts.retain(|p| p.name != name);
    loaded.texts.push(DeckProperty {
        name,
        values,
        doubt,
    });
}
