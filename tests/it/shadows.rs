//! Shadows of a bar on the floor below it lie where geometry says.

use crate::common;
use crate::common::light::{lighting, render, scene};
use crate::common::shape::boxes;
use glam::DVec3;
use serde_json::{Value, json};
use strataray::case::Case;
use strataray::image::Image;
use strataray::reference::Ray;
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::{Executor, Renderer};
use strataray::scene::{CameraSpec, ColorSpec, FramingCamera, Projection, StrategyKind};
use strataray::view::View;

/// The bar's corners and the floor's height, in world space.
const BAR: [DVec3; 2] = [
    DVec3::new(70.0, 105.0, -44.0),
    DVec3::new(170.0, 135.0, -20.0),
];
const FLOOR: f64 = -100.0;
/// Parts of the light that come from everywhere and from all lights together.
const AMBIENT: f64 = 0.25;
const DIRECT: f64 = 0.75;
/// How far the edge of a shadow is spread to either side: by 2.7 standard deviations of the finest level.
const EDGE: f64 = 8.0;

/// A bar in mid-air above a floor, both opaque and white, in a box of 240 x 240 x 120.
fn bar() -> Case {
    let x = [0.0, BAR[0].x, BAR[1].x, 240.0];
    let y = [0.0, BAR[0].y, BAR[1].y, 240.0];
    let depth = [0.0, -BAR[1].z, -BAR[0].z, -FLOOR, 120.0];
    let is_solid = |ijk: [usize; 3]| ijk == [1, 1, 1] || ijk[2] == 3;
    boxes(&x, &y, &depth, &|ijk| f64::from(u8::from(is_solid(ijk))))
}

/// The picture under lights.
fn picture(
    renderer: &mut dyn Renderer,
    case: &Case,
    lights: &[Light],
    mode: &str,
    strategy: StrategyKind,
) -> (View, Image) {
    let mut scene = scene(
        &[[0.0, 0.0], [0.4, 0.0], [0.5, 1.0], [1.0, 1.0]],
        3.0,
        lighting(json!({
            "lights": lights.iter().map(Light::spec).collect::<Vec<_>>(),
            "shadows": {"mode": mode, "gap": 5},
            "ambient": AMBIENT,
            "volume": {"size": [80, 80, 40], "light_size": [80, 80, 40]},
        })),
    );
    scene.size = [100, 80];
    scene.transfer.color = ColorSpec::Points(vec![(0.0, "#ffffff".into())]);
    scene.strategy = strategy;
    scene.sampling_step = Some(1.0);
    scene.camera = CameraSpec::Framing(FramingCamera {
        azimuth_degrees: 205.0,
        elevation_degrees: 50.0,
        zoom: 1.1,
        projection: Projection::Perspective,
    });
    let (view, frame) = render(renderer, case, &scene);
    (view, frame.image)
}

/// A light of a kind; the vector is where a directional one goes, or where another is.
#[derive(Clone, Copy)]
enum Light {
    Directional(DVec3),
    Point(DVec3),
    /// Straight down, within an angle.
    Spot(DVec3, f64),
}

impl Light {
    fn spec(&self) -> Value {
        match self {
            Self::Directional(d) => json!({"kind": "directional", "direction": d.to_array()}),
            Self::Point(p) => json!({"kind": "point", "position": p.to_array()}),
            Self::Spot(p, opening) => json!({
                "kind": "spot", "position": p.to_array(), "direction": [0, 0, -1],
                "opening_degrees": opening,
            }),
        }
    }

    /// The light turned by half around the middle.
    fn mirrored(self) -> Self {
        let middle = DVec3::new(240.0, 240.0, 0.0);
        let turn = |v: DVec3| DVec3::new(-v.x, -v.y, v.z);
        match self {
            Self::Directional(d) => Self::Directional(turn(d)),
            Self::Point(p) => Self::Point(middle + turn(p)),
            Self::Spot(p, opening) => Self::Spot(middle + turn(p), opening),
        }
    }

    /// True where its light comes to a point of the floor, false where not; `None` at edges.
    fn reaches(&self, at: DVec3) -> Option<bool> {
        let (toward, inside) = match *self {
            Self::Directional(d) => (-d, Some(true)),
            Self::Point(p) => (p - at, Some(true)),
            Self::Spot(p, opening) => {
                let angle = (p - at).angle_between(DVec3::Z).to_degrees();
                // The light fades over the outer tenth.
                let is_inside = angle < 0.87 * opening;
                (
                    p - at,
                    (is_inside || angle > 1.03 * opening).then_some(is_inside),
                )
            }
        };
        match [-EDGE, EDGE].map(|wider| passes(at, toward, wider)) {
            [_, true] => inside,
            [false, _] => Some(false),
            _ if inside == Some(false) => inside,
            _ => None,
        }
    }
}

/// True where a ray misses the bar made wider to all sides.
fn passes(origin: DVec3, direction: DVec3, wider: f64) -> bool {
    let [a, b] = [BAR[0] - wider, BAR[1] + wider].map(|corner| (corner - origin) / direction);
    a.min(b).max_element().max(0.0) > a.max(b).min_element()
}

