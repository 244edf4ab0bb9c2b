//! Local grids of decks of dual porosity, beside files of results with the same cells.

use std::path::Path;

use strataray::case::{Case, load};
use strataray_parsers::Warnings;
use strataray_parsers::deck::{DeckProperty, Grdecl};
use strataray_parsers::records::RecordWriter;

use crate::common::tiny;

/// Two columns of two layers, of which the second one is refined; its last fracture has a porosity of its own.
const DECK: &str = "RUNSPEC\nDUALPORO\nMETRIC\nOIL\nWATER\nDIMENS\n2 1 4 /\nGRID\nDXV\n2*10 /\nDYV\n10 /\nDZV\n4*4 /\n\
    TOPS\n2*100 6* /\nPORO\n0.1 0.2 0.3 0.4 0.01 0.02 0.03 0.04 /\nACTNUM\n6*1 1 0 /\n\
    CARFIN\nA 2 2 1 1 1 2 2 1 8 /\nEQUALS\n PORO 0.9 1 1 1 1 6 6 /\n/\nENDFIN\n";

/// Of an array the values of the cells that have a matrix, then of those that have fractures.
fn results(property: &DeckProperty, actnum: &[i32]) -> Vec<f32> {
    let half = |part: i32, first: usize| {
        let cells = actnum.iter().enumerate();
        let cells = cells.filter(move |(_, active)| *active & part != 0);
        cells.map(move |(cell, _)| property.values[first + cell] as f32)
    };
    half(1, 0).chain(half(2, actnum.len())).collect()
}

fn porosity(properties: &[DeckProperty]) -> &DeckProperty {
    properties.iter().find(|p| p.name == "PORO").unwrap()
}

/// Writes the grid file and the file of porosities that a simulator makes of a deck, of which `off` is added to that of
/// the last fracture.
fn write_results(folder: &Path, deck: &Grdecl, off: f32) {
    let narrow = |values: &[f64]| values.iter().map(|v| *v as f32).collect::<Vec<f32>>();
    let dims = |dims: [usize; 3]| dims.map(|n| i32::try_from(n).unwrap());
    let local = &deck.local_grids[0];
    let mut out = RecordWriter::new(Vec::new());
    let mut head = vec![0; 100];
    head[5] = 1;
    out.inte("FILEHEAD", &head).unwrap();
    let [ni, nj, nk] = dims(deck.dims);
    out.inte("GRIDHEAD", &[1, ni, nj, nk, 0]).unwrap();
    out.real("COORD", &narrow(&deck.coord)).unwrap();
    out.real("ZCORN", &narrow(&deck.zcorn)).unwrap();
    let actnum = deck.actnum.as_deref().unwrap();
    out.inte("ACTNUM", actnum).unwrap();
    out.mess("ENDGRID").unwrap();
    out.chars("LGR", &[local.grid.name.as_str()]).unwrap();
    let [ni, nj, nk] = dims(local.grid.dims);
    out.inte("GRIDHEAD", &[1, ni, nj, nk, 1]).unwrap();
    out.real("COORD", &narrow(&local.grid.coord)).unwrap();
    out.real("ZCORN", &narrow(&local.grid.zcorn)).unwrap();
    let active = local.grid.actnum.as_deref().unwrap();
    out.inte("ACTNUM", active).unwrap();
    out.inte("HOSTNUM", &local.grid.host).unwrap();
    out.mess("ENDGRID").unwrap();
    out.mess("ENDLGR").unwrap();
    std::fs::write(folder.join("R.EGRID"), out.finish().unwrap()).unwrap();

    let mut out = RecordWriter::new(Vec::new());
    let main = results(porosity(&deck.properties), actnum);
    let mut own = results(porosity(&local.properties), active);
    *own.last_mut().unwrap() += off;
    let mut head = vec![0; 411];
    head[11] = i32::try_from(main.len()).unwrap();
    out.inte("INTEHEAD", &head).unwrap();
    out.real("PORO", &main).unwrap();
    out.chars("LGR", &[local.grid.name.as_str()]).unwrap();
    out.real("PORO", &own).unwrap();
    out.mess("LGRSGONE").unwrap();
    std::fs::write(folder.join("R.INIT"), out.finish().unwrap()).unwrap();
}

/// Values by active cell, those that are not there as -1.
fn values(case: &Case, name: &str) -> Vec<f32> {
    let field = case.field(name, 0).unwrap();
    let values = field.values().iter();
    values.map(|v| if v.is_nan() { -1.0 } else { *v }).collect()
}

#[test]
fn local_grids_have_matrix_and_fractures() {
    let folder = tempfile::tempdir().unwrap();
    let path = tiny::write(folder.path(), "D.DATA", DECK);
    let deck = Grdecl::read(&path, &mut Warnings::default()).unwrap();
    let case = load::open(&path).unwrap();
    let told = |case: &Case, words: &str| case.about.notes.iter().any(|n| n.contains(words));
    assert!(told(&case, "4 of matrix and 4 of fractures"));
    let counts = [0, 1].map(|patch| case.grid.active_in(patch).count());
    assert_eq!(counts, [4, 8]);
    write_results(folder.path(), &deck, 0.0);
    let results = load::open(&folder.path().join("R.EGRID")).unwrap();
    assert_eq!(results.grid.patches(), case.grid.patches());
    for name in ["PORO", "PORO.FRACTURE"] {
        assert_eq!(values(&case, name), values(&results, name), "{name}");
    }
    let fractures = values(&case, "PORO.FRACTURE");
    let of_local: Vec<f32> = case.grid.active_in(1).map(|(n, _)| fractures[n]).collect();
    assert_eq!(of_local, [0.02, 0.02, 0.9, 0.02, -1.0, -1.0, -1.0, -1.0]);
    // Pore volumes of a quarter of the host's.
    let volumes = values(&case, "PORV.FRACTURE");
    let of_local = case.grid.active_in(1).map(|(n, _)| volumes[n]);
    let of_local: Vec<f32> = of_local.take(2).collect();
    assert!(
        of_local.iter().all(|v| (v - 100.0 * 0.02).abs() < 1e-4),
        "{of_local:?}"
    );
    // Results with another value are seen to differ.
    write_results(folder.path(), &deck, 0.1);
    let other = load::open(&folder.path().join("R.EGRID")).unwrap();
    assert_eq!(values(&case, "PORO"), values(&other, "PORO"));
    assert_ne!(
        values(&case, "PORO.FRACTURE"),
        values(&other, "PORO.FRACTURE")
    );
}
