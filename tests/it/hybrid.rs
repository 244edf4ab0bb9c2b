//! A regular volume beside the model: images of all executors and strategies against the reference.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};

use crate::common;
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::reference;
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::{Executor, FrameStats, Renderer};
use strataray::scene::StrategyKind;
use strataray::view::{self, ShownCube, View};
use strataray_parsers::volume::{ByteOrder, Contents, Lattice, SampleType, nrrd};

/// All that there are.
fn executors() -> Vec<Arc<dyn Executor>> {
    let gpu = common::gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    gpu.into_iter().chain([cpu]).collect()
}

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
        shown.world_from_sample = shown.world_from_sample * DAffine3::from_translation(DVec3::X);
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
    let Volume { case, file, .. } = volume([24, 20, 22], 0.15, true, layers);
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
        for executor in executors() {
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
                let least = match strategy {
                    StrategyKind::Srg => 38.0,
                    StrategyKind::Libc => 48.0,
                    StrategyKind::Plts => 50.0,
                };
                assert!(samples > 10_000 && own > least, "{place}");
                assert!(moved < 36.0 && none < 36.0, "{place}");
            }
        }
    }
}
