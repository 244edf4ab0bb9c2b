//! Hull, fault sheets and edges of cells, by every strategy: against the reference and against formulas.

mod cells;
mod faint;
mod looks;
mod sheets;

use crate::common;
use crate::common::images::{all, picture};
use crate::common::shape::{Shape, boxes};
use glam::DVec3;
use strataray::case::{Case, load};
use strataray::image::metrics::{ciede2000_map, psnr_8bit};
use strataray::image::{Blending, Image};
use strataray::reference;
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::lighting::LightSpec;
use strataray::scene::{
    CameraSpec, ClipSpec, CutFace, FramingCamera, Hull, Inactive, Interpolation, LightMode,
    LightingSpec, Mode, OpacitySpec, Projection, RangeSpec, Scene, StrategyKind,
};
use strataray::view::surfaces::{
    EDGE_DARKNESS, EDGE_WIDTH, FAINT_BEHIND, FAINT_FRONT, HEADLIGHT_AMBIENT, HEADLIGHT_ASIDE,
    PALETTE, SHEET_OPACITY, UNNAMED, faint_color,
};
use strataray::view::{self, Surfaces, View};

const NONE: Surfaces = Surfaces {
    hull: Hull::Hidden,
    faults: false,
    wells: false,
    cell_edges: false,
    solid: false,
};
const HULL: Surfaces = Surfaces {
    hull: Hull::Opaque,
    ..NONE
};
const FAULTS: Surfaces = Surfaces {
    faults: true,
    ..NONE
};
const FAINT: Surfaces = Surfaces {
    hull: Hull::Faint,
    ..NONE
};
/// What the mode `cells` shows.
const CELLS: Surfaces = Surfaces {
    solid: true,
    cell_edges: true,
    ..HULL
};

fn camera(azimuth_degrees: f64, elevation_degrees: f64, zoom: f64) -> CameraSpec {
    CameraSpec::Framing(FramingCamera {
        azimuth_degrees,
        elevation_degrees,
        zoom,
        projection: Projection::Perspective,
    })
}

fn with(view: &View, surfaces: Surfaces) -> View {
    let mut changed = view.clone();
    changed.style.surfaces = surfaces;
    changed
}

/// PSNR in dB without the worst of a thousand pixels: at an outline a pixel may see another face, and one
/// pixel makes as much of it as all others.
fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    let mut pairs: Vec<_> = a.into_iter().zip(b).collect();
    let error = |(a, b): &([u8; 3], [u8; 3])| (0..3).map(|c| a[c].abs_diff(b[c])).max();
    pairs.sort_by_key(error);
    pairs.truncate(pairs.len() - pairs.len().div_ceil(1000));
    let (a, b): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

fn pixel(image: &Image, x: u32, y: u32) -> [f64; 4] {
    image.pixels[(x + image.size[0] * y) as usize].map(f64::from)
}

fn blended(view: &View, srgb: [f64; 3]) -> DVec3 {
    DVec3::from_array(view.style.blending.of_srgb(srgb))
}

/// A scene of test grids: nothing ends a ray early.
fn plain(camera: CameraSpec, opacity: f64) -> Scene {
    let mut scene = Scene {
        size: [80, 60],
        camera,
        property: Some("VALUE".into()),
        range: RangeSpec::Fixed([0.0, 1.0]),
        vertical_exaggeration: Some(1.0),
        sampling_step: Some(0.5),
        early_termination: 0.0,
        ..Scene::default()
    };
    scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, opacity], [1.0, opacity]]));
    scene.transfer.reference_length = Some(100.0);
    scene
}

/// A plane through the middle of the model, seen from the side that is cut away.
fn cut(view: &View, face: CutFace) -> ClipSpec {
    let [low, high] = view.world.bounds;
    let away = view.camera.forward.with_z(0.0) + DVec3::new(0.3, 0.1, 0.0);
    ClipSpec {
        point: (0.5 * (low + high)).to_array(),
        normal: away.to_array(),
        face,
    }
}

const BOTH: Surfaces = Surfaces {
    faults: true,
    ..HULL
};

const fn edges(on: Surfaces) -> Surfaces {
    Surfaces {
        cell_edges: true,
        ..on
    }
}
/// A box of one value, seen so that three of its faces show.
fn one_box() -> Case {
    boxes(&[0.0, 100.0], &[0.0, 90.0], &[1000.0, 1080.0], &|_| 0.5)
}

/// Axis of the face at which a ray enters a box.
fn entered([low, high]: [DVec3; 2], ray: &reference::Ray) -> usize {
    let [a, b] = [low, high].map(|plane| (plane - ray.origin) / ray.direction);
    let near = a.min(b).to_array();
    (0..3).max_by(|a, b| near[*a].total_cmp(&near[*b])).unwrap()
}

fn srgb(color: [f64; 3]) -> [u8; 3] {
    color.map(|v| (255.0 * v).round() as u8)
}
/// Two blocks of 100 x 100 x 100 side by side, the eastern one deeper by a throw.
fn blocks(throw: f64, keywords: &str) -> Case {
    Shape {
        dims: [2, 1, 1],
        depth: &|[i, ..], [_, _, dk]| 1000.0 + throw * i as f64 + 100.0 * dk as f64,
        keywords,
        ..Shape::default()
    }
    .case()
}

