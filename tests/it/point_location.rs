//! The GPU's point location against the reference's, on real models and on analytic cells.

use crate::common;
use crate::common::shape::Shape;
use glam::DVec3;
use strataray::case::{Case, load};
use strataray::model::{CellField, Dims, Grid, GridInput, VertexField};
use strataray::reference::{self, Located, Locator};
use strataray::render;
use strataray::render::gpu::{Gpu, GpuGrid, probe};
use strataray::scene::Interpolation;
use strataray::view::ShownCells;

const POINTS: usize = 100_000;

/// Seeded points: half in and around the box, half inside cells.
fn points(grid: &Grid, n: usize, seed: u64) -> Vec<DVec3> {
    let mut random = fastrand::Rng::with_seed(seed);
    let [low, high] = grid.bounds().unwrap();
    let margin = 0.05 * (high - low);
    (0..n)
        .map(|at| {
            let mut unit = || DVec3::new(random.f64(), random.f64(), random.f64());
            if at % 2 == 0 {
                low - margin + unit() * (high - low + 2.0 * margin)
            } else {
                let parameters = 2.0 * unit() - 1.0;
                let cell = grid.active_cells()[random.usize(0..grid.active_cells().len())];
                grid.hexahedron(grid.dims().ijk(cell)).at(parameters)
            }
        })
        .collect()
}

/// Newton from inside a given cell: the parameters of a point there, wherever they end up.
fn parameters_in(grid: &Grid, ijk: strataray::model::Ijk, point: DVec3) -> DVec3 {
    let hexahedron = grid.hexahedron(ijk);
    let mut q = DVec3::ZERO;
    for _ in 0..60 {
        let step = hexahedron.jacobian(q).inverse() * (point - hexahedron.at(q));
        if !step.is_finite() {
            break;
        }
        q += step.clamp_length_max(1.0);
    }
    q
}

/// Distance of parameters from the cell's nearest face, in cell sizes; below zero outside.
fn from_face(parameters: DVec3) -> f64 {
    0.5 * (1.0 - parameters.abs().max_element())
}

#[derive(Default, Debug)]
struct Tally {
    inside: usize,
    other_cell: usize,
    wrong_cell: usize,
    wrong_parameters: usize,
    wrong_value: usize,
    beyond_f32: usize,
    largest_parameter_error: f64,
}

fn compare(
    grid: &Grid,
    field: &CellField,
    vertices: &VertexField,
    points: &[DVec3],
    gpu: &[Option<render::Located>],
    cpu: &[Option<Located>],
) -> Tally {
    let statistics = field.statistics().unwrap();
    let range = (statistics.max - statistics.min).max(1e-30);
    let [low, high] = grid.bounds().unwrap();
    let extent = (high - low).max_element();
    let mut tally = Tally::default();
    for ((&point, gpu), cpu) in points.iter().zip(gpu).zip(cpu) {
        match (gpu, cpu) {
            (Some(a), Some(b)) if a.ijk == b.ijk => {
                tally.inside += 1;
                let error = (a.parameters - b.str).abs().max_element();
                tally.largest_parameter_error = tally.largest_parameter_error.max(error);
                // Coordinates have 24 bits on the device: in layers of millimeters that is the limit.
                let hexahedron = grid.hexahedron(b.ijk);
                let moved = hexahedron.at(a.parameters).distance(hexahedron.at(b.str));
                let grain = extent * 2f64.powi(-25);
                tally.beyond_f32 += usize::from(error > 1e-4 && moved <= grain);
                tally.wrong_parameters += usize::from(error > 1e-4 && moved > grain);
                let value = reference::value_at(grid, b, field, Some(vertices)).unwrap();
                tally.wrong_value += usize::from((a.value - value).abs() > 1e-4 * range);
            }
            (None, None) => {}
            (a, b) => {
                tally.other_cell += 1;
                let near_a =
                    a.is_some_and(|a| from_face(parameters_in(grid, a.ijk, point)).abs() <= 1e-4);
                let near_b = b.as_ref().is_some_and(|b| from_face(b.str).abs() <= 1e-4);
                if !near_a && !near_b {
                    tally.wrong_cell += 1;
                    if tally.wrong_cell <= 5 {
                        println!("  at {point}: GPU {a:?}, reference {b:?}");
                    }
                }
            }
        }
    }
    tally
}

#[test]
fn gpu_and_reference_find_the_same_cells() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        check(&gpu, &load::open(&model).unwrap(), "PORO");
    }
}

#[test]
fn closed_form_of_vertical_pillars_finds_the_same_cells() {
    let Some(gpu) = common::gpu() else { return };
    // Uneven quadrilaterals, dipping layers of uneven thickness, a fault and a wedge.
    let case = Shape {
        dims: [14, 11, 7],
        pillar: &|i, j| {
            let [x, y] = [i as f64, j as f64];
            let x = 80.0 * x + 11.0 * (1.7 * y + 0.9 * x).sin();
            let y = 60.0 * y + 13.0 * (1.3 * i as f64 - 0.4 * y).cos();
            [[x, y, 1500.0], [x, y, 2500.0]]
        },
        depth: &|[i, j, k], [di, dj, dk]| {
            let [x, y, z] = [(i + di) as f64, (j + dj) as f64, (k + dk) as f64];
            let throw = if i >= 6 { 17.0 } else { 0.0 };
            2000.0 + throw + 4.0 * x - 3.0 * y + z * (1.0 + 0.9 * x + 0.3 * y)
        },
        value: &|[i, j, k]| (i * j + 3 * k) as f64,
        ..Shape::default()
    }
    .case();
    assert!(GpuGrid::new(&gpu, &case.grid).unwrap().facts.vertical);
    check(&gpu, &case, "VALUE");
}

