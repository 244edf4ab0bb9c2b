//! Strategies side by side: rows, files and the turn of the camera.

use std::cell::Cell;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Mutex;

use crate::common;
use glam::DVec3;
use strataray::case::{Case, load};
use strataray::compare::{
    Compared, Comparer, Plan, Reference, Report, Row, Setting, Source, summary,
};
use strataray::image::metrics::Comparison;
use strataray::render::gpu::GpuExecutor;
use strataray::scene::{CameraSpec, ExplicitCamera, Projection, Scene, StrategyKind};
use strataray::view::{self, NamedView, TurnAxis, View, half_turns};

const SIZE: [u32; 2] = [96, 72];
const ACCURATE: Reference = Reference::Strategy(StrategyKind::accurate());

fn scene() -> Scene {
    Scene {
        size: SIZE,
        ..Scene::default()
    }
}

fn plan(case: &Case, reference: Reference, views: usize) -> Plan {
    let scene = scene();
    let view = view::resolve(&scene, case).unwrap();
    let views = half_turns(&scene, &view, TurnAxis::All, views);
    Plan::of_strategies(&StrategyKind::ALL, reference, views, 1)
}

/// All views of a plan, or `None` with a sentence where there is no adapter.
fn compare(case: &Case, plan: &Plan) -> Option<Vec<Compared>> {
    let mut comparer = Comparer::new(&GpuExecutor::from(common::gpu()?), &case.grid, plan).unwrap();
    let view = |n| comparer.view(n, &|_| true).unwrap();
    Some((0..plan.views.len()).map(view).collect())
}

fn names() -> Vec<&'static str> {
    StrategyKind::ALL.iter().map(|k| k.name()).collect()
}

#[test]
fn rows_of_every_strategy_against_the_cpu() {
    let case = load::open(&common::sample()).unwrap();
    let plan = plan(&case, Reference::Cpu, 2);
    let Some(views) = compare(&case, &plan) else {
        return;
    };
    for (n, compared) in views.iter().enumerate() {
        let rows: Vec<&Row> = compared.outcomes.iter().map(|o| &o.row).collect();
        assert_eq!(rows.iter().map(|r| r.strategy).collect::<Vec<_>>(), names());
        let reference = compared.truths[0].picture.as_ref().unwrap();
        for (outcome, row) in compared.outcomes.iter().zip(rows) {
            assert_eq!((row.view, row.reference.as_str()), (n, "cpu"));
            assert!(row.error.is_none() && !row.is_reference(), "{row:?}");
            assert!(row.frame_ms.unwrap() > 0.0 && row.prepare_ms.unwrap() > 0.0);
            // At least the 16 bytes of each of the picture's pixels.
            assert!(row.gpu_bytes.unwrap() > 16 * 96 * 72);
            assert_eq!(row.lost_rays, Some(0), "{}", row.strategy);
            let picture = outcome.picture.as_ref().unwrap();
            let again = Comparison::of(picture, reference).unwrap();
            assert_eq!(row.psnr_db, Some(again.psnr_db));
            assert_eq!(row.ciede2000_p99, Some(again.ciede2000_p99));
            let differences = outcome.differences.as_ref().unwrap();
            assert_eq!(
                row.ciede2000_mean,
                Some(strataray::image::metrics::mean(differences))
            );
        }
    }
}

