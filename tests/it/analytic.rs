//! Pictures and values whose answer is a formula, by every strategy and the reference.

use crate::common;
use crate::common::images::{all, picture};
use crate::common::shape::{Shape, parallelepipeds};
use glam::DVec3;
use strataray::case::Case;
use strataray::model::VertexField;
use strataray::reference::{self, Locator};
use strataray::render::gpu::{GpuGrid, GpuRenderer, probe};
use strataray::scene::{
    CameraSpec, FramingCamera, Interpolation, OpacitySpec, Projection, RangeSpec, Scene,
    StrategyKind,
};
use strataray::view::{self, ShownCells, View};

fn scene(azimuth: f64, elevation: f64, opacity: &[[f64; 2]]) -> Scene {
    let mut scene = Scene {
        size: [60, 45],
        camera: CameraSpec::Framing(FramingCamera {
            azimuth_degrees: azimuth,
            elevation_degrees: elevation,
            zoom: 1.1,
            projection: Projection::Perspective,
        }),
        property: Some("VALUE".into()),
        range: RangeSpec::Fixed([0.0, 1.0]),
        vertical_exaggeration: Some(2.0),
        sampling_step: Some(0.75),
        early_termination: 0.0,
        ..Scene::default()
    };
    scene.transfer.opacity = Some(OpacitySpec::Points(opacity.to_vec()));
    scene.transfer.reference_length = Some(100.0);
    scene
}

/// True for those that keep to the cells: a resampled grid blurs their sides by about a voxel.
fn keeps_to_cells(by: Option<StrategyKind>) -> bool {
    by != Some(StrategyKind::Srg)
}

/// Convex solids: where `normal . p <= offset` for each pair, in world space.
type Solid = Vec<(DVec3, f64)>;

/// Alpha of a pixel, from the number of samples on the lattice inside solids that do not overlap.
fn alpha(view: &View, solids: &[Solid], x: u32, y: u32) -> [f64; 2] {
    let ray = reference::Ray::through_pixel(view, x, y);
    let step = view.sampling.step;
    let tau = view.style.transfer.extinction(0.5);
    let mut samples = [0.0, 0.0];
    for solid in solids {
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for (normal, offset) in solid {
            let (rate, height) = (normal.dot(ray.direction), offset - normal.dot(ray.origin));
            let t = height / rate;
            match rate < 0.0 {
                true => enter = enter.max(t),
                false => leave = leave.min(t),
            }
        }
        // A sample on a face may count or not; so both ends are given.
        let count = |slack: f64| {
            let first = ((enter + slack) / step - 0.5).ceil();
            let last = ((leave - slack) / step - 0.5).floor();
            (last - first + 1.0).max(0.0)
        };
        samples[0] += count(0.02);
        samples[1] += count(-0.02);
    }
    samples.map(|n| 1.0 - (-tau * step * n).exp())
}

/// Half-spaces of a box between two corners, sheared by `x += shear * z`.
fn slab(low: DVec3, high: DVec3, shear: f64) -> Solid {
    let side = DVec3::new(1.0, 0.0, -shear);
    vec![
        (side, high.x),
        (-side, -low.x),
        (DVec3::Y, high.y),
        (-DVec3::Y, -low.y),
        (DVec3::Z, high.z),
        (-DVec3::Z, -low.z),
    ]
}

fn check_alphas(case: &Case, solids: &[Solid], what: &str) {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    for (azimuth, elevation) in [(205.0, 35.0), (90.5, 7.0), (10.0, -50.0)] {
        let scene = scene(azimuth, elevation, &[[0.0, 0.6], [1.0, 0.6]]);
        let view = view::resolve(&scene, case).unwrap();
        for by in all() {
            let image = picture(&mut renderer, case, &view, by);
            let name = by.map_or("reference", StrategyKind::name);
            let (mut wrong, mut covered, mut shifted) = (0, 0, 0);
            let mut errors = [0.0, 0.0];
            for y in 0..view.size[1] {
                for x in 0..view.size[0] {
                    let found = f64::from(image.pixels[(x + view.size[0] * y) as usize][3]);
                    let within = |[low, high]: [f64; 2]| found > low - 1e-4 && found < high + 1e-4;
                    for (error, at) in errors.iter_mut().zip([x, x + 2]) {
                        let [low, high] = alpha(&view, solids, at, y);
                        *error += (found - 0.5 * (low + high)).abs();
                    }
                    covered += u32::from(found > 0.0);
                    wrong += u32::from(!within(alpha(&view, solids, x, y)));
                    // The twin: the answer of another pixel is wrong.
                    shifted += u32::from(!within(alpha(&view, solids, x + 2, y)));
                }
            }
            let [error, twin] = errors.map(|e: f64| e / f64::from(covered));
            println!(
                "{what} {name} {azimuth}: {wrong} of {covered} wrong, shifted {shifted}; mean error {error:.5}, shifted {twin:.5}"
            );
            match keeps_to_cells(by) {
                true => assert!(wrong * 200 <= covered, "{what} {name} {azimuth}: {wrong}"),
                false => assert!(
                    error < 0.003 && 10.0 * error < twin,
                    "{what} {azimuth}: {error}"
                ),
            }
            assert!(
                shifted * 4 > covered && covered > 200,
                "{shifted} {covered}"
            );
        }
    }
}

