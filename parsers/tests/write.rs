//! What the writers write, the readers read back equal; what could not be read back is refused.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    clippy::type_complexity,
    reason = "tests"
)]

use std::path::PathBuf;
use std::{fs, io};

use strataray_parsers::cells::Head;
use strataray_parsers::deck::{DeckWriter, Grdecl, GridText, GridUnit};
use strataray_parsers::egrid::{self, Egrid, LocalGrid, PorosityModel};
use strataray_parsers::records::Kind;
use strataray_parsers::restart::{self, RestartWriter};
use strataray_parsers::units::UnitSystem;
use strataray_parsers::wells::{self, Completion, Direction, Flow, Status, Well};
use strataray_parsers::{Warnings, init};

/// A file with these bytes in a folder that lives as long as the first part.
fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn refusal<T>(result: io::Result<T>) -> String {
    let error = result.err().unwrap_or_else(|| panic!("was written"));
    assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{error}");
    error.to_string()
}

/// A grid whose values need every digit of f32.
fn grid() -> Egrid {
    let mut random = fastrand::Rng::with_seed(7);
    let [ni, nj, nk] = [5, 4, 3];
    let mut reals = |n: usize| (0..n).map(|_| 1000.0 * random.f32() - 300.0).collect();
    Egrid {
        dims: [ni, nj, nk],
        coord: reals(6 * (ni + 1) * (nj + 1)),
        zcorn: reals(8 * ni * nj * nk),
        actnum: Some((0..60).map(|n| i32::from(n % 7 != 0)).collect()),
        coarse: Some((0..60).map(|n| i32::from(n < 4)).collect()),
        map_units: Some("METRES".into()),
        map_axes: Some([0.0, 100.0, 12.5, -3.0, 9000.0, 1.0]),
        grid_unit: Some(egrid::GridUnit {
            length: "FEET".into(),
            is_map: true,
        }),
        porosity_model: PorosityModel::DualPermeability,
        nnc: vec![[1, 60], [60, 119]],
        local_nnc: Vec::new(),
        reservoirs: Vec::new(),
        local_grids: Vec::new(),
    }
}

fn read_egrid(bytes: &[u8]) -> Egrid {
    let (_folder, path) = file("A.EGRID", bytes);
    let mut warnings = Warnings::default();
    let grid = Egrid::read(&path, &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    grid
}

#[test]
fn ok_egrid_reads_back_equal() {
    let full = grid();
    let bytes = full.write(Vec::new()).unwrap();
    assert_eq!(read_egrid(&bytes), full);
    let bare = Egrid {
        actnum: None,
        map_units: None,
        map_axes: None,
        grid_unit: None,
        porosity_model: PorosityModel::Single,
        nnc: Vec::new(),
        ..full.clone()
    };
    let back = read_egrid(&bare.write(Vec::new()).unwrap());
    assert_eq!(back, bare);
    assert_ne!(back, full);
}

#[test]
fn err_egrid_that_could_not_be_read() {
    let damaged = |change: fn(&mut Egrid)| {
        let mut grid = grid();
        change(&mut grid);
        refusal(grid.write(Vec::new()))
    };
    let cases: [(fn(&mut Egrid), &str); 8] = [
        (|g| g.zcorn[17] = f32::NAN, "ZCORN: value 18"),
        (|g| g.coord[0] = f32::INFINITY, "COORD: value 1"),
        (
            |g| g.zcorn.truncate(479),
            "ZCORN: expected 480 values, found 479",
        ),
        (|g| g.actnum = Some(vec![1]), "ACTNUM: expected 60"),
        (|g| g.dims = [0, 4, 3], "0 x 4 x 3"),
        (|g| g.dims = [usize::MAX, 2, 2], "cells are not supported"),
        (|g| g.map_units = Some("KILOMETRES".into()), "longer than 8"),
        (
            |g| {
                g.local_grids.push(LocalGrid {
                    name: "L1".into(),
                    ..LocalGrid::default()
                });
            },
            "local grids",
        ),
    ];
    for (change, sentence) in cases {
        let said = damaged(change);
        assert!(said.contains(sentence), "{said}\nlacks: {sentence}");
    }
}

fn head() -> Head {
    Head {
        units: Some(UnitSystem::Lab),
        dims: [5, 4, 3],
        active: 3,
        phases: 7,
        date: "2001-06-30".into(),
        clock: [23, 59, 30_000_000],
        wells: 0,
        connections_per_well: 0,
        strings_per_well: 0,
    }
}

#[test]
fn ok_init_reads_back_equal() {
    let arrays = [("PORO", vec![0.1, 0.25, f32::NAN]), ("NTG", vec![1.0; 3])];
    let bytes = init::write(Vec::new(), &head(), arrays.clone()).unwrap();
    let (_folder, path) = file("A.INIT", &bytes);
    let back = init::open(&path, &mut Warnings::default()).unwrap();
    assert_eq!(back.head().unwrap(), head());
    for (name, values) in arrays {
        let read = back.values(back.find(name).unwrap()).unwrap();
        let bits = |v: &[f32]| v.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&read), bits(&values), "{name}");
    }
    assert!(back.find("SWAT").is_none());
}

