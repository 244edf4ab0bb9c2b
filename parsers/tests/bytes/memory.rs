//! Files in memory are read as files on disk are.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use strataray_parsers::cells::CellArrays;
use strataray_parsers::deck::{DeckCells, Folders, Grdecl, MemoryFiles};
use strataray_parsers::egrid::Egrid;
use strataray_parsers::records::RecordFile;
use strataray_parsers::restart::{self, Step};
use strataray_parsers::{FileBytes, ParseError, Warnings, init};

use super::fixtures::{CELL, egrid, head, restart};

/// Files of a model in two folders, one of them named in another letter case than it has.
const DECK: [(&str, &str); 4] = [
    (
        "model/MAIN.DATA",
        "INCLUDE\n '../include/cell.grid' /\nINCLUDE\n poro.inc /\nGDFILE\n 'faults.txt' /\n",
    ),
    ("include/cell.grid", CELL),
    ("model/PORO.INC", "PORO\n 0.25 /\n"),
    (
        "model/faults.txt",
        "FAULTS\n'F1' 1 1 1 1 1 1 'X' /\n/\nINCLUDE\n 'absent.inc' /\n",
    ),
];

fn on_disk(folder: &Path) {
    for (name, text) in DECK {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}

fn without_absent(folder: &Path) -> MemoryFiles {
    let file = |(name, text): (&str, &str)| (folder.join(name), text.replace("absent", "PORO"));
    DECK.map(file).into_iter().collect()
}

fn first_value(arrays: &CellArrays, name: &str) -> f32 {
    arrays.values(arrays.find(name).unwrap()).unwrap()[0]
}

fn pressures(steps: &[Step]) -> Vec<(u32, f32)> {
    let pressure = |step: &Step| (step.report, first_value(&step.arrays, "PRESSURE"));
    steps.iter().map(pressure).collect()
}

#[test]
fn ok_all_kinds_of_bytes_are_the_same_file() {
    let bytes = egrid();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("A.EGRID");
    fs::write(&path, &bytes).unwrap();
    let mut warnings = Warnings::default();
    let disk = Egrid::read(&path, &mut warnings).unwrap();
    let shared: Arc<[u8]> = bytes.clone().into();
    let lasting: &'static [u8] = bytes.clone().leak();
    let files = [
        FileBytes::open(&path).unwrap(),
        ("A", bytes).into(),
        ("A", shared).into(),
        ("A", lasting).into(),
    ];
    for file in files {
        let grid = Egrid::from_bytes(file, &mut warnings).unwrap();
        assert_eq!(grid, disk);
    }
    assert_eq!(disk.zcorn, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert!(warnings.is_empty());
}

#[test]
fn err_bytes_are_named_as_they_were_given() {
    let error = |result: Result<Egrid, ParseError>| result.unwrap_err().to_string();
    let mut bytes = egrid();
    bytes.pop();
    let said = error(Egrid::from_bytes(
        ("zip:A.EGRID", bytes),
        &mut Warnings::default(),
    ));
    assert!(said.starts_with("zip:A.EGRID@0x"), "{said}");
    let none = error(Egrid::from_bytes(("B", []), &mut Warnings::default()));
    assert_eq!(none, "B@0x0: the file is empty");
}

#[test]
fn ok_init_and_restarts() {
    let mut warnings = Warnings::default();
    let poro = [("PORO", vec![0.25])];
    let bytes = init::write(Vec::new(), &head(), poro).unwrap();
    let arrays = init::from_bytes(("A.INIT", bytes), &mut warnings).unwrap();
    assert_eq!(first_value(&arrays, "PORO"), 0.25);
    let unified = ("A.UNRST", restart([3, 7]));
    let steps = restart::unified_from_bytes(unified, &mut warnings).unwrap();
    assert_eq!(pressures(&steps), [(3, 103.0), (7, 107.0)]);
    assert!(warnings.is_empty(), "{warnings:?}");

    // Of separate files, those that can be read.
    let file = |report: u32, bytes: Vec<u8>| {
        let name = format!("A.X{report:04}");
        (report, FileBytes::from((name, bytes)))
    };
    let damaged = vec![1; 100];
    let separate = [file(1, damaged.clone()), file(7, restart([7, 9]))];
    let steps = restart::separate_from_bytes(separate, &mut warnings).unwrap();
    assert_eq!(pressures(&steps), [(7, 107.0)]);
    let said: Vec<_> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 1);
    assert!(said[0].starts_with("A.X0001@0x0: ") && said[0].ends_with("report 1 was left out"));
    let none = restart::separate_from_bytes([file(1, damaged)], &mut warnings);
    assert!(none.is_err());
}

#[test]
fn ok_records_outlive_the_file_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("A.UNRST");
    fs::write(&path, restart([1, 2])).unwrap();
    let file = FileBytes::from((&path, fs::read(&path).unwrap()));
    fs::remove_file(&path).unwrap();
    let records = RecordFile::from_bytes(file).unwrap();
    let entry = records.find("PRESSURE").unwrap();
    assert_eq!(records.f32s(entry).unwrap(), [101.0]);
    assert!(RecordFile::open(&path).is_err());
}

