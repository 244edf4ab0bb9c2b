//! Regular volumes as cases: places, values, pictures and notes, by files that this program writes.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common;
use crate::common::images::{all, picture};
use crate::common::shape::Shape;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use strataray::case::{Case, Kind, load};
use strataray::export::volume::{self, VolumeFormat};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::model::synthetic::VOLUMES;
use strataray::model::{Dims, Ijk, VertexField};
use strataray::picking;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::{Coloring, Interpolation, Mode, RangeSpec, Scene, StrategyKind};
use strataray::session::Session;
use strataray::view::{self, View, look};
use strataray_parsers::volume::{
    ByteOrder, Contents, Lattice, SampleType, SegyLayout, SegyWriter, metaimage, nrrd, vti,
};

/// Samples along the axes of the file.
const DIMS: [usize; 3] = [5, 4, 3];

/// A lattice along x, y and z, z upward.
fn upright() -> Lattice {
    Lattice::straight(DIMS, [1000.0, 2000.0, -40.0], [25.0, 12.5, 4.0])
}

/// Sheared and rotated, with inclined pillars and dipping layers.
fn sheared() -> Lattice {
    Lattice {
        dims: DIMS,
        origin: [431_000.0, 6_470_000.0, -2000.0],
        edges: [[20.0, -9.0, 1.0], [7.5, 21.0, -0.5], [1.0, 0.5, 4.0]],
    }
}

/// A value that no two samples share.
fn value([i, j, k]: [usize; 3]) -> f32 {
    (i + 10 * j + 100 * k) as f32 - 150.0
}

fn contents(lattice: Lattice, name: &str) -> Contents {
    Contents {
        lattice,
        sample: SampleType::F32,
        byte_order: ByteOrder::Little,
        name: name.into(),
    }
}

/// The samples of a lattice in natural order.
fn samples([ni, nj, nk]: [usize; 3], of: impl Fn([usize; 3]) -> f32) -> Vec<f64> {
    let places = (0..ni * nj * nk).map(|n| [n % ni, n / ni % nj, n / ni / nj]);
    places.map(|at| f64::from(of(at))).collect()
}

fn write_nrrd(path: &Path, lattice: Lattice, name: &str, of: impl Fn([usize; 3]) -> f32) {
    let file = std::fs::File::create(path).unwrap();
    let values = samples(lattice.dims, of);
    nrrd::write(file, &contents(lattice, name), false, values).unwrap();
}

/// The file in each format, of the values of [`value`]; a trace of SEG-Y begins at its upper end.
fn write_all(folder: &Path) -> [PathBuf; 4] {
    let paths = ["A.nrrd", "B.mha", "C.vti", "D.segy"].map(|name| folder.join(name));
    let create = |n: usize| std::fs::File::create(&paths[n]).unwrap();
    let contents = contents(upright(), "");
    let values = samples(DIMS, value);
    nrrd::write(create(0), &contents, true, values.clone()).unwrap();
    metaimage::write(create(1), &contents, false, values.clone()).unwrap();
    vti::write(create(2), &contents, values).unwrap();
    let layout = SegyLayout {
        sample: SampleType::Ibm32,
        byte_order: ByteOrder::Big,
        samples: DIMS[2],
        interval: 4.0,
        delay: 32,
        text: String::new(),
    };
    let mut writer = SegyWriter::new(create(3), layout).unwrap();
    for j in 0..DIMS[1] {
        for i in 0..DIMS[0] {
            let trace: Vec<f32> = (0..DIMS[2]).rev().map(|k| value([i, j, k])).collect();
            let place = [1000.0 + 25.0 * i as f64, 2000.0 + 12.5 * j as f64];
            let numbers = [100 + 2 * i as i32, 300 + j as i32];
            writer.trace(numbers[0], numbers[1], place, &trace).unwrap();
        }
    }
    writer.finish().unwrap();
    paths
}

fn subject(case: &Case) -> &str {
    case.about.subject.as_deref().unwrap()
}

/// The value of the volume in a cell.
fn value_of(case: &Case, [i, j, k]: [usize; 3]) -> Option<f32> {
    let field = case.field(subject(case), 0).unwrap();
    let cell = case.grid.dims().cell(Ijk { i, j, k });
    field.value(&case.grid, cell)
}

fn middle(case: &Case, [i, j, k]: [usize; 3]) -> DVec3 {
    case.grid.hexahedron(Ijk { i, j, k }).at(DVec3::ZERO)
}

fn cells() -> impl Iterator<Item = [usize; 3]> {
    let [ni, nj, nk] = DIMS;
    (0..ni * nj * nk).map(move |n| [n % ni, n / ni % nj, n / ni / nj])
}