#[test]
fn the_reference_is_perfect_and_another_view_is_not() {
    let case = load::open(&common::sample()).unwrap();
    let plan = plan(&case, ACCURATE, 2);
    let Some(views) = compare(&case, &plan) else {
        return;
    };
    for (compared, other) in views.iter().zip(views.iter().rev()) {
        let reference = compared.truths[0].picture.as_ref().unwrap();
        let perfect = compared.outcomes.iter().filter(|o| o.row.is_reference());
        assert_eq!(perfect.clone().count(), 1);
        for outcome in perfect {
            let row = &outcome.row;
            assert_eq!(row.psnr_db, Some(f64::INFINITY));
            let figures = [row.ssim, row.ciede2000_mean, row.ciede2000_p99];
            assert_eq!(figures, [Some(1.0), Some(0.0), Some(0.0)]);
            assert_eq!(outcome.picture.as_ref(), Some(reference));
            assert!(outcome.differences.is_none());
        }
        // The twin: what every strategy made of the other view.
        for outcome in &other.outcomes {
            let shifted = Comparison::of(outcome.picture.as_ref().unwrap(), reference).unwrap();
            for row in compared.outcomes.iter().map(|o| &o.row) {
                assert!(shifted.psnr_db < row.psnr_db.unwrap() - 3.0);
                assert!(shifted.ssim < row.ssim.unwrap());
                assert!(shifted.ciede2000_mean > row.ciede2000_mean.unwrap() + 0.2);
                assert!(shifted.ciede2000_p99 > row.ciede2000_p99.unwrap() + 1.0);
            }
        }
    }
}

#[test]
fn failing_strategies_are_rows_and_the_rest_goes_on() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    for reference in [Reference::Cpu, ACCURATE] {
        let mut plan = plan(&case, reference, 2);
        let limit = gpu.device.limits().max_texture_dimension_2d;
        for contender in &mut plan.contenders {
            contender.views[0].size = [limit + 1, 1];
        }
        if let Source::Cpu(views) = &mut plan.truths[0].source {
            views[0].size = [limit + 1, 1];
        }
        let views = compare(&case, &plan).unwrap();
        let is_cpu = reference == Reference::Cpu;
        assert_eq!(views[0].truths[0].picture.is_ok(), is_cpu);
        for (outcome, next) in views[0].outcomes.iter().zip(&views[1].outcomes) {
            let error = outcome.row.error.as_ref().unwrap();
            assert!(error.contains(&limit.to_string()), "{error}");
            assert!(outcome.picture.is_none() && outcome.row.frame_ms.is_none());
            assert!(outcome.row.psnr_db.is_none());
            assert!(next.row.error.is_none() && next.row.psnr_db.unwrap() > 20.0);
        }
        let rows: Vec<Row> = views.into_iter().flat_map(rows).collect();
        let text = summary(&rows);
        let failed = text.lines().filter(|l| l.ends_with("1 |")).count();
        assert_eq!(failed, names().len(), "{text}");
    }
}

fn rows(compared: Compared) -> Vec<Row> {
    compared.outcomes.into_iter().map(|o| o.row).collect()
}

#[test]
fn a_report_tells_of_failures_and_of_canceled_views() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let plan = plan(&case, ACCURATE, 3);
    let folder = tempfile::tempdir().unwrap();
    let begin = || {
        let setting = Setting {
            case: &case,
            plan: &plan,
            adapter: gpu.describe(),
            difference_scale: 2.5,
        };
        Report::begin(folder.path(), setting).unwrap()
    };
    let mut comparer = Comparer::new(&GpuExecutor::from(gpu.clone()), &case.grid, &plan).unwrap();
    let mut compared = comparer.view(0, &|_| true).unwrap();
    let sentence = "the driver | said no";
    for outcome in &mut compared.outcomes {
        if !outcome.row.is_reference() {
            (outcome.picture, outcome.differences) = (None, None);
            outcome.row.error = Some(sentence.into());
        }
    }
    let mut report = begin();
    report.add(compared).unwrap();
    let rows = report.finish().unwrap();
    assert_eq!(rows.len(), names().len());
    let page = std::fs::read_to_string(folder.path().join("compare.md")).unwrap();
    let told = page.matches("the driver \\| said no").count();
    assert_eq!(told, names().len() - 1, "{page}");
    assert!(
        page.contains("1 of 3") && page.contains("yellow 2.5"),
        "{page}"
    );
    assert!(links_lead_somewhere(folder.path()) > 0);
    // Nothing to tell of.
    assert!(begin().finish().is_err());
}

