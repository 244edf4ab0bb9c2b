//! The reference against what can be computed by hand.

mod cone;
mod lights;
mod shading;

use glam::{DAffine3, DVec2, DVec3};

use super::integrate::Sample;
use super::{Integrator, Located, Locator, Ray, render, value_at};
use crate::image::metrics::fraction_within;
use crate::model::{CellField, Dims, Grid, GridInput, Ijk, MapAxes, Spaces, VertexField};
use crate::scene::lighting::{LightSpec, VolumeSpec};
use crate::scene::{Interpolation, LightingSpec, StrategyKind};
use crate::transfer::TransferFunction;
use crate::view::{Camera, Notes, Sampling, Shown, ShownCells, Style, View, World, lighting};

/// A grid whose pillars and depths are functions of their place.
struct Shape<'a> {
    dims: [usize; 3],
    /// Upper and lower end of pillar (i, j).
    pillar: &'a dyn Fn(usize, usize) -> [DVec3; 2],
    /// Depth of corner (di, dj, dk) of cell (i, j, k).
    depth: &'a dyn Fn(Ijk, [usize; 3]) -> f64,
    active: &'a dyn Fn(Ijk) -> bool,
    axes: Option<MapAxes>,
}

impl Default for Shape<'_> {
    /// Two by two by two cells of 10 x 20 x 3, the top at depth 100.
    fn default() -> Self {
        Self {
            dims: [2, 2, 2],
            pillar: &|i, j| {
                let top = DVec3::new(10.0 * i as f64, 20.0 * j as f64, 0.0);
                [top, top + 1000.0 * DVec3::Z]
            },
            depth: &|ijk, d| 100.0 + 3.0 * (ijk.k + d[2]) as f64,
            active: &|_| true,
            axes: None,
        }
    }
}

impl Shape<'_> {
    fn grid(&self) -> Grid {
        let [ni, nj, nk] = self.dims;
        let dims = Dims { ni, nj, nk };
        let pillar = |n: usize| (self.pillar)(n % (ni + 1), n / (ni + 1));
        let ends = (0..dims.pillars()).flat_map(pillar);
        let coord: Vec<f64> = ends.flat_map(|end| end.to_array()).collect();
        let zcorn: Vec<f64> = (0..8 * dims.cells())
            .map(|at| {
                let (x, rest) = (at % (2 * ni), at / (2 * ni));
                let (y, z) = (rest % (2 * nj), rest / (2 * nj));
                let (i, j, k) = (x / 2, y / 2, z / 2);
                (self.depth)(Ijk { i, j, k }, [x % 2, y % 2, z % 2])
            })
            .collect();
        let cells = (0..dims.cells() as u32).map(|n| dims.ijk(crate::model::CellIndex(n)));
        let actnum: Vec<i32> = cells.map(|ijk| i32::from((self.active)(ijk))).collect();
        Grid::new(&GridInput {
            dims,
            coord: &coord,
            zcorn: &zcorn,
            actnum: Some(&actnum),
            map_axes: self.axes,
        })
        .unwrap()
    }
}

/// Tilted, converging pillars and dipping, uneven layers.
fn skewed() -> Grid {
    Shape {
        dims: [3, 4, 5],
        pillar: &|i, j| {
            let top = DVec3::new(100.0 * i as f64, 80.0 * j as f64, 1000.0);
            let lean = DVec3::new(7.0 * j as f64 - 5.0, 3.0 * i as f64, 200.0);
            [top, top + lean]
        },
        depth: &|ijk, d| {
            let (i, j, k) = (ijk.i + d[0], ijk.j + d[1], ijk.k + d[2]);
            1000.0 + 12.0 * i as f64 + 5.0 * (k * (j + 2)) as f64 + (i * j * k) as f64
        },
        ..Shape::default()
    }
    .grid()
}

