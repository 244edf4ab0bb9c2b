//! The legacy GRID gives the grid that its EGRID twin gives.

use strataray_parsers::egrid::{Egrid, LocalGrid, PorosityModel};
use strataray_parsers::records::RecordWriter;
use strataray_parsers::{ErrorKind, ParseError, Warnings, case};

use super::data;

fn read(bytes: &[u8], warnings: &mut Warnings) -> Result<Egrid, ParseError> {
    Egrid::from_bytes(("A.GRID", bytes.to_vec()), warnings)
}

/// x, y and depth of a corner, as simulators compute them.
fn corner(grid: &Egrid, [i, j, k]: [usize; 3], c: usize) -> [f32; 3] {
    let [ni, nj, _] = grid.dims;
    let (di, dj, dk) = (c & 1, c >> 1 & 1, c >> 2);
    let z = grid.zcorn[2 * i + di + 2 * ni * (2 * j + dj) + 4 * ni * nj * (2 * k + dk)];
    let pillar = (j + dj) * (ni + 1) + i + di;
    let ends = &grid.coord[6 * pillar..6 * pillar + 6];
    let along = f64::from(z - ends[2]) / f64::from(ends[5] - ends[2]);
    let along = if along.is_finite() { along } else { 0.0 };
    let at = |n: usize| {
        (f64::from(ends[n]) + along * (f64::from(ends[n + 3]) - f64::from(ends[n]))) as f32
    };
    [at(0), at(1), z]
}

/// The grid as a GRID file; `is_there` says which cells it has.
fn write(
    grid: &Egrid,
    mut out: RecordWriter<Vec<u8>>,
    is_there: impl Fn([usize; 3]) -> bool,
) -> Vec<u8> {
    out.inte("DIMENS", &grid.dims.map(|n| n as i32)).unwrap();
    out.chars("MAPUNITS", &["METRES"]).unwrap();
    if let Some(axes) = grid.map_axes {
        out.real("MAPAXES", &axes.map(|v| v as f32)).unwrap();
    }
    out.chars("GRIDUNIT", &["METRES", ""]).unwrap();
    write_cells(grid, &mut out, is_there, |_| 0);
    for local in &grid.local_grids {
        match local.parent.as_str() {
            "" => out.chars("LGR", &[&local.name]).unwrap(),
            parent => out.chars("LGR", &[&local.name, parent]).unwrap(),
        }
        out.inte("DIMENS", &local.dims.map(|n| n as i32)).unwrap();
        write_cells(&alone(local), &mut out, |_| true, |n| local.host[n]);
    }
    out.finish().unwrap()
}

/// A local grid as a grid of its own.
fn alone(local: &LocalGrid) -> Egrid {
    Egrid {
        dims: local.dims,
        coord: local.coord.clone(),
        zcorn: local.zcorn.clone(),
        actnum: local.actnum.clone(),
        map_axes: None,
        local_grids: Vec::new(),
        ..small()
    }
}

fn write_cells(
    grid: &Egrid,
    out: &mut RecordWriter<Vec<u8>>,
    is_there: impl Fn([usize; 3]) -> bool,
    host: impl Fn(usize) -> i32,
) {
    let [ni, nj, nk] = grid.dims;
    for n in 0..ni * nj * nk {
        let ijk = [n % ni, n / ni % nj, n / ni / nj];
        if !is_there(ijk) {
            continue;
        }
        let [i, j, k] = ijk.map(|n| n as i32 + 1);
        let active = grid.actnum.as_ref().map_or(1, |a| a[n]);
        let coords = [i, j, k, n as i32 + 1, active, host(n), 0];
        out.inte("COORDS", &coords).unwrap();
        let corners: Vec<f32> = (0..8).flat_map(|c| corner(grid, ijk, c)).collect();
        out.real("CORNERS", &corners).unwrap();
    }
}

