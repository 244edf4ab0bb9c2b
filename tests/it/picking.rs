//! What is picked is what is seen: against pictures, formulas and the command line.

use std::path::PathBuf;
use std::process::{Command, Output};

use crate::common;
use crate::common::shape::{Shape, boxes};
use glam::DVec2;
use serde_json::Value;
use strataray::case::{Case, Measure, load};
use strataray::image::Image;
use strataray::image::metrics::{ciede2000, lab};
use strataray::model::Ijk;
use strataray::model::topology::Face;
use strataray::picking::{self, Part, Pick};
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::{
    CameraSpec, ClipSpec, ColorSpec, CutFace, ExplicitCamera, Filter, Hull, Inactive,
    Interpolation, LightingSpec, OpacitySpec, Projection, RangeSpec, Scene, StrategyKind,
};
use strataray::view::{self, View, look};

/// Colors of the same kind are nearer to each other than this.
const ALIKE: f64 = 15.0;

/// The first picture of a case, without light: a shaded color is darker than its value's.
fn opening(case: &Case) -> Scene {
    // The faint hull is there for orientation, and adds gray to each color; wells have colors of their own.
    let without_hull = serde_json::json!({"show": {"hull": "hidden", "wells": false}});
    Scene {
        size: [480, 360],
        lighting: LightingSpec::default(),
        // Samples, as a pick takes them, instead of whole segments.
        strategy: StrategyKind::Plts,
        ..look::opening(case, &without_hull).unwrap()
    }
}

/// The color of a pixel in L*a*b*, as if what covers it were opaque.
fn seen_color(image: &Image, pixel: usize) -> [f64; 3] {
    let [r, g, b, a] = image.pixels[pixel];
    let mut opaque = image.clone();
    opaque.pixels = vec![[r / a, g / a, b / a, 1.0]];
    lab(opaque.over_background_8bit([0.0; 3])[0].map(|v| f64::from(v) / 255.0))
}

/// The color of a value in L*a*b*.
fn value_color(view: &View, value: f64) -> [f64; 3] {
    let transfer = &view.style.transfer;
    let shown = transfer.scale.shown(value, transfer.range[0]);
    lab(transfer.srgb(transfer.position(shown)))
}

/// The same color at one lightness: what light and the gray of the hull leave of it.
fn without_lightness([_, a, b]: [f64; 3]) -> [f64; 3] {
    [50.0, a, b]
}

/// The value of the first cell with which the ray has gathered an opacity of 0.1.
fn first_met(pick: &Pick) -> f64 {
    let mut gathered = 0.0;
    let mut cells = pick.cells.iter();
    let first = cells.find(|c| {
        gathered += c.contribution;
        gathered >= 0.1
    });
    first.map_or(f64::NAN, |c| c.value)
}

/// Places of covered pixels, drawn by lot.
fn covered(image: &Image, count: usize) -> Vec<(usize, DVec2)> {
    let [width, height] = image.size;
    let mut lot = fastrand::Rng::with_seed(7);
    let mut places = Vec::new();
    while places.len() < count {
        let (x, y) = (lot.u32(0..width), lot.u32(0..height));
        let pixel = (y * width + x) as usize;
        if image.pixels[pixel][3] >= 0.1 {
            places.push((pixel, middle([x, y], image.size)));
        }
    }
    places
}

fn models() -> Vec<PathBuf> {
    let real = [
        "reek/REEK.EGRID",
        "brugge/BRUGGE_0000.EGRID",
        "spe9/SPE9_CP.EGRID",
    ];
    let real = real.iter().filter_map(|file| common::data(file));
    [common::sample()].into_iter().chain(real).collect()
}

/// The middle of a pixel, 0 to 1.
fn middle([x, y]: [u32; 2], size: [u32; 2]) -> DVec2 {
    let part = |n: u32, count: u32| (f64::from(n) + 0.5) / f64::from(count);
    DVec2::new(part(x, size[0]), part(y, size[1]))
}

