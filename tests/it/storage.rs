//! Depths and values in 16 bits: how near they stay, that images agree, and what they take.

use std::sync::Arc;

use crate::common;
use crate::common::shape::crossing;
use serde_json::json;
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::model::synthetic::Recipe;
use strataray::model::{CellIndex, Grid, GridInput};
use strataray::render::cpu::CpuExecutor;
use strataray::render::gpu::GpuExecutor;
use strataray::render::plan::packing::{packed, unpacked};
use strataray::render::plan::{CompactGrid, Values, drawn_words};
use strataray::render::{Executor, Frame, Renderer};
use strataray::scene::{Interpolation, Storage, StrategyKind};
use strataray::view::{self, View};

fn executors() -> Vec<Arc<dyn Executor>> {
    let gpu = common::gpu().map(|gpu| Arc::new(GpuExecutor::from(gpu)) as Arc<dyn Executor>);
    let cpu: Arc<dyn Executor> = Arc::new(CpuExecutor::default());
    [cpu].into_iter().chain(gpu).collect()
}

/// A view of the volume alone.
fn volume(case: &Case, more: &serde_json::Value) -> View {
    let mut written = json!({
        "size": [160, 120], "mode": "volume", "lighting": {}, "show": {"hull": "hidden"},
    });
    let keys = written.as_object_mut().unwrap();
    keys.extend(more.as_object().unwrap().clone());
    let scene = view::look::opening(case, &written).unwrap();
    view::resolve(&scene, case).unwrap()
}

fn stored(view: &View, storage: Storage) -> View {
    let mut view = view.clone();
    view.sampling.storage = storage;
    view
}

