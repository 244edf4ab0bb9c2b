//! Each kind of error: files that give it, and twins that differ in nothing else and are read.

use std::fs;
use std::path::Path;

use strataray_parsers::deck::{DeckCells, Grdecl, MemoryFiles};
use strataray_parsers::egrid::Egrid;
use strataray_parsers::records::{RecordFile, RecordWriter};
use strataray_parsers::{At, ErrorKind, FileBytes, ParseError, Warnings, case, restart};

use super::fixtures::{self, CELL, cell, egrid, restart};

/// Checks that `damaged` is an error of `kind`, and that its twin is read.
#[track_caller]
fn check<T, U>(kind: ErrorKind, damaged: Result<T, ParseError>, twin: Result<U, ParseError>) {
    let Err(error) = damaged else {
        panic!("was read: no error of the kind {kind:?}");
    };
    assert_eq!(error.kind, kind, "{error}");
    if let Err(error) = twin {
        panic!("the twin was not read: {error}");
    }
}

fn read_egrid(bytes: impl Into<Vec<u8>>) -> Result<Egrid, ParseError> {
    Egrid::from_bytes(("A.EGRID", bytes.into()), &mut Warnings::default())
}

fn read_files(files: &[(&'static str, Vec<u8>)]) -> Result<Grdecl, ParseError> {
    let files = files.iter().cloned().collect::<MemoryFiles>();
    Grdecl::read_from(&files, Path::new("A"), &[], &mut Warnings::default())
}

fn read_deck(text: &str) -> Result<Grdecl, ParseError> {
    read_files(&[("A", text.into())])
}

/// A deck of one cell and `text`.
fn read_cell(text: &str) -> Result<Grdecl, ParseError> {
    read_deck(&format!("{CELL}{text}"))
}

/// `bytes` with the number at the first `from` behind `name` made `to`.
fn changed(mut bytes: Vec<u8>, name: &str, from: i32, to: i32) -> Vec<u8> {
    let start = bytes
        .windows(name.len())
        .position(|w| w == name.as_bytes())
        .unwrap();
    let behind = &bytes[start..];
    let at = start
        + behind
            .windows(4)
            .position(|w| w == from.to_be_bytes())
            .unwrap();
    bytes[at..at + 4].copy_from_slice(&to.to_be_bytes());
    bytes
}

#[test]
fn not_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("A.EGRID");
    let twin = folder.path().join("B.EGRID");
    fs::write(&twin, egrid()).unwrap();
    let read = |path: &Path| Egrid::read(path, &mut Warnings::default());
    check(ErrorKind::NotFound, read(&path), read(&twin));
    check(ErrorKind::NotFound, case::find(&path), case::find(&twin));
    let with = |added: &Path| case::find_with(&twin, &[added.to_owned()]);
    let init = folder.path().join("C.INIT");
    fs::write(&init, fixtures::init()).unwrap();
    check(
        ErrorKind::NotFound,
        with(&folder.path().join("D.INIT")),
        with(&init),
    );
    let deck = ("A", b"INCLUDE\n 'B' /\n".to_vec());
    let included = ("B", CELL.into());
    check(
        ErrorKind::NotFound,
        read_files(std::slice::from_ref(&deck)),
        read_files(&[deck, included]),
    );
}

#[test]
fn io() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("A");
    fs::write(&file, "text").unwrap();
    check(
        ErrorKind::Io,
        FileBytes::open(folder.path()),
        FileBytes::open(&file),
    );
    let error = FileBytes::open(folder.path()).err().unwrap();
    assert!(error.cause.is_some());
}

#[test]
fn not_this_format() {
    check(
        ErrorKind::NotThisFormat,
        read_egrid(CELL),
        read_egrid(egrid()),
    );
    let binary = read_files(&[("A", egrid())]);
    check(ErrorKind::NotThisFormat, binary, read_deck(CELL));
}

#[test]
fn truncated() {
    let whole = egrid();
    check(
        ErrorKind::Truncated,
        read_egrid(&whole[..0]),
        read_egrid(&*whole),
    );
    check(
        ErrorKind::Truncated,
        read_egrid(&whole[..whole.len() - 1]),
        read_egrid(&*whole),
    );
    check(
        ErrorKind::Truncated,
        read_egrid(&whole[..90]),
        read_egrid(&*whole),
    );
    check(
        ErrorKind::Truncated,
        read_cell("PORO\n 0.5"),
        read_cell("PORO\n 0.5 /"),
    );
    check(
        ErrorKind::Truncated,
        read_cell("ACTNUM\n 1"),
        read_cell("ACTNUM\n 1 /"),
    );
    check(
        ErrorKind::Truncated,
        read_cell("SKIP\n"),
        read_cell("SKIP\nENDSKIP\n"),
    );
}