/// A view of a grid from the side with one color (linear 0.25, 0.5, 1) and one extinction.
fn view(grid: &Grid, field: CellField, extinction: f64, sampling_step: f64) -> View {
    let spaces = Spaces::new(grid.map_axes(), 2.0);
    let [low, high] = grid.bounds().unwrap();
    let [a, b] = [low, high].map(|p| spaces.world_from_grid.transform_point3(p));
    let world_bounds = [a.min(b), a.max(b)];
    let center = 0.5 * (a + b);
    let eye = center - 100.0 * DVec3::X;
    let srgb = [0.25, 0.5, 1.0].map(crate::image::color::srgb_from_linear);
    let box_corners = std::array::from_fn(|c| {
        let pick = |axis: usize| world_bounds[c >> axis & 1][axis];
        DVec3::new(pick(0), pick(1), pick(2))
    });
    View {
        size: [9, 9],
        camera: Camera::look_at(eye, center, DVec3::Z, 0.3).unwrap(),
        style: Style {
            background: [1.0; 3],
            beyond: [false; 2],
            transfer: TransferFunction {
                color: vec![(0.0, srgb)],
                opacity: vec![(0.0, 1.0 - (-extinction).exp())],
                range: [0.0, 1.0],
                scale: crate::transfer::Scale::Linear,
                bands: None,
                reference_length: 1.0,
            },
            blending: crate::image::Blending::Linear,
            surfaces: crate::view::Surfaces::default(),
            lighting: lighting::resolve(&LightingSpec::default(), DVec3::ONE, 1).unwrap(),
        },
        world: World {
            spaces,
            vertical_exaggeration: 2.0,
            space: crate::model::Space::Map,
            bounds: world_bounds,
            corners: box_corners,
            subject: crate::view::Subject::of_box(box_corners).into(),
        },
        sampling: Sampling {
            strategy: StrategyKind::ALL[0],
            step: sampling_step,
            early_termination: 0.0,
            supersample: 1,
            libc: crate::scene::LibcSettings::default(),
            plts: crate::scene::PltsSettings::default(),
            srg: crate::scene::SrgSettings::default(),
            storage: crate::scene::Storage::default(),
        },
        shown: Shown {
            property: "TEST".into(),
            step: 0,
            wells: std::sync::Arc::default(),
            connections: std::sync::Arc::default(),
            named_faults: std::sync::Arc::default(),
            chosen_faults: None,
            cube: None,
            clip: Vec::new(),
            cells: ShownCells::new(
                field.into(),
                vec![true; grid.active_cells().len()],
                Interpolation::Cell,
            ),
        },
        notes: Notes {
            has_box: false,
            has_legend: false,
            facts: None,
            units: crate::case::Units::default(),
            warnings: Vec::new(),
        },
    }
}

/// Lights a view of a grid along the axes, with voxels of these edges.
fn light(view: &mut View, spec: LightingSpec, voxel: DVec3) {
    let extent = view.world.bounds[1] - view.world.bounds[0];
    let size = (extent / voxel).to_array().map(|n| n.round() as u32);
    let volume = VolumeSpec {
        size: Some(size),
        ..spec.volume
    };
    let spec = LightingSpec { volume, ..spec };
    view.style.lighting = lighting::resolve(&spec, extent, view.shown.cells.drawn.len()).unwrap();
}

/// A white light with sharp shadows that shines along `direction`.
fn directional(direction: [f64; 3]) -> LightSpec {
    LightSpec::Directional {
        direction,
        half_angle_degrees: 1.0,
        intensity: Some(1.0),
        color: "#ffffff".into(),
    }
}

fn constant(grid: &Grid) -> CellField {
    CellField::new(vec![0.5; grid.active_cells().len()])
}

fn central_ray(grid: &Grid, view: &View) -> [f64; 4] {
    Integrator::new(grid, view).ray(Ray::through_pixel(view, 4, 4))
}

#[test]
fn ok_every_point_of_a_cell_is_located_in_it() {
    let grid = skewed();
    let locator = Locator::new(&grid);
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..10_000 {
        let cell = grid.active_cells()[random.usize(0..grid.active_cells().len())];
        let ijk = grid.dims().ijk(cell);
        let mut one = || 0.9999 * (2.0 * random.f64() - 1.0);
        let str = DVec3::new(one(), one(), one());
        let found = locator.locate(grid.hexahedron(ijk).at(str)).unwrap();
        assert_eq!(found.ijk, ijk);
        assert!(found.str.distance(str) < 1e-9);
    }
}

#[test]
fn err_points_outside_and_in_inactive_cells_are_nowhere() {
    let hole = Ijk { i: 0, j: 0, k: 0 };
    let grid = Shape {
        active: &|ijk| ijk != hole,
        ..Shape::default()
    }
    .grid();
    let locator = Locator::new(&grid);
    assert_eq!(locator.locate(grid.hexahedron(hole).center()), None);
    let [low, high] = grid.bounds().unwrap();
    for axis in 0..3 {
        for (end, sign) in [(low, -1.0), (high, 1.0)] {
            let mut point = 0.5 * (low + high) + 0.1;
            point[axis] = end[axis] + sign * 1e-4;
            assert_eq!(locator.locate(point), None);
            point[axis] = end[axis] - sign * 1e-4;
            assert!(locator.locate(point).is_some());
        }
    }
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(locator.locate(DVec3::splat(bad)), None);
    }
}