/// A view of a case without light, of a scene with more keys.
fn seen(case: &Case, more: &Value) -> View {
    let mut written = json!({
        "size": [80, 60], "mode": "volume", "range": [-150.0, 100.0], "early_termination": 0.0,
        "vertical_exaggeration": 1.0,
    });
    let keys = written.as_object_mut().unwrap();
    keys.extend(more.as_object().unwrap().clone());
    let scene: Scene = serde_json::from_value(written).unwrap();
    let scene = Scene {
        property: Some(look::default_property(case)),
        ..scene
    };
    view::resolve(&scene, case).unwrap()
}

fn psnr(a: &Image, b: &Image) -> f64 {
    let [a, b] = [a, b].map(|image| image.over_background_8bit([0.0; 3]));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

fn notes(case: &Case) -> String {
    case.about.notes.join("\n")
}

#[test]
fn a_volume_opens_the_same_from_every_format() {
    let Some(gpu) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let cases = write_all(folder.path()).map(|path| load::open(&path).unwrap());
    let mut first: Option<Image> = None;
    for case in &cases {
        let name = &case.about.name;
        let property = case.property(subject(case)).unwrap();
        assert_eq!(property.kind, Kind::Static);
        // An array of VTK has a name, whoever writes it.
        let expected = match name.as_str() {
            "C" => "values",
            "D" => "AMPLITUDE",
            _ => "VALUE",
        };
        assert_eq!(property.name, expected);
        for at in cells() {
            let [i, j, k] = at;
            // Layer 1 is the uppermost: the last sample of a volume that goes upward.
            let sample = [i, j, DIMS[2] - 1 - k];
            assert_eq!(value_of(case, at), Some(value(sample)), "{name} {at:?}");
            let depth = 32.0 + 4.0 * k as f64;
            let place = DVec3::new(1000.0 + 25.0 * i as f64, 2000.0 + 12.5 * j as f64, depth);
            assert!(middle(case, at).distance(place) < 1e-6, "{name} {at:?}");
        }
        assert_ne!(value_of(case, [0, 0, 0]), Some(value([0, 0, 0])));
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let mut draw = |more: Value| {
            let view = seen(case, &more);
            picture(&mut renderer, case, &view, Some(StrategyKind::Plts))
        };
        let image = draw(json!({}));
        let first = first.get_or_insert_with(|| image.clone());
        let alike = psnr(&image, first);
        assert!(alike > 60.0, "{name}: {alike}");
        // The twin: in a narrower range of colors.
        let other = psnr(&draw(json!({"range": [-150.0, -100.0]})), first);
        assert!(other < 40.0, "{name}: {other}");
    }
    // What is time is no depth, and lines are told by their numbers.
    let seismic = notes(&cases[3]);
    assert_eq!(cases[3].about.time_unit.as_deref(), Some("ms"));
    assert!(seismic.contains("two-way time in ms"), "{seismic}");
    assert!(
        seismic.contains("I 1 is inline 100, the next one 2 further"),
        "{seismic}"
    );
    let upward = notes(&cases[0]);
    assert!(upward.contains("K is axis 3 from its end"), "{upward}");
    assert!(cases[0].about.time_unit.is_none() && !upward.contains("time"));
}

#[test]
fn samples_of_a_sheared_volume_are_found_at_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sheared.nrrd");
    write_nrrd(&path, sheared(), "vp", value);
    let session = Session::open(&path).unwrap();
    assert_eq!(subject(session.case()), "vp");
    let lattice = sheared();
    let place = |[i, j, k]: [usize; 3], off: f64| {
        let [x, y, z] = lattice.place([i as f64, j as f64, k as f64 + off]);
        [x, y, -z]
    };
    for (off, is_right) in [(0.0, true), (0.4, true), (0.7, false)] {
        let places: Vec<[f64; 3]> = cells().map(|at| place(at, off)).collect();
        let cell = Interpolation::Cell;
        let found = session.locate("vp", "first", cell, &places).unwrap();
        for (at, found) in cells().zip(found) {
            let [i, j, k] = at;
            let ijk = [i + 1, j + 1, DIMS[2] - k];
            let is_it = found.is_some_and(|f| f.cell == ijk && f.value == f64::from(value(at)));
            assert_eq!(is_it, is_right, "{at:?} {off}");
        }
    }
}

