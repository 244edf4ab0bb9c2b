//! Devices with limits: with what WebGPU grants by default all is drawn, and with less nothing is begun.

use std::sync::Arc;

use serde_json::json;
use strataray::case::load;
use strataray::image::Image;
use strataray::render::gpu::bind_groups::Parameters;
use strataray::render::gpu::device::PARAMETERS;
use strataray::render::gpu::{Gpu, GpuRenderer};
use strataray::render::{RenderError, Renderer};
use strataray::scene::{Scene, StrategyKind};
use strataray::view::{self, View};
use wgpu::Limits;

use crate::common;

/// Lights with shadows, hull and faults, a filter, and inactive cells as ghosts; as small as shows all.
fn scene(lights: &serde_json::Value) -> Scene {
    serde_json::from_value(json!({
        "version": 1,
        "size": [32, 24],
        "mode": "volume",
        "filter": {"i": "3-24"},
        "show": {"inactive": "ghost", "hull": "faint", "faults": true},
        "srg": {"factor": 1.0},
        "lighting": {
            "occlusion": {"mode": "preilluminated"},
            "lights": lights,
            "volume": {"size": [4, 4, 2], "light_size": [4, 4, 2]},
        },
    }))
    .unwrap()
}

/// A picture by each strategy.
fn pictures(gpu: Gpu, case: &strataray::case::Case, view: &View) -> Vec<Image> {
    let mut renderer = GpuRenderer::new(Arc::new(gpu), &case.grid).unwrap();
    let by = |strategy| {
        renderer
            .render(&view.by(strategy), &|_| true)
            .unwrap()
            .image
    };
    StrategyKind::ALL.map(by).into()
}

/// Largest difference of two pictures' numbers.
fn apart(a: &Image, b: &Image) -> f32 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// WebGPU's default limits with so many storage buffers a shader stage.
fn with_buffers(max_storage_buffers_per_shader_stage: u32) -> Limits {
    Limits {
        max_storage_buffers_per_shader_stage,
        ..Limits::default()
    }
}

#[test]
fn the_default_limits_of_webgpu_are_enough() {
    if common::gpu().is_none() {
        return;
    }
    let case = load::open(&common::sample()).unwrap();
    let lit = json!([{"kind": "directional", "direction": [1, 1, -2]}]);
    let view = view::resolve(&scene(&lit), &case).unwrap();
    let dark = view::resolve(&scene(&json!([])), &case).unwrap();
    let least = Gpu::with_limits(None, &Limits::default()).unwrap();
    assert_eq!(least.device.limits(), Limits::default());
    let least = pictures(least, &case, &view);
    let usual = pictures(Gpu::new(None).unwrap(), &case, &view);
    let dark = pictures(Gpu::new(None).unwrap(), &case, &dark);
    for ((least, usual), dark) in least.iter().zip(&usual).zip(&dark) {
        // 1e-5 of 1 is 100 dB in the worst pixel. The twin, no light, is a hundred times farther.
        let found = [apart(least, usual), apart(least, dark)];
        assert!(found[0] <= 1e-5 && found[1] > 1e-3, "{found:?}");
    }
}

#[test]
fn err_a_buffer_less_is_refused() {
    let Some(gpu) = common::gpu() else { return };
    match Gpu::with_limits(None, &with_buffers(7)) {
        Err(RenderError::Unsuitable { adapter, reason }) => {
            assert_eq!(adapter, gpu.info.name);
            let words = "it offers 7 storage buffers per shader stage and 8 are needed";
            assert!(reason.starts_with(words), "{reason}");
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("7 are taken"),
    }
}

#[test]
fn parameters_are_storage_only_where_there_are_buffers_for_them() {
    let Some(gpu) = common::gpu() else { return };
    if !gpu.is_software() || std::env::var_os(PARAMETERS).is_some() {
        return;
    }
    let needed = Parameters::Storage.storage_buffers();
    for (buffers, parameters) in [
        (needed - 1, Parameters::Uniform),
        (needed, Parameters::Storage),
    ] {
        let gpu = Gpu::with_limits(None, &with_buffers(buffers)).unwrap();
        assert_eq!(gpu.layouts.parameters(), parameters);
    }
}