#[test]
fn shared_faces_belong_to_the_first_cell() {
    let grid = skewed();
    let locator = Locator::new(&grid);
    let mut random = fastrand::Rng::with_seed(8);
    for _ in 0..2_000 {
        let ijk = Ijk {
            i: random.usize(0..2),
            j: random.usize(0..3),
            k: random.usize(0..4),
        };
        let axis = random.usize(0..3);
        let mut one = || 0.99 * (2.0 * random.f64() - 1.0);
        let mut str = DVec3::new(one(), one(), one());
        str[axis] = 1.0;
        let point = grid.hexahedron(ijk).at(str);
        // The cell on the upper side of the face has it too, and is not the one found.
        let mut next = ijk;
        *[&mut next.i, &mut next.j, &mut next.k][axis] += 1;
        str[axis] = -1.0;
        assert!(grid.hexahedron(next).at(str).distance(point) < 1e-9);
        assert_eq!(locator.locate(point).unwrap().ijk, ijk);
    }
}

#[test]
fn overlapping_cells_give_the_first_column_then_the_upper_layer() {
    // The lower layer reaches up through half of the upper one, and the pillars of both columns
    // meet at depth 200 and cross below.
    let grid = Shape {
        dims: [2, 1, 2],
        pillar: &|i, j| {
            let top = DVec3::new(10.0 * i as f64, 20.0 * j as f64, 100.0);
            let bottom = DVec3::new(10.0, 20.0 * j as f64, 200.0);
            [top, bottom]
        },
        depth: &|ijk, d| match (ijk.i, ijk.k) {
            (0, 0) => 100.0 + 50.0 * d[2] as f64,
            (0, _) => 125.0 + 50.0 * d[2] as f64,
            _ => 210.0 + 40.0 * (ijk.k + d[2]) as f64,
        },
        ..Shape::default()
    }
    .grid();
    let locator = Locator::new(&grid);
    let at = |x, depth| locator.locate(DVec3::new(x, 10.0, depth)).map(|l| l.ijk);
    let ijk = |i, k| Some(Ijk { i, j: 0, k });
    assert_eq!(at(9.0, 124.0), ijk(0, 0));
    assert_eq!(at(9.0, 130.0), ijk(0, 0)); // also in layer 1
    assert_eq!(at(9.0, 160.0), ijk(0, 1));
    assert_eq!(at(11.0, 130.0), None);
    // Inside out, and still found.
    assert_eq!(at(9.0, 240.0), ijk(1, 0));
    assert_eq!(at(9.0, 260.0), ijk(1, 1));
    assert_eq!(at(11.0, 240.0), None);
}

#[test]
fn vertex_values_reproduce_a_linear_field() {
    let grid = skewed();
    let linear = |p: DVec3| 3.0 + p.dot(DVec3::new(0.01, -0.02, 0.005));
    let locator = Locator::new(&grid);
    let mut random = fastrand::Rng::with_seed(9);
    for _ in 0..1_000 {
        let cell = grid.active_cells()[random.usize(0..grid.active_cells().len())];
        let hexahedron = grid.hexahedron(grid.dims().ijk(cell));
        let mut one = || 0.99 * (2.0 * random.f64() - 1.0);
        let point = hexahedron.at(DVec3::new(one(), one(), one()));
        let located = locator.locate(point).unwrap();
        let weights = crate::model::corner_point::weights(located.str);
        let sum = |f: &dyn Fn(DVec3) -> f64| -> f64 {
            (0..8).map(|c| weights[c] * f(hexahedron.0[c])).sum()
        };
        assert!((sum(&linear) - linear(point)).abs() < 1e-9);
        // A quadratic field is not reproduced.
        assert!((sum(&|p| p.x * p.x) - point.x * point.x).abs() > 1e-6);
    }
}

#[test]
fn value_at_of_cells_and_vertices() {
    let grid = Shape::default().grid();
    let mut values: Vec<f32> = (0..8).map(|n| n as f32).collect();
    let corner = |at: f64| Located {
        ijk: Ijk { i: 0, j: 0, k: 0 },
        str: DVec3::splat(at),
    };
    let field = CellField::new(values.clone());
    let vertices = VertexField::new(&grid, &field);
    assert_eq!(value_at(&grid, &corner(1.0), &field, None), Some(0.0));
    // The inner vertex has the mean of all eight, the outer one the cell's own value.
    assert_eq!(
        value_at(&grid, &corner(1.0), &field, Some(&vertices)),
        Some(3.5)
    );
    assert_eq!(
        value_at(&grid, &corner(-1.0), &field, Some(&vertices)),
        Some(0.0)
    );
    // Between 0, 0.5 (along i), 1, 2 and 4, ... : the mean of the means (0+.5+1+1.5+2+2.5+3+3.5)/8.
    assert_eq!(
        value_at(&grid, &corner(0.0), &field, Some(&vertices)),
        Some(1.75)
    );
    values[0] = f32::NAN;
    let field = CellField::new(values);
    let vertices = VertexField::new(&grid, &field);
    for vertices in [None, Some(&vertices)] {
        assert_eq!(value_at(&grid, &corner(1.0), &field, vertices), None);
    }
}

