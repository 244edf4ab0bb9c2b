//! The strategy SRG: what its volume holds, when it is filled, and what each switch costs and gains.

#[allow(dead_code, reason = "only the time is of use here")]
#[path = "../../src/cli/process.rs"]
mod process;

use std::cell::Cell;
use std::time::Duration;

use crate::common;
use crate::common::light::Block;
use crate::common::shape::{Shape, boxes, parallelepipeds};
use glam::DVec3;
use half::f16;
use rayon::prelude::*;
use strataray::case::{Case, load};
use strataray::image::metrics::{Comparison, fraction_within, psnr_8bit};
use strataray::image::{Image, Rgb8};
use strataray::model::{CellField, Grid, VertexField};
use strataray::reference::{self, Locator};
use strataray::render::gpu::pyramids::{self, Bricks};
use strataray::render::gpu::resample::{self, VOXEL_WORK};
use strataray::render::gpu::slabs::Slabs;
use strataray::render::gpu::strategies::srg::Srg;
use strataray::render::gpu::strategy::{Preparation, RenderStrategy};
use strataray::render::gpu::tiles::Pace;
use strataray::render::gpu::volume::Volume;
use strataray::render::gpu::{Gpu, GpuGrid, GpuRenderer};
use strataray::render::plan::layout::RUN;
use strataray::render::revisions::RevisionCounter;
use strataray::render::{Frame, Job, RenderError, Renderer};
use strataray::scene::{
    self, CameraSpec, ClipSpec, CutFace, ExplicitCamera, FramingCamera, Inactive, Interpolation,
    OpacitySpec, Projection, RangeSpec, Scene, SrgSettings, StrategyKind,
};
use strataray::view::voxels::{self, Voxel};
use strataray::view::{self, ShownCells, View};

/// No switch is on.
const PLAIN: SrgSettings = SrgSettings {
    budget_mb: None,
    factor: None,
    weighted: false,
    skip_empty: false,
    even: 0.0,
    thin: 0.0,
    roulette: 0.0,
};

/// An opacity curve under which the lower half of the values is invisible.
const UPPER_HALF: [[f64; 2]; 3] = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.7]];

/// Turns a switch on.
type Change = fn(&mut SrgSettings);

fn scene(size: [u32; 2], srg: SrgSettings) -> Scene {
    Scene {
        size,
        camera: CameraSpec::Framing(FramingCamera {
            azimuth_degrees: 205.0,
            elevation_degrees: 35.0,
            zoom: 1.2,
            projection: Projection::Perspective,
        }),
        strategy: StrategyKind::Srg,
        srg,
        ..Scene::default()
    }
}

fn with(view: &View, srg: SrgSettings) -> View {
    let mut changed = view.clone();
    changed.sampling.srg = srg;
    changed
}

fn render(renderer: &mut GpuRenderer, view: &View) -> Frame {
    let frame = renderer.render(view, &|_| true).unwrap();
    assert!(frame.image.pixels.iter().flatten().all(|v| v.is_finite()));
    frame
}

