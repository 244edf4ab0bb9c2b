//! Summary vectors of real cases, and of twins in every form.

use std::fs;
use std::path::Path;

use strataray_parsers::case::{self, SummarySource};
use strataray_parsers::records::{Kind, RecordFile, RecordWriter};
use strataray_parsers::summary::{Subject, Summary};
use strataray_parsers::units::UnitSystem;
use strataray_parsers::{FileBytes, Warnings};

use super::data;

fn open(path: &Path) -> Summary {
    let mut warnings = Warnings::default();
    let summary = Summary::open(&case::find_summary(path).unwrap(), &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    summary
}

fn values(summary: &Summary, key: &str) -> Vec<f32> {
    summary.values(summary.find(key).unwrap()).unwrap()
}

#[test]
fn ok_reek() {
    let Some(path) = data("reek/REEK.EGRID") else {
        return;
    };
    let summary = open(&path);
    assert_eq!((summary.vectors.len(), summary.dims), (434, [40, 64, 14]));
    assert_eq!(summary.units, Some(UnitSystem::Metric));
    let count = |is: fn(&Subject) -> bool| {
        let vectors = summary.vectors.iter();
        vectors.filter(|v| is(&v.subject)).count()
    };
    assert_eq!(count(|s| matches!(s, Subject::Block(_))), 3);
    // Number 1095 in natural order of 40 x 64 x 14 cells.
    assert!(summary.find("BPR:15,28,1").is_some());
    assert!(count(|s| matches!(s, Subject::Well(_))) > 100);
    assert_eq!(count(|s| matches!(s, Subject::Other(Some(_)))), 0);
    let days: Vec<f64> = summary.steps.iter().map(|s| s.days).collect();
    assert_eq!(days[..4], [1.0, 4.0, 13.0, 31.0]);
    assert!(days.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(summary.dates()[3], "2000-02-01");
    assert!(summary.steps[3].is_report || summary.steps.last().unwrap().is_report);
    // Totals of the field are those of its wells, and rise.
    let field = values(&summary, "FOPT");
    assert!(field.windows(2).all(|pair| pair[0] <= pair[1]));
    let wells = summary.vectors.iter().filter(|v| v.keyword == "WOPT");
    let last: f32 = wells
        .map(|v| *summary.values(v).unwrap().last().unwrap())
        .sum();
    let total = *field.last().unwrap();
    assert!((last / total - 1.0).abs() < 1e-4, "{last} {total}");
    let rate = summary.find("FOPR").unwrap();
    assert_eq!(rate.unit, "SM3/DAY");
    assert!(!rate.is_history());
    assert!(summary.find("FOPRH").unwrap().is_history());
}

#[test]
fn ok_vectors_of_local_grids() {
    let Some(path) = data("lgr_nnc/SIMPLE_SUMMARY2.SMSPEC") else {
        return;
    };
    let summary = open(&path);
    let locals: Vec<_> = summary
        .vectors
        .iter()
        .filter(|v| v.keyword.starts_with('L'))
        .collect();
    assert!(!locals.is_empty());
    for vector in locals {
        let grid = match &vector.subject {
            Subject::LocalBlock(grid, cell) => {
                assert!(cell.iter().all(|n| *n > 0), "{vector}");
                grid
            }
            Subject::LocalConnection(grid, _, cell) => {
                assert!(cell.iter().all(|n| *n > 0), "{vector}");
                grid
            }
            Subject::LocalWell(grid, _) => grid,
            other => panic!("{vector}: {other:?}"),
        };
        assert!(["CENTER", "WELLI1"].contains(&grid.as_str()), "{vector}");
    }
    assert_eq!(summary.dates()[0], "2015-04-09");
    assert_eq!(values(&summary, "FOPR").len(), summary.steps.len());
}

/// A file with its arrays from `range` as another file.
fn copy(
    file: &RecordFile,
    range: std::ops::Range<usize>,
    mut out: RecordWriter<Vec<u8>>,
) -> Vec<u8> {
    for entry in &file.entries()[range] {
        let name = entry.name();
        match entry.kind {
            Kind::Inte => out.inte(name, &file.i32s(entry).unwrap()),
            Kind::Real => out.real(name, &file.f32s(entry).unwrap()),
            Kind::Text(width) => out.text(name, width, &file.strings(entry).unwrap()),
            _ => panic!("{name}"),
        }
        .unwrap();
    }
    out.finish().unwrap()
}

fn assert_equal(a: &Summary, b: &Summary) {
    assert_eq!(a.vectors, b.vectors);
    assert_eq!(a.steps, b.steps);
    assert_eq!(a.dates(), b.dates());
    for vector in &a.vectors {
        assert_eq!(
            a.values(vector).unwrap(),
            b.values(vector).unwrap(),
            "{vector}"
        );
    }
}

#[test]
fn ok_twins_in_every_form() {
    let Some(path) = data("reek/REEK.SMSPEC") else {
        return;
    };
    let [spec, params] =
        ["SMSPEC", "UNSMRY"].map(|e| RecordFile::open(&path.with_extension(e)).unwrap());
    let unified = open(&path);
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: Vec<u8>| fs::write(folder.path().join(name), bytes).unwrap();
    let all = |file: &RecordFile| 0..file.entries().len();
    // Formatted.
    let text = || RecordWriter::formatted(Vec::new());
    write("A.FSMSPEC", copy(&spec, all(&spec), text()));
    write("A.FUNSMRY", copy(&params, all(&params), text()));
    let formatted = open(&folder.path().join("A"));
    assert_equal(&unified, &formatted);
    // A file for each report, of which a formatted one has a binary twin.
    let starts = (0..params.entries().len()).filter(|n| params.entries()[*n].name() == "SEQHDR");
    let starts: Vec<usize> = starts.chain([params.entries().len()]).collect();
    for (n, ends) in starts.windows(2).enumerate() {
        let binary = RecordWriter::new(Vec::new());
        write(
            &format!("B.S{:04}", n + 1),
            copy(&params, ends[0]..ends[1], binary),
        );
        if n == 0 {
            write("B.A0001", copy(&params, ends[0]..ends[1], text()));
        }
    }
    write(
        "B.SMSPEC",
        copy(&spec, all(&spec), RecordWriter::new(Vec::new())),
    );
    let source = case::find_summary(&folder.path().join("B.SMSPEC")).unwrap();
    let SummarySource::Separate { data, .. } = &source else {
        panic!("{source:?}");
    };
    assert_eq!(data.len(), starts.len() - 1);
    assert!(data[0].1.ends_with("B.S0001"));
    assert_equal(&unified, &open(&folder.path().join("B")));
    // By vectors.
    let mut out = RecordWriter::new(Vec::new());
    out.inte("START", &[1, 1, 2000, 0, 0, 0, 0]).unwrap();
    let keys: Vec<String> = unified.vectors.iter().map(ToString::to_string).collect();
    out.text("KEYCHECK", 30, &keys).unwrap();
    let units: Vec<&str> = unified.vectors.iter().map(|v| v.unit.as_str()).collect();
    out.chars("UNITS", &units).unwrap();
    let reports = unified
        .steps
        .iter()
        .map(|s| if s.is_report { s.report as i32 } else { 0 });
    out.inte("RSTEP", &reports.collect::<Vec<_>>()).unwrap();
    let numbers: Vec<i32> = unified.steps.iter().map(|s| s.number).collect();
    out.inte("TSTEP", &numbers).unwrap();
    for (n, vector) in unified.vectors.iter().enumerate() {
        out.real(&format!("V{n}"), &unified.values(vector).unwrap())
            .unwrap();
    }
    write("C.ESMRY", out.finish().unwrap());
    assert_equal(&unified, &open(&folder.path().join("C")));
}

#[test]
fn ok_what_vectors_are_of() {
    let mut spec = RecordWriter::new(Vec::new());
    let vectors = [
        ("TIME", "", 0, "TIME"),
        ("", "", 0, ""),
        ("WUOPH", "P1", 1, "WUOPH:P1"),
        ("COFR", "P1", 8, "COFR:P1:2,1,2"),
        ("SOFR", "P1", 3, "SOFR:P1:3"),
        ("RPR", "", 4, "RPR:4"),
        ("ROFT", "", 2 + 32_768 * 13, "ROFT:2-3"),
        ("AAQR", "", 1, "AAQR:1"),
        ("GOPR", "G1", 1, "GOPR:G1"),
        ("BPR", "", 13, "BPR"),
        ("STEPTYPE", "", 0, "STEPTYPE"),
        ("NEWTON", "", 0, "NEWTON"),
    ];
    let named = |name: &'static str| if name.is_empty() { ":+:+:+:+" } else { name };
    spec.inte("DIMENS", &[12, 3, 2, 2]).unwrap();
    spec.chars("KEYWORDS", &vectors.map(|v| v.0)).unwrap();
    spec.text("NAMES", 12, &vectors.map(|v| named(v.1)))
        .unwrap();
    spec.inte("NUMS", &vectors.map(|v| v.2)).unwrap();
    spec.chars("UNITS", &["HOURS"; 12]).unwrap();
    spec.inte("STARTDAT", &[28, 2, 2000, 23, 30, 0]).unwrap();
    let spec = spec.finish().unwrap();
    let mut params = RecordWriter::new(Vec::new());
    params.inte("SEQHDR", &[1]).unwrap();
    for hours in [0.5_f32, 24.5] {
        let mut values = [7.0; 12];
        values[0] = hours;
        params.real("PARAMS", &values).unwrap();
    }
    params.real("PARAMS", &[1.0]).unwrap();
    let params = params.finish().unwrap();
    let mut warnings = Warnings::default();
    let summary = Summary::from_bytes(
        ("A.SMSPEC", spec.clone()),
        ("A.UNSMRY", params.clone()),
        &mut warnings,
    );
    let summary = summary.unwrap();
    let shown: Vec<String> = summary.vectors.iter().map(ToString::to_string).collect();
    let expected = vectors.iter().map(|v| v.3).filter(|key| !key.is_empty());
    assert_eq!(shown, expected.collect::<Vec<_>>());
    assert_eq!(
        summary.find("ROFT:2-3").unwrap().subject,
        Subject::Regions([2, 3])
    );
    // A cell that the grid has not.
    assert_eq!(summary.find("BPR").unwrap().subject, Subject::Other(None));
    assert!(!summary.find("WUOPH:P1").unwrap().is_history());
    assert_eq!(summary.dates(), ["2000-02-29", "2000-03-01"]);
    assert_eq!(values(&summary, "GOPR:G1"), [7.0, 7.0]);
    let reports: Vec<_> = summary
        .steps
        .iter()
        .map(|s| (s.report, s.is_report))
        .collect();
    assert_eq!(reports, [(1, false), (1, true)]);
    let said: Vec<_> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "A.UNSMRY: 1 time steps were left out: their PARAMS have another number of values than the 12 that KEYWORDS names"
        ]
    );
    // One that is still being written.
    let mut warnings = Warnings::default();
    let cut = params[..params.len() - 60].to_vec();
    let files = vec![(7, FileBytes::from(("A.S0007", cut)))];
    let cut = Summary::separate_from_bytes(("A.SMSPEC", spec), files, &mut warnings).unwrap();
    assert_eq!((cut.steps.len(), cut.steps[0].report), (1, 7));
    assert_eq!(warnings.iter().count(), 1);
}

