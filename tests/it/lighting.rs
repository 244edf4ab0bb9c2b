//! Lighting in scene files: what is refused and how, presets, defaults, sizes of volumes.

use crate::common;
use crate::common::shape::Shape;
use glam::DVec3;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::render::gpu::volume::Volume;
use strataray::scene::lighting::PRESETS;
use strataray::scene::{LightingSpec, Scene};
use strataray::view::lighting::BUDGET_MB;
use strataray::view::{self, Lighting, View};

/// A scene's lighting for a case, or what is wrong with it.
fn resolved(case: &Case, lighting: &Value) -> Result<Lighting, String> {
    let scene = json!({"property": "VALUE", "lighting": lighting});
    let scene: Scene = serde_json::from_value(scene).map_err(|e| e.to_string())?;
    let view = view::resolve(&scene, case).map_err(|e| e.to_string())?;
    Ok(view.style.lighting)
}

/// Lighting with one field of its own.
type Part = fn(&str, &Value) -> Value;

fn occlusion(field: &str, value: &Value) -> Value {
    json!({"occlusion": {field: value}})
}

fn unused_occlusion(field: &str, value: &Value) -> Value {
    json!({"occlusion": {"mode": "off", field: value}})
}

fn shadows(field: &str, value: &Value) -> Value {
    json!({"shadows": {field: value}})
}

/// A directional light.
fn lights(field: &str, value: &Value) -> Value {
    let mut light = json!({"kind": "directional", "direction": [0, 0, -1]});
    light[field] = value.clone();
    json!({"lights": [light]})
}

fn spot(field: &str, value: &Value) -> Value {
    let mut light = json!({"kind": "spot", "direction": [0, 0, -1], "position": [0, 0, 0]});
    light[field] = value.clone();
    json!({"lights": [light]})
}

fn volume(field: &str, value: &Value) -> Value {
    json!({"volume": {field: value}})
}

fn top(field: &str, value: &Value) -> Value {
    json!({field: value})
}

#[test]
fn err_values_out_of_range_name_their_field() {
    // What is refused, and what is as far as one may go.
    let cases: [(Part, &str, Value, Value); 27] = [
        (
            occlusion,
            "occlusion.half_angle_degrees",
            json!(0.9),
            json!(1),
        ),
        (
            occlusion,
            "occlusion.half_angle_degrees",
            json!(45.1),
            json!(45),
        ),
        (occlusion, "occlusion.splits", json!(2), json!(3)),
        (occlusion, "occlusion.attenuation", json!(-0.1), json!(0)),
        (occlusion, "occlusion.attenuation", json!(4.1), json!(4)),
        (occlusion, "occlusion.strength", json!(1.1), json!(1)),
        (occlusion, "occlusion.gap", json!(21), json!(0)),
        (occlusion, "occlusion.length", json!(0), json!(0.01)),
        (unused_occlusion, "occlusion.splits", json!(5), json!(1)),
        (shadows, "shadows.splits", json!(2), json!(7)),
        (shadows, "shadows.attenuation", json!(5), json!(4)),
        (shadows, "shadows.gap", json!(-1), json!(20)),
        (shadows, "shadows.length", json!(1.1), json!(1)),
        (
            lights,
            "lights.half_angle_degrees",
            json!(0.01),
            json!(0.05),
        ),
        (lights, "lights.half_angle_degrees", json!(11), json!(10)),
        (
            lights,
            "lights.direction",
            json!([0, 0, 0]),
            json!([0, 0, 1]),
        ),
        (lights, "lights.color", json!("white"), json!("#fff0e0")),
        (lights, "lights.intensity", json!(-1), json!(0)),
        (spot, "lights.opening_degrees", json!(90), json!(89)),
        (top, "ambient", json!(1.5), json!(1)),
        (top, "rays", json!(0), json!(1)),
        (top, "rays", json!(1025), json!(1024)),
        (top, "rays_gap", json!(-0.1), json!(0)),
        (top, "rays_gap", json!(20.5), json!(20)),
        (
            volume,
            "volume.size",
            json!([64, 1, 64]),
            json!([64, 2, 64]),
        ),
        (
            volume,
            "volume.light_size",
            json!([8, 8, 2049]),
            json!([8, 8, 2048]),
        ),
        (volume, "volume.budget_mb", json!(0), json!(1)),
    ];
    let case = Shape::default().case();
    for (part, place, wrong, right) in cases {
        let field = place.rsplit('.').next().unwrap();
        let error = resolved(&case, &part(field, &wrong)).unwrap_err();
        let start = format!("scene: lighting.{place}: ");
        assert!(error.starts_with(&start), "{place}: {error}");
        assert!(
            error.contains("must be") || error.contains("must have"),
            "{error}"
        );
        let found = resolved(&case, &part(field, &right));
        assert!(found.is_ok(), "{place}: {found:?}");
    }
}

