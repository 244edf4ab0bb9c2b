//! Point location in cells of odd shapes, on the device against f64.

use std::f64::consts::TAU;

use crate::common;
use glam::{DVec2, DVec3};
use strataray::case::load;
use strataray::model::{CellField, Dims, Grid, GridInput, Hexahedron};
use strataray::reference::{Located, Locator};
use strataray::render;
use strataray::render::gpu::{Gpu, GpuGrid, probe};
use strataray::scene::Interpolation;
use strataray::view::ShownCells;

/// Cells apart from each other, each with pillars of its own.
struct Loose {
    grid: Grid,
    cells: Vec<Hexahedron>,
}

/// Distance from one loose cell to the next.
const APART: f64 = 400.0;

/// The eight corners of a cell, given about its own middle, four pillars each with its upper and lower one.
type Corners = [[DVec3; 2]; 4];

impl Loose {
    fn new(shapes: &[Corners]) -> Self {
        let across = (shapes.len() as f64).sqrt().ceil() as usize;
        let place = |n: usize| DVec3::new((n % across) as f64, (n / across) as f64, 0.0) * APART;
        let corners = |n: usize| shapes[n].map(|ends| ends.map(|p| p + place(n) + ORIGIN));
        // Every other column is inactive, so that no two cells share a pillar.
        let dims = Dims {
            ni: 2 * shapes.len() - 1,
            nj: 1,
            nk: 1,
        };
        let mut coord = Vec::new();
        for row in 0..2 {
            for n in 0..shapes.len() {
                for pillar in &corners(n)[2 * row..2 * row + 2] {
                    let mut ends = *pillar;
                    if ends[0].z == ends[1].z {
                        // A pillar of a pinched edge needs a direction.
                        ends[1].z += 10.0;
                    }
                    coord.extend(ends.iter().flat_map(|p| p.to_array()));
                }
            }
        }
        let mut zcorn = vec![0.0; 8 * dims.cells()];
        let mut actnum = vec![0; dims.cells()];
        for n in 0..shapes.len() {
            actnum[2 * n] = 1;
            for (c, pillar) in corners(n).iter().enumerate() {
                for (plane, point) in pillar.iter().enumerate() {
                    let x = 2 * (2 * n) + (c & 1);
                    zcorn[x + 2 * dims.ni * (c >> 1) + 4 * dims.ni * plane] = point.z;
                }
            }
        }
        let grid = Grid::new(&GridInput {
            dims,
            coord: &coord,
            zcorn: &zcorn,
            actnum: Some(&actnum),
            map_axes: None,
        })
        .unwrap();
        let cells = grid.active_cells().iter();
        let cells = cells.map(|&c| grid.hexahedron(dims.ijk(c))).collect();
        Self { grid, cells }
    }

    /// Points within each cell, cell after cell.
    fn points(&self, each: usize) -> Vec<DVec3> {
        let mut random = fastrand::Rng::with_seed(3);
        let mut unit = || 1.998 * random.f64() - 0.999;
        let cells = self.cells.iter();
        cells
            .flat_map(|cell| {
                (0..each)
                    .map(|_| cell.at(DVec3::new(unit(), unit(), unit())))
                    .collect::<Vec<_>>()
            })
            .collect()
    }
}

const ORIGIN: DVec3 = DVec3::new(460_000.0, 5_930_000.0, 2_000.0);

/// Where the device and where f64 find points.
fn locate(
    gpu: &Gpu,
    grid: &Grid,
    points: &[DVec3],
) -> Vec<(Option<render::Located>, Option<Located>)> {
    let cells = grid.active_cells().len();
    let mut on_device = GpuGrid::new(gpu, grid).unwrap();
    let field = CellField::new(vec![1.0; cells]);
    let shown = ShownCells::new(field.into(), vec![true; cells], Interpolation::Cell);
    on_device.show(gpu, grid, &shown).unwrap();
    let found = probe::locate(gpu, &on_device, grid, points, Interpolation::Cell).unwrap();
    let locator = Locator::new(grid);
    let truth = points.iter().map(|&p| locator.locate(p));
    found.into_iter().zip(truth).collect()
}

/// What the device makes of points that f64 finds.
#[derive(Debug, Default)]
struct Tally {
    inside: usize,
    lost: usize,
    elsewhere: usize,
    /// Largest distance between the point and the place that the parameters name.
    farthest: f64,
}

