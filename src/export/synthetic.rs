//! A synthetic model as the files of a case.

use std::io;
use std::path::{Path, PathBuf};

use strataray_parsers::cells::Head;
use strataray_parsers::deck::DeckWriter;
use strataray_parsers::egrid::{self, Egrid, PorosityModel};
use strataray_parsers::init;
use strataray_parsers::restart::RestartWriter;
use strataray_parsers::units::UnitSystem;
use strataray_parsers::wells::{Direction, Kind, Well};

use super::error::{ExportError, failed};
use super::grdecl;
use super::output::Output;
use super::wells;
use crate::model::synthetic::{self, Fields, Geometry, Step, Synthetic};

/// Length unit of synthetic models and of their map.
const METRES: &str = "METRES";
/// Oil, water and gas, as INTEHEAD adds them.
const PHASES: i32 = 7;
/// How much longer a value takes as text than as binary data.
const TEXT: usize = 4;

/// Where to write a model.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// Folder, made where it is missing.
    pub folder: &'a Path,
    /// Base name of the files.
    pub name: &'a str,
    /// Write the grid and its static properties as text too.
    pub text: bool,
}

/// Writes `NAME.EGRID`, `.INIT`, `.UNRST` and perhaps `.GRDECL`, all of them or none; returns their paths.
///
/// `progress` gets the part done and returns false to cancel.
///
/// # Errors
/// When a file cannot be written, or `progress` cancels.
pub fn write(
    model: Synthetic,
    target: &Target<'_>,
    progress: &dyn Fn(f64) -> bool,
) -> Result<Vec<PathBuf>, ExportError> {
    let Target { folder, name, text } = *target;
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let Synthetic {
        geometry,
        steps,
        fields,
    } = model;
    let head = head(&geometry);
    let work = Work::of(&head);
    let mut output = Output::new(&[], progress);
    output.expect(work.total(steps.len(), text));
    let path = |extension: &str| folder.join(format!("{name}.{extension}"));
    let egrid = to_egrid(geometry);
    output.write(&path("EGRID"), |file| egrid.write(file).map(drop))?;
    output.advance(work.geometry)?;
    output.write(&path("INIT"), |file| {
        init::write(file, &head, arrays(&fields, &Fields::STATIC, 0.0)).map(drop)
    })?;
    output.advance(work.statics)?;
    let restart = path("UNRST");
    let mut writer = RestartWriter::new(output.file(&restart)?);
    for step in &steps {
        write_step(&mut writer, step, &head, &fields).map_err(failed(&restart))?;
        output.advance(work.step)?;
    }
    writer.finish().map_err(failed(&restart))?;
    if text {
        output.write(&path("GRDECL"), |file| write_text(file, &egrid, &fields))?;
        output.advance(work.text)?;
    }
    Ok(output.keep()?.files)
}

/// How many values are written to each.
struct Work {
    geometry: usize,
    statics: usize,
    step: usize,
    text: usize,
}

impl Work {
    fn of(head: &Head) -> Self {
        let cells = head.dims.iter().map(|n| *n as usize).product::<usize>();
        let active = head.active as usize;
        // Eight corners and the activity of a cell.
        let geometry = 9 * cells;
        Self {
            geometry,
            statics: Fields::STATIC.len() * active,
            step: Fields::DYNAMIC.len() * active,
            text: TEXT * (geometry + Fields::STATIC.len() * cells),
        }
    }

    fn total(&self, steps: usize, text: bool) -> usize {
        let text = if text { self.text } else { 0 };
        self.geometry + self.statics + steps * self.step + text
    }
}

fn head(geometry: &Geometry) -> Head {
    let dims = geometry.dims;
    Head {
        units: Some(UnitSystem::Metric),
        dims: [dims.ni, dims.nj, dims.nk].map(|n| n as i32),
        active: geometry.actnum.iter().filter(|a| **a != 0).count() as i32,
        phases: PHASES,
        ..Head::default()
    }
}

fn to_egrid(geometry: Geometry) -> Egrid {
    let Geometry {
        dims,
        coord,
        zcorn,
        actnum,
        map_axes,
    } = geometry;
    Egrid {
        dims: [dims.ni, dims.nj, dims.nk],
        coord,
        zcorn,
        actnum: Some(actnum),
        coarse: None,
        map_units: map_axes.map(|_| METRES.into()),
        map_axes,
        grid_unit: Some(egrid::GridUnit {
            length: METRES.into(),
            is_map: false,
        }),
        porosity_model: PorosityModel::Single,
        nnc: Vec::new(),
        local_nnc: Vec::new(),
        reservoirs: Vec::new(),
        local_grids: Vec::new(),
    }
}

/// Properties at a time, each computed when its turn comes.
fn arrays<'a>(
    fields: &'a Fields,
    names: &'a [&'static str],
    time: f64,
) -> impl Iterator<Item = (&'static str, Vec<f32>)> + 'a {
    let values = move |name: &&'static str| Some((*name, fields.values(name, time)?));
    names.iter().filter_map(values)
}

fn well(well: &synthetic::Well) -> Well {
    let kind = match well.is_injector {
        true => Kind::WaterInjector,
        false => Kind::Producer,
    };
    let cells = well.cells.iter().map(|cell| (*cell, true, Direction::Z));
    wells::open_to(&well.name, kind, cells)
}

fn write_step(
    writer: &mut RestartWriter<std::fs::File>,
    step: &Step,
    head: &Head,
    fields: &Fields,
) -> io::Result<()> {
    let head = Head {
        date: step.date.clone(),
        ..head.clone()
    };
    let arrays = arrays(fields, &Fields::DYNAMIC, step.time);
    let wells: Vec<Well> = fields.wells().iter().map(well).collect();
    writer.step(step.report, step.days, &head, &wells, arrays)
}

fn write_text(file: std::fs::File, egrid: &Egrid, fields: &Fields) -> io::Result<()> {
    let mut writer = DeckWriter::new(file);
    grdecl::grid(&mut writer, egrid)?;
    let actnum = egrid.actnum.as_deref().unwrap_or_default();
    for (name, values) in arrays(fields, &Fields::STATIC, 0.0) {
        // Text has a value for inactive cells too.
        let mut active = values.into_iter();
        let of = |a: &i32| match a {
            0 => 0.0,
            _ => active.next().unwrap_or_default(),
        };
        let all: Vec<f32> = actnum.iter().map(of).collect();
        writer.property(name, &all)?;
    }
    writer.finish().map(drop)
}
