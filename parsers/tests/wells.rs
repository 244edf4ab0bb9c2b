//! Wells of decks, and paths of wells.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

use std::path::{Path, PathBuf};

use strataray_parsers::calendar::moment;
use strataray_parsers::deck::{MemoryFiles, Schedule};
use strataray_parsers::paths::{self, Vertical, WellPath};
use strataray_parsers::wells::{self, Direction, Kind, Status, Well};
use strataray_parsers::{Warnings, restart};

const DIMS: [usize; 3] = [10, 10, 5];

fn schedule(text: &str) -> Schedule {
    let files = MemoryFiles::from_iter([("A.SCH", text.to_owned())]);
    let path = [Path::new("A.SCH")];
    Schedule::read_from(&files, &path, None, &mut Warnings::default()).unwrap()
}

fn read(text: &str) -> Vec<WellPath> {
    paths::from_bytes(("wells.dev", text.to_owned()), &mut Warnings::default()).unwrap()
}

fn cells(well: &Well) -> Vec<[i32; 3]> {
    well.completions.iter().map(|c| c.cell).collect()
}

#[test]
fn defaults_patterns_and_lists_of_a_schedule() {
    let text = "
WELSPECS
 PA 'G1' 3 4 1000 OIL /
 PB 'G1' 5 6 1* OIL /
 INJ 'G2' 1 1 1* WATER /
/
COMPDAT
 PA 2* 1 3 /
 PA 0 0 5 5 SHUT /
 PB 6 7 2 2 OPEN 2* 0.2 3* Y /
 PA 3 4 2 2 SHUT /
 INJ 11 1 1 1 /
/
WLIST
 '*L' NEW PA PB /
/
WCONPROD
 '*L' STOP ORAT /
/
WCONINJE
 I* GAS 1* RATE /
/
";
    let wells = schedule(text).wells(None, DIMS);
    assert_eq!(
        cells(&wells[0]),
        [[3, 4, 1], [3, 4, 2], [3, 4, 3], [3, 4, 5]]
    );
    let open: Vec<bool> = wells[0].completions.iter().map(|c| c.is_open).collect();
    assert_eq!(open, [true, false, true, false]);
    assert_eq!((wells[0].head, wells[0].depth), ([3, 4], Some(1000.0)));
    assert_eq!(wells[1].completions[0].direction, Some(Direction::Y));
    let states: Vec<_> = wells.iter().map(|w| (w.kind, w.status)).collect();
    assert_eq!(
        states,
        [
            (Kind::Producer, Status::Stopped),
            (Kind::Producer, Status::Stopped),
            (Kind::GasInjector, Status::Open)
        ]
    );
    // Outside of the grid.
    assert!(wells[2].completions.is_empty());
    assert_eq!(schedule(text).outside(DIMS), 1);
    assert_eq!(schedule(text).outside([11, 10, 5]), 0);
}

#[test]
fn wells_of_local_grids_and_fractures() {
    let wells = schedule(
        "WELSPECL\n P G LGR1 2 3 /\n/\nCOMPDATL\n P LGR1 2* 1 2 /\n/\nWELSPECS\n F G 1 1 /\n/\nCOMPDAT\n F 2* 5 6 /\n/\n",
    )
    .wells(None, DIMS);
    let local = &wells[0].local[0];
    assert_eq!((local.grid.as_str(), local.head), ("LGR1", [2, 3]));
    assert_eq!(local.completions[1].cell, [2, 3, 2]);
    assert!(wells[0].completions.is_empty());
    // Six layers down of five are the fractures of the first.
    let fracture = wells[1].completions[1];
    assert_eq!((fracture.cell, fracture.is_fracture), ([1, 1, 1], true));
}

#[test]
fn what_is_said_at_a_date_holds_after_it() {
    let text = "START\n 1 JAN 2020 /\nSCHEDULE\nWELSPECS\n P G 1 1 /\n/\nTSTEP\n 10 21 /\nWCONHIST\n P OPEN /\n/\n\
                DATES\n 1 JLY 2020 12:00:00 /\n/\nWELOPEN\n P SHUT /\n/\n";
    let schedule = schedule(text);
    let status = |date: &str| {
        let wells = schedule.wells(moment(date), DIMS);
        wells.first().map(|well| (well.kind, well.status))
    };
    assert_eq!(status("2020-01-01"), None);
    assert_eq!(status("2020-02-01"), Some((Kind::Undefined, Status::Shut)));
    assert_eq!(status("2020-02-02"), Some((Kind::Producer, Status::Open)));
    assert_eq!(
        status("2020-07-01 12:00"),
        Some((Kind::Producer, Status::Open))
    );
    assert_eq!(status("2020-07-02"), Some((Kind::Producer, Status::Shut)));
    assert_eq!(Some(schedule.end), moment("2020-07-01 12:00"));
}

