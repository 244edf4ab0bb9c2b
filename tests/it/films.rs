//! Films of the bundled sample: the right views, one range, and the right files.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::{Arc, Mutex};

use crate::common;
use glam::DVec3;
use strataray::case::{Case, CaseError, Source, load};
use strataray::image::metrics::psnr_8bit;
use strataray::picture::{Annotations, Layout, finished};
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::{
    CameraSpec, ExplicitCamera, FramingCamera, Projection, RangeSpec, Scene, StepSpec,
};
use strataray::view::step::steps;
use strataray::view::{Sequence, Turn, View, resolve};

fn scene(property: &str) -> Scene {
    Scene {
        size: [200, 150],
        property: Some(property.into()),
        ..Scene::default()
    }
}

fn over_steps(scene: &Scene, case: &Case, chosen: &[usize]) -> Sequence {
    let sequence = Sequence::over_steps(scene, case, chosen, &|_| true);
    sequence.unwrap().unwrap()
}

fn strataray(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strataray"))
        .arg(arguments[0])
        .arg(common::sample())
        .args(&arguments[1..])
        .output()
        .unwrap()
}

/// What the program says when it refuses.
fn refusal(arguments: &[&str]) -> String {
    let output = strataray(arguments);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// Two renderings of the same; where a ray pauses may change a last digit.
fn same(a: &[u8], b: &[u8]) -> bool {
    psnr_8bit(a, b) > 60.0
}

#[test]
fn all_steps_have_one_range_and_a_given_one_wins() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = scene("PRESSURE");
    let chosen = [0, 10, 20];
    let sequence = over_steps(&scene, &case, &chosen);
    let own = chosen.map(|step| {
        let field = case.field("PRESSURE", step).unwrap();
        field.statistics().unwrap()
    });
    let min = own.iter().fold(f64::INFINITY, |m, s| m.min(s.min));
    let max = own.iter().fold(f64::NEG_INFINITY, |m, s| m.max(s.max));
    assert_eq!(sequence.range(), [min, max]);
    // No step alone has this range.
    assert!(own.iter().all(|s| [s.min, s.max] != [min, max]));
    for (n, step) in chosen.into_iter().enumerate() {
        let view = sequence.view(n, &case).unwrap();
        assert_eq!(
            (view.shown.step, view.style.transfer.range),
            (step, [min, max])
        );
    }
    scene.range = RangeSpec::Fixed([1.0, 2.0]);
    let sequence = over_steps(&scene, &case, &chosen);
    assert_eq!(
        sequence.view(1, &case).unwrap().style.transfer.range,
        [1.0, 2.0]
    );
}

#[test]
fn pictures_are_those_of_render_with_the_range_of_all_steps() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let mut picture = |view: &View| {
        let frame = renderer.render(view, &|_| true).unwrap();
        let layout = Layout::of_picture(&case, view, true);
        let picture = finished(&frame.image, &case, view, &layout);
        picture.pixels.into_flattened()
    };
    let scene = scene("PRESSURE");
    let sequence = over_steps(&scene, &case, &[5, 20]);
    let film: Vec<_> = (0..2)
        .map(|n| picture(&sequence.view(n, &case).unwrap()))
        .collect();
    assert!(!same(&film[0], &film[1]));
    for (n, step) in [(0, 5), (1, 20)] {
        let mut still = scene.clone();
        still.step = StepSpec::Index(step);
        let own_range = picture(&resolve(&still, &case).unwrap());
        still.range = RangeSpec::Fixed(sequence.range());
        let same_range = picture(&resolve(&still, &case).unwrap());
        assert!(same(&same_range, &film[n]), "step {step}");
        assert!(!same(&own_range, &film[n]), "step {step}");
    }
}

#[test]
fn step_and_date_stand_in_every_picture() {
    let case = load::open(&common::sample()).unwrap();
    for property in ["SWAT", "SOIL", "PRESSURE-PRESSURE@0"] {
        let sequence = over_steps(&scene(property), &case, &[0, 7]);
        for (n, words) in [
            (0, ["report 0", "2005-01-01"]),
            (1, ["report 7", "2012-01-01"]),
        ] {
            let view = sequence.view(n, &case).unwrap();
            let annotations = Annotations::of(&case, &view);
            let facts = annotations.info.unwrap().whole();
            for text in [&annotations.when, &facts] {
                assert!(words.iter().all(|w| text.contains(w)), "{property}: {text}");
                assert!(!text.contains("step"), "{text}");
            }
        }
    }
    let still = resolve(&scene("PORO"), &case).unwrap();
    let annotations = Annotations::of(&case, &still);
    assert_eq!(annotations.when, "");
    assert!(!annotations.info.unwrap().whole().contains("report"));
}

