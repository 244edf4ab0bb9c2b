//! What is drawn fills the rectangle that title, facts and legend leave, and stands still over time.

use std::path::PathBuf;

use crate::common;
use glam::DVec2;
use strataray::case::{Case, load};
use strataray::picture::Shot;
use strataray::scene::{CameraSpec, Filter, PropertyFilter, Scene, StepSpec};
use strataray::view::{self, Sequence, Turn, View};

fn scene(size: [u32; 2]) -> Scene {
    Scene {
        size,
        ..Scene::default()
    }
}

/// Smallest and largest place in the picture of the box around what is drawn.
fn reach_of_box(view: &View) -> [DVec2; 2] {
    let start = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    view.world
        .subject
        .outline
        .iter()
        .fold(start, |[a, b], corner| {
            let at = view.camera.project(*corner, view.aspect()).unwrap();
            [a.min(at), b.max(at)]
        })
}

/// Smallest and largest place in the picture of the corners of the drawn cells.
fn reach(view: &View, case: &Case) -> [DVec2; 2] {
    let cells = case
        .grid
        .active_cells()
        .iter()
        .zip(&*view.shown.cells.drawn);
    let drawn = cells.filter(|(_, drawn)| **drawn);
    let corners = drawn.flat_map(|(cell, _)| {
        let ijk = case.grid.dims().ijk(*cell);
        case.grid.hexahedron(ijk).0
    });
    let start = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    corners.fold(start, |[a, b], corner| {
        let world = view.world.spaces.world_from_grid.transform_point3(corner);
        let at = view.camera.project(world, view.aspect()).unwrap();
        [a.min(at), b.max(at)]
    })
}

fn models() -> Vec<PathBuf> {
    let mut models = common::models();
    let others = [
        "spe1/SPE1CASE1.EGRID",
        "spe9/SPE9_CP.EGRID",
        "reported/F01_SLICE.EGRID",
        "reported/F02_CONST.EGRID",
    ];
    models.extend(others.iter().filter_map(|f| common::data(f)));
    models
}