/// A well with all that is written, and one with what differs.
fn written_wells() -> [Well; 2] {
    let completion = |k: i32, is_open: bool| Completion {
        is_open,
        number: 7,
        segment: 2,
        factor: Some(1.5),
        depth: Some(2000.0),
        diameter: Some(0.25),
        kh: Some(40.0),
        skin: Some(-1.0),
        ..Completion::open([4, 5, k], Direction::X, k)
    };
    let well = |name: &str, completions: Vec<Completion>| Well {
        head: [4, 5],
        depth: Some(1990.0),
        kind: wells::Kind::Producer,
        status: Status::Open,
        segments: 3,
        completions,
        flow: Some(Flow {
            oil: 1.0,
            water: 2.0,
            gas: 3.0,
            voidage: 4.0,
            tubing_head_pressure: 5.0,
            bottom_hole_pressure: 6.0,
            water_cut: 7.0,
            gas_oil_ratio: 8.0,
            produced: [9.0, 10.0, 11.0],
            injected: [12.0, 13.0, 14.0],
        }),
        ..Well::named(name)
    };
    [
        well("PROD-1", vec![completion(1, true), completion(2, false)]),
        Well {
            kind: wells::Kind::GasInjector,
            status: Status::Shut,
            ..well("I2", vec![completion(1, true)])
        },
    ]
}

