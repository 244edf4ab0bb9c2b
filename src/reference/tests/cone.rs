//! Transmittances of cones through media that have answers in closed form or by one integral.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Integrator, Shape, constant, light, view};
use crate::model::Grid;
use crate::scene::LightingSpec;
use crate::scene::lighting::{OcclusionSpec, VolumeSpec};
use crate::view::lighting::Cone;
use crate::view::{ClipPlane, View};

/// Cells side by side with faces at these places of x; in world space 200 wide along y and z, from the
/// middle (0, -100).
fn row(faces: &[f64]) -> Grid {
    Shape {
        dims: [faces.len() - 1, 1, 1],
        pillar: &|i, j| {
            let top = DVec3::new(faces[i], 200.0 * j as f64 - 100.0, 0.0);
            [top, top + 1000.0 * DVec3::Z]
        },
        depth: &|_, d| 100.0 * d[2] as f64,
        ..Shape::default()
    }
    .grid()
}

/// Of such a row, its cells drawn or not, with one extinction and rays over cones that begin at 1.
fn row_view(grid: &Grid, drawn: &[bool], extinction: f64, rays: u32) -> View {
    let mut view = view(grid, constant(grid), extinction, 1.0);
    view.shown.cells.drawn = drawn.to_vec().into();
    let spec = LightingSpec {
        rays,
        ..LightingSpec::default()
    };
    light(&mut view, spec, DVec3::ONE);
    view
}

fn cone(half_angle_degrees: f64, length: f64) -> Cone {
    Cone {
        half_angle: half_angle_degrees.to_radians(),
        splits: 7,
        attenuation: 0.6,
        gap: 1.0,
        length,
        even_media: true,
    }
}

/// From a place on the middle line of a row, without another end than the cone's.
fn transmittance(integrator: &Integrator, x: f64, axis: DVec3, cone: &Cone, seed: u64) -> f64 {
    let apex = DVec3::new(x, 0.0, -100.0);
    let mut random = fastrand::Rng::with_seed(seed);
    integrator.transmittance(apex, axis, cone, f64::INFINITY, &mut random)
}

/// Mean over a cone, weighted by the cosine to its axis, of a function of that cosine.
fn mean_over(cone: &Cone, of: &dyn Fn(f64) -> f64) -> f64 {
    let low = cone.half_angle.cos();
    let cosines = (0..1000).map(|n| low + (1.0 - low) * (f64::from(n) + 0.5) / 1000.0);
    let [sum, weight] = cosines.fold([0.0; 2], |[sum, weight], c| [sum + c * of(c), weight + c]);
    sum / weight
}

#[test]
fn in_a_uniform_medium_all_rays_are_as_long_as_the_cone() {
    let grid = row(&[0.0, 200.0]);
    let view = row_view(&grid, &[true], 0.03, 5);
    let integrator = Integrator::new(&grid, &view);
    let axis = DVec3::new(0.6, 0.48, -0.64);
    for (degrees, length) in [(1.0, 35.0), (20.0, 35.3), (45.0, 80.0), (20.0, 1.3)] {
        let found = transmittance(&integrator, 100.0, axis, &cone(degrees, length), 1);
        assert!((found - (-0.03 * (length - 1.0)).exp()).abs() < 1e-12);
        assert!((found - (-0.03 * length).exp()).abs() > 1e-3);
    }
    // Rays begin at a gap of their own: a cone's counts for nothing.
    for gap in [0.0, 2.5] {
        let mut view = row_view(&grid, &[true], 0.03, 5);
        view.style.lighting.rays_gap = gap;
        let integrator = Integrator::new(&grid, &view);
        let found = transmittance(&integrator, 100.0, axis, &cone(20.0, 35.0), 1);
        assert!(
            (found - (-0.03 * (35.0 - gap)).exp()).abs() < 1e-12,
            "{found}"
        );
        let gap = cone(20.0, 35.0).gap;
        assert!((found - (-0.03 * (35.0 - gap)).exp()).abs() > 5e-3);
    }
    // Nothing between the gap and the end.
    let short = transmittance(&integrator, 100.0, axis, &cone(20.0, 0.9), 1);
    assert!((short - 1.0).abs() < 1e-12);
}

#[test]
fn rays_start_by_the_voxels_that_the_view_decided_on() {
    let grid = row(&[0.0, 200.0]);
    let found = [10, 160].map(|budget| {
        let mut view = row_view(&grid, &[true], 0.03, 5);
        let extent = view.world.bounds[1] - view.world.bounds[0];
        let spec = LightingSpec {
            rays_gap: 2.0,
            volume: VolumeSpec {
                budget_mb: Some(budget),
                ..VolumeSpec::default()
            },
            ..LightingSpec::default()
        };
        // So many cells that the budget alone decides.
        view.style.lighting = crate::view::lighting::resolve(&spec, extent, 10_000_000).unwrap();
        let integrator = Integrator::new(&grid, &view);
        let found = transmittance(&integrator, 100.0, DVec3::X, &cone(20.0, 35.0), 1);
        let start = 2.0 * view.style.lighting.sigma();
        assert!((found - (-0.03 * (35.0 - start)).exp()).abs() < 1e-12);
        found
    });
    assert!(found[1] < found[0] - 1e-3, "{found:?}");
}