#[test]
fn axes_are_permuted_until_layers_go_down() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("turned.nrrd");
    // The first axis goes down, the second one south.
    let mut lattice = upright();
    lattice.edges = [[0.0, 0.0, -4.0], [0.0, -12.5, 0.0], [25.0, 0.0, 0.0]];
    write_nrrd(&path, lattice, "", value);
    let case = load::open(&path).unwrap();
    let Dims { ni, nj, nk } = case.grid.dims();
    assert_eq!([ni, nj, nk], [4, 3, 5]);
    for [a, b, c] in cells() {
        assert_eq!(value_of(&case, [b, c, a]), Some(value([a, b, c])));
        let [x, y, z] = lattice.place([a as f64, b as f64, c as f64]);
        assert!(middle(&case, [b, c, a]).distance(DVec3::new(x, y, -z)) < 1e-6);
    }
    let told = notes(&case);
    assert!(
        told.contains("I is axis 2, J is axis 3, K is axis 1;"),
        "{told}"
    );
}

/// The cells of a sheared volume as a deck: the same pictures by every strategy and by the reference.
#[test]
fn a_deck_of_the_same_cells_looks_the_same() {
    let Some(gpu) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sheared.nrrd");
    write_nrrd(&path, sheared(), "", value);
    let case = load::open(&path).unwrap();
    let lattice = sheared();
    let node = |i: usize, j: usize, k: usize| {
        // Of the upper face of layer k, from the top.
        let steps = [i as f64 - 0.5, j as f64 - 0.5, (DIMS[2] - k) as f64 - 0.5];
        let [x, y, z] = lattice.place(steps);
        [x, y, -z]
    };
    let deck = |factor: f32| {
        Shape {
            dims: DIMS,
            pillar: &|i, j| [node(i, j, 0), node(i, j, DIMS[2])],
            depth: &|[i, j, k], [di, dj, dk]| node(i + di, j + dj, k + dk)[2],
            value: &|[i, j, k]| f64::from(factor * value([i, j, DIMS[2] - 1 - k])),
            ..Shape::default()
        }
        .case()
    };
    let (same, twin) = (deck(1.0), deck(-1.0));
    let view = |case: &Case| {
        let scene: Scene = serde_json::from_value(json!({
            "size": [80, 60], "mode": "volume", "property": "VALUE", "range": [-150.0, 150.0],
            "camera": {"azimuth_degrees": 205.0, "elevation_degrees": 30.0, "zoom": 1.0},
            "vertical_exaggeration": 3.0, "early_termination": 0.0,
        }))
        .unwrap();
        view::resolve(&scene, case).unwrap()
    };
    for by in all() {
        let name = by.map_or("reference", StrategyKind::name);
        let [image, other, wrong] = [&case, &same, &twin].map(|case| {
            let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
            picture(&mut renderer, case, &view(case), by)
        });
        let (alike, unlike) = (psnr(&image, &other), psnr(&image, &wrong));
        println!("{name}: {alike:.1} dB, with other values {unlike:.1} dB");
        assert!(alike >= 60.0 && unlike < 40.0, "{name}: {alike} {unlike}");
    }
}

/// Straight down through a box of one value: all samples of the step lie inside, and the opacity is a formula.
#[test]
fn a_box_of_one_value_absorbs_by_beer_lambert() {
    let Some(gpu) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("even.nrrd");
    let lattice = Lattice::straight([6, 6, 8], [0.5, 0.5, 0.5], [1.0; 3]);
    write_nrrd(&path, lattice, "", |_| 0.5);
    let case = load::open(&path).unwrap();
    let view = seen(
        &case,
        &json!({
            "range": [0.0, 1.0], "sampling_step": 0.5,
            "transfer": {"opacity": [[0.0, 0.3], [1.0, 0.3]], "reference_length": 4.0},
            "camera": {
                "eye": [3.0, 3.0, 18.0], "target": [3.0, 3.0, 8.0], "up": [0.0, 1.0, 0.0],
                "fovy_degrees": 20.0, "projection": "parallel",
            },
        }),
    );
    let expected = |length: f64| 1.0 - 0.7_f64.powf(length / 4.0);
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    // A resampled grid is blurred at its sides.
    for by in all().filter(|by| *by != Some(StrategyKind::Srg)) {
        let image = picture(&mut renderer, &case, &view, by);
        let middle = f64::from(image.pixels[40 + 80 * 30][3]);
        let name = by.map_or("reference", StrategyKind::name);
        assert!((middle - expected(8.0)).abs() < 1e-5, "{name}: {middle}");
        assert!((middle - expected(7.5)).abs() > 1e-2, "{name}: {middle}");
    }
}