/// Pillars that lean, and depths all different.
fn small() -> Egrid {
    let [ni, nj, nk] = [3_u16, 2, 4];
    let pillar = |n: u16| {
        let [x, y] = [n % (ni + 1), n / (ni + 1)].map(|n| 100.0 * f32::from(n));
        [x, y, 1000.0, x + 8.0, y - 4.0, 1016.0]
    };
    let depth = |n: u16| {
        let (within, plane) = (n % (4 * ni * nj), n / (4 * ni * nj));
        // Halves of planes, so that a cell is four deep and nothing is between cells.
        1000.0 + 4.0 * f32::from(plane.div_ceil(2)) + f32::from(within % 8) / 8.0
    };
    Egrid {
        dims: [ni, nj, nk].map(usize::from),
        coord: (0..(ni + 1) * (nj + 1)).flat_map(pillar).collect(),
        zcorn: (0..8 * ni * nj * nk).map(depth).collect(),
        actnum: Some((0..ni * nj * nk).map(|n| i32::from(n % 5 != 2)).collect()),
        coarse: None,
        map_units: Some("METRES".into()),
        map_axes: Some([0.0, 1.0, 0.0, 0.0, 1.0, 0.0]),
        grid_unit: None,
        porosity_model: strataray_parsers::egrid::PorosityModel::Single,
        nnc: Vec::new(),
        local_nnc: Vec::new(),
        reservoirs: Vec::new(),
        local_grids: Vec::new(),
    }
}

fn assert_twins(twin: &Egrid, grid: &Egrid, tolerance: f32) {
    assert_eq!(twin.dims, grid.dims);
    assert_eq!(twin.zcorn, grid.zcorn);
    assert_eq!(twin.actnum, grid.actnum);
    assert_eq!(twin.map_axes, grid.map_axes);
    let [ni, nj, nk] = grid.dims;
    for n in 0..ni * nj * nk {
        let ijk = [n % ni, n / ni % nj, n / ni / nj];
        for c in 0..8 {
            let [a, b] = [corner(twin, ijk, c), corner(grid, ijk, c)];
            let off = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            assert!(off <= tolerance, "{ijk:?} {c}: {a:?} {b:?}");
        }
    }
}

#[test]
fn ok_equals_its_egrid_twin_in_both_forms() {
    let grid = small();
    for out in [
        RecordWriter::new(Vec::new()),
        RecordWriter::formatted(Vec::new()),
    ] {
        let mut warnings = Warnings::default();
        let twin = read(&write(&grid, out, |_| true), &mut warnings).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_twins(&twin, &grid, 1e-3);
        assert_eq!(twin.grid_unit.unwrap().length, "METRES");
    }
}

