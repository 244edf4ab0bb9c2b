//! Files that were made to do harm: each ends soon, in a sentence or in a grid.

use std::path::Path;
use std::time::{Duration, Instant};
use std::{fs, io};

use strataray_parsers::deck::{Grdecl, MemoryFiles};
use strataray_parsers::records::{RecordFile, RecordWriter};
use strataray_parsers::{ErrorKind, FileBytes, ParseError, Warnings, case};

use super::fixtures::{self, CELL, egrid};
use super::properties;

fn read(files: &MemoryFiles, name: &str) -> Result<Grdecl, ParseError> {
    let start = Instant::now();
    let read = Grdecl::read_from(files, Path::new(name), &[], &mut Warnings::default());
    assert!(start.elapsed() < Duration::from_secs(5), "took too long");
    read
}

fn read_text(text: &str) -> Result<Grdecl, ParseError> {
    read(&MemoryFiles::from_iter([("A", text.to_owned())]), "A")
}

#[track_caller]
fn refused(result: Result<Grdecl, ParseError>, kind: ErrorKind, part: &str) {
    let error = result.unwrap_err();
    assert_eq!(error.kind, kind, "{error}");
    assert!(error.to_string().contains(part), "{error}");
}

#[test]
fn chains_and_circles_of_includes() {
    let chain = |length: usize| -> MemoryFiles {
        let next = |n: usize| (n.to_string(), format!("INCLUDE\n '{}' /\n", n + 1));
        let last = [(length.to_string(), CELL.to_owned())];
        (0..length).map(next).chain(last).collect()
    };
    refused(read(&chain(1000), "0"), ErrorKind::TooLarge, "nested");
    assert!(read(&chain(60), "0").is_ok());
    // Back to the first, by another spelling of its name.
    let circle = [
        ("a/A", "INCLUDE\n '../a/./b/../B' /\n"),
        ("a/B", "INCLUDE\n 'A' /\n"),
    ];
    let circle = MemoryFiles::from_iter(circle);
    refused(
        read(&circle, "a/A"),
        ErrorKind::Malformed,
        "includes itself",
    );
    // Each file includes the next one twice: 2^40 files.
    let double = |n: usize| {
        let include = format!("INCLUDE\n '{}' /\n", n + 1);
        (n.to_string(), include.repeat(2))
    };
    let doubled: MemoryFiles = (0..40)
        .map(double)
        .chain([("40".into(), String::new())])
        .collect();
    refused(read(&doubled, "0"), ErrorKind::TooLarge, "included files");
}

#[test]
fn a_large_file_that_is_included_again_and_again() {
    let large = "-- nothing\n".repeat(1 << 20);
    let deck = |times: usize| {
        let files = [
            ("A", "INCLUDE\n 'B' /\n".repeat(times) + CELL),
            ("B", large.clone()),
        ];
        read(&MemoryFiles::from_iter(files), "A")
    };
    assert!(deck(3).is_ok());
    refused(deck(1000), ErrorKind::TooLarge, "again and again");
}

#[test]
fn enormous_counts_in_text() {
    for zcorn in [
        "1000000000*0",
        "4*0 18446744073709551615*1",
        "99999999999999999999*0",
    ] {
        let error = read_text(&CELL.replace("4*0 4*1", zcorn)).unwrap_err();
        assert!(matches!(
            error.kind,
            ErrorKind::WrongCount | ErrorKind::BadValue
        ));
    }
    // In arrays that are left out.
    assert!(read_text(&format!("{CELL}PORO\n1000000000*0 /\n")).is_ok());
    // Short records that stand for many items.
    let fault = format!("{CELL}FAULTS\n 1000000000*1 /\n/\n");
    refused(read_text(&fault), ErrorKind::Malformed, "too many items");
    let dims = CELL.replace("1 1 1 1 F", "2147483647 1 1 1 F");
    refused(read_text(&dims), ErrorKind::TooLarge, "cannot be described");
    // Many arrays that take a word each.
    let names: String = (0..9000).map(|n| format!(" A{n} 1 /\n")).collect();
    let blocks = format!(
        "DIMENS\n 1000 1000 60 /\nEQUALS\n DX 1 /\n DY 1 /\n DZ 1 /\n TOPS 1 /\n{names}/\n"
    );
    let error = read_text(&blocks).unwrap_err();
    assert_eq!(error.kind, ErrorKind::TooLarge, "{error}");
    assert!(
        error
            .to_string()
            .contains("more than 8 arrays of 1000 x 1000 x 60 cells"),
        "{error}"
    );
    // Regions and boxes that are no cells of the grid.
    let text = format!(
        "{CELL}MULTNUM\n 1 /\nPORO\n 0.5 /\nEQUALREG\n PORO 1 2147483647 M /\n PORO 1 -1 M /\n/\n\
         EQUALS\n PORO 1 1 18446744073709551615 1 1 1 1 /\n/\nADDZCORN\n 1e308 1 1 1 1 1 1 /\n 1e308 1 1 1 1 1 1 /\n/\n"
    );
    if let Ok(grid) = read_text(&text) {
        assert!(grid.zcorn.iter().all(|depth| depth.is_finite()));
    }
}