#[test]
fn what_is_picked_has_the_color_that_is_seen() {
    let Some(gpu) = common::gpu() else { return };
    const PLACES: usize = 200;
    let mut twin_fails = 0;
    for model in models() {
        let case = load::open(&model).unwrap();
        let view = view::resolve(&opening(&case), &case).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let frame = renderer.render(&view, &|_| true);
        let image = frame.unwrap().image;
        let (mut shown, mut own, mut first) = (0, 0, 0);
        for (pixel, at) in covered(&image, PLACES) {
            let pick = picking::pick(&mut renderer, &case, &view, at).unwrap();
            let hit = pick.hit.clone().unwrap();
            let color = seen_color(&image, pixel);
            let is_alike = |value: f64| ciede2000(value_color(&view, value), color) <= ALIKE;
            shown += usize::from(is_alike(hit.shown));
            own += usize::from(is_alike(hit.value));
            first += usize::from(is_alike(first_met(&pick)));
            // All contributions are the pixel's opacity, but for whole segments against samples.
            let sum: f64 = pick.cells.iter().map(|c| c.contribution).sum();
            let opacity = f64::from(image.pixels[pixel][3]);
            assert!((sum - opacity).abs() < 1e-2, "{sum} {opacity}");
            // A value of the file, and one between it and those around it.
            let field = case.field(&view.shown.property, view.shown.step).unwrap();
            let cell = case.grid.dims().cell(hit.ijk);
            assert_eq!(
                field.value(&case.grid, cell).map(f64::from),
                Some(hit.value)
            );
        }
        let name = &case.about.name;
        let all = PLACES;
        println!(
            "{name} {}: {shown} of {all}, by the cell's own value {own}; the first met {first}",
            view.shown.property
        );
        assert!(100 * shown >= 95 * all, "{name}: {shown} of {all}");
        // The twin: the first cell that is opaque enough. Where all is solid that is the one seen.
        twin_fails += usize::from(100 * first < 95 * all && first < own);
    }
    assert!(twin_fails > 0);
}

#[test]
fn a_click_on_the_first_picture_takes_the_value_that_is_seen() {
    let Some(gpu) = common::gpu() else { return };
    const PLACES: usize = 200;
    let mut twin_fails = 0;
    for model in models() {
        let case = load::open(&model).unwrap();
        // As it opens: the hull and occlusion make the color of the value lighter or darker.
        let scene = Scene {
            size: [480, 360],
            ..look::opening(&case, &serde_json::json!({"show": {"wells": false}})).unwrap()
        };
        let view = view::resolve(&scene, &case).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let frame = renderer.render(&view, &|_| true);
        let image = frame.unwrap().image;
        let (mut alike, mut first, mut whole) = (0, 0, 0);
        for (pixel, at) in covered(&image, PLACES) {
            let pick = picking::pick(&mut renderer, &case, &view, at).unwrap();
            let color = seen_color(&image, pixel);
            let is_alike = |value: f64| {
                let [a, b] = [value_color(&view, value), color].map(without_lightness);
                ciede2000(a, b) <= ALIKE
            };
            // Nothing is taken where only the hull is seen.
            let Some(hit) = &pick.hit else { continue };
            alike += usize::from(is_alike(hit.shown));
            first += usize::from(is_alike(first_met(&pick)));
            whole += usize::from(ciede2000(value_color(&view, hit.shown), color) <= ALIKE);
        }
        let name = &case.about.name;
        println!("{name}: {alike} of {PLACES}, with lightness {whole}; the first met {first}");
        assert!(100 * alike >= 95 * PLACES, "{name}: {alike}");
        twin_fails += usize::from(first + 5 < alike);
    }
    assert!(twin_fails > 0);
}

#[test]
fn stepping_along_the_line_of_sight_reaches_all_cells() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let view = view::resolve(&opening(&case), &case).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    for at in [DVec2::splat(0.5), DVec2::new(0.4, 0.55)] {
        let pick = picking::pick(&mut renderer, &case, &view, at).unwrap();
        let hit = pick.hit.as_ref().unwrap();
        let before: Vec<Ijk> = walk_of(&pick, hit.ijk, -1);
        let behind: Vec<Ijk> = walk_of(&pick, hit.ijk, 1);
        assert_eq!(pick.around(hit.ijk), Some([before.len(), behind.len()]));
        let all: Vec<Ijk> = before
            .into_iter()
            .rev()
            .chain([hit.ijk])
            .chain(behind)
            .collect();
        let cells: Vec<Ijk> = pick.cells.iter().map(|c| c.ijk).collect();
        assert_eq!(all, cells);
        assert!(cells.len() > 5, "{}", cells.len());
        let distinct: std::collections::HashSet<Ijk> = cells.iter().copied().collect();
        assert_eq!(distinct.len(), cells.len());
        assert!(pick.cells.is_sorted_by(|a, b| a.from <= b.from));
        assert!(pick.cells.iter().all(|c| c.from < c.to));
        // Somewhere else there is nothing to step to.
        assert_eq!(pick.beside(Ijk { i: 999, j: 0, k: 0 }, 1), None);
    }
}