#[test]
fn absent_samples_are_cells_without_a_value() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("holes.nrrd");
    let absent = [2, 1, 1];
    write_nrrd(&path, upright(), "", |at| match at == absent {
        true => f32::NAN,
        false => value(at),
    });
    let case = load::open(&path).unwrap();
    assert_eq!(value_of(&case, absent), None);
    assert_eq!(value_of(&case, [2, 1, 0]), Some(value([2, 1, 2])));
    let field = case.field("VALUE", 0).unwrap();
    assert_eq!(field.statistics().unwrap().undefined, 1);
    // What is absent takes no part in the means at its corners.
    let means = VertexField::new(&case.grid, &field);
    let [i, j, k] = absent;
    let corners = means.corners(&case.grid, Ijk { i, j, k });
    assert!(corners.iter().all(|v| v.is_finite()), "{corners:?}");
    // Null of raw samples, which the file beside them names.
    let raw = folder.path().join("holes.raw");
    std::fs::write(&raw, [1, 2, 255, 4]).unwrap();
    let layout = r#"{
        "size": [2, 2, 1], "type": "u8", "null": 255, "name": "density", "unit": "g/cm3", "file": "holes.raw"
    }"#;
    std::fs::write(folder.path().join("holes.json"), layout).unwrap();
    for name in ["holes.raw", "holes.json"] {
        let case = load::open(&folder.path().join(name)).unwrap();
        assert_eq!(case.property("density").unwrap().unit, "g/cm3");
        let values = [0, 1, 2, 3].map(|n| value_of(&case, [n % 2, n / 2, 0]));
        assert_eq!(values, [Some(1.0), Some(2.0), None, Some(4.0)]);
    }
}

#[test]
fn volumes_on_one_lattice_open_together_and_others_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_nrrd(&at("near.nrrd"), upright(), "", value);
    write_nrrd(&at("far.nrrd"), upright(), "", |at| value(at) + 7.0);
    let case = load::open_with(&at("near.nrrd"), &[at("far.nrrd")]).unwrap();
    let difference = case.field("VALUE.far-VALUE@same", 0).unwrap();
    assert!(difference.values().iter().all(|v| *v == 7.0));
    let mut moved = upright();
    moved.origin[0] += 5.0;
    write_nrrd(&at("moved.nrrd"), moved, "", value);
    let mut larger = upright();
    larger.dims[0] += 1;
    write_nrrd(&at("larger.nrrd"), larger, "", value);
    for (name, says) in [
        ("moved.nrrd", "up to 5.000 away"),
        ("larger.nrrd", "6 x 4 x 3"),
    ] {
        let refused = load::open_with(&at("near.nrrd"), &[at(name)]).map(drop);
        let told = refused.unwrap_err().to_string();
        assert!(told.contains(says) && told.contains(name), "{told}");
    }
    // A volume is a case of its own beside a model, and no part of it.
    let told = load::open_with(&common::sample(), &[at("far.nrrd")]).map(drop);
    let told = told.unwrap_err().to_string();
    assert!(told.contains("open it by itself"), "{told}");
    assert!(load::is_case(&at("far.nrrd")));
}

#[test]
fn damaged_and_impossible_volumes_are_refused_with_words() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let refused = |path: &Path| {
        let told = load::open(path).map(drop).unwrap_err().to_string();
        assert!(told.contains(&*path.to_string_lossy()), "{told}");
        told
    };
    // Each edge that makes a volume none, and what is said.
    for (edges, says) in [
        (
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            "no axis",
        ),
        (
            [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
            "one plane",
        ),
        (
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1e-7]],
            "do not go down",
        ),
    ] {
        let path = at("edges.nrrd");
        write_nrrd(&path, Lattice { edges, ..upright() }, "", value);
        let told = refused(&path);
        assert!(told.contains(says), "{told}");
    }
    for path in write_all(folder.path()) {
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 40]).unwrap();
        // What is compressed is found to be cut off where it is read.
        let told = match load::open(&path) {
            Err(error) => error.to_string(),
            Ok(case) => case.field(subject(&case), 0).unwrap_err().to_string(),
        };
        assert!(told.contains(&*path.to_string_lossy()), "{told}");
        std::fs::write(&path, &whole).unwrap();
        let case = load::open(&path).unwrap();
        assert!(case.field(subject(&case), 0).is_ok());
    }
    std::fs::write(at("bare.raw"), [0; 8]).unwrap();
    let told = refused(&at("bare.raw"));
    assert!(told.contains("neither size nor type"), "{told}");
}