#[test]
fn ray_through_a_box_is_beer_lambert() {
    let grid = Shape::default().grid();
    let (extinction, step) = (0.07, 0.3);
    let view = view(&grid, constant(&grid), extinction, step);
    let [red, green, blue, alpha] = central_ray(&grid, &view);
    // The box is 20 long along x and begins 90 from the eye: samples at (n + 1/2) 0.3 within
    // 90..110 are n = 300..=366, which are 67.
    let expected = 1.0 - (-extinction * step * 67.0).exp();
    assert!((alpha - expected).abs() < 1e-12);
    assert!((1.0 - alpha - (-extinction * 20.0f64).exp()).abs() < extinction * step);
    for (channel, linear) in [(red, 0.25), (green, 0.5), (blue, 1.0)] {
        assert!((channel - linear * alpha).abs() < 1e-12);
    }
    // One sample less would be noticed.
    assert!((alpha - 1.0 + (-extinction * step * 66.0).exp()).abs() > 1e-3);
}

#[test]
fn a_slab_has_the_same_transmittance_everywhere_in_parallel() {
    let grid = Shape::default().grid();
    let (extinction, step) = (0.07, 0.3);
    let mut view = view(&grid, constant(&grid), extinction, step);
    let center = 0.5 * (view.world.bounds[0] + view.world.bounds[1]);
    let perspective = render(&grid, &view, &|_| true).unwrap();
    view.camera = view.camera.with(crate::scene::Projection::Parallel, center);
    // A picture as high as the slab is 12 high, and as wide as it is 40 wide.
    view.camera.parallel = Some(5.9);
    view.camera.right *= 3.0;
    let parallel = render(&grid, &view, &|_| true).unwrap();
    // Samples as on the central ray in perspective, which all others take on a longer way.
    let expected = (-extinction * step * 67.0).exp();
    let error = |p: &[f32; 4]| (1.0 - f64::from(p[3]) - expected).abs();
    assert!(parallel.pixels.iter().all(|p| error(p) < 1e-6));
    assert!(perspective.pixels.iter().any(|p| error(p) > 1e-3));
    // From the middle of the slab on, half as many.
    view.camera.eye = center;
    let half = render(&grid, &view, &|_| true).unwrap();
    let expected = (-extinction * step * 33.0).exp();
    let error = |p: &[f32; 4]| (1.0 - f64::from(p[3]) - expected).abs();
    assert!(half.pixels.iter().all(|p| error(p) < 1e-6));
}

#[test]
fn hidden_and_undefined_cells_are_empty() {
    let grid = Shape::default().grid();
    // The central ray runs along the edge of four pairs of cells, which the first pair has.
    let mut hidden = view(&grid, constant(&grid), 0.07, 0.3);
    for n in [0, 2, 4, 6] {
        std::sync::Arc::make_mut(&mut hidden.shown.cells.drawn)[n] = false;
    }
    let expected = |samples: f64| 1.0 - (-0.07 * 0.3 * samples).exp();
    // 90..100 has samples n = 300..=332 (33 of them), 100..110 the other 34.
    assert!((central_ray(&grid, &hidden)[3] - expected(34.0)).abs() < 1e-12);
    let mut values = vec![0.5; 8];
    for n in [1, 3, 5, 7] {
        values[n] = f32::NAN;
    }
    let undefined = view(&grid, CellField::new(values), 0.07, 0.3);
    assert!((central_ray(&grid, &undefined)[3] - expected(33.0)).abs() < 1e-12);
}

#[test]
fn early_termination_ends_a_ray() {
    let grid = Shape::default().grid();
    let mut view = view(&grid, constant(&grid), 1.0, 0.3);
    view.sampling.early_termination = 0.01;
    // exp(-0.3 n) falls below 0.01 at n = 16.
    let expected = 1.0 - (-0.3f64 * 16.0).exp();
    assert!((central_ray(&grid, &view)[3] - expected).abs() < 1e-12);
}