#[test]
fn ok_restart_reads_back_equal() {
    // More values than a block holds, and a step without wells and date.
    let head = Head {
        active: 2500,
        ..head()
    };
    let values = |step: u32| {
        (0..2500)
            .map(|n| (n * (step + 1)) as f32)
            .collect::<Vec<_>>()
    };
    let undated = Head {
        date: String::new(),
        units: None,
        ..head.clone()
    };
    let mut writer = RestartWriter::new(Vec::new());
    let wells = written_wells();
    let arrays = [("PRESSURE", values(0)), ("SWAT", values(1))];
    writer.step(0, 0.0, &undated, &[], arrays).unwrap();
    writer
        .step(20, 181.25, &head, &wells, [("SWAT", values(2))])
        .unwrap();
    let (_folder, path) = file("A.UNRST", &writer.finish().unwrap());
    let mut warnings = Warnings::default();
    let steps = restart::open_unified(&path, &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(steps.len(), 2);
    assert_eq!((steps[0].report, steps[0].days), (0, 0.0));
    assert_eq!((steps[1].report, steps[1].days), (20, 181.25));
    assert_eq!(steps[0].head, undated);
    assert_eq!(steps[1].head.date, "2001-06-30");
    assert!(steps[0].wells().unwrap().is_empty());
    assert_eq!(steps[1].wells().unwrap(), ["PROD-1", "I2"]);
    assert_eq!(wells::read(&steps[1].arrays).unwrap(), wells);
    let read = |step: usize, name: &str| {
        let arrays = &steps[step].arrays;
        arrays.find(name).map(|e| arrays.values(e).unwrap())
    };
    assert_eq!(read(0, "PRESSURE"), Some(values(0)));
    assert_eq!(read(0, "SWAT"), Some(values(1)));
    assert_eq!(read(1, "PRESSURE"), None);
    assert_eq!(read(1, "SWAT"), Some(values(2)));
}

#[test]
fn ok_regions_are_whole_numbers_and_porv_has_all_cells() {
    let head = Head {
        dims: [5, 1, 1],
        active: 2,
        ..head()
    };
    let arrays = [
        ("SATNUM", vec![1.0, 2.0]),
        ("FIPNUM", vec![1.0, 1e20]),
        ("NTG", vec![1.0, 1.0]),
        ("PORV", vec![0.0, 7.5, 0.0, 2.5, 0.0]),
    ];
    let bytes = init::write(Vec::new(), &head, arrays.clone()).unwrap();
    let read = init::from_bytes(("A.INIT", bytes), &mut Warnings::default()).unwrap();
    for ((name, values), kind) in
        arrays
            .iter()
            .zip([Kind::Inte, Kind::Real, Kind::Real, Kind::Real])
    {
        let entry = read.find(name).unwrap();
        assert_eq!((entry.kind, &read.values(entry).unwrap()), (kind, values));
    }
}

#[test]
fn err_cell_arrays_that_could_not_be_read() {
    let init = |head: &Head, name: &str, n: usize| {
        refusal(init::write(Vec::new(), head, [(name, vec![1.0; n])]))
    };
    assert!(init(&head(), "PORO", 4).contains("PORO: expected 3 values, found 4"));
    assert!(init(&head(), "TOOLONGNAME", 3).contains("TOOLONGNAME"));
    assert!(init(&head(), "", 3).contains("is not a keyword"));
    for date in ["2001-6-30", "30 JUN 2001", "0-1-1", "2001-06", "-001-01-01"] {
        let head = Head {
            date: date.into(),
            ..head()
        };
        assert!(init(&head, "PORO", 3).contains(date), "{date}");
    }
    let negative = Head {
        active: -1,
        ..head()
    };
    assert!(init(&negative, "PORO", 3).contains("expected -1"));
    let mut writer = RestartWriter::new(Vec::new());
    let none: [(&str, Vec<f32>); 0] = [];
    let said = refusal(writer.step(0, 0.0, &head(), &[Well::named("A-LONG-NAME")], none.clone()));
    assert!(said.contains("A-LONG-NAME"), "{said}");
    let said = refusal(writer.step(u32::MAX, 0.0, &head(), &[Well::named("A")], none));
    assert!(said.contains("4294967295"), "{said}");
}

/// A writer that has room for so many bytes.
#[derive(Debug)]
struct Full(usize);

impl io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if bytes.len() > self.0 {
            return Err(io::Error::from(io::ErrorKind::StorageFull));
        }
        self.0 -= bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn err_a_full_disk_is_reported() {
    let grid = grid();
    let whole = grid.write(Vec::new()).unwrap().len();
    assert!(grid.write(Full(whole)).is_ok());
    assert!(grid.write(Full(whole - 1)).is_err());
    let mut writer = DeckWriter::new(Full(20));
    let written = writer.property("PORO", &[0.123_456_f32; 30]);
    assert!(written.and_then(|()| writer.finish()).is_err());
}

fn text_of(grid: &Egrid) -> GridText<'_, f32> {
    GridText {
        dims: grid.dims,
        coord: &grid.coord,
        zcorn: &grid.zcorn,
        actnum: grid.actnum.as_deref(),
        map_axes: grid.map_axes,
        map_units: grid.map_units.as_deref(),
        grid_unit: None,
    }
}

fn read_deck(bytes: &[u8]) -> Grdecl {
    let (_folder, path) = file("A.GRDECL", bytes);
    let mut warnings = Warnings::default();
    let deck = Grdecl::read(&path, &mut warnings)
        .unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(bytes)));
    assert!(warnings.is_empty(), "{warnings:?}");
    deck
}

#[test]
fn ok_deck_reads_back_equal() {
    let grid = grid();
    let unit = GridUnit {
        name: "FEET".into(),
        is_map: true,
    };
    let ntg: Vec<f64> = (0..60).map(|n| 1.0 / f64::from(n / 4 + 1)).collect();
    let mut permx = vec![f32::NAN; 60];
    permx[3..9].fill(1e-3);
    permx[20..25].copy_from_slice(&[f32::MIN_POSITIVE, -0.0, 0.0, 3.4e38, 16_777_216.0]);
    let regions: Vec<i32> = (0..60).map(|n| n / 20 - 1).collect();
    let mut writer = DeckWriter::new(Vec::new());
    let grid_unit = Some(&unit);
    let text = GridText {
        grid_unit,
        ..text_of(&grid)
    };
    writer.grid(&text).unwrap();
    writer.property("NTG", &ntg).unwrap();
    writer.property("PERMX", &permx).unwrap();
    writer.property("FIPNUM", &regions).unwrap();
    let bytes = writer.finish().unwrap();
    let longest = bytes.split(|&b| b == b'\n').map(<[u8]>::len).max();
    assert!(longest.is_some_and(|l| l <= 80), "{longest:?}");
    let deck = read_deck(&bytes);
    let f32s = |values: &[f64]| {
        values
            .iter()
            .map(|v| (*v as f32).to_bits())
            .collect::<Vec<_>>()
    };
    let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(deck.dims, grid.dims);
    assert_eq!(f32s(&deck.coord), bits(&grid.coord));
    assert_eq!(f32s(&deck.zcorn), bits(&grid.zcorn));
    assert_eq!(deck.actnum, grid.actnum);
    assert_eq!(deck.map_axes, grid.map_axes);
    assert_eq!(deck.map_units, grid.map_units);
    assert_eq!(deck.grid_unit, Some(unit));
    let names: Vec<_> = deck.properties.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["NTG", "PERMX", "FIPNUM"]);
    assert_eq!(deck.properties[0].values, ntg);
    assert_eq!(f32s(&deck.properties[1].values), bits(&permx));
    let whole: Vec<f64> = regions.iter().map(|&r| f64::from(r)).collect();
    assert_eq!(deck.properties[2].values, whole);
    assert_ne!(deck.properties[0].values, whole);
}