fn walk_of(pick: &Pick, from: Ijk, by: isize) -> Vec<Ijk> {
    std::iter::successors(pick.beside(from, by), |c| pick.beside(*c, by)).collect()
}

/// Seen from the west, straight along x, the rays parallel; opacities refer to 100 m.
fn from_west(colors: &[(f64, &str)], opacity: &[[f64; 2]]) -> Scene {
    let mut scene = Scene {
        size: [40, 40],
        camera: CameraSpec::Explicit(ExplicitCamera {
            eye: [-500.0, 50.0, -1010.0],
            target: [0.0, 50.0, -1010.0],
            up: [0.0, 0.0, 1.0],
            fovy_degrees: 1.0,
            projection: Projection::Parallel,
        }),
        property: Some("VALUE".into()),
        range: RangeSpec::Fixed([0.0, 1.0]),
        vertical_exaggeration: Some(1.0),
        sampling_step: Some(0.5),
        interpolation: Interpolation::Cell,
        early_termination: 0.0,
        ..Scene::default()
    };
    let points = colors.iter().map(|(at, color)| (*at, (*color).to_owned()));
    scene.transfer.color = ColorSpec::Points(points.collect());
    scene.transfer.opacity = Some(OpacitySpec::Points(opacity.to_vec()));
    scene.transfer.reference_length = Some(100.0);
    scene
}

const BLUE_TO_RED: [(f64, &str); 2] = [(0.0, "#0000ff"), (1.0, "#ff0000")];

fn pick(case: &Case, scene: &Scene) -> Option<Pick> {
    let view = view::resolve(scene, case).unwrap();
    let mut renderer = GpuRenderer::new(common::gpu()?, &case.grid).unwrap();
    let picked = picking::pick(&mut renderer, case, &view, DVec2::splat(0.5));
    Some(picked.unwrap())
}

/// A blue box before a red one, each 100 m thick.
fn two_boxes() -> Case {
    boxes(
        &[0.0, 100.0, 200.0],
        &[0.0, 100.0],
        &[1000.0, 1020.0],
        &|[i, ..]| i as f64,
    )
}

fn near(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() < 5e-3
}

#[test]
fn of_two_boxes_the_one_is_picked_whose_color_is_seen() {
    let case = two_boxes();
    let at = |i: usize| Ijk { i, j: 0, k: 0 };
    for (opacities, taken) in [
        ([0.3, 0.9], 1),
        ([0.7, 0.9], 0),
        ([0.05, 0.2], 1),
        ([0.2, 0.05], 0),
    ] {
        let [first, second] = opacities;
        let scene = from_west(&BLUE_TO_RED, &[[0.0, first], [1.0, second]]);
        let Some(found) = pick(&case, &scene) else {
            return;
        };
        let [a, b] = [found.cells[0], found.cells[1]];
        assert_eq!(found.cells.len(), 2);
        assert_eq!([a.ijk, b.ijk], [at(0), at(1)]);
        assert_eq!([a.value, b.value], [0.0, 1.0]);
        assert!(near(a.contribution, first), "{a:?}");
        assert!(near(b.contribution, (1.0 - first) * second), "{b:?}");
        for (cell, [from, to]) in [(a, [500.0, 600.0]), (b, [600.0, 700.0])] {
            assert!(
                (cell.from - from).abs() <= 0.5 && (cell.to - to).abs() <= 0.5,
                "{cell:?}"
            );
        }
        let hit = found.hit.as_ref().unwrap();
        assert_eq!(
            (hit.ijk, hit.value, hit.shown),
            (at(taken), taken as f64, taken as f64)
        );
        assert_eq!(hit.part, Part::Inside);
        assert_eq!(found.around(hit.ijk), Some([taken, 1 - taken]));
        // Where the cell begins, for there most of it is seen.
        assert!(
            (hit.map.x - 100.0 * taken as f64).abs() < 1.0 && (hit.map.z - 1010.0).abs() < 1e-6
        );
    }
    // Nothing to see, though there are cells.
    let found = pick(&case, &from_west(&BLUE_TO_RED, &[[0.0, 0.0], [1.0, 0.0]])).unwrap();
    assert_eq!((found.hit, found.cells.len()), (None, 2));
}