#[test]
fn rates_and_pressures_that_are_asked_for() {
    let text = "
WELSPECS
 P 'G' 3 4 1* OIL /
 I 'G' 1 1 1* WATER /
 H 'G' 2 2 1* OIL /
/
WCONPROD
 P OPEN LRAT 100 2* 250 1* 50 /
/
WCONINJE
 I WATER OPEN RATE 300 1* 400 /
/
WCONHIST
 H OPEN ORAT 7 8 9 /
/
TSTEP
 10 /
WELTARG
 P LRAT 200 /
 P WRAT 20 /
 P GUID 3 /
/
TSTEP
 10 /
WCONPROD
 P OPEN BHP 1* MYUDQ 3* 60 /
/
";
    let all = schedule(text);
    let at = |date: Option<&str>, well: usize| -> Vec<(&str, f64)> {
        let wells = all.wells(date.map(|date| moment(date).unwrap()), DIMS);
        wells[well]
            .targets
            .iter()
            .map(|t| (t.name, t.value))
            .collect()
    };
    let first = [("ORAT", 100.0), ("LRAT", 250.0), ("BHP", 50.0)];
    assert_eq!(at(Some("1983-01-05"), 0), first);
    let changed = [
        ("ORAT", 100.0),
        ("LRAT", 200.0),
        ("BHP", 50.0),
        ("WRAT", 20.0),
    ];
    assert_eq!(at(Some("1983-01-15"), 0), changed);
    // A record says all anew; a quantity that the run computes is no number.
    assert_eq!(at(None, 0), [("BHP", 60.0)]);
    assert_eq!(at(None, 1), [("RATE", 300.0), ("BHP", 400.0)]);
    assert_eq!(at(None, 2), [("ORAT", 7.0), ("WRAT", 8.0), ("GRAT", 9.0)]);
    assert_eq!(
        all.not_evaluated,
        ["WELTARG of other quantities than rates and pressures"]
    );
}

#[test]
fn what_holds_under_a_condition_is_named_and_not_evaluated() {
    let text = "WELSPECS\n P G 1 1 /\n/\nACTIONX\n A 1 /\n WWCT P > 0.5 /\n/\nWELOPEN\n P SHUT /\n/\nENDACTIO\nWCONPROD\n P OPEN /\n/\n\
                UDQ\n DEFINE WUX WOPR / 2 /\n/\nSKIP\nWELOPEN\n P SHUT /\n/\nENDSKIP\n";
    let schedule = schedule(text);
    assert_eq!(schedule.not_evaluated, ["ACTIONX", "UDQ"]);
    assert_eq!(schedule.wells(None, DIMS)[0].status, Status::Open);
}

#[test]
fn sections_before_the_schedule_are_passed() {
    let deck = "RUNSPEC\nINCLUDE\n 'runspec.inc' /\nGRID\nINCLUDE\n 'gone.grdecl' /\nSUMMARY\nWBHP\n/\nWOPR\n 'P' /\n\
                SCHEDULE\nINCLUDE\n 'a.sch' /\nINCLUDE\n 'gone.sch' /\nDATES\n 1 JAN 2022 /\n/\nEND\nWELSPECS\n Z G 1 1 /\n/\n";
    let files = MemoryFiles::from_iter([
        ("A.DATA", deck),
        ("runspec.inc", "START\n 1 JAN 2021 /\n"),
        ("a.sch", "WELSPECS\n P G 1 1 /\n/\n"),
    ]);
    let mut warnings = Warnings::default();
    let path = [Path::new("A.DATA")];
    let schedule = Schedule::read_from(&files, &path, None, &mut warnings).unwrap();
    assert_eq!(schedule.names, ["P"]);
    assert_eq!(Some(schedule.end), moment("2022-01-01"));
    let told: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("gone.sch"), "{told:?}");
    assert!(Schedule::begins(b"-- wells\n\nDATES\n 1 JAN") && !Schedule::begins(b"PORO\n 1 /"));
}

