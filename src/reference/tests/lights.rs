//! Lights and shadows on what a ray meets.

use glam::DVec3;

use super::{Shape, central_ray, constant, directional, light, view};
use crate::model::Grid;
use crate::scene::lighting::{LightSpec, ShadowSpec};
use crate::scene::{LightMode, LightingSpec};
use crate::view::lighting::SPOT_EDGE;
use crate::view::surfaces::{HEADLIGHT_AMBIENT, HEADLIGHT_ASIDE};
use crate::view::{ClipPlane, View};

/// What the central ray meets in [`stage`].
const MET: DVec3 = DVec3::new(21.25, 30.0, -203.0);

/// Two opaque cells of 10 x 20: one that the central ray meets at x = 20, one aside at x = 0..10 and
/// y = 40..60, which hides the first from what lies toward (-1, 1).
fn stage(lights: Vec<LightSpec>) -> (Grid, View) {
    let grid = Shape {
        dims: [3, 3, 1],
        ..Shape::default()
    }
    .grid();
    let mut view = view(&grid, constant(&grid), 50.0, 2.5);
    view.shown.cells.drawn = (0..9).map(|n| n == 5 || n == 6).collect::<Vec<_>>().into();
    let spec = LightingSpec {
        lights,
        shadows: ShadowSpec {
            gap: 1.0,
            ..ShadowSpec::default()
        },
        ambient: Some(0.0),
        rays: 16,
        ..LightingSpec::default()
    };
    light(&mut view, spec, DVec3::splat(3.0));
    (grid, view)
}

/// How bright the lights make what the central ray meets.
fn brightness(lights: Vec<LightSpec>) -> f64 {
    let (grid, view) = stage(lights);
    central_ray(&grid, &view)[2]
}

fn point(position: DVec3) -> LightSpec {
    LightSpec::Point {
        position: position.to_array(),
        half_angle_degrees: 1.0,
        intensity: Some(1.0),
        color: "#ffffff".into(),
    }
}

fn spot(position: DVec3, direction: DVec3, opening_degrees: f64) -> LightSpec {
    LightSpec::Spot {
        position: position.to_array(),
        direction: direction.to_array(),
        opening_degrees,
        half_angle_degrees: 1.0,
        intensity: Some(1.0),
        color: "#ffffff".into(),
    }
}

fn is_lit(lights: Vec<LightSpec>) -> bool {
    let brightness = brightness(lights);
    let lit = (brightness - 1.0).abs() < 1e-9;
    assert!(lit || brightness < 1e-3, "{brightness}");
    lit
}

/// Toward the cell aside, and toward nothing.
fn sides() -> [DVec3; 2] {
    [1.0, -1.0].map(|y| DVec3::new(-1.0, y, 0.0).normalize())
}

#[test]
fn directional_lights_come_from_where_nothing_is_between() {
    assert!(is_lit(vec![directional([1.0, 1.0, 0.0])]));
    assert!(!is_lit(vec![directional([1.0, -1.0, 0.0])]));
    // From behind the cell itself.
    assert!(!is_lit(vec![directional([-1.0, 0.0, 0.0])]));
}

#[test]
fn point_lights_are_hidden_only_by_what_is_nearer() {
    let [hidden, free] = sides();
    assert!(!is_lit(vec![point(MET + 40.0 * hidden)]));
    assert!(is_lit(vec![point(MET + 12.0 * hidden)]));
    assert!(is_lit(vec![point(MET + 40.0 * free)]));
}

#[test]
fn spots_light_what_is_inside_their_opening() {
    let [hidden, free] = sides();
    let at = |side: DVec3| MET + 40.0 * side;
    assert!(is_lit(vec![spot(at(free), -free, 20.0)]));
    assert!(!is_lit(vec![spot(at(hidden), -hidden, 20.0)]));
    assert!(is_lit(vec![spot(MET + 12.0 * hidden, -hidden, 20.0)]));
    let turned = |degrees: f64| glam::DQuat::from_rotation_z(degrees.to_radians()) * -free;
    assert!(is_lit(vec![spot(at(free), turned(17.9), 20.0)]));
    assert!(!is_lit(vec![spot(at(free), turned(20.1), 20.0)]));
    assert!(!is_lit(vec![spot(at(free), free, 20.0)]));
    // At its edge, by the cosine.
    let cosine = |degrees: f64| degrees.to_radians().cos();
    let x = (cosine(19.3) - cosine(20.0)) / (cosine(20.0 * (1.0 - SPOT_EDGE)) - cosine(20.0));
    let edge = brightness(vec![spot(at(free), turned(19.3), 20.0)]);
    assert!((edge - x * x * (3.0 - 2.0 * x)).abs() < 1e-9, "{edge}");
}

#[test]
fn lights_add_up_in_their_colors_over_the_ambient_part() {
    let [_, free] = sides();
    let LightSpec::Point { position, .. } = point(MET + 40.0 * free) else {
        unreachable!()
    };
    let red = LightSpec::Point {
        position,
        half_angle_degrees: 1.0,
        intensity: Some(0.5),
        color: "#ff0000".into(),
    };
    let lights = vec![
        red,
        directional([1.0, 1.0, 0.0]),
        directional([1.0, -1.0, 0.0]),
    ];
    let (grid, mut view) = stage(lights);
    view.style.lighting.ambient = 0.3;
    let expect = |view: &View, [red, green, blue]: [f64; 3]| {
        let [r, g, b, _] = central_ray(&grid, view);
        let off = (r / 0.25 - red)
            .abs()
            .max((g / 0.5 - green).abs())
            .max((b - blue).abs());
        assert!(off < 1e-3, "{r} {g} {b}");
    };
    expect(&view, [1.8, 1.3, 1.3]);
    // Lights cast no shadows where these are off.
    view.style.lighting.shadows = LightMode::Off;
    expect(&view, [2.8, 2.3, 2.3]);
}

#[test]
fn opaque_sections_are_shaded_as_samples_are() {
    let plane = |x: f64| ClipPlane {
        point: x * DVec3::X,
        normal: DVec3::X,
        opaque: true,
    };
    // The section is turned to the viewer, beside whom the lamp is.
    let aside = HEADLIGHT_ASIDE.map(|v| v * v).iter().sum::<f64>();
    let lamp = HEADLIGHT_AMBIENT + (1.0 - HEADLIGHT_AMBIENT) / (1.0 + aside).sqrt();
    // The plane takes half of the cell away, and the one aside; from behind the other half is dark.
    for (direction, brightness) in [([1.0, -1.0, 0.0], 1.0), ([-1.0, 0.0, 0.0], 0.0)] {
        let (grid, mut view) = stage(vec![directional(direction)]);
        view.shown.clip = vec![plane(25.0)];
        let [red, green, blue, alpha] = central_ray(&grid, &view);
        assert_eq!(alpha, 1.0);
        for (channel, own) in [(red, 0.25), (green, 0.5), (blue, 1.0)] {
            assert!((channel - own * brightness * lamp).abs() < 1e-3);
        }
    }
}