fn check(gpu: &Gpu, case: &Case, property: &str) {
    let grid = &case.grid;
    let field = case.field(property, 0).unwrap();
    let vertices = VertexField::new(grid, &field);
    let drawn = vec![true; grid.active_cells().len()];
    let mut gpu_grid = GpuGrid::new(gpu, grid).unwrap();
    let shown = ShownCells::new(field.clone(), drawn, Interpolation::Vertex);
    gpu_grid.show(gpu, grid, &shown).unwrap();
    let points = points(grid, POINTS, 7);
    let on_gpu = probe::locate(gpu, &gpu_grid, grid, &points, Interpolation::Vertex).unwrap();
    let locator = Locator::new(grid);
    let on_cpu: Vec<_> = points.iter().map(|&p| locator.locate(p)).collect();
    let tally = compare(grid, &field, &vertices, &points, &on_gpu, &on_cpu);
    println!("{}: {tally:?}", case.about.name);
    assert!(tally.inside > POINTS / 3, "{tally:?}");
    assert!(tally.beyond_f32 <= POINTS / 1000, "{tally:?}");
    assert_eq!(
        [tally.wrong_cell, tally.wrong_parameters, tally.wrong_value],
        [0; 3],
        "{tally:?}"
    );
    // The twin: points moved by a thousandth of the model are somewhere else.
    let [low, high] = grid.bounds().unwrap();
    let moved: Vec<_> = points
        .iter()
        .map(|&p| locator.locate(p + 1e-3 * (high - low)))
        .collect();
    let tally = compare(grid, &field, &vertices, &points, &on_gpu, &moved);
    assert!(
        tally.wrong_cell > 100 && tally.wrong_parameters > 1000,
        "{tally:?}"
    );
}

/// A grid of `n` cells each way whose corners a map moves; pillars stay straight as they are given.
fn grid_of(
    n: usize,
    pillar: impl Fn(f64, f64) -> [DVec3; 2],
    depth: impl Fn(f64, f64, f64) -> f64,
) -> Grid {
    let dims = Dims {
        ni: n,
        nj: n,
        nk: n,
    };
    let mut coord = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let ends = pillar(i as f64, j as f64);
            coord.extend(ends.iter().flat_map(|e| e.to_array()));
        }
    }
    let mut zcorn = Vec::new();
    for plane in 0..2 * n {
        for y in 0..2 * n {
            for x in 0..2 * n {
                zcorn.push(depth(
                    x.div_ceil(2) as f64,
                    y.div_ceil(2) as f64,
                    plane.div_ceil(2) as f64,
                ));
            }
        }
    }
    Grid::new(&GridInput {
        dims,
        coord: &coord,
        zcorn: &zcorn,
        actnum: None,
        map_axes: None,
    })
    .unwrap()
}

#[test]
fn known_parameters_come_back_on_both() {
    let Some(gpu) = common::gpu() else { return };
    let straight = |x: f64, y: f64| DVec3::new(4e5 + 100.0 * x, 6e6 + 80.0 * y, 2000.0);
    let sheared = grid_of(
        3,
        |x, y| {
            [
                straight(x, y),
                straight(x, y) + DVec3::new(30.0, -20.0, 60.0),
            ]
        },
        |x, y, k| 2000.0 + 20.0 * k + 5.0 * x - 3.0 * y,
    );
    // Neighboring pillars lean in different directions.
    let twisted = grid_of(
        3,
        |x, y| {
            [
                straight(x, y),
                straight(x, y) + DVec3::new(9.0 * (y - 1.5), -9.0 * (x - 1.5), 60.0),
            ]
        },
        |x, y, k| 2000.0 + 20.0 * k + 2.0 * x * y,
    );
    for grid in [sheared, twisted] {
        let mut random = fastrand::Rng::with_seed(5);
        let known: Vec<_> = (0..10_000)
            .map(|_| {
                let cell = grid.active_cells()[random.usize(0..27)];
                let mut unit = || 1.98 * random.f64() - 0.99;
                (grid.dims().ijk(cell), DVec3::new(unit(), unit(), unit()))
            })
            .collect();
        let points: Vec<_> = known
            .iter()
            .map(|(ijk, q)| grid.hexahedron(*ijk).at(*q))
            .collect();
        // A linear field, given at the cells, is not linear at the hull's vertices: compare parameters.
        let field = CellField::new(vec![1.0; 27]);
        let mut gpu_grid = GpuGrid::new(&gpu, &grid).unwrap();
        let shown = ShownCells::new(field.into(), vec![true; 27], Interpolation::Cell);
        gpu_grid.show(&gpu, &grid, &shown).unwrap();
        let on_gpu = probe::locate(&gpu, &gpu_grid, &grid, &points, Interpolation::Cell).unwrap();
        let locator = Locator::new(&grid);
        for (((ijk, q), point), gpu) in known.iter().zip(&points).zip(&on_gpu) {
            let cpu = locator.locate(*point).unwrap();
            let gpu = gpu.unwrap();
            assert_eq!((cpu.ijk, gpu.ijk), (*ijk, *ijk));
            assert!(
                cpu.str.distance(*q) < 1e-7 && gpu.parameters.distance(*q) < 1e-4,
                "{q} {} {}",
                cpu.str,
                gpu.parameters
            );
        }
    }
}
