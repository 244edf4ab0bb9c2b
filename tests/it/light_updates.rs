//! What light is made anew when, what it takes, and that a canceled update leaves nothing stale.

use std::cell::Cell;

use crate::common;
use crate::common::light::{Block, lighting, render};
use crate::common::shape::boxes;
use serde_json::{Value, json};
use strataray::case::{Case, load};
use strataray::render::gpu::GpuRenderer;
use strataray::render::gpu::illumination::Made;
use strataray::render::{RenderError, Renderer};
use strataray::scene::Scene;
use strataray::view;

/// Occlusion, a directional light and a spot on the sample, in small volumes.
fn lit() -> Value {
    let mut scene = Scene {
        size: [8, 6],
        property: Some("SWAT".into()),
        vertical_exaggeration: Some(8.0),
        sampling_step: Some(50.0),
        ..Scene::default()
    };
    scene.lighting = lighting(json!({
        "occlusion": {},
        "lights": [
            {"kind": "directional", "direction": [1, -1, -2]},
            {"kind": "spot", "position": [4e5, 6e6, 4e3], "direction": [0.1, 0.1, -1]},
        ],
        "volume": {"size": [40, 30, 12], "light_size": [13, 10, 6]},
    }));
    serde_json::to_value(scene).unwrap()
}

fn parsed(scene: &Value) -> Scene {
    serde_json::from_value(scene.clone()).unwrap()
}

/// The light volumes, one after the other.
fn volumes(renderer: &GpuRenderer) -> Vec<Vec<f64>> {
    let all = Block::read(renderer.gpu(), renderer.light().light_volumes().unwrap(), 0);
    let each = all.values.chunks(13 * 10 * 6);
    each.map(<[f64]>::to_vec).collect()
}

/// What changes, and where; fields, pyramids and light volumes that are made of it.
type Change = (&'static str, Value, [u64; 3]);

fn changes() -> Vec<Change> {
    let camera = json!({"azimuth_degrees": 100, "elevation_degrees": 30});
    let parallel = |zoom: f64| json!({"azimuth_degrees": 100, "elevation_degrees": 30, "zoom": zoom, "projection": "parallel"});
    let clip = json!([{"point": [0, 0, -15400], "normal": [0, 0, -1]}]);
    vec![
        ("/camera", camera, [0, 0, 1]),
        (
            "/lighting/lights/0/direction",
            json!([-1, 0.5, -1]),
            [0, 0, 1],
        ),
        (
            "/lighting/lights/1/position",
            json!([4e5, 6e6, -5e3]),
            [0, 0, 1],
        ),
        // Of a parallel camera only the direction counts.
        ("/camera", parallel(1.0), [0, 0, 1]),
        ("/camera", parallel(2.5), [0; 3]),
        // What is applied to samples is in no volume.
        ("/lighting/lights/1/direction", json!([0.3, 0, -1]), [0; 3]),
        ("/lighting/lights/1/opening_degrees", json!(20), [0; 3]),
        ("/lighting/lights/1/color", json!("#ff8800"), [0; 3]),
        ("/lighting/occlusion/strength", json!(0.5), [0; 3]),
        ("/lighting/ambient", json!(0.7), [0; 3]),
        ("/background", json!("#202020"), [0; 3]),
        ("/sampling_step", json!(30), [0; 3]),
        ("/strategy", json!("libc"), [0; 3]),
        (
            "/lighting/occlusion/half_angle_degrees",
            json!(30),
            [0, 0, 1],
        ),
        ("/lighting/shadows/attenuation", json!(0.5), [0, 0, 2]),
        ("/transfer/opacity", json!([[0, 0.6], [1, 0.1]]), [0, 1, 3]),
        ("/range", json!([0.2, 0.7]), [0, 1, 3]),
        ("/vertical_exaggeration", json!(7), [0, 1, 3]),
        ("/clip", clip, [0, 1, 3]),
        ("/filter/k", json!([2, 9]), [1, 1, 3]),
        ("/step", json!(3), [1, 1, 3]),
        ("/property", json!("SOIL"), [1, 1, 3]),
        ("/interpolation", json!("cell"), [1, 1, 3]),
        ("/show/inactive", json!("ghost"), [1, 1, 3]),
        ("/lighting/volume/size", json!([36, 30, 12]), [1, 1, 3]),
        ("", lit(), [1, 1, 3]),
        ("/background", json!("#ffffff"), [0; 3]),
    ]
}

#[test]
fn a_change_remakes_what_depends_on_it_alone() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let mut scene = lit();
    render(&mut renderer, &case, &parsed(&scene));
    let counts = |renderer: &GpuRenderer| {
        let Made {
            fields,
            pyramids,
            light_volumes,
            ..
        } = renderer.light().made;
        [fields, pyramids, light_volumes]
    };
    assert_eq!(counts(&renderer), [1, 1, 3]);
    let start = volumes(&renderer);
    let mut order = Vec::new();
    for (place, value, expected) in changes() {
        let (made, before) = (counts(&renderer), volumes(&renderer));
        *scene.pointer_mut(place).unwrap() = value;
        render(&mut renderer, &case, &parsed(&scene));
        let now = counts(&renderer);
        let more: [u64; 3] = std::array::from_fn(|n| now[n] - made[n]);
        assert_eq!(more, expected, "{place}");
        // As many volumes are others as were made: none was made for nothing, none is stale.
        let after = volumes(&renderer);
        let differs = (0..3).filter(|n| before[*n] != after[*n]);
        let differs: Vec<usize> = differs.collect();
        assert_eq!(differs.len() as u64, expected[2], "{place}");
        order.push(differs);
    }
    // Camera, first and second light.
    assert_eq!(order[..3], [[0], [1], [2]]);
    assert_eq!(volumes(&renderer), start);
}