#[test]
fn progress_rises_and_cancels() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    for reference in [Reference::Cpu, ACCURATE] {
        let plan = plan(&case, reference, 1);
        let mut comparer =
            Comparer::new(&GpuExecutor::from(gpu.clone()), &case.grid, &plan).unwrap();
        let told = Mutex::new(Vec::new());
        let tell = |f| {
            told.lock().unwrap().push(f);
            true
        };
        assert!(comparer.view(0, &tell).is_some());
        let told = told.into_inner().unwrap();
        assert!((told.last().unwrap() - 1.0).abs() < 1e-9, "{told:?}");
        assert!(told.iter().all(|f| (0.0..=1.0 + 1e-9).contains(f)));
        assert!(told[0] < 0.5 && told.len() > 4, "{told:?}");
        for stop in [0.0, 0.3, 0.9] {
            assert!(comparer.view(0, &|f| f <= stop).is_none(), "{stop}");
        }
        assert!(comparer.view(1, &|_| true).is_none());
    }
}

fn middle(view: &View) -> DVec3 {
    view.world.corners.iter().sum::<DVec3>() / 8.0
}

/// True where all of the model is in the picture.
fn frames_all(named: &NamedView) -> bool {
    let inside = |point: &DVec3| {
        let at = named.view.camera.project(*point, 96.0 / 72.0);
        at.is_some_and(|at| at.min_element() > 0.0 && at.max_element() < 1.0)
    };
    named.view.world.subject.points.iter().all(inside)
}