#[test]
fn what_is_hidden_contributes_nothing() {
    let case = two_boxes();
    let mut scene = from_west(&BLUE_TO_RED, &[[0.0, 0.9], [1.0, 0.9]]);
    scene.early_termination = 0.2;
    let Some(found) = pick(&case, &scene) else {
        return;
    };
    assert_eq!(found.hit.as_ref().unwrap().ijk.i, 0);
    // The ray ends in the first cell; the second one can still be stepped to.
    assert_eq!(found.cells[1].contribution, 0.0);
    assert!(found.cells[0].contribution > 0.8 && found.cells[0].contribution < 0.82);
    // From a filter, only what is drawn.
    scene.filter = Filter {
        i: Some([2, 2].into()),
        ..Filter::default()
    };
    let found = pick(&case, &scene).unwrap();
    assert_eq!(found.cells.len(), 1);
    assert_eq!(found.hit.unwrap().ijk.i, 1);
}

#[test]
fn thin_layers_of_one_color_are_seen_through_a_faint_one() {
    // A faint blue box of 100 m before twenty red ones of 5 m, each of which contributes less than it.
    let x: Vec<f64> = [0.0]
        .into_iter()
        .chain((0..=20).map(|n| 100.0 + 5.0 * f64::from(n)))
        .collect();
    let value = |[i, ..]: [usize; 3]| if i == 0 { 0.0 } else { 0.9 + 0.001 * i as f64 };
    let case = boxes(&x, &[0.0, 100.0], &[1000.0, 1020.0], &value);
    let scene = from_west(&BLUE_TO_RED, &[[0.0, 0.08], [0.5, 0.6], [1.0, 0.6]]);
    let Some(found) = pick(&case, &scene) else {
        return;
    };
    let hit = found.hit.unwrap();
    let most = found
        .cells
        .iter()
        .map(|c| c.contribution)
        .fold(0.0, f64::max);
    assert_eq!(found.cells[0].contribution, most);
    assert!(hit.ijk.i > 0 && hit.value > 0.9, "{hit:?}");
}

#[test]
fn clip_planes_cut_the_ray_or_end_it() {
    let case = two_boxes();
    let mut scene = from_west(&BLUE_TO_RED, &[[0.0, 0.9], [1.0, 0.9]]);
    for (face, x) in [
        (CutFace::Open, 50.0),
        (CutFace::Opaque, 50.0),
        (CutFace::Opaque, 150.0),
    ] {
        scene.clip = vec![ClipSpec {
            point: [x, 0.0, 0.0],
            normal: [1.0, 0.0, 0.0],
            face,
        }];
        let Some(found) = pick(&case, &scene) else {
            return;
        };
        let hit = found.hit.unwrap();
        let first = found.cells[0];
        let number = (x / 100.0) as usize;
        assert_eq!((hit.ijk.i, first.ijk.i), (number, number));
        assert!((first.from - 500.0 - x).abs() <= 0.5, "{first:?}");
        match face {
            CutFace::Opaque => {
                assert_eq!(hit.part, Part::Section);
                assert_eq!(hit.contribution, 1.0);
                assert!((hit.map.x - x).abs() < 1e-6);
                assert!(found.cells[1..].iter().all(|c| c.contribution == 0.0));
            }
            CutFace::Open => {
                assert_eq!(hit.part, Part::Inside);
                assert!(near(first.contribution, 1.0 - 0.1f64.sqrt()), "{first:?}");
            }
        }
    }
}

