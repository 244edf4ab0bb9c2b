//! Range, scale and coloring: every strategy against the reference, and what a scene may ask for.

use std::sync::Arc;

use crate::common;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::image::Image;
use strataray::image::metrics::psnr_8bit;
use strataray::model::synthetic::Recipe;
use strataray::model::{CellField, Dims, Grid, GridInput, derivatives};
use strataray::reference;
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::{Interpolation, Scene, StrategyKind};
use strataray::transfer::{Scale, boundaries};
use strataray::view::step::steps;
use strataray::view::{self, Sequence, View};

fn scene(fields: &Value) -> Scene {
    let mut whole = json!({
        "size": [120, 90],
        "camera": {"azimuth_degrees": 205.0, "elevation_degrees": 35.0, "zoom": 1.2},
    });
    for (name, value) in fields.as_object().unwrap() {
        whole[name] = value.clone();
    }
    serde_json::from_value(whole).unwrap()
}

fn view(case: &Case, fields: &Value) -> View {
    view::resolve(&scene(fields), case).unwrap()
}

fn refusal(case: &Case, fields: &Value) -> String {
    view::resolve(&scene(fields), case).unwrap_err().to_string()
}

fn psnr(a: &Image, b: &Image, view: &View) -> f64 {
    let [a, b] = [a, b].map(|i| i.over_background_8bit(view.style.background));
    psnr_8bit(a.as_flattened(), b.as_flattened())
}

/// PSNR in dB that a strategy must reach: `pictures.rs` says why they differ.
fn least(strategy: StrategyKind) -> f64 {
    match strategy {
        StrategyKind::Plts => 60.0,
        StrategyKind::Libc => 55.0,
        StrategyKind::Srg => 42.0,
    }
}

#[test]
fn every_scale_and_coloring_agrees_with_the_reference() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let opacity = json!([[0.0, 0.1], [1.0, 0.4]]);
    let plain = |property: &str| {
        view(
            &case,
            &json!({"property": property, "transfer": {"opacity": opacity}}),
        )
    };
    for (property, transfer) in [
        (
            "SWAT",
            json!({"coloring": "banded", "bands": 4, "opacity": opacity}),
        ),
        ("PERMX", json!({"scale": "log", "opacity": opacity})),
        (
            "PERMX",
            json!({"scale": "log", "coloring": "banded", "bands": 5, "opacity": opacity}),
        ),
        ("FIPNUM", json!({"coloring": "categories"})),
        ("SWAT", json!({"opacity": "boundaries"})),
    ] {
        let view = view(&case, &json!({"property": property, "transfer": transfer}));
        let truth = reference::render(&case.grid, &view, &|_| true).unwrap();
        assert!(truth.pixels.iter().any(|p| p[3] > 0.3), "nothing to see");
        // The twin: the same property with colors that pass into each other by value.
        let other = reference::render(&case.grid, &plain(property), &|_| true).unwrap();
        let apart = psnr(&other, &truth, &view);
        for strategy in StrategyKind::ALL {
            let shown = view.by(strategy);
            let frame = renderer.render(&shown, &|_| true).unwrap();
            let db = psnr(&frame.image, &truth, &view);
            let what = format!(
                "{property} {transfer} {}: {db:.1} dB, twin {apart:.1}",
                strategy.name()
            );
            println!("{what}");
            assert!(db >= least(strategy) && apart < db, "{what}");
        }
        assert!(
            apart < least(StrategyKind::Srg),
            "{property} {transfer}: {apart}"
        );
    }
}

