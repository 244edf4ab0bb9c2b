//! Results that are not as they are most often: steps, activity, lengths, files cut short.

use std::path::{Path, PathBuf};

use strataray::case::CaseError;
use strataray_parsers::cells::Head;
use strataray_parsers::egrid::Egrid;
use strataray_parsers::records::RecordWriter;

use super::{info, inputs, names, near, open, stats, told};
use crate::common::tiny;

/// The grid and a restart of these bytes.
fn with_restart(folder: &Path, bytes: Vec<u8>) -> PathBuf {
    tiny::write(folder, "A.UNRST", bytes);
    tiny::write_egrid(folder, "A", &tiny::egrid())
}

/// A step with SWAT, as simulators write them: by name, INTEHEAD items (from 1), what follows.
struct Odd {
    out: RecordWriter<Vec<u8>>,
}

impl Odd {
    fn new() -> Self {
        Self {
            out: RecordWriter::new(Vec::new()),
        }
    }

    fn head(&mut self, count: usize, items: &[(usize, i32)]) {
        let mut head = vec![0; count];
        for (item, value) in items {
            head[item - 1] = *value;
        }
        self.out.inte("INTEHEAD", &head).unwrap();
    }

    fn done(self) -> Vec<u8> {
        self.out.finish().unwrap()
    }
}

#[test]
fn f07_cells_without_pore_volume_are_inactive() {
    let folder = tempfile::tempdir().unwrap();
    let built = tiny::write_egrid(folder.path(), "A", &tiny::egrid());
    let is_out = |n: usize| n.is_multiple_of(7);
    let volume = |n| if is_out(n) { 0.0 } else { 1000.0 };
    let volumes: Vec<f32> = (0..120).map(volume).collect();
    let kept: Vec<usize> = (0..120).filter(|n| !is_out(*n)).collect();
    assert_eq!(kept.len(), 102);
    let porosity: Vec<f32> = kept.iter().map(|n| tiny::porosity()[*n]).collect();
    let mean = porosity.iter().map(|v| f64::from(*v)).sum::<f64>() / 102.0;
    let mut out = RecordWriter::new(Vec::new());
    let mut head = vec![0; 411];
    (head[2], head[11], head[14]) = (1, 102, 7);
    out.inte("INTEHEAD", &head).unwrap();
    out.real("PORV", &volumes).unwrap();
    out.real("PORO", &porosity).unwrap();
    tiny::write(folder.path(), "A.INIT", out.finish().unwrap());
    let step = (
        tiny::head(102, 7, "2030-01-01"),
        vec![("SWAT", vec![0.4; 102])],
    );
    tiny::write(folder.path(), "A.UNRST", tiny::restart(&[step]));
    let case = open(&built);
    near(&[stats(&case, "PORO", 0)[2]], &[mean]);
    for path in inputs("F07_PORV.EGRID", built) {
        let case = open(&path);
        assert_eq!(case.grid.active_cells().len(), 102);
        near(&[stats(&case, "PORV", 0)[0]], &[1000.0]);
        assert!(stats(&case, "SWAT", 0)[2] > 0.3);
        told(&case, &["120 active cells", "102", "PORV"]);
        if path.ends_with("F07_PORV.EGRID") {
            near(&stats(&case, "PORO", 0), &[0.101, 0.218, 0.1595]);
        }
    }
}

#[test]
fn f08_steps_without_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let mut odd = Odd::new();
    for month in 1..=4 {
        odd.head(411, &[(12, 120), (15, 7), (65, 1), (66, month), (67, 2030)]);
        let days = 31.0 * f64::from(month - 1);
        odd.out.doub("DOUBHEAD", &[days]).unwrap();
        // What stands in a local grid's section is no step of its own.
        odd.out.chars("LGR", &["L1"]).unwrap();
        odd.head(411, &[(12, 8)]);
        odd.out.mess("ENDLGR").unwrap();
        odd.out
            .real("SWAT", &[0.1 + 0.1 * month as f32; 120])
            .unwrap();
    }
    for path in inputs("F08_NOSEQ.EGRID", with_restart(folder.path(), odd.done())) {
        let case = open(&path);
        let steps: Vec<_> = case
            .steps
            .iter()
            .map(|s| (s.report, s.date.as_str(), s.days))
            .collect();
        let expected = [
            (0, "2030-01-01", 0.0),
            (1, "2030-02-01", 31.0),
            (2, "2030-03-01", 62.0),
            (3, "2030-04-01", 93.0),
        ];
        assert_eq!(steps, expected);
        near(&[stats(&case, "SWAT", 2)[2]], &[0.4]);
        told(&case, &["SEQNUM", "INTEHEAD"]);
    }
}