#[test]
fn ok_decks_with_what_they_include() {
    let folder = tempfile::tempdir().unwrap();
    on_disk(folder.path());
    let main = folder.path().join("model/MAIN.DATA");
    let files = without_absent(folder.path());
    let mut warnings = Warnings::default();
    let memory = Grdecl::read_from(&files, &main, &[], &mut warnings).unwrap();
    assert_eq!(memory.files.len(), 4);
    assert_eq!(memory.properties[0].values, [0.25]);
    assert_eq!(memory.faults[0].name, "F1");
    fs::write(folder.path().join("model/absent.inc"), DECK[2].1).unwrap();
    let mut disk = Grdecl::read_from(&Folders, &main, &[], &mut warnings).unwrap();
    // The same but for the names of files.
    disk.files.clone_from(&memory.files);
    assert_eq!(disk, memory);
    assert!(Grdecl::is_grid_from(&files, &main).unwrap());
    let faults = Grdecl::read_faults_from(&files, &main, [1; 3], &mut warnings).unwrap();
    assert_eq!(faults, memory.faults);
    let poro = [folder.path().join("model/PORO.INC")];
    let cells = DeckCells::read_from(&files, &poro, [1; 3], &mut warnings).unwrap();
    assert_eq!(cells.properties, memory.properties);
    assert!(!Grdecl::is_grid_from(&files, &poro[0]).unwrap());
}

#[test]
fn err_decks_that_include_what_is_not_there() {
    let files: MemoryFiles = DECK.into_iter().collect();
    let read = |path: &str| {
        let read = Grdecl::read_from(&files, Path::new(path), &[], &mut Warnings::default());
        read.unwrap_err()
    };
    let error = read("model/MAIN.DATA");
    assert_eq!(error.path, PathBuf::from("model/faults.txt"));
    assert_eq!(
        error.to_string(),
        "model/faults.txt:5:2: INCLUDE: 'absent.inc' was not found; looked for model/absent.inc (included from model/MAIN.DATA:5)"
    );
    assert!(
        read("MAIN.DATA")
            .to_string()
            .starts_with("MAIN.DATA: cannot open: ")
    );
}

#[test]
fn ok_a_deck_with_its_grid_in_a_binary_file() {
    let deck = ("A.DATA", b"GRID\nGDFILE\n 'A.EGRID' /\n".to_vec());
    let mut warnings = Warnings::default();
    let mut read =
        |files: &MemoryFiles| Grdecl::read_from(files, Path::new("A.DATA"), &[], &mut warnings);
    let grid = read(&MemoryFiles::from_iter([
        deck.clone(),
        ("A.EGRID", egrid()),
    ]))
    .unwrap();
    assert_eq!(grid.zcorn[7], 7.0);
    let error = read(&MemoryFiles::from_iter([deck]))
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("A.DATA:3:2: GDFILE: its grid cannot be read: A.EGRID: cannot open: "),
        "{error}"
    );
}
