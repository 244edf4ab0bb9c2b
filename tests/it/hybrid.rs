//! A regular volume beside the model: images of all executors and strategies against the reference.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};

use crate::common;
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::picking;
use strataray::reference;
use strataray::render::cpu::CpuExecutor;
use strataray::render::{Executor, FrameStats, Renderer};
use strataray::scene::StrategyKind;
use strataray::view::{self, ShownCube, View};
use strataray_parsers::volume::{ByteOrder, Contents, Lattice, SampleType, nrrd};

fn opened(case: &Case, written: &Value) -> View {
    let scene = view::look::opening(case, written).unwrap();
    view::resolve(&scene, case).unwrap()
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

fn sample() -> Case {
    load::open(&common::sample()).unwrap()
}

/// A lattice around the case's model: `out` of its extents beyond it to all sides, turned and sheared where it is askew.
fn around(case: &Case, dims: [usize; 3], out: f64, is_askew: bool) -> Lattice {
    let view = opened(case, &json!({}));
    let to_map = |p: DVec3| view.world.spaces.map_from_world(p);
    let [low, high] = view.world.bounds.map(to_map);
    let (low, high) = (low.min(high), low.max(high));
    let extent = (1.0 + 2.0 * out) * (high - low);
    let center = 0.5 * (low + high);
    let (mut edges, turn) = (
        DMat3::from_diagonal(extent),
        if is_askew { 0.4 } else { 0.0 },
    );
    edges = DMat3::from_rotation_z(turn) * edges;
    if is_askew {
        edges.x_axis += 0.2 * edges.y_axis;
        edges.z_axis.x += 0.1 * extent.x;
    }
    let steps = DVec3::from_array(dims.map(|n| 1.0 / n as f64));
    let edges = edges * DMat3::from_diagonal(steps);
    let middle = DVec3::from_array(dims.map(|n| 0.5 * (n as f64 - 1.0)));
    // NRRD has elevation.
    let up = DVec3::new(1.0, 1.0, -1.0);
    let [i, j, k] = [edges.x_axis, edges.y_axis, edges.z_axis].map(|e| (up * e).to_array());
    Lattice {
        dims,
        origin: (up * (center - edges * middle)).to_array(),
        edges: [i, j, k],
    }
}

/// Writes a volume of a field over the parts (0 to 1) of the lattice.
fn write(path: &Path, lattice: Lattice, field: impl Fn(DVec3) -> f64) {
    let [ni, nj, nk] = lattice.dims;
    let part = |n: usize, of: usize| (n as f64 + 0.5) / of as f64;
    let values = (0..nk).flat_map(|k| (0..nj).flat_map(move |j| (0..ni).map(move |i| [i, j, k])));
    let values = values.map(|[i, j, k]| field(DVec3::new(part(i, ni), part(j, nj), part(k, nk))));
    let contents = Contents {
        lattice,
        sample: SampleType::F32,
        byte_order: ByteOrder::Little,
        name: "AMPLITUDE".into(),
    };
    let file = std::fs::File::create(path).unwrap();
    nrrd::write(file, &contents, false, values).unwrap();
}

/// Layers that dip and break, as in seismic, with a hole in them.
fn layers(at: DVec3) -> f64 {
    if at.distance(DVec3::new(0.3, 0.3, 0.4)) < 0.12 {
        return f64::NAN;
    }
    let throw = if at.x + 0.3 * at.y > 0.7 { 0.11 } else { 0.0 };
    (20.0 * (at.z + 0.15 * at.x - throw)).sin() * (0.6 + 0.4 * at.y)
}

/// A scene with a volume, `more` laid over it.
fn beside(file: &Path, more: &Value) -> Value {
    let mut written = json!({
        "size": [80, 60], "mode": "volume", "lighting": {}, "show": {"hull": "hidden"},
        "volumes": [{"file": file}],
    });
    let keys = written.as_object_mut().unwrap();
    keys.extend(more.as_object().unwrap().clone());
    written
}

fn render(renderer: &mut dyn Renderer, view: &View) -> (Image, FrameStats) {
    let frame = renderer.render(view, &|_| true).unwrap();
    let stats = frame.stats;
    assert_eq!((stats.lost_rays, stats.lost_samples), (0, 0), "{stats:?}");
    (frame.image, stats)
}

/// The view with its cube changed.
fn with_cube(view: &View, change: impl Fn(&mut ShownCube)) -> View {
    let mut shown = ShownCube::clone(view.shown.cube.as_deref().unwrap());
    change(&mut shown);
    let mut view = view.clone();
    view.shown.cube = Some(Arc::new(shown));
    view
}

/// The same a voxel farther along the first axis.
fn shifted(view: &View) -> View {
    with_cube(view, |shown| {
        shown.world_from_sample *= DAffine3::from_translation(DVec3::X);
    })
}

fn without(view: &View) -> View {
    let mut view = view.clone();
    view.shown.cube = None;
    view
}

struct Volume {
    case: Case,
    file: PathBuf,
    _folder: tempfile::TempDir,
}

fn volume(dims: [usize; 3], out: f64, is_askew: bool, field: impl Fn(DVec3) -> f64) -> Volume {
    let case = sample();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cube.nrrd");
    write(&file, around(&case, dims, out, is_askew), field);
    Volume {
        case,
        file,
        _folder: folder,
    }
}

#[test]
fn every_strategy_has_the_reference_s_volume() {
    let Volume {
        case,
        file,
        _folder,
    } = volume([24, 20, 22], 0.15, true, layers);
    let middle = opened(&case, &json!({})).world.bounds;
    let middle = (0.5 * (middle[0] + middle[1])).to_array();
    let plane = json!([{"point": middle, "normal": [0.3, 1, 0], "face": "open"}]);
    let exact = vec![StrategyKind::Plts, StrategyKind::Libc];
    let looks = [
        (json!({}), StrategyKind::ALL.to_vec()),
        (
            json!({"interpolation": "cell", "clip": plane}),
            exact.clone(),
        ),
        (
            json!({"show": {"hull": "faint", "faults": true, "wells": true}}),
            exact,
        ),
        (json!({"mode": "cells"}), vec![StrategyKind::Plts]),
    ];
    for (look, strategies) in looks {
        let view = opened(&case, &beside(&file, &look));
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        for executor in common::executors() {
            let mut renderer = executor.renderer(&case.grid).unwrap();
            for strategy in &strategies {
                let mut db = |view: &View| {
                    let (image, stats) = render(&mut *renderer, &view.by(*strategy));
                    (
                        psnr(&image, &truth, &view.by(*strategy)),
                        stats.cube_samples,
                    )
                };
                let (own, samples) = db(&view);
                let [moved, none] = [shifted(&view), without(&view)].map(|v| db(&v).0);
                let place = format!(
                    "{} {} {look}: {own:.1} dB, a voxel off {moved:.1}, without {none:.1}, {samples} samples",
                    executor.info().executor,
                    strategy.name()
                );
                println!("{place}");
                let on_gpu = executor.info().executor == "gpu";
                let least = match strategy {
                    // On the GPU single pixels differ at the rims of faces.
                    _ if on_gpu && view.style.surfaces.are_shown() => 45.0,
                    StrategyKind::Srg => 44.0,
                    StrategyKind::Libc => 52.0,
                    StrategyKind::Plts => 60.0,
                };
                assert!(samples > 10_000 && own > least, "{place}");
                assert!(moved < 40.0 && none < 30.0, "{place}");
            }
        }
    }
}

/// A cube of one value with an opacity per length is what Beer and Lambert say, wherever rays miss the model.
#[test]
fn an_even_volume_absorbs_as_beer_and_lambert_say() {
    let Volume {
        case,
        file,
        _folder,
    } = volume([8, 8, 8], 1.0, true, |_| 1.0);
    let opacity = |part: f64| json!({"transfer": {"opacity": [[0, part], [1, part]], "color": [[0, "#ff0000"]]}});
    let written = |part: f64| {
        let mut written = beside(
            &file,
            &json!({"early_termination": 0.0, "filter": {"i": [1, 1], "j": [1, 1]}}),
        );
        let volume = written["volumes"][0].as_object_mut().unwrap();
        volume.extend(opacity(part).as_object().unwrap().clone());
        volume.insert("range".into(), json!([0, 2]));
        opened(&case, &written)
    };
    let (view, twin) = (written(0.3), written(0.35));
    let shown = view.shown.cube.clone().unwrap();
    let tau = shown.transfer.extinction(0.5);
    let step = shown.step(view.sampling.step);
    // What rays pass of the parallelepiped, and where they meet the model's box.
    let chord = |x: u32, y: u32| {
        let ray = reference::Ray::through_pixel(&view, x, y);
        let inside = |p: DVec3| shown.world_from_sample.inverse().transform_point3(p);
        let (from, to) = (inside(ray.origin), inside(ray.origin + ray.direction));
        let within = |from: DVec3, along: DVec3, [low, high]: [DVec3; 2]| {
            let [a, b] = [low, high].map(|corner| (corner - from) / along);
            [a.min(b).max_element().max(0.0), a.max(b).min_element()]
        };
        let [enter, leave] = within(from, to - from, shown.crop);
        let [first, last] = within(ray.origin, ray.direction, view.world.bounds);
        (last <= first).then_some((leave - enter).max(0.0))
    };
    for executor in common::executors() {
        let mut renderer = executor.renderer(&case.grid).unwrap();
        for strategy in StrategyKind::ALL {
            let mut worst = |view: &View| {
                let (image, _) = render(&mut *renderer, &view.by(strategy));
                let mut worst = (0, 0.0f64);
                for (n, pixel) in (0..).zip(&image.pixels) {
                    let Some(length) = chord(n % view.size[0], n / view.size[0]) else {
                        continue;
                    };
                    let alpha = 1.0 - (-tau * length).exp();
                    // One sample more or less.
                    let slack = (tau * step).exp_m1() * (-tau * length).exp();
                    let over = (f64::from(pixel[3]) - alpha).abs() - slack;
                    worst = (worst.0 + u32::from(length > 0.0), worst.1.max(over));
                }
                worst
            };
            let (count, own) = worst(&view);
            let (_, other) = worst(&twin);
            let place = format!(
                "{} {}: {count} pixels, {own:.2e}, twin {other:.2e}",
                executor.info().executor,
                strategy.name()
            );
            println!("{place}");
            assert!(count > 500 && own < 1e-4 && other > 0.01, "{place}");
        }
    }
}

#[test]
fn a_volume_without_opacity_changes_no_bit() {
    let Volume {
        case,
        file,
        _folder,
    } = volume([12, 12, 12], 0.2, true, layers);
    let mut written = beside(&file, &json!({"show": {"hull": "faint", "faults": true}}));
    let with = |written: &mut Value, opacity: f64| {
        written["volumes"][0]["transfer"] = json!({"opacity": [[0, opacity], [1, opacity]]});
        opened(&case, written)
    };
    let (none, some) = (with(&mut written, 0.0), with(&mut written, 0.01));
    for executor in common::executors() {
        let mut renderer = executor.renderer(&case.grid).unwrap();
        for strategy in StrategyKind::ALL {
            let mut image = |view: &View| render(&mut *renderer, &view.by(strategy)).0;
            let plain = image(&without(&none));
            let place = format!("{} {}", executor.info().executor, strategy.name());
            assert!(image(&none).pixels == plain.pixels, "{place}");
            assert!(image(&some).pixels != plain.pixels, "{place}");
        }
    }
}

/// The same field on a turned and sheared lattice and on a straight one.
#[test]
fn a_turned_lattice_shows_the_same_field() {
    let case = sample();
    let folder = tempfile::tempdir().unwrap();
    let ball = |lattice: Lattice, shift: f64| {
        let view = opened(&case, &json!({}));
        let [low, high] = view
            .world
            .bounds
            .map(|p| view.world.spaces.map_from_world(p));
        let (center, size) = (0.5 * (low + high), (high - low).abs());
        let name = format!("{:?}{shift}.nrrd", lattice.edges[0][1]);
        let file = folder.path().join(name);
        let [ni, nj, nk] = lattice.dims.map(|n| n as f64);
        write(&file, lattice, |part| {
            let at = part * DVec3::new(ni, nj, nk) - 0.5;
            let place =
                DVec3::from_array(lattice.place(at.to_array())) * DVec3::new(1.0, 1.0, -1.0);
            let away = (place - center - shift * size.x * DVec3::X) / size;
            (-12.0 * away.length_squared()).exp()
        });
        let mut written = beside(&file, &json!({}));
        written["volumes"][0]["range"] = json!([0, 1]);
        written["volumes"][0]["transfer"] =
            json!({"opacity": [[0, 0], [0.2, 0], [1, 0.4]], "reference_length": 100});
        opened(&case, &written)
    };
    let straight = ball(around(&case, [48; 3], 0.4, false), 0.0);
    let turned = ball(around(&case, [64; 3], 0.6, true), 0.0);
    let aside = ball(around(&case, [64; 3], 0.6, true), 0.06);
    let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
    let [straight_image, turned_image, aside_image] =
        [&straight, &turned, &aside].map(|view| render(&mut *renderer, view).0);
    let own = psnr(&turned_image, &straight_image, &straight);
    let twin = psnr(&aside_image, &straight_image, &straight);
    println!("{own:.1} dB, aside {twin:.1} dB");
    assert!(own > 60.0 && twin < 42.0, "{own} {twin}");
}

#[test]
fn files_that_cannot_be_shown_are_told() {
    let Volume {
        case,
        file,
        _folder,
    } = volume([4, 4, 4], 0.0, false, |at| at.x);
    let refused = |written: &Value| {
        let scene = view::look::opening(&case, written).unwrap();
        view::resolve(&scene, &case).err().unwrap().to_string()
    };
    let cut = file.with_file_name("cut.nrrd");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() - 9]).unwrap();
    let missing = file.with_file_name("missing.segy");
    for (path, words) in [(&cut, "the file is cut"), (&missing, "missing.segy")] {
        let told = refused(&beside(path, &json!({})));
        assert!(
            told.contains(words) && told.contains(path.to_str().unwrap()),
            "{told}"
        );
    }
    let with = |key: &str, value: Value| {
        let mut written = beside(&file, &json!({}));
        written["volumes"][0][key] = value;
        refused(&written)
    };
    assert!(with("crop", json!({"i": [0, 9]})).contains("volumes.crop.i"));
    assert!(with("velocity", json!(-3)).contains("volumes.velocity"));
    assert!(with("range", json!([1, 0])).contains("volumes.range"));
    let log = json!({"scale": "log"});
    assert!(with("transfer", log).contains("volumes.transfer.scale"));
    let mut two = beside(&file, &json!({}));
    let first = two["volumes"][0].clone();
    two["volumes"].as_array_mut().unwrap().push(first);
    assert!(refused(&two).contains("one volume at a time"));
    let unknown = json!({"volumes": [{"file": file, "opacity": 1}]});
    assert!(view::look::opening(&case, &unknown).is_err());
    // The twin: what is right is shown.
    assert!(
        opened(&case, &beside(&file, &json!({})))
            .shown
            .cube
            .is_some()
    );
}

/// What is seen of a volume is told, and no cell behind it.
#[test]
fn a_pick_tells_the_volume_that_hides_the_cells() {
    let Volume {
        case,
        file,
        _folder,
    } = volume([8, 8, 8], 0.3, false, |at| 1.0 + at.x);
    let with = |opacity: f64| {
        let mut written = beside(&file, &json!({}));
        written["volumes"][0]["transfer"] = json!({"opacity": [[0, opacity], [1, opacity]]});
        opened(&case, &written)
    };
    let mut renderer = CpuExecutor::default().renderer(&case.grid).unwrap();
    let middle = glam::DVec2::splat(0.5);
    let hidden = picking::pick(&mut *renderer, &case, &with(0.99), middle).unwrap();
    let cube = hidden.cube.unwrap();
    assert!(hidden.hit.is_none() && cube.name == "AMPLITUDE");
    assert!((1.0..=2.0).contains(&cube.value), "{cube:?}");
    let seen = picking::pick(&mut *renderer, &case, &with(0.0), middle).unwrap();
    assert!(seen.cube.is_none() && !seen.cells.is_empty());
}
