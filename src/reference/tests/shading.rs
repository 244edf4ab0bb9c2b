//! Colors of samples by the field's surfaces, and of whole pictures in some light.

use glam::DVec3;

use super::{
    Integrator, Sample, Shape, central_ray, constant, directional, light, render, skewed, view,
};
use crate::model::{CellField, Grid};
use crate::scene::lighting::{OcclusionSpec, ShadowSpec};
use crate::scene::{Interpolation, LightMode, LightingSpec};
use crate::view::ghosts::Ghosts;
use crate::view::lighting::{GRADIENT_FADE, SHININESS, SPECULAR};
use crate::view::{ShownGrids, View};

#[test]
fn gradients_are_those_of_the_interpolated_value() {
    let grid = skewed();
    let mut random = fastrand::Rng::with_seed(12);
    let field = CellField::new((0..60).map(|_| random.f32()).collect());
    let mut view = view(&grid, field, 0.01, 3.0);
    view.shown.cells.interpolation = Interpolation::Vertex;
    view.style.transfer.range = [-1.0, 3.0];
    let integrator = Integrator::new(&grid, &view);
    let value = |p: DVec3| integrator.sample(p).and_then(|s: Sample| s.value);
    for _ in 0..500 {
        let cell = grid.active_cells()[random.usize(0..60)];
        let mut one = || 0.9 * (2.0 * random.f64() - 1.0);
        let in_grid = grid
            .hexahedron(grid.dims().ijk(cell))
            .at(DVec3::new(one(), one(), one()));
        let p = view.world.spaces.world_from_grid.transform_point3(in_grid);
        let gradient = integrator.gradient(&integrator.sample(p).unwrap()).unwrap();
        let along = |axis: DVec3| {
            let [before, after] = [-1e-4, 1e-4].map(|d| value(p + d * axis).unwrap());
            (after - before) / 2e-4 / 4.0
        };
        let differences = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
        let error = gradient.distance(differences);
        assert!(
            error < 1e-6 * (1.0 + gradient.length()),
            "{gradient} {differences}"
        );
        assert!(gradient.length() > 1e-5);
    }
    view.shown.cells.interpolation = Interpolation::Cell;
    let constant = Integrator::new(&grid, &view);
    let middle = view.world.spaces.world_from_grid.transform_point3(
        grid.hexahedron(grid.dims().ijk(grid.active_cells()[0]))
            .center(),
    );
    assert_eq!(constant.gradient(&constant.sample(middle).unwrap()), None);
}

/// A medium whose positions rise along x by `rate` over a reference length of 2, seen along x and lit from `direction` toward it.
fn rising(rate: f64, direction: [f64; 3]) -> (Grid, View) {
    let grid = Shape {
        dims: [4, 3, 3],
        ..Shape::default()
    }
    .grid();
    let values = (0..36)
        .map(|n| (5.0 * rate) as f32 * (n % 4) as f32)
        .collect();
    let mut view = view(&grid, CellField::new(values), 0.01, 1.0);
    view.shown.cells.interpolation = Interpolation::Vertex;
    view.style.transfer.reference_length = 2.0;
    let spec = LightingSpec {
        lights: vec![directional(direction)],
        shadows: ShadowSpec {
            mode: LightMode::Off,
            ..ShadowSpec::default()
        },
        ambient: Some(0.2),
        blinn_phong: true,
        ..LightingSpec::default()
    };
    light(&mut view, spec, DVec3::ONE);
    (grid, view)
}

/// The color there of the medium in a cell with neighbors on all sides.
fn inner_color(grid: &Grid, view: &View) -> [f64; 3] {
    let integrator = Integrator::new(grid, view);
    let center = DVec3::new(15.0, 30.0, -209.0);
    integrator.lit(center, &integrator.sample(center).unwrap())
}

#[test]
fn blinn_phong_follows_its_formula() {
    for (rate, direction, cosines) in [
        // Along the gradient and the view; halfway is the same.
        (0.2, [1.0, 0.0, 0.0], [1.0, 1.0]),
        // By 3, 4, 5, and halfway by half of that angle.
        (0.2, [0.8, 0.6, 0.0], [0.8, 0.9f64.sqrt()]),
        (0.2, [0.0, 0.6, 0.8], [0.0, 0.5f64.sqrt()]),
        (0.04, [0.8, 0.6, 0.0], [0.8, 0.9f64.sqrt()]),
        (0.004, [0.8, 0.6, 0.0], [0.8, 0.9f64.sqrt()]),
        // From behind: the sign of the gradient means nothing.
        (0.2, [-0.8, 0.6, 0.0], [0.8, 0.1f64.sqrt()]),
    ] {
        let (grid, mut view) = rising(rate, direction);
        let [low, high] = GRADIENT_FADE;
        let x = ((rate - low) / (high - low)).clamp(0.0, 1.0);
        let weight = x * x * (3.0 - 2.0 * x);
        let [diffuse, halfway]: [f64; 2] = cosines;
        let expected = |own: f64| {
            let highlight = SPECULAR * weight * halfway.powf(SHININESS);
            own * (0.2 + 1.0 - weight + weight * diffuse) + highlight
        };
        let found = inner_color(&grid, &view);
        for (channel, own) in found.iter().zip([0.25, 0.5, 1.0]) {
            assert!(
                (channel - expected(own)).abs() < 1e-6,
                "{rate} {direction:?} {found:?}"
            );
        }
        // By the cell's own value, or without the model, there is no surface.
        view.shown.cells.interpolation = Interpolation::Cell;
        assert!((inner_color(&grid, &view)[2] - 1.2).abs() < 1e-12);
        view.shown.cells.interpolation = Interpolation::Vertex;
        view.style.lighting.blinn_phong = false;
        assert!((inner_color(&grid, &view)[2] - 1.2).abs() < 1e-12);
    }
}