/// The ray's point of the floor, unless the bar is before it.
fn floor_at(view: &View, x: u32, y: u32) -> Option<DVec3> {
    let ray = Ray::through_pixel(view, x, y);
    let at = ray.origin + (FLOOR - ray.origin.z) / ray.direction.z * ray.direction;
    let is_floor = at.min_element() > FLOOR - 1.0 && at.truncate().min_element() > 3.0;
    let is_seen = passes(at, -ray.direction, 4.0);
    (is_floor && at.truncate().max_element() < 237.0 && is_seen).then_some(at)
}

/// Pixels of the floor by the lights that reach it (bit n: light n), and how many are wrong: off by more than
/// a seventh of one light.
fn counted(view: &View, image: &Image, lights: &[Light]) -> ([u32; 4], u32) {
    let share = DIRECT / lights.len() as f64;
    let (mut counts, mut wrong) = ([0; 4], 0);
    for y in 0..view.size[1] {
        for x in 0..view.size[0] {
            let Some(at) = floor_at(view, x, y) else {
                continue;
            };
            let reach: Option<Vec<bool>> = lights.iter().map(|l| l.reaches(at)).collect();
            let Some(reach) = reach else { continue };
            let bits = reach.iter().enumerate().map(|(n, r)| usize::from(*r) << n);
            counts[bits.sum::<usize>()] += 1;
            let number = reach.iter().filter(|r| **r).count();
            let found = f64::from(image.pixels[(x + view.size[0] * y) as usize][1]);
            let expected = AMBIENT + share * number as f64;
            wrong += u32::from((found - expected).abs() > share / 7.0);
        }
    }
    (counts, wrong)
}

/// The picture under lights shows their shadows, found where and by what `ways` say; not those of the lights
/// turned around, and none where they are off. Gives the pixels by the lights that reach them.
fn check(name: &str, lights: &[Light], ways: &[(&str, StrategyKind)]) -> Option<[u32; 4]> {
    let gpu = GpuExecutor::from(common::gpu()?);
    let executors: [&dyn Executor; 2] = [&gpu, &CpuExecutor::default()];
    let mut counts = None;
    for executor in executors {
        counts = Some(check_on(executor, name, lights, ways));
    }
    counts
}

/// As [`check`], by an executor.
fn check_on(
    executor: &dyn Executor,
    name: &str,
    lights: &[Light],
    ways: &[(&str, StrategyKind)],
) -> [u32; 4] {
    let case = bar();
    let mut renderer = executor.renderer(&case.grid).unwrap();
    let mirrored: Vec<_> = lights.iter().map(|l| l.mirrored()).collect();
    let mut pixels = [0; 4];
    for &(mode, strategy) in ways {
        let (view, image) = picture(&mut *renderer, &case, lights, mode, strategy);
        let (counts, wrong) = counted(&view, &image, lights);
        let (_, twin) = counted(&view, &image, &mirrored);
        let strategy = strategy.name();
        let executor = executor.info().executor;
        println!(
            "{executor} {name} {mode} {strategy}: {wrong} of {counts:?} pixels wrong; mirrored {twin}"
        );
        assert!(wrong == 0 && twin > 200, "{name} {mode} {strategy}");
        pixels = counts;
    }
    let (view, image) = picture(&mut *renderer, &case, lights, "off", StrategyKind::Plts);
    let (_, wrong) = counted(&view, &image, lights);
    assert!(wrong > 40, "{name} without shadows: {wrong}");
    pixels
}

const BOTH: [(&str, StrategyKind); 2] = [
    ("image", StrategyKind::Plts),
    ("preilluminated", StrategyKind::Plts),
];

#[test]
fn a_directional_light_casts_a_shadow() {
    let light = Light::Directional(DVec3::new(0.45, -0.6, -1.0));
    let others = [StrategyKind::Libc, StrategyKind::Srg].map(|s| ("preilluminated", s));
    let counts = check("directional", &[light], &[BOTH, others].concat());
    assert!(counts.is_none_or(|[dark, lit, ..]| dark > 50 && lit > 1000));
}

#[test]
fn a_point_light_casts_a_shadow() {
    let light = Light::Point(DVec3::new(80.0, 170.0, 60.0));
    let counts = check("point", &[light], &BOTH);
    assert!(counts.is_none_or(|[dark, lit, ..]| dark > 150 && lit > 500));
}

#[test]
fn a_spot_lights_a_circle_but_for_the_shadow() {
    let light = Light::Spot(DVec3::new(100.0, 90.0, 150.0), 20.0);
    let counts = check("spot", &[light], &BOTH);
    assert!(counts.is_none_or(|[dark, lit, ..]| dark > 500 && lit > 300));
}

#[test]
fn two_lights_cast_two_shadows() {
    let lights = [
        Light::Directional(DVec3::new(0.5, -0.85, -1.0)),
        Light::Point(DVec3::new(190.0, 165.0, 80.0)),
    ];
    let counts = check("two", &lights, &BOTH);
    assert!(counts.is_none_or(|[_, first, second, both]| first.min(second) > 20 && both > 500));
}