#[test]
fn true_values_come_back_from_every_scale() {
    let case = load::open(&common::sample()).unwrap();
    let permx = case.field("PERMX", 0).unwrap();
    let log = view(
        &case,
        &json!({"property": "PERMX", "transfer": {"scale": "log"}}),
    );
    let positive = permx.values().iter().filter(|v| **v > 0.0);
    let least = positive.fold(f32::INFINITY, |a, b| a.min(*b));
    for (shown, value) in log.shown.cells.field.values().iter().zip(permx.values()) {
        let wanted = f64::from(value.max(least));
        let back = log.true_value(f64::from(*shown));
        assert!((back / wanted - 1.0).abs() < 1e-5, "{back} {wanted}");
    }
    let statistics = permx.statistics().unwrap();
    let [low, high] = log.style.transfer.true_range();
    assert!((low / f64::from(least) - 1.0).abs() < 1e-9);
    assert!((high / statistics.max - 1.0).abs() < 1e-9);
    let regions = view(
        &case,
        &json!({"property": "FIPNUM", "transfer": {"coloring": "categories"}}),
    );
    let fipnum = case.field("FIPNUM", 0).unwrap();
    for (shown, value) in regions
        .shown
        .cells
        .field
        .values()
        .iter()
        .zip(fipnum.values())
    {
        assert_eq!(regions.true_value(f64::from(*shown)), f64::from(*value));
    }
    let Scale::Categories(values) = &regions.style.transfer.scale else {
        panic!("{:?}", regions.style.transfer.scale);
    };
    assert!(values.len() > 1 && regions.shown.cells.interpolation == Interpolation::Cell);
    assert_eq!(
        regions.style.transfer.range,
        [-0.5, values.len() as f64 - 0.5]
    );
}

#[test]
fn the_range_is_that_of_the_step_or_of_all_steps() {
    let case = load::open(&common::sample()).unwrap();
    let range = |fields: Value| view(&case, &fields).style.transfer.range;
    let last = case.steps.len() - 1;
    for property in ["PRESSURE", "SWAT-SWAT@0"] {
        let all = range(json!({"property": property, "step": 1, "range": "steps"}));
        assert_eq!(
            all,
            range(json!({"property": property, "step": last, "range": "steps"}))
        );
        let mut union = [f64::INFINITY, f64::NEG_INFINITY];
        for step in 0..=last {
            let [low, high] = range(json!({"property": property, "step": step}));
            union = [union[0].min(low), union[1].max(high)];
        }
        assert_eq!(all, union);
        assert_ne!(all, range(json!({"property": property, "step": 1})));
    }
    let own = range(json!({"property": "PORO"}));
    assert_eq!(own, range(json!({"property": "PORO", "range": "steps"})));
    assert_eq!(range(json!({"property": "PORO", "range": null})), own);
}

#[test]
fn films_have_one_range_in_every_scale() {
    let case = load::open(&common::sample()).unwrap();
    let all = steps(&case, None, 1).unwrap();
    let film = |fields: Value| {
        let film = Sequence::over_steps(&scene(&fields), &case, &all, &|_| true);
        film.unwrap().unwrap()
    };
    let linear = film(json!({"property": "PRESSURE"}));
    let log = film(json!({"property": "PRESSURE", "transfer": {"scale": "log"}}));
    assert_eq!(linear.range(), log.range());
    let first = log.view(0, &case).unwrap();
    let last = log.view(all.len() - 1, &case).unwrap();
    assert_eq!(first.style.transfer.range, last.style.transfer.range);
    assert_eq!(first.style.transfer.range, linear.range().map(f64::log10));
}

#[test]
fn err_what_cannot_be_shown_is_said() {
    let case = load::open(&common::sample()).unwrap();
    for (fields, words) in [
        (
            json!({"property": "SWAT-SWAT@last", "transfer": {"scale": "log"}}),
            ["transfer.scale", "above 0"],
        ),
        (
            json!({"property": "PORO", "range": [-2.0, -1.0], "transfer": {"scale": "log"}}),
            ["transfer.scale", "-2 to -1"],
        ),
        (
            json!({"property": "SWAT", "transfer": {"coloring": "categories"}}),
            ["transfer.coloring", "not whole"],
        ),
        (
            json!({"property": "INDEX_I", "transfer": {"coloring": "categories", "scale": "log"}}),
            ["there is no property", "INDEX_I"],
        ),
        (
            json!({"property": "FIPNUM", "transfer": {"coloring": "categories", "scale": "log"}}),
            ["transfer.scale", "no logarithm"],
        ),
        (
            json!({"transfer": {"coloring": "banded", "bands": 1}}),
            ["transfer.bands", "2 to 64"],
        ),
        (
            json!({"transfer": {"coloring": "banded", "bands": 65}}),
            ["transfer.bands", "2 to 64"],
        ),
        (json!({"range": [2.0, 1.0]}), ["range", "smaller first"]),
        (
            json!({"transfer": {"opacity": [[0.5, 0.1], [0.4, 0.2]]}}),
            ["transfer.opacity", "rising"],
        ),
    ] {
        let said = refusal(&case, &fields);
        assert!(words.iter().all(|w| said.contains(w)), "{fields}: {said}");
    }
}

