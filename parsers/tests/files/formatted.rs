//! Formatted files give what their binary twins give.

use std::fs;
use std::path::PathBuf;

use strataray_parsers::cells::Head;
use strataray_parsers::egrid::Egrid;
use strataray_parsers::records::{Form, Kind, RecordFile, RecordWriter};
use strataray_parsers::restart::{self, RestartWriter, Step};
use strataray_parsers::wells::Well;
use strataray_parsers::{ErrorKind, ParseError, Warnings, case, init};

use super::data;

fn open(text: &str) -> Result<RecordFile, ParseError> {
    RecordFile::from_bytes(("A.FINIT", text.as_bytes().to_vec()))
}

/// Values of an array as they are compared: bits of numbers, or strings.
fn content(file: &RecordFile, n: usize) -> Vec<String> {
    let entry = &file.entries()[n];
    match entry.kind {
        Kind::Text(_) => file.strings(entry).unwrap(),
        Kind::Mess => Vec::new(),
        Kind::Real => {
            let values = file.f32s(entry).unwrap();
            values.iter().map(|v| v.to_bits().to_string()).collect()
        }
        _ => {
            let values = file.f64s(entry).unwrap();
            values.iter().map(|v| v.to_bits().to_string()).collect()
        }
    }
}

fn assert_equal(a: &RecordFile, b: &RecordFile) {
    assert_eq!(a.entries().len(), b.entries().len());
    for n in 0..a.entries().len() {
        let [one, other] = [a, b].map(|f| (f.entries()[n].name(), f.entries()[n].kind));
        assert_eq!(one, other);
        assert_eq!(content(a, n), content(b, n), "{}", one.0);
    }
}

/// Writes an array of every kind with values that are hard to write.
fn write_all(mut out: RecordWriter<Vec<u8>>) -> Vec<u8> {
    out.inte("IN", &[1, -2, i32::MIN, i32::MAX, 0, 7, 8])
        .unwrap();
    let reals = [
        0.1,
        -1.234_567_9e-38,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
        1e-45,
    ];
    out.real("RE", &reals).unwrap();
    // More than one block.
    let many: Vec<f32> = (0_u16..2500).map(|n| f32::from(n) / 7.0).collect();
    out.real("MANY", &many).unwrap();
    let doubles = [0.25, 1.0 / 3.0, -2.5e-300, f64::NEG_INFINITY, 1e100];
    out.doub("DO", &doubles).unwrap();
    out.logi("LO", &[true; 60]).unwrap();
    out.chars("CH", &["ONE", "", "IT'S", "EIGHT CH"]).unwrap();
    out.text("TX", 90, &["ELEVEN CHARS", "B"]).unwrap();
    out.mess("ME").unwrap();
    out.inte("EMPTY", &[]).unwrap();
    out.finish().unwrap()
}

#[test]
fn ok_written_twins_are_equal() {
    let binary = write_all(RecordWriter::new(Vec::new()));
    let text = write_all(RecordWriter::formatted(Vec::new()));
    assert!(text.is_ascii());
    // As Windows ends lines.
    let crlf = String::from_utf8(text.clone())
        .unwrap()
        .replace('\n', "\r\n");
    let binary = RecordFile::from_bytes(("A", binary)).unwrap();
    for text in [text, crlf.into_bytes()] {
        let text = RecordFile::from_bytes(("A", text)).unwrap();
        assert_eq!(
            (binary.form(), text.form()),
            (Form::Binary, Form::Formatted)
        );
        assert_equal(&binary, &text);
    }
}