/// A grid's text with no more than it must have.
fn bare<'a>(dims: [usize; 3], coord: &'a [f32], zcorn: &'a [f32]) -> GridText<'a, f32> {
    GridText {
        dims,
        coord,
        zcorn,
        actnum: None,
        map_axes: None,
        map_units: None,
        grid_unit: None,
    }
}

#[cfg(feature = "parallel")]
#[test]
fn ok_deck_is_the_same_with_any_number_of_threads() {
    // Several pieces, with runs of equal values across their ends.
    let dims = [100, 100, 20];
    let zcorn: Vec<f32> = (0..8 * 200_000)
        .map(|n| (n / 3 % 70_000) as f32 / 7.0)
        .collect();
    let coord = vec![1.5; 6 * 101 * 101];
    let text = bare(dims, &coord, &zcorn);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut writer = DeckWriter::new(Vec::new());
            writer.grid(&text).unwrap();
            writer.finish().unwrap()
        })
    };
    let bytes = with(1);
    assert!(bytes == with(3));
    let deck = read_deck(&bytes);
    assert!(deck.zcorn.iter().zip(&zcorn).all(|(a, b)| *a as f32 == *b));
    // One token for a run that is as long as the array, piece by piece.
    assert!(bytes.windows(9).any(|w| w == b"61206*1.5"));
}

#[test]
fn err_deck_that_could_not_be_read() {
    let grid = grid();
    let write = |text: GridText<'_, f32>| refusal(DeckWriter::new(Vec::new()).grid(&text));
    let mut zcorn = grid.zcorn.clone();
    zcorn[2] = f32::NAN;
    let text = text_of(&grid);
    assert!(
        write(GridText {
            zcorn: &zcorn,
            ..text
        })
        .contains("ZCORN: value 3")
    );
    assert!(write(GridText { coord: &[], ..text }).contains("COORD: expected 180"));
    let hostile = Some("M' /\nSPECGRID");
    assert!(
        write(GridText {
            map_units: hostile,
            ..text
        })
        .contains("quoted")
    );
    let property =
        |name: &str, value: f32| refusal(DeckWriter::new(Vec::new()).property(name, &[0.0, value]));
    assert!(property("PORO", f32::NEG_INFINITY).contains("PORO: value 2 is infinite"));
    for name in ["", "1PORO", "PO RO", "PORO/", "MUCHTOOLONG", "PORÖ"] {
        assert!(property(name, 0.0).contains("is not a keyword"), "{name}");
    }
}

/// Wall time of a large grid as text; run with `--ignored --nocapture`, and once more with
/// `RAYON_NUM_THREADS=1`.
#[test]
#[ignore = "only measures"]
fn speed_of_writing_a_large_deck() {
    let dims = [160, 160, 50];
    let mut random = fastrand::Rng::with_seed(3);
    let depth = |n: usize| 2000.0 + n as f32 / 1e4;
    let zcorn: Vec<f32> = (0..8 * 160 * 160 * 50)
        .map(|n| depth(n) + random.f32())
        .collect();
    let coord = vec![1.0; 6 * 161 * 161];
    let text = bare(dims, &coord, &zcorn);
    for _ in 0..5 {
        let bytes = std::cell::Cell::new(0);
        let start = std::time::Instant::now();
        let mut writer = DeckWriter::new(Counted(&bytes));
        writer.grid(&text).unwrap();
        writer.finish().unwrap();
        let megabytes = 1e-6 * bytes.get() as f64;
        let seconds = start.elapsed().as_secs_f64();
        println!("{megabytes:.0} MB, {:.0} MB/s", megabytes / seconds);
    }
}

/// A writer that only counts.
struct Counted<'a>(&'a std::cell::Cell<usize>);

impl io::Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.set(self.0.get() + bytes.len());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