fn frame(renderer: &mut dyn Renderer, view: &View) -> Frame {
    let frame = renderer.render(view, &|_| true).unwrap();
    let stats = frame.stats;
    assert_eq!((stats.lost_rays, stats.lost_samples), (0, 0), "{stats:?}");
    frame
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

/// A grid with its depths in steps of so much.
fn in_steps(grid: &Grid, step: f64) -> Arc<Grid> {
    let dims = grid.dims();
    let ends = grid.pillars().iter().flat_map(|pillar| {
        let [top, bottom] = [0.0, 1e4].map(|z| pillar.at(z).to_array());
        [top, bottom].concat()
    });
    let coord: Vec<f64> = ends.collect();
    let mut zcorn = vec![0.0; 8 * dims.cells()];
    for cell in 0..dims.cells() {
        let ijk = dims.ijk(CellIndex(cell as u32));
        for corner in 0..8 {
            let [di, dj, dk] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let row = 2 * ijk.j + dj + 2 * dims.nj * (2 * ijk.k + dk);
            let depth = grid.corner_depth(ijk, corner);
            zcorn[2 * ijk.i + di + 2 * dims.ni * row] = (depth / step).round() * step;
        }
    }
    let active = |cell| i32::from(grid.is_active(dims.ijk(CellIndex(cell as u32))));
    let actnum: Vec<i32> = (0..dims.cells()).map(active).collect();
    let input = GridInput {
        dims,
        coord: &coord,
        zcorn: &zcorn,
        actnum: Some(&actnum),
        map_axes: grid.map_axes(),
    };
    Arc::new(Grid::new(&input).unwrap())
}

/// Least PSNR in dB of an image with depths and values in 16 bits against the exact one.
const LEAST_DB: f64 = 77.0;

#[test]
fn images_are_nearly_those_of_exact_storage() {
    for (n, model) in common::models().iter().take(3).enumerate() {
        let case = load::open(model).unwrap();
        for (interpolation, strategy) in [
            ("vertex", StrategyKind::Plts),
            ("cell", StrategyKind::Libc),
            ("cell", StrategyKind::Plts),
            ("vertex", StrategyKind::Libc),
        ] {
            let look = json!({"interpolation": interpolation});
            let view = volume(&case, &look).by(strategy);
            let mut compact_images = Vec::new();
            for executor in executors() {
                let mut renderer = executor.renderer(&case.grid).unwrap();
                let [exact, compact] = [Storage::Exact, Storage::Compact]
                    .map(|storage| frame(&mut *renderer, &stored(&view, storage)));
                let name = executor.info().executor;
                let error = compact.storage_error;
                let db = psnr(&exact.image, &compact.image, &view);
                let place = format!("{name} {} {strategy:?} {interpolation}", case.about.name);
                println!("{place}: {db:.1} dB, {error:?}");
                assert!(db >= LEAST_DB, "{place} {db}");
                assert_eq!(exact.storage_error.depth, 0.0, "{place}");
                assert!(error.depth > 0.0 && error.depth <= 0.008, "{place}");
                assert!(error.value <= 1e-5, "{place}");
                // Back again.
                let again = frame(&mut *renderer, &stored(&view, Storage::Exact));
                assert_eq!(again.storage_error.depth, 0.0, "{place}");
                assert!(psnr(&exact.image, &again.image, &view) > 90.0, "{place}");
                if name == "gpu" {
                    let [a, b] = [&exact, &compact].map(|f| f.bytes.property as f64);
                    assert!(b < 0.56 * a, "{place}: {a} {b}");
                    assert!(exact.bytes.geometry > compact.bytes.geometry, "{place}");
                }
                compact_images.push(compact.image);
                if n == 0 {
                    // The twin.
                    let coarse = in_steps(&case.grid, 128.0 * error.depth);
                    let mut renderer = executor.renderer(&coarse).unwrap();
                    let coarse = renderer.render(&view, &|_| true).unwrap().image;
                    let db = psnr(&exact.image, &coarse, &view);
                    println!("{place} coarse: {db:.1} dB");
                    assert!(db < LEAST_DB - 6.0, "{place} {db}");
                }
            }
            if let [a, b] = &compact_images[..] {
                // What executors agree to where storage is exact.
                let db = psnr(a, b, &view);
                println!("{interpolation} {strategy:?}: {db:.1} dB");
                assert!(db > 70.0, "{interpolation} {strategy:?} {db}");
            }
        }
    }
}

#[test]
fn lists_that_are_held_by_blocks_have_the_depths_of_the_grid() {
    for model in common::models() {
        let case = load::open(&model).unwrap();
        let grid = &case.grid;
        let [exact, compact] =
            [Storage::Exact, Storage::Compact].map(|s| CompactGrid::new(grid, s).unwrap());
        let words = packed(&compact.depths);
        let dims = grid.dims();
        let mut largest = 0.0f64;
        for cell in grid.active_cells() {
            let ijk = dims.ijk(*cell);
            let column = ijk.i + dims.ni * ijk.j;
            for corner in 0..8u32 {
                let depth = |of: &CompactGrid| {
                    let list = of.column_lists[column][corner as usize & 3];
                    let entry =
                        strataray::render::plan::list_entry(list, ijk.k as u32, corner >> 2);
                    (entry, of.depths[entry as usize])
                };
                let ((_, exact), (entry, compact)) = (depth(&exact), depth(&compact));
                assert_eq!(unpacked(&words, entry), compact);
                largest = largest.max(f64::from((exact - compact).abs()));
            }
        }
        println!("{}: {largest} of {}", case.about.name, compact.depth_error);
        assert!(largest > 0.0 && largest <= compact.depth_error);
        // Values at vertices lie where the depths lie.
        let view = volume(&case, &json!({"interpolation": "vertex"}));
        let values = |storage| Values::new(grid, &view.shown.cells, storage).held.len();
        assert_eq!(values(Storage::Compact), compact.depths.len());
        assert_eq!(values(Storage::Exact), exact.depths.len());
    }
}

#[test]
fn categories_keep_their_colors() {
    let case = load::open(&common::sample()).unwrap();
    let look = json!({
        "property": "K", "interpolation": "cell", "transfer": {"coloring": "categories"},
    });
    let view = volume(&case, &look);
    assert_eq!(view.shown.cells.interpolation, Interpolation::Cell);
    let held = |storage| Values::new(&case.grid, &view.shown.cells, storage);
    let compact = held(Storage::Compact);
    assert!(compact.held.iter().any(|v| *v > 0.0) && compact.error == 0.0);
    assert_eq!(compact.held, held(Storage::Exact).held);
}

/// Of geometry, acceleration and values at vertices, on the device, lists of faces aside.
#[test]
fn bytes_of_an_active_cell_are_as_stated() {
    for (name, exact_most, compact_most) in [
        ("r1", 17.5, 11.4),
        ("r2", 18.2, 12.0),
        ("r3", 22.0, 13.4),
        ("r4", 11.9, 6.8),
        ("r5", 10.9, 6.3),
    ] {
        let recipe = Recipe::named(name).unwrap();
        let geometry = recipe.build(recipe.dims, 1, 1).unwrap().geometry;
        let grid = Grid::new(&GridInput {
            dims: geometry.dims,
            coord: &geometry.coord,
            zcorn: &geometry.zcorn,
            actnum: Some(&geometry.actnum),
            map_axes: None,
        });
        let grid = grid.unwrap();
        let bytes = |storage| {
            let compact = CompactGrid::new(&grid, storage).unwrap();
            let numbers = match storage {
                Storage::Exact => size_of_val(&*compact.depths),
                Storage::Compact => size_of_val(&*packed(&compact.depths)),
            };
            let others = size_of_val(&*compact.words()) + size_of_val(&*drawn_words(&grid, &[]));
            // Values take as much as depths.
            let each = (2 * numbers + others) as f64 / grid.active_cells().len() as f64;
            (each, compact.depth_error)
        };
        let [(exact, _), (compact, error)] = [Storage::Exact, Storage::Compact].map(bytes);
        println!("{name}: {exact:.2}, {compact:.2} bytes an active cell, {error} m");
        assert!(
            exact > compact_most && exact <= exact_most,
            "{name} {exact}"
        );
        assert!(compact <= compact_most, "{name} {compact}");
        assert!(error > 0.0 && error < 0.02, "{name} {error}");
    }
}

/// Whatever reads depths or values: surfaces with edges, ghosts, sections, volumes, light; and layers that cross.
#[test]
fn every_look_can_be_held_in_16_bits() {
    let sample = load::open(&common::sample()).unwrap();
    let lit = json!({
        "show": {"inactive": "ghost", "hull": "faint", "faults": true, "cell_edges": true},
        "srg": {"factor": 2.0},
        "lighting": {"occlusion": {"mode": "preilluminated"}, "volume": {"size": [16, 16, 16], "light_size": [8, 8, 8]}},
    });
    let cut = json!({
        "mode": "cells",
        "clip": [{"point": [0.0, 0.0, 0.0], "normal": [0.3, 0.1, 1.0]}],
    });
    let crossed = json!({"property": "VALUE", "interpolation": "cell"});
    for executor in executors() {
        for (case, look) in [(&sample, &lit), (&sample, &cut), (&crossing(), &crossed)] {
            let mut renderer = executor.renderer(&case.grid).unwrap();
            let mut view = volume(case, look);
            if let Some(plane) = view.shown.clip.first_mut() {
                let [low, high] = view.world.bounds;
                plane.point = 0.5 * (low + high);
            }
            for strategy in StrategyKind::ALL {
                let view = view.by(strategy);
                let [exact, compact] = [Storage::Exact, Storage::Compact]
                    .map(|storage| frame(&mut *renderer, &stored(&view, storage)).image);
                let db = psnr(&exact, &compact, &view);
                let name = executor.info().executor;
                println!("{name} {strategy:?} {look}: {db:.1} dB");
                // Faces of layers that cross lie in one plane. Which of two a pixel meets first may differ in tiles of
                // another size, and tiles are as large as the adapter is quick: one pixel of this image is 48.6 dB.
                let is_by_tiles = name == "gpu" && look == &crossed;
                let least = if is_by_tiles { 45.0 } else { 60.0 };
                assert!(db > least, "{name} {strategy:?} {look} {db}");
                assert!(exact.pixels.iter().any(|pixel| pixel[3] > 0.05));
            }
        }
    }
}