fn compare(a: &Image, b: &Image, view: &View) -> Comparison {
    let [a, b] = [a, b].map(|image| Rgb8 {
        size: image.size,
        pixels: image.over_background_8bit(view.style.background),
    });
    Comparison::of(&a, &b).unwrap()
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

/// Value times presence, and presence, of each voxel.
fn volume_of(
    gpu: &Gpu,
    grid: &Grid,
    field: &CellField,
    interpolation: Interpolation,
    factor: f64,
) -> ([u32; 3], Vec<[f64; 2]>) {
    let mut on_device = GpuGrid::new(gpu, grid).unwrap();
    let drawn: Vec<bool> = field.values().iter().map(|v| !v.is_nan()).collect();
    let shown = ShownCells::new(field.clone().into(), drawn, interpolation);
    on_device.show(gpu, grid, &shown).unwrap();
    let volume = Volume::new(gpu, voxels::Shape::of(grid.dims(), factor, false));
    let range = range_of(field);
    let fill = Job::new(|progress| {
        let (on_device, volume) = (&on_device, &volume);
        Box::pin(async move {
            let mut pace = Pace::default();
            let mut slabs = Slabs::new(gpu, &mut pace, &progress);
            resample::fill(&mut slabs, on_device, volume, range, interpolation).await
        })
    });
    fill.run(&|_| true).unwrap();
    let halves =
        |word: &u32| [*word as u16, (*word >> 16) as u16].map(|h| f16::from_bits(h).into());
    let words = volume.read(gpu, 0).unwrap();
    (volume.shape.size, words.iter().map(halves).collect())
}

fn range_of(field: &CellField) -> [f64; 2] {
    let statistics = field.statistics().unwrap();
    [statistics.min, statistics.max]
}

/// Point of grid space at a part (0..1) of the box of the active cells.
fn in_box(grid: &Grid, part: DVec3) -> DVec3 {
    let [low, high] = grid.bounds().unwrap();
    low + part * (high - low)
}

/// Place of a voxel in the box; `shift` is added to the middle, in voxels.
fn place([nx, ny, nz]: [u32; 3], n: usize, shift: f64) -> DVec3 {
    let n = n as u32;
    let voxel = glam::UVec3::new(n % nx, n / nx % ny, n / nx / ny).as_dvec3();
    (voxel + 0.5 + shift) / glam::UVec3::new(nx, ny, nz).as_dvec3()
}

#[test]
fn the_volume_holds_value_and_presence_as_the_reference_finds_them() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let grid = &case.grid;
        let field = case.field("PORO", 0).unwrap();
        let [low, high] = range_of(&field);
        let locator = Locator::new(grid);
        let vertices = VertexField::new(grid, &field);
        for interpolation in [Interpolation::Cell, Interpolation::Vertex] {
            let (size, voxels) = volume_of(&gpu, grid, &field, interpolation, 1.3);
            let vertices = (interpolation == Interpolation::Vertex).then_some(&vertices);
            let every = voxels.len().div_ceil(8000);
            let expected = |part| {
                let located = locator.locate(in_box(grid, part));
                let value = located.and_then(|l| reference::value_at(grid, &l, &field, vertices));
                value.map_or([0.0; 2], |v| [(v - low) / (high - low), 1.0])
            };
            let wrong = |shift| {
                let wrong = |n: &usize| {
                    let expected = expected(place(size, *n, shift));
                    // Half floats have eleven bits.
                    let [value, presence] = voxels[*n];
                    presence != expected[1] || (value - expected[0]).abs() > 6e-4
                };
                let tested = (0..voxels.len()).into_par_iter().step_by(every);
                tested.filter(wrong).count()
            };
            let present = voxels.iter().filter(|v| v[1] == 1.0).count();
            let [at_middle, beside] = [wrong(0.0), wrong(0.25)];
            println!(
                "{} {interpolation:?}: of {} voxels {present} are present, {at_middle} differ, {beside} beside the middles",
                case.about.name,
                voxels.len()
            );
            // A middle on a face may fall to either side.
            assert!(at_middle * every * 1000 <= present, "{at_middle}");
            assert!(beside * every * 10 > present && present > 1000, "{beside}");
        }
    }
}

#[test]
fn a_linear_field_is_linear_in_the_volume() {
    let Some(gpu) = common::gpu() else { return };
    let errors = |square: f64| {
        let case = parallelepipeds::case(square);
        let field = case.field("VALUE", 0).unwrap();
        let [low, high] = range_of(&field);
        let (size, voxels) = volume_of(&gpu, &case.grid, &field, Interpolation::Vertex, 5.0);
        let locator = Locator::new(&case.grid);
        let (mut worst, mut inside) = (0.0f64, 0);
        for (n, voxel) in voxels.iter().enumerate() {
            let point = in_box(&case.grid, place(size, n, 0.0));
            let Some(located) = locator.locate(point) else {
                continue;
            };
            let ijk = [located.ijk.i, located.ijk.j, located.ijk.k];
            if (0..3).all(|a| (1..parallelepipeds::DIMS[a] - 1).contains(&ijk[a])) {
                let expected = parallelepipeds::value(point, square);
                worst = worst.max((voxel[0] - (expected - low) / (high - low)).abs());
                inside += 1;
            }
        }
        assert!(inside > 500, "{inside}");
        worst
    };
    let [exact, square] = [errors(0.0), errors(1e-5)];
    println!(
        "worst error of a stored value: {exact:.1e}, {square:.1e} where the field is not linear"
    );
    assert!(exact < 3e-4 && square > 1e-3);
}

/// The strategy by itself, with what it is prepared from.
struct Bench<'a> {
    gpu: &'a Gpu,
    case: &'a Case,
    grid: GpuGrid,
    revisions: RevisionCounter,
    srg: Srg,
}

impl<'a> Bench<'a> {
    fn new(gpu: &'a Gpu, case: &'a Case) -> Self {
        Self {
            gpu,
            case,
            grid: GpuGrid::new(gpu, &case.grid).unwrap(),
            revisions: RevisionCounter::default(),
            srg: Srg::new(gpu),
        }
    }

    fn show(&mut self, view: &View) {
        let (gpu, model) = (self.gpu, &self.case.grid);
        self.grid.show(gpu, model, &view.shown.cells).unwrap();
        self.grid.revisions = self.revisions.of(view);
    }

