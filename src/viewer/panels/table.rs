//! The values of the selected cells as a text table: one row per cell, step and property.

use crate::case::Case;
use crate::viewer::reader::{Curves, Table};

const HEADS: [&str; 10] = [
    "case", "grid", "i", "j", "k", "date", "step", "property", "value", "unit",
];

/// Values of the step, then those of the curves at all other steps, as comma-separated text. Values that do
/// not change with time have no date and no step.
///
/// # Errors
/// When it cannot be written; the sentence is for people.
pub fn csv(table: &Table, curves: Option<&Curves>) -> Result<String, String> {
    let why = |e: &dyn std::fmt::Display| format!("the table cannot be written: {e}");
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = |row: [&str; 10]| writer.write_record(row).map_err(|e| why(&e));
    write(HEADS)?;
    let case = &*table.of.case;
    for (cell, values) in by_cell(table, curves) {
        for (property, step, value) in values {
            let [i, j, k] = cell.map(|n| n.to_string());
            let at = step.and_then(|n| case.steps.get(n).map(|s| (s.date.clone(), n.to_string())));
            let (date, number) = at.unwrap_or_default();
            write([
                &case.about.name,
                "global",
                &i,
                &j,
                &k,
                &date,
                &number,
                property,
                &value.to_string(),
                case.unit(property),
            ])?;
        }
    }
    let bytes = writer.into_inner().map_err(|e| why(&e))?;
    String::from_utf8(bytes).map_err(|e| why(&e))
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
