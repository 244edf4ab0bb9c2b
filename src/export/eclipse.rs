//! EGRID, INIT and UNRST: the files of a case.

use std::io;
use std::path::{Path, PathBuf};

use strataray_parsers::cells::Head;
use strataray_parsers::egrid::{Egrid, GridUnit, PorosityModel};
use strataray_parsers::init;
use strataray_parsers::restart::RestartWriter;
use strataray_parsers::units::{LengthUnit, UnitSystem};

use super::contents::{Contents, Exported};
use super::error::{ExportError, failed};
use super::names::{keyword, note_keywords};
use super::output::Output;
use super::wells;
use crate::case::{Case, Kind, Step};
use crate::model::Ijk;

/// Stands for no value, as simulators have it.
const UNDEFINED: f32 = 1e20;
/// The array of INIT files that has a value for inactive cells too: their volumes are 0.
const PORE_VOLUME: &str = "PORV";

/// Writes the grid to `path`, properties to the INIT beside it, and those that change with time to the UNRST.
pub(super) fn write(
    contents: &Contents<'_>,
    path: &Path,
    output: &mut Output<'_>,
) -> Result<(), ExportError> {
    note_keywords(contents, path, output)?;
    wells::note_paths(contents, output);
    let (cells, count) = (contents.grid().dims().cells(), contents.count());
    output.expect(9 * cells + contents.pairs().len() * count);
    let [init, restart] = ["INIT", "UNRST"].map(|name| sibling(path, name));
    let egrid = egrid(contents);
    output.write(path, |file| egrid.write(file).map(drop))?;
    if contents.dynamics().next().is_none() && restart.exists() {
        return Err(ExportError::Leftover(restart));
    }
    output.advance(9 * cells)?;
    let head = head(contents);
    let file = output.file(&init)?;
    let mut arrays = Arrays::new(contents, contents.statics(), 0, output);
    let written = init::write(file, &head, &mut arrays).map(drop);
    arrays.end(written, &init)?;
    if contents.dynamics().next().is_none() {
        return Ok(());
    }
    let mut writer = RestartWriter::new(output.file(&restart)?);
    for &step in &contents.steps {
        let of_step = contents.case.steps.get(step);
        let (report, days) = of_step.map_or((0, 0.0), |s| (s.report, s.days));
        let head = at(of_step, &head);
        let wells = wells::of_step(contents, step)?;
        let mut arrays = Arrays::new(contents, contents.dynamics(), step, output);
        let written = writer.step(report, days, &head, &wells, &mut arrays);
        arrays.end(written, &restart)?;
    }
    writer.finish().map(drop).map_err(failed(&restart))
}

/// The grid as an EGRID file has it.
pub(super) fn egrid(contents: &Contents<'_>) -> Egrid {
    let grid = contents.grid();
    let about = &contents.case.about;
    let dims = grid.dims();
    let (coord, zcorn) = grid.main_corners(|v| v as f32);
    Egrid {
        dims: [dims.ni, dims.nj, dims.nk],
        coord,
        zcorn,
        actnum: Some(contents.actnum()),
        coarse: None,
        map_units: about.map_axes.map(|_| about.map_unit.clone()),
        map_axes: about.map_axes,
        grid_unit: Some(GridUnit {
            length: about.length_unit.clone(),
            // The case has axes that its grid does not need.
            is_map: about.map_axes.is_some() && grid.map_axes().is_none(),
        }),
        porosity_model: PorosityModel::Single,
        nnc: connections(contents),
        local_nnc: Vec::new(),
        reservoirs: Vec::new(),
        local_grids: Vec::new(),
    }
}

/// Connections between cells that are both written, by their numbers from 1.
fn connections(contents: &Contents<'_>) -> Vec<[i32; 2]> {
    let grid = contents.grid();
    let number = |ijk: &Ijk| {
        (contents.case.grid.patch_of(*ijk) == Some(0)).then_some(())?;
        let cell = grid.dims().cell(*ijk);
        let active = grid.active_index(cell)?;
        contents.drawn()[active.0 as usize].then_some(cell.0 as i32 + 1)
    };
    let pairs = contents.case.connections.iter();
    pairs
        .filter_map(|[a, b]| Some([number(a)?, number(b)?]))
        .collect()
}