/// Part of its color that a pixel in row `y` keeps where lines run down the picture at the projections of
/// some points.
fn kept_by_lines(view: &View, points: &[DVec3], x: u32) -> f64 {
    let covered = points.iter().map(|point| {
        let at = view.camera.project(*point, view.aspect()).unwrap().x * f64::from(view.size[0]);
        (0.5 * EDGE_WIDTH + 0.5 - (at - f64::from(x) - 0.5).abs()).clamp(0.0, 1.0)
    });
    1.0 - EDGE_DARKNESS * covered.fold(0.0, f64::max)
}

#[test]
fn edges_are_as_wide_at_any_distance() {
    let Some(gpu) = common::gpu() else { return };
    let planes = [0.0, 100.0, 200.0, 300.0];
    let case = boxes(&planes, &planes, &[1000.0, 1020.0, 1040.0], &|_| 0.5);
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let section = ClipSpec {
        point: [0.0, 0.0, -1010.0],
        normal: [0.0, 0.0, -1.0],
        face: CutFace::Opaque,
    };
    for (zoom, clip, depth) in [
        (0.7, None, 1000.0),
        (0.4, None, 1000.0),
        (0.6, Some(section), 1010.0),
    ] {
        let is_section = clip.is_some();
        // Straight down: rows of pixels run along x.
        let mut scene = plain(camera(0.0, 90.0, zoom), 0.3);
        // So large that lines do not fade.
        scene.size = [160, 120];
        scene.clip.extend(clip);
        let view = view::resolve(&scene, &case).unwrap();
        let on = |cell_edges| Surfaces {
            cell_edges,
            ..if is_section { NONE } else { HULL }
        };
        let row = view
            .camera
            .project(DVec3::new(150.0, 150.0, -depth), view.aspect());
        let y = (row.unwrap().y * f64::from(view.size[1])) as u32;
        let lines = planes.map(|x| DVec3::new(x, 150.0, -depth));
        for by in all() {
            let [with_lines, without] = [true, false]
                .map(|edges| picture(&mut renderer, &case, &with(&view, on(edges)), by));
            let (mut dark, mut seen) = (0, 0);
            for x in 0..view.size[0] {
                let [base, found] = [&without, &with_lines].map(|i| pixel(i, x, y));
                if base[3] < 1.0 {
                    continue;
                }
                let expected = kept_by_lines(&view, &lines, x);
                let error = (found[1] - expected * base[1]).abs();
                assert!(
                    error < 2e-3 && found[3] == 1.0,
                    "{by:?} {zoom} {x}: {error}"
                );
                seen += 1;
                dark += u32::from(expected < 1.0 - 0.35 * EDGE_DARKNESS);
            }
            assert!(
                seen > 20 && (4..=12).contains(&dark),
                "{by:?} {zoom}: {dark} of {seen}"
            );
        }
    }
}

#[test]
fn what_is_not_shown_leaves_no_trace() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let scene = Scene {
        size: [16, 12],
        camera: camera(205.0, 35.0, 1.0),
        ..Scene::default()
    };
    let view = view::resolve(&scene, &case).unwrap();
    for strategy in StrategyKind::ALL {
        let [before, hull, faults, after] = [NONE, edges(HULL), FAULTS, NONE]
            .map(|shown| picture(&mut renderer, &case, &with(&view, shown), Some(strategy)));
        let difference = |image: &Image| {
            let pairs = image
                .pixels
                .iter()
                .flatten()
                .zip(before.pixels.iter().flatten());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        // Where a ray pauses depends on the time, and PLTS locates it anew then.
        let most = if strategy == StrategyKind::Plts {
            1e-4
        } else {
            0.0
        };
        assert!(difference(&after) <= most, "{}", difference(&after));
        assert!(difference(&hull) > 0.1 && difference(&faults) > 0.05);
    }
}

#[test]
fn scenes_say_what_is_shown() {
    let case = blocks(30.0, "");
    let resolved = |show: &str| {
        let scene: Scene = serde_json::from_str(&format!("{{\"show\": {show}}}")).ok()?;
        Some(view::resolve(&scene, &case).unwrap().style.surfaces)
    };
    let cells = |rest: &str| {
        let text = format!(
            "{{\"mode\": \"cells\", \"clip\": [{{\"point\": [50, 50, -1050], \"normal\": [1, 0, 0]}}]{rest}}}"
        );
        view::resolve(&serde_json::from_str(&text).unwrap(), &case).unwrap()
    };
    let view = cells("");
    assert_eq!(view.style.surfaces, CELLS);
    assert_eq!(view.shown.cells.interpolation, Interpolation::Cell);
    assert!(view.shown.clip[0].opaque);
    let without_edges = Surfaces {
        cell_edges: false,
        ..CELLS
    };
    let view = cells(r#", "show": {"cell_edges": false, "hull": "hidden"}"#);
    assert_eq!(view.style.surfaces, without_edges);
    assert!(serde_json::from_str::<Scene>(r#"{"mode": "solid"}"#).is_err());
    assert_eq!(resolved("{}"), Some(NONE));
    assert_eq!(resolved(r#"{"hull": "opaque"}"#), Some(HULL));
    assert_eq!(
        resolved(r#"{"hull": "hidden", "faults": true}"#),
        Some(FAULTS)
    );
    let all = r#"{"hull": "opaque", "faults": true, "cell_edges": true}"#;
    assert_eq!(resolved(all), Some(edges(BOTH)));
    assert_eq!(resolved(r#"{"hull": "faint"}"#), Some(FAINT));
    assert_eq!(resolved(r#"{"hull": "glass"}"#), None);
}