impl Tally {
    fn of(
        grid: &Grid,
        points: &[DVec3],
        located: &[(Option<render::Located>, Option<Located>)],
    ) -> Self {
        let mut tally = Self::default();
        for (point, (found, truth)) in points.iter().zip(located) {
            let Some(truth) = truth else { continue };
            tally.inside += 1;
            match found {
                None => tally.lost += 1,
                Some(found) if found.ijk != truth.ijk => tally.elsewhere += 1,
                Some(found) => {
                    let place = grid.hexahedron(found.ijk).at(found.parameters);
                    tally.farthest = tally.farthest.max(place.distance(*point));
                }
            }
        }
        tally
    }
}

/// A box of 100 x 80 x 6 about the origin, its corners moved.
fn moved(by: impl Fn([usize; 3], DVec3) -> DVec3) -> Corners {
    std::array::from_fn(|c| {
        std::array::from_fn(|k| {
            let at = [c & 1, c >> 1, k];
            let unit = DVec3::new(at[0] as f64, at[1] as f64, k as f64) - 0.5;
            by(at, unit * DVec3::new(100.0, 80.0, 6.0))
        })
    })
}

/// A box whose edge at one side is shorter than that opposite, in each of eight orientations: the narrow side
/// at low or high I or J, and both windings.
fn tapers() -> Vec<(f64, Corners)> {
    let mut all = Vec::new();
    for ratio in [1.0, 1.5, 2.0, 3.0, 4.0, 7.0, 10.0, 20.0, 50.0, 100.0] {
        for turn in 0..4 {
            for mirrored in [false, true] {
                let shape = moved(|[i, j, _], p| {
                    let (far, along) = if turn % 2 == 0 { (i, 1) } else { (j, 0) };
                    let is_narrow = (far == 1) == (turn < 2);
                    let mut p = p;
                    p[along] *= if is_narrow { 1.0 / ratio } else { 1.0 };
                    // Oblique, so that no product vanishes.
                    p.y += 0.3 * p.x;
                    p.z += 0.02 * p.x - 0.03 * p.y;
                    if mirrored {
                        p.x = -p.x;
                    }
                    p
                });
                all.push((ratio, vertical(shape)));
            }
        }
    }
    all
}

/// The same cell with each lower corner below its upper one.
fn vertical(corners: Corners) -> Corners {
    corners.map(|[top, bottom]| [top, top.truncate().extend(bottom.z)])
}

#[test]
fn vertical_cells_narrow_at_one_side_lose_nothing() {
    let Some(gpu) = common::gpu() else { return };
    let shapes = tapers();
    let loose = Loose::new(&shapes.iter().map(|s| s.1).collect::<Vec<_>>());
    let points = loose.points(400);
    let located = locate(&gpu, &loose.grid, &points);
    for (n, pair) in shapes.chunks(8).enumerate() {
        let range = 8 * 400 * n..8 * 400 * (n + 1);
        let tally = Tally::of(&loose.grid, &points[range.clone()], &located[range]);
        println!("ratio {}: {tally:?}", pair[0].0);
    }
    let tally = Tally::of(&loose.grid, &points, &located);
    assert_eq!(tally.inside, points.len());
    assert_eq!([tally.lost, tally.elsewhere], [0; 2], "{tally:?}");
    assert!(tally.farthest < 1e-4, "{tally:?}");
}

