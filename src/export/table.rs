//! Tables of cells, CSV and Parquet: one row per cell, step and property.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, FloatType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use super::contents::{Contents, Exported};
use super::error::{ExportError, failed};
use super::output::Output;
use crate::case::{Case, Measure, Units};
use crate::model::GridCell;

/// Heads of the columns.
pub const HEADS: [&str; 10] = [
    "case", "grid", "i", "j", "k", "date", "step", "property", "value", "unit",
];

/// What is in the column `grid` of cells of the main grid.
const GLOBAL: &str = "global";

/// The name of a cell's grid in the table.
fn grid_name(cell: GridCell<'_>) -> &str {
    match cell.grid {
        "" => GLOBAL,
        name => name,
    }
}

/// Cells with their values, of those that are one cell of the file the first.
fn named<'a>(
    contents: &'a Contents<'_>,
    values: Vec<f32>,
) -> impl Iterator<Item = (GridCell<'a>, f32)> {
    let grid = contents.grid();
    let cells = contents.cells().zip(values);
    let cells = cells.filter(|(cell, value)| !value.is_nan() && grid.is_first(*cell));
    cells.map(|(cell, value)| (grid.cell_name(cell), value))
}

/// A value of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<'a> {
    /// The cell.
    pub cell: GridCell<'a>,
    /// The step; `None` where the property does not change with time.
    pub step: Option<usize>,
    /// The property.
    pub property: &'a str,
    /// Its value.
    pub value: f32,
}

/// Rows as comma-separated text. Values that do not change with time have no date and no step.
pub struct CsvTable<'a, W: Write> {
    case: &'a Case,
    units: Units,
    /// The property of the last row, and how its values are written.
    measure: (String, Measure),
    writer: csv::Writer<W>,
}

impl<'a, W: Write> CsvTable<'a, W> {
    /// A table of cells of a case in some units, with its heads.
    ///
    /// # Errors
    /// When writing fails.
    pub fn new(case: &'a Case, units: Units, out: W) -> io::Result<Self> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(HEADS)?;
        Ok(Self {
            case,
            units,
            measure: Default::default(),
            writer,
        })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// When writing fails.
    pub fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if self.measure.0 != row.property {
            let measure = self.case.measure(row.property, self.units);
            self.measure = (row.property.to_owned(), measure);
        }
        let measure = &self.measure.1;
        let [i, j, k] = row.cell.ijk.map(|n| n.to_string());
        let step = row.step.and_then(|n| Some((n, self.case.steps.get(n)?)));
        let number = step.map(|(n, _)| n.to_string()).unwrap_or_default();
        Ok(self.writer.write_record([
            self.case.about.name.as_str(),
            grid_name(row.cell),
            &i,
            &j,
            &k,
            step.map_or("", |(_, step)| &step.date),
            &number,
            row.property,
            &measure.show_single(row.value).to_string(),
            &measure.unit,
        ])?)
    }

    /// Writes what is left and gives back where to.
    ///
    /// # Errors
    /// When writing fails.
    pub fn finish(self) -> io::Result<W> {
        let flushed = self.writer.into_inner();
        flushed.map_err(csv::IntoInnerError::into_error)
    }
}

/// Values of the cells at a step, NaN where undefined.
type Values<'a> = (&'a Exported, Option<usize>, Vec<f32>);

/// Reads the values that are written one after the other.
fn each(
    contents: &Contents<'_>,
    output: &mut Output<'_>,
    mut write: impl FnMut(Values<'_>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    if contents.properties.is_empty() {
        return Err(ExportError::NoProperty);
    }
    let pairs = contents.pairs();
    output.expect(pairs.len());
    for (property, step) in pairs {
        if let Some(values) = contents.values(&property.name, step.unwrap_or_default())? {
            write((property, step, values))?;
        }
        output.advance(1)?;
    }
    Ok(())
}

/// Writes a row for each defined value, as comma-separated text.
pub(super) fn write_csv(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    let fail = failed(path);
    let mut table =
        CsvTable::new(contents.case, contents.units, output.file(path)?).map_err(&fail)?;
    each(contents, output, |(property, step, values)| {
        for (cell, value) in named(contents, values) {
            let row = Row {
                cell,
                step,
                property: &property.name,
                value,
            };
            table.row(&row).map_err(&fail)?;
        }
        Ok(())
    })?;
    table.finish().map(drop).map_err(&fail)
}

/// Rows that are held in memory before they are written.
const ROWS: usize = 1 << 20;

