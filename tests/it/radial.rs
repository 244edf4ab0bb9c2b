//! Radial local grids: sectors lie in the columns that they refine, and those of a deck are those of the simulator.

use glam::DVec3;
use strataray::case::{Case, load};
use strataray::model::Grid;
use strataray_parsers::Warnings;
use strataray_parsers::egrid::Egrid;

use crate::common::{self, tiny};

const FILE: &str = "lgr_nnc/LGR_TESTMOD.EGRID";

fn number(grid: &Grid, name: &str) -> usize {
    let mut patches = grid.patches().iter();
    patches.position(|patch| patch.name == name).unwrap()
}

/// Middles of a local grid's cells of the outermost ring and of their hosts, on the map.
fn middles(grid: &Grid, patch: usize) -> Vec<[DVec3; 2]> {
    let rings = grid.patches()[patch].dims.ni;
    let cells = grid.active_in(patch);
    let cells = cells.filter(|(_, at)| grid.cell_name(*at).ijk[0] == rings);
    let middle = |at| grid.hexahedron(at).center().with_z(0.0);
    let hosts: std::collections::HashMap<_, _> = grid.hosts_of(patch).collect();
    cells
        .map(|(_, at)| [middle(at), middle(hosts[&at])])
        .collect()
}

#[test]
fn sectors_lie_in_the_columns_that_they_refine() {
    let Some(path) = common::data(FILE) else {
        return;
    };
    let case = load::open(&path).unwrap();
    let pairs = middles(&case.grid, number(&case.grid, "LGR2"));
    assert_eq!(pairs.len(), 32);
    let far = |turn: fn(DVec3, DVec3) -> DVec3| {
        let around = pairs.iter().map(|pair| pair[1]).sum::<DVec3>() / pairs.len() as f64;
        let far = pairs
            .iter()
            .map(|[cell, host]| turn(*cell, around).distance(*host));
        far.fold(0.0, f64::max)
    };
    // Hosts are 100 m wide. Mirrored sectors would lie in other columns.
    assert!(far(|cell, _| cell) < 60.0);
    let mirrored = |cell: DVec3, around: DVec3| cell.with_y(2.0 * around.y - cell.y);
    assert!(far(mirrored) > 80.0);
}

/// The grid of the file as a deck, with its radial local grid by RADFIN4.
fn deck(grid: &Egrid, outer: f64) -> String {
    let [ni, nj, nk] = grid.dims;
    let [coord, zcorn] = [&grid.coord, &grid.zcorn].map(|values| tiny::numbers(values));
    format!(
        "GRID\nSPECGRID\n{ni} {nj} {nk} 1 F /\nGRIDUNIT\nMETRES /\nCOORD\n{coord} /\nZCORN\n{zcorn} /\n\
         RADFIN4\nLGR2 1 2 2 3 4 5 6 8 4 /\nINRAD\n0.2 /\nOUTRAD\n{outer} /\nENDFIN\nPORO\n26*0.2 0.21 0.22 0.23 0.24 /\n"
    )
}

#[test]
fn a_deck_has_the_rings_of_its_simulator() {
    let Some(path) = common::data(FILE) else {
        return;
    };
    let file = Egrid::read(&path, &mut Warnings::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let open = |outer: f64| {
        let text = deck(&file, outer);
        load::open(&tiny::write(folder.path(), "A.DATA", text)).unwrap()
    };
    let simulated = load::open(&path).unwrap();
    let apart = |case: &Case| {
        let [a, b] = [&simulated.grid, &case.grid];
        let [of_a, of_b] = [a, b].map(|grid| number(grid, "LGR2"));
        let cells = a.active_in(of_a).zip(b.active_in(of_b));
        let mut most = 0.0_f64;
        for ((_, at), (_, other)) in cells {
            assert_eq!(a.cell_name(at), b.cell_name(other));
            let pairs = a.hexahedron(at).0.into_iter().zip(b.hexahedron(other).0);
            most = pairs.map(|(a, b)| a.distance(b)).fold(most, f64::max);
        }
        most
    };
    let case = open(92.699_106);
    assert_eq!(case.grid.active_in(1).count(), 192);
    assert!(apart(&case) < 0.02, "{}", apart(&case));
    assert!(apart(&open(90.0)) > 0.1);
    // Sectors have the values of their columns: the first of a layer is in the one at I 2, J 2.
    let values = case.field("PORO", 0).unwrap().values().to_vec();
    let last = case.grid.active_in(1).filter(|(_, at)| {
        let [i, _, k] = case.grid.cell_name(*at).ijk;
        i == 1 && k == 3
    });
    let mut last: Vec<(usize, f32)> = last
        .map(|(n, at)| (case.grid.cell_name(at).ijk[1], values[n]))
        .collect();
    last.sort_by_key(|(j, _)| *j);
    let last: Vec<f32> = last.into_iter().map(|(_, value)| value).collect();
    assert_eq!(last, [0.22, 0.22, 0.21, 0.21, 0.23, 0.23, 0.24, 0.24]);
}