/// The public data, where it is.
#[test]
fn lines_drawn_behind_keywords_are_decoration() {
    let of = |line: &str| {
        let text = format!("SUMMARY\nWOPR\n/\n\nSCHEDULE {line}\nWELSPECS\n P G 1 1 /\n/\n");
        schedule(&text).wells(None, [3, 3, 3]).len()
    };
    for line in ["", "=====", "----- -- wells", "= - =", "_____"] {
        assert_eq!(of(line), 1, "{line}");
    }
    // What could be a record is none.
    assert_eq!(of("P /"), 0);
}

fn data(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("STRATARAY_DATA")?;
    Some(PathBuf::from(folder).join(path))
}

#[test]
fn a_deck_says_what_the_restart_of_its_run_has() {
    for (deck, run, dims) in [
        ("reek/deck/model/REEK.DATA", "reek/REEK.UNRST", [40, 64, 14]),
        ("spe9/deck/SPE9_CP.DATA", "spe9/SPE9_CP.UNRST", [24, 25, 15]),
        ("spe1/SPE1CASE1.DATA", "spe1/SPE1CASE1.UNRST", [10, 10, 3]),
    ] {
        let (Some(deck), Some(run)) = (data(deck), data(run)) else {
            return;
        };
        let mut warnings = Warnings::default();
        let schedule = Schedule::read(&[deck.as_path()], None, &mut warnings).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        let steps = restart::open_unified(&run, &mut warnings).unwrap();
        let mut compared = 0;
        for step in steps.iter().skip(1) {
            let of_run = wells::read(&step.arrays).unwrap();
            let of_deck = schedule.wells(moment(&step.head.time()), dims);
            assert_eq!(of_run.len(), of_deck.len(), "{}", step.head.date);
            for (a, b) in of_run.iter().zip(&of_deck) {
                assert_eq!((&a.name, a.kind, a.head), (&b.name, b.kind, b.head));
                // Flow orders connections along the well.
                let sorted = |well: &Well| {
                    let open = well.completions.iter().map(|c| (c.cell, c.is_open));
                    let mut open: Vec<_> = open.collect();
                    open.sort_unstable();
                    open
                };
                assert_eq!(sorted(a), sorted(b), "{} {}", a.name, step.head.date);
                compared += a.completions.len();
            }
        }
        assert!(compared > 2, "{compared}");
    }
}

#[test]
fn lists_of_points_with_names() {
    // The forms that the documentation of ResInsight shows.
    let wells = read(
        "X Y TVD MD\nName Well_1\n6507.1\t725\t2542\t2542\n6523.5\t757\t2549\t2578.6\n\n-- a comment\nThis is not its name\nName Well_2\n\
         550.7 1020.2 2410 2520\n551 1004.1 2422.2 2540.2\n# inside\n555.2 993.9 2425 2551.6\n\n3Q AHB-J\n5507.0 4638.5 0.0 0.0\n5507 4638.5 1628.6 1628.6\n",
    );
    let names: Vec<&str> = wells.iter().map(|w| w.name.as_str()).collect();
    assert_eq!(names, ["Well_1", "Well_2", "3Q AHB-J"]);
    assert_eq!(wells[1].points[2], [555.2, 993.9, 2425.0]);
    assert_eq!(wells[1].measured.as_ref().unwrap()[2], 2551.6);
    assert_eq!(wells[0].vertical, Vertical::Depth);
    // Without names, with marks of ends, in other letters for the same.
    let plain = "1 2 -3\n4 5 -60\n-999\n7 8 9\n1 1 -1\n";
    for text in [
        plain.to_owned(),
        format!("\u{feff}{}", plain.replace('\n', "\r\n")),
        plain.replace(' ', ";"),
        plain.replace(' ', ", "),
        plain.replace(' ', "\t").replace('\n', "\r"),
    ] {
        let wells = read(&text);
        let names: Vec<&str> = wells.iter().map(|w| w.name.as_str()).collect();
        assert_eq!(names, ["wells", "wells 2"], "{text:?}");
        assert_eq!(wells[0].points, [[1.0, 2.0, 3.0], [4.0, 5.0, 60.0]]);
        // One file has one convention.
        assert_eq!(wells[1].points[0], [7.0, 8.0, -9.0]);
        assert_eq!(wells[1].vertical, Vertical::ElevationBySign);
    }
    let other = read(&plain.replace("-60", "60"));
    assert_eq!(other[0].points[1], [4.0, 5.0, 60.0]);
    assert_eq!(other[0].vertical, Vertical::DepthBySign);
}

