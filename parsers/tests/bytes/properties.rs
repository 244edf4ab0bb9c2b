//! What holds for each reader whatever the bytes: it gives something complete, or an error that a person can act on.
//!
//! Fuzzing uses the same functions (`parsers/fuzz`).

use std::path::Path;

use strataray_parsers::deck::{DeckCells, Grdecl, MemoryFiles, Schedule};
use strataray_parsers::egrid::{Egrid, PorosityModel};
use strataray_parsers::records::{Kind, RecordFile};
use strataray_parsers::resqml::Package;
use strataray_parsers::roff::RoffFile;
use strataray_parsers::summary::Summary;
use strataray_parsers::volume::{self, Options};
use strataray_parsers::{
    ErrorKind, FileBytes, ParseError, Warnings, init, paths as well_paths, restart, wells,
};

/// The name of the file in errors.
const NAME: &str = "ANY.FILE";

/// Reads bytes, decodes all that is in them, and panics where something is not as it must be.
pub type Reader = fn(Vec<u8>) -> Result<(), ParseError>;

/// All readers, by the names of their fuzz targets.
pub const READERS: [(&str, Reader); 15] = [
    ("records", records),
    ("egrid", egrid),
    ("init", init),
    ("restart", restart),
    ("wells", wells),
    ("summary", summary),
    ("esmry", esmry),
    ("roff", roff),
    ("resqml", resqml),
    ("resqml_arrays", resqml_arrays),
    ("deck", deck),
    ("schedule", schedule),
    ("paths", paths),
    ("volume", volume),
    ("segy", segy),
];

/// What makes a file binary, formatted, or a legacy grid: bytes behind it reach the reader of that form.
pub const BINARY_HEAD: &[u8] = &[0, 0, 0, 16];
pub const TEXT_HEAD: &[u8] = b" 'FIRST   '           1 'INTE'\n 1\n";
pub const LEGACY_HEAD: &[u8] =
    b" 'DIMENS  '           3 'INTE'\n 2 1 1\n 'COORDS  '           5 'INTE'\n 1 1 1 1 1\n";

/// `bytes` behind `head`.
pub fn behind(head: &[u8], bytes: &[u8]) -> Vec<u8> {
    [head, bytes].concat()
}

/// Panics unless the reader gives something, or an error that names the file in one line and has a kind.
pub fn holds(reader: Reader, bytes: Vec<u8>) {
    if let Err(error) = reader(bytes) {
        check_error(&error);
    }
}

pub fn check_error(error: &ParseError) {
    let sentence = error.to_string();
    assert_ne!(error.kind, ErrorKind::Other, "{sentence}");
    assert!(sentence.contains(NAME), "{sentence}");
    assert!(!error.message.is_empty(), "{sentence}");
    assert!(!sentence.contains(char::is_control), "{sentence:?}");
}

fn check_warnings(warnings: &Warnings) {
    for warning in warnings.iter() {
        assert!(!warning.message.is_empty(), "{warning}");
        assert!(!warning.to_string().contains('\n'), "{warning}");
    }
}

/// Panics unless the arrays of a grid have the lengths that its dimensions ask for.
pub fn check_grid(dims: [usize; 3], lengths: [usize; 2], actnum: Option<&[i32]>) {
    let [ni, nj, nk] = dims;
    assert_eq!(lengths, [6 * (ni + 1) * (nj + 1), 8 * ni * nj * nk]);
    assert!(actnum.is_none_or(|actnum| actnum.len() == ni * nj * nk));
}

/// Decodes every array, the first ones in every way; one that can be decoded has as many values as its header says.
pub fn decode(file: &RecordFile) {
    for (n, entry) in file.entries().iter().enumerate() {
        let check = |length: Result<usize, ParseError>| match length {
            Ok(length) => assert_eq!(length as u64, entry.count, "{}", entry.name()),
            Err(error) => check_error(&error),
        };
        let is_first = n < 20;
        if is_first || entry.is_numeric() {
            check(file.f64s(entry).map(|values| values.len()));
        }
        if is_first || matches!(entry.kind, Kind::Text(_)) {
            check(file.strings(entry).map(|values| values.len()));
        }
        if is_first {
            check(file.f32s(entry).map(|values| values.len()));
            check(file.i32s(entry).map(|values| values.len()));
            check(file.bools(entry).map(|values| values.len()));
        }
    }
}

/// Arrays, binary or as text.
pub fn records(bytes: Vec<u8>) -> Result<(), ParseError> {
    let file = RecordFile::from_bytes((NAME, bytes))?;
    decode(&file);
    Ok(())
}