    /// Whether it was not canceled, how often the volume was filled, and how often progress was told.
    fn prepare(&mut self, view: &View, go_on: bool) -> (bool, u64, u32) {
        let (fills, calls) = (self.srg.fills(), Cell::new(0));
        let progress = |_| {
            calls.set(calls.get() + 1);
            go_on
        };
        let (gpu, model, grid, srg) = (self.gpu, &self.case.grid, &self.grid, &mut self.srg);
        let prepare = Job::new(|told| {
            Box::pin(async move {
                let what = Preparation {
                    gpu,
                    model,
                    grid,
                    view,
                    faces: None,
                    progress: &told,
                };
                srg.prepare(&what).await
            })
        });
        let done = match prepare.run(&progress) {
            Ok(()) => true,
            Err(RenderError::Canceled) => false,
            Err(error) => panic!("{error}"),
        };
        (done, self.srg.fills() - fills, calls.get())
    }
}

#[test]
fn the_volume_is_filled_anew_when_it_must_and_only_then() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let settings = SrgSettings {
        factor: Some(2.0),
        ..SrgSettings::default()
    };
    let base = scene([40, 30], settings);
    let view = |change: &dyn Fn(&mut Scene)| {
        let mut scene = base.clone();
        change(&mut scene);
        view::resolve(&scene, &case).unwrap()
    };
    let first = view(&|_| ());
    let mut bench = Bench::new(&gpu, &case);
    bench.show(&first);
    // Canceled, filled, kept.
    assert_eq!(bench.prepare(&first, false), (false, 0, 1));
    let (done, fills, calls) = bench.prepare(&first, true);
    assert!(done && fills == 1 && calls > 0, "{fills} {calls}");
    assert_eq!(bench.prepare(&first, true), (true, 0, 0));
    // Nothing of this is in the volume. The first curve that hides values asks for the bricks.
    let hides =
        |scene: &mut Scene| scene.transfer.opacity = Some(OpacitySpec::Points(UPPER_HALF.to_vec()));
    let (done, fills, calls) = bench.prepare(&view(&hides), true);
    assert!(done && fills == 0 && calls > 0);
    let turned = |scene: &mut Scene| {
        scene.camera = CameraSpec::Framing(FramingCamera {
            azimuth_degrees: 20.0,
            elevation_degrees: 60.0,
            zoom: 2.0,
            projection: Projection::Perspective,
        });
    };
    let kept: [&dyn Fn(&mut Scene); 7] = [
        &hides,
        &turned,
        &|scene| scene.range = RangeSpec::Fixed([0.2, 0.3]),
        &|scene| scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.5], [0.4, 0.0]])),
        &|scene| scene.sampling_step = Some(20.0),
        &|scene| scene.srg.weighted = false,
        &|scene| scene.srg.even = 0.1,
    ];
    for change in kept {
        assert_eq!(bench.prepare(&view(change), true), (true, 0, 0));
    }
    // All of this is.
    let another: [&dyn Fn(&mut Scene); 6] = [
        &|scene| scene.step = scene::StepSpec::Index(3),
        &|scene| scene.property = Some("PORO".into()),
        &|scene| scene.interpolation = Interpolation::Cell,
        &|scene| scene.filter.k = Some([2, 5].into()),
        &|scene| scene.srg.factor = Some(1.5),
        &|scene| scene.srg.thin = 0.01,
    ];
    for change in another {
        let view = view(change);
        bench.show(&view);
        let (done, fills, calls) = bench.prepare(&view, true);
        assert!(done && fills == 1 && calls > 0);
        assert_eq!(bench.prepare(&view, true).1, 0);
        bench.show(&first);
        assert_eq!(bench.prepare(&first, true).1, 1);
    }
    // What is left of a fill that was canceled is not used.
    let later = view(another[0]);
    bench.show(&later);
    assert_eq!(bench.prepare(&later, false), (false, 0, 1));
    assert_eq!(bench.prepare(&later, true).1, 1);
}

