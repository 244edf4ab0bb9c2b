//! Decks that are written in other ways, or that a simulator changes on its way in.

use strataray::case::Case;

use super::{info, inputs, names, near, open, stats, told};
use crate::common::{self, tiny};

fn active(case: &Case) -> usize {
    case.grid.active_cells().len()
}

/// A block-centered deck of four layers, of 10, 20, 5 and 5 m.
fn blocks(sizes: &str) -> String {
    format!("RUNSPEC\nTITLE\n block\nDIMENS\n 6 5 4 /\nMETRIC\nOIL\nWATER\nGRID\n{sizes}")
}

#[test]
fn f04_block_centered_grids() {
    let folder = tempfile::tempdir().unwrap();
    let arrays = "DX\n 120*100 /\nDY\n 120*80 /\nDZ\n 30*10 30*20 60*5 /\nTOPS\n 30*2000 /\nPORO\n 120*0.2 /\n";
    let equals = "EQUALS\n 'DX' 100 /\n 'DY' 80 /\n 'DZ' 10 1 6 1 5 1 1 /\n 'DZ' 20 1 6 1 5 2 2 /\n \
                  'DZ' 5 1 6 1 5 3 4 /\n 'TOPS' 2000 1 6 1 5 1 1 /\n/\n";
    let vectors = "DXV\n 6*100 /\nDYV\n 5*80 /\nDZV\n 10 20 5 5 /\nTOPS\n 30*2000 /\n";
    for (reported, sizes) in [
        ("F04_DXDYDZ.DATA", arrays),
        ("F04_EQUALS.DATA", equals),
        ("F04_DXDYDZ.DATA", vectors),
    ] {
        for path in inputs(
            reported,
            tiny::write(folder.path(), "A.DATA", blocks(sizes)),
        ) {
            let case = open(&path);
            assert_eq!(active(&case), 120);
            near(&[case.grid.signed_bulk_volume()], &[9.6e6]);
            let depths = case.field("DEPTH", 0).unwrap();
            near(&[f64::from(depths.values()[30])], &[2020.0]);
        }
    }
}

#[test]
fn a_deck_of_dual_porosity_shows_its_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = "DX\n 120*100 /\nDY\n 120*80 /\nDZ\n 30*10 30*20 60*5 /\nTOPS\n 30*2000 /\nPORO\n 60*0.2 60*0.01 /\n";
    let single = tiny::write(folder.path(), "A.DATA", blocks(sizes));
    assert_eq!(active(&open(&single)), 120);
    let dual = blocks(sizes).replace("METRIC", "METRIC\nDUALPORO");
    let case = open(&tiny::write(folder.path(), "B.DATA", dual));
    assert_eq!(active(&case), 60);
    near(&[case.grid.signed_bulk_volume()], &[7.2e6]);
    near(&stats(&case, "PORO", 0), &[0.2, 0.2, 0.2]);
    near(&stats(&case, "PORO.FRACTURE", 0), &[0.01, 0.01, 0.01]);
}

#[test]
fn fractures_of_a_deck_have_values_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = "DX\n 120*100 /\nDY\n 120*80 /\nDZ\n 30*10 30*20 60*5 /\nTOPS\n 30*2000 /\nPORO\n 60*0.2 60*0.05 /\n\
                 PERMX\n 60*1 60*1000 /\nACTNUM\n 60*1 30*1 30*0 /\nMULTIPLY\n PERMX 2 1 6 1 5 2 3 /\n/\n\
                 SOLUTION\nSWAT\n 60*0.2 60*0.7 /\n";
    let text = blocks(sizes).replace("METRIC", "METRIC\nDUALPORO");
    let case = open(&tiny::write(folder.path(), "A.DATA", &text));
    assert_eq!(case.about.porosity_model, "dual");
    let values = |name: &str| {
        let field = case.field(name, 0).unwrap();
        [field.values()[0], field.values()[30]].map(f64::from)
    };
    // The box of MULTIPLY reaches over the second layer of the matrix and the first one of the fractures.
    near(&values("PERMX"), &[1.0, 2.0]);
    near(&values("PERMX.FRACTURE")[..1], &[2000.0]);
    // Fractures of the second layer are inactive.
    assert!(values("PERMX.FRACTURE")[1].is_nan());
    // By pore volume, of which the matrix of the first layer has 0.2 and the fractures 0.05 of the same rock.
    near(
        &values("SWAT.TOTAL"),
        &[(0.2 * 0.2 + 0.05 * 0.7) / 0.25, 0.2],
    );
    near(&values("PORV")[..1], &[100.0 * 80.0 * 10.0 * 0.2]);
    assert!(!names(&case).contains(&"PORO.TOTAL") && !names(&case).contains(&"DX.FRACTURE"));
    told(&case, &["PERMX.FRACTURE", "NODPPM"]);
    let effective = text.replace("DUALPORO", "DUALPORO\nNODPPM");
    let case = open(&tiny::write(folder.path(), "B.DATA", effective));
    assert!(!case.about.notes.iter().any(|n| n.contains("NODPPM")));
    // As one porosity the same text is four layers, without fractures.
    let case = open(&tiny::write(
        folder.path(),
        "C.DATA",
        text.replace("DUALPORO", ""),
    ));
    assert_eq!(active(&case), 90);
    assert!(!names(&case).iter().any(|name| name.contains('.')));
}