/// EGRID, legacy GRID and binary GRDECL, in both forms.
pub fn egrid(bytes: Vec<u8>) -> Result<(), ParseError> {
    let mut warnings = Warnings::default();
    let grid = Egrid::from_bytes((NAME, bytes), &mut warnings)?;
    check_warnings(&warnings);
    let lengths = [grid.coord.len(), grid.zcorn.len()];
    check_grid(grid.dims, lengths, grid.actnum.as_deref());
    for local in &grid.local_grids {
        let [ni, nj, _] = local.dims;
        // Of one coordinate system or several.
        let pillars = 6 * (ni + 1) * (nj + 1);
        assert!(local.coord.len().is_multiple_of(pillars));
        let lengths = [pillars, local.zcorn.len()];
        check_grid(local.dims, lengths, local.actnum.as_deref());
    }
    Ok(())
}

pub fn init(bytes: Vec<u8>) -> Result<(), ParseError> {
    let mut warnings = Warnings::default();
    let arrays = init::from_bytes((NAME, bytes), &mut warnings)?;
    check_warnings(&warnings);
    decode(arrays.file());
    arrays.local_grids()?;
    arrays.joins()?;
    arrays.head()?.time();
    Ok(())
}

pub fn restart(bytes: Vec<u8>) -> Result<(), ParseError> {
    let mut warnings = Warnings::default();
    let steps = restart::unified_from_bytes((NAME, bytes), &mut warnings)?;
    check_warnings(&warnings);
    assert!(!steps.is_empty());
    decode(steps[0].arrays.file());
    for step in &steps {
        step.head.time();
        step.wells()?;
    }
    Ok(())
}

/// Wells of restart steps.
pub fn wells(bytes: Vec<u8>) -> Result<(), ParseError> {
    let mut warnings = Warnings::default();
    for step in restart::unified_from_bytes((NAME, bytes), &mut warnings)? {
        for well in wells::read(&step.arrays)? {
            assert!(!well.name.is_empty());
        }
    }
    Ok(())
}

fn curves(summary: &Summary) -> Result<(), ParseError> {
    assert!(summary.dates().len() <= summary.steps.len());
    for vector in &summary.vectors {
        let values = summary.values(vector)?;
        assert_eq!(values.len(), summary.steps.len(), "{vector}");
    }
    Ok(())
}

/// SMSPEC and UNSMRY, of one file that has the arrays of both.
pub fn summary(bytes: Vec<u8>) -> Result<(), ParseError> {
    let mut warnings = Warnings::default();
    let (spec, data) = ((NAME, bytes.clone()), (NAME, bytes));
    curves(&Summary::from_bytes(spec, data, &mut warnings)?)
}

pub fn esmry(bytes: Vec<u8>) -> Result<(), ParseError> {
    let mut warnings = Warnings::default();
    curves(&Summary::extended_from_bytes((NAME, bytes), &mut warnings)?)
}

pub fn roff(bytes: Vec<u8>) -> Result<(), ParseError> {
    let file = RoffFile::from_bytes((NAME, bytes))?;
    if let Some(grid) = file.grid()? {
        let pillars = grid.pillars();
        let lengths = [pillars.coord.len(), pillars.zcorn.len()];
        check_grid(pillars.dims, lengths, pillars.actnum.as_deref());
    }
    for parameter in file.parameters()? {
        let cells = file.dims()?.iter().product::<usize>();
        assert_eq!(file.values(&parameter)?.len(), cells);
    }
    Ok(())
}

/// A package as resqpy writes it, and the file with its arrays.
pub const PACKAGE: &[u8] = include_bytes!("../../../tests/data/resqml/small.epc");
pub const ARRAYS: &[u8] = include_bytes!("../../../tests/data/resqml/small.h5");

/// A package with the arrays of another one.
pub fn resqml(bytes: Vec<u8>) -> Result<(), ParseError> {
    in_package(bytes, ARRAYS.to_vec())
}

/// The arrays of a package.
pub fn resqml_arrays(bytes: Vec<u8>) -> Result<(), ParseError> {
    in_package(PACKAGE.to_vec(), bytes)
}

fn in_package(package: Vec<u8>, arrays: Vec<u8>) -> Result<(), ParseError> {
    let arrays = FileBytes::from((format!("{NAME}/small.h5"), arrays));
    let package = Package::from_bytes((NAME, package), &[arrays])?;
    for grid in package.grids() {
        let geometry = package.geometry(grid)?;
        package.crs(grid)?;
        let [ni, nj, nk] = geometry.dims;
        assert!(
            geometry
                .splits
                .iter()
                .all(|s| s.pillar < (ni + 1) * (nj + 1))
        );
        for property in package.properties() {
            let values = package.values(property, geometry.dims)?;
            assert_eq!(values.len(), ni * nj * nk);
        }
    }
    Ok(())
}