/// Writes a row for each defined value, in columns without compression; what repeats is in dictionaries.
pub(super) fn write_parquet(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    let fail = |error: ParquetError| failed(path)(io::Error::other(error));
    let file = output.file(path)?;
    let settings = Arc::new(WriterProperties::builder().build());
    let schema = schema().map_err(fail)?;
    let mut writer = SerializedFileWriter::new(file, schema, settings).map_err(fail)?;
    let mut rows = Columns::default();
    each(contents, output, |(property, step, values)| {
        let measure = contents.case.measure(&property.name, contents.units);
        let values = named(contents, values);
        rows.add(contents.case, (property, &measure), step, values);
        match rows.values.len() >= ROWS {
            true => rows.write(&mut writer).map_err(fail),
            false => Ok(()),
        }
    })?;
    rows.write(&mut writer).map_err(fail)?;
    writer.close().map(drop).map_err(fail)
}

fn schema() -> Result<TypePtr, ParquetError> {
    let column = |name: &&str| {
        let (kind, logical) = match *name {
            "i" | "j" | "k" | "step" => (Physical::INT32, None),
            "value" => (Physical::FLOAT, None),
            _ => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let may_lack = matches!(*name, "date" | "step");
        let repetition = match may_lack {
            true => Repetition::OPTIONAL,
            false => Repetition::REQUIRED,
        };
        let builder = Type::primitive_type_builder(name, kind);
        let builder = builder.with_repetition(repetition);
        builder.with_logical_type(logical).build().map(Arc::new)
    };
    let columns = HEADS.iter().map(column).collect::<Result<_, _>>()?;
    let table = Type::group_type_builder("cells").with_fields(columns);
    table.build().map(Arc::new)
}

/// Rows by column.
#[derive(Default)]
struct Columns {
    case: Vec<ByteArray>,
    grids: Vec<ByteArray>,
    cells: [Vec<i32>; 3],
    /// Of the rows that have one.
    dates: Vec<ByteArray>,
    steps: Vec<i32>,
    /// By row: 1 where there is a step.
    has_step: Vec<i16>,
    properties: Vec<ByteArray>,
    units: Vec<ByteArray>,
    values: Vec<f32>,
}

impl Columns {
    fn add<'c>(
        &mut self,
        case: &Case,
        (property, measure): (&Exported, &Measure),
        step: Option<usize>,
        values: impl Iterator<Item = (GridCell<'c>, f32)>,
    ) {
        let before = self.values.len();
        // Copies share their bytes.
        let mut last = (GLOBAL, ByteArray::from(GLOBAL));
        for (cell, value) in values {
            let name = grid_name(cell);
            if name != last.0 {
                last = (name, ByteArray::from(name));
            }
            self.grids.push(last.1.clone());
            for (column, number) in self.cells.iter_mut().zip(cell.ijk) {
                column.push(number as i32);
            }
            self.values.push(measure.show_single(value));
        }
        let count = self.values.len() - before;
        let text = |column: &mut Vec<ByteArray>, text: &str| {
            column.extend(std::iter::repeat_n(ByteArray::from(text), count));
        };
        text(&mut self.case, &case.about.name);
        text(&mut self.properties, &property.name);
        text(&mut self.units, &measure.unit);
        let step = step.and_then(|n| Some((n, case.steps.get(n)?)));
        if let Some((n, step)) = step {
            text(&mut self.dates, &step.date);
            self.steps.extend(std::iter::repeat_n(n as i32, count));
        }
        let has = i16::from(step.is_some());
        self.has_step.extend(std::iter::repeat_n(has, count));
    }

    /// Writes the rows, in the order of [`HEADS`], and forgets them.
    fn write<W: Write + Send>(
        &mut self,
        writer: &mut SerializedFileWriter<W>,
    ) -> Result<(), ParquetError> {
        let rows = std::mem::take(self);
        if rows.values.is_empty() {
            return Ok(());
        }
        let mut group = writer.next_row_group()?;
        let some = Some(rows.has_step.as_slice());
        column::<ByteArrayType, _>(&mut group, &rows.case, None)?;
        column::<ByteArrayType, _>(&mut group, &rows.grids, None)?;
        for numbers in &rows.cells {
            column::<Int32Type, _>(&mut group, numbers, None)?;
        }
        column::<ByteArrayType, _>(&mut group, &rows.dates, some)?;
        column::<Int32Type, _>(&mut group, &rows.steps, some)?;
        column::<ByteArrayType, _>(&mut group, &rows.properties, None)?;
        column::<FloatType, _>(&mut group, &rows.values, None)?;
        column::<ByteArrayType, _>(&mut group, &rows.units, None)?;
        group.close().map(drop)
    }
}

/// Writes the next column; `has` is 1 for the rows that have a value, where not all do.
fn column<T: parquet::data_type::DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    has: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("there is no column left".into()));
    };
    column.typed::<T>().write_batch(values, has, None)?;
    column.close()
}