#[test]
fn a_fill_is_split_into_parts_that_the_pace_allows() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let field = case.field("PORO", 0).unwrap();
    let mut on_device = GpuGrid::new(&gpu, &case.grid).unwrap();
    let drawn = vec![true; field.values().len()];
    let shown = ShownCells::new(field.clone(), drawn, Interpolation::Cell);
    on_device.show(&gpu, &case.grid, &shown).unwrap();
    let volume = Volume::new(&gpu, voxels::Shape::of(case.grid.dims(), 4.0, false));
    let [width, height, depth] = volume.shape.size.map(u64::from);
    let voxels = width * height * depth;
    // Voxels of each part, made at a pace that learns from the parts or, the twin, at one that does all at once.
    let parts_at = |mut pace: Pace| {
        let done = Cell::new(0.0);
        let parts = std::cell::RefCell::new(Vec::new());
        let progress = |part: f64| {
            let voxels = (part - done.replace(part)) * voxels as f64;
            parts.borrow_mut().push(voxels.round() as u64);
            true
        };
        let range = range_of(&field);
        let fill = Job::new(|told| {
            let (gpu, on_device, volume) = (&gpu, &on_device, &volume);
            let pace = &mut pace;
            Box::pin(async move {
                let mut slabs = Slabs::new(gpu, pace, &told);
                resample::fill(&mut slabs, on_device, volume, range, Interpolation::Cell).await
            })
        });
        fill.run(&progress).unwrap();
        assert_eq!(done.get(), 1.0);
        parts.into_inner()
    };
    let learned = parts_at(Pace::default());
    let mut fast = Pace::default();
    for _ in 0..60 {
        fast.learn(Duration::from_micros(1), u64::MAX);
    }
    let at_once = parts_at(fast);
    // However fast the device is, the first part is as small as for the slowest one, and each may be larger
    // than the one before by the pace's growth alone; rows are not divided.
    let row = width * depth.min(u64::from(RUN));
    let mut most = Pace::default().pieces(1) as f64;
    let is_short = |(voxels, most): (&u64, f64)| (voxels * VOXEL_WORK) as f64 <= most + 1.0;
    let mut limits = || {
        let limit = most.max((row * VOXEL_WORK) as f64);
        most *= Pace::CHANGE[1];
        limit
    };
    let limits: Vec<f64> = learned.iter().map(|_| limits()).collect();
    println!(
        "{voxels} voxels in {} parts, the largest of {:?}; {} parts without a limit",
        learned.len(),
        learned.iter().max(),
        at_once.len()
    );
    assert_eq!(learned.iter().sum::<u64>(), voxels);
    assert!(learned.len() > 5, "{learned:?}");
    assert!(
        learned.iter().zip(limits.clone()).all(is_short),
        "{learned:?}"
    );
    assert!(!at_once.iter().zip(limits).all(is_short), "{at_once:?}");
}

#[test]
fn the_volume_fits_its_budget_or_has_its_factor() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let mut bytes = |settings| {
            let view = view::resolve(&scene([20, 15], settings), &case).unwrap();
            render(&mut renderer, &view).bytes.resampled
        };
        for megabytes in [1, 3, 10] {
            let budget = u64::from(megabytes) << 20;
            let all = SrgSettings {
                budget_mb: Some(megabytes),
                even: 0.01,
                thin: 0.01,
                ..SrgSettings::default()
            };
            let with_pyramids = bytes(all);
            let alone = bytes(SrgSettings {
                budget_mb: Some(megabytes),
                ..PLAIN
            });
            println!(
                "{} {megabytes} MB: {alone} bytes, {with_pyramids} with all pyramids",
                case.about.name
            );
            assert!(alone < with_pyramids && with_pyramids <= budget);
            assert!(with_pyramids * 10 > budget * 7, "most of it is used");
        }
        let cells = case.grid.dims().cells() as u64;
        let twice = bytes(SrgSettings {
            factor: Some(2.0),
            ..PLAIN
        });
        // Beside the voxels there are the buffers that are only bound.
        assert_eq!(twice, 4 * 8 * cells + 48);
    }
}

/// PSNR in dB to the plain march, and steps as a part of its steps.
fn against_plain(renderer: &mut GpuRenderer, view: &View, settings: SrgSettings) -> [f64; 2] {
    let plain = render(renderer, &with(view, PLAIN));
    let frame = render(renderer, &with(view, settings));
    let steps = frame.stats.work as f64 / plain.stats.work as f64;
    [psnr(&frame.image, &plain.image, view), steps]
}

#[test]
fn each_switch_stays_within_its_error_of_the_plain_march() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let mut scene = scene([200, 150], PLAIN);
        scene.transfer.opacity = Some(OpacitySpec::Points(UPPER_HALF.to_vec()));
        let view = view::resolve(&scene, &case).unwrap();
        // A switch, the least PSNR in dB and the most steps that it may take, and its twin that is too
        // coarse to stay within either error.
        let rows: [(&str, Change, [f64; 2], Change); 4] = [
            // The twin passes what is seen.
            (
                "skip_empty",
                |s| s.skip_empty = true,
                [80.0, 0.95],
                |s| s.thin = 0.9,
            ),
            ("even", |s| s.even = 0.01, [60.0, 1.01], |s| s.even = 0.9),
            ("thin", |s| s.thin = 0.02, [40.0, 0.95], |s| s.thin = 0.9),
            (
                "roulette",
                |s| s.roulette = 0.02,
                [40.0, 1.01],
                |s| s.roulette = 0.9,
            ),
        ];
        for (name, change, [least, most], twin) in rows {
            let [[db, steps], [twin_db, twin_steps]] = [change, twin].map(|change| {
                let mut settings = PLAIN;
                change(&mut settings);
                against_plain(&mut renderer, &view, settings)
            });
            println!(
                "{} {name}: {db:.1} dB with {steps:.2} of the steps; its twin {twin_db:.1} dB with {twin_steps:.2}",
                case.about.name
            );
            assert!(db >= least && steps <= most, "{name}");
            // Layers so thin that no brick lies inside the model have no even ones.
            let has_none = name == "even" && twin_steps > 0.999 && model != common::sample();
            assert!(twin_db < least || has_none, "{name}: the twin");
        }
    }
}