#[test]
fn ok_numbers_in_every_notation() {
    let file = open(
        "\n 'PORO    '          9 'REAL'\n   0.1E+01  .2D+01  3 0.4d1 5.0-101 6.0+2\n  inf -Infinity NaN\n 'FLAGS' 3 'LOGI'\nT F\r\n  T\n",
    )
    .unwrap();
    let poro = file.f32s(&file.entries()[0]).unwrap();
    assert_eq!(poro[..6], [1.0, 2.0, 3.0, 4.0, 0.0, 600.0]);
    assert_eq!(poro[6..8], [f32::INFINITY, f32::NEG_INFINITY]);
    assert!(poro[8].is_nan());
    let flags = &file.entries()[1];
    assert_eq!(flags.name(), "FLAGS");
    assert_eq!(file.bools(flags).unwrap(), [true, false, true]);
    assert_eq!(file.f64s(flags).unwrap(), [1.0, 0.0, 1.0]);
}

#[test]
fn err_names_file_keyword_and_line() {
    let header = " 'PORO    '           3 'REAL'\n";
    let behind = " 'NTG     '           1 'REAL'\n 1.0\n";
    let said = |text: String| {
        let file = match open(&text) {
            Ok(file) => file,
            Err(error) => return (error.kind, error.to_string()),
        };
        let error = file.f32s(&file.entries()[0]).unwrap_err();
        (error.kind, error.to_string())
    };
    let (kind, text) = said(format!("{header} 1.0 2.x\n 3.0\n{behind}"));
    assert_eq!(kind, ErrorKind::BadValue);
    assert_eq!(
        text,
        "A.FINIT:2:6: PORO: \"2.x\" is not a value of its type"
    );
    let (kind, text) = said(format!("{header} 1.0 2.0\n{behind}"));
    assert_eq!(kind, ErrorKind::Malformed);
    assert_eq!(
        text,
        "A.FINIT:1:2: PORO: its header says 3 values, and 2 follow; the file is damaged"
    );
    let (kind, text) = said(format!("{behind}{header} 1.0 2.0\n"));
    assert_eq!(kind, ErrorKind::Truncated);
    assert!(text.starts_with("A.FINIT:3:"), "{text}");
    assert!(text.ends_with("PORO: the file ends before its 3 values"));
    let (kind, _) = said(format!("{header} 1.0 2.0 3.0"));
    assert_eq!(kind, ErrorKind::Truncated, "within the last number");
    let (kind, text) = said(format!("{behind} 'PORO 3 REAL\n 1 2 3\n"));
    assert_eq!(kind, ErrorKind::Malformed);
    assert!(text.starts_with("A.FINIT:3:2: NTG: after it: "), "{text}");
    let (kind, _) = said(header.replace('3', "2000000000"));
    assert_eq!(kind, ErrorKind::Truncated);
}

fn pressures(steps: &[Step]) -> Vec<(u32, f64, Vec<f32>)> {
    let pressure = |step: &Step| {
        let entry = step.arrays.find("PRESSURE").unwrap();
        (step.report, step.days, step.arrays.values(entry).unwrap())
    };
    steps.iter().map(pressure).collect()
}

