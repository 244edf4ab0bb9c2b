//! Samples in other files than their header.

use std::fs;
use std::path::Path;

use strataray_parsers::ErrorKind;
use strataray_parsers::volume::{self, Options};

use super::{DIMS, check_values, open, rotated, values};

fn read(path: &Path) -> Result<volume::VolumeFile, strataray_parsers::ParseError> {
    volume::open(path, &Options::default())
}

fn bytes() -> Vec<u8> {
    values(rotated().region())
        .iter()
        .map(|v| *v as u8)
        .collect()
}

fn nrrd_head(fields: &str) -> String {
    let [ni, nj, nk] = DIMS;
    format!("NRRD0005\ntype: uint8\ndimension: 3\nsizes: {ni} {nj} {nk}\nencoding: raw\n{fields}\n")
}

#[test]
fn one_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let all = bytes();
    fs::write(at("plain"), &all).unwrap();
    fs::write(at("lines"), [b"one\ntwo\nxx", &all[..]].concat()).unwrap();
    for (fields, is_read) in [
        ("data file: plain", true),
        ("datafile: plain", true),
        ("data file: lines\nline skip: 2\nbyte skip: 2", true),
        ("data file: lines\nbyte skip: -1", true),
        ("data file: lines\nline skip: 2\nbyte skip: 3", false),
        ("data file: lines\nline skip: 1000", false),
        ("data file: gone", false),
    ] {
        fs::write(at("A.nhdr"), nrrd_head(fields)).unwrap();
        match read(&at("A.nhdr")) {
            Ok(volume) => {
                assert!(is_read, "{fields}");
                check_values(&volume);
            }
            Err(error) => assert!(!is_read, "{fields}: {error}"),
        }
    }
    // The file does not begin where it does.
    fs::write(at("A.nhdr"), nrrd_head("data file: lines")).unwrap();
    let volume = read(&at("A.nhdr")).unwrap();
    assert_ne!(
        volume.f64s(volume.lattice.region()).unwrap(),
        values(volume.lattice.region())
    );
    // From memory there is no folder.
    let error = open("A.nhdr", nrrd_head("data file: plain").into()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Unsupported);
    // MetaImage counts a header of the file from its start, or from its end.
    let [ni, nj, nk] = DIMS;
    for (size, is_read) in [("10", true), ("-1", true), ("11", false)] {
        let head = format!(
            "NDims = 3\nDimSize = {ni} {nj} {nk}\nHeaderSize = {size}\nElementType = MET_UCHAR\nElementDataFile = lines\n"
        );
        fs::write(at("A.mhd"), head).unwrap();
        let volume = read(&at("A.mhd"));
        assert_eq!(volume.is_ok(), is_read, "{size}");
        volume.iter().for_each(check_values);
    }
}

#[test]
fn a_file_for_each_slice() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let all = bytes();
    let slice = all.len() / DIMS[2];
    for (n, slice) in all.chunks(slice).enumerate() {
        fs::write(at(&format!("s{:02}.raw", n + 1)), slice).unwrap();
    }
    let [ni, nj, nk] = DIMS;
    let meta = |data: &str| {
        format!(
            "NDims = 3\nDimSize = {ni} {nj} {nk}\nElementType = MET_UCHAR\nElementDataFile = {data}\n"
        )
    };
    for (name, head) in [
        (
            "A.nhdr",
            nrrd_head("data file: LIST\ns01.raw\ns02.raw\ns03.raw\ns04.raw"),
        ),
        ("B.nhdr", nrrd_head("data file: s%02d.raw 1 4 1")),
        ("A.mhd", meta("LIST\ns01.raw\ns02.raw\ns03.raw\ns04.raw")),
        ("B.mhd", meta("s%02d.raw 1 4 1")),
    ] {
        fs::write(at(name), &head).unwrap();
        check_values(&read(&at(name)).unwrap());
        // Three files for four slices, and a file that is not there.
        fs::write(
            at(name),
            head.replace("s04.raw", "").replace("1 4 1", "1 3 1"),
        )
        .unwrap();
        assert!(read(&at(name)).is_err(), "{name}");
        fs::write(
            at(name),
            head.replace("s04.raw", "s05.raw").replace("1 4 1", "2 5 1"),
        )
        .unwrap();
        assert_eq!(
            read(&at(name)).unwrap_err().kind,
            ErrorKind::NotFound,
            "{name}"
        );
    }
}

#[test]
fn a_description_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("A.raw"), [b"head", &bytes()[..]].concat()).unwrap();
    let [ni, nj, nk] = DIMS;
    let text = format!(
        r#"{{"size": [{ni}, {nj}, {nk}], "type": "u8", "spacing": [1, 2, 4], "skip": 4, "name": "density", "file": "A.raw"}}"#
    );
    fs::write(at("A.json"), &text).unwrap();
    for name in ["A.raw", "A.json"] {
        let volume = read(&at(name)).unwrap();
        assert_eq!(volume.lattice.spacing(), [1.0, 2.0, 4.0]);
        assert_eq!(volume.name, "density");
        check_values(&volume);
    }
    fs::rename(at("A.json"), at("A.raw.json")).unwrap();
    check_values(&read(&at("A.raw")).unwrap());
    for (from, to) in [
        ("\"u8\"", "\"u9\""),
        ("\"skip\": 4", "\"skip\": 5"),
        ("\"size\": [7", "\"size\": [7.5"),
        ("\"spacing\"", "\"spacings\""),
        ("\"A.raw\"", "\"B.raw\""),
        ("}", ""),
    ] {
        fs::write(at("B.json"), text.replace(from, to)).unwrap();
        assert!(read(&at("B.json")).is_err(), "{to}");
    }
    // A pipe or a folder is no file.
    fs::write(at("B.json"), text.replace("A.raw", ".")).unwrap();
    assert!(read(&at("B.json")).is_err());
}