#[test]
fn dividing_by_presence_comes_nearer_to_the_reference() {
    let Some(gpu) = common::gpu() else { return };
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let view = view::resolve(&scene([120, 90], PLAIN), &case).unwrap();
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        let weighted = SrgSettings {
            weighted: true,
            ..PLAIN
        };
        let [without, with] = [PLAIN, weighted].map(|settings| {
            let view = with(&view, settings);
            psnr(&render(&mut renderer, &view).image, &truth, &view)
        });
        println!(
            "{}: {without:.1} dB, {with:.1} dB divided by presence",
            case.about.name
        );
        assert!(with > without + 1.0);
    }
}

#[test]
fn roulette_is_unbiased() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let mut scene = scene([160, 120], PLAIN);
    scene.early_termination = 0.0;
    scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.3], [1.0, 0.9]]));
    let view = view::resolve(&scene, &case).unwrap();
    let plain = render(&mut renderer, &view).image;
    // Mean difference of all channels of the pixels that differ, in standard errors.
    let mut bias = |view: &View| {
        let found = render(&mut renderer, view).image;
        let sums = |image: &Image| -> Vec<f64> {
            let sum = |p: &[f32; 4]| p.iter().map(|v| f64::from(*v)).sum();
            image.pixels.iter().map(sum).collect()
        };
        let pairs = sums(&found).into_iter().zip(sums(&plain));
        let differences: Vec<f64> = pairs.map(|(a, b)| a - b).filter(|d| *d != 0.0).collect();
        let n = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / n;
        let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / n;
        (n, mean / (variance / n).sqrt())
    };
    let by_chance = with(
        &view,
        SrgSettings {
            roulette: 0.3,
            ..PLAIN
        },
    );
    let (pixels, errors) = bias(&by_chance);
    // The twin ends all those rays.
    let always = {
        let mut changed = view.clone();
        changed.sampling.early_termination = 0.3;
        changed
    };
    let (_, twin) = bias(&always);
    println!(
        "{pixels} pixels differ; bias {errors:.2} standard errors, {twin:.0} where every ray ends"
    );
    assert!(pixels > 2000.0 && errors.abs() < 4.0 && twin.abs() > 20.0);
    // The same pixel, the same chance.
    let [a, b] = [0, 1].map(|_| render(&mut renderer, &by_chance).image);
    assert!(psnr(&a, &b, &view) > 60.0);
}

#[test]
fn quality_grows_with_the_factor() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let view = view::resolve(&scene([120, 90], SrgSettings::default()), &case).unwrap();
    let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
    let mut before = 0.0;
    for factor in [1.0, 2.0, 3.0, 4.0, 6.0, 8.0] {
        let settings = SrgSettings {
            factor: Some(factor),
            ..SrgSettings::default()
        };
        let image = render(&mut renderer, &with(&view, settings)).image;
        let found = compare(&image, &truth, &view);
        println!("factor {factor}: {found:?}");
        assert!(found.psnr_db > before + 1.0, "{factor}");
        before = found.psnr_db;
    }
    assert!(before > 45.0);
}

/// Boxes whose inner part a plane of clipping on each side leaves, two cells from the model's sides.
fn inner_boxes(value: &dyn Fn([usize; 3]) -> f64) -> (Case, Vec<ClipSpec>) {
    const COUNTS: [u32; 3] = [9, 8, 7];
    const EDGES: [f64; 3] = [100.0, 90.0, 40.0];
    let planes: [Vec<f64>; 3] = std::array::from_fn(|a| {
        let planes = 0..=COUNTS[a];
        planes.map(|n| EDGES[a] * f64::from(n)).collect()
    });
    let [x, y, depth] = &planes;
    let sides = (0..6).map(|side| {
        let (axis, is_high) = (side / 2, side % 2 == 1);
        let from_side = 2.0 * EDGES[axis];
        let whole = EDGES[axis] * f64::from(COUNTS[axis]);
        let at = if is_high {
            whole - from_side
        } else {
            from_side
        };
        // Depth is down.
        let up = if axis == 2 { -1.0 } else { 1.0 };
        let inward = if is_high { -up } else { up };
        let on = |v: f64| std::array::from_fn(|a| if a == axis { v } else { 0.0 });
        ClipSpec {
            point: on(up * at),
            normal: on(inward),
            face: CutFace::Open,
        }
    });
    (boxes(x, y, depth, value), sides.collect())
}