#[test]
fn steps_are_chosen_by_number_date_and_name() {
    let case = load::open(&common::sample()).unwrap();
    let all: Vec<usize> = (0..21).collect();
    assert_eq!(steps(&case, None, 1).unwrap(), all);
    assert_eq!(steps(&case, Some("first..last"), 1).unwrap(), all);
    let by_date = steps(&case, Some("2010-01-01..9"), 2).unwrap();
    assert_eq!(by_date, [5, 7, 9]);
    for (wrong, word) in [
        ("5", "0..10"),
        ("5..2", "after"),
        ("0..99", "no step 99"),
        ("..", "no step"),
    ] {
        let error = steps(&case, Some(wrong), 1).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
}

/// Notes which steps are read, and has no values at one of them.
struct Watched {
    source: Arc<dyn Source>,
    missing: usize,
    read: Arc<Mutex<BTreeSet<usize>>>,
}

impl Source for Watched {
    fn values(&self, name: &str, step: usize) -> Result<Option<Vec<f32>>, CaseError> {
        // Static ones, by which values are weighted, have one step alone.
        if name == "SWAT" {
            self.read.lock().unwrap().insert(step);
        }
        match step == self.missing {
            true => Ok(None),
            false => self.source.values(name, step),
        }
    }
}

#[test]
fn only_chosen_steps_are_read_and_those_without_values_are_left_out() {
    let mut case = load::open(&common::sample()).unwrap();
    let read = Arc::default();
    case.source = Arc::new(Watched {
        source: case.source,
        missing: 4,
        read: Arc::clone(&read),
    });
    let sequence = over_steps(&scene("SWAT"), &case, &[3, 4, 5]);
    let shown: Vec<_> = (0..sequence.count())
        .map(|n| sequence.view(n, &case).unwrap().shown.step)
        .collect();
    assert_eq!(shown, [3, 5]);
    assert!(sequence.left_out()[0].contains("step 4") && sequence.left_out().len() == 1);
    assert_eq!(*read.lock().unwrap(), BTreeSet::from([3, 4, 5]));
    let none = Sequence::over_steps(&scene("SWAT"), &case, &[4], &|_| true);
    assert!(none.unwrap_err().to_string().contains("at step 4"));
    let canceled = Sequence::over_steps(&scene("SWAT"), &case, &[3, 5], &|f| f < 0.4);
    assert!(canceled.unwrap().is_none());
}

/// True where all of the model is in the picture.
fn all_is_inside(view: &View) -> bool {
    let mut points = view.world.subject.points.iter();
    points.all(|&point| {
        let at = view.camera.project(point, view.aspect()).unwrap();
        at.min_element() >= 0.0 && at.max_element() <= 1.0
    })
}

fn turn(degrees: f64, views: usize) -> Turn {
    Turn { degrees, views }
}

#[test]
fn a_turn_keeps_its_distance_and_the_model_in_the_picture() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = scene("SOIL");
    let middle = |view: &View| view.world.corners.iter().sum::<DVec3>() / 8.0;
    let from = |azimuth_degrees: f64| {
        CameraSpec::Framing(FramingCamera {
            azimuth_degrees,
            elevation_degrees: 20.0,
            zoom: 1.0,
            projection: Projection::Perspective,
        })
    };
    // The narrow side of the model, so that the first view stands near.
    let nearest = (0..12).map(|n| from(30.0 * f64::from(n))).min_by(|a, b| {
        let distance = |camera: &CameraSpec| {
            scene.camera = camera.clone();
            let view = resolve(&scene, &case).unwrap();
            view.camera.eye.distance(middle(&view))
        };
        let [a, b] = [a, b].map(distance);
        a.total_cmp(&b)
    });
    scene.camera = nearest.unwrap();
    let sequence = Sequence::around(&scene, &case, turn(360.0, 24)).unwrap();
    let still = resolve(&scene, &case).unwrap();
    let middle = middle(&still);
    let views: Vec<_> = (0..sequence.count())
        .map(|n| sequence.view(n, &case).unwrap())
        .collect();
    let distance = |view: &View| view.camera.eye.distance(middle);
    for view in &views {
        assert!(all_is_inside(view));
        assert!((distance(view) - distance(&views[0])).abs() < 1e-6 * distance(view));
    }
    // Nearer by a fifth the model would not stay in the picture.
    let near = |view: &View| {
        let mut near = view.clone();
        near.camera.eye += near.camera.forward * 0.2 * distance(view);
        near
    };
    assert!(all_is_inside(&still));
    assert!(views.iter().any(|view| !all_is_inside(&near(view))));
}