#[test]
fn err_what_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("A.SMSPEC");
    fs::write(&path, "").unwrap();
    let error = case::find_summary(&path).unwrap_err().to_string();
    assert!(
        error.ends_with("looked for A.SMSPEC with A.UNSMRY or A.S0001, and A.ESMRY"),
        "{error}"
    );
    let mut spec = RecordWriter::new(Vec::new());
    spec.chars("KEYWORDS", &["FOPR"]).unwrap();
    let spec = spec.finish().unwrap();
    let mut params = RecordWriter::new(Vec::new());
    params.real("PARAMS", &[1.0]).unwrap();
    let params = params.finish().unwrap();
    let read = |spec: &[u8], params: &[u8]| {
        let [spec, params] = [spec, params].map(<[u8]>::to_vec);
        let read = Summary::from_bytes(
            ("A.SMSPEC", spec),
            ("A.UNSMRY", params),
            &mut Warnings::default(),
        );
        read.unwrap_err().to_string()
    };
    assert_eq!(
        read(&spec, &params),
        "A.SMSPEC: TIME: is missing, and so is YEARS: the vectors have no times"
    );
    assert_eq!(
        read(&spec, &spec),
        "A.UNSMRY: PARAMS: is missing: there is no time step"
    );
    assert_eq!(
        read(&params, &params),
        "A.SMSPEC: KEYWORDS: is missing; this is no SMSPEC file"
    );
}