#[test]
fn f19_coarse_cells_show_their_values_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let mut coarse = vec![0; 120];
    for cell in [0, 1, 6, 7] {
        coarse[cell] = 1;
    }
    let grid = Egrid {
        coarse: Some(coarse),
        ..tiny::egrid()
    };
    let built = tiny::write_egrid(folder.path(), "A", &grid);
    // Without PORV the first cell stands for the four.
    let values: Vec<f32> = (0..117).map(|n| n as f32).collect();
    let step = (
        tiny::head(117, 7, "2030-01-01"),
        vec![("SWAT", values.clone())],
    );
    tiny::write(folder.path(), "A.UNRST", tiny::restart(&[step]));
    let of = |path: &Path, name: &str| {
        let field = open(path).field(name, 0).unwrap();
        [0, 1, 2, 6, 7, 8].map(|n| field.values()[n])
    };
    assert_eq!(of(&built, "SWAT"), [0.0, 0.0, 1.0, 0.0, 0.0, 5.0]);
    // With PORV the one that has volume does, here the last.
    let mut volumes = vec![1000.0; 120];
    volumes[..8].copy_from_slice(&[0.0, 0.0, 1e3, 1e3, 1e3, 1e3, 0.0, 4e3]);
    let mut out = RecordWriter::new(Vec::new());
    let mut head = vec![0; 411];
    (head[2], head[11], head[14]) = (1, 117, 7);
    out.inte("INTEHEAD", &head).unwrap();
    out.real("PORV", &volumes).unwrap();
    out.real("PORO", &values).unwrap();
    tiny::write(folder.path(), "A.INIT", out.finish().unwrap());
    assert_eq!(of(&built, "PORO"), [4.0, 4.0, 0.0, 4.0, 4.0, 5.0]);
    assert_eq!(of(&built, "PORV")[..2], [4e3, 4e3]);
    told(&open(&built), &["CORSNUM", "4 cells are coarsened to 1"]);
    for path in inputs("F19_COARSE.EGRID", built).iter().skip(1) {
        let case = open(path);
        assert_eq!(case.grid.active_cells().len(), 32);
        let field = case.field("PORO", 0).unwrap();
        near(
            &[0, 1, 4, 5].map(|n| f64::from(field.values()[n])),
            &[0.1; 4],
        );
        near(&[stats(&case, "PORO", 0)[1]], &[0.3]);
        told(&case, &["CORSNUM", "4 cells are coarsened to 1"]);
    }
}

#[test]
fn f20_arrays_of_another_length_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut odd = Odd::new();
    for step in 0..2 {
        odd.out.inte("SEQNUM", &[step]).unwrap();
        odd.head(411, &[(12, 120), (65, 1 + step), (66, 1), (67, 2030)]);
        odd.out.doub("DOUBHEAD", &[f64::from(step)]).unwrap();
        odd.out.real("SCON", &[1.0; 40]).unwrap();
        odd.out.doub("DLYTIM", &[1.0; 120]).unwrap();
        odd.out.mess("STARTSOL").unwrap();
        odd.out.real("SWAT", &[0.5; 120]).unwrap();
        if step == 1 {
            odd.out.real("ZMF_1", &[0.5; 123]).unwrap();
        }
        odd.out.mess("ENDSOL").unwrap();
    }
    let built = with_restart(folder.path(), odd.done());
    let case = open(&built);
    told(&case, &["A.UNRST", "ZMF_1", "step 1", "123", "120"]);
    // Lists of other things are neither properties nor missed.
    assert!(!names(&case).contains(&"DLYTIM"), "{:?}", names(&case));
    assert!(!case.about.notes.iter().any(|n| n.contains("SCON")));
    for path in inputs("F20_LENGTH.EGRID", built).iter().skip(1) {
        let case = open(path);
        told(
            &case,
            &["F20_LENGTH.UNRST", "ZMF_1", "step 0", "123", "120"],
        );
        assert!(names(&case).contains(&"SWAT") && !names(&case).contains(&"ZMF_1"));
    }
}

fn at(clock: [i32; 3]) -> Head {
    Head {
        clock,
        ..tiny::head(120, 7, "2025-01-01")
    }
}