#[test]
fn a_canceled_update_leaves_nothing_stale() {
    let Some(gpu) = common::gpu() else { return };
    let case = load::open(&common::sample()).unwrap();
    let fresh = |layers: [u32; 2]| {
        let mut scene = lit();
        // The same values, so that nothing but the cells tells one from the other.
        scene["filter"]["k"] = json!(layers);
        let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
        render(&mut renderer, &case, &parsed(&scene));
        (parsed(&scene), volumes(&renderer))
    };
    let [(first, was), (second, expected)] = [[1, 4], [4, 9]].map(fresh);
    assert_ne!(was, expected);
    let mut renderer = GpuRenderer::new(gpu.clone(), &case.grid).unwrap();
    let mut canceled = 0;
    for calls in 0u32.. {
        render(&mut renderer, &case, &first);
        assert!(volumes(&renderer) == was, "after {calls} calls");
        // Ends after so many slabs of values, pyramid and light, then goes on.
        let view = view::resolve(&second, &case).unwrap();
        let left = Cell::new(calls);
        let progress = |_| left.replace(left.get().saturating_sub(1)) > 0;
        match renderer.render(&view, &progress) {
            Ok(_) => break,
            Err(RenderError::Canceled) => canceled += 1,
            Err(error) => panic!("{error}"),
        }
        render(&mut renderer, &case, &second);
        assert!(volumes(&renderer) == expected, "after {calls} calls");
    }
    println!("canceled at {canceled} places");
    assert!(canceled > 5);
}

/// A cube of 2 x 2 x 2 cells.
fn cube() -> Case {
    let planes = [0.0, 50.0, 100.0];
    boxes(&planes, &planes, &planes, &|[i, j, k]| (i + j + k) as f64)
}

#[test]
fn volumes_take_what_was_computed_and_are_freed() {
    let Some(gpu) = common::gpu() else { return };
    let case = cube();
    let mut renderer = GpuRenderer::new(gpu, &case.grid).unwrap();
    let mut bytes = |spec: Value| {
        let scene = Scene {
            size: [8, 6],
            lighting: lighting(spec),
            ..Scene::default()
        };
        let (_, frame) = render(&mut renderer, &case, &scene);
        let light = renderer.light();
        let is_there = [
            light.field().is_some(),
            light.pyramid().is_some(),
            light.light_volumes().is_some(),
        ];
        (frame.bytes.lighting as f64, is_there)
    };
    let light = json!({"kind": "directional", "direction": [1, 1, -1]});
    let spec = |occlusion: &str, lights: &[&Value]| {
        json!({
            "occlusion": {"mode": occlusion}, "lights": lights,
            "volume": {"size": [48, 48, 48], "light_size": [24, 24, 24]},
        })
    };
    let within = |found: f64, volumes: f64| {
        let voxels = 48f64.powi(3);
        let expected = 2.0 * ((2.0 + 1.0 / 7.0) * voxels + volumes * 24f64.powi(3));
        (found / expected - 1.0).abs() < 0.01
    };
    let (found, is_there) = bytes(spec("preilluminated", &[&light, &light]));
    println!("{found} bytes with three light volumes");
    assert!(within(found, 3.0) && !within(found, 2.0), "{found}");
    assert_eq!(is_there, [true; 3]);
    let (found, is_there) = bytes(spec("image", &[]));
    assert!(within(found, 0.0), "{found}");
    assert_eq!(is_there, [true, true, false]);
    // Off, in three ways.
    for off in [
        json!({}),
        spec("off", &[]),
        json!({"shadows": {"mode": "image"}}),
    ] {
        bytes(spec("preilluminated", &[]));
        assert_eq!(bytes(off), (0.0, [false; 3]));
    }
}