#[test]
fn rays_end_at_what_they_reach_for_and_when_all_is_dark() {
    let grid = row(&[0.0, 200.0]);
    let view = row_view(&grid, &[true], 0.03, 5);
    let integrator = Integrator::new(&grid, &view);
    let apex = DVec3::new(100.0, 0.0, -100.0);
    let reach = |reach| {
        let mut random = fastrand::Rng::with_seed(3);
        integrator.transmittance(apex, DVec3::Y, &cone(20.0, 50.0), reach, &mut random)
    };
    assert!((reach(12.0) - (-0.03f64 * 11.0).exp()).abs() < 1e-12);
    assert!((reach(60.0) - (-0.03f64 * 49.0).exp()).abs() < 1e-12);
    assert!((reach(0.0) - 1.0).abs() < 1e-12);
    // exp(-10 * 49) would be 1e-213; the first step that falls below 1e-3 ends it.
    let dark = row_view(&grid, &[true], 10.0, 5);
    let dark = transmittance(
        &Integrator::new(&grid, &dark),
        100.0,
        DVec3::X,
        &cone(20.0, 50.0),
        1,
    );
    assert!((1e-6..1e-3).contains(&dark), "{dark}");
}

#[test]
fn the_model_ends_at_its_box() {
    let grid = row(&[0.0, 200.0]);
    let view = row_view(&grid, &[true], 0.05, 256);
    let integrator = Integrator::new(&grid, &view);
    // The face is 10 ahead, the cone's end 10.6 from its apex: some rays end here and some there.
    let wide = cone(30.0, 10.6);
    let path = |c: f64| (10.0 / c).min(10.6) - 1.0;
    let expected = mean_over(&wide, &|c| (-0.05 * path(c)).exp());
    let found = transmittance(&integrator, 190.0, DVec3::X, &wide, 1);
    assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    for other in [(-0.05f64 * 9.0).exp(), (-0.05f64 * 9.6).exp()] {
        assert!((found - other).abs() > 1e-3);
    }
}

#[test]
fn a_half_space_hides_all_of_a_cone_or_half_of_it() {
    let grid = row(&[0.0, 100.0, 200.0]);
    let view = row_view(&grid, &[false, true], 50.0, 256);
    let integrator = Integrator::new(&grid, &view);
    let wide = cone(20.0, 60.0);
    assert!(transmittance(&integrator, 90.0, DVec3::X, &wide, 1) < 1e-3);
    assert_eq!(
        transmittance(&integrator, 90.0, DVec3::NEG_X, &wide, 1),
        1.0
    );
    assert_eq!(transmittance(&integrator, 30.0, DVec3::X, &wide, 1), 1.0);
    for (seed, axis) in [(1, DVec3::Y), (2, DVec3::NEG_Y), (3, DVec3::Z)] {
        let half = transmittance(&integrator, 100.0, axis, &wide, seed);
        assert!((half - 0.5).abs() < 0.02, "{half}");
    }
    // Turned into it by 5 degrees, of a direction's turns around the axis fewer stay outside.
    let (into, along) = 5f64.to_radians().sin_cos();
    let outside = |c: f64| (into / along / c.acos().tan()).min(1.0).acos() / PI;
    let expected = mean_over(&wide, &outside);
    let turned = DVec3::new(into, along, 0.0);
    let less = transmittance(&integrator, 100.0, turned, &wide, 1);
    assert!((less - expected).abs() < 0.02, "{less} {expected}");
    assert!(expected < 0.4);
}

#[test]
fn a_slab_is_crossed_obliquely() {
    let grid = row(&[0.0, 80.0, 90.0, 200.0]);
    let view = row_view(&grid, &[false, true, false], 0.1, 1024);
    let integrator = Integrator::new(&grid, &view);
    let behind = |c: &Cone, axis, seed| transmittance(&integrator, 60.0, axis, c, seed);
    let [narrow, wide] = [20.0, 40.0].map(|degrees| cone(degrees, 100.0));
    let [expected, of_wide] =
        [&narrow, &wide].map(|c| mean_over(c, &|cosine| (-1.0 / cosine).exp()));
    assert!((behind(&narrow, DVec3::X, 1) - expected).abs() < 5e-4);
    assert!((behind(&wide, DVec3::X, 1) - of_wide).abs() < 5e-4);
    // Another opening, another axis and one path for all are not the same.
    assert!((of_wide - expected).abs() > 0.02);
    assert!((behind(&narrow, DVec3::NEG_X, 1) - expected).abs() > 0.5);
    let turned = DVec3::new(0.9, 0.19f64.sqrt(), 0.0);
    assert!((behind(&narrow, turned, 1) - expected).abs() > 0.02);
    assert!((expected - (-1.0f64).exp()).abs() > 5e-3);
}