#[test]
fn fractures_without_pore_volume_leave_the_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = "DX\n 120*100 /\nDY\n 120*80 /\nDZ\n 120*10 /\nTOPS\n 30*2000 /\nPORO\n 30*0.2 30*0 30*0 30*0.1 /\n";
    let text = blocks(sizes).replace("METRIC", "METRIC\nDUALPERM");
    let case = open(&tiny::write(folder.path(), "A.DATA", &text));
    assert_eq!(active(&case), 60);
    let values = |name: &str| case.field(name, 0).unwrap().values().to_vec();
    let [matrix, fractures] = ["PORO", "PORO.FRACTURE"].map(values);
    assert!(matrix[0] > 0.0 && fractures[0].is_nan());
    assert!(matrix[30].is_nan() && fractures[30] > 0.0);
    // Where neither has any, there is no cell.
    let none = text.replace("30*0 30*0 30*0.1", "30*0 60*0");
    let case = open(&tiny::write(folder.path(), "B.DATA", none));
    assert_eq!(active(&case), 30);
}

#[test]
fn a_radial_deck_closes_its_circle() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "RUNSPEC\nRADIAL\nDIMENS\n 2 4 1 /\nMETRIC\nOIL\nWATER\nGRID\nINRAD\n 100 /\nDRV\n 2*100 /\n\
                DTHETAV\n 4*90 /\nCOORDSYS\n 1 1 'COMP' /\nDZ\n 8*10 /\nTOPS\n 8*2000 /\nPORO\n 8*0.2 /\n";
    let case = open(&tiny::write(folder.path(), "A.DATA", deck));
    assert_eq!(active(&case), 8);
    // Squares of half diagonals 100, 200 and 300, 10 m high.
    near(&[case.grid.signed_bulk_volume()], &[1.6e6]);
    told(&case, &["radial", "36.3 %"]);
}

#[test]
fn f09_tables_are_no_properties() {
    let folder = tempfile::tempdir().unwrap();
    let table: String = (0..30)
        .map(|n| format!(" {} 0.1 0.2 0\n", 0.01 * f64::from(n)))
        .collect();
    let deck = format!(
        "RUNSPEC\nOIL\nWATER\nGRID\n{}PROPS\nSWOF\n{table} /\nPVDO\n{table} /\nSWL\n120*0.1 /\nSOLUTION\n",
        tiny::grid_text()
    );
    let built = tiny::write(folder.path(), "A.DATA", deck);
    let case = open(&built);
    assert!(names(&case).contains(&"SWL"));
    for path in inputs("F09_TABLES.DATA", built) {
        let case = open(&path);
        let found = names(&case);
        assert!(
            !found.contains(&"SWOF") && !found.contains(&"PVDO"),
            "{found:?}"
        );
        assert!(found.contains(&"PORO"));
    }
}

#[test]
fn f12_byte_order_mark() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("\u{feff}{}", tiny::grid_text());
    for path in inputs(
        "F12_BOM.GRDECL",
        tiny::write(folder.path(), "A.GRDECL", text),
    ) {
        let case = open(&path);
        assert_eq!((active(&case), case.about.notes.len()), (120, 0));
        near(&stats(&case, "PORO", 0), &[0.1, 0.219, 0.1595]);
    }
}

#[test]
fn f13_included_files_in_another_letter_case() {
    let folder = tempfile::tempdir().unwrap();
    tiny::write(folder.path(), "Include/Deep/Grid.GRDECL", tiny::grid_text());
    let deck =
        "RUNSPEC\nDIMENS\n 6 5 4 /\nMETRIC\nGRID\nINCLUDE\n 'INCLUDE\\deep\\GRID.grdecl' /\n";
    let built = tiny::write(folder.path(), "A.DATA", deck);
    for path in inputs("F13_case/F13.DATA", built) {
        assert_eq!(stats(&open(&path), "PORO", 0)[0], f64::from(0.1_f32));
    }
}