#[test]
fn ok_a_real_field_equals_its_egrid_twin() {
    let Some(path) = data("reek/REEK.EGRID") else {
        return;
    };
    let mut warnings = Warnings::default();
    let grid = Egrid::read(&path, &mut warnings).unwrap();
    let bytes = write(&grid, RecordWriter::new(Vec::new()), |_| true);
    let twin = read(&bytes, &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    // Map coordinates of millions of meters are half a meter apart in f32.
    assert_twins(&twin, &grid, 1.0);
}

#[test]
fn ok_local_grids_equal_their_egrid_twins() {
    for name in ["lgr_nnc/SIMPLE_SUMMARY2.EGRID", "lgr_nnc/LGR_TESTMOD.EGRID"] {
        let Some(path) = data(name) else {
            return;
        };
        let mut warnings = Warnings::default();
        let mut grid = Egrid::read(&path, &mut warnings).unwrap();
        grid.local_grids.retain(|local| !local.is_radial);
        // One that refines a cell of the first.
        let nested = LocalGrid {
            name: "NESTED".into(),
            parent: grid.local_grids[0].name.clone(),
            host: vec![7; 24],
            dims: small().dims,
            coord: small().coord,
            zcorn: small().zcorn,
            actnum: small().actnum,
            number: grid.local_grids.len() as i32 + 1,
            ..LocalGrid::default()
        };
        grid.local_grids.push(nested);
        let bytes = write(&grid, RecordWriter::new(Vec::new()), |_| true);
        let twin = read(&bytes, &mut warnings).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(twin.local_grids.len(), grid.local_grids.len());
        for (local, expected) in twin.local_grids.iter().zip(&grid.local_grids) {
            assert_eq!(
                (&local.name, &local.parent),
                (&expected.name, &expected.parent)
            );
            assert_eq!(
                (&local.host, local.number),
                (&expected.host, expected.number)
            );
            assert_twins(&alone(local), &alone(expected), 1e-3);
        }
    }
}

#[test]
fn ok_damaged_local_grids_are_left_out() {
    let local = |host: i32, off: f32| LocalGrid {
        name: "L".into(),
        host: vec![host; 24],
        dims: small().dims,
        coord: small().coord.iter().map(|v| v + off).collect(),
        zcorn: small().zcorn,
        actnum: small().actnum,
        ..LocalGrid::default()
    };
    for (host, off, told) in [
        (1, 0.0, None),
        (
            0,
            0.0,
            Some("local grid L was left out: COORDS: names no host cell"),
        ),
        (
            1,
            f32::NAN,
            Some("local grid L was left out: CORNERS: is not 24 finite numbers"),
        ),
    ] {
        let grid = Egrid {
            local_grids: vec![local(host, off)],
            ..small()
        };
        let bytes = write(&grid, RecordWriter::new(Vec::new()), |_| true);
        let mut warnings = Warnings::default();
        let twin = read(&bytes, &mut warnings).unwrap();
        assert_eq!(twin.local_grids.len(), usize::from(told.is_none()));
        let said: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        match told {
            None => assert_eq!(said, [""; 0]),
            Some(told) => assert!(said.len() == 1 && said[0].contains(told), "{said:?}"),
        }
    }
}

#[test]
fn ok_absent_cells_are_inactive_and_have_no_volume() {
    let grid = small();
    // A whole column is missing, one at its top, one in the middle.
    let is_there =
        |[i, j, k]: [usize; 3]| !(i == 2 && j == 1 || i == 0 && k == 0 || i == 1 && k == 2);
    let mut warnings = Warnings::default();
    let bytes = write(&grid, RecordWriter::new(Vec::new()), is_there);
    let twin = read(&bytes, &mut warnings).unwrap();
    let said: Vec<_> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        ["A.GRID: 8 of 24 cells are not in the file: they are inactive, without volume"]
    );
    for n in 0..24 {
        let ijk = [n % 3, n / 3 % 2, n / 6];
        let active = twin.actnum.as_ref().unwrap()[n];
        if is_there(ijk) {
            assert_eq!(active, grid.actnum.as_ref().unwrap()[n]);
            (0..8).for_each(|c| assert_eq!(corner(&twin, ijk, c)[2], corner(&grid, ijk, c)[2]));
            continue;
        }
        assert_eq!(active, 0);
        for c in 0..4 {
            let depth = |k, c| corner(&twin, [ijk[0], ijk[1], k], c)[2];
            assert_eq!(depth(ijk[2], c), depth(ijk[2], c + 4));
            match ijk {
                [0, _, 0] => assert_eq!(depth(0, c), depth(1, c)),
                [1, ..] => assert_eq!(depth(2, c), depth(1, c + 4)),
                _ => {}
            }
        }
    }
}