#[test]
fn a_layer_thinner_than_a_step_is_met_as_often_as_it_should_be() {
    let grid = row(&[0.0, 80.0, 80.2, 200.0]);
    let view = row_view(&grid, &[false, true, false], 0.2, 1024);
    let integrator = Integrator::new(&grid, &view);
    let found = transmittance(&integrator, 60.0, DVec3::X, &cone(1.0, 100.0), 1);
    // A ray meets it in two of five cases, and then for half a unit. For thin ones that is the same.
    let met = 0.4 * (-0.2f64 * 0.5).exp() + 0.6;
    assert!((found - met).abs() < 3e-3, "{found} {met}");
    assert!((met - (-0.2f64 * 0.2).exp()).abs() < 2e-3);
    for other in [1.0, (-0.2f64 * 0.5).exp()] {
        assert!((found - other).abs() > 0.02);
    }
}

#[test]
fn what_is_cut_away_hides_nothing() {
    let grid = row(&[0.0, 100.0, 200.0]);
    let mut view = row_view(&grid, &[false, true], 50.0, 16);
    let wide = cone(20.0, 60.0);
    let seen = |view: &View| transmittance(&Integrator::new(&grid, view), 90.0, DVec3::X, &wide, 1);
    assert!(seen(&view) < 1e-3);
    view.shown.clip = vec![ClipPlane {
        point: 95.0 * DVec3::X,
        normal: DVec3::NEG_X,
        opaque: true,
    }];
    assert_eq!(seen(&view), 1.0);
}

#[test]
fn errors_fall_with_the_number_of_rays_and_even_out() {
    let grid = row(&[0.0, 100.0, 200.0]);
    let wide = cone(20.0, 30.0);
    // Mean and root mean square of the errors where the half is hidden.
    let errors = |rays| {
        let view = row_view(&grid, &[false, true], 50.0, rays);
        let integrator = Integrator::new(&grid, &view);
        let error = |seed| transmittance(&integrator, 100.0, DVec3::Y, &wide, seed) - 0.5;
        let errors: Vec<f64> = (0..200).map(error).collect();
        let mean = |f: &dyn Fn(f64) -> f64| errors.iter().map(|&e| f(e)).sum::<f64>() / 200.0;
        [mean(&|e| e), mean(&|e| e * e).sqrt()]
    };
    let [few, many] = [errors(8), errors(128)];
    for [mean, spread] in [few, many] {
        assert!(mean.abs() < 3.5 * spread / 200f64.sqrt(), "{mean} {spread}");
    }
    // Independent rays have 0.5 / sqrt(n).
    assert!(
        few[1] < 0.5 / 8f64.sqrt() && many[1] < 0.5 / 128f64.sqrt(),
        "{few:?} {many:?}"
    );
    assert!(many[1] < few[1] / 4.0 && many[1] > 0.0, "{few:?} {many:?}");
}

#[test]
fn occlusion_ends_at_the_eye() {
    let grid = row(&[0.0, 200.0]);
    let (extinction, step) = (0.05, 0.7);
    let mut view = view(&grid, constant(&grid), extinction, step);
    view.camera.eye = DVec3::new(170.0, 0.0, -100.0);
    let occlusion = OcclusionSpec {
        length: 20.0 / (3.0f64.sqrt() * 200.0),
        strength: 0.8,
        gap: 1.0,
        ..OcclusionSpec::default()
    };
    let spec = LightingSpec {
        occlusion: Some(occlusion),
        ambient: Some(0.9),
        rays: 2,
        ..LightingSpec::default()
    };
    light(&mut view, spec, DVec3::ONE);
    // Looking along x from 30 before the end of the medium: a sample at `t` has rays of `t`, 20 at most.
    let (mut expected, mut without_eye, mut transmittance) = (0.0, 0.0, 1.0);
    let alpha = 1.0 - (-extinction * step).exp();
    for t in (0..)
        .map(|n| (f64::from(n) + 0.5) * step)
        .take_while(|t| *t < 30.0)
    {
        let left = |path: f64| 0.9 * (0.2 + 0.8 * (-extinction * (path - 1.0).max(0.0)).exp());
        expected += transmittance * alpha * left(t.min(20.0));
        without_eye += transmittance * alpha * left(20.0);
        transmittance *= 1.0 - alpha;
    }
    let [_, _, blue, covered] = super::central_ray(&grid, &view);
    assert!((blue - expected).abs() < 1e-9, "{blue} {expected}");
    assert!((covered - (1.0 - transmittance)).abs() < 1e-12);
    assert!((blue - without_eye).abs() > 0.05);
}