#[test]
fn f14_geometry_of_another_file() {
    let folder = tempfile::tempdir().unwrap();
    tiny::write_egrid(folder.path(), "GEOM", &tiny::egrid());
    let deck = |file: &str| {
        let poro = tiny::porosity_text();
        format!("RUNSPEC\nDIMENS\n 6 5 4 /\nMETRIC\nOIL\nWATER\nGRID\nGDFILE\n '{file}' /\n{poro}")
    };
    let built = tiny::write(folder.path(), "A.DATA", deck("GEOM.EGRID"));
    for path in inputs("F14_GDFILE.DATA", built) {
        let case = open(&path);
        near(&[case.grid.signed_bulk_volume()], &[9.6e6]);
        near(&stats(&case, "PORO", 0), &[0.1, 0.219, 0.1595]);
        assert!(case.about.notes.is_empty(), "{:?}", case.about.notes);
    }
    let failure = |text: String| {
        let path = tiny::write(folder.path(), "B.DATA", text);
        strataray::case::load::open(&path)
            .err()
            .unwrap()
            .to_string()
    };
    let gone = failure(deck("GONE.EGRID"));
    assert!(
        gone.contains("GDFILE") && gone.contains("GONE.EGRID"),
        "{gone}"
    );
    let other = failure(deck("GEOM.EGRID").replace("6 5 4", "6 5 5"));
    assert!(
        other.contains("6 x 5 x 5") && other.contains("6 x 5 x 4"),
        "{other}"
    );
}

#[test]
fn f15_depths_that_a_deck_shifts() {
    let folder = tempfile::tempdir().unwrap();
    let grid = tiny::grid_text();
    let deck = format!("RUNSPEC\nMETRIC\nGRID\n{grid}ADDZCORN\n 50 1 3 1 5 1 4 /\n/\n");
    let built = tiny::write(folder.path(), "A.DATA", deck);
    let plain = open(&tiny::write(folder.path(), "B.GRDECL", grid));
    let [shifted, plain] = [open(&built), plain].map(|case| case.field("DEPTH", 0).unwrap());
    for (cell, (a, b)) in shifted.values().iter().zip(plain.values()).enumerate() {
        let expected = if cell % 6 < 3 { 50.0 } else { 0.0 };
        near(&[f64::from(a - b)], &[expected]);
    }
    for path in inputs("F15_ADDZCORN.DATA", built).iter().skip(1) {
        // Column 4 is 17 m deeper than column 3, which is shifted by 50 m.
        let field = open(path).field("DEPTH", 0).unwrap();
        let [west, east] = [2, 3].map(|cell| f64::from(field.values()[cell]));
        near(&[west - east], &[33.0]);
    }
}

#[test]
fn f17_pflotran_writes_decks_like_this() {
    let folder = tempfile::tempdir().unwrap();
    let rest = tiny::grid_text().replace("SPECGRID\n 6 5 4 1 F /\n", "");
    tiny::write(folder.path(), "geom.grdecl", &rest);
    let outer = tiny::write(
        folder.path(),
        "A.grdecl",
        "DIMENS\n 6 5 4 /\n\nexternal_file geom.grdecl\n",
    );
    let four = tiny::write(
        folder.path(),
        "B.grdecl",
        format!("SPECGRID\n 6 5 4  F  /\n{rest}"),
    );
    let inputs = [
        inputs("F17_pflotran.grdecl", outer),
        inputs("F17_spec4.grdecl", four),
    ];
    for path in inputs.concat() {
        let dims = open(&path).grid.dims();
        assert_eq!([dims.ni, dims.nj, dims.nk], [6, 5, 4], "{}", path.display());
    }
}