#[test]
fn enormous_counts_in_arrays() {
    for (count, kind) in [
        (i32::MAX, b"REAL"),
        (i32::MIN, b"X231"),
        (-1, b"INTE"),
        (i32::MAX, b"C099"),
        (i32::MAX, b"CHAR"),
    ] {
        let marker = 16_i32.to_be_bytes();
        let mut bytes = egrid();
        bytes.extend(
            [
                &marker[..],
                b"PORO    ",
                &count.to_be_bytes(),
                kind,
                &marker,
            ]
            .concat(),
        );
        assert!(RecordFile::from_bytes(("A", bytes)).is_err());
    }
    let text = b" 'PORO    '  2147483647 'REAL'\n 0.5\n".to_vec();
    assert!(RecordFile::from_bytes(("A", text)).is_err());
}

#[test]
fn values_that_are_too_deep() {
    let radial = |angle: &str| {
        read_text(&format!(
            "RUNSPEC\nRADIAL\nDIMENS\n1 1 1 /\nGRID\nINRAD\n1e308 /\nDRV\n1e308 /\nDTHETAV\n{angle} /\nDZ\n1 /\nTOPS\n1 /\n"
        ))
    };
    for angle in ["90", "1e308", "-1e308", "0"] {
        if let Ok(grid) = radial(angle) {
            assert!(grid.coord.iter().all(|v| v.is_finite()), "{angle}");
        }
    }
}

#[cfg(unix)]
#[test]
fn links_and_pipes_and_odd_names() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, at(name)).unwrap();
    // Two links to each other, and a folder that is in itself.
    link("two", "one");
    link("one", "two");
    link(".", "loop");
    let read = |path: &Path| Grdecl::read(path, &mut Warnings::default());
    let error = read(&at("one")).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Io, "{error}");
    fs::write(at("A"), "INCLUDE\n 'one' /\n").unwrap();
    assert_eq!(read(&at("A")).unwrap_err().kind, ErrorKind::NotFound);
    fs::write(at("B"), "INCLUDE\n 'loop/B' /\n").unwrap();
    assert!(read(&at("B")).is_err());
    let error = FileBytes::open(Path::new("/dev/zero")).unwrap_err();
    assert!(error.to_string().ends_with("not a regular file"), "{error}");
    // A name in Latin-1, of a case and of a file that a deck includes.
    let name = std::ffi::OsStr::from_bytes(b"F\xe6r.EGRID");
    let path = folder.path().join(name);
    if fs::write(&path, egrid()).is_ok() {
        fs::write(path.with_extension("INIT"), super::fixtures::init()).unwrap();
        let found = case::find(&path).unwrap();
        assert!(found.init.is_some() && found.name.starts_with('F'));
        let deck = [&b"INCLUDE\n 'f\xe6r.grid' /\n"[..]].concat();
        fs::write(at("C"), deck).unwrap();
        fs::write(path.with_extension("grid"), CELL).unwrap();
        assert_eq!(read(&at("C")).unwrap().files.len(), 2);
    }
}

/// Arrays of a file that is too large to be read into memory at once.
const ARRAYS: usize = 20;

#[test]
fn a_large_file_that_is_cut_off_while_it_is_read() -> io::Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("A.INIT");
    let values: Vec<f32> = (0..1 << 20).map(|n| n as f32).collect();
    let mut out = RecordWriter::new(fs::File::create(&path)?);
    for _ in 0..ARRAYS {
        out.real("PORO", &values)?;
    }
    out.finish()?;
    let length = fs::metadata(&path)?.len();
    assert!(length > 64 << 20);
    let file = RecordFile::open(&path).unwrap();
    let read = || -> Vec<Result<Vec<f32>, ParseError>> {
        file.entries()
            .iter()
            .map(|entry| file.f32s(entry))
            .collect()
    };
    assert!(
        read()
            .iter()
            .all(|r| r.as_ref().is_ok_and(|v| *v == values))
    );
    // Mapped memory that is gone would end this process.
    let writer = fs::OpenOptions::new().write(true).open(&path)?;
    let results = std::thread::scope(|scope| {
        scope.spawn(|| {
            for part in (1..1000).rev() {
                let _ = writer.set_len(length / 1000 * part);
            }
        });
        let rounds = [read(), read(), read()];
        rounds.into_iter().flatten().collect::<Vec<_>>()
    });
    writer.set_len(100)?;
    for result in results.into_iter().chain(read()) {
        match result {
            Ok(found) => assert!(found == values),
            Err(error) => {
                assert_eq!(error.kind, ErrorKind::Truncated, "{error}");
                assert!(error.to_string().contains("cut off at byte 0x"), "{error}");
            }
        }
    }
    assert!(read().iter().all(Result::is_err));
    Ok(())
}

#[test]
fn objects_of_packages_without_end() {
    let start = Instant::now();
    let with =
        |object: &[u8]| properties::resqml(fixtures::package("IjkGrid", |_| object.to_vec()));
    let error = with(&vec![b' '; 17 << 20]).unwrap_err();
    assert_eq!(error.kind, ErrorKind::TooLarge, "{error}");
    let deep = "<a>".repeat(1 << 20);
    let error = with(deep.as_bytes()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Malformed, "{error}");
    let deep = ["<a>".repeat(1 << 18), "</a>".repeat(1 << 18)].concat();
    assert!(with(deep.as_bytes()).is_err());
    let entities = "<!DOCTYPE a [<!ENTITY b \"bbbb\">]><a>&b;</a>";
    let error = with(entities.as_bytes()).unwrap_err();
    assert!(error.message.contains("DTD"), "{error}");
    properties::resqml(fixtures::package("IjkGrid", |whole| whole)).unwrap();
    assert!(start.elapsed() < Duration::from_secs(10), "took too long");
}