#[test]
fn malformed() {
    let marker = changed(egrid(), "COORD", 96, 92);
    check(
        ErrorKind::Malformed,
        read_egrid(marker),
        read_egrid(egrid()),
    );
    let negative = changed(egrid(), "ZCORN", 8, -8);
    check(
        ErrorKind::Malformed,
        read_egrid(negative),
        read_egrid(egrid()),
    );
    check(
        ErrorKind::Malformed,
        read_egrid([egrid(), vec![1; 24]].concat()),
        read_egrid(egrid()),
    );
    let units = |unit: &str| read_cell(&format!("MAPUNITS\n {unit} /\n"));
    check(ErrorKind::Malformed, units("'METRES"), units("'METRES'"));
    // A missing slash, told from a value that is no number by the keyword that stands there.
    check(
        ErrorKind::Malformed,
        read_cell("PORO\n 0.5\nPERMX\n 1 /\n"),
        read_cell("PORO\n 0.5 /\nPERMX\n 1 /\n"),
    );
    check(
        ErrorKind::Malformed,
        read_cell("INCLUDE\n'A' /\n"),
        read_cell(""),
    );
}

#[test]
fn missing_keyword() {
    let without = CELL.replace("ZCORN", "NOCORN");
    check(
        ErrorKind::MissingKeyword,
        read_deck(&without),
        read_deck(CELL),
    );
    let mut bytes = egrid();
    let at = bytes.windows(5).position(|w| w == b"ZCORN").unwrap();
    bytes[at] = b'Y';
    check(
        ErrorKind::MissingKeyword,
        read_egrid(bytes),
        read_egrid(egrid()),
    );
    let steps = |bytes| restart::unified_from_bytes(("A.UNRST", bytes), &mut Warnings::default());
    check(
        ErrorKind::MissingKeyword,
        steps(egrid()),
        steps(restart([1, 2])),
    );
    let sizes = "DIMENS\n1 1 1 /\nDX\n1 /\nDY\n1 /\nTOPS\n1 /\n";
    check(
        ErrorKind::MissingKeyword,
        read_deck(sizes),
        read_deck(&format!("{sizes}DZ\n1 /\n")),
    );
}

#[test]
fn wrong_type() {
    let mut writer = RecordWriter::new(Vec::new());
    writer.chars("NAMES", &["A"]).unwrap();
    let file = RecordFile::from_bytes(("A", writer.finish().unwrap())).unwrap();
    let names = file.find("NAMES").unwrap();
    check(ErrorKind::WrongType, file.f32s(names), file.strings(names));
    check(ErrorKind::WrongType, file.bools(names), file.strings(names));
}

#[test]
fn wrong_count() {
    check(
        ErrorKind::WrongCount,
        read_cell("ACTNUM\n 2*1 /"),
        read_cell("ACTNUM\n 1*1 /"),
    );
    check(
        ErrorKind::WrongCount,
        read_cell("MAPAXES\n 5*1 /"),
        read_cell("MAPAXES\n 6*1 /"),
    );
    let fault = |items: &str| read_cell(&format!("FAULTS\n 'F' 6*1 {items} /\n/\n"));
    check(ErrorKind::WrongCount, fault(""), fault("X"));
    // One more column than the arrays are for.
    let mut larger = egrid();
    let head = larger.windows(8).position(|w| w == b"GRIDHEAD").unwrap();
    // Behind the rest of the header record: a marker, the type of the grid, NI.
    let columns = head + 16 + 2 * size_of::<i32>()..head + 16 + 4 * size_of::<i32>();
    assert_eq!(larger[columns.clone()], [0, 0, 0, 1, 0, 0, 0, 1]);
    larger[columns.end - 1] = 2;
    check(
        ErrorKind::WrongCount,
        read_egrid(larger),
        read_egrid(egrid()),
    );
}