#[test]
fn ok_boxes_and_faulted_stacks_absorb_by_beer_lambert() {
    // World z is -2 * depth; the box is 200 x 200 wide, from depth 1000 to 1040.
    let [low, high] = [
        DVec3::new(0.0, 0.0, -2080.0),
        DVec3::new(200.0, 200.0, -2000.0),
    ];
    check_alphas(&Shape::default().case(), &[slab(low, high, 0.0)], "box");

    // Pillars lean by 0.5 along x for each unit of depth, so by -0.25 for each of world z.
    let sheared = Shape {
        pillar: &|i, j| {
            let [x, y] = [100.0 * i as f64, 100.0 * j as f64];
            [[x - 50.0, y, 900.0], [x + 50.0, y, 1100.0]]
        },
        ..Shape::default()
    };
    let offset = DVec3::new(-0.25 * 2000.0, 0.0, 0.0);
    let solid = slab(low + offset, high + offset, -0.25);
    check_alphas(&sheared.case(), &[solid], "sheared box");

    // The second column lies 13 deeper: three faces of the first are open in part.
    let faulted = Shape {
        depth: &|[i, _, k], [_, _, dk]| 1000.0 + 13.0 * i as f64 + 20.0 * (k + dk) as f64,
        ..Shape::default()
    };
    let case = faulted.case();
    assert_eq!(case.grid.fault_faces(), [4, 0]);
    let left = slab(low, high - DVec3::new(100.0, 0.0, 0.0), 0.0);
    let down = DVec3::new(0.0, 0.0, -26.0);
    let right = slab(low + down + DVec3::new(100.0, 0.0, 0.0), high + down, 0.0);
    check_alphas(&case, &[left, right], "faulted stack");
}

#[test]
fn nothing_bleeds_across_a_fault() {
    let Some(gpu) = common::gpu() else { return };
    // 0 on one side, 1 on the other; only what lies between is opaque.
    let covered = |throw: f64, by: Option<StrategyKind>| {
        let case = Shape {
            depth: &|[i, _, k], [_, _, dk]| 1000.0 + throw * i as f64 + 20.0 * (k + dk) as f64,
            value: &|[i, _, _]| i as f64,
            ..Shape::default()
        }
        .case();
        let opacity = [
            [0.0, 0.0],
            [0.02, 0.0],
            [0.1, 0.9],
            [0.9, 0.9],
            [0.98, 0.0],
            [1.0, 0.0],
        ];
        let view = view::resolve(&scene(205.0, 35.0, &opacity), &case).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let image = picture(&mut renderer, &case, &view, by);
        image.pixels.iter().filter(|p| p[3] > 0.0).count()
    };
    for by in all().filter(|by| keeps_to_cells(*by)) {
        assert_eq!(covered(7.0, by), 0, "{by:?}");
        assert!(
            covered(0.0, by) > 200,
            "{by:?}: without a throw values blend"
        );
    }
}

#[test]
fn a_linear_field_is_reproduced_inside_on_both() {
    let Some(gpu) = common::gpu() else { return };
    let errors = |square: f64| {
        let case = parallelepipeds::case(square);
        let field = case.field("VALUE", 0).unwrap();
        let mut random = fastrand::Rng::with_seed(12);
        let points: Vec<DVec3> = (0..2000)
            .map(|_| {
                // Within the cells that touch inner vertices only.
                let mut at = |n: usize| 1.01 + random.f64() * (n as f64 - 2.02);
                let [u, v, w] = parallelepipeds::DIMS.map(&mut at);
                let corner = parallelepipeds::corner;
                let axis = |a: DVec3| a - corner(0, 0, 0);
                corner(0, 0, 0)
                    + u * axis(corner(1, 0, 0))
                    + v * axis(corner(0, 1, 0))
                    + w * axis(corner(0, 0, 1))
            })
            .collect();
        let mut grid = GpuGrid::new(&gpu, &case.grid).unwrap();
        let drawn = vec![true; case.grid.active_cells().len()];
        let shown = ShownCells::new(field.clone(), drawn, Interpolation::Vertex);
        grid.show(&gpu, &case.grid, &shown).unwrap();
        let found = probe::locate(&gpu, &grid, &case.grid, &points, Interpolation::Vertex).unwrap();
        let locator = Locator::new(&case.grid);
        let vertices = VertexField::new(&case.grid, &field);
        let mut worst = [0.0f64; 2];
        for (point, found) in points.iter().zip(found) {
            let located = locator.locate(*point).unwrap();
            let on_cpu = reference::value_at(&case.grid, &located, &field, Some(&vertices));
            for (w, value) in worst
                .iter_mut()
                .zip([found.unwrap().value, on_cpu.unwrap()])
            {
                *w = w.max((value - parallelepipeds::value(*point, square)).abs());
            }
        }
        worst
    };
    let exact = errors(0.0);
    println!("linear field, worst errors on GPU and CPU: {exact:?}");
    assert!(exact.iter().all(|e| *e < 2e-5), "{exact:?}");
    // The twin: a quadratic field is not.
    assert!(errors(1e-5).iter().all(|e| *e > 1e-3));
}