#[test]
fn opaque_faces_are_picked_before_all_that_is_behind_them() {
    let case = two_boxes();
    // However faint the first box is inside.
    let mut scene = from_west(&BLUE_TO_RED, &[[0.0, 0.01], [1.0, 0.9]]);
    scene.show.hull = Hull::Opaque;
    let Some(found) = pick(&case, &scene) else {
        return;
    };
    let hit = found.hit.as_ref().unwrap();
    assert_eq!((hit.ijk.i, hit.contribution), (0, 1.0));
    assert_eq!(hit.part, Part::Face(Face::IMinus));
    assert!(hit.map.x.abs() < 1e-6);
    assert_eq!(found.around(hit.ijk), Some([0, 1]));
    scene.show.hull = Hull::Hidden;
    assert_eq!(pick(&case, &scene).unwrap().hit.unwrap().ijk.i, 1);
    // Opened by a plane, one looks at the inside of the hull through the cells.
    scene.show.hull = Hull::Opaque;
    scene.clip = vec![ClipSpec {
        point: [50.0, 0.0, 0.0],
        normal: [1.0, 0.0, 0.0],
        face: CutFace::Open,
    }];
    let found = pick(&case, &scene).unwrap();
    assert_eq!(found.hit.unwrap().ijk.i, 1);
    let sum: f64 = found.cells.iter().map(|c| c.contribution).sum();
    assert!(near(sum, 1.0), "{sum}");
}

/// A fault between the two columns: the second one lies 8 m deeper.
fn faulted() -> Case {
    Shape {
        dims: [2, 1, 1],
        depth: &|[i, ..], [_, _, dk]| 1000.0 + 20.0 * dk as f64 + 8.0 * i as f64,
        value: &|[i, ..]| i as f64,
        keywords: "FAULTS\n 'NORTH' 1 1 1 1 1 1 'X' /\n/\n",
        ..Shape::default()
    }
    .case()
}

#[test]
fn a_fault_is_picked_where_it_is_what_is_seen() {
    let case = faulted();
    let scene = |opacity: f64| {
        let mut scene = from_west(&BLUE_TO_RED, &[[0.0, opacity], [1.0, opacity]]);
        scene.show.faults = true.into();
        scene
    };
    let Some(found) = pick(&case, &scene(0.05)) else {
        return;
    };
    // Half of what comes through the first cell.
    let hit = found.hit.as_ref().unwrap();
    assert!(near(hit.contribution, 0.95 * 0.5), "{hit:?}");
    let Part::Fault(fault) = &hit.part else {
        panic!("{hit:?}")
    };
    assert_eq!(found.fault.as_ref(), Some(fault));
    assert_eq!(fault.name.as_deref(), Some("NORTH"));
    assert_eq!((fault.near.i, fault.far.i), (0, 1));
    assert!(near(fault.throw, 8.0), "{fault:?}");
    assert_eq!(
        fault.in_words(&Measure::of_file("m")),
        "Fault NORTH, throw 8.0 m: far side deeper"
    );
    assert!(
        near(found.cells[1].contribution, 0.95 * 0.5 * 0.05),
        "{:?}",
        found.cells
    );
    // From the other side the far one is the shallower one.
    let mut other = scene(0.05);
    if let CameraSpec::Explicit(camera) = &mut other.camera {
        camera.eye[0] = 700.0;
    }
    let fault = pick(&case, &other).unwrap().fault.unwrap();
    assert_eq!((fault.near.i, fault.far.i), (1, 0));
    assert_eq!(
        fault.in_words(&Measure::of_file("m")),
        "Fault NORTH, throw 8.0 m: far side shallower"
    );
    // Before a dense cell it is not seen, and behind half of one it is, though the cell is what is picked.
    let hidden = pick(&case, &scene(0.99)).unwrap();
    assert_eq!(
        (hidden.hit.unwrap().part, hidden.fault),
        (Part::Inside, None)
    );
    let half = pick(&case, &scene(0.5)).unwrap();
    assert_eq!(half.hit.unwrap().part, Part::Inside);
    assert!(half.fault.is_some());
    // Nor where no faults are shown.
    let mut without = scene(0.05);
    without.show.faults = false.into();
    assert_eq!(pick(&case, &without).unwrap().fault, None);
}

#[test]
fn one_renderer_answers_for_every_view() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let plain = opening(&case);
    let mut scenes = vec![plain.clone()];
    for (hull, faults) in [
        (Hull::Opaque, false),
        (Hull::Opaque, true),
        (Hull::Hidden, true),
    ] {
        let mut scene = plain.clone();
        (scene.show.hull, scene.show.faults) = (hull, faults.into());
        scenes.push(scene.clone());
        scene.filter.i = Some([8, 30].into());
        scenes.push(scene.clone());
        scene.show.inactive = Inactive::Ghost;
        scenes.push(scene);
    }
    let mut kept = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
    let mut parts = Vec::new();
    for scene in scenes.iter().chain(scenes.iter().rev()) {
        let view = view::resolve(scene, &case).unwrap();
        let mut fresh = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        for at in [
            DVec2::new(0.5, 0.5),
            DVec2::new(0.4, 0.52),
            DVec2::new(0.6, 0.45),
        ] {
            let fresh = picking::pick(&mut fresh, &case, &view, at).unwrap();
            let again = picking::pick(&mut kept, &case, &view, at).unwrap();
            assert_eq!(fresh, again);
            parts.extend(fresh.hit.map(|h| std::mem::discriminant(&h.part)));
        }
    }
    parts.dedup();
    assert!(parts.len() > 2);
}