#[test]
fn err_fields_that_are_unknown_or_missing_are_named() {
    let case = Shape::default().case();
    for (wrong, name) in [
        (json!({"oclusion": {}}), "oclusion"),
        (occlusion("half_angle", &json!(20)), "half_angle"),
        (occlusion("mode", &json!("fast")), "fast"),
        (shadows("strength", &json!(1)), "strength"),
        (lights("opening_degrees", &json!(20)), "opening_degrees"),
        (lights("kind", &json!("lamp")), "lamp"),
        (json!({"lights": [{"direction": [0, 0, -1]}]}), "kind"),
        (json!({"lights": [{"kind": "directional"}]}), "direction"),
        (json!({"lights": [{"kind": "point"}]}), "position"),
        (
            json!({"lights": [{"kind": "spot", "position": [0, 0, 0]}]}),
            "direction",
        ),
        (volume("size", &json!([64, 64])), "length 2"),
    ] {
        let error = resolved(&case, &wrong).unwrap_err();
        assert!(error.contains(name), "{wrong}: {error}");
        println!("{error}");
    }
}

#[test]
fn presets_resolve_and_differ() {
    let case = Shape::default().case();
    let mut seen = Vec::new();
    for (name, _) in PRESETS {
        let spec = LightingSpec::preset(name).unwrap();
        let lighting = resolved(&case, &serde_json::to_value(&spec).unwrap()).unwrap();
        assert_eq!(lighting.is_off(), name == "off");
        assert!(!seen.contains(&spec), "{name}");
        seen.push(spec);
    }
    assert_eq!(seen[0], LightingSpec::default());
    assert!(LightingSpec::preset("sunny").is_none());
}

#[test]
fn nothing_said_is_no_light_and_all_said_comes_back() {
    let empty: Scene = serde_json::from_value(json!({"lighting": {}})).unwrap();
    assert_eq!(empty, Scene::default());
    let all = json!({
        "occlusion": {
            "mode": "image", "half_angle_degrees": 12.5, "splits": 3, "attenuation": 0.5, "strength": 0.9,
            "gap": 2.5, "length": 0.4, "even_media": true,
        },
        "lights": [
            {"kind": "directional", "direction": [1, 2, -3], "half_angle_degrees": 2.5, "intensity": 0.3, "color": "#ffeedd"},
            {"kind": "point", "position": [1, 2, 3], "half_angle_degrees": 0.5, "intensity": 0.2, "color": "#112233"},
            {"kind": "spot", "position": [4, 5, 6], "direction": [0, 1, -1], "opening_degrees": 25, "half_angle_degrees": 1.5, "intensity": 0.1, "color": "#445566"},
        ],
        "shadows": {
            "mode": "monte_carlo", "splits": 3, "attenuation": 0.9, "gap": 1.5, "length": 0.6, "even_media": true,
        },
        "ambient": 0.2, "blinn_phong": true, "exact_colors": true, "geometry": false,
        "volume": {"budget_mb": 7, "size": [10, 11, 12], "light_size": [5, 6, 7]},
        "rays": 32, "rays_gap": 2.5, "seed": 5,
    });
    let spec: LightingSpec = serde_json::from_value(all.clone()).unwrap();
    let written = serde_json::to_value(&spec).unwrap();
    // Every field is written, and none is a default.
    let default = serde_json::to_value(LightingSpec::default()).unwrap();
    let fields = |of: &Value| of.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(fields(&written), fields(&all));
    assert!(fields(&all).iter().all(|f| written[f] != default[f]));
    assert_eq!(
        serde_json::from_value::<LightingSpec>(written.clone()).unwrap(),
        spec
    );
    for (a, b) in written["lights"]
        .as_array()
        .unwrap()
        .iter()
        .zip(all["lights"].as_array().unwrap())
    {
        assert_eq!(fields(a), fields(b));
    }
}