#[test]
fn a_turn_begins_at_the_scenes_camera_and_goes_around_the_middle() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = scene("SOIL");
    let framed = resolve(&scene, &case).unwrap();
    let middle = framed.world.corners.iter().sum::<DVec3>() / 8.0;
    // Looks past the middle, from the south.
    let eye = middle + DVec3::new(100.0, -9000.0, 4000.0);
    scene.camera = CameraSpec::Explicit(ExplicitCamera {
        eye: eye.to_array(),
        target: (middle + DVec3::new(50.0, 20.0, 0.0)).to_array(),
        up: [0.0, 0.0, 1.0],
        fovy_degrees: 30.0,
        projection: Projection::Perspective,
    });
    let still = resolve(&scene, &case).unwrap();
    let quarter = Sequence::around(&scene, &case, turn(90.0, 4)).unwrap();
    let [first, last] = [0, 3].map(|n| quarter.view(n, &case).unwrap().camera);
    assert_eq!(first, still.camera);
    // A quarter on from the south, as azimuths count, is the west.
    let arm = last.eye - middle;
    assert!((arm - DVec3::new(-9000.0, -100.0, 4000.0)).length() < 1e-6);
    let forward = DVec3::new(
        still.camera.forward.y,
        -still.camera.forward.x,
        still.camera.forward.z,
    );
    assert!((last.forward - forward).length() < 1e-9);
    // A full turn ends one view before its beginning; the other way around it is seen backward.
    let full = Sequence::around(&scene, &case, turn(360.0, 4)).unwrap();
    let back = Sequence::around(&scene, &case, turn(-360.0, 4)).unwrap();
    let eye = |s: &Sequence, n| s.view(n, &case).unwrap().camera.eye;
    assert!((eye(&full, 1) - last.eye).length() < 1e-6);
    assert!((eye(&full, 3) - eye(&back, 1)).length() < 1e-6);
    assert!((eye(&full, 3) - eye(&full, 1)).length() > 1e3);
    assert!(Sequence::around(&scene, &case, turn(f64::NAN, 4)).is_err());
    assert!(Sequence::around(&scene, &case, turn(90.0, 0)).is_err());
}

#[test]
fn the_command_writes_films_and_folders_of_the_same_pictures() {
    if common::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let scene = path("scene.json");
    let json = r#"{"size": [200, 150], "property": "SOIL", "range": [0.0, 0.85]}"#;
    std::fs::write(&scene, json).unwrap();
    let [film, frames, still] = ["film.png", "frames/", "still.png"].map(path);
    let chosen = ["--steps", "2015-01-01..last", "--every", "5"];
    for output in [&film, &frames] {
        let options = [
            "animate", "--scene", &scene, "--over", "steps", "-o", output,
        ];
        let done = strataray(&[&options[..], &chosen].concat());
        assert!(done.status.success(), "{done:?}");
    }
    let done = strataray(&["render", "--scene", &scene, "--step", "10", "-o", &still]);
    assert!(done.status.success(), "{done:?}");
    let pixels = |path: &str| image::open(path).unwrap().into_rgb8().into_raw();
    let number = |n: u32| pixels(&format!("{frames}frame_000{n}.png"));
    // The first picture of an animated PNG is what other programs show of it.
    assert!(same(&pixels(&film), &pixels(&still)));
    assert!(same(&number(0), &pixels(&still)));
    assert!(!same(&number(1), &number(0)) && !same(&number(2), &number(1)));
    assert_eq!(std::fs::read_dir(&frames).unwrap().count(), 3);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
}

#[test]
fn err_what_cannot_become_a_film_is_said_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("film.png");
    let film = film.to_str().unwrap();
    for (options, words) in [
        (vec!["steps", "--property", "PORO"], vec!["PORO", "static"]),
        (
            vec!["steps", "--property", "NONE"],
            vec!["no property NONE"],
        ),
        (vec!["steps", "--degrees", "90"], vec!["--degrees", "orbit"]),
        (vec!["orbit", "--every", "2"], vec!["--every", "steps"]),
        (vec!["steps", "--step", "2"], vec!["--steps A..B"]),
        (vec!["steps", "--steps", "9..2"], vec!["9..2"]),
        (vec!["orbit", "--fps", "0"], vec!["--fps", "0.2"]),
        (vec!["orbit", "--degrees", "nan"], vec!["finite"]),
    ] {
        let said = refusal(&[&["animate", "-o", film, "--over"], &options[..]].concat());
        assert!(words.iter().all(|w| said.contains(w)), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    let said = refusal(&["animate", "--over", "orbit", "-o", "film.avi"]);
    assert!(said.contains(".gif") && said.contains("DIR/"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Names that end in `.part` in a folder.
fn drafts(folder: &Path) -> usize {
    let names = std::fs::read_dir(folder).unwrap();
    let names = names.map(|e| e.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.ends_with(".part")).count()
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing() {
    use std::time::{Duration, Instant};
    if common::gpu().is_none() {
        return;
    }
    for output in ["film.png", "film.gif", "film/"] {
        let folder = tempfile::tempdir().unwrap();
        let mut film = Command::new(env!("CARGO_BIN_EXE_strataray"))
            .args(["animate", "--quiet", "--over", "orbit", "--frames", "5000"])
            .arg("-o")
            .arg(folder.path().join(output))
            .arg(common::sample())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while drafts(folder.path()) == 0 {
            assert!(start.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(20));
        }
        // Into the rendering, which begins after the device is opened.
        std::thread::sleep(Duration::from_secs(3));
        assert!(film.try_wait().unwrap().is_none());
        let id = film.id().to_string();
        let kill = Command::new("sh")
            .args(["-c", &format!("kill -INT {id}")])
            .status();
        assert!(kill.unwrap().success());
        let done = film.wait_with_output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(1), "{said}");
        assert!(said.contains("canceled"), "{said}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