#[test]
fn f24_cells_below_the_least_pore_volume() {
    let folder = tempfile::tempdir().unwrap();
    let grid = tiny::grid_text().replace(&tiny::porosity_text(), "PORO\n 60*0.0 60*0.2 /\n");
    let deck = |units: &str, rest: &str| {
        let text = format!("RUNSPEC\n{units}\nOIL\nWATER\nGRID\n{grid}{rest}");
        tiny::write(folder.path(), "A.DATA", text)
    };
    let built = deck("METRIC", "MINPV\n 1000 /\n");
    let case = open(&built);
    told(&case, &["60 cells", "MINPV (1000)", "inactive"]);
    for path in inputs("F24_MINPV.DATA", built) {
        let case = open(&path);
        assert_eq!(active(&case), 60);
        near(&stats(&case, "PORO", 0), &[0.2, 0.2, 0.2]);
    }
    // Cells of 80,000 units of volume: 16,000 RM3 or FT3 of pores, which are 2,850 RB.
    for (units, rest, expected) in [
        ("METRIC", "MINPV\n 16001 /\n", 0),
        ("METRIC", "MINPV\n 15999 /\n", 60),
        ("METRIC", "NTG\n 120*0.5 /\nMINPV\n 8001 /\n", 0),
        ("FIELD", "MINPV\n 2849 /\n", 60),
        ("FIELD", "MINPV\n 2851 /\n", 0),
        ("METRIC", "EDIT\nPORV\n 30*5 30* 60*7 /\n", 90),
        ("METRIC", "EDIT\nEQUALS\n PORV 7 1 6 1 5 1 1 /\n/\n", 90),
        // Net to gross and factors on pore volumes leave no pores; what EDIT gives does.
        ("METRIC", "NTG\n 90*1 30*0 /\n", 30),
        ("METRIC", "EDIT\nMULTPV\n 90*1 30*0 /\n", 30),
        ("METRIC", "EDIT\nMULTIPLY\n PORV 0 1 6 1 5 4 4 /\n/\n", 30),
        ("METRIC", "NTG\n 90*1 30*0 /\nEDIT\nPORV\n 90* 30*5 /\n", 60),
        ("METRIC", "PINCH\n/\n", 60),
    ] {
        assert_eq!(
            active(&open(&deck(units, rest))),
            expected,
            "{units} {rest}"
        );
    }
    told(
        &open(&deck("METRIC", "")),
        &["60 cells without pore volume"],
    );
    // A grid that is no whole deck is left as it is.
    let alone = tiny::write(folder.path(), "B.GRDECL", &grid);
    assert_eq!(active(&open(&alone)), 120);
}

#[test]
fn what_a_deck_asks_for_and_is_not_done_marks_the_property() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{}PERMX\n 120*5 /\nMULTIREG\n PORO 2 1 M /\n/\n",
        tiny::grid_text()
    );
    let path = tiny::write(folder.path(), "A.GRDECL", text);
    let case = open(&path);
    let doubt = |name: &str| case.property(name).unwrap().doubt.clone();
    assert_eq!(
        doubt("PORO").as_deref(),
        Some("MULTIREG of the deck was not applied")
    );
    assert_eq!(doubt("PERMX"), None);
    told(&case, &["MULTIREG was not applied to PORO"]);
    let facts = info([&path]);
    let properties = facts["properties"].as_array().unwrap();
    let poro = properties.iter().find(|p| p["name"] == "PORO").unwrap();
    assert_eq!(poro["doubt"], "MULTIREG of the deck was not applied");
}

/// Decks give the values that a simulator wrote after reading them.
#[test]
fn decks_agree_with_the_results_of_their_runs() {
    for (deck, results, copied) in [
        ("reek/deck/model/REEK.DATA", "reek/REEK.EGRID", ""),
        ("spe9/deck/SPE9_CP.DATA", "spe9/SPE9_CP.EGRID", ""),
        // Alone in its folder, so that nothing but the deck is read.
        (
            "spe1/SPE1CASE1.DATA",
            "spe1/SPE1CASE1.EGRID",
            "SPE1CASE1.DATA",
        ),
    ] {
        let (Some(mut deck), Some(results)) = (common::data(deck), common::data(results)) else {
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        if !copied.is_empty() {
            deck = tiny::write(folder.path(), copied, std::fs::read(&deck).unwrap());
        }
        let [deck, results] = [open(&deck), open(&results)];
        assert_eq!(deck.grid.active_cells(), results.grid.active_cells());
        let [a, b] = [&deck, &results].map(|case| case.grid.bounds().unwrap());
        assert!(
            a[0].distance(b[0]) < 1.0 && a[1].distance(b[1]) < 1.0,
            "{a:?} {b:?}"
        );
        let both = [
            "PORO", "PERMX", "PERMY", "PERMZ", "SWL", "SWCR", "EQLNUM", "FIPNUM", "SATNUM", "DZ",
        ];
        let mut compared = 0;
        for name in both
            .into_iter()
            .filter(|n| names(&deck).contains(n) && names(&results).contains(n))
        {
            let [a, b] = [&deck, &results].map(|case| case.field(name, 0).unwrap());
            let apart = |(a, b): (&f32, &f32)| (a - b).abs() > 1e-5 * b.abs();
            let differ = a
                .values()
                .iter()
                .zip(b.values())
                .filter(|p| apart(*p))
                .count();
            assert_eq!(differ, 0, "{name} of {}", deck.about.name);
            compared += 1;
        }
        assert!(compared >= 4, "{compared}");
    }
}