#[test]
fn light_adds_up_to_what_there_is_without() {
    let case = Shape::default().case();
    let sun = json!({"kind": "directional", "direction": [0, 0, -1]});
    for (lights, ambient, each) in [
        (json!([]), 1.0, 0.0),
        (json!([sun]), 0.4, 0.6),
        (json!([sun, sun, sun]), 0.4, 0.2),
    ] {
        let lighting = resolved(&case, &json!({"lights": lights})).unwrap();
        assert!((lighting.ambient - ambient).abs() < 1e-12);
        assert!(
            lighting
                .lights
                .iter()
                .all(|l| (l.intensity - each).abs() < 1e-12)
        );
    }
}

#[test]
fn volumes_have_cubes_and_fit_their_budget() {
    let case = load::open(&common::sample()).unwrap();
    for (exaggeration, budget_mb) in [(1.0, 1), (10.0, 1), (10.0, 3)] {
        let mut scene = Scene {
            vertical_exaggeration: Some(exaggeration),
            ..Scene::default()
        };
        scene.lighting.volume.budget_mb = Some(budget_mb);
        let lighting = view::resolve(&scene, &case).unwrap().style.lighting;
        let size = lighting.size();
        let voxels: f64 = size.iter().map(|n| f64::from(*n)).product();
        // Values, extinction and pyramid in half floats.
        let megabytes = 2.0 * (2.0 + 1.0 / 7.0) * voxels / f64::from(1 << 20);
        println!("{exaggeration}, {budget_mb} MB: {size:?} voxels, {megabytes:.3} MB");
        assert!(
            (megabytes / f64::from(budget_mb) - 1.0).abs() < 0.06,
            "{megabytes}"
        );
        let edges = lighting.extent / DVec3::from_array(size.map(f64::from));
        assert!(edges.max_element() < 1.1 * edges.min_element(), "{edges}");
        assert!((lighting.sigma() - edges.element_sum() / 3.0).abs() < 1e-9);
        // An eighth of the voxels, in flat models more along the depth.
        let light = lighting.light_size();
        assert_eq!(light[2], size[2].div_ceil(2).max(size[2].min(48)));
        let part = light.iter().map(|n| f64::from(*n)).product::<f64>() / voxels;
        assert!((part - 0.125).abs() < 0.03, "{light:?} of {size:?}");
    }
    // A small model has no more voxels than its cells need, whatever the budget; at least a few.
    let small = resolved(&Shape::default().case(), &volume("budget_mb", &json!(500))).unwrap();
    let voxels: u32 = small.size().iter().product();
    assert!(voxels > 1000 && voxels <= 3000, "{voxels}");
}

/// The view of the sample with an extinction volume as it is asked for.
fn with_volume(case: &Case, volume: &Value) -> View {
    let scene = json!({
        "size": [8, 6], "property": "PORO", "sampling_step": 50,
        "lighting": {"occlusion": {}, "volume": volume},
    });
    let scene: Scene = serde_json::from_value(scene).unwrap();
    view::resolve(&scene, case).unwrap()
}

#[test]
fn the_budget_decides_the_volume_where_the_scene_names_no_size() {
    let case = load::open(&common::sample()).unwrap();
    let lighting = |volume: Value| with_volume(&case, &volume).style.lighting;
    let usual = lighting(json!({}));
    assert_eq!(
        usual.size(),
        lighting(json!({"budget_mb": BUDGET_MB})).size()
    );
    let fine = lighting(json!({"budget_mb": 160}));
    assert!(fine.sigma() < 0.95 * usual.sigma());
    assert!(fine.size().iter().zip(usual.size()).all(|(a, b)| *a > b));
    let voxels = DVec3::from_array(fine.size().map(f64::from));
    assert!((fine.sigma() - (fine.extent / voxels).element_sum() / 3.0).abs() < 1e-9);
}

#[test]
fn a_device_takes_the_volume_of_the_view() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let view = with_volume(&case, &json!({"budget_mb": 20}));
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    renderer.render(&view, &|_| true).unwrap();
    let light = renderer.light();
    let size = |volume: Option<&Volume>| volume.unwrap().shape.size;
    assert_eq!(size(light.field()), view.style.lighting.size());
    assert_eq!(size(light.pyramid()), view.style.lighting.size());
    assert_eq!(
        size(light.light_volumes()),
        view.style.lighting.light_size()
    );
    let usual = with_volume(&case, &json!({})).style.lighting;
    assert_ne!(size(light.field()), usual.size());
}
