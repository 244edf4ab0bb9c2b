//! Wells of real steps.

use strataray_parsers::cells::CellArrays;
use strataray_parsers::restart::{self, Step};
use strataray_parsers::wells::{self, Direction, Kind, Status, Well};
use strataray_parsers::{Warnings, records::RecordWriter};

use super::data;

fn steps(name: &str) -> Option<Vec<Step>> {
    Some(restart::open_unified(&data(name)?, &mut Warnings::default()).unwrap())
}

fn find<'a>(wells: &'a [Well], name: &str) -> &'a Well {
    wells.iter().find(|well| well.name == name).unwrap()
}

fn cells(well: &Well) -> Vec<[i32; 3]> {
    well.completions.iter().map(|c| c.cell).collect()
}

/// What holds for any step of a whole case.
fn check(arrays: &CellArrays) -> Vec<Well> {
    let wells = wells::read(arrays).unwrap();
    let [ni, nj, nk] = arrays.head().unwrap().dims;
    for well in &wells {
        assert!(well.group.is_some(), "{}", well.name);
        for completion in &well.completions {
            let [i, j, k] = completion.cell;
            assert!((1..=ni).contains(&i) && (1..=nj).contains(&j) && (1..=nk).contains(&k));
            assert!(completion.factor.unwrap() >= 0.0 && completion.depth.unwrap() > 0.0);
        }
        let orders = well.completions.iter().map(|c| c.order);
        assert!(orders.eq(1..=well.completions.len() as i32));
    }
    wells
}

#[test]
fn ok_spe1() {
    let Some(steps) = steps("spe1/SPE1CASE1.UNRST") else {
        return;
    };
    for step in &steps {
        let wells = check(&step.arrays);
        let names: Vec<_> = wells.iter().map(|w| w.name.clone()).collect();
        assert_eq!(names, step.wells().unwrap());
        let producer = find(&wells, "PROD");
        assert_eq!(producer.head, [10, 10]);
        assert_eq!(
            (producer.kind, producer.status),
            (Kind::Producer, Status::Open)
        );
        assert_eq!(producer.group.as_deref(), Some("G1"));
        assert_eq!(producer.depth, Some(8400.0));
        assert_eq!(cells(producer), [[10, 10, 3]]);
        let completion = producer.completions[0];
        assert_eq!(completion.direction, Some(Direction::Z));
        assert_eq!(completion.diameter, Some(0.5));
        assert!(completion.is_open && !completion.is_fracture);
        let injector = find(&wells, "INJ");
        assert_eq!(injector.kind, Kind::GasInjector);
        assert_eq!(cells(injector), [[1, 1, 1]]);
        // 100 million cubic feet of gas a day, as the deck asks for.
        assert!((injector.flow.unwrap().gas + 100_000.0).abs() < 1.0);
        let injected = injector.flow.unwrap().injected[2];
        assert!((injected / (100_000.0 * step.days) - 1.0).abs() < 1e-3);
    }
}

#[test]
fn ok_spe9_and_reek() {
    for (name, count) in [("spe9/SPE9_CP.UNRST", 26), ("reek/REEK.UNRST", 8)] {
        let Some(steps) = steps(name) else {
            return;
        };
        let mut produced = 0.0;
        for step in &steps {
            let wells = check(&step.arrays);
            assert_eq!(wells.len(), step.wells().unwrap().len());
            let total: f64 = wells.iter().map(|w| w.flow.unwrap().produced[0]).sum();
            assert!(total >= produced, "{name}: totals never fall");
            produced = total;
        }
        let last = check(&steps.last().unwrap().arrays);
        assert_eq!(last.len(), count, "{name}");
        assert!(produced > 0.0);
        let injectors = last.iter().filter(|w| w.kind == Kind::WaterInjector);
        assert!(injectors.count() > 0);
    }
    let wells = check(&steps("spe9/SPE9_CP.UNRST").unwrap()[0].arrays);
    let layers = |well: &Well| cells(well).iter().map(|c| c[2]).collect::<Vec<_>>();
    assert_eq!(layers(find(&wells, "INJE1")), [11, 12, 13, 14, 15]);
    assert_eq!(layers(find(&wells, "PRODU2")), [2, 3, 4]);
}

#[test]
fn ok_brugge_of_another_simulator() {
    let Some(path) = data("brugge/BRUGGE_0000.X0003") else {
        return;
    };
    let steps = restart::open_separate(&[(3, path)], &mut Warnings::default()).unwrap();
    let wells = check(&steps[0].arrays);
    let named: Vec<_> = wells.iter().map(|w| w.name.as_str()).collect();
    assert_eq!(&named[..2], ["I01", "I02"]);
    let first = find(&wells, "I01");
    assert_eq!((first.kind, first.head), (Kind::WaterInjector, [32, 44]));
    assert_eq!(first.completions.len(), 9);
    assert_eq!(first.completions[0].direction, Some(Direction::X));
    assert!(first.completions.iter().all(|c| c.is_open));
    assert_eq!(wells.len(), 113);
}