#[test]
fn err_what_is_no_pillar_grid() {
    let mut grid = small();
    let damaged = |grid: &Egrid, change: &dyn Fn([f32; 3], usize) -> [f32; 3]| {
        let mut out = RecordWriter::new(Vec::new());
        out.inte("DIMENS", &[3, 2, 4]).unwrap();
        for n in 0..24_usize {
            let ijk = [n % 3, n / 3 % 2, n / 6];
            out.inte("COORDS", &ijk.map(|n| n as i32 + 1)).unwrap();
            let corners: Vec<f32> = (0..8)
                .flat_map(|c| change(corner(grid, ijk, c), n))
                .collect();
            out.real("CORNERS", &corners).unwrap();
        }
        read(&out.finish().unwrap(), &mut Warnings::default())
    };
    let whole = damaged(&grid, &|point, _| point).unwrap();
    assert_eq!(whole.zcorn, grid.zcorn);
    // Cells that end beside their neighbors'.
    let error = damaged(&grid, &|[x, y, z], n| [x + 10.0 * n as f32, y, z]).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Unsupported);
    assert!(
        error.to_string().contains("only pillar grids are read"),
        "{error}"
    );
    let error = damaged(&grid, &|[x, y, _], _| [x, y, f32::NAN]).unwrap_err();
    assert_eq!(error.kind, ErrorKind::BadValue);
    // More cells than the file could have left out.
    let few = write(&grid, RecordWriter::new(Vec::new()), |ijk| ijk == [0; 3]);
    assert!(read(&few, &mut Warnings::default()).is_ok());
    grid.dims = [1000, 1000, 100];
    let mut out = RecordWriter::new(Vec::new());
    out.inte("DIMENS", &[1000, 1000, 100]).unwrap();
    out.inte("COORDS", &[1, 1, 1]).unwrap();
    out.real("CORNERS", &[0.0; 24]).unwrap();
    let error = read(&out.finish().unwrap(), &mut Warnings::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::WrongCount);
    assert_eq!(
        error.to_string(),
        "A.GRID@0x0: DIMENS: says 100000000 cells, and the file has 1"
    );
}

#[test]
fn ok_binary_grdecl() {
    let grid = small();
    let write = |kind: i32| {
        let mut out = RecordWriter::new(Vec::new());
        out.inte("SPECGRID", &[3, 2, 4, 1, kind]).unwrap();
        let mut coord = grid.coord.clone();
        if kind == 1 {
            // Sectors of a few degrees.
            coord.iter_mut().skip(1).step_by(3).for_each(|y| *y /= 10.0);
        }
        out.real("COORD", &coord).unwrap();
        out.real("ZCORN", &grid.zcorn).unwrap();
        out.inte("ACTNUM", grid.actnum.as_ref().unwrap()).unwrap();
        out.finish().unwrap()
    };
    let mut warnings = Warnings::default();
    let twin = read(&write(0), &mut warnings).unwrap();
    assert!(warnings.is_empty());
    assert_eq!((twin.dims, &twin.coord), (grid.dims, &grid.coord));
    assert_eq!((&twin.zcorn, &twin.actnum), (&grid.zcorn, &grid.actnum));
    // Radii and angles.
    let radial = read(&write(1), &mut warnings).unwrap();
    let said: Vec<_> = warnings.iter().map(ToString::to_string).collect();
    assert!(said.len() == 1 && said[0].contains("radial"), "{said:?}");
    assert_eq!(
        (radial.dims, &radial.zcorn, &radial.actnum),
        (grid.dims, &grid.zcorn, &grid.actnum)
    );
    for (made, [radius, angle]) in [(0, [0, 1]), (7, [42, 43])] {
        let made = &radial.coord[6 * made..][..2];
        let angle = (grid.coord[angle] / 10.0).to_radians();
        let radius = grid.coord[radius];
        let expected = [radius * angle.cos(), radius * angle.sin()];
        let near = |(a, b): (&f32, f32)| (a - b).abs() < 1e-5 * radius.abs().max(1.0);
        assert!(made.iter().zip(expected).all(near), "{made:?} {expected:?}");
    }
}