#[test]
fn boundaries_do_not_move_with_time() {
    let case = load::open(&common::sample()).unwrap();
    let opacity = |step: usize, range: Value| {
        let fields = json!({"property": "SWAT", "step": step, "range": range, "transfer": {"opacity": "boundaries"}});
        view(&case, &fields).style.transfer.opacity
    };
    let last = case.steps.len() - 1;
    let found = opacity(last, json!([0.0, 1.0]));
    assert!((5..=11).contains(&found.len()), "{found:?}");
    assert_eq!(opacity(1, json!([0.0, 1.0])), found);
    assert_ne!(opacity(1, json!([0.1, 0.9])), found);
    // Without boundaries there is the default curve.
    let whole = json!({"property": "FIPNUM", "transfer": {"coloring": "categories", "opacity": "boundaries"}});
    let plain = json!({"property": "FIPNUM", "transfer": {"coloring": "categories"}});
    assert_eq!(
        view(&case, &whole).style.transfer.opacity,
        view(&case, &plain).style.transfer.opacity
    );
}

/// The values of a formula of I at the active cells.
fn along_i(grid: &Grid, value: impl Fn(f64) -> f64) -> Arc<CellField> {
    let cells = grid.active_cells().iter();
    let values = cells.map(|&cell| value(grid.dims().ijk(cell).i as f64) as f32);
    Arc::new(CellField::new(values.collect()))
}

#[test]
fn fronts_in_a_grid_are_found_at_their_value() {
    let case = load::open(&common::sample()).unwrap();
    let found = |value: &dyn Fn(f64) -> f64| {
        boundaries::find(&derivatives::samples(
            &case.grid,
            &along_i(&case.grid, value),
            None,
        ))
    };
    // From 0.2 to 0.8 within some three cells, and within one.
    for width in [1.5, 0.1] {
        let front = found(&|i| 0.5 + 0.3 * ((i - 15.5) / width).tanh());
        assert_eq!(front.len(), 1, "{front:?}");
        assert!((front[0].value - 0.5).abs() < 0.03, "{front:?}");
        assert!(
            front[0].ends[0] > 0.2 && front[0].ends[1] < 0.8,
            "{front:?}"
        );
    }
    // Twins: the same values in a ramp, all the same, and none.
    assert_eq!(found(&|i| 0.2 + 0.6 * i / 39.0), []);
    assert_eq!(found(&|_| 0.5), []);
    assert_eq!(found(&|_| f64::NAN), []);
}

#[test]
#[ignore = "measures: cargo test --release --test colors -- --ignored --nocapture"]
fn boundaries_of_a_million_cells() {
    let dims = Dims {
        ni: 100,
        nj: 100,
        nk: 120,
    };
    let model = Recipe::named("faulted").unwrap().build(dims, 1, 2).unwrap();
    let geometry = &model.geometry;
    let grid = Grid::new(&GridInput {
        dims,
        coord: &geometry.coord,
        zcorn: &geometry.zcorn,
        actnum: Some(&geometry.actnum),
        map_axes: None,
    })
    .unwrap();
    let field = CellField::new(model.fields.values("SWAT", 1.0).unwrap());
    let start = std::time::Instant::now();
    let samples = derivatives::samples(&grid, &field, None);
    let sampled = start.elapsed();
    let found = boundaries::find(&samples);
    println!(
        "{} active cells: samples in {sampled:?}, all in {:?}: {found:?}",
        grid.active_cells().len(),
        start.elapsed()
    );
}