#[test]
fn f21_steps_within_a_day() {
    let folder = tempfile::tempdir().unwrap();
    let clocks = [0, 6, 12, 18].map(|hour| at([hour, 30, 0]));
    let steps = clocks.map(|head| {
        (
            head.clone(),
            vec![("SWAT", vec![0.01 * head.clock[0] as f32; 120])],
        )
    });
    let built = with_restart(folder.path(), tiny::restart(&steps));
    for path in inputs("F21_HOURS.EGRID", built) {
        let case = open(&path);
        let dates: Vec<_> = case.steps.iter().map(|s| s.date.as_str()).collect();
        let expected = [0, 6, 12, 18].map(|hour| format!("2025-01-01 {hour:02}:30"));
        assert_eq!(dates, expected);
        assert_eq!(case.step("2025-01-01 06:30").unwrap(), 1);
        assert_eq!(case.step(" 2025-01-01 6:30").unwrap(), 1);
        let several = case.step("2025-01-01").unwrap_err();
        assert!(
            matches!(several, CaseError::SeveralSteps { .. }),
            "{several}"
        );
        assert!(
            several.to_string().contains("1 (2025-01-01 06:30)"),
            "{several}"
        );
        assert!(case.step("2025-01-01 07:30").is_err() && case.step("2025-01-02").is_err());
        let asked = "SWAT@2025-01-01 06:30";
        let facts = info([path.as_os_str(), "--stats".as_ref(), asked.as_ref()]);
        let step = &case.field("SWAT", 1).unwrap().statistics().unwrap();
        near(
            &[facts["stats"][asked]["mean"].as_f64().unwrap()],
            &[step.mean],
        );
    }
}

#[test]
fn f21_dates_have_as_much_time_as_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let clocks = [
        [0, 0, 0],
        [23, 59, 30_000_000],
        [-2345, -2345, 0],
        [7, 0, 0],
    ];
    let steps = clocks.map(|clock| (at(clock), vec![("SWAT", vec![0.5; 120])]));
    let case = open(&with_restart(folder.path(), tiny::restart(&steps)));
    let dates: Vec<_> = case.steps.iter().map(|s| s.date.as_str()).collect();
    let day = "2025-01-01";
    assert_eq!(dates, [day, "2025-01-01 23:59:30", day, "2025-01-01 07:00"]);
    // Two steps of one date have to be told apart by number; the time of day is enough for the others.
    assert!(
        case.step(day)
            .unwrap_err()
            .to_string()
            .contains("0 (2025-01-01), 2 (2025-01-01)")
    );
    assert_eq!(case.step("2025-01-01 07:00").unwrap(), 3);
    let steps: Vec<_> = steps.into_iter().skip(3).collect();
    let case = open(&with_restart(folder.path(), tiny::restart(&steps)));
    assert_eq!(case.step(day).unwrap(), 0, "the day has one step");
}

#[test]
fn f22_days_from_dates() {
    let folder = tempfile::tempdir().unwrap();
    let mut odd = Odd::new();
    for month in 1..=3 {
        odd.out.inte("SEQNUM", &[month - 1]).unwrap();
        odd.head(67, &[(65, 1), (66, month), (67, 2020)]);
        odd.out.real("SWAT", &[0.1 * month as f32; 120]).unwrap();
    }
    for path in inputs(
        "F22_NODOUBHEAD.EGRID",
        with_restart(folder.path(), odd.done()),
    ) {
        let case = open(&path);
        let days: Vec<f64> = case.steps.iter().map(|s| s.days).collect();
        assert_eq!(days, [0.0, 31.0, 60.0]);
        told(&case, &["DOUBHEAD is missing", "dates"]);
    }
}

#[test]
fn f23_init_that_is_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let built = tiny::write_egrid(folder.path(), "A", &tiny::egrid());
    let arrays = [
        ("PORV", vec![1000.0; 120]),
        ("PORO", tiny::porosity()),
        ("PERMX", vec![100.0; 120]),
    ];
    let whole = tiny::init(&tiny::head(120, 7, "2000-01-01"), &arrays);
    tiny::write(folder.path(), "A.INIT", &whole[..whole.len() - 200]);
    for path in inputs("F23_INITCUT.EGRID", built) {
        let case = open(&path);
        near(&stats(&case, "PORO", 0), &[0.1, 0.219, 0.1595]);
        assert!(!names(&case).contains(&"PERMX"));
        told(
            &case,
            &[
                ".INIT",
                "PERMX and what follows it were left out",
                "200 bytes too early",
            ],
        );
    }
}