/// Half of the cells inactive and shown, all in darkness.
fn dark_ghosts(exact_colors: bool) -> [f64; 4] {
    let grid = Shape {
        active: &|ijk| ijk.i == 1,
        ..Shape::default()
    }
    .grid();
    let mut view = view(&grid, constant(&grid), 0.07, 0.3);
    view.shown.cells.ghosts = Some(Ghosts::new(&grid, &ShownGrids::default(), &[true; 4]).into());
    view.world.bounds[0].x -= 10.0;
    let spec = LightingSpec {
        lights: vec![directional([-1.0, 0.0, 0.0])],
        ambient: Some(0.0),
        exact_colors,
        ..LightingSpec::default()
    };
    light(&mut view, spec, DVec3::ONE);
    view.style.lighting.lights[0].intensity = 0.0;
    central_ray(&grid, &view)
}

#[test]
fn exact_colors_shade_only_what_has_no_value() {
    let [red, green, blue, alpha] = dark_ghosts(true);
    let by_ghosts = 1.0 - blue / alpha;
    // 33 samples of ghosts before the others, which are seen in their own color.
    assert!((0.01..0.5).contains(&by_ghosts), "{by_ghosts}");
    assert!((red / blue - 0.25).abs() < 1e-12 && (green / blue - 0.5).abs() < 1e-12);
    let [.., blue, alpha_of_shaded] = dark_ghosts(false);
    assert!(blue == 0.0 && alpha_of_shaded == alpha);
}

#[test]
fn a_ghost_between_values_has_no_gradient() {
    let grid = Shape {
        dims: [3, 1, 1],
        active: &|ijk| ijk.i != 1,
        ..Shape::default()
    }
    .grid();
    let mut view = view(&grid, CellField::new(vec![0.0, 1.0]), 0.07, 0.3);
    view.shown.cells.interpolation = Interpolation::Vertex;
    let gradient = |grid: &Grid, view: &View| {
        let integrator = Integrator::new(grid, view);
        let middle = integrator.sample(DVec3::new(15.0, 10.0, -203.0)).unwrap();
        integrator.gradient(&middle)
    };
    view.shown.cells.ghosts = Some(Ghosts::new(&grid, &ShownGrids::default(), &[true; 2]).into());
    // All of its vertices have values, of the cells beside it.
    assert_eq!(gradient(&grid, &view), None);
    // With a value of its own it has one.
    view.shown.cells.ghosts = None;
    view.shown.cells.field = CellField::new(vec![0.0, 0.5, 1.0]).into();
    view.shown.cells.drawn = vec![true; 3].into();
    let with_value = gradient(&grid.with_inactive(), &view).unwrap();
    assert!(with_value.distance(0.05 * DVec3::X) < 1e-9);
}

#[test]
fn light_that_shades_nothing_changes_no_bit() {
    let grid = skewed();
    let field = CellField::new((0..60).map(|n| n as f32 / 60.0).collect());
    let mut view = view(&grid, field, 0.02, 3.0);
    view.shown.cells.interpolation = Interpolation::Vertex;
    view.camera.eye.x -= 500.0;
    let picture = |view: &View| render(&grid, view, &|_| true).unwrap().pixels;
    let off = picture(&view);
    assert!(off.iter().filter(|p| p[3] > 0.1).count() > 10);
    let occluded = |strength| LightingSpec {
        occlusion: Some(OcclusionSpec {
            strength,
            ..OcclusionSpec::default()
        }),
        rays: 2,
        ..LightingSpec::default()
    };
    light(&mut view, occluded(0.0), DVec3::splat(10.0));
    assert_eq!(picture(&view), off);
    light(&mut view, occluded(0.5), DVec3::splat(10.0));
    assert_ne!(picture(&view), off);
}

#[test]
fn pictures_depend_on_the_seed_alone() {
    let grid = skewed();
    let field = CellField::new((0..60).map(|n| n as f32 / 60.0).collect());
    let mut view = view(&grid, field, 0.02, 3.0);
    view.camera.eye.x -= 500.0;
    let spec = |seed| LightingSpec {
        occlusion: Some(OcclusionSpec::default()),
        rays: 4,
        seed,
        ..LightingSpec::default()
    };
    let mut picture = |seed, threads| {
        light(&mut view, spec(seed), DVec3::splat(10.0));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap()
            .install(|| render(&grid, &view, &|_| true).unwrap().pixels)
    };
    let [one, again, other] = [picture(1, 1), picture(1, 3), picture(2, 1)];
    assert_eq!(one, again);
    assert_ne!(one, other);
    let mean = |pixels: &[[f32; 4]]| pixels.iter().map(|p| f64::from(p[2])).sum::<f64>() / 81.0;
    assert!((mean(&one) / mean(&other) - 1.0).abs() < 0.01);
}
