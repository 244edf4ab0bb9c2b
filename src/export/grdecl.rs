//! GRDECL text: the grid, and properties with a value for each cell.

use std::fs::File;
use std::io;
use std::path::Path;

use strataray_parsers::deck::{self, DeckWriter, GridText, Number};
use strataray_parsers::egrid::Egrid;

use super::contents::{Contents, Exported, is_single};
use super::eclipse::egrid;
use super::error::{ExportError, failed};
use super::names::{keyword, note_keywords};
use super::of_step;
use super::output::Output;

/// Writes the grid with static properties, and those of a step too where it is the only one; else each step has a file
/// of its own.
pub(super) fn write(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    note_keywords(contents, path, output)?;
    let cells = contents.grid().dims().cells();
    output.expect((8 + contents.pairs().len()) * cells);
    let mut writer = DeckWriter::new(output.file(path)?);
    write_grid(contents, &mut writer).map_err(failed(path))?;
    output.advance(8 * cells)?;
    let mut text = Text {
        contents,
        path,
        writer,
    };
    text.properties(contents.statics(), 0, output)?;
    let steps = contents.changing_steps();
    if let [step] = *steps {
        text.properties(contents.dynamics(), step, output)?;
    }
    text.finish()?;
    for step in steps.iter().filter(|_| steps.len() > 1) {
        let path = &of_step(path, *step);
        let mut text = Text {
            contents,
            path,
            writer: DeckWriter::new(output.file(path)?),
        };
        text.properties(contents.dynamics(), *step, output)?;
        text.finish()?;
    }
    Ok(())
}

/// A file in the making.
struct Text<'a> {
    contents: &'a Contents<'a>,
    path: &'a Path,
    writer: DeckWriter<File>,
}

impl Text<'_> {
    fn properties<'p>(
        &mut self,
        properties: impl Iterator<Item = &'p Exported>,
        step: usize,
        output: &mut Output<'_>,
    ) -> Result<(), ExportError> {
        for property in properties {
            if let Some(values) = self.contents.values(&property.name, step)? {
                let all = self.contents.spread(values, 0.0);
                let written = self.writer.property(&keyword(&property.name), &all);
                written.map_err(failed(self.path))?;
            }
            output.advance(self.contents.grid().dims().cells())?;
        }
        Ok(())
    }

    fn finish(self) -> Result<(), ExportError> {
        self.writer.finish().map(drop).map_err(failed(self.path))
    }
}

/// As 32-bit numbers where the grid has no others, which takes half the text.
fn write_grid(contents: &Contents<'_>, writer: &mut DeckWriter<File>) -> io::Result<()> {
    let egrid = egrid(contents);
    if is_single(contents.grid()) {
        return self::grid(writer, &egrid);
    }
    let (coord, zcorn) = contents.grid().main_corners(|v| v);
    with_corners(writer, &egrid, &coord, &zcorn)
}

/// Writes a grid as text.
pub(super) fn grid(writer: &mut DeckWriter<File>, egrid: &Egrid) -> io::Result<()> {
    with_corners(writer, egrid, &egrid.coord, &egrid.zcorn)
}

fn with_corners<T: Number>(
    writer: &mut DeckWriter<File>,
    egrid: &Egrid,
    coord: &[T],
    zcorn: &[T],
) -> io::Result<()> {
    let unit = egrid.grid_unit.as_ref().map(|unit| deck::GridUnit {
        name: unit.length.clone(),
        is_map: unit.is_map,
    });
    writer.grid(&GridText {
        dims: egrid.dims,
        coord,
        zcorn,
        actnum: egrid.actnum.as_deref(),
        map_axes: egrid.map_axes,
        map_units: egrid.map_units.as_deref(),
        grid_unit: unit.as_ref(),
    })
}