#[test]
fn bad_value() {
    check(
        ErrorKind::BadValue,
        read_cell("PORO\n 0.x /"),
        read_cell("PORO\n 0.5 /"),
    );
    check(
        ErrorKind::BadValue,
        read_cell("ACTNUM\n -1 /"),
        read_cell("ACTNUM\n 1 /"),
    );
    check(
        ErrorKind::BadValue,
        read_cell("PORO\n 0*1 /"),
        read_cell("PORO\n 1*1 /"),
    );
    let fault = |face: &str| read_cell(&format!("FAULTS\n 'F' 6*1 {face} /\n/\n"));
    check(ErrorKind::BadValue, fault("U"), fault("X"));
    let depth = (5.0_f32).to_bits().cast_signed();
    let undefined = changed(egrid(), "ZCORN", depth, f32::NAN.to_bits().cast_signed());
    // Depths of an EGRID are given as they are.
    let has_nan = |bytes| read_egrid(bytes).is_ok_and(|grid| grid.zcorn.iter().any(|z| z.is_nan()));
    assert!(has_nan(undefined) && !has_nan(egrid()));
}

#[test]
fn mismatch() {
    let deck = |dims: &str| {
        let text = format!("SPECGRID\n {dims} /\nGDFILE\n 'B' /\n");
        read_files(&[("A", text.into()), ("B", egrid())])
    };
    check(ErrorKind::Mismatch, deck("2 1 1"), deck("1 1 1"));
}

#[test]
fn unsupported() {
    check(
        ErrorKind::Unsupported,
        read_deck(&CELL.replace("1 1 1 1 F", "1 1 1 2 F")),
        read_deck(CELL),
    );
    // The first 1 of GRIDHEAD is the type of the grid.
    check(
        ErrorKind::Unsupported,
        read_egrid(changed(egrid(), "GRIDHEAD", 1, 2)),
        read_egrid(egrid()),
    );
    let folder = tempfile::tempdir().unwrap();
    let [grid, model, init] = ["A.EGRID", "A.EPC", "A.INIT"].map(|name| folder.path().join(name));
    for path in [&grid, &model, &init] {
        fs::write(path, cell().write(Vec::new()).unwrap()).unwrap();
    }
    let with = |added: &Path| case::find_with(&grid, &[added.to_owned()]);
    check(ErrorKind::Unsupported, with(&model), with(&init));
}

#[test]
fn too_large() {
    let dims = |dims: &str| read_deck(&CELL.replace("1 1 1 1", dims));
    check(
        ErrorKind::TooLarge,
        dims("2000 2000 2000 1"),
        dims("1 1 1 1"),
    );
    check(ErrorKind::TooLarge, dims("1 1 999999 1"), dims("1 1 1 1"));
    let files: MemoryFiles = [("A", "PORO\n 0.5 /\n")].into_iter().collect();
    let paths = [Path::new("A").to_owned()];
    let cells = |dims| DeckCells::read_from(&files, &paths, dims, &mut Warnings::default());
    check(
        ErrorKind::TooLarge,
        cells([usize::MAX, 2, 2]),
        cells([1, 1, 1]),
    );
    // A file that includes the next one, and so on.
    let chain = |length: usize| {
        let next = |n: usize| (n.to_string(), format!("INCLUDE\n '{}' /\n", n + 1));
        let last = [(length.to_string(), CELL.to_owned())];
        let files: MemoryFiles = (0..length).map(next).chain(last).collect();
        Grdecl::read_from(&files, Path::new("0"), &[], &mut Warnings::default())
    };
    check(ErrorKind::TooLarge, chain(64), chain(63));
    // A count of 2^62 values, which have more bytes than a file can have.
    let mut header = Vec::new();
    for (count, kind) in [(i32::MIN, b"X231"), (0, b"REAL")] {
        header.extend(
            [
                &16_i32.to_be_bytes(),
                &b"PORO    "[..],
                &count.to_be_bytes(),
                kind,
                &16_i32.to_be_bytes(),
            ]
            .concat(),
        );
    }
    let read = |bytes: Vec<u8>| RecordFile::from_bytes(("A", bytes));
    check(
        ErrorKind::TooLarge,
        read(header.clone()),
        read(changed(header, "PORO", i32::MIN, 0)),
    );
}

#[test]
fn other() {
    let path = Path::new("A");
    let error = ParseError::new(path, At::File, "", "is not wanted");
    assert_eq!(error.kind, ErrorKind::Other);
    let error = ParseError::of(ErrorKind::Mismatch, path, At::File, "", "is not wanted");
    assert_eq!(error.kind, ErrorKind::Mismatch);
}