#[test]
fn a_field_that_resampling_keeps_is_seen_as_the_reference_sees_it() {
    let Some(gpu) = common::gpu() else { return };
    // A linear field is the same between vertices and between the middles of voxels, but beside the model's sides.
    // The twin is a field of zeros and ones.
    let linear = |[i, j, k]: [usize; 3]| (i + 2 * j + 3 * k) as f64 / 40.0;
    let uneven = |[i, j, k]: [usize; 3]| {
        f64::from(u8::from(
            fastrand::Rng::with_seed((i + 101 * j + 10_007 * k) as u64).bool(),
        ))
    };
    for factor in [1.0, 2.0] {
        for projection in [Projection::Perspective, Projection::Parallel] {
            let found = [&linear as &dyn Fn([usize; 3]) -> f64, &uneven].map(|value| {
                let (case, clip) = inner_boxes(value);
                let settings = SrgSettings {
                    factor: Some(factor),
                    ..SrgSettings::default()
                };
                let mut scene = scene([80, 60], settings);
                scene.property = Some("VALUE".into());
                scene.range = RangeSpec::Fixed([0.0, 1.0]);
                scene.vertical_exaggeration = Some(1.0);
                scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.05], [1.0, 0.6]]));
                scene.transfer.reference_length = Some(100.0);
                scene.clip = clip;
                if let CameraSpec::Framing(camera) = &mut scene.camera {
                    camera.projection = projection;
                }
                let view = view::resolve(&scene, &case).unwrap();
                assert_eq!(view.shown.cells.interpolation, Interpolation::Vertex);
                let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
                assert!(truth.pixels.iter().filter(|p| p[3] > 0.3).count() > 300);
                let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
                let image = render(&mut renderer, &view).image;
                let within = fraction_within(&image.pixels, &truth.pixels, 2e-3);
                (psnr(&image, &truth, &view), within)
            });
            println!("{factor} {projection:?}: {found:?}");
            let [kept, twin] = found;
            // Nearer than PLTS must be, for one model alone.
            assert!(kept.0 >= 65.0 && kept.1 >= 0.999, "{kept:?}");
            assert!(twin.0 < 55.0 && twin.1 < 0.95, "{twin:?}");
        }
    }
}

/// Both numbers of each voxel of a level.
fn pairs(gpu: &Gpu, volume: &Volume, level: u32) -> [Block; 2] {
    let words = volume.read(gpu, level).unwrap();
    [0, 16].map(|shift| Block {
        size: volume.shape.at(level).map(|n| n as usize),
        values: words
            .iter()
            .map(|w| f16::from_bits((w >> shift) as u16).into())
            .collect(),
    })
}

#[test]
fn averages_are_means_of_an_odd_number_of_voxels_too() {
    let Some(gpu) = common::gpu() else { return };
    // What a half float leaves of a number below 1.
    const HALF: f64 = 5e-4;
    let mut random = fastrand::Rng::with_seed(5);
    for size in [[3, 5, 7], [7, 3, 5], [6, 9, 1], [4, 8, 16]] {
        let shape = voxels::Shape {
            size,
            levels: 3,
            voxel: Voxel::Pair,
        };
        let volume = Volume::new(&gpu, shape);
        let number = 2 * size.iter().product::<u32>();
        let halves: Vec<u16> = (0..number)
            .map(|_| f16::from_f64(random.f64()).to_bits())
            .collect();
        let [width, height, depth_or_array_layers] = size;
        gpu.queue.write_texture(
            volume.texture.as_image_copy(),
            bytemuck::cast_slice(&halves),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * width),
                rows_per_image: Some(height),
            },
            wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers,
            },
        );
        let bricks = Bricks::unused(&gpu, size);
        let average = Job::new(|told| {
            let (gpu, volume, bricks) = (&gpu, &volume, &bricks);
            Box::pin(async move {
                let mut pace = Pace::default();
                let mut slabs = Slabs::new(gpu, &mut pace, &told);
                pyramids::average(&mut slabs, volume, bricks).await
            })
        });
        average.run(&|_| true).unwrap();
        let mut worst: f64 = 0.0;
        for level in 1..shape.levels {
            let [below, made] = [level - 1, level].map(|l| pairs(&gpu, &volume, l));
            for (below, made) in below.iter().zip(&made) {
                let error = made.apart(&below.means(made.size));
                // The twin: one lookup in the middle, which is the mean where voxels pair off.
                let mut lookup = made.clone();
                for voxel in made.voxels() {
                    *lookup.at_mut(voxel) = below.linear(made.middle(voxel));
                }
                let twin = made.apart(&lookup);
                println!("{size:?}, level {level}: off by {error:.5}, a lookup by {twin:.4}");
                assert!(error < HALF, "{error}");
                worst = worst.max(twin);
            }
        }
        let is_odd = size.iter().any(|n| n % 2 == 1 && *n > 1);
        assert!(if is_odd { worst > 0.1 } else { worst < HALF }, "{worst}");
    }
}

