//! Local grids: geometry, connections, arrays by grid.

use std::collections::{BTreeMap, HashSet};
use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;
use strataray_parsers::deck::{Grdecl, MemoryFiles};
use strataray_parsers::egrid::{Egrid, GridConnections, LocalGrid};
use strataray_parsers::records::RecordWriter;
use strataray_parsers::{Warnings, init, restart};

use super::data;

const CASES: [&str; 2] = ["lgr_nnc/LGR_TESTMOD.EGRID", "lgr_nnc/SIMPLE_SUMMARY2.EGRID"];

fn facts(case: &str) -> Option<(Egrid, Value)> {
    let oracle = std::fs::read(data("oracle.json")?).unwrap();
    let oracle: Value = serde_json::from_slice(&oracle).unwrap();
    let mut warnings = Warnings::default();
    let grid = Egrid::read(&data(case).unwrap(), &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    Some((grid, oracle[case].clone()))
}

fn number(fact: &Value) -> usize {
    usize::try_from(fact.as_u64().unwrap()).unwrap()
}

/// Corners of a cell in the order of the facts.
fn corners<T: Copy + Into<f64>>(grid: &LocalGrid<T>, ijk: [usize; 3]) -> Vec<[f64; 3]> {
    let [ni, nj, _] = grid.dims;
    let [i, j, k] = ijk;
    let corner = |c: usize| {
        let (di, dj, dk) = (c & 1, c >> 1 & 1, c >> 2);
        let z = grid.zcorn[2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * (2 * k + dk)].into();
        let pillar = (j + dj) * (ni + 1) + i + di;
        let ends: Vec<f64> = grid.coord[6 * pillar..6 * pillar + 6]
            .iter()
            .map(|v| (*v).into())
            .collect();
        let along = (z - ends[2]) / (ends[5] - ends[2]);
        let along = if along.is_finite() { along } else { 0.0 };
        let at = |n: usize| ends[n] + along * (ends[n + 3] - ends[n]);
        [at(0), at(1), z]
    };
    (0..8).map(corner).collect()
}

fn check_local(grid: &LocalGrid, facts: &Value) {
    assert_eq!(grid.name, facts["name"].as_str().unwrap());
    assert_eq!(grid.parent, facts["parent"].as_str().unwrap());
    let found = usize::try_from(grid.number).unwrap();
    assert_eq!(found, number(&facts["grid_number_GRIDHEAD5"]));
    let sectors = number(&facts["gridhead_ITEM27_NTHETA_0_if_cartesian"]);
    assert_eq!(grid.is_radial, sectors > 0);
    let hosts: HashSet<i32> = grid.host.iter().copied().collect();
    assert_eq!(hosts.len(), number(&facts["distinct_host_cells"]));
    let shape = &facts["grid"];
    let dims = ["ni", "nj", "nk"].map(|n| number(&shape[n]));
    assert_eq!(grid.dims, dims);
    assert_eq!(grid.active(), number(&shape["active_cells"]));
    for cell in facts["cells"].as_array().unwrap() {
        let place = cell["ijk"].as_array().unwrap();
        let ijk = [0, 1, 2].map(|n| number(&place[n]) - 1);
        for (mine, fact) in corners(grid, ijk)
            .iter()
            .zip(cell["corners"].as_array().unwrap())
        {
            let fact = [0, 1, 2].map(|n| fact[n].as_f64().unwrap());
            let is_near = mine.iter().zip(fact).all(|(a, b)| (a - b).abs() < 1e-3);
            assert!(is_near, "{ijk:?}: {mine:?} {fact:?}");
        }
    }
}

#[test]
fn ok_grids_and_connections_agree_with_other_programs() {
    for case in CASES {
        let Some((grid, facts)) = facts(case) else {
            return;
        };
        let locals = facts["lgrs"].as_array().unwrap();
        assert_eq!(grid.local_grids.len(), locals.len());
        for (local, facts) in grid.local_grids.iter().zip(locals) {
            check_local(local, facts);
            let [low, high] = local.host_box.unwrap();
            let hosts: i32 = low.iter().zip(high).map(|(a, b)| b - a + 1).product();
            let distinct: HashSet<i32> = local.host.iter().copied().collect();
            assert_eq!(usize::try_from(hosts), Ok(distinct.len()));
        }
        let sum = |is: fn([i32; 2]) -> bool| {
            let lists = grid.local_nnc.iter().filter(|list| is(list.grids));
            lists.map(|list| list.cells.len()).sum::<usize>()
        };
        let nnc = &facts["nnc"];
        assert_eq!(grid.nnc.len(), number(&nnc["nnc_global_global"]));
        assert_eq!(sum(|[a, b]| a == b), number(&nnc["nnc_within_lgrs"]));
        let to_host = number(&nnc["nnc_lgr_to_host_pairs_NNCL_NNCG"]);
        assert_eq!(sum(|[_, b]| b == 0), to_host);
    }
}

#[test]
fn ok_arrays_by_grid() {
    for case in CASES {
        let Some((grid, _)) = facts(case) else {
            return;
        };
        let mut warnings = Warnings::default();
        let path = data(case).unwrap().with_extension("INIT");
        let arrays = init::open(&path, &mut warnings).unwrap();
        // The global grid has its own alone.
        let cells = grid.zcorn.len() as u64 / 8;
        for name in ["PORO", "PVTNUM"] {
            assert_eq!(arrays.find(name).unwrap().count, cells);
            assert_eq!(arrays.iter().filter(|e| e.name() == name).count(), 1);
        }
        assert_eq!(arrays.find("TRANNNC").unwrap().count, grid.nnc.len() as u64);
        let locals = arrays.local_grids().unwrap();
        let names: Vec<&str> = locals.iter().map(|l| l.name.as_str()).collect();
        let expected: Vec<&str> = grid.local_grids.iter().map(|l| l.name.as_str()).collect();
        assert_eq!(names, expected);
        for (local, grid_of) in locals.iter().zip(&grid.local_grids) {
            let count = |name: &str| local.arrays.find(name).map(|e| e.count);
            let active = grid_of.active() as u64;
            assert_eq!([count("PORO"), count("PVTNUM")], [Some(active); 2]);
            let head = local.arrays.head().unwrap();
            assert_eq!(head.dims.map(|n| n as usize), grid_of.dims);
            let connections = |grids: [i32; 2]| {
                let lists = grid.local_nnc.iter().filter(|list| list.grids == grids);
                lists.map(|list| list.cells.len() as u64).sum::<u64>()
            };
            let number = grid_of.number;
            assert_eq!(count("TRANNNC"), Some(connections([number; 2])));
            assert_eq!(count("TRANGL"), Some(connections([number, 0])));
        }
    }
}

#[test]
fn ok_steps_by_grid() {
    let Some(path) = data("lgr_nnc/LGR_TESTMOD.UNRST") else {
        return;
    };
    let mut warnings = Warnings::default();
    let steps = restart::open_unified(&path, &mut warnings).unwrap();
    assert_eq!(steps.len(), 4);
    for step in &steps {
        let locals = step.arrays.local_grids().unwrap();
        let counts: BTreeMap<&str, u64> = locals
            .iter()
            .map(|l| (l.name.as_str(), l.arrays.find("PRESSURE").unwrap().count))
            .collect();
        assert_eq!(counts, BTreeMap::from([("LGR1", 128), ("LGR2", 192)]));
        assert_eq!(step.arrays.find("PRESSURE").unwrap().count, 30);
    }
}

/// A grid in a grid in a grid, with connections between the local ones.
#[test]
fn ok_nested_grids() {
    let mut out = RecordWriter::new(Vec::new());
    let mut write_grid = |head: &[i32; 5]| {
        out.inte("GRIDHEAD", head).unwrap();
        let [_, ni, nj, nk, _] = head.map(|n| n as usize);
        let coord = vec![1.0; 6 * (ni + 1) * (nj + 1)];
        out.real("COORD", &coord).unwrap();
        out.real("ZCORN", &vec![2.0; 8 * ni * nj * nk]).unwrap();
        if head[4] > 0 {
            let host = vec![1; ni * nj * nk];
            out.inte("HOSTNUM", &host).unwrap();
            out.mess("ENDGRID").unwrap();
            out.mess("ENDLGR").unwrap();
        }
        match head[4] {
            0 => out.chars("LGR", &["OUTER"]).unwrap(),
            1 => {
                out.chars("LGR", &["INNER"]).unwrap();
                out.chars("LGRPARNT", &["OUTER"]).unwrap();
            }
            2 => {
                // Damaged: it has no ZCORN.
                out.chars("LGR", &["BROKEN"]).unwrap();
                out.inte("GRIDHEAD", &[1, 1, 1, 1, 3]).unwrap();
                out.mess("ENDLGR").unwrap();
                for (name, values) in [
                    ("NNCHEADA", [1, 2]),
                    ("NNA1", [1, 8]),
                    ("NNA2", [3, 99]),
                    ("NNCHEAD", [1, 3]),
                    ("NNCL", [1, 1]),
                    ("NNCG", [1, 1]),
                ] {
                    out.inte(name, &values).unwrap();
                }
            }
            _ => {}
        }
    };
    write_grid(&[1, 2, 1, 1, 0]);
    write_grid(&[1, 2, 2, 2, 1]);
    write_grid(&[1, 3, 1, 1, 2]);
    let bytes = out.finish().unwrap();
    let mut warnings = Warnings::default();
    let grid = Egrid::from_bytes(("A.EGRID", bytes), &mut warnings).unwrap();
    let names: Vec<_> = grid
        .local_grids
        .iter()
        .map(|g| (g.name.as_str(), g.parent.as_str(), g.number))
        .collect();
    assert_eq!(names, [("OUTER", "", 1), ("INNER", "OUTER", 2)]);
    assert_eq!(grid.local_grids[1].host, [1, 1, 1]);
    let list = GridConnections {
        grids: [1, 2],
        cells: vec![[1, 3]],
    };
    assert_eq!(grid.local_nnc, [list]);
    let said: Vec<_> = warnings.iter().map(|w| w.message.clone()).collect();
    assert_eq!(
        said,
        [
            "local grid BROKEN was left out: COORD: is missing; a grid needs GRIDHEAD, COORD and ZCORN",
            "3 of 4 connections name cells outside the grid, or of a grid that is not there: left out"
        ]
    );
}

/// The main grid of a file as a deck, with a CARFIN for each of its local grids, and a RADFIN4 for radial ones.
fn deck_of(grid: &Egrid) -> String {
    let [ni, nj, nk] = grid.dims;
    let array = |values: &[f32]| {
        let mut text = String::new();
        values.iter().for_each(|v| writeln!(text, "{v}").unwrap());
        text
    };
    let (coord, zcorn) = (array(&grid.coord), array(&grid.zcorn));
    let mut deck = format!("SPECGRID\n{ni} {nj} {nk} 1 F /\nCOORD\n{coord}/\nZCORN\n{zcorn}/\n");
    for local in &grid.local_grids {
        let [low, high] = local.host_box.unwrap();
        let keyword = ["CARFIN", "RADFIN4"][usize::from(local.is_radial)];
        let mut record = format!("{keyword}\n '{}'", local.name);
        for axis in 0..3 {
            write!(record, " {} {}", low[axis], high[axis]).unwrap();
        }
        let [ni, nj, nk] = local.dims;
        let rings = if local.is_radial { RINGS } else { "" };
        writeln!(deck, "{record} {ni} {nj} {nk} /\n{rings}ENDFIN").unwrap();
    }
    deck
}

/// The radii of the radial local grid of LGR_TESTMOD: each of its first five is the one before times the same factor.
const RINGS: &str = "INRAD\n 0.2 /\nOUTRAD\n 92.699106 /\n";

fn read_deck(text: &str) -> Grdecl {
    let files = MemoryFiles::from_iter([("A.DATA", text.as_bytes().to_vec())]);
    let mut warnings = Warnings::default();
    let grid = Grdecl::read_from(&files, Path::new("A.DATA"), &[], &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    grid
}

/// How far the corners of cells are apart at most.
fn apart(a: &LocalGrid<f64>, b: &LocalGrid) -> f64 {
    assert_eq!((&a.name, &a.parent, a.dims), (&b.name, &b.parent, b.dims));
    assert_eq!((&a.host, a.number), (&b.host, b.number));
    let [ni, nj, nk] = a.dims;
    let mut most = 0.0_f64;
    for cell in 0..ni * nj * nk {
        let ijk = [cell % ni, cell / ni % nj, cell / (ni * nj)];
        let pairs = corners(a, ijk).into_iter().zip(corners(b, ijk));
        let off = pairs.flat_map(|(a, b)| [0, 1, 2].map(|n| (a[n] - b[n]).abs()));
        most = off.fold(most, f64::max);
    }
    most
}

#[test]
fn local_grids_of_a_deck_are_those_of_the_simulator() {
    for (case, count) in CASES.iter().zip([2, 2]) {
        let Some((file, _)) = facts(case) else {
            return;
        };
        let text = deck_of(&file);
        let deck = read_deck(&text);
        assert_eq!(deck.local_grids.len(), count);
        for (local, expected) in deck.local_grids.iter().zip(&file.local_grids) {
            let off = apart(&local.grid, expected);
            // The file has the sides of a tilted column at its middle, and angles in degrees.
            let most = if expected.is_radial { 1e-2 } else { 2e-3 };
            assert!(off < most, "{case} {}: {off}", local.grid.name);
            assert_eq!(local.grid.is_radial, expected.is_radial);
        }
        // One that divides its hosts unevenly is another one.
        let first = &deck.local_grids[0].grid;
        let mut sizes = vec!["1"; first.dims[0]];
        sizes[0] = "2";
        let uneven = text.replacen(
            "ENDFIN",
            &format!("HXFIN\n{} /\nENDFIN", sizes.join(" ")),
            1,
        );
        let uneven = read_deck(&uneven);
        assert!(apart(&uneven.local_grids[0].grid, &file.local_grids[0]) > 0.1);
        if text.contains(RINGS) {
            let other = read_deck(&text.replace("92.699106", "90"));
            assert!(apart(&other.local_grids[1].grid, &file.local_grids[1]) > 0.1);
        }
    }
}