#[test]
fn what_is_drawn_fills_its_rectangle_from_rim_to_rim() {
    for model in models() {
        let case = load::open(&model).unwrap();
        for size in [
            [1000, 750],
            [640, 480],
            [300, 200],
            [1600, 600],
            [600, 1200],
        ] {
            let mut scene = scene(size);
            for has_box in [false, true] {
                scene.show.r#box = has_box;
                let Shot { view, layout, .. } = Shot::of(&scene, &case, false).unwrap();
                assert_eq!(view.size, layout.volume_size());
                let name = format!("{} {size:?} {has_box}", model.display());
                let [low, high] = reach(&view, &case);
                let is_inside = low.min_element() > 0.039 && high.max_element() < 0.961;
                assert!(is_inside, "{name} {low} {high}");
                let across = (high - low).max_element();
                // Margins of 4 percent, in one direction at least; a box and its labels take some room.
                let [low, high] = reach_of_box(&view);
                match has_box {
                    false => assert!(across > 0.91, "{name} {across}"),
                    true => {
                        assert!(low.min_element() > 0.019 && high.max_element() < 0.981);
                        let across = across.max((high - low).max_element());
                        assert!(across > 0.85, "{name} {across}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_vertical_section_is_seen_from_the_side() {
    let Some(file) = common::data("reported/F01_SLICE.EGRID") else {
        return;
    };
    let case = load::open(&file).unwrap();
    let view = Shot::of(&scene([1000, 750]), &case, false).unwrap().view;
    // It lies in the plane of x and depth.
    assert!(
        view.camera.forward.y.abs() > 0.95,
        "{}",
        view.camera.forward
    );
    let [low, high] = reach(&view, &case);
    assert!((high - low).x > 0.85);
}

#[test]
fn a_scene_that_says_where_from_is_seen_from_there() {
    let case = load::open(&common::sample()).unwrap();
    let text = r#"{"azimuth_degrees": 20, "elevation_degrees": 50}"#;
    let mut scene = scene([800, 600]);
    scene.camera = serde_json::from_str::<CameraSpec>(text).unwrap();
    let forward = view::resolve(&scene, &case).unwrap().camera.forward;
    let azimuth = (-forward.x).atan2(-forward.y).to_degrees();
    assert!(
        (azimuth - 20.0).abs() < 1e-9 && ((-forward.z).asin().to_degrees() - 50.0).abs() < 1e-9
    );
    // One without a direction is chosen, and says so again when it is saved.
    for text in ["{}", r#"{"zoom": 2.0}"#, r#"{"projection": "parallel"}"#] {
        let spec = serde_json::from_str::<CameraSpec>(text).unwrap();
        assert!(matches!(spec, CameraSpec::Automatic(_)), "{text}");
        let again = serde_json::to_string(&spec).unwrap();
        assert_eq!(serde_json::from_str::<CameraSpec>(&again).unwrap(), spec);
    }
    assert!(serde_json::from_str::<CameraSpec>(r#"{"zoom": 2.0, "azimuth": 3}"#).is_err());
}

#[test]
fn a_filter_is_framed_but_not_what_changes_with_time() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = scene([800, 600]);
    scene.property = Some("SOIL".into());
    scene.show.r#box = false;
    let whole = view::resolve(&scene, &case).unwrap();
    scene.filter = Filter {
        i: Some([1, 5].into()),
        j: Some([1, 5].into()),
        ..Filter::default()
    };
    let corner = view::resolve(&scene, &case).unwrap();
    let [low, high] = reach(&corner, &case);
    assert!((high - low).max_element() > 0.91, "{low} {high}");
    assert!(corner.world.subject.points.len() < whole.world.subject.points.len() / 4);
    // Oil goes away with time, and the camera stands still.
    scene.filter = Filter {
        properties: vec![PropertyFilter {
            min: Some(0.5),
            max: Some(1.0),
            ..PropertyFilter::open("SOIL")
        }],
        ..Filter::default()
    };
    let cameras = [0, 10, 20].map(|step| {
        scene.step = StepSpec::Index(step);
        let view = view::resolve(&scene, &case).unwrap();
        (
            view.camera,
            view.shown.cells.drawn.iter().filter(|d| **d).count(),
        )
    });
    assert!(cameras.iter().all(|c| c.0 == whole.camera));
    assert!(cameras[0].1 != cameras[2].1);
}

#[test]
fn the_pictures_of_a_film_have_the_volume_at_one_place() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = scene([640, 480]);
    scene.property = Some("PRESSURE".into());
    let size = Shot::of(&scene, &case, false).unwrap().layout.volume_size();
    let steps = Sequence::over_steps(&scene, &case, &[0, 10, 20], &|_| true);
    let steps = steps.unwrap().unwrap().sized(size).unwrap();
    let turn = Turn {
        degrees: 360.0,
        views: 8,
    };
    let turn = Sequence::around(&scene, &case, turn)
        .unwrap()
        .sized(size)
        .unwrap();
    for sequence in [&steps, &turn] {
        let views: Vec<View> = (0..sequence.count())
            .map(|n| sequence.view(n, &case).unwrap())
            .collect();
        for view in &views {
            assert_eq!(view.size, size);
            let [low, high] = reach(view, &case);
            assert!(low.min_element() > 0.0 && high.max_element() < 1.0);
        }
    }
    let eye = |n| steps.view(n, &case).unwrap().camera.eye;
    assert_eq!(eye(0), eye(2));
    // A turn looks at one point all the way.
    let middle = turn.view(0, &case).unwrap().world.subject.middle;
    for n in 0..8 {
        let view = turn.view(n, &case).unwrap();
        let at = view.camera.project(middle, view.aspect()).unwrap();
        assert!(at.distance(DVec2::splat(0.5)) < 1e-9, "{at}");
    }
}
