//! The reader of text decks: real files against independent facts, hand-written ones, and broken ones.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use std::fs;
use std::path::{Path, PathBuf};

use strataray_parsers::deck::{DeckProperty, Grdecl, MemoryFiles, UnitSystem};
use strataray_parsers::egrid::PorosityModel;
use strataray_parsers::records::RecordWriter;
use strataray_parsers::{ParseError, Warnings};

/// One cell, with all corners at depth 0 or 1.
const CELL: &str = "SPECGRID\n1 1 1 1 F /\nCOORD\n0 0 0 0 0 1  1 0 0 1 0 1  0 1 0 0 1 1  1 1 0 1 1 1 /\nZCORN\n4*0 4*1 /\n";

fn read(path: &Path) -> (Result<Grdecl, ParseError>, Vec<String>) {
    let mut warnings = Warnings::default();
    let grid = Grdecl::read(path, &mut warnings);
    (grid, warnings.iter().map(ToString::to_string).collect())
}

fn read_bytes(text: &[u8]) -> (Result<Grdecl, ParseError>, Vec<String>) {
    let name = Path::new("TEST.GRDECL");
    let files = MemoryFiles::from_iter([(name, text.to_vec())]);
    let mut warnings = Warnings::default();
    let grid = Grdecl::read_from(&files, name, &[], &mut warnings);
    (grid, warnings.iter().map(ToString::to_string).collect())
}

fn ok(text: &str) -> Grdecl {
    let (grid, warnings) = read_bytes(text.as_bytes());
    assert_eq!(warnings, Vec::<String>::new(), "{text}");
    grid.unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn warned(text: &str) -> (Grdecl, String) {
    let (grid, warnings) = read_bytes(text.as_bytes());
    (grid.unwrap(), warnings.join("\n"))
}

#[track_caller]
fn err(text: &str, expected: &str) {
    let message = read_bytes(text.as_bytes()).0.unwrap_err().to_string();
    assert!(message.contains(expected), "{message}\nlacks: {expected}");
}

/// `CELL` with `text` behind it.
fn cell(text: &str) -> String {
    format!("{CELL}{text}")
}

fn property<'a>(grid: &'a Grdecl, name: &str) -> &'a [f64] {
    let property = grid
        .properties
        .iter()
        .find(|property| property.name == name);
    &property.unwrap_or_else(|| panic!("no {name}")).values
}

fn names(grid: &Grdecl) -> Vec<&str> {
    grid.properties
        .iter()
        .map(|property| property.name.as_str())
        .collect()
}

fn data() -> Option<PathBuf> {
    let path = std::env::var_os("STRATARAY_DATA").map(PathBuf::from);
    if path.is_none() {
        println!("STRATARAY_DATA is not set: the test on real decks is left out");
    }
    path
}

// --- notation ---