#[test]
fn well_traces() {
    let text = "# WELL TRACE FROM PETREL\n# WELL NAME:  15/9-F 1\n# WELL HEAD X-COORDINATE: 1000.0 (m)\n# WELL HEAD Y-COORDINATE: 2000.0 (m)\n\
                # WELL DATUM (KB, Kelly bushing, from MSL): 27.3 (m)\n# MD AND TVD ARE REFERENCED (=0) AT WELL DATUM AND INCREASE DOWNWARDS\n\
                # XYZ TRACE IS GIVEN IN COORDINATE SYSTEM\n# DX DY ARE GIVEN IN GRID NORTH IN m-UNITS\n# DEPTH (Z, TVD) GIVEN IN m-UNITS\n\
                #====\n      MD    X    Y     Z    TVD  DX DY AZIM_TN INCL DLS AZIM_GN\n#====\n\
                0 1000 2000 27.3 0 0 0 145 0 0 145\n 1200 1001 2002 -1172.7 1200 1 2 145 0 0 145\n";
    let [well] = read(text).try_into().unwrap();
    assert_eq!(well.name, "15/9-F 1");
    // Below the sea, and not from the drill floor.
    assert_eq!(
        well.points,
        [[1000.0, 2000.0, -27.3], [1001.0, 2002.0, 1172.7]]
    );
    assert_eq!(well.measured, Some(vec![0.0, 1200.0]));
    assert_eq!(well.vertical, Vertical::Elevation);
    assert_eq!(well.unit.map(|unit| unit.short()), Some("M"));
    assert!(paths::begin(text.as_bytes(), false));
    let feet = read(&text.replace("(m)", "(ft)").replace("m-UNITS", "ft-UNITS"));
    assert_eq!(feet[0].unit.map(|unit| unit.short()), Some("FT"));
}

#[test]
fn wells_of_rms_and_json() {
    let text = "1.0\nUndefined\nOP 1 461499.9 5932000.1 25.5\n2\nMD UNK lin\nFacies DISC 0 Shale 1 Sand\n\
                461499.9 5932000.1 1000 1025.5 0\n461500.9 5932001.1 1100 1127.5 -999\n";
    let [well] = read(text).try_into().unwrap();
    assert_eq!(
        (well.name.as_str(), well.vertical),
        ("OP 1", Vertical::Depth)
    );
    assert_eq!(well.points[1], [461_500.9, 5_932_001.1, 1100.0]);
    assert_eq!(well.measured, Some(vec![1025.5, 1127.5]));
    assert!(paths::begin(text.as_bytes(), false));
    let json = r#"[{"name": "A", "path": [{"x": 1, "y": 2, "z": 3}, {"x": 1, "y": 2, "z": 4}]}]"#;
    let [well] = read(json).try_into().unwrap();
    assert_eq!((well.points[1], well.measured), ([1.0, 2.0, 4.0], None));
    assert!(paths::begin(json.as_bytes(), false));
}

#[test]
fn texts_that_are_no_paths_are_not_taken_for_such() {
    for text in [
        "PORO\n 0.1 0.2 0.3 /\n",
        "PORO\n 0.1 0.2 0.3\n 0.1 0.2 0.3\n",
        "0.1 0.2 0.3\n",
        "SPECGRID\n 1 1 1 1 F /\nCOORD\n 1 2 3 1 2 4\n",
        "NAME is a word\n",
        "{\"scene\": 1}",
        "",
    ] {
        assert!(!paths::begin(text.as_bytes(), false), "{text}");
    }
    // The ending of a name is enough for rows of numbers, and not for a deck.
    assert!(paths::begin(b"1 2 3\n4 5 6\n", true));
    assert!(!paths::begin(b"PORO\n 0.1 0.2 0.3 /\n", true));
    assert!(paths::begin(b"WELLNAME: A\n1 2 3\n", false));
    assert!(paths::begin(b"Easting,Northing,TVDSS\n1,2,3\n", false));
}