#[test]
fn a_pick_tells_the_sample_and_its_value() {
    let Some(gpu) = common::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picked.nrrd");
    write_nrrd(&path, upright(), "", value);
    let case = load::open(&path).unwrap();
    let view = seen(
        &case,
        &json!({
            "mode": "cells",
            "camera": {
                "eye": [1050.0, 2018.75, 500.0], "target": [1050.0, 2018.75, -40.0],
                "up": [0.0, 1.0, 0.0], "fovy_degrees": 9.0, "projection": "parallel",
            },
        }),
    );
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    // The uppermost layer from above; x to the right, and y upward.
    let width = 2.0 * 540.0 * 4.5_f64.to_radians().tan() * 80.0 / 60.0;
    for sample in [[1, 1, 2], [3, 2, 2], [0, 3, 2]] {
        let [x, y, _] = upright().place(sample.map(|n| n as f64));
        let at = DVec2::new((x - 1050.0) / width, -(y - 2018.75) / (0.75 * width)) + 0.5;
        let pick = picking::pick(&mut renderer, &case, &view, at).unwrap();
        let hit = pick.hit.unwrap();
        let [i, j, _] = sample;
        assert_eq!(hit.ijk, Ijk { i, j, k: 0 });
        assert_eq!(hit.value, f64::from(value(sample)));
        assert_ne!(hit.value, f64::from(value([i, j, 0])));
    }
}

#[test]
fn first_looks_follow_the_values() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let lattice = Lattice::straight([16, 16, 16], [0.0; 3], [1.0; 3]);
    let opened = |name: &str, content: &str, of: &dyn Fn([usize; 3]) -> f32| {
        write_nrrd(&at(name), lattice, content, of);
        let case = load::open(&at(name)).unwrap();
        look::opening(&case, &Value::Null).unwrap()
    };
    let wave = |[i, j, k]: [usize; 3]| (0.7 * k as f32 + 0.1 * (i + j) as f32).sin() - 0.25;
    let seismic = opened("a.nrrd", "amplitude", &wave);
    let RangeSpec::Fixed([low, high]) = seismic.range else {
        panic!("amplitudes have a fixed range");
    };
    assert!(low == -high && high > 1.0, "{low} {high}");
    assert_eq!(seismic.mode, Mode::Volume);
    // Without negative values there is nothing about zero.
    let envelope = opened("b.nrrd", "amplitude", &|at| wave(at).abs());
    assert_eq!(envelope.range, RangeSpec::STEP);
    // A mask keeps its values looked for; several whole numbers are regions.
    let mask = opened("c.nrrd", "", &|[i, ..]| f32::from(i > 7));
    assert_eq!(
        (mask.mode, mask.transfer.coloring),
        (Mode::Volume, Coloring::Continuous)
    );
    assert_eq!(
        (mask.interpolation, seismic.interpolation),
        (Interpolation::Cell, Interpolation::Vertex)
    );
    let labels = opened("d.nrrd", "", &|[i, ..]| (i / 4) as f32);
    assert_eq!(labels.transfer.coloring, Coloring::Categories);
}

#[test]
fn synthetic_volumes_are_written_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for (n, recipe) in VOLUMES.iter().enumerate() {
        let dims = Dims {
            ni: 9,
            nj: 8,
            nk: 7,
        };
        let made = recipe.build(dims, 1);
        for (format, ending) in VolumeFormat::ALL {
            let name = format!("V{n}");
            let target = [folder.path(), Path::new(&name)];
            let path = volume::write(&made, target, format, &|_| true).unwrap();
            assert_eq!(path.extension().unwrap(), ending);
            let case = load::open(&path).unwrap();
            let field = case.field(subject(&case), 0).unwrap();
            for (n, cell) in case.grid.active_cells().iter().enumerate() {
                let Ijk { i, j, k } = dims.ijk(*cell);
                let at = Ijk {
                    i,
                    j,
                    k: dims.nk - 1 - k,
                };
                assert_eq!(
                    field.values()[n],
                    made.value(at),
                    "{} {ending}",
                    recipe.name
                );
            }
            let canceled = volume::write(&made, target, format, &|_| false);
            assert!(canceled.is_err());
        }
    }
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_strataray"));
        let command = command.arg("sample").args(arguments).arg("-o");
        command.arg(folder.path()).output().unwrap()
    };
    let written = run(&["shells", "--dims", "6,5,4", "--format", "mha"]);
    assert!(written.status.success(), "{written:?}");
    let case = load::open(&folder.path().join("SHELLS.mha")).unwrap();
    assert_eq!(case.grid.active_cells().len(), 120);
    for wrong in [&["shells", "--steps", "3"][..], &["box", "--format", "mha"]] {
        let refused = run(wrong);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(
            !refused.status.success() && said.contains(wrong[1]),
            "{said}"
        );
    }
}