fn head(contents: &Contents<'_>) -> Head {
    let dims = contents.grid().dims();
    Head {
        units: Some(unit_system(contents.case)),
        dims: [dims.ni, dims.nj, dims.nk].map(|n| n as i32),
        active: contents.count() as i32,
        phases: phases(contents.case),
        ..Head::default()
    }
}

/// The unit system that gives the properties of the files the units that they have.
fn unit_system(case: &Case) -> UnitSystem {
    use UnitSystem::{Field, Lab, Metric, PvtM};
    let length = LengthUnit::from_name(&case.about.length_unit);
    let of_files = |p: &&crate::case::Property| p.kind != Kind::Derived;
    let fits = |system: &UnitSystem| {
        let mut properties = case.properties.iter().filter(of_files);
        properties.all(|p| p.unit == system.unit_of(&p.name))
    };
    let mut systems = [Metric, Field, Lab, PvtM];
    // Many cases have no property with a unit.
    systems.sort_by_key(|system| Some(system.length()) != length);
    systems.into_iter().find(fits).unwrap_or(systems[0])
}

/// Oil, water and gas as INTEHEAD adds them, by the saturations of a case.
fn phases(case: &Case) -> i32 {
    let bits = [("SOIL", 1), ("SWAT", 2), ("SGAS", 4)];
    let has = |name: &str| case.properties.iter().any(|p| p.name == name);
    let known = bits.iter().filter(|(name, _)| has(name));
    known.map(|(_, bit)| bit).sum()
}

/// The head at a step: its date and time of day.
fn at(step: Option<&Step>, head: &Head) -> Head {
    let text = step.map_or("", |step| step.date.as_str());
    let (date, time) = text.split_once(' ').unwrap_or((text, ""));
    let mut parts = time.split(':').map(|n| n.parse().unwrap_or(0));
    let mut part = || parts.next().unwrap_or(0);
    Head {
        date: date.to_owned(),
        clock: [part(), part(), 1_000_000 * part()],
        ..head.clone()
    }
}

/// A file of another ending beside the grid's, in the letter case of that.
fn sibling(path: &Path, ending: &str) -> PathBuf {
    let grid = path.extension().and_then(|e| e.to_str());
    let is_lower = grid.is_some_and(|e| e.chars().all(|c| !c.is_ascii_uppercase()));
    match is_lower {
        true => path.with_extension(ending.to_ascii_lowercase()),
        false => path.with_extension(ending),
    }
}

/// Arrays of properties at a step, each read when its turn comes. The first that cannot be read ends them.
struct Arrays<'a, 'o, P> {
    contents: &'a Contents<'a>,
    properties: P,
    step: usize,
    output: &'a mut Output<'o>,
    failure: Option<ExportError>,
}

impl<'a, 'o, P: Iterator<Item = &'a Exported>> Arrays<'a, 'o, P> {
    fn new(
        contents: &'a Contents<'a>,
        properties: P,
        step: usize,
        output: &'a mut Output<'o>,
    ) -> Self {
        Self {
            contents,
            properties,
            step,
            output,
            failure: None,
        }
    }

    /// What came of writing them to a file.
    fn end(self, written: io::Result<()>, path: &Path) -> Result<(), ExportError> {
        match self.failure {
            Some(failure) => Err(failure),
            None => written.map_err(failed(path)),
        }
    }

    fn read(&mut self, property: &Exported) -> Result<Option<(String, Vec<f32>)>, ExportError> {
        self.output.advance(self.contents.count())?;
        let Some(mut values) = self.contents.values(&property.name, self.step)? else {
            return Ok(None);
        };
        for value in values.iter_mut().filter(|v| v.is_nan()) {
            *value = UNDEFINED;
        }
        if property.name == PORE_VOLUME && !property.is_dynamic {
            values = self.contents.spread(values, 0.0);
        }
        Ok(Some((keyword(&property.name), values)))
    }
}

impl<'a, P: Iterator<Item = &'a Exported>> Iterator for Arrays<'a, '_, P> {
    type Item = (String, Vec<f32>);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let property = self.properties.next()?;
            match self.read(property) {
                Ok(None) => {}
                Ok(array) => return array,
                Err(failure) => {
                    self.failure = Some(failure);
                    return None;
                }
            }
        }
    }
}