#[test]
fn clip_planes_cut_and_show_exact_sections() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let mut scene = scene([120, 90], SrgSettings::default());
    scene.vertical_exaggeration = Some(8.0);
    let whole = view::resolve(&scene, &case).unwrap();
    let middle = 0.5 * (whole.world.bounds[0] + whole.world.bounds[1]);
    let uncut = render(&mut renderer, &whole).image;
    for face in [CutFace::Open, CutFace::Opaque] {
        scene.clip = vec![ClipSpec {
            point: middle.to_array(),
            normal: [0.1, 1.0, 0.0],
            face,
        }];
        let view = view::resolve(&scene, &case).unwrap();
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        let image = render(&mut renderer, &view).image;
        let [cut, twin] = [&image, &uncut].map(|i| psnr(i, &truth, &view));
        println!("{face:?}: {cut:.1} dB, {twin:.1} dB uncut");
        assert!(cut > 40.0 && twin < 30.0);
        // Where the section is opaque the volume plays no part.
        let pairs = image.pixels.iter().zip(&truth.pixels);
        let sections = pairs.filter(|(_, t)| t[3] == 1.0);
        let (close, far): (Vec<_>, Vec<_>) =
            sections.partition(|(a, t)| (0..4).all(|c| (a[c] - t[c]).abs() < 2e-3));
        assert_eq!(
            close.len() > 300,
            face == CutFace::Opaque,
            "{}",
            close.len()
        );
        assert!(far.len() * 100 <= close.len(), "{}", far.len());
    }
}

#[test]
fn an_eye_inside_the_model_sees_what_is_ahead() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let mut scene = scene([120, 90], SrgSettings::default());
    let outside = view::resolve(&scene, &case).unwrap();
    let [low, high] = outside.world.bounds;
    let middle = 0.5 * (low + high);
    let mut look_at = |target: DVec3| {
        scene.camera = CameraSpec::Explicit(ExplicitCamera {
            eye: middle.to_array(),
            target: target.to_array(),
            up: [0.0, 0.0, 1.0],
            fovy_degrees: 60.0,
            projection: Projection::Perspective,
        });
        view::resolve(&scene, &case).unwrap()
    };
    let view = look_at(DVec3::new(high.x, high.y, middle.z));
    let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
    let back = look_at(DVec3::new(low.x, low.y, middle.z));
    let [ahead, twin] = [&view, &back].map(|v| {
        let image = render(&mut renderer, v).image;
        psnr(&image, &truth, &view)
    });
    println!("{ahead:.1} dB, {twin:.1} dB looking back");
    assert!(ahead > 38.0 && twin < 30.0);
}

#[test]
fn ghosts_are_resampled_beside_the_field() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    // Only ghosts are seen, and they are seen well.
    let mut scene = scene([120, 90], SrgSettings::default());
    scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.0], [1.0, 0.0]]));
    scene.transfer.reference_length = Some(2.0);
    let hidden = view::resolve(&scene, &case).unwrap();
    scene.show.inactive = Inactive::Ghost;
    let view = view::resolve(&scene, &case).unwrap();
    let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
    let [found, twin] = [&view, &hidden].map(|v| {
        let image = render(&mut renderer, v).image;
        psnr(&image, &truth, &view)
    });
    println!("{found:.1} dB, {twin:.1} dB without ghosts");
    assert!(found > 40.0 && twin < 25.0);
}

#[test]
fn undefined_values_and_hidden_cells_leave_holes() {
    let Some(gpu) = common::gpu() else { return };
    let case = Shape {
        dims: [4, 4, 4],
        value: &|[i, j, _]| if (i, j) == (1, 2) { 1e20 } else { 0.5 },
        ..Shape::default()
    }
    .case();
    let mut scene = scene([60, 45], SrgSettings::default());
    scene.property = Some("VALUE".into());
    scene.transfer.opacity = Some(OpacitySpec::Points(vec![[0.0, 0.9], [1.0, 0.9]]));
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let view = view::resolve(&scene, &case).unwrap();
    let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
    let db = psnr(&render(&mut renderer, &view).image, &truth, &view);
    scene.filter.i = Some([1, 2].into());
    let half = view::resolve(&scene, &case).unwrap();
    let twin = psnr(&render(&mut renderer, &half).image, &truth, &view);
    println!("{db:.1} dB, {twin:.1} dB where half of the cells are hidden");
    assert!(db > 35.0 && twin < 25.0);
}