#[test]
fn ok_fractures_are_folded_to_their_layer() {
    for name in ["dualporo/DUAL.UNRST", "dualporo/TEST_DP.UNRST"] {
        let Some(steps) = steps(name) else {
            return;
        };
        let wells = wells::read(&steps.last().unwrap().arrays).unwrap();
        assert_eq!(cells(find(&wells, "INJ")), [[1, 1, 1]]);
        assert!(find(&wells, "INJ").completions[0].is_fracture);
    }
    let single = wells::read(&steps("dualporo/TEST_SP.UNRST").unwrap()[1].arrays).unwrap();
    assert!(!find(&single, "INJ").completions[0].is_fracture);
}

#[test]
fn ok_wells_of_local_grids() {
    let Some(steps) = steps("lgr_nnc/LGR_TESTMOD.UNRST") else {
        return;
    };
    let wells = check(&steps[1].arrays);
    let [first, second] = [find(&wells, "PROD1"), find(&wells, "PROD2")];
    assert_eq!(cells(first), [[2, 1, 1]]);
    let local = &first.local[0];
    assert_eq!((local.grid.as_str(), local.head), ("LGR1", [3, 2]));
    let places: Vec<_> = local.completions.iter().map(|c| c.cell).collect();
    assert_eq!(places, [[3, 2, 1], [3, 3, 1], [3, 4, 1]]);
    assert_eq!(local.completions[0].direction, Some(Direction::Y));
    let local = &second.local[0];
    assert_eq!((local.grid.as_str(), local.head), ("LGR2", [2, 6]));
    assert_eq!(local.completions.len(), 4);
    assert_eq!((first.local.len(), second.local.len()), (1, 1));
}

#[test]
fn ok_status_and_completions_of_shut_wells() {
    let Some(steps) = steps("editnnc/9_EDITNNC.UNRST") else {
        return;
    };
    let wells = check(&steps[1].arrays);
    assert_eq!(find(&wells, "PROD2").status, Status::Shut);
    assert_eq!(find(&wells, "PROD2").completions.len(), 4);
    assert_eq!(find(&wells, "INJ1").group.as_deref(), Some("INJE"));
}

#[test]
fn err_arrays_shorter_than_their_head_says() {
    let read = |wells: i32, items: i32| {
        let mut out = RecordWriter::new(Vec::new());
        let mut head = [0; 40];
        for (item, value) in [(16, wells), (17, 1), (24, items), (27, 1), (32, 15)] {
            head[item] = value;
        }
        out.inte("INTEHEAD", &head).unwrap();
        out.inte("IWEL", &[1; 22]).unwrap();
        out.chars("ZWEL", &["A", "B"]).unwrap();
        out.inte("ICON", &[1; 30]).unwrap();
        let bytes = out.finish().unwrap();
        let steps = restart::unified_from_bytes(("A.UNRST", bytes), &mut Warnings::default());
        wells::read(&steps.unwrap()[0].arrays)
    };
    let wells = read(2, 11).unwrap();
    assert_eq!(wells.len(), 2);
    assert_eq!((wells[0].depth, wells[0].flow), (None, None));
    let error = read(2, 12).unwrap_err().to_string();
    assert!(
        error.ends_with("IWEL: has 22 values, and INTEHEAD says 2 times 12; the file is damaged"),
        "{error}"
    );
    assert!(read(i32::MAX, i32::MAX).is_err());
    assert!(read(i32::MAX, 0).is_err());
    assert!(read(-1, 11).unwrap().is_empty());
    // Wells with more completions than there are arrays for.
    let mut out = RecordWriter::new(Vec::new());
    let mut head = [0; 40];
    for (item, value) in [(16, 2), (17, i32::MAX), (24, 11)] {
        head[item] = value;
    }
    out.inte("INTEHEAD", &head).unwrap();
    out.inte("IWEL", &[i32::MAX; 22]).unwrap();
    out.chars("ZWEL", &["A", "B"]).unwrap();
    let bytes = out.finish().unwrap();
    let steps = restart::unified_from_bytes(("A.UNRST", bytes), &mut Warnings::default());
    let wells = wells::read(&steps.unwrap()[0].arrays).unwrap();
    assert!(wells.iter().all(|well| well.completions.is_empty()));
}
