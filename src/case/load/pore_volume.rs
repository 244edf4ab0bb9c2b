//! Cells of a deck whose pore volume is so small that a simulator makes them inactive (MINPV).

use strataray_parsers::deck::DeckProperty;
use strataray_parsers::units::{LengthUnit, UnitSystem};

use super::grids::Loaded;
use crate::model::derived::Derived;

/// MINPV of a whole deck that gives none.
const DEFAULT: f64 = 1e-6;

/// Makes the cells inactive whose pore volume is below MINPV; a note says how many, or why none.
pub fn leave_small(
    loaded: &mut Loaded,
    units: UnitSystem,
    length: LengthUnit,
    notes: &mut Vec<String>,
) {
    // A deck that names phases is one that a simulator runs.
    let is_whole = loaded.is_deck && loaded.phases != 0;
    let given = loaded.min_pore_volume;
    let Some(least) = given.or(is_whole.then_some(DEFAULT)) else {
        return;
    };
    let array = |name: &str| loaded.texts.iter().find(|property| property.name == name);
    let Some(porosity) = array("PORO") else {
        if given.is_some() {
            notes.push("MINPV was not applied: the deck gives no PORO".into());
        }
        return;
    };
    let factors = [Some(porosity), array("NTG"), array("MULTPV")];
    let edited = array("PORV");
    let all = factors.into_iter().chain([edited]).flatten();
    let doubt = all.filter_map(|property| property.doubt.as_ref()).next();
    if let (Some(doubt), Some(_)) = (doubt, given) {
        notes.push(format!(
            "MINPV may leave out other cells than the simulator: {doubt}"
        ));
    }
    let unit = length.meters().powi(3) / units.pore_volume_in_cubic_meters();
    let value = |property: Option<&DeckProperty>, cell: usize| property.map(|p| p.values[cell]);
    let volumes = Derived::Volume.field(&loaded.grid);
    let cells = loaded.grid.active_cells().iter().zip(volumes.values());
    let is_small = cells.map(|(cell, volume)| {
        let cell = cell.0 as usize;
        let factors = factors.iter().filter_map(|p| value(*p, cell));
        let computed = f64::from(*volume) * unit * factors.product::<f64>();
        let edited = value(edited, cell).filter(|v| !v.is_nan());
        edited.unwrap_or(computed) < least
    });
    let small: Vec<bool> = is_small.collect();
    let count = small.iter().filter(|small| **small).count();
    if count == 0 {
        return;
    }
    let mut keeps = vec![true; loaded.grid.dims().cells()];
    for (cell, small) in loaded.grid.active_cells().iter().zip(&small) {
        keeps[cell.0 as usize] = !small;
    }
    loaded.grid.retain_active(|cell| keeps[cell.0 as usize]);
    notes.push(match given {
        Some(least) => {
            format!("{count} cells with a pore volume below MINPV ({least}) are inactive")
        }
        None => format!("{count} cells without pore volume are inactive"),
    });
}