#[test]
fn eye_inside_the_box_sees_what_is_ahead() {
    let grid = Shape::default().grid();
    let mut view = view(&grid, constant(&grid), 0.07, 0.3);
    view.camera.eye += 100.0 * DVec3::X;
    // Samples at (n + 1/2) 0.3 up to 10: n = 0..=32.
    let expected = 1.0 - (-0.07 * 0.3 * 33.0f64).exp();
    assert!((central_ray(&grid, &view)[3] - expected).abs() < 1e-12);
    view.camera.forward = -view.camera.forward;
    view.camera.eye -= 100.0 * DVec3::X;
    assert_eq!(central_ray(&grid, &view), [0.0; 4]);
}

#[test]
fn picture_does_not_depend_on_where_the_model_is_nor_on_its_axes() {
    let near = skewed();
    let picture = |grid: &Grid| {
        let field = CellField::new((0..60).map(|n| n as f32 / 60.0).collect());
        let mut view = view(grid, field, 0.01, 3.0);
        view.style.transfer.opacity = vec![(0.0, 0.0), (1.0, 0.05)];
        view.shown.cells.interpolation = Interpolation::Vertex;
        view.camera = Camera::framing(
            &view.world.corners,
            1.0,
            0.5,
            1.0,
            1.0,
            crate::scene::Projection::Perspective,
        )
        .unwrap();
        render(grid, &view, &|_| true).unwrap()
    };
    let at_home = picture(&near);
    let covered = at_home.pixels.iter().filter(|p| p[3] > 0.1).count();
    assert!(covered > 10, "{covered}");
    let moved = Shape {
        dims: [3, 4, 5],
        pillar: &|i, j| {
            let p = near.pillars()[i + 4 * j];
            [p.top, p.bottom].map(|end| end + DVec3::new(1024.0, 2048.0, 0.0))
        },
        depth: &|ijk, d| near.corner_depth(ijk, d[0] + 2 * d[1] + 4 * d[2]),
        axes: Some(MapAxes {
            origin: DVec2::new(460_000.0, 5_930_000.0),
            ex: DVec2::X,
            ey: DVec2::Y,
            unit: None,
        }),
        ..Shape::default()
    }
    .grid();
    let far = picture(&moved);
    assert!(fraction_within(&at_home.pixels, &far.pixels, 1e-3) > 0.95);
    // Mirrored axes give another picture.
    let mirrored = Shape {
        dims: [3, 4, 5],
        pillar: &|i, j| {
            let p = near.pillars()[i + 4 * j];
            [p.top, p.bottom]
        },
        depth: &|ijk, d| near.corner_depth(ijk, d[0] + 2 * d[1] + 4 * d[2]),
        axes: Some(MapAxes {
            origin: DVec2::ZERO,
            ex: DVec2::X,
            ey: -DVec2::Y,
            unit: None,
        }),
        ..Shape::default()
    }
    .grid();
    let other = picture(&mirrored);
    assert!(fraction_within(&at_home.pixels, &other.pixels, 1e-3) < 0.9);
}

#[test]
fn render_puts_the_top_row_first_and_can_be_stopped() {
    // Only the upper layer is there, so that the picture is full above and empty below.
    let grid = Shape {
        dims: [2, 2, 10],
        active: &|ijk| ijk.k < 5 || ijk.i + ijk.j == 0 && ijk.k == 9,
        ..Shape::default()
    }
    .grid();
    let view = view(&grid, constant(&grid), 10.0, 0.1);
    let seen = std::sync::Mutex::new(Vec::new());
    let image = render(&grid, &view, &|done| {
        seen.lock().unwrap().push(done);
        true
    })
    .unwrap();
    assert_eq!((image.size, image.pixels.len()), ([9, 9], 81));
    let seen = seen.into_inner().unwrap();
    assert!(seen.len() == 9 && seen.contains(&1.0));
    assert!(image.pixels[9 * 3 + 4][3] > 0.99 && image.pixels[9 * 5 + 4][3] == 0.0);
    assert_eq!(render(&grid, &view, &|_| false), None);
}

#[test]
fn rays_through_pixels_agree_with_the_projection() {
    let grid = Shape::default().grid();
    let mut view = view(&grid, constant(&grid), 1.0, 1.0);
    view.size = [40, 20];
    for (x, y) in [(0, 0), (39, 0), (13, 17)] {
        let ray = Ray::through_pixel(&view, x, y);
        let at = view.camera.project(ray.origin + 7.0 * ray.direction, 2.0);
        let expected = DVec2::new((f64::from(x) + 0.5) / 40.0, (f64::from(y) + 0.5) / 20.0);
        assert!(at.is_some_and(|at| at.distance(expected) < 1e-12));
    }
    assert_ne!(view.world.spaces.world_from_grid, DAffine3::IDENTITY);
}