#[test]
fn ok_a_case_of_real_files_equals_its_binary_twin() {
    let mut warnings = Warnings::default();
    let Some(text) = data("formatted/SPE1CASE1.FEGRID") else {
        return;
    };
    let binary = data("spe1/SPE1CASE1.EGRID").unwrap();
    let [one, other] = [&text, &binary].map(|path| case::find(path).unwrap());
    let grids = [&text, &binary].map(|path| Egrid::read(path, &mut warnings).unwrap());
    assert_eq!(grids[0].zcorn, grids[1].zcorn);
    assert_eq!(grids[0].dims, [10, 10, 3]);
    // As many digits as the text has.
    let is_near = |a: f32, b: f32| (a - b).abs() <= 2e-7 * a.abs();
    let inits = [one.init, other.init].map(|f| init::open(&f.unwrap(), &mut warnings).unwrap());
    let entries: Vec<_> = inits[0]
        .iter()
        .filter(|e| e.is_numeric())
        .copied()
        .collect();
    assert!(entries.len() > 20);
    for entry in entries {
        let twin = inits[1].find(entry.name()).unwrap();
        let values = inits[0].values(&entry).unwrap();
        let twins = inits[1].values(twin).unwrap();
        assert_eq!(values.len(), twins.len());
        let mut pairs = values.iter().zip(&twins);
        assert!(pairs.all(|(a, b)| is_near(*a, *b)), "{}", entry.name());
    }
    let steps = [one.restart, other.restart].map(|source| {
        let case::RestartSource::Unified(path) = source else {
            panic!("no steps");
        };
        pressures(&restart::open_unified(&path, &mut warnings).unwrap())
    });
    assert_eq!(steps[0].len(), 12);
    for ((report, days, values), (twin, twin_days, twins)) in steps[0].iter().zip(&steps[1]) {
        assert_eq!((report, days), (twin, twin_days));
        assert!(values.iter().zip(twins).all(|(a, b)| is_near(*a, *b)));
    }
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn ok_one_restart_in_both_forms() {
    let Some(text) = data("formatted/SPE1_TESTCASE.FUNRST") else {
        return;
    };
    let text = RecordFile::open(&text).unwrap();
    let binary = RecordFile::open(&data("formatted/SPE1_TESTCASE.UNRST").unwrap()).unwrap();
    assert_eq!(text.entries().len(), binary.entries().len());
    for (a, b) in text.entries().iter().zip(binary.entries()) {
        assert_eq!((a.name(), a.kind, a.count), (b.name(), b.kind, b.count));
        if let (Ok(a), Ok(b)) = (text.f64s(a), binary.f64s(b)) {
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 2e-7 * a.abs();
            assert!(a.iter().zip(&b).all(near));
        } else if let Kind::Text(_) = a.kind {
            assert_eq!(text.strings(a).unwrap(), binary.strings(b).unwrap());
        }
    }
}

#[test]
fn ok_binary_files_are_preferred_where_both_exist() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: Vec<u8>| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let head = Head {
        active: 1,
        date: "2001-06-30".into(),
        ..Head::default()
    };
    let step = |out: RecordWriter<Vec<u8>>| {
        let mut writer = RestartWriter::to(out);
        let arrays = [("PRESSURE", vec![250.1_f32])];
        writer
            .step(4, 31.5, &head, &[Well::named("P1")], arrays)
            .unwrap();
        writer.finish().unwrap()
    };
    let text_grid = write("A.FEGRID", Vec::new());
    let text_step = write("A.F0004", step(RecordWriter::formatted(Vec::new())));
    let found = |path: &PathBuf| case::find(path).unwrap();
    let separate = |files: &case::CaseFiles| match &files.restart {
        case::RestartSource::Separate(files) => files.clone(),
        _ => panic!("no separate restarts"),
    };
    assert_eq!(separate(&found(&text_grid)), [(4, text_step.clone())]);
    let init = write("A.FINIT", Vec::new());
    assert_eq!(found(&text_grid).init, Some(init));
    // Now with binary twins.
    let binary_step = write("A.X0004", step(RecordWriter::new(Vec::new())));
    let init = write("A.INIT", Vec::new());
    let grid = write("A.EGRID", Vec::new());
    for path in [folder.path().join("A"), folder.path().to_owned()] {
        let files = found(&path);
        assert_eq!(files.grid, case::GridSource::Egrid(grid.clone()));
        assert_eq!(files.init, Some(init.clone()));
        assert_eq!(separate(&files), [(4, binary_step.clone())]);
    }
    // What the user names goes first.
    let files = found(&text_grid);
    assert_eq!(files.grid, case::GridSource::Egrid(text_grid));
    let mut warnings = Warnings::default();
    let open = |path| restart::open_separate(&[(4, path)], &mut warnings).unwrap();
    let [text, binary] = [text_step, binary_step].map(open);
    assert_eq!(pressures(&text), pressures(&binary));
    assert_eq!(text[0].head, binary[0].head);
    assert_eq!(text[0].wells().unwrap(), ["P1"]);
}
