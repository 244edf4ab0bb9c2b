//! The values of the selected cells as a text table: one row per cell, step and property.

use std::io;

use crate::case::{Case, Units};
use crate::export::table::{CsvTable, Row};
use crate::viewer::reader::{Curves, Table};

/// Values of the step, then those of the curves at all other steps, as comma-separated text in some units.
///
/// # Errors
/// When it cannot be written; the sentence is for people.
pub fn csv(table: &Table, curves: Option<&Curves>, units: Units) -> Result<String, String> {
    let bytes = written(table, curves, units);
    let text = bytes.and_then(|bytes| String::from_utf8(bytes).map_err(io::Error::other));
    text.map_err(|e| format!("the table cannot be written: {e}"))
}

fn written(table: &Table, curves: Option<&Curves>, units: Units) -> io::Result<Vec<u8>> {
    let mut out = CsvTable::new(&table.of.case, units, Vec::new())?;
    for (cell, values) in by_cell(table, curves) {
        for (property, step, value) in values {
            out.row(&Row {
                cell: table.of.case.grid.name_of(cell),
                step,
                property,
                value,
            })?;
        }
    }
    out.finish()
}

/// Property, step (none where the property does not change) and value.
type Value<'a> = (&'a str, Option<usize>, f32);

/// The values of each cell: those of the table, then those of the curves.
fn by_cell<'a>(
    table: &'a Table,
    curves: Option<&'a Curves>,
) -> impl Iterator<Item = ([usize; 3], Vec<Value<'a>>)> {
    // Curves are read by and by; those of other cells are not of this table.
    let curves = curves.filter(|c| c.of == table.of);
    let cells = table.of.cells.iter().enumerate();
    cells.map(move |(n, cell)| {
        let rows = table.rows.iter();
        let mut values: Vec<_> = rows
            .filter_map(|(name, _, values)| {
                let step = is_dynamic(&table.of.case, name).then_some(table.step);
                Some((name.as_str(), step, (*values.get(n)?)?))
            })
            .collect();
        for curve in curves.iter().flat_map(|c| &c.curves) {
            let points = curve.points.get(n).into_iter().flatten();
            let others = points.filter(|(step, _)| *step != table.step);
            values.extend(others.map(|(step, v)| (curve.property.as_str(), Some(*step), *v)));
        }
        (*cell, values)
    })
}

fn is_dynamic(case: &Case, property: &str) -> bool {
    case.is_dynamic(property)
}