#[test]
fn err_settings_out_of_range_are_named() {
    let case = load::open(&common::sample()).unwrap();
    let with = |text: &str| {
        let settings = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let scene = Scene {
            srg: settings,
            ..Scene::default()
        };
        view::resolve(&scene, &case).map_err(|e| e.to_string())
    };
    for (text, word) in [
        (r#"{"budget_mb": 0}"#, "srg.budget_mb"),
        (r#"{"factor": 0}"#, "srg.factor"),
        (r#"{"factor": -1}"#, "srg.factor"),
        (r#"{"factor": 1e300}"#, "srg.factor"),
        (r#"{"factor": 30}"#, "budget_mb"),
        (r#"{"factor": 5, "budget_mb": 1}"#, "budget_mb"),
        (r#"{"even": 1}"#, "srg.even"),
        (r#"{"thin": -0.1}"#, "srg.thin"),
        (r#"{"roulette": 2}"#, "srg.roulette"),
        (r#"{"budget": 5}"#, "budget"),
    ] {
        let error = with(text).err().unwrap_or_default();
        assert!(error.contains(word), "{text}: {error}");
    }
    let fine = with(r#"{"budget_mb": 512, "factor": 2.5, "even": 0.02}"#).unwrap();
    assert_eq!(
        (fine.sampling.srg.factor, fine.sampling.srg.even),
        (Some(2.5), 0.02)
    );
}

/// CPU time of a frame in milliseconds, the mean of several.
fn cpu_time(renderer: &mut GpuRenderer, view: &View) -> f64 {
    const FRAMES: u32 = 9;
    let start = process::cpu_time();
    for _ in 0..FRAMES {
        render(renderer, view);
    }
    1e3 * (process::cpu_time() - start).as_secs_f64() / f64::from(FRAMES)
}

#[test]
#[ignore = "prints a table of docs/performance.md"]
fn table_of_factors() {
    let Some(gpu) = common::gpu() else { return };
    println!(
        "| model | factor | MB | fill CPU ms | frame CPU ms | PSNR dB | SSIM | CIEDE2000 mean, 99 % |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        let view = view::resolve(&scene([240, 180], SrgSettings::default()), &case).unwrap();
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        // The first fill compiles shaders.
        render(&mut renderer, &view);
        for factor in [1.0, 2.0, 3.0, 4.0, 6.0, 8.0] {
            let settings = SrgSettings {
                factor: Some(factor),
                ..SrgSettings::default()
            };
            let view = with(&view, settings);
            let start = process::cpu_time();
            let frame = render(&mut renderer, &view);
            let both = 1e3 * (process::cpu_time() - start).as_secs_f64();
            let each = cpu_time(&mut renderer, &view);
            let c = compare(&frame.image, &truth, &view);
            println!(
                "| {} | {factor} | {:.1} | {:.0} | {each:.0} | {:.1} | {:.4} | {:.2}, {:.2} |",
                case.about.name,
                frame.bytes.resampled as f64 / f64::from(1 << 20),
                both - each,
                c.psnr_db,
                c.ssim,
                c.ciede2000_mean,
                c.ciede2000_p99
            );
        }
    }
}

#[test]
#[ignore = "prints a table of docs/performance.md"]
fn table_of_switches() {
    let Some(gpu) = common::gpu() else { return };
    let switches: [(&str, Change); 9] = [
        ("weighted", |s| s.weighted = true),
        ("skip_empty", |s| s.skip_empty = true),
        ("even 0.01", |s| s.even = 0.01),
        ("even 0.1", |s| s.even = 0.1),
        ("thin 0.005", |s| s.thin = 0.005),
        ("thin 0.02", |s| s.thin = 0.02),
        ("roulette 0.05", |s| s.roulette = 0.05),
        ("roulette 0.2", |s| s.roulette = 0.2),
        ("the defaults", |s| *s = SrgSettings::default()),
    ];
    let mut rows = vec![String::new(); 2 * switches.len()];
    let mut header = String::from("| switch | opacity |");
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        header += &format!(" {} |", case.about.name);
        for (upper, curve) in [None, Some(UPPER_HALF.to_vec())].into_iter().enumerate() {
            let mut scene = scene([400, 300], PLAIN);
            scene.transfer.opacity = curve.map(OpacitySpec::Points);
            let view = view::resolve(&scene, &case).unwrap();
            let plain = render(&mut renderer, &view);
            let time = cpu_time(&mut renderer, &view);
            for (at, (name, change)) in switches.iter().enumerate() {
                let mut settings = PLAIN;
                change(&mut settings);
                let view = with(&view, settings);
                let frame = render(&mut renderer, &view);
                let gain = time / cpu_time(&mut renderer, &view);
                let steps = frame.stats.work as f64 / plain.stats.work as f64;
                let c = compare(&frame.image, &plain.image, &view);
                let row = &mut rows[2 * at + upper];
                if row.is_empty() {
                    *row = format!("| {name} | {} |", ["all", "upper half"][upper]);
                }
                *row += &format!(
                    " {gain:.2} / {steps:.2}; {:.0} dB, {:.4}, {:.2} |",
                    c.psnr_db, c.ssim, c.ciede2000_mean
                );
            }
        }
    }
    println!(
        "{header}\n| --- | --- |{}",
        " --- |".repeat(common::models().len())
    );
    println!("{}", rows.join("\n"));
}
