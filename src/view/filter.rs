//! Which cells are drawn: by I, J and K, by the values of properties, and by wells.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::error::{SceneError, wrong};
use super::grids::ShownGrids;
use super::step::{step_of, well_step};
use crate::case::{Case, CaseError};
use crate::model::{CellField, Dims, Ijk};
use crate::scene::names::matches_any;
use crate::scene::{Filter, PropertyFilter, StepSpec};

fn check(filter: &PropertyFilter) -> Result<(), SceneError> {
    let name = &filter.name;
    let refuse = |problem: String| Err(wrong("filter.properties", problem));
    match (filter.min, filter.max, &filter.values) {
        (Some(v), ..) | (_, Some(v), _) if v.is_nan() => {
            refuse(format!("{name}: min and max must be numbers"))
        }
        (Some(min), Some(max), _) if min > max => refuse(format!(
            "{name}: min {min} is larger than max {max}; swap them, or use \"invert\": true for the values outside"
        )),
        (Some(_), _, Some(_)) | (_, Some(_), Some(_)) => refuse(format!(
            "{name}: give either min and max or values, not both"
        )),
        _ => Ok(()),
    }
}

/// Which rows, columns and layers are kept, by zero-based index.
fn kept(filter: &Filter, dims: Dims) -> Result<[Vec<bool>; 3], SceneError> {
    let counts = [dims.ni, dims.nj, dims.nk];
    let mut all = counts.map(|count| vec![true; count]);
    let fields = ["filter.i", "filter.j", "filter.k"];
    for (axis, (flags, field)) in all.iter_mut().zip(fields).enumerate() {
        if let Some(kept) = filter.along(axis) {
            *flags = kept.flags(flags.len()).map_err(|e| wrong(field, e))?;
        }
    }
    Ok(all)
}

/// Extent of the thinnest part that the filter leaves, given the mean edges of the cells along I, J and
/// K: one cell where it goes by values or wells, else the shortest run of rows, columns or layers that it keeps.
/// `None` where it hides nothing.
///
/// # Errors
/// As [`drawn`].
pub(super) fn thinnest(
    filter: &Filter,
    dims: Dims,
    edges: DVec3,
) -> Result<Option<f64>, SceneError> {
    let by_value = filter.properties.iter().any(PropertyFilter::limits) || !filter.wells.is_empty();
    let along = kept(filter, dims)?.into_iter().zip(edges.to_array());
    let runs = along.filter_map(|(flags, edge)| {
        let hides = flags.contains(&false);
        let runs = flags.chunk_by(|a, b| a == b).filter(|run| run[0]);
        let shortest = runs.map(<[bool]>::len).min().filter(|_| hides)?;
        Some(shortest as f64 * edge)
    });
    let one_cell = by_value.then(|| edges.min_element());
    Ok(runs.chain(one_cell).min_by(f64::total_cmp))
}

/// Which active cells of a case are drawn, by active index: those of the grids shown with a thickness and a value of
/// `field` that pass the filter. I, J and K of a cell of a local grid are those of the main grid's cell that it lies in.
///
/// # Errors
/// When the filter names what the case does not have, or contradicts itself.
pub(super) fn drawn(
    case: &Case,
    field: &CellField,
    grids: &ShownGrids,
    filter: &Filter,
    step: &StepSpec,
) -> Result<Vec<bool>, SceneError> {
    let grid = &case.grid;
    let dims = grid.dims();
    let [i, j, k] = kept(filter, grid.main_dims())?;
    let passes = |cell: Ijk| {
        let at = grid.main_cell(cell);
        grids.shows(grid, cell) && i[at.i] && j[at.j] && k[at.k]
    };
    let has_all = grids.are_all() && [&i, &j, &k].iter().all(|kept| !kept.contains(&false));
    let cells = grid.active_cells().par_iter().zip(grid.thick());
    let mut drawn: Vec<bool> = cells
        .zip(field.values())
        .map(|((&cell, is_thick), value)| {
            *is_thick && !value.is_nan() && (has_all || passes(dims.ijk(cell)))
        })
        .collect();
    for property in &filter.properties {
        check(property)?;
        if !property.limits() {
            continue;
        }
        let values = values(case, &property.name, step)?;
        let cells = drawn.par_iter_mut().zip(values.values());
        cells.for_each(|(drawn, value)| *drawn &= property.keeps(*value));
    }
    if !filter.wells.is_empty() {
        let connected = connected(case, &filter.wells, well_step(case, step))?;
        let cells = drawn.iter_mut().zip(connected);
        cells.for_each(|(drawn, is_connected)| *drawn &= is_connected);
    }
    Ok(drawn)
}

/// By active index: true where a well whose name matches one of some patterns is connected to the cell at a step,
/// open or not.
fn connected(case: &Case, names: &[String], step: usize) -> Result<Vec<bool>, CaseError> {
    let grid = &case.grid;
    let mut cells = vec![false; grid.active_cells().len()];
    let wells = case.wells(step)?;
    let named = wells.iter().filter(|well| matches_any(names, &well.name));
    for cell in named.flat_map(|well| well.cells(grid)) {
        if let Some(active) = grid.active_index(grid.dims().cell(cell)) {
            cells[active.0 as usize] = true;
        }
    }
    Ok(cells)
}

/// A property that filters, at the scene's step, whether or not the property shown changes with time.
fn values(case: &Case, name: &str, step: &StepSpec) -> Result<Arc<CellField>, SceneError> {
    let at = step_of(case, step, case.is_dynamic(name))?;
    case.field(name, at).map_err(|error| match error {
        CaseError::UnknownProperty { .. } => wrong("filter.properties", error.to_string()),
        error => error.into(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn the_thinnest_part_is_a_cell_a_run_or_nothing() {
        let dims = Dims {
            ni: 10,
            nj: 20,
            nk: 5,
        };
        let edges = DVec3::new(100.0, 50.0, 8.0);
        let of = |json: &str| thinnest(&serde_json::from_str(json).unwrap(), dims, edges).unwrap();
        for (json, expected) in [
            ("{}", None),
            (r#"{"k":[1,5],"properties":[{"name":"A"}]}"#, None),
            (r#"{"k":[2,4]}"#, Some(24.0)),
            (r#"{"i":[3,3]}"#, Some(100.0)),
            (r#"{"j":"1-10,15"}"#, Some(50.0)),
            (r#"{"i":[1,9],"j":[1,19]}"#, Some(900.0)),
            (
                r#"{"i":[3,3],"properties":[{"name":"A","min":1}]}"#,
                Some(8.0),
            ),
        ] {
            assert_eq!(of(json), expected, "{json}");
        }
    }
}