/// A grid around a well: rings that grow, in sectors of a few degrees.
fn radial(sectors: usize, inner: f64, growth: f64, rings: usize) -> Grid {
    let dims = Dims {
        ni: rings,
        nj: sectors,
        nk: 3,
    };
    let mut coord = Vec::new();
    for j in 0..=sectors {
        for i in 0..=rings {
            let angle = TAU * j as f64 / sectors as f64;
            let at = inner * growth.powi(i as i32) * DVec2::from_angle(angle);
            coord.extend([at.x, at.y, 1990.0, at.x, at.y, 2020.0]);
        }
    }
    let mut zcorn = Vec::new();
    for plane in 0..6usize {
        let depth = 2000.0 + 4.0 * plane.div_ceil(2) as f64;
        zcorn.extend(std::iter::repeat_n(depth, 4 * rings * sectors));
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
fn radial_grids_have_no_grooves() {
    let Some(gpu) = common::gpu() else { return };
    for grid in [radial(24, 0.1, 1.6, 18), radial(90, 1.0, 2.5, 7)] {
        let mut random = fastrand::Rng::with_seed(4);
        let cells: Vec<Hexahedron> = {
            let dims = grid.dims();
            let cells = grid.active_cells().iter();
            cells.map(|&c| grid.hexahedron(dims.ijk(c))).collect()
        };
        // Half of the points lie on faces that two cells share.
        let points: Vec<DVec3> = (0..40_000)
            .map(|n| {
                let cell = &cells[random.usize(0..cells.len())];
                let mut unit = || 1.98 * random.f64() - 0.99;
                let mut at = DVec3::new(unit(), unit(), unit());
                match n % 4 {
                    0 => at.y = 1.0,
                    1 => at.y = -1.0,
                    _ => {}
                }
                cell.at(at)
            })
            .collect();
        let located = locate(&gpu, &grid, &points);
        let tally = Tally::of(&grid, &points, &located);
        let lost = located.iter().filter(|(found, _)| found.is_none()).count();
        println!("{:?}: {lost} lost, {tally:?}", grid.dims());
        assert_eq!(lost, 0);
    }
}

#[test]
fn the_reported_taper_is_whole() {
    let Some(gpu) = common::gpu() else { return };
    let [model, file] =
        ["F06_TAPER.EGRID", "F06_points.csv"].map(|file| common::bundled("reported").join(file));
    let case = load::open(&model).unwrap();
    let text = std::fs::read_to_string(file).unwrap();
    let number = |v: &str| v.trim().parse::<f64>().unwrap();
    let points: Vec<DVec3> = text
        .lines()
        .skip(1)
        .map(|line| {
            let v: Vec<f64> = line.split(',').map(number).collect();
            DVec3::new(v[0], v[1], v[2])
        })
        .collect();
    let located = locate(&gpu, &case.grid, &points);
    let tally = Tally::of(&case.grid, &points, &located);
    println!("{tally:?}");
    assert_eq!((points.len(), tally.inside), (25, 25));
    assert_eq!([tally.lost, tally.elsewhere], [0; 2]);
}

/// Ways in which a cell's pillars stand: vertical, all leaning alike, each leaning its own way.
const LEANINGS: [fn(usize, DVec3) -> DVec3; 3] = [
    |_, p| p,
    |_, p| p + DVec3::new(0.7, -0.4, 0.0) * p.z,
    |c, p| p + [DVec3::X, DVec3::Y, -DVec3::Y, -DVec3::X][c] * (0.9 * p.z),
];

/// A box whose corners `by` moves, dipping, with pillars of each leaning, and each of them turned over: its
/// bottom above its top.
fn variants(by: impl Fn([usize; 3], DVec3) -> DVec3) -> Vec<Corners> {
    let lean = |lean: &fn(usize, DVec3) -> DVec3| {
        moved(|at, p| {
            let p = lean(at[0] + 2 * at[1], by(at, p));
            p + DVec3::Z * (0.06 * p.x - 0.04 * p.y)
        })
    };
    let upright: Vec<Corners> = LEANINGS.iter().map(lean).collect();
    let turned = upright.iter().map(|c| c.map(|[top, bottom]| [bottom, top]));
    upright.iter().copied().chain(turned).collect()
}

/// The number of the pillar at (i, j).
fn pillar([i, j, _]: [usize; 3]) -> usize {
    i + 2 * j
}

/// In plan the section has a reflex corner, or two of its sides cross.
fn concave() -> Vec<Corners> {
    let mut all = Vec::new();
    for corner in 0..4 {
        for part in [0.5, 0.55, 0.7, 0.9, 0.99] {
            all.extend(variants(|at, p| {
                let drawn_in = if pillar(at) == corner {
                    1.0 - 2.0 * part
                } else {
                    1.0
                };
                p * DVec3::new(drawn_in, drawn_in, 1.0)
            }));
        }
    }
    for part in [0.6, 0.8, 1.0] {
        all.extend(variants(|[i, _, _], p| {
            p * DVec3::new(1.0, if i == 1 { 1.0 - 2.0 * part } else { 1.0 }, 1.0)
        }));
    }
    all
}

/// Top and bottom are saddles, which may cross each other.
fn saddles() -> Vec<Corners> {
    let mut all = Vec::new();
    for height in [1.0, 2.9, 3.1, 6.0, 20.0] {
        for sides in [[1.0, 1.0], [1.0, -1.0], [1.0, 0.0], [0.0, -1.0]] {
            all.extend(variants(|[i, j, k], p| {
                let up = if i == j { 1.0 } else { -1.0 };
                p + DVec3::Z * (height * up * sides[k])
            }));
        }
    }
    all
}

/// Edges of no length: upright ones, or those of top and bottom.
fn pinched() -> Vec<Corners> {
    let mut all = Vec::new();
    for edges in 1..15u32 {
        all.extend(variants(|at, p| {
            let height = f64::from(1 - (edges >> pillar(at) & 1));
            p * DVec3::new(1.0, 1.0, height)
        }));
    }
    for side in 0..4 {
        for ends in [[true, false], [false, true], [true, true]] {
            all.extend(variants(|[i, j, k], p| {
                let is_pinched = ends[k] && [i, j][side / 2] == side % 2;
                let along = if is_pinched { 0.0 } else { 1.0 };
                match side / 2 {
                    0 => p * DVec3::new(1.0, along, 1.0),
                    _ => p * DVec3::new(along, 1.0, 1.0),
                }
            }));
        }
    }
    all
}

/// Narrow at one end of one axis, across one of the others or both.
fn narrowing() -> Vec<Corners> {
    let mut all = Vec::new();
    for ratio in [2.0, 7.0, 30.0, 100.0] {
        for axis in 0..3 {
            for end in 0..2 {
                for across in [1, 2, 3] {
                    all.extend(variants(|at, mut p| {
                        if at[axis] == end {
                            for other in 1..3 {
                                let part = if across & other != 0 { ratio } else { 1.0 };
                                p[(axis + other) % 3] /= part;
                            }
                        }
                        p
                    }));
                }
            }
        }
    }
    all
}

/// Every corner somewhere near its place.
fn crumpled() -> Vec<Corners> {
    let mut random = fastrand::Rng::with_seed(8);
    let mut all = Vec::new();
    for off in [0.2, 0.4, 0.7] {
        for _ in 0..20 {
            let by: [DVec3; 8] = std::array::from_fn(|_| {
                let mut one = || off * (2.0 * random.f64() - 1.0);
                DVec3::new(one(), one(), one()) * DVec3::new(100.0, 80.0, 6.0)
            });
            all.extend(variants(|at, p| p + by[pillar(at) + 4 * at[2]]));
        }
    }
    all
}

/// What the device and f64 make of points of which each lies in some cell.
#[derive(Debug, Default)]
struct Answers {
    missed: [usize; 2],
    /// Largest distance between a point and the place that cell and parameters name.
    farthest: [f64; 2],
}

impl Answers {
    fn of(
        grid: &Grid,
        points: &[DVec3],
        located: &[(Option<render::Located>, Option<Located>)],
    ) -> Self {
        let mut answers = Self::default();
        for (point, (on_device, truth)) in points.iter().zip(located) {
            let both = [
                on_device.map(|l| (l.ijk, l.parameters)),
                truth.map(|l| (l.ijk, l.str)),
            ];
            for (n, found) in both.into_iter().enumerate() {
                match found {
                    None => answers.missed[n] += 1,
                    Some((ijk, at)) => {
                        let off = grid.hexahedron(ijk).at(at).distance(*point);
                        answers.farthest[n] = answers.farthest[n].max(off);
                    }
                }
            }
        }
        answers
    }

    /// Every point is found, and found where it is.
    fn are_right(&self) -> bool {
        self.missed == [0; 2] && self.farthest[0] < 1e-3 && self.farthest[1] < 1e-7
    }
}

#[test]
fn every_point_of_a_cell_is_found_whatever_its_shape() {
    let Some(gpu) = common::gpu() else { return };
    for (name, shapes) in [
        ("concave", concave()),
        ("saddles", saddles()),
        ("pinched", pinched()),
        ("narrowing", narrowing()),
        ("crumpled", crumpled()),
    ] {
        // A folded cell has some points several times: any of their parameters will do.
        let upright: Vec<_> = shapes.iter().copied().map(vertical).collect();
        for (pillars, shapes) in [("of all kinds", shapes), ("vertical", upright)] {
            let loose = Loose::new(&shapes);
            let points = loose.points(100);
            let located = locate(&gpu, &loose.grid, &points);
            let answers = Answers::of(&loose.grid, &points, &located);
            println!(
                "{name}, pillars {pillars}: {} cells, {} points, {answers:?}",
                shapes.len(),
                points.len()
            );
            assert!(answers.are_right(), "{name}, {pillars}: {answers:?}");
            // The twin: beside the cells there is nothing, and the answer to one point is none to another.
            let beside: Vec<_> = points.iter().map(|p| p + 0.5 * APART * DVec3::X).collect();
            let found = locate(&gpu, &loose.grid, &beside);
            assert!(found.iter().all(|f| matches!(f, (None, None))), "{name}");
            let others = Answers::of(&loose.grid, &points[1..], &located);
            assert!(others.farthest.iter().all(|&off| off > 1.0), "{others:?}");
        }
    }
}

/// Seven by seven leaning columns of 60 dipping layers with a fault, most of them collapsed on all pillars or on
/// some.
fn collapsed() -> Grid {
    let dims = Dims {
        ni: 7,
        nj: 7,
        nk: 60,
    };
    let mut random = fastrand::Rng::with_seed(9);
    let pillars = (dims.ni + 1) * (dims.nj + 1);
    // Depth of each plane on each pillar, from its first one.
    let mut planes = vec![vec![0.0; pillars]];
    for k in 0..dims.nk {
        let kind = random.f64();
        let last = planes[k].iter();
        let next = last.map(|depth| {
            let is_thick = kind > 0.85 || kind > 0.7 && random.bool();
            depth
                + if is_thick {
                    0.5 + 6.0 * random.f64()
                } else {
                    0.0
                }
        });
        planes.push(next.collect());
    }
    let at = |i: usize, j: usize| i + (dims.ni + 1) * j;
    let mut coord = Vec::new();
    for j in 0..=dims.nj {
        for i in 0..=dims.ni {
            let top = ORIGIN + DVec3::new(100.0 * i as f64, 80.0 * j as f64, -100.0);
            let lean = DVec3::new(30.0 + 3.0 * j as f64, -20.0 + 2.0 * i as f64, 200.0);
            coord.extend([top, top + lean].iter().flat_map(|p| p.to_array()));
        }
    }
    let mut zcorn = Vec::new();
    for plane in 0..2 * dims.nk {
        for y in 0..2 * dims.nj {
            for x in 0..2 * dims.ni {
                let (i, j) = (x.div_ceil(2), y.div_ceil(2));
                let throw = if x / 2 >= 3 { 11.0 } else { 0.0 };
                let dip = 5.0 * i as f64 - 3.0 * j as f64;
                zcorn.push(ORIGIN.z + dip + throw + planes[plane.div_ceil(2)][at(i, j)]);
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
fn thick_layers_among_collapsed_ones_lose_nothing() {
    let Some(gpu) = common::gpu() else { return };
    let grid = collapsed();
    let dims = grid.dims();
    let all = grid.active_cells().iter().map(|&cell| dims.ijk(cell));
    let thick: Vec<_> = all.filter(|&ijk| grid.has_thickness(ijk)).collect();
    assert!(thick.len() * 2 < grid.active_cells().len());
    let mut random = fastrand::Rng::with_seed(10);
    let points: Vec<DVec3> = (0..30_000)
        .map(|_| {
            let cell = grid.hexahedron(thick[random.usize(0..thick.len())]);
            let mut unit = || 1.998 * random.f64() - 0.999;
            cell.at(DVec3::new(unit(), unit(), unit()))
        })
        .collect();
    let located = locate(&gpu, &grid, &points);
    let answers = Answers::of(&grid, &points, &located);
    let tally = Tally::of(&grid, &points, &located);
    println!("{} thick cells: {answers:?}, {tally:?}", thick.len());
    assert!(answers.are_right(), "{answers:?}");
    // In wedges, whose edges belong to several cells, rounding may choose another one.
    assert!(tally.elsewhere * 1000 <= points.len(), "{tally:?}");
    // The twin: the answer to one point is none to another.
    let others = Answers::of(&grid, &points[1..], &located);
    assert!(others.farthest.iter().all(|&off| off > 1.0), "{others:?}");
}