#[test]
fn the_camera_turns_at_constant_distance() {
    let case = load::open(&common::sample()).unwrap();
    let mut scene = scene();
    let framing = view::resolve(&scene, &case).unwrap();
    let camera = framing.camera;
    let explicit = ExplicitCamera {
        eye: camera.eye.to_array(),
        // Beside the middle.
        target: (camera.eye + camera.forward + 0.05 * camera.right).to_array(),
        up: camera.up.to_array(),
        fovy_degrees: 30.0,
        projection: Projection::Perspective,
    };
    for spec in [scene.camera.clone(), CameraSpec::Explicit(explicit)] {
        scene.camera = spec;
        let start = view::resolve(&scene, &case).unwrap();
        let is_framing = scene.camera.framing_zoom().is_some();
        for about in [TurnAxis::X, TurnAxis::Y, TurnAxis::Z, TurnAxis::All] {
            let views = half_turns(&scene, &start, about, 9);
            let distance = |v: &NamedView| v.view.camera.eye.distance(middle(&v.view));
            let first = distance(&views[0]);
            assert!(
                views
                    .iter()
                    .all(|v| (distance(v) / first - 1.0).abs() < 1e-9)
            );
            // Framing cameras stand back for all; others stay where they are, whatever is seen.
            let all_framed = views.iter().all(frames_all);
            let tips_over = about != TurnAxis::Z;
            assert!(all_framed == is_framing || !tips_over, "{about:?}");
            let same = views[0].view.camera == start.camera;
            assert!(same || is_framing && first >= start.camera.eye.distance(middle(&start)));
            for named in &views {
                let c = &named.view.camera;
                assert!((c.right.cross(c.forward) - c.up).length() < 1e-9);
                // What is seen in the middle stays the same point.
                let aside = (middle(&start) - c.eye).normalize().dot(c.forward);
                let aside_first = (middle(&start) - views[0].view.camera.eye).normalize();
                let expected = aside_first.dot(views[0].view.camera.forward);
                assert!((aside - expected).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn half_turns_go_where_their_names_say() {
    let case = load::open(&common::sample()).unwrap();
    let scene = scene();
    let start = view::resolve(&scene, &case).unwrap();
    let towards_eye = |about, count| -> Vec<(String, DVec3)> {
        let views = half_turns(&scene, &start, about, count);
        let arm = |v: &View| (v.camera.eye - middle(v)).normalize();
        views
            .iter()
            .map(|v| (v.name.clone(), arm(&v.view)))
            .collect()
    };
    let [x, y, z] = towards_eye(TurnAxis::X, 1)[0].1.to_array();
    let expected = [
        ("x 0°", [x, y, z]),
        // The model's top turns to the south, as if the camera rose from the south to the north.
        ("x 90°", [x, z, -y]),
        ("x 180°", [x, -y, -z]),
        ("y 90°", [z, -y, x]),
        ("y 180°", [-x, -y, z]),
        ("z 90°", [-y, x, z]),
    ];
    let found = towards_eye(TurnAxis::All, 6);
    assert_eq!(found.len(), 6);
    for ((name, arm), (expected_name, expected)) in found.iter().zip(expected) {
        assert_eq!(name, expected_name);
        let expected = DVec3::from_array(expected);
        assert!(
            (*arm - expected).length() < 1e-9,
            "{name}: {arm} {expected}"
        );
    }
    // One axis ends on the other side.
    let ends = [
        (TurnAxis::X, [x, -y, -z]),
        (TurnAxis::Y, [-x, y, -z]),
        (TurnAxis::Z, [-x, -y, z]),
    ];
    for (about, expected) in ends {
        let found = towards_eye(about, 5);
        let (name, arm) = &found[4];
        assert!(name.ends_with(" 180°"), "{name}");
        assert!((*arm - DVec3::from_array(expected)).length() < 1e-9);
        assert!((found[3].1 - *arm).length() > 0.1);
    }
    assert_eq!(towards_eye(TurnAxis::All, 0).len(), 0);
}

fn run(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strataray"))
        .arg("compare")
        .arg(common::sample())
        .args(["--size", "96x72", "--frames", "1", "-o"])
        .arg(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn rows_of(folder: &Path) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(folder.join("compare.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn size_of(path: &Path) -> [u32; 2] {
    let picture = image::open(path).unwrap();
    [picture.width(), picture.height()]
}

/// Number of files that `compare.md` names, each of which is a picture that can be read.
fn links_lead_somewhere(folder: &Path) -> usize {
    let page = std::fs::read_to_string(folder.join("compare.md")).unwrap();
    let links = page
        .split("](")
        .skip(1)
        .map(|l| l.split(')').next().unwrap());
    let seen = Cell::new(0);
    for link in links {
        let [width, height] = size_of(&folder.join(link));
        assert!(width > 0 && height > 0);
        seen.set(seen.get() + 1);
    }
    seen.get()
}

#[test]
fn the_command_writes_rows_and_pictures() {
    if common::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("new/folder");
    let output = run(&["--views", "3"], &folder);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{:?}", output.stderr);
    let rows = rows_of(&folder);
    assert_eq!(rows.len(), 3 * names().len());
    let accurate = StrategyKind::accurate().name();
    for (n, row) in rows.iter().enumerate() {
        let (view, strategy) = (n / names().len(), names()[n % names().len()]);
        assert_eq!(row["view"], view);
        assert_eq!(row["strategy"], strategy);
        assert_eq!(row["reference"], accurate);
        assert!(row["error"].is_null());
        let is_reference = strategy == accurate;
        // JSON has no infinity: equal pictures have null.
        assert_eq!(row["psnr_db"].is_null(), is_reference, "{row}");
        assert_eq!(row["ssim"] == 1.0, is_reference, "{row}");
        let keys = [
            "ciede2000_mean",
            "ciede2000_p99",
            "frame_ms",
            "prepare_ms",
            "gpu_bytes",
            "recovered_rays",
            "lost_rays",
        ];
        assert!(keys.iter().all(|key| row[key].is_number()), "{row}");
        assert_eq!(
            size_of(&folder.join(row["picture"].as_str().unwrap())),
            SIZE
        );
        assert_eq!(row["difference"].is_null(), is_reference);
        if let Some(file) = row["difference"].as_str() {
            // With title and scale.
            assert!(size_of(&folder.join(file))[0] > SIZE[0]);
        }
        assert!(said.contains(strategy), "{said}");
    }
    // Sheet, four plots; picture, reference and difference of each row but the reference's own.
    let links = 5 + 3 * (3 * (names().len() - 1) + 1);
    assert_eq!(links_lead_somewhere(&folder), links);
    // Nothing else, and nothing half done.
    let files = std::fs::read_dir(&folder).unwrap().count();
    assert_eq!(files, 7 + 3 * (2 * names().len() - 1));
}

#[test]
fn a_reference_that_is_not_compared_is_a_picture_without_rows() {
    if common::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let accurate = StrategyKind::accurate().name();
    let other = names().into_iter().find(|n| *n != accurate).unwrap();
    let twice = format!("{other},{other}");
    for (arguments, reference) in [
        (vec!["--strategies", twice.as_str()], accurate),
        (vec!["--strategy", other, "--reference"], "cpu"),
    ] {
        assert!(run(&arguments, folder.path()).status.success());
        let rows = rows_of(folder.path());
        assert_eq!(rows.len(), 1);
        assert_eq!(
            (&rows[0]["strategy"], &rows[0]["reference"]),
            (&other.into(), &reference.into())
        );
        assert!(rows[0]["psnr_db"].as_f64().unwrap() > 20.0, "{}", rows[0]);
        let file = folder.path().join(format!("view_0_{reference}.png"));
        assert_eq!(size_of(&file), SIZE);
        links_lead_somewhere(folder.path());
    }
}

/// A scene of occlusion in small volumes, as a file in a folder.
fn lit_scene(folder: &Path) -> String {
    let path = folder.join("scene.json");
    let scene = serde_json::json!({
        "property": "PORO", "mode": "volume", "vertical_exaggeration": 8.0,
        "transfer": {"opacity": [[0, 0.0], [0.3, 0.1], [0.6, 0.3], [1, 0.9]]},
        "lighting": {"occlusion": {}, "volume": {"budget_mb": 1}, "rays": 8},
    });
    std::fs::write(&path, scene.to_string()).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn light_methods_are_measured_against_rays_of_their_own_side() {
    let folder = tempfile::tempdir().unwrap();
    let scene = lit_scene(folder.path());
    let arguments = [
        "--adapter",
        "cpu",
        "--scene",
        &scene,
        "--light",
        "cones,surround,off,vct,cones",
    ];
    let output = run(&arguments, folder.path());
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{:?}", output.stderr);
    let rows = rows_of(folder.path());
    let told: Vec<[&str; 2]> = rows
        .iter()
        .map(|row| ["setting", "reference"].map(|key| row[key].as_str().unwrap()))
        .collect();
    let around = "rays to all sides";
    let expected = [
        ["cones", "rays"],
        ["off", "rays"],
        ["vct", "rays"],
        ["rays again", "rays"],
        ["surround", around],
        ["off to all sides", around],
        ["rays to all sides again", around],
    ];
    assert_eq!(told, expected);
    let figure = |name: &str, key: &str| {
        let row = rows.iter().find(|row| row["setting"] == name).unwrap();
        row[key].as_f64().unwrap()
    };
    // Each method is nearer than no light at all, and two runs of rays are nearer than that.
    for [off, method, floor] in [
        ["off", "cones", "rays again"],
        ["off", "vct", "rays again"],
        ["off to all sides", "surround", "rays to all sides again"],
    ] {
        let [off_by, by, least] = [off, method, floor].map(|n| figure(n, "ciede2000_mean"));
        assert!(
            least > 0.0 && least < by && by < 0.9 * off_by,
            "{method}: {least} {by} {off_by}"
        );
        assert!(figure(off, "brighter") > 5.0);
        assert!(figure(method, "light_ms") > 0.0);
    }
    assert_eq!(said.matches("Noise floor").count(), 2, "{said}");
    let floors = rows.iter().filter(|row| row["is_floor"] == true).count();
    assert_eq!(floors, 2);
    assert!(links_lead_somewhere(folder.path()) > 0);
}

#[test]
fn rays_are_the_reference_itself_where_they_have_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let scene = lit_scene(folder.path());
    let arguments = ["--adapter", "cpu", "--scene", &scene, "--light", "vct,rays"];
    assert!(run(&arguments, folder.path()).status.success());
    let rows = rows_of(folder.path());
    let names: Vec<_> = rows.iter().map(|row| row["setting"].clone()).collect();
    assert_eq!(names, ["vct", "rays", "rays again"]);
    assert_eq!(rows[1]["ssim"], 1.0);
    assert!(rows[0]["ssim"].as_f64().unwrap() < 1.0);
    assert!(rows[1]["difference"].is_null() && rows[2]["difference"].is_string());
}

#[test]
fn values_of_a_key_are_measured_each_against_its_own_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = lit_scene(folder.path());
    let common = ["--adapter", "cpu", "--scene", &scene, "--sweep"];
    let swept = |sweep: &str| {
        let output = run(&[&common[..], &[sweep]].concat(), folder.path());
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.success(), said)
    };
    let (done, said) = swept("lighting.occlusion.attenuation=0,1,1,4");
    assert!(done, "{said}");
    let rows = rows_of(folder.path());
    let own: Vec<&serde_json::Value> = rows.iter().filter(|r| r["is_floor"] != true).collect();
    let names: Vec<_> = own.iter().map(|r| r["setting"].as_str().unwrap()).collect();
    assert_eq!(names, ["attenuation=0", "attenuation=1", "attenuation=4"]);
    let apart: Vec<f64> = own
        .iter()
        .map(|r| r["ciede2000_mean"].as_f64().unwrap())
        .collect();
    // Rays know no attenuation: cones without it darken nothing, and with four times as much far too much.
    assert!(apart[1] < apart[0] && apart[1] < apart[2], "{apart:?}");
    assert!(links_lead_somewhere(folder.path()) > 0);
    for (sweep, word) in [
        ("lighting.occlusion.angle=1", "lighting.occlusion.angle"),
        ("lighting.occlusion.splits=2", "splits"),
        ("lighting.rays=many", "lighting.rays=many"),
        ("property=NONE", "property=NONE"),
        ("sampling_step.x=1", "sampling_step.x"),
        ("rays", "lighting.rays=4,16,64"),
        ("lighting..rays=1", "a key is missing"),
        ("lighting.rays=1,,2", "a value is missing"),
    ] {
        let (done, said) = swept(sweep);
        assert!(!done && said.contains(word), "{sweep}: {said}");
        assert!(!said.contains("panicked"));
    }
}

#[test]
fn err_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let cases: [(&[&str], &Path, &str); 2] = [
        (
            &["--difference-scale", "0"],
            folder.path(),
            "--difference-scale",
        ),
        (&[], &file, "cannot write"),
    ];
    for (arguments, output, word) in cases {
        let output = run(arguments, output);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        let sentences: Vec<&str> = said.lines().filter(|l| !l.contains("note:")).collect();
        assert!(
            sentences.len() == 1 && sentences[0].contains(word),
            "{said}"
        );
        assert!(!said.contains("panicked"));
    }
    // What does not go together is refused before anything else.
    for arguments in [
        &["--turn", "x"][..],
        &["--strategies", "fastest"],
        &["--views", "0"],
        &["--frames", "0"],
        &["--strategy", "plts", "--strategies", "plts"],
        &["--light", "cones", "--strategies", "plts"],
        &["--light", "brightest"],
        &["--light", "cones", "--sweep", "lighting.rays=1"],
    ] {
        assert_eq!(run(arguments, folder.path()).status.code(), Some(2));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