/// The small grid with its layers twice, the lower ones as fractures of the upper ones; `off` moves the last
/// cell down its pillars, and there is a fracture where `is_there` says so.
fn doubled(off: f32, is_there: impl Fn(usize) -> bool) -> Vec<u8> {
    let grid = small();
    let actnum = grid.actnum.as_deref().unwrap();
    let mut out = RecordWriter::new(Vec::new());
    out.inte("DIMENS", &[3, 2, 8]).unwrap();
    for n in (0..48_usize).filter(|n| *n < 24 || is_there(*n - 24)) {
        let (cell, layer) = (n % 24, n / 6);
        let ijk = [cell % 3, cell / 3 % 2, cell / 6];
        // The matrix is active as in the small grid, fractures where it is not, and everywhere in the first layer.
        let active = if n < 24 {
            actnum[cell]
        } else {
            i32::from(cell < 6 || actnum[cell] == 0)
        };
        let place = [ijk[0], ijk[1], layer, n].map(|n| n as i32 + 1);
        out.inte("COORDS", &[place.as_slice(), &[active, 0, 0]].concat())
            .unwrap();
        let mut corners: Vec<f32> = (0..8).flat_map(|c| corner(&grid, ijk, c)).collect();
        if n == 47 {
            // Along the pillars.
            let along = [0.5 * off, -0.25 * off, off];
            corners
                .iter_mut()
                .zip(along.iter().cycle())
                .for_each(|(v, by)| *v += by);
        }
        out.real("CORNERS", &corners).unwrap();
    }
    out.finish().unwrap()
}

#[test]
fn ok_layers_that_lie_where_others_do_are_fractures() {
    let grid = small();
    let told = |bytes: &[u8]| {
        let mut warnings = Warnings::default();
        let grid = read(bytes, &mut warnings).unwrap();
        let said: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        (grid, said.join("\n"))
    };
    let (dual, said) = told(&doubled(0.0, |_| true));
    assert_eq!(
        said,
        "A.GRID: layers 5 to 8 lie where layers 1 to 4 do: they are taken for the fractures of dual porosity"
    );
    assert_eq!(dual.porosity_model, PorosityModel::Dual);
    assert_eq!((dual.dims, &dual.zcorn), (grid.dims, &grid.zcorn));
    let active = grid.actnum.as_ref().unwrap().iter().enumerate();
    let expected = active.map(|(n, active)| match (active, n < 6) {
        (1, false) => 1,
        (1, true) => 3,
        _ => 2,
    });
    assert_eq!(dual.actnum, Some(expected.collect()));
    // Fractures of some cells alone.
    let (some, said) = told(&doubled(0.0, |n| n % 2 == 0));
    assert!(
        said.contains("fractures") && !said.contains("not in the file"),
        "{said}"
    );
    assert_eq!((some.dims, some.actnum.unwrap()[1]), ([3, 2, 4], 1));
    // A cell that lies elsewhere makes them layers of their own.
    let mut warnings = Warnings::default();
    let single = read(&doubled(0.25, |_| true), &mut warnings);
    let single = single.unwrap();
    assert_eq!(
        (single.dims, single.porosity_model),
        ([3, 2, 8], PorosityModel::Single)
    );
}

#[test]
fn ok_a_case_prefers_egrid() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = write(&small(), RecordWriter::new(Vec::new()), |_| true);
    let legacy = folder.path().join("A.GRID");
    std::fs::write(&legacy, bytes).unwrap();
    let found = |case: &case::CaseFiles| case.grid.clone();
    let egrid = |path: &std::path::Path| case::GridSource::Egrid(path.to_owned());
    assert_eq!(found(&case::find(folder.path()).unwrap()), egrid(&legacy));
    let better = folder.path().join("A.FEGRID");
    std::fs::write(&better, " 'FILEHEAD'").unwrap();
    assert_eq!(found(&case::find(folder.path()).unwrap()), egrid(&better));
    assert_eq!(found(&case::find(&legacy).unwrap()), egrid(&legacy));
}