fn run(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .args(["pick", "--quiet"])
        .arg(common::sample())
        .args(arguments)
        .output();
    output.unwrap()
}

#[test]
fn the_command_gives_the_same_answer() {
    let Some(gpu) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    let case = load::open(&common::sample()).unwrap();
    let scene = opening(&case);
    std::fs::write(&file, serde_json::to_string(&scene).unwrap()).unwrap();
    let view = view::resolve(&scene, &case).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let at = middle([230, 190], view.size);
    let pick = picking::pick(&mut renderer, &case, &view, at).unwrap();
    let hit = pick.hit.as_ref().unwrap();
    let scene = file.to_str().unwrap();
    let output = run(&["--scene", scene, "--at", "230,190", "--json", "--plain"]);
    assert!(output.status.success(), "{output:?}");
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let [before, behind] = pick.around(hit.ijk).unwrap();
    assert_eq!(told["pixel"], serde_json::json!([230, 190]));
    assert_eq!(told["property"], "SOIL");
    assert_eq!(told["step"], view.shown.step);
    assert_eq!(told["unit"], "");
    assert_eq!([&told["before"], &told["behind"]], [before, behind]);
    let [i, j, k] = hit.ijk.one_based();
    let taken = &told["hit"];
    for (name, number) in [("i", i), ("j", j), ("k", k)] {
        assert_eq!(taken[name], number);
    }
    assert_eq!(
        (&taken["grid"], &taken["part"]),
        (&"".into(), &"inside".into())
    );
    assert!(taken["fault"].is_null());
    for (name, value) in [
        ("value", hit.value),
        ("shown", hit.shown),
        ("contribution", hit.contribution),
    ] {
        assert!(
            (taken[name].as_f64().unwrap() - value).abs() < 1e-6,
            "{name} {taken}"
        );
    }
    assert_eq!(taken["map"].as_array().unwrap().len(), 3);
    let ray = told["ray"].as_array().unwrap();
    assert_eq!(ray.len(), pick.cells.len());
    for (told, cell) in ray.iter().zip(&pick.cells) {
        let mut names: Vec<&String> = told.as_object().unwrap().keys().collect();
        names.sort();
        assert_eq!(
            names,
            ["contribution", "from", "grid", "i", "j", "k", "to", "value"]
        );
        assert_eq!(told["k"], cell.ijk.k + 1);
    }
    let text = run(&["--scene", scene, "--at", "230,190", "--plain"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(
        text.starts_with(&format!("I {i}  J {j}  K {k}   SOIL ")),
        "{text}"
    );
    assert!(
        text.contains(&format!("{before} in front, {behind} behind")),
        "{text}"
    );
    assert_eq!(text.lines().filter(|l| l.starts_with('>')).count(), 1);
    // Where there is only background.
    let nothing = run(&["--scene", scene, "--at", "0,0", "--json", "--plain"]);
    let nothing: Value = serde_json::from_slice(&nothing.stdout).unwrap();
    assert!(nothing["hit"].is_null() && nothing["ray"] == serde_json::json!([]));
}

#[test]
fn pixels_that_are_none_are_refused_in_one_sentence() {
    for (at, says) in [
        ("480,10", "X goes from 0 to 479 and Y from 0 to 359"),
        ("10,360", "480 x 360 pixels"),
        ("-1,10", "X goes from 0"),
        ("10", "X,Y"),
        ("1.5,2", "whole numbers"),
        ("a,b", "X,Y"),
        ("1,2,3", "X,Y"),
    ] {
        let output = run(&["--size", "480x360", "--at", at]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{at}: {said}");
        assert!(
            said.contains(says) && said.trim().lines().count() == 1,
            "{at}: {said}"
        );
    }
}
