//! From a synthetic model to the files of a case: the counterpart of [`crate::case::load`].

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use strataray_parsers::cells::Head;
use strataray_parsers::deck::{self, DeckWriter, GridText};
use strataray_parsers::egrid::{self, Egrid, PorosityModel};
use strataray_parsers::init;
use strataray_parsers::restart::RestartWriter;
use strataray_parsers::units::UnitSystem;

use crate::model::synthetic::{Fields, Geometry, Step, Synthetic};

/// Length unit of synthetic models and of their map.
const METRES: &str = "METRES";
/// Oil, water and gas, as INTEHEAD adds them.
const PHASES: i32 = 7;
/// How much longer a value takes as text than as binary data.
const TEXT: usize = 4;

/// Why a model could not be written.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The file or folder cannot be written.
    #[error("cannot write {}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// Whoever asked does not want it anymore.
    #[error("writing was canceled")]
    Canceled,
}

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

/// Writes `NAME.EGRID`, `.INIT`, `.UNRST` and perhaps `.GRDECL`; returns their paths.
///
/// `progress` gets the part done and returns false to cancel.
///
/// # Errors
/// When a file cannot be written, or `progress` cancels.
pub fn synthetic(
    model: Synthetic,
    target: &Target<'_>,
    progress: &dyn Fn(f64) -> bool,
) -> Result<Vec<PathBuf>, SaveError> {
    let Target { folder, name, text } = *target;
    std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    let Synthetic {
        geometry,
        steps,
        fields,
    } = model;
    let head = head(&geometry);
    let mut progress = WriteProgress::new(&head, steps.len(), text, progress);
    let path = |extension: &str| folder.join(format!("{name}.{extension}"));
    let mut files = vec![path("EGRID"), path("INIT"), path("UNRST")];
    let egrid = to_egrid(geometry);
    write(&files[0], |file| egrid.write(file).map(drop))?;
    progress.advance(progress.geometry)?;
    write(&files[1], |file| {
        init::write(file, &head, arrays(&fields, &Fields::STATIC, 0.0)).map(drop)
    })?;
    progress.advance(progress.statics)?;
    let restart = |e| failed(&files[2], e);
    let mut writer = RestartWriter::new(create(&files[2])?);
    for step in &steps {
        write_step(&mut writer, step, &head, &fields).map_err(restart)?;
        progress.advance(progress.step)?;
    }
    writer.finish().map_err(restart)?;
    if text {
        files.push(path("GRDECL"));
        write(&files[3], |file| write_text(file, &egrid, &fields))?;
        progress.advance(progress.text)?;
    }
    Ok(files)
}

/// Values still to write, by what they are written to.
struct WriteProgress<'a> {
    geometry: usize,
    statics: usize,
    step: usize,
    text: usize,
    total: usize,
    done: usize,
    tell: &'a dyn Fn(f64) -> bool,
}

impl<'a> WriteProgress<'a> {
    fn new(head: &Head, steps: usize, text: bool, tell: &'a dyn Fn(f64) -> bool) -> Self {
        let cells = head.dims.iter().map(|n| *n as usize).product::<usize>();
        let active = head.active as usize;
        // Eight corners and the activity of a cell.
        let geometry = 9 * cells;
        let statics = Fields::STATIC.len() * active;
        let step = Fields::DYNAMIC.len() * active;
        let text = usize::from(text) * TEXT * (geometry + Fields::STATIC.len() * cells);
        Self {
            geometry,
            statics,
            step,
            text,
            total: geometry + statics + steps * step + text,
            done: 0,
            tell,
        }
    }

    fn advance(&mut self, work: usize) -> Result<(), SaveError> {
        self.done += work;
        match (self.tell)(self.done as f64 / self.total as f64) {
            true => Ok(()),
            false => Err(SaveError::Canceled),
        }
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

fn failed(path: &Path, cause: io::Error) -> SaveError {
    let path = path.to_owned();
    SaveError::Io { path, cause }
}

fn create(path: &Path) -> Result<File, SaveError> {
    File::create(path).map_err(|e| failed(path, e))
}

fn write(path: &Path, content: impl FnOnce(File) -> io::Result<()>) -> Result<(), SaveError> {
    content(create(path)?).map_err(|e| failed(path, e))
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

fn write_step(
    writer: &mut RestartWriter<File>,
    step: &Step,
    head: &Head,
    fields: &Fields,
) -> io::Result<()> {
    let head = Head {
        date: step.date.clone(),
        ..head.clone()
    };
    let arrays = arrays(fields, &Fields::DYNAMIC, step.time);
    writer.step(step.report, step.days, &head, fields.wells(), arrays)
}

fn write_text(file: File, egrid: &Egrid, fields: &Fields) -> io::Result<()> {
    let unit = deck::GridUnit {
        name: METRES.into(),
        is_map: false,
    };
    let mut writer = DeckWriter::new(file);
    writer.grid(&GridText {
        dims: egrid.dims,
        coord: &egrid.coord,
        zcorn: &egrid.zcorn,
        actnum: egrid.actnum.as_deref(),
        map_axes: egrid.map_axes,
        map_units: egrid.map_units.as_deref(),
        grid_unit: Some(&unit),
    })?;
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
