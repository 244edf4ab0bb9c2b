//! A small grid as text and as binary files: 6 x 5 x 4 cells of 100 x 80 x 10 that dip to the east, with a throw of 20
//! between columns 3 and 4.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use strataray_parsers::cells::Head;
use strataray_parsers::egrid::{Egrid, GridUnit, PorosityModel};
use strataray_parsers::init;
use strataray_parsers::restart::RestartWriter;
use strataray_parsers::units::UnitSystem;

pub const DIMS: [usize; 3] = [6, 5, 4];
pub const CELLS: usize = 120;

/// Six values a pillar.
pub fn coord() -> Vec<f32> {
    let pillar = |n: usize| {
        let [x, y] = [100.0 * (n % 7) as f32, 80.0 * (n / 7) as f32];
        [x, y, 1900.0, x, y, 2140.0]
    };
    (0..42).flat_map(pillar).collect()
}

/// Eight depths a cell; those east of the fault are higher by `throw`.
pub fn zcorn(throw: f32) -> Vec<f32> {
    let depth = |at: usize| {
        let [i, j, k] = [at % 12, at / 12 % 10, at / 120];
        let throw = if i > 5 { throw } else { 0.0 };
        let pillar = i.div_ceil(2) + j.div_ceil(2);
        2000.0 + 10.0 * k.div_ceil(2) as f32 + pillar as f32 - throw
    };
    (0..8 * CELLS).map(depth).collect()
}

/// Numbers as text.
pub fn numbers<T: std::fmt::Display>(values: &[T]) -> String {
    values.iter().fold(String::new(), |mut text, value| {
        write!(text, " {value}").unwrap();
        text
    })
}

/// COORD and ZCORN as text.
pub fn geometry(throw: f32) -> String {
    let [coord, zcorn] = [numbers(&coord()), numbers(&zcorn(throw))];
    format!("COORD\n{coord} /\nZCORN\n{zcorn} /\n")
}

/// A porosity that rises from 0.1 to 0.219 cell by cell.
pub fn porosity() -> Vec<f32> {
    (0..CELLS).map(|n| 0.1 + 0.001 * n as f32).collect()
}

/// PORO as text.
pub fn porosity_text() -> String {
    format!("PORO\n{} /\n", numbers(&porosity()))
}

/// The grid and its porosity as text.
pub fn grid_text() -> String {
    let geometry = geometry(20.0);
    format!("SPECGRID\n 6 5 4 1 F /\n{geometry}{}", porosity_text())
}

/// Writes a file, and the folders it is in.
pub fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, content).unwrap();
    path
}

/// The grid as an EGRID file.
pub fn egrid() -> Egrid {
    Egrid {
        dims: DIMS,
        coord: coord(),
        zcorn: zcorn(20.0),
        actnum: Some(vec![1; CELLS]),
        coarse: None,
        map_units: None,
        map_axes: None,
        grid_unit: Some(GridUnit {
            length: "METRES".into(),
            is_map: false,
        }),
        porosity_model: PorosityModel::Single,
        nnc: Vec::new(),
        local_nnc: Vec::new(),
        reservoirs: Vec::new(),
        local_grids: Vec::new(),
    }
}

/// Writes a grid.
pub fn write_egrid(folder: &Path, name: &str, grid: &Egrid) -> PathBuf {
    let path = folder.join(format!("{name}.EGRID"));
    grid.write(std::fs::File::create(&path).unwrap()).unwrap();
    path
}

/// INTEHEAD of a run with `active` cells and phases (1 oil, 2 water, 4 gas) on a day.
pub fn head(active: usize, phases: i32, date: &str) -> Head {
    Head {
        units: Some(UnitSystem::Metric),
        dims: [6, 5, 4],
        active: i32::try_from(active).unwrap(),
        phases,
        date: date.into(),
        ..Head::default()
    }
}

/// Bytes of an INIT file.
pub fn init(head: &Head, arrays: &[(&str, Vec<f32>)]) -> Vec<u8> {
    let arrays = arrays.iter().map(|(name, values)| (*name, values.clone()));
    init::write(Vec::new(), head, arrays).unwrap()
}

/// Arrays of a step.
pub type Arrays<'a> = Vec<(&'a str, Vec<f32>)>;

/// Bytes of a unified restart whose steps are 31 days apart.
pub fn restart(steps: &[(Head, Arrays<'_>)]) -> Vec<u8> {
    let mut writer = RestartWriter::new(Vec::new());
    for (n, (head, arrays)) in steps.iter().enumerate() {
        let arrays = arrays.iter().map(|(name, values)| (*name, values.clone()));
        let days = 31.0 * n as f64;
        writer.step(n as u32, days, head, &[], arrays).unwrap();
    }
    writer.finish().unwrap()
}