/// A deck as a grid and as what it says of another one; it may include `PORO.INC`, and itself.
pub fn deck(bytes: Vec<u8>) -> Result<(), ParseError> {
    let files = [(NAME, bytes), ("PORO.INC", b"PORO\n 12*0.25 /\n".to_vec())];
    let files = MemoryFiles::from_iter(files);
    let mut warnings = Warnings::default();
    let named = [Path::new(NAME).to_owned()];
    if let Err(error) = DeckCells::read_from(&files, &named, [3, 2, 2], &mut warnings) {
        check_error(&error);
    }
    let grid = Grdecl::read_from(&files, Path::new(NAME), &[], &mut warnings)?;
    check_warnings(&warnings);
    let lengths = [grid.coord.len(), grid.zcorn.len()];
    check_grid(grid.dims, lengths, grid.actnum.as_deref());
    let cells: usize = grid.dims.iter().product();
    let lengths = match grid.porosity_model {
        PorosityModel::Single => vec![cells],
        _ => vec![cells, 2 * cells],
    };
    let mut properties = grid.properties.iter();
    assert!(properties.all(|p| lengths.contains(&p.values.len())));
    for local in &grid.local_grids {
        let (properties, local) = (&local.properties, &local.grid);
        let lengths = [local.coord.len(), local.zcorn.len()];
        check_grid(local.dims, lengths, local.actnum.as_deref());
        let cells: usize = local.dims.iter().product();
        assert!(properties.iter().all(|p| p.values.len() == cells));
        assert_eq!(local.host.len(), cells);
    }
    for fault in &grid.faults {
        let mut ends = [fault.i, fault.j, fault.k].into_iter().zip(grid.dims);
        assert!(ends.all(|([first, last], n)| first <= last && last <= n));
    }
    Ok(())
}

/// The wells of a deck, which may include itself, at its end and before.
pub fn schedule(bytes: Vec<u8>) -> Result<(), ParseError> {
    Schedule::begins(&bytes);
    let files = MemoryFiles::from_iter([(NAME, bytes)]);
    let mut warnings = Warnings::default();
    let schedule = Schedule::read_from(&files, &[Path::new(NAME)], None, &mut warnings)?;
    check_warnings(&warnings);
    let dims = [3, 2, 2];
    let at_end = schedule.wells(None, dims);
    assert!(at_end.len() <= schedule.names.len());
    assert!(schedule.wells(Some(schedule.end), dims).len() <= at_end.len());
    for completion in at_end.iter().flat_map(|well| &well.completions) {
        let mut axes = completion.cell.iter().zip([3, 2, 2]);
        assert!(axes.all(|(n, most)| (1..=most).contains(n)));
    }
    Ok(())
}

/// Paths of wells.
pub fn paths(bytes: Vec<u8>) -> Result<(), ParseError> {
    well_paths::begin(&bytes, true);
    let mut warnings = Warnings::default();
    let wells = well_paths::from_bytes((NAME, bytes), &mut warnings)?;
    check_warnings(&warnings);
    assert!(!wells.is_empty());
    for well in wells {
        assert!(well.points.len() > 1);
        assert!(well.points.iter().flatten().all(|v| v.is_finite()));
        assert!(well.measured.is_none_or(|m| m.len() == well.points.len()));
    }
    Ok(())
}

/// A volume by what is in it.
pub fn volume(bytes: Vec<u8>) -> Result<(), ParseError> {
    check_volume(NAME, bytes)
}

/// A volume that is SEG-Y by its name.
pub fn segy(bytes: Vec<u8>) -> Result<(), ParseError> {
    check_volume("ANY.FILE.sgy", bytes)
}

fn check_volume(name: &'static str, bytes: Vec<u8>) -> Result<(), ParseError> {
    let volume = volume::from_bytes((name, bytes), &Options::default())?;
    check_warnings(&volume.notes);
    let lattice = &volume.lattice;
    assert!(lattice.samples() > 0);
    assert!(lattice.place([1.0; 3]).iter().all(|v| !v.is_nan()));
    // A few bytes may be compressed from many, and have many places without a trace.
    if lattice.samples() / lattice.dims[volume.slow_axis()] > 1 << 20 {
        return Ok(());
    }
    let slabs = || volume.slabs(1 << 14);
    for slab in slabs().take(3).chain(slabs().last()) {
        assert_eq!(volume.f32s(slab)?.len(), slab.samples());
    }
    Ok(())
}