#[test]
fn ok_one_cell() {
    let grid = ok(CELL);
    assert_eq!(grid.dims, [1, 1, 1]);
    assert_eq!(grid.coord.len(), 24);
    assert_eq!(grid.zcorn, [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(grid.actnum, None);
    assert_eq!(grid.files.len(), 1);
}

#[test]
fn ok_numbers_in_every_notation() {
    for (token, value) in [
        ("1.0D+3", 1000.0),
        ("1d3", 1000.0),
        ("1E+03", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("-.5e-1", -0.05),
        ("+7", 7.0),
        ("1*0.25", 0.25),
        ("0.1", 0.1),
        (
            "123456789012345678901234567890",
            123456789012345678901234567890.0,
        ),
        ("-0", 0.0),
        ("0.54950006E+06", 549500.06),
        ("00000000012.5", 12.5),
        ("1e-400", 0.0),
    ] {
        let grid = ok(&cell(&format!("PORO\n{token}/\n")));
        assert_eq!(property(&grid, "PORO"), [value], "{token}");
    }
}

#[test]
fn ok_undefined_values_in_properties() {
    for token in ["*", "1*", "nan", "NaN", "-inf", "Infinity", "1e999"] {
        let grid = ok(&cell(&format!("PORO\n{token} /\n")));
        assert!(property(&grid, "PORO")[0].is_nan(), "{token}");
    }
    assert_eq!(ok(&cell("ACTNUM\n1* /\n")).actnum, Some(vec![1]));
}

#[test]
fn ok_comments_line_ends_and_case() {
    let plain = ok(&cell("PORO\n0.25 /\n"));
    let texts = [
        cell("PORO -- porosity / of 'it\n0.25-- a / and a ' here\n/ the rest is / comment\n"),
        cell("poro\n\t0.25/ ZCORN\n"),
        cell("  PORO\n0.25\n/\n"),
        cell("PORO 0.25 /\n"),
        cell("NOECHO\nPORO 0.25 /\n"),
        cell("PORO--x\n\x0c 0.25 /\n"),
    ];
    for text in texts {
        for line_end in ["\n", "\r\n", "\r"] {
            let text = text.replace('\n', line_end);
            let grid = ok(&text);
            assert_eq!(
                (grid.coord, grid.zcorn, grid.properties),
                (
                    plain.coord.clone(),
                    plain.zcorn.clone(),
                    plain.properties.clone()
                ),
                "{text:?}"
            );
        }
    }
    let different = ok(&cell("PORO\n0.26 /\n"));
    assert_ne!(different.properties, plain.properties);
}

#[test]
fn ok_bytes_beyond_utf8_in_comments() {
    let mut text = cell("PORO -- d\n0.25 /\n").into_bytes();
    let at = text.len() - 9;
    text.splice(at..at, *b"\xe6\xf8\xe5\xff");
    assert_eq!(property(&read_bytes(&text).0.unwrap(), "PORO"), [0.25]);
}

#[test]
fn ok_arrays_before_dimensions() {
    let (spec, arrays) = CELL.split_at(CELL.find("COORD").unwrap());
    assert_eq!(
        ok(&format!("PORO\n0.5 /\n{arrays}{spec}")).properties,
        ok(&cell("PORO\n0.5 /\n")).properties
    );
}

// --- short keywords ---

#[test]
fn ok_map_keywords() {
    let grid = ok(&cell(
        "MAPAXES\n1 2 3\n4 5 6 / \nMAPUNITS\n'METRES  ' /\nGRIDUNIT\nFEET 'MAP     ' /\nGDORIENT\nINC DEC INC DOWN LEFT /\nFIELD\n",
    ));
    assert_eq!(grid.map_axes, Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    assert_eq!(grid.map_units.as_deref(), Some("METRES"));
    let unit = grid.grid_unit.unwrap();
    assert_eq!((unit.name.as_str(), unit.is_map), ("FEET", true));
    assert_eq!(
        grid.gdorient.unwrap(),
        ["INC", "DEC", "INC", "DOWN", "LEFT"]
    );
    assert_eq!(grid.unit_system, Some(UnitSystem::Field));
}

#[test]
fn ok_faults() {
    let grid = ok(&cell(
        "FAULTS\n'A/B -- C' 1 1 1 1\n 1 1 'x-' / why\n F2 6*1 J /\n/\nPORO\n0.5/\n",
    ));
    assert_eq!(grid.faults.len(), 2);
    assert_eq!(
        (grid.faults[0].name.as_str(), grid.faults[0].face.as_str()),
        ("A/B -- C", "X-")
    );
    assert_eq!(
        (
            grid.faults[1].i,
            grid.faults[1].k,
            grid.faults[1].face.as_str()
        ),
        ([1, 1], [1, 1], "J")
    );
    assert_eq!(names(&grid), ["PORO"]);
}

#[test]
fn err_faults() {
    err(&cell("FAULTS\nA 1 1 1 1 1 1 W /\n/\n"), "'W' is not a face");
    err(
        &cell("FAULTS\nA 1 1 1 1 1 1 /\n/\n"),
        "TEST.GRDECL:8:1: FAULTS: expected 8 items",
    );
    err(&cell("FAULTS\nA 2 1 1 1 1 1 X /\n/\n"), "runs backward");
    err(&cell("FAULTS\nA 0 1 1 1 1 1 X /\n/\n"), "found '0'");
    err(
        &cell("FAULTS\n'A 1 1 1 1 1 1 X /\n/\n"),
        "quote is not closed",
    );
    let (grid, warning) = warned(&cell("FAULTS\nA 1 2 1 1 1 1 X /\n/\n"));
    assert!(
        grid.faults.is_empty() && warning.contains("outside the grid (I 2 of 1)"),
        "{warning}"
    );
}

// --- what is skipped ---

#[test]
fn ok_unknown_keywords_are_skipped() {
    for skipped in [
        "RUNSPEC\nTITLE\n COORD is not a keyword here / 'x\nOIL\nWATER\n\nGRID\nINIT\nNOECHO\n",
        "PINCH\n",
        "PINCH\n/\n",
        "PINCH\n 0.4 NOGAP 1* TOPBOT TOP /\n",
        "START\n 1 JAN 2000 /\n",
        "START\n 1 'JAN' 2000 /\n",
        "RPTGRID\n ALLNNC PORO /\n",
        "RPTSOL\n FIP=2 RESTART=2 /\n",
        "SCALECRS\nYES /\n",
        "GRIDOPTS\n 'YES' 1* /\n",
        "PVTO\n0 14.7 1 1.2 /\n1.5 4000 1.12 0.94\n 4600 1.1 0.94 /\n/\n",
        "ROCK\n 3600 4e-6 /\n",
        "EQUIL\n1 2 3 0 8800 0 1 0 0 /\n2 3 4 5 6 7 8 /\n",
        "TABDIMS\n/\nEQLDIMS\n2 100 20 /\n",
        "AQUCON\n 1 1 1 1 1 1 1 'I-' /\n/\n",
        "GDUMMY\n'a/b' 'c -- d' 12 / comment\n",
        "SKIP\nZCORN\n1 2 3 /\nENDSKIP\n",
        "ECHO\nNOSUCHKEYWORD\n",
    ] {
        let grid = ok(&format!("{skipped}{CELL}{skipped}PORO\n0.5 /\n{skipped}"));
        assert_eq!(
            (grid.zcorn.len(), names(&grid)),
            (8, vec!["PORO"]),
            "{skipped}"
        );
    }
}

#[test]
fn ok_reading_stops_before_summary_schedule_and_end() {
    for end in ["SUMMARY", "SCHEDULE", "END", "ENDINC"] {
        let grid = ok(&cell(&format!(
            "{end}\nWOPR\n'A\n/\nPORO\n0.5 /\nZCORN 1 2"
        )));
        assert!(grid.properties.is_empty(), "{end}");
    }
}

/// A grid of 2 x 2 x 2 cells of a meter with `text` behind it.
fn cube(text: &str) -> String {
    let pillar = |n: usize| format!(" {} {} 0 {} {} 2", n % 3, n / 3, n % 3, n / 3);
    let coord: String = (0..9).map(pillar).collect();
    format!("SPECGRID\n2 2 2 1 F /\nCOORD\n{coord} /\nZCORN\n16*0 32*1 16*2 /\n{text}")
}

#[test]
fn ok_operations_are_applied_in_their_order() {
    let grid = ok(&cube(
        "EQUALS\n PORO 0.2 /\n 'PORO' 0.3 1 1 1 2 2 2 / a box\n NTG 0.5 / in the same box\n/\n\
         PERMX\n1 2 3 4 5 6 7 8 /\nCOPY\n PERMX PERMY /\n PERMX PERMZ 1 2 1 2 1 1 /\n/\n\
         MULTIPLY\n PERMY 10 /\n PERMY 2 1 1 1 1 1 1 /\n MULTZ 0.1 1 2 1 2 2 2 /\n/\n\
         ADD\n PERMX 1 /\n/\nMINVALUE\n PERMX 4 /\n/\nMAXVALUE\n PERMX 7 /\n/\n",
    ));
    let [porosity, gap] = [0.2, f64::NAN];
    assert_eq!(
        property(&grid, "PORO"),
        [
            porosity, porosity, porosity, porosity, 0.3, porosity, 0.3, porosity
        ]
    );
    // Cells outside the box have what a deck gives where it gives nothing.
    assert_eq!(
        property(&grid, "NTG"),
        [1.0, 1.0, 1.0, 1.0, 0.5, 1.0, 0.5, 1.0]
    );
    assert_eq!(
        property(&grid, "PERMX"),
        [4.0, 4.0, 4.0, 5.0, 6.0, 7.0, 7.0, 7.0]
    );
    assert_eq!(
        property(&grid, "PERMY"),
        [20.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0]
    );
    let shown = format!("{:?}", property(&grid, "PERMZ"));
    assert_eq!(
        shown,
        format!("{:?}", [1.0, 2.0, 3.0, 4.0, gap, gap, gap, gap])
    );
    assert_eq!(property(&grid, "MULTZ")[3..5], [1.0, 0.1]);
    assert!(
        grid.properties
            .iter()
            .all(|property| property.doubt.is_none())
    );
}

#[test]
fn ok_arrays_in_boxes() {
    let grid = ok(&cube(
        "PORO\n8*0.1 /\nBOX\n2 2 1 2 1 1 /\nPORO\n0.2 0.3 /\nACTNUM\n0 1 /\nEQUALS\n NTG 0.5 /\n/\n\
         ENDBOX\nSATNUM\n8*3 /\n",
    ));
    assert_eq!(
        property(&grid, "PORO"),
        [0.1, 0.2, 0.1, 0.3, 0.1, 0.1, 0.1, 0.1]
    );
    assert_eq!(
        property(&grid, "NTG"),
        [1.0, 0.5, 1.0, 0.5, 1.0, 1.0, 1.0, 1.0]
    );
    assert_eq!(grid.actnum.unwrap(), [1, 0, 1, 1, 1, 1, 1, 1]);
    let (grid, warning) = warned(&cube("BOX\n1 3 1 2 1 1 /\nPORO\n6*0.2 /\nENDBOX\n"));
    assert!(
        names(&grid).is_empty() && warning.contains("a BOX outside the grid"),
        "{warning}"
    );
    let (grid, warning) = warned(&cube("BOX\n1 2 1 2 1 1 /\nPORO\n8*0.2 /\nENDBOX\n"));
    assert!(
        names(&grid).is_empty() && warning.contains("8 values for 4 cells"),
        "{warning}"
    );
}

#[test]
fn ok_what_is_not_applied_is_said_and_doubted() {
    let (grid, warning) = warned(&cube(
        "PORO\n8*0.2 /\nPERMX\n8*5 /\nNTG\n8*1 /\nEQUALREG\n PORO 0.3 1 M /\n NTG 0.9 2 M /\n/\n\
         MULTIREG\n PORO 2 1 M /\n/\nEQUALS\n NTG 1 /\n PERMX 9 1 3 1 1 1 1 /\n/\n\
         COPY\n PORO PERMY /\n NOSUCH PERMX /\n/\nMULTIPLY\n TRANX 0.5 /\n/\nCOPY\n PERMX PERMZ /\n/\n",
    ));
    for expected in [
        "EQUALREG was not applied to PORO, NTG: the array of its regions is not in the deck",
        "EQUALS was not applied to PERMX: its box is outside the grid",
        "COPY was not applied to PERMX: the array that it reads is not in the deck",
        "MULTIPLY was not applied to TRANX, which the deck does not give",
    ] {
        assert!(warning.contains(expected), "{expected}\n{warning}");
    }
    let doubt = |name: &str| {
        let property = grid
            .properties
            .iter()
            .find(|property| property.name == name);
        property.unwrap().doubt.as_deref()
    };
    let both = Some("EQUALREG and MULTIREG of the deck were not applied");
    assert_eq!([doubt("PORO"), doubt("PERMY")], [both; 2]);
    assert_eq!(
        doubt("PERMX"),
        Some("EQUALS and COPY of the deck were not applied")
    );
    assert_eq!(doubt("PERMZ"), doubt("PERMX"));
    // What is set anew for all cells is as the deck says.
    assert_eq!(doubt("NTG"), None);
}

/// Regions 1 and 2 side by side along i, and 3 instead of both in the lower layer.
const REGIONS: &str =
    "8*3 /\nBOX\n1 1 1 2 1 1 /\nNAME\n2*1 /\nBOX\n2 2 1 2 1 1 /\nNAME\n2*2 /\nENDBOX\n";

fn regions(name: &str) -> String {
    format!("{name}\n{}", REGIONS.replace("NAME", name))
}

#[test]
fn ok_operations_on_regions() {
    let poro = "PORO\n8*0.5 /\nPERMX\n1 2 3 4 5 6 7 8 /\n";
    let with = |text: &str| {
        let grid = ok(&cube(&format!("{}{poro}{text}", regions("MULTNUM"))));
        property(&grid, "PORO").to_vec()
    };
    let (a, b) = (0.25, 0.5);
    let first = [a, b, a, b, b, b, b, b];
    assert_eq!(with("EQUALREG\n PORO 0.25 1 M /\n/\n"), first);
    assert_eq!(with("EQUALREG\n PORO 0.25 1 /\n/\n"), first);
    assert_eq!(with("MULTIREG\n PORO 0.5 1 M /\n/\n"), first);
    assert_eq!(with("ADDREG\n PORO -0.25 1 /\n/\n"), first);
    // Another region, other cells.
    let second = [b, a, b, a, b, b, b, b];
    assert_eq!(with("EQUALREG\n PORO 0.25 2 M /\n/\n"), second);
    // Regions as they are when the record is read.
    assert_eq!(
        with("EQUALS\n MULTNUM 2 1 1 1 1 1 1 /\n/\nEQUALREG\n PORO 0.25 2 /\n/\n"),
        [a, a, b, a, b, b, b, b]
    );
    assert_eq!(
        with("COPYREG\n PERMX PORO 3 /\n/\n"),
        [b, b, b, b, 5.0, 6.0, 7.0, 8.0]
    );
    let (grid, warning) = warned(&cube(&format!(
        "{}{poro}EQUALREG\n PORO 0.25 7 /\n PORO 0.1 1 O /\n/\n",
        regions("MULTNUM")
    )));
    assert_eq!(property(&grid, "PORO"), [0.5; 8]);
    for expected in [
        "EQUALREG was not applied to PORO: no cell is in its region",
        "EQUALREG was not applied to PORO: the array of its regions is not in the deck",
    ] {
        assert!(warning.contains(expected), "{warning}");
    }
}

#[test]
fn ok_the_array_of_regions_that_is_meant() {
    let both = format!("{}FLUXNUM\n4*1 4*2 /\nPORO\n8*0.5 /\n", regions("MULTNUM"));
    let record = "EQUALREG\n PORO 0 1 LETTER /\n/\n";
    let zeros = |options: &str, letter: &str| {
        let grid = ok(&cube(&format!(
            "{options}{both}{}",
            record.replace("LETTER", letter)
        )));
        let values = property(&grid, "PORO").to_vec();
        (0..8)
            .filter(|cell| values[*cell] == 0.0)
            .collect::<Vec<_>>()
    };
    let (flux, multiplier) = (vec![0, 1, 2, 3], vec![0, 2]);
    assert_eq!(zeros("", "F"), flux);
    assert_eq!(zeros("", "M"), multiplier);
    // Where none is named: as GRIDOPTS has it.
    assert_eq!(zeros("", ""), flux);
    assert_eq!(zeros("GRIDOPTS\n 'YES' 0 /\n", ""), flux);
    assert_eq!(zeros("GRIDOPTS\n 'YES' 3 /\n", ""), multiplier);
}

#[test]
fn ok_formulas() {
    let deck = "PORO\n8*0.5 /\nPERMX\n10 100 4*10 -3 10 /\n";
    let target = |record: &str| {
        let (grid, warning) = warned(&cube(&format!("{deck}OPERATE\n PORO 6* {record} /\n/\n")));
        (property(&grid, "PORO").to_vec(), warning)
    };
    // By hand, for x = 10, 100 and -3, and r = 0.5.
    for (record, expected) in [
        ("MULTA PERMX 2 1", [21.0, 201.0, -5.0]),
        ("POLY PERMX 2 2", [200.5, 20000.5, 18.5]),
        ("SLOG PERMX 1 0.1", [100.0, 1e11, 10_f64.powf(0.7)]),
        ("MULTX PERMX 3", [30.0, 300.0, -9.0]),
        ("ADDX PERMX 3", [13.0, 103.0, 0.0]),
        ("COPY PERMX", [10.0, 100.0, -3.0]),
        ("MAXLIM PERMX 20", [10.0, 20.0, -3.0]),
        ("MINLIM PERMX 20", [20.0, 100.0, 20.0]),
        ("MULTP PERMX 2 2", [200.0, 20000.0, 18.0]),
        ("ABS PERMX", [10.0, 100.0, 3.0]),
        ("MULTIPLY PERMX", [5.0, 50.0, -1.5]),
        ("INV PERMX", [0.1, 0.01, -1.0 / 3.0]),
    ] {
        let (values, warning) = target(record);
        for (cell, expected) in [0, 1, 6].into_iter().zip(expected) {
            let difference = (values[cell] - expected).abs();
            assert!(difference <= 1e-12 * expected.abs(), "{record}: {values:?}");
        }
        assert!(warning.is_empty(), "{warning}");
    }
    for (record, first) in [("LOG10 PERMX", 1.0), ("LOGE PERMX", 10_f64.ln())] {
        let (values, warning) = target(record);
        assert_eq!(values[0], first);
        assert!(values[6].is_nan() && !values[7].is_nan());
        assert!(
            warning.contains("PORO becomes undefined in 1 cell"),
            "{warning}"
        );
    }
    let (values, warning) = target("NOSUCH PERMX");
    assert_eq!(values, [0.5; 8]);
    assert!(warning.contains("OPERATE was not applied to PORO: its formula is not known"));
}

#[test]
fn ok_formulas_in_boxes_and_regions() {
    let deck = format!(
        "PORO\n8*0.5 /\nPERMX\n1 2 3 4 5 6 7 8 /\n{}",
        regions("OPERNUM")
    );
    let grid = ok(&cube(&format!(
        "{deck}OPERATE\n PORO 1 1 1 1 2 2 MULTX PERMX 10 /\n PERMY 6* COPY PERMX /\n/\n\
         OPERATER\n PORO 1 ADDX PERMX 100 /\n PERMY 3 MULTA PORO 2 1 1* O /\n/\n"
    )));
    assert_eq!(
        property(&grid, "PORO"),
        [101.0, 0.5, 103.0, 0.5, 50.0, 0.5, 0.5, 0.5]
    );
    let defined: Vec<f64> = property(&grid, "PERMY").to_vec();
    // A box that is named holds for the records behind it, so the copy is of one cell.
    assert!(defined[..4].iter().all(|value| value.is_nan()));
    assert_eq!(defined[4..], [101.0, 2.0, 2.0, 2.0]);
}

#[test]
fn ok_the_section_edit_has_factors_of_its_own() {
    let grid = ok(&cube(
        "GRID\nMULTX\n8*0.5 /\nMULTPV\n8*2 /\nPORO\n8*0.1 /\nEDIT\n\
         MULTX\n4*0.5 4*1 /\nEQUALS\n MULTPV 3 1 1 1 1 1 1 /\n MULTY 0.1 /\n/\n\
         BOX\n1 2 1 1 1 1 /\nPORV\n100 200 /\nENDBOX\nMULTIPLY\n PORV 10 1 2 1 2 1 1 /\n/\n",
    ));
    let half = 0.25;
    assert_eq!(
        property(&grid, "MULTX"),
        [half, half, half, half, 0.5, 0.5, 0.5, 0.5]
    );
    let mut thinner = [1.0; 8];
    thinner[0] = 0.1;
    assert_eq!(property(&grid, "MULTY"), thinner);
    // Given pore volumes: 100 and 200, times 10, the first times the factor of its cell in EDIT.
    let volumes = property(&grid, "PORV");
    assert_eq!(volumes[..2], [3000.0, 2000.0]);
    assert!(volumes[2..].iter().all(|volume| volume.is_nan()));
    // Others follow from the geometry, times the factors of both sections and those on PORV.
    assert_eq!(
        property(&grid, "MULTPV")[1..],
        [2.0, 20.0, 20.0, 2.0, 2.0, 2.0, 2.0]
    );
    // In one section the last one holds.
    let (grid, _) = warned(&cube("GRID\nMULTX\n8*0.5 /\nMULTX\n8*0.25 /\n"));
    assert_eq!(property(&grid, "MULTX"), [0.25; 8]);
}

#[test]
fn ok_changes_of_pore_volumes_that_are_not_known() {
    let (grid, warning) = warned(&cube(
        "GRID\nPORO\n8*0.1 /\nEDIT\nEQUALS\n PORV 5 1 1 1 1 1 1 /\n/\nADD\n PORV 1 /\n/\n",
    ));
    assert_eq!(property(&grid, "PORV")[0], 6.0);
    assert!(
        warning.contains("ADD was not applied to PORV where it follows from the geometry"),
        "{warning}"
    );
    let (grid, _) = warned(&cube("EDIT\nADD\n PORV 1 /\n/\n"));
    assert!(names(&grid).is_empty());
}

#[test]
fn ok_cells_are_made_inactive_by_operations() {
    let grid = ok(&cube(
        "EQUALS\n ACTNUM 0 1 1 1 2 1 1 /\n/\nBOX\n2 2 2 2 2 2 /\nACTNUM\n0 /\nENDBOX\n\
         FLUXNUM\n7*1 2 /\nEQUALREG\n ACTNUM 1 2 F /\n/\n",
    ));
    assert_eq!(grid.actnum.unwrap(), [0, 1, 0, 1, 1, 1, 1, 1]);
}

#[test]
fn ok_faults_have_their_multipliers() {
    let grid = ok(&cube(
        "FAULTS\nF1 1 1 1 2 1 2 X /\nF2 1 2 1 1 1 2 Y /\nG 1 1 1 2 1 1 X /\n/\n\
         MULTFLT\n'F*' 0.5 /\n'F2' 0.0 /\n/\n",
    ));
    let multipliers: Vec<_> = grid.faults.iter().map(|fault| fault.multiplier).collect();
    assert_eq!(multipliers, [Some(0.5), Some(0.0), None]);
}

#[test]
fn ok_tables_are_no_properties() {
    let grid = ok(&cube(
        "SWOF\n 0.2 0 1 0 1 1 0 0 /\nMYPROP\n8*1 /\nRUNSPEC\nOIL\nWATER\nSTRANGE\n8*1 /\nGRID\nODD\n8*2 /\n\
         PROPS\nPVDO\n 1 1 1 2 2 2 3 3 /\nUNKNOWN\n8*1 /\nSWL\n8*0.1 /\nREGIONS\nFIPABC\n8*2 /\nSOLUTION\n\
         EQUIL\n 1 2 3 4 5 6 7 8 /\nSWAT\n8*0.3 /\n",
    ));
    assert_eq!(names(&grid), ["MYPROP", "ODD", "SWL", "FIPABC", "SWAT"]);
    assert_eq!(grid.phases, 3);
}

#[test]
fn ok_block_centered_grids() {
    let deck =
        "DIMENS\n2 1 2 /\nDXV\n100 50 /\nDY\n4*80 /\nEQUALS\n DZ 10 /\n DZ 20 1 2 1 1 2 2 /\n/\n";
    let grid = ok(&format!("{deck}TOPS\n1000 1010 /\nPORO\n4*0.2 /\n"));
    assert_eq!(names(&grid), ["DY", "DZ", "PORO"]);
    assert_eq!(grid.coord[6..12], [100.0, 0.0, 1000.0, 100.0, 0.0, 1040.0]);
    assert_eq!(grid.coord[30..33], [150.0, 80.0, 1000.0]);
    assert_eq!(grid.zcorn[0..4], [1000.0, 1000.0, 1010.0, 1010.0]);
    assert_eq!(grid.zcorn[8..12], [1010.0, 1010.0, 1020.0, 1020.0]);
    assert_eq!(grid.zcorn[28..32], [1030.0, 1030.0, 1040.0, 1040.0]);
    // Tops of deeper layers leave gaps.
    let grid = ok(&format!("{deck}TOPS\n1000 1010 1015 1* /\n"));
    assert_eq!(grid.zcorn[16..20], [1015.0, 1015.0, 1020.0, 1020.0]);
    err(
        &format!("{deck}TOPS\n1000 1* /\n"),
        "TOPS: has no value for cell 2 of the first layer",
    );
    let half = deck.replace("DY\n4*80", "BOX\n1 1 1 1 1 1 /\nDY\n80");
    err(
        &format!("{half}ENDBOX\nTOPS\n2*1000 /\n"),
        "DY: has no value for cell 2",
    );
    let uneven = deck.replace("4*80", "2*80 2*90");
    let (_, warning) = warned(&format!("{uneven}TOPS\n2*1000 /\n"));
    assert!(
        warning.contains("DY differs from layer to layer"),
        "{warning}"
    );
}

/// A ring of two cells along the radius, four around and two layers, with `sizes`.
fn ring(sizes: &str) -> (Grdecl, String) {
    warned(&format!(
        "RUNSPEC\nRADIAL\nDIMENS\n2 4 2 /\nGRID\nINRAD\n1 /\n{sizes}DZ\n8*5 8*10 /\nTOPS\n8*1000 /\nPORO\n16*0.2 /\n"
    ))
}

#[test]
fn ok_radial_grids() {
    let near = |values: &[f64], expected: &[f64]| {
        let pairs = values.iter().zip(expected);
        assert_eq!(values.len(), expected.len());
        assert!(
            pairs.clone().all(|(a, b)| (a - b).abs() < 1e-9),
            "{values:?} {expected:?}"
        );
    };
    let (grid, warning) = ring("DRV\n2 4 /\nDTHETAV\n4*90 /\n");
    assert!(warning.contains("the grid is radial"), "{warning}");
    // Radii 1, 3, 7; the second row of pillars is a quarter of a turn on.
    near(&grid.coord[..6], &[1.0, 0.0, 1000.0, 1.0, 0.0, 1015.0]);
    near(&grid.coord[12..15], &[7.0, 0.0, 1000.0]);
    near(&grid.coord[30..33], &[0.0, 7.0, 1000.0]);
    assert_eq!(grid.coord[..18], grid.coord[72..]);
    assert_eq!([grid.zcorn[0], grid.zcorn[127]], [1000.0, 1015.0]);
    assert_eq!(property(&grid, "PORO").len(), 16);
    // The same by cells, and by an operation.
    let arrays = "DR\n2 4 2 4 2 4 2 4 2 4 2 4 2 4 2 4 /\nEQUALS\n DTHETA 90 /\n/\n";
    assert_eq!(ring(arrays).0.coord, grid.coord);
    // Other sizes, other pillars.
    let (other, _) = ring("DRV\n2 5 /\nDTHETAV\n4*45 /\n");
    near(&other.coord[12..14], &[8.0, 0.0]);
    near(
        &other.coord[66..68],
        &[-8.0 * 0.5_f64.sqrt(), 8.0 * 0.5_f64.sqrt()],
    );
    near(&other.coord[84..86], &[-8.0, 0.0]);
    // Radii between two ends grow by the same factor: 1, 4, 16.
    let (grown, _) = ring("OUTRAD\n16 /\nDTHETAV\n4*90 /\n");
    near(&[grown.coord[6], grown.coord[12]], &[4.0, 16.0]);
    let lacking = "RUNSPEC\nRADIAL\nDIMENS\n1 1 1 /\nDR\n1 /\nDTHETA\n360 /\nDZ\n1 /\nTOPS\n1 /\n";
    err(lacking, "a radial one needs DIMENS, INRAD");
}

#[test]
fn ok_radial_corner_points() {
    // One cell from radius 1 to 2 and from 0 to 90 degrees.
    let pillars = "1 0 0 1 0 1  2 0 0 2 0 1  1 90 0 1 90 1  2 90 0 2 90 1";
    let start = CELL.find("0 0 0 0 0 1").unwrap();
    let end = CELL.find(" /\nZCORN").unwrap();
    let deck = format!("{}{pillars}{}", &CELL[..start], &CELL[end..]);
    let (grid, warning) = warned(&deck.replace("1 1 1 1 F", "1 1 1 1 T"));
    assert!(warning.contains("radial"), "{warning}");
    assert!(grid.coord[18].abs() < 1e-15 && grid.coord[19] == 2.0);
    assert_eq!(ok(&deck).coord[18..20], [2.0, 90.0]);
}

/// A deck of dual porosity, 1 x 1 cells in two layers of matrix and two of fractures.
fn dual(text: &str) -> String {
    format!("RUNSPEC\nDUALPORO\nOIL\nDIMENS\n1 1 4 /\nGRID\n{text}")
}

#[test]
fn ok_dual_porosity_shows_the_matrix() {
    let corners = |zcorn: &str| {
        format!(
            "SPECGRID\n1 1 4 1 F /\nCOORD\n0 0 0 0 0 1  1 0 0 1 0 1  0 1 0 0 1 1  1 1 0 1 1 1 /\nZCORN\n{zcorn} /\n"
        )
    };
    let both = "4*0 8*1 4*2 4*0 8*1 4*2";
    for zcorn in [both, "4*0 8*1 4*2"] {
        let grid = ok(&dual(&format!(
            "{}PORO\n0.1 0.2 0.3 0.4 /\nPERMX\n2*5 2*500 /\nACTNUM\n1 0 1 1 /\nFAULTS\n F 1 1 1 1 1 4 X /\n G 1 1 1 1 3 4 X /\n/\n",
            corners(zcorn)
        )));
        assert_eq!(grid.porosity_model, PorosityModel::Dual);
        assert_eq!(grid.dims, [1, 1, 2]);
        assert_eq!(grid.zcorn.len(), 16);
        // The matrix, then the fractures.
        assert_eq!(property(&grid, "PORO"), [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(property(&grid, "PERMX"), [5.0, 5.0, 500.0, 500.0]);
        // Both, and the fracture alone.
        assert_eq!(grid.actnum, Some(vec![3, 2]));
        assert_eq!((grid.faults.len(), grid.faults[0].k), (1, [1, 2]));
    }
    // Without the word the same text is four layers.
    let single = ok(&dual(&corners(both)).replace("DUALPORO\n", ""));
    assert_eq!((single.dims, single.actnum), ([1, 1, 4], None));
    // Sizes of the matrix alone.
    let blocks = dual(
        "DPGRID\nDX\n2*10 /\nDY\n2*10 /\nDZ\n5 6 /\nTOPS\n100 /\nBOX\n1 1 1 1 3 4 /\nPERMX\n7 8 /\nENDBOX\n",
    );
    let grid = ok(&blocks);
    assert_eq!(grid.zcorn[12..], [111.0; 4]);
    assert_eq!(grid.actnum, Some(vec![3, 3]));
    // Sizes are those of the matrix, and fractures that are given nothing have what the matrix has, by DPGRID alone.
    assert_eq!(property(&grid, "DX"), [10.0, 10.0]);
    let shared = blocks.replace("ENDBOX", "ENDBOX\nPORO\n0.1 0.2 /");
    assert_eq!(property(&ok(&shared), "PORO"), [0.1, 0.2, 0.1, 0.2]);
    let own = shared.replace("DPGRID\n", "");
    assert_eq!(property(&ok(&own), "PORO"), [0.1, 0.2]);
    // A box may reach over both halves.
    let across = own.replace(
        "ENDBOX",
        "EQUALS\nPERMZ 3 1 1 1 1 2 3 /\n/\nCOPY\nPERMZ PERMY 1 1 1 1 2 3 /\n/",
    );
    let values = ok(&across);
    let values = property(&values, "PERMY");
    assert!(values[0].is_nan() && values[1..3] == [3.0, 3.0] && values[3].is_nan());
    assert!(!own.contains("NODPPM") && !ok(&own).has_effective_fractures);
    assert!(ok(&own.replace("DUALPORO", "DUALPORO\nNODPPM")).has_effective_fractures);
    let odd = blocks.replace("1 1 4 /", "1 1 3 /");
    err(&odd, "DIMENS: 3 layers of dual porosity");
}

#[test]
fn ok_activity_of_a_grid_file_is_changed() {
    let mut out = RecordWriter::new(Vec::new());
    out.inte("GRIDHEAD", &[1, 2, 1, 1]).unwrap();
    out.real("COORD", &[0.5; 36]).unwrap();
    out.real("ZCORN", &[1.5; 16]).unwrap();
    out.inte("ACTNUM", &[0, 1]).unwrap();
    let egrid = out.finish().unwrap();
    let read = |text: &str| {
        let deck = format!("GDFILE\n 'A.EGRID' /\n{text}");
        let files = [("A.DATA", deck.into_bytes()), ("A.EGRID", egrid.clone())];
        let files = MemoryFiles::from_iter(files);
        let mut warnings = Warnings::default();
        let grid = Grdecl::read_from(&files, Path::new("A.DATA"), &[], &mut warnings);
        grid.unwrap().actnum.unwrap()
    };
    assert_eq!(read(""), [0, 1]);
    assert_eq!(read("EQUALS\n ACTNUM 0 2 2 1 1 1 1 /\n/\n"), [0, 0]);
    assert_eq!(read("ACTNUM\n2*1 /\n"), [1, 1]);
}

#[test]
fn ok_depths_are_shifted() {
    let grid = ok(&cube(
        "ADDZCORN\n 5 1 1 1 2 1 2 /\n 1 1 2 1 2 2 2 4* ALL /\n/\n",
    ));
    assert_eq!(grid.zcorn[..4], [5.0, 5.0, 0.0, 0.0]);
    assert_eq!(grid.zcorn[60..], [8.0, 8.0, 3.0, 3.0]);
    for more in ["5 1 1 1 2 1 2 1 1 /", "5 1 1 1 2 1 2 4* TOP /"] {
        let (grid, warning) = warned(&cube(&format!("ADDZCORN\n {more}\n/\n")));
        assert_eq!(grid.zcorn[0], 0.0);
        assert!(warning.contains("ADDZCORN with more than"), "{warning}");
    }
    let (grid, warning) = warned(&cube("ADDZCORN\n 5 1 3 1 2 1 2 /\n/\n"));
    assert!(
        grid.zcorn[0] == 0.0 && warning.contains("box is outside"),
        "{warning}"
    );
}

#[test]
fn ok_local_grids() {
    // Two cells side by side, of 10 m and 20 m along x.
    let text = |local: &str| {
        format!(
            "RUNSPEC\nDIMENS\n2 1 2 /\nGRID\nDXV\n10 20 /\nDYV\n10 /\nDZV\n4 6 /\nTOPS\n2*100 /\n\
             PORO\n0.1 0.2 0.3 0.4 /\nMULTZ\n4*0.5 /\nACTNUM\n1 1 0 1 /\n{local}\nPERMX\n1 2 3 4 /\n"
        )
    };
    let carfin = "CARFIN\n'fine' 1 2 1 1 1 2 5 2 2 10 /\nNXFIN\n 3 2 /\nHXFIN\n 1 1 2 2* /\nPERMX\n 20*9 /\n\
                  BOX\n 1 5 1 1 1 1 /\nNTG\n 5*0.7 /\nENDBOX\nEQUALS\n PORO 0.5 2 3 2 2 1 1 /\n/\nENDFIN\n\
                  REFINE\n 'FINE' /\nMULTIPLY\n PORO 2 5 5 1 2 2 2 /\n/\nENDFIN\n";
    let (grid, warning) = warned(&text(carfin));
    assert_eq!(warning.lines().count(), 1, "{warning}");
    assert!(
        warning.contains("MULTZ of local grid FINE are not those"),
        "{warning}"
    );
    let [fine] = grid.local_grids.as_slice() else {
        panic!("one local grid");
    };
    assert_eq!(
        (fine.grid.name.as_str(), fine.grid.dims),
        ("FINE", [5, 2, 2])
    );
    // Four parts of the first host, in proportion 1 : 1 : 2, and two of the second.
    let x: Vec<f64> = (0..6).map(|i| fine.grid.coord[6 * i]).collect();
    assert_eq!(x, [0.0, 2.5, 5.0, 10.0, 20.0, 30.0]);
    assert_eq!(fine.grid.zcorn[..10], [100.0; 10]);
    assert_eq!(fine.grid.zcorn[20..30], [100.0; 10]);
    assert_eq!(fine.grid.zcorn[40..60], [104.0; 20]);
    assert_eq!(fine.grid.host[..5], [1, 1, 1, 2, 2]);
    let active = [vec![1; 10], [0, 0, 0, 1, 1].repeat(2)].concat();
    assert_eq!(fine.grid.actnum.as_deref(), Some(active.as_slice()));
    let values = |name: &str| {
        let found = fine.properties.iter().find(|p| p.name == name);
        found.unwrap().values.as_slice()
    };
    assert_eq!(
        values("PORO")[..10],
        [0.1, 0.1, 0.1, 0.2, 0.2, 0.1, 0.5, 0.5, 0.2, 0.2]
    );
    assert_eq!(values("PORO")[10..15], [0.3, 0.3, 0.3, 0.4, 0.8]);
    // Its own, though those of the main grid stand behind them.
    assert_eq!(values("PERMX"), [9.0; 20]);
    assert_eq!((values("NTG")[4], values("NTG")[5]), (0.7, 1.0));
    assert!(fine.properties.iter().all(|p| p.name != "MULTZ"));
    // The main grid knows nothing of it.
    assert_eq!(property(&grid, "PERMX"), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(property(&grid, "PORO"), [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(ok(&text("")).local_grids, []);
    // A grid in a grid.
    let nested = format!("{carfin}CARFIN\nIN 4 5 1 2 1 1 2 4 3 1* FINE /\nENDFIN\n");
    let (grid, _) = warned(&text(&nested));
    let inner = &grid.local_grids[1].grid;
    assert_eq!((inner.parent.as_str(), inner.dims), ("FINE", [2, 4, 3]));
    assert_eq!(inner.host[..8], [4, 5, 4, 5, 9, 10, 9, 10]);
    // A third of the first layer.
    assert!((inner.zcorn[32] - (100.0 + 4.0 / 3.0)).abs() < 1e-12);
    assert_eq!((inner.coord[0], inner.coord[12]), (10.0, 30.0));
}

#[test]
fn ok_local_grids_that_are_left_out() {
    let first = "CARFIN\nA 1 2 1 1 1 1 4 2 2 /\nENDFIN\n";
    for (text, told, count) in [
        (
            "CARFIN\nA 1 5 1 1 1 1 5 1 1 /\nENDFIN\n".to_owned(),
            "its box is outside",
            0,
        ),
        (
            "CARFIN\nA 1 2 1 1 1 1 3 1 1 /\nENDFIN\n".to_owned(),
            "3 cells are not shared evenly among 2",
            0,
        ),
        (
            first.replace("ENDFIN", "NXFIN\n2 1 /\nENDFIN"),
            "NXFIN needs numbers of cells that are 4",
            0,
        ),
        (
            first.replace("ENDFIN", "NXFIN\n2 /\nENDFIN"),
            "NXFIN: expected 2 values",
            0,
        ),
        (
            first.replace("ENDFIN", "HYFIN\n1 0 /\nENDFIN"),
            "HYFIN needs sizes above 0",
            0,
        ),
        (
            format!("{first}CARFIN\nB 2 3 1 1 1 1 2 1 1 /\nENDFIN\n"),
            "it refines cells that A refines",
            1,
        ),
        (
            format!("{first}CARFIN\nA 3 3 1 1 1 1 2 1 1 /\nENDFIN\n"),
            "there is a local grid 'A' already",
            1,
        ),
        (
            format!("{first}CARFIN\nB 1 1 1 1 1 1 2 1 1 1* C /\nENDFIN\n"),
            "there is no grid C before it",
            1,
        ),
        (
            first.replace("4 2 2", "40000 200 200"),
            "more cells than the length of the deck",
            0,
        ),
        (first.replace("1 1 4", "1"), "CARFIN needs a name", 0),
        (
            format!("{first}REFINE\nB /\nPORO\n4*0.9 /\nENDFIN\n"),
            "is called 'B'",
            1,
        ),
        (
            first.replace("ENDFIN", "DX\n16*1 /\nENDFIN"),
            "DX of local grid A is not read",
            1,
        ),
        (
            first.replace("ENDFIN", "FAULTS\n F 1 1 1 1 1 1 X /\n/\nENDFIN"),
            "FAULTS of local grids",
            1,
        ),
    ] {
        check_told(&text, told, count);
    }
}

#[test]
fn ok_radial_local_grids_that_are_left_out() {
    for (text, told, count) in [
        (
            "RADFIN\nR 1 1 1 1 3 4 /\nINRAD\n1 /\nENDFIN\n",
            "RADFIN needs a name",
            0,
        ),
        (
            "RADFIN\nR 1 1 1 1 3 4 1 /\nDRV\n0.1 0.1 0.1 /\nENDFIN\n",
            "INRAD, the radius of its innermost ring, is missing",
            0,
        ),
        (
            "RADFIN\nR 1 1 1 1 3 4 1 1* 0.1 0.05 /\nENDFIN\n",
            "OUTRAD 0.05 must be above INRAD 0.1",
            0,
        ),
        (
            "RADFIN\nR 1 1 1 1 3 4 1 1* 0.1 /\nENDFIN\n",
            "has neither DRV nor OUTRAD",
            1,
        ),
        (
            "RADFIN\nR 1 1 1 1 3 4 1 1* 0.1 /\nDRV\n0.3 0.3 0.3 /\nENDFIN\n",
            "its outermost ring begins at a radius of 0.7",
            0,
        ),
        (
            "RADFIN\nR 1 1 1 1 2 2 1 1* 0.1 0.3 /\nDTHETAV\n90 180 /\nENDFIN\n",
            "its sectors have 270 degrees",
            0,
        ),
        (
            "RADFIN4\nR 1 2 1 1 1 1 2 4 1 /\nINRAD\n0.1 /\nENDFIN\n",
            "RADFIN4 refines two columns along I and two along J",
            0,
        ),
        (
            "RADFIN\nR 1 1 1 1 2 2 1 1* 0.1 0.3 /\nDR\n2*0.1 0.1 0.2 /\nENDFIN\n",
            "DR is not the same for all cells",
            0,
        ),
        (
            "RADFIN\nR 1 1 1 1 2 2 1 1* 0.1 0.3 /\nNXFIN\n2 /\nENDFIN\n",
            "NXFIN is not used",
            1,
        ),
        (
            "RADFIN\nR 1 1 1 1 2 2 1 1* 0.1 0.3 /\nDZ\n4*1 /\nENDFIN\n",
            "DZ of local grid R is not read: its rings",
            1,
        ),
        (
            "RADFIN\nR 1 1 1 1 2 2 1 1* 0.1 0.3 /\nENDFIN\nCARFIN\nB 1 1 1 1 1 1 2 1 1 1* R /\nENDFIN\n",
            "it refines a radial grid",
            1,
        ),
    ] {
        check_told(text, told, count);
    }
}

/// Four cells with local grids of a text, of which something is told and so many are left.
fn check_told(text: &str, told: &str, count: usize) {
    let blocks = "DIMENS\n4 1 1 /\nDXV\n4*1 /\nDYV\n1 /\nDZV\n1 /\nTOPS\n4*0 /\n";
    let (grid, warning) = warned(&format!("{blocks}{text}PORO\n4*0.2 /\n"));
    assert!(warning.contains(told), "{text}: {warning}");
    assert_eq!(grid.local_grids.len(), count, "{text}");
    // What is not for the main grid does not reach it.
    assert_eq!(property(&grid, "PORO"), [0.2; 4], "{text}");
    assert!(grid.faults.is_empty() && grid.dims == [4, 1, 1], "{text}");
}

#[test]
fn ok_radial_local_grids() {
    // Columns of 10 m by 10 m, of which the second along I has other values.
    let text = |local: &str| {
        format!(
            "DIMENS\n3 2 2 /\nDXV\n3*10 /\nDYV\n2*10 /\nDZV\n4 6 /\nTOPS\n6*100 /\n\
             PORO\n12*0.1 /\nEQUALS\n PORO 0.2 2 2 1 1 1 2 /\n/\n{local}"
        )
    };
    let one = "RADFIN\n'WELL' 2 1 1 2 3 4 4 1* 0.5 /\nDRV\n 0.5 1 9 /\nDTHETAV\n 45 135 2*90 /\n\
               EQUALS\n PORO 0.5 1 3 2 2 1 1 /\n/\nENDFIN\n";
    let grid = ok(&text(one));
    let well = &grid.local_grids[0];
    assert!(well.grid.is_radial && well.grid.dims == [3, 4, 4]);
    // The outermost ring is as large as its column, though the deck says more.
    let radii: Vec<f64> = (0..4).map(|i| well.grid.coord[6 * i]).collect();
    let outermost = (100.0 / std::f64::consts::PI).sqrt();
    assert_eq!(radii, [0.5, 1.0, 2.0, outermost]);
    let angles: Vec<f64> = (0..5).map(|j| well.grid.coord[24 * j + 1]).collect();
    assert_eq!(angles, [0.0, 45.0, 180.0, 270.0, 360.0]);
    // Two layers in each host of 4 and 6 m.
    let depths: Vec<f64> = (0..8).map(|plane| well.grid.zcorn[48 * plane]).collect();
    assert_eq!(
        depths,
        [100.0, 102.0, 102.0, 104.0, 104.0, 107.0, 107.0, 110.0]
    );
    assert_eq!((well.grid.host[0], well.grid.host[47]), (2, 8));
    let values = |p: &DeckProperty| (p.name == "PORO").then(|| p.values.clone());
    let porosity = well.properties.iter().find_map(values).unwrap();
    assert_eq!(porosity[..7], [0.2, 0.2, 0.2, 0.5, 0.5, 0.5, 0.2]);
    // By sizes of cells, and with the factor from ring to ring that two radii leave.
    let sizes = one.replace("DRV\n 0.5 1 9", &format!("DR\n {}", "0.5 1 9 ".repeat(16)));
    assert_eq!(ok(&text(&sizes)).local_grids[0].grid, well.grid);
    let growing = one.replace("DRV\n 0.5 1 9", "OUTRAD\n 13.5");
    let growing = &ok(&text(&growing)).local_grids[0].grid;
    assert!((growing.coord[6] - 1.5).abs() < 1e-12 && (growing.coord[12] - 4.5).abs() < 1e-12);
    // Around the pillar between four columns: I + and J - first.
    let four = "RADFIN4\n'FOUR' 2 3 1 2 1 1 2 8 1 /\nINRAD\n 1 /\nOUTRAD\n 9 /\nENDFIN\n";
    let four = &ok(&text(four)).local_grids[0].grid;
    let hosts: Vec<i32> = four.host.iter().step_by(2).copied().collect();
    assert_eq!(hosts, [3, 3, 2, 2, 5, 5, 6, 6]);
    assert!((four.coord[12] - (400.0 / std::f64::consts::PI).sqrt()).abs() < 1e-12);
}

#[test]
fn ok_local_grids_of_dual_porosity() {
    // Two layers of matrix above two of fractures.
    let text = |local: &str| {
        format!(
            "RUNSPEC\nDUALPORO\nDIMENS\n2 1 4 /\nGRID\nDXV\n2*10 /\nDYV\n10 /\nDZV\n2*4 2*4 /\nTOPS\n4*100 4*100 /\n\
             PORO\n0.1 0.2 0.3 0.4 0.01 0.02 0.03 0.04 /\nACTNUM\n7*1 0 /\n{local}"
        )
    };
    let carfin = "CARFIN\nA 2 2 1 1 1 2 2 1 8 /\nEQUALS\n PORO 0.9 1 1 1 1 8 8 /\n/\nENDFIN\n";
    let (grid, warning) = warned(&text(carfin));
    assert_eq!(warning.lines().count(), 1, "{warning}");
    assert!(
        warning
            .contains("the 8 layers of local grid A are taken for 4 of matrix and 4 of fractures"),
        "{warning}"
    );
    let fine = &grid.local_grids[0];
    assert_eq!((fine.grid.dims, fine.grid.zcorn.len()), ([2, 1, 4], 64));
    assert_eq!(fine.grid.host, [2, 2, 2, 2, 4, 4, 4, 4]);
    let values = |p: &DeckProperty| (p.name == "PORO").then(|| p.values.clone());
    let porosity = fine.properties.iter().find_map(values).unwrap();
    let matrix = [0.2, 0.2, 0.2, 0.2, 0.4, 0.4, 0.4, 0.4];
    assert_eq!(porosity[..8], matrix);
    assert_eq!(
        porosity[8..],
        [0.02, 0.02, 0.02, 0.02, 0.04, 0.04, 0.9, 0.04]
    );
    // The matrix alone where the host has no fracture.
    assert_eq!(fine.grid.actnum, Some(vec![3, 3, 3, 3, 1, 1, 1, 1]));
    // The same text of single porosity has eight layers.
    let (single, _) = warned(&text(carfin).replace("DUALPORO\n", ""));
    assert_eq!(single.local_grids[0].grid.dims, [2, 1, 8]);
    for (wrong, told) in [
        (
            carfin.replace("1 2 2 1 8", "1 2 2 1 7"),
            "7 layers of dual porosity",
        ),
        (
            carfin.replace("1 2 2 1 8", "3 4 2 1 8"),
            "outside the matrix",
        ),
    ] {
        let (grid, warning) = warned(&text(&wrong));
        assert!(
            warning.contains(told) && grid.local_grids.is_empty(),
            "{warning}"
        );
    }
    // Fractures that are given nothing have what their matrix has, by DPGRID alone.
    let own = text(&carfin.replace("CARFIN", "PERMX\n4*5 /\nCARFIN"));
    let values = |text: &str| {
        let (grid, _) = warned(text);
        let values = |p: &DeckProperty| (p.name == "PERMX").then(|| p.values.clone());
        let found = grid.local_grids[0].properties.iter().find_map(values);
        found.unwrap()
    };
    assert_eq!(values(&own), [5.0; 8]);
    assert_eq!(values(&own.replace("GRID\n", "GRID\nDPGRID\n")), [5.0; 16]);
}

#[test]
fn ok_files_with_a_mark_of_their_encoding() {
    let text = [b"\xef\xbb\xbf", cell("PORO\n0.5 /\n").as_bytes()].concat();
    let (grid, warnings) = read_bytes(&text);
    assert_eq!((names(&grid.unwrap()), warnings.len()), (vec!["PORO"], 0));
}

#[test]
fn ok_dimensions_without_the_number_of_coordinate_systems() {
    for dims in [
        "1 1 1 F",
        "1 1 1  F  ",
        "1 1 1",
        "1 1 1 1",
        "1 1 1 1*",
        "1 1 1 1* F",
    ] {
        assert_eq!(ok(&CELL.replace("1 1 1 1 F", dims)).dims, [1; 3], "{dims}");
    }
}

#[test]
fn ok_odd_decks_are_warned_about() {
    for (text, expected) in [
        ("PORO\n2*0.5 /\n", "PORO has 2 values for 1 cells"),
        ("PORO\n0.5 /\nPORO\n0.6 /\n", "PORO is given again"),
        ("NOECHO\n12 abc\n", "belongs to no keyword"),
        (
            "GDFILE\n'X.EGRID' U /\n",
            "GDFILE is not read: the deck has COORD",
        ),
        (
            "IMPORT\n'X.GRDECL' /\n",
            "IMPORT was not read, so its arrays are missing: X.GRDECL: cannot open",
        ),
        ("some text at the end", "no closing /"),
        ("DIMENS\n2 2 2 /\n", "SPECGRID is followed"),
    ] {
        let (grid, warning) = warned(&cell(text));
        assert_eq!(grid.dims, [1, 1, 1]);
        assert!(warning.contains(expected), "{warning}");
    }
}

// --- errors ---

#[test]
fn err_wrong_counts() {
    err(
        &CELL.replace("4*0 4*1", "4*0 3*1"),
        "TEST.GRDECL:6:9: ZCORN: expected 8 values, found 7",
    );
    err(
        &CELL.replace("4*0 4*1", "4*0 5*1"),
        "ZCORN: expected 8 values, found 9",
    );
    err(
        &CELL.replace("4*0 4*1", "999999999999999*1"),
        "expected 8 values, found 999999999999999",
    );
    err(
        &CELL.replace("4*0 4*1", "18446744073709551615*1 18446744073709551615*1"),
        "expected 8 values, found 18446744073709551615",
    );
    err(
        &CELL.replace("4*0 4*1", "99999999999999999999*1"),
        "impossible repeat count",
    );
    err(&CELL.replace("4*0 4*1", "0*1"), "impossible repeat count");
}

#[test]
fn err_wrong_values() {
    err(
        &CELL.replace("4*0 4*1", "4*0 4*1x"),
        "TEST.GRDECL:6:5: ZCORN: '1x' is not a number",
    );
    err(
        &CELL.replace("4*0 4*1", "4*0 4*"),
        "a defaulted value (*) is not allowed here",
    );
    err(
        &CELL.replace("4*0 4*1", "7*0 nan"),
        "'nan' is not a finite number",
    );
    err(
        &CELL.replace("4*0 4*1", "7*0 1e999"),
        "'1e999' is not a finite number",
    );
    err(
        &cell("PORO\n0.2x5 /\n"),
        "TEST.GRDECL:8:1: PORO: '0.2x5' is not a number",
    );
    err(
        &cell("ACTNUM\n0.5 /\n"),
        "ACTNUM: the value 0.5 of cell 1 is not 0",
    );
    err(
        &cell("MAPAXES\n1 2 3 4 5 /\n"),
        "MAPAXES: expected 6 values, found 5",
    );
    err(&cell("MAPAXES\n1 2 3 4 5 z /\n"), "'z' is not a number");
}

#[test]
fn err_missing_slash() {
    err(
        &CELL.replace("1 1 1 /\nZCORN", "1 1 1\nZCORN"),
        "TEST.GRDECL:5:1: COORD: 'ZCORN' is not a number; is the closing / of COORD missing?",
    );
    err(
        CELL.trim_end().trim_end_matches('/'),
        "ZCORN: the file ends before the closing /",
    );
    err(
        &cell("PORO\n0.5\n"),
        "PORO: the file ends before the closing /",
    );
    err(
        &cell("MYPROP\n0.5\nACTNUM\n1 /\n"),
        "is the closing / of MYPROP missing?",
    );
}

#[test]
fn err_missing_keywords() {
    let parts: Vec<&str> = CELL.split_inclusive("/\n").collect();
    let without = |index: usize| {
        parts
            .iter()
            .enumerate()
            .filter(|part| part.0 != index)
            .map(|part| *part.1)
            .collect::<String>()
    };
    err(
        &without(0),
        "no grid: SPECGRID (or DIMENS) is missing: open the file",
    );
    err(&without(1), "no grid: COORD is missing");
    err(&without(2), "no grid: ZCORN is missing");
    err("", "SPECGRID (or DIMENS), COORD, ZCORN are missing");
    err(
        "DIMENS\n1 1 1 /\nDX\n100 /\nDY\n100 /\nDZ\n1 /\n",
        "no grid: a block-centered one needs DIMENS, DX (or DXV)",
    );
    err("PORO\n0.5 /\n", "has PORO but no grid");
    err("FAULTS\nA 1 1 1 1 1 1 X /\n/\n", "has FAULTS but no grid");
    err(
        "DIMENS\n1 1 1 /\nDR\n1 /\nDTHETA\n360 /\nDZ\n1 /\nTOPS\n1 /\n",
        "no grid: a radial one needs DIMENS, INRAD, DR",
    );
}

#[test]
fn err_dimensions() {
    let with = |dims: &str| CELL.replace("1 1 1 1 F", dims);
    err(
        &with("-1 1 1"),
        "TEST.GRDECL:2:1: SPECGRID: expected a whole number of at least 1, found '-1'",
    );
    err(&with("1 0 1"), "found '0'");
    err(&with("1 1"), "expected three numbers of cells");
    err(&with("1* 1 1"), "found '*'");
    err(&with("1 1 1 2 F"), "NUMRES");
    err(&with("99999 99999 99999"), "more than a grid can have");
    err(
        &with("18446744073709551615 2 2"),
        "more than a grid can have",
    );
    err(&with("18446744073709551616 2 2"), "whole number");
    err(&with("1290 1290 1290"), "cannot be described by 1");
    err(&with("2 1 1"), "COORD: expected 36 values, found 24");
}

#[test]
fn err_binary_file() {
    let error = read_bytes(b"\0\0\0\x10FILEHEAD").0.unwrap_err().to_string();
    assert!(error.contains("binary"), "{error}");
}

// --- includes ---

fn write_all(files: &[(&str, String)]) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = directory.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    directory
}

#[test]
fn ok_includes_quoted_bare_aliased_and_nested() {
    let directory = write_all(&[
        ("model/MAIN.DATA", "PATHS\n'GRIDS' '../include/grid' /\n/\nINCLUDE\n '$GRIDS/cell.grid' /\nINCLUDE\n../include/poro.inc /\nINCLUDE ..\\include\\ntg.inc/ comment\n".into()),
        ("include/grid/cell.grid", format!("{CELL}INCLUDE\n beside.inc /\n")),
        ("include/grid/beside.inc", "PERMX\n7 /\nENDINC\nnot read".into()),
        ("include/poro.inc", "PORO\n0.5 /".into()),
        ("include/ntg.inc", "NTG\n1 /".into()),
    ]);
    let (grid, warnings) = read(&directory.path().join("model/MAIN.DATA"));
    let grid = grid.unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(names(&grid), ["PERMX", "PORO", "NTG"]);
    let files: Vec<_> = grid
        .files
        .iter()
        .map(|file| file.file_name().unwrap().to_str().unwrap())
        .collect();
    assert_eq!(
        files,
        [
            "MAIN.DATA",
            "cell.grid",
            "beside.inc",
            "poro.inc",
            "ntg.inc"
        ]
    );
}

#[test]
fn ok_imported_files() {
    let values = |out: &mut RecordWriter<Vec<u8>>| {
        out.real("PORO", &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8])?;
        out.inte("SATNUM", &[1, 1, 1, 1, 2, 2, 2, 2])?;
        out.chars("NAMES", &["A"])
    };
    let written = |mut out: RecordWriter<Vec<u8>>| {
        values(&mut out).unwrap();
        out.finish().unwrap()
    };
    let (binary, text) = (
        written(RecordWriter::new(Vec::new())),
        written(RecordWriter::formatted(Vec::new())),
    );
    let read = |text: &str, files: Vec<(&str, Vec<u8>)>| {
        let deck = ("model/A.DATA", cube(text).into_bytes());
        let files = MemoryFiles::from_iter(files.into_iter().chain([deck]));
        let mut warnings = Warnings::default();
        let grid = Grdecl::read_from(&files, Path::new("model/A.DATA"), &[], &mut warnings);
        let said: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        (grid.unwrap(), said.join("\n"))
    };
    let deck = "PATHS\n'P' '..\\Props' /\n/\nIMPORT\n '$P\\arrays.bin' FORM /\nEQUALS\n PORO 0.9 1 1 1 1 1 1 /\n/\n";
    for (form, bytes) in [("UNFORMATTED", &binary), ("FORMATTED", &text)] {
        let deck = deck.replace("FORM", form);
        let (grid, warning) = read(&deck, vec![("props/ARRAYS.BIN", bytes.clone())]);
        assert_eq!(warning, "");
        let poro: Vec<_> = property(&grid, "PORO").iter().map(|v| *v as f32).collect();
        assert_eq!(poro, [0.9, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]);
        assert_eq!(property(&grid, "SATNUM")[3..5], [1.0, 2.0]);
        assert_eq!(names(&grid), ["PORO", "SATNUM"]);
        assert_eq!(grid.files.len(), 2);
    }
    // One that ends within an array, one of another number of cells, and one of text.
    let cut = binary[..binary.len() - 9].to_vec();
    let (grid, warning) = read(deck, vec![("props/arrays.bin", cut)]);
    assert_eq!(names(&grid), ["PORO"]);
    assert!(warning.contains("IMPORT was not read"), "{warning}");
    let mut out = RecordWriter::new(Vec::new());
    out.real("PORO", &[0.5; 7]).unwrap();
    let (_, warning) = read(deck, vec![("props/arrays.bin", out.finish().unwrap())]);
    assert!(
        warning.contains("PORO has 7 values for 8 cells"),
        "{warning}"
    );
    let (grid, _) = read(deck, vec![("props/arrays.bin", b"NTG\n8*0.5 /\n".to_vec())]);
    assert_eq!(names(&grid), ["NTG", "PORO"]);
    // A grid in a file.
    let mut out = RecordWriter::new(Vec::new());
    let pillars = [[0.0_f32, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let coord = pillars.map(|[x, y]| [x, y, 0.0, x, y, 1.0]).concat();
    out.real("COORD", &coord).unwrap();
    out.real("ZCORN", &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
        .unwrap();
    let files = [
        ("A", b"DIMENS\n1 1 1 /\nIMPORT\n 'G' /\n".to_vec()),
        ("G", out.finish().unwrap()),
    ];
    let files = MemoryFiles::from_iter(files);
    let grid = Grdecl::read_from(&files, Path::new("A"), &[], &mut Warnings::default());
    assert_eq!(grid.unwrap().coord, ok(CELL).coord);
}

#[test]
fn err_includes() {
    let directory = write_all(&[
        ("A", "\nINCLUDE\n 'B' /\n".into()),
        ("B", "INCLUDE\n 'A' /\n".into()),
        ("C", "INCLUDE\n 'no such' /\n".into()),
        ("D", "INCLUDE\n 'E' /\n".into()),
        ("E", format!("{CELL}PORO\nx5 0.x /\nPERMX\n 1x /\n")),
        ("F", "INCLUDE\n /\n".into()),
    ]);
    let message = |name: &str| {
        read(&directory.path().join(name))
            .0
            .unwrap_err()
            .to_string()
    };
    assert!(
        message("A").contains("includes itself") && message("A").contains("A:2)"),
        "{}",
        message("A")
    );
    assert!(
        message("C").contains("C:2:2: INCLUDE: 'no such' was not found; looked for "),
        "{}",
        message("C")
    );
    assert!(
        message("D").contains("E:10:2: PERMX: '1x' is not a number (included from ")
            && message("D").ends_with("D:1)"),
        "{}",
        message("D")
    );
    assert!(
        message("F").contains("expected the path"),
        "{}",
        message("F")
    );
    assert!(message("no such").contains("cannot open"));
}

// --- numbers ---

#[test]
fn numbers_equal_the_standard_library_bit_by_bit() {
    let mut random = fastrand::Rng::with_seed(20_240_229);
    let (mut text, mut expected) = (String::new(), Vec::new());
    let count = 1_000_000;
    for index in 0..count {
        let token = random_number(&mut random);
        expected.push(token.replace(['d', 'D'], "e").parse::<f64>().unwrap());
        text.push_str(&token);
        text.push_str(if index % 6 == 5 { "\n" } else { "  " });
    }
    let spec = CELL
        .replace("1 1 1 1 F", &format!("{count} 1 1"))
        .replace("4*0 4*1", "8000000*1");
    let coord = format!("COORD\n{}*1 /", 12 * (count + 1));
    let start = spec.find("COORD").unwrap();
    let end = spec.find("ZCORN").unwrap();
    let deck = format!("{}{coord}\n{}PROP\n{text}/\n", &spec[..start], &spec[end..]);
    let grid = ok(&deck);
    let values = property(&grid, "PROP");
    let equal = |(value, expected): (&f64, &f64)| value.to_bits() == expected.to_bits();
    assert!(values.iter().zip(&expected).all(equal));
    // The comparison sees a difference in the last bit.
    assert!(!equal((
        &values[0],
        &f64::from_bits(expected[0].to_bits() ^ 1)
    )));
}

fn random_number(random: &mut fastrand::Rng) -> String {
    let digits = |random: &mut fastrand::Rng, most: usize| -> String {
        let count = random.usize(1..=most);
        (0..count)
            .map(|_| char::from(random.u8(b'0'..=b'9')))
            .collect()
    };
    let sign = ["", "", "-", "+"][random.usize(..4)];
    let whole = digits(random, 9);
    let fraction = digits(random, 8);
    match random.u8(..8) {
        0 => format!("{sign}{whole}"),
        1 => format!("{sign}.{fraction}"),
        2 => format!("{sign}{whole}."),
        3 => format!("{sign}0.{}{fraction}", digits(random, 16)),
        4 => format!("{sign}{whole}.{fraction}E{:+03}", random.i32(-30..30)),
        5 => format!(
            "{sign}{whole}.{fraction}{}{}",
            ["D", "d", "e"][random.usize(..3)],
            random.i32(-280..280)
        ),
        6 => format!("{:e}", f64::from_bits(random.u64(..0x7ff0_0000_0000_0000))),
        _ => format!("{sign}{whole}.{fraction}"),
    }
}

// --- real decks ---

/// Compares a deck with `oracle.json`: dimensions, activity, map axes, units, orientation, properties.
fn check_facts(grid: &Grdecl, facts: &serde_json::Value) -> Result<(), String> {
    let same = |what: &str, found: String, expected: String| {
        if found == expected {
            Ok(())
        } else {
            Err(format!("{what}: {found} instead of {expected}"))
        }
    };
    let words = |value: &serde_json::Value| -> Option<Vec<String>> {
        Some(
            value
                .as_array()?
                .iter()
                .map(|word| word.as_str().unwrap().to_owned())
                .collect(),
        )
    };
    let dims = ["ni", "nj", "nk"]
        .map(|axis| usize::try_from(facts["grid"][axis].as_u64().unwrap()).unwrap());
    same("dims", format!("{:?}", grid.dims), format!("{dims:?}"))?;
    same(
        "pillars",
        grid.coord.len().to_string(),
        (6 * (dims[0] + 1) * (dims[1] + 1)).to_string(),
    )?;
    same(
        "corners",
        grid.zcorn.len().to_string(),
        (8 * dims.iter().product::<usize>()).to_string(),
    )?;
    let total = dims.iter().product::<usize>();
    let active = grid.actnum.as_ref().map_or(total, |actnum| {
        actnum.iter().filter(|&&active| active == 1).count()
    });
    same(
        "active",
        active.to_string(),
        facts["grid"]["actnum_value_counts"]["1"].to_string(),
    )?;
    same(
        "ACTNUM",
        grid.actnum.is_some().to_string(),
        facts["grid"]["actnum_present"].to_string(),
    )?;
    let axes = words(&facts["mapaxes"]).map(|axes| {
        axes.iter()
            .map(|axis| axis.parse::<f64>().unwrap())
            .collect::<Vec<_>>()
    });
    same(
        "MAPAXES",
        format!("{:?}", grid.map_axes.map(|axes| axes.to_vec())),
        format!("{axes:?}"),
    )?;
    let unit = grid.grid_unit.as_ref().map(|unit| {
        vec![
            unit.name.clone(),
            if unit.is_map { "MAP" } else { "" }.to_owned(),
        ]
    });
    same(
        "GRIDUNIT",
        format!("{unit:?}"),
        format!("{:?}", words(&facts["gridunit"])),
    )?;
    same(
        "MAPUNITS",
        format!("{:?}", grid.map_units.clone().map(|unit| vec![unit])),
        format!("{:?}", words(&facts["mapunits"])),
    )?;
    same(
        "GDORIENT",
        format!("{:?}", grid.gdorient.clone().map(Vec::from)),
        format!("{:?}", words(&facts["gdorient"])),
    )?;
    check_properties(grid, &facts["properties_active"])?;
    check_cell(grid, &facts["cells"][0])
}

fn check_properties(grid: &Grdecl, facts: &serde_json::Value) -> Result<(), String> {
    for (name, facts) in facts.as_object().unwrap() {
        let active = |cell: usize| grid.actnum.as_ref().is_none_or(|actnum| actnum[cell] != 0);
        let values: Vec<f64> = property(grid, name)
            .iter()
            .enumerate()
            .filter(|value| active(value.0))
            .map(|value| *value.1)
            .collect();
        #[allow(clippy::cast_precision_loss, reason = "a few thousand cells")]
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let expected = facts["mean"].as_f64().unwrap();
        if (mean - expected).abs() > 1e-8 * expected.abs()
            || values.len() as u64 != facts["count"].as_u64().unwrap()
        {
            return Err(format!("{name}: mean {mean} instead of {expected}"));
        }
    }
    Ok(())
}

/// The first listed cell's corner depths, through the index of ZCORN.
fn check_cell(grid: &Grdecl, cell: &serde_json::Value) -> Result<(), String> {
    let [i, j, k] =
        [0, 1, 2].map(|axis| usize::try_from(cell["ijk"][axis].as_u64().unwrap()).unwrap() - 1);
    let [ni, nj, _] = grid.dims;
    for corner in 0..8 {
        let (di, dj, dk) = (corner % 2, corner / 2 % 2, corner / 4);
        let depth = grid.zcorn[2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * (2 * k + dk)];
        let expected = cell["corners"][corner][2].as_f64().unwrap();
        if (depth - expected).abs() > 1e-6 * expected.abs() {
            return Err(format!(
                "corner {corner}: depth {depth} instead of {expected}"
            ));
        }
    }
    Ok(())
}

#[test]
fn real_decks_have_the_facts_of_the_oracle() {
    let Some(data) = data() else { return };
    let oracle: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(data.join("oracle.json")).unwrap()).unwrap();
    let mut seen = Vec::new();
    for (name, facts) in oracle
        .as_object()
        .unwrap()
        .iter()
        .filter(|case| case.1["grdecl"] == true)
    {
        let (grid, warnings) = read(&data.join(name));
        let grid = grid.unwrap_or_else(|error| panic!("{error}"));
        check_facts(&grid, facts).unwrap_or_else(|difference| panic!("{name}: {difference}"));
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
        seen.push((grid, facts));
    }
    assert_eq!(seen.len(), 13);
    // No deck has the facts of another one.
    for (index, (grid, _)) in seen.iter().enumerate() {
        let other = seen[(index + 1) % seen.len()].1;
        assert!(check_facts(grid, other).is_err());
    }
}

#[test]
fn real_reek_deck_with_includes() {
    let Some(data) = data() else { return };
    let (grid, warnings) = read(&data.join("reek/deck/model/REEK.DATA"));
    let grid = grid.unwrap();
    assert_eq!(grid.dims, [40, 64, 14]);
    assert_eq!(grid.unit_system, Some(UnitSystem::Metric));
    // Counted in the include files: arrays by keyword and by operations, the lines of reek.faults by grep.
    assert_eq!(
        names(&grid),
        [
            "PORO", "PERMX", "PERMY", "PERMZ", "MULTZ", "SWL", "SWU", "SGCR", "SWCR", "SGU",
            "SWATINIT", "EQLNUM", "FIPNUM", "SATNUM", "PVTNUM"
        ]
    );
    let lines = fs::read_to_string(data.join("reek/deck/include/grid/reek.faults")).unwrap();
    assert_eq!(
        grid.faults.len(),
        lines.lines().filter(|line| line.starts_with("'F")).count()
    );
    assert!(warnings.is_empty(), "{warnings:#?}");
}

#[test]
fn real_spe9_deck() {
    let Some(data) = data() else { return };
    let (grid, warnings) = read(&data.join("spe9/deck/SPE9_CP.DATA"));
    let grid = grid.unwrap();
    assert_eq!(grid.dims, [24, 25, 15]);
    assert_eq!(grid.unit_system, Some(UnitSystem::Field));
    assert_eq!(names(&grid), ["PORO", "PERMX", "PERMY", "PERMZ"]);
    assert_eq!(property(&grid, "PORO")[8999], 0.157);
    let [x, z] = ["PERMX", "PERMZ"].map(|name| property(&grid, name)[4321]);
    assert!((z / x - 0.01).abs() < 1e-12);
    assert!(warnings.is_empty(), "{warnings:#?}");
}

#[test]
fn real_block_centered_decks() {
    let Some(data) = data() else { return };
    let (grid, warnings) = read(&data.join("spe1/SPE1CASE1.DATA"));
    let grid = grid.unwrap();
    assert_eq!(
        (grid.dims, warnings.len()),
        ([10, 10, 3], 0),
        "{warnings:?}"
    );
    // Its text says 10 x 10 cells of 1000 ft, layers of 20, 30 and 50 ft below 8325 ft.
    assert_eq!(
        grid.coord[720..],
        [10000.0, 10000.0, 8325.0, 10000.0, 10000.0, 8425.0]
    );
    assert_eq!([grid.zcorn[400], grid.zcorn[2399]], [8345.0, 8425.0]);
    assert_eq!(property(&grid, "PERMZ")[199..=200], [50.0, 200.0]);
    let (grid, warnings) = read(&data.join("decks/SPE3CASE1.DATA"));
    assert_eq!(
        (grid.unwrap().dims, warnings.len()),
        ([9, 9, 4], 0),
        "{warnings:?}"
    );
}

#[test]
fn real_nested_faults() {
    let Some(data) = data() else { return };
    let (grid, warnings) = read(&data.join("grdecl/fault_test/regular27cell.DATA"));
    let grid = grid.unwrap();
    let names: Vec<_> = grid
        .faults
        .iter()
        .map(|fault| fault.name.as_str())
        .collect();
    assert_eq!(names[0], "grid_C202");
    assert_eq!(names[4], "mother_grid_C202");
    assert_eq!(names[8..], ["MAIN", "DATA_FILE_MAIN"]);
    assert_eq!(grid.files.len(), 5);
    assert!(warnings.is_empty(), "{warnings:?}");
}

// --- speed ---

/// A grid of 160 x 160 x 50 cells as exporters write it: about 140 MB.
fn write_large_deck(path: &Path) {
    use std::io::Write;
    let (ni, nj, nk) = (160_usize, 160_usize, 50_usize);
    let mut random = fastrand::Rng::with_seed(1);
    let mut out = std::io::BufWriter::new(fs::File::create(path).unwrap());
    writeln!(out, "SPECGRID\n {ni} {nj} {nk} 1 F /\n\nCOORD").unwrap();
    for pillar in 0..(ni + 1) * (nj + 1) {
        let (x, y) = (
            456_510.61 + 50.37 * (pillar % (ni + 1)) as f64,
            5_926_880.03 + 50.11 * (pillar / (ni + 1)) as f64,
        );
        writeln!(out, " {x:.2} {y:.2} 1700.00 {x:.2} {y:.2} 2100.00").unwrap();
    }
    let mut array = |name: &str, count: usize, value: &mut dyn FnMut(usize) -> String| {
        writeln!(out, "/\n\n{name} -- generated").unwrap();
        for index in 0..count {
            let end = if index % 8 == 7 { "\n" } else { " " };
            write!(out, "{}{end}", value(index)).unwrap();
        }
    };
    let cells = ni * nj * nk;
    array("ZCORN", 8 * cells, &mut |index| {
        format!(
            "{:.4}",
            1700.0 + 4.0 * (index / (4 * ni * nj)) as f64 + random.f64()
        )
    });
    array("PORO", cells, &mut |index| {
        format!("0.{:04}", 500 + index % 2500)
    });
    array("PERMX", cells, &mut |index| {
        format!("{:.3}", 0.5 + (index * 7919 % 200_003) as f64 / 100.0)
    });
    array("ACTNUM", cells / 20, &mut |index| {
        if index % 3 == 0 {
            "20*1".into()
        } else {
            "3*0 17*1".into()
        }
    });
    writeln!(out, "/").unwrap();
}

/// Wall and processor time of a large deck; run with `--ignored --nocapture`, and once more with
/// `RAYON_NUM_THREADS=1`.
#[test]
#[ignore = "writes 140 MB and only measures"]
fn speed_of_a_large_deck() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("LARGE.GRDECL");
    write_large_deck(&path);
    let megabytes = fs::metadata(&path).unwrap().len() as f64 / 1e6;
    let mut seconds: Vec<f64> = (0..6)
        .map(|_| {
            let start = std::time::Instant::now();
            assert_eq!(read(&path).0.unwrap().properties.len(), 2);
            start.elapsed().as_secs_f64()
        })
        .collect();
    // The first run warms the file up.
    seconds.remove(0);
    seconds.sort_by(f64::total_cmp);
    println!(
        "{megabytes:.0} MB: {:.0} MB/s (median of 5; slowest {:.0}, fastest {:.0})",
        megabytes / seconds[2],
        megabytes / seconds[4],
        megabytes / seconds[0]
    );
}
